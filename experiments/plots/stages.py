"""Pictures side by side, each with a name and what it is: the figures 9 and 10 of the papers.

usage: stages.py STAGES.txt FOLDER OUT.png [COLUMNS]

STAGES.txt has a line for each stage: its name, two numbers that are not needed here, and what it is. FOLDER holds a
picture of each, NAME.png, all of one size. Pixels are taken as they are; below each stand its name and what it is.
Without COLUMNS all are in one row.
"""

import os
import sys

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams.update({"font.family": "DejaVu Sans"})
import matplotlib.pyplot as plt  # noqa: E402

from whole_files import save  # noqa: E402

DPI = 100
STRIP = 92  # pixels, for the words


def stages(path):
    with open(path, encoding="utf-8") as file:
        for line in file:
            if line.strip() and not line.startswith("#"):
                name, _, _, what = line.rstrip("\n").split(" ", 3)
                yield name, what


def main():
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    table, folder, out = sys.argv[1:4]
    shown = list(stages(table))
    columns = int(sys.argv[4]) if len(sys.argv) == 5 else len(shown)
    rows = -(-len(shown) // columns)
    pictures = [plt.imread(os.path.join(folder, f"{name}.png")) for name, _ in shown]
    height, width = pictures[0].shape[:2]
    size = (width * columns, (height + STRIP) * rows)
    figure = plt.figure(figsize=(size[0] / DPI, size[1] / DPI), dpi=DPI, facecolor="white")
    for i, ((name, what), picture) in enumerate(zip(shown, pictures)):
        column, below = i % columns, rows - 1 - i // columns
        bottom = below * (height + STRIP)
        figure.figimage(picture, column * width, bottom + STRIP)
        for y, text, points, colour in ((62, f"({name})", 21, "#222222"), (20, what, 18, "#444444")):
            figure.text((column + 0.5) / columns, (bottom + y) / size[1], text, ha="center", va="center",
                        fontsize=points, color=colour)
    save(figure, out, dpi=DPI)


if __name__ == "__main__":
    main()
