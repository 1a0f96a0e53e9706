"""The stages of the paper's figure 10 side by side.

usage: figure10.py STAGES.txt FOLDER OUT.png

STAGES.txt has a line for each stage: its name, two numbers that are not needed here, and what it is. FOLDER holds a
picture of each, NAME.png, all of one size. Pixels are taken as they are; below each stand its name and what it is.
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
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    _, table, folder, out = sys.argv
    shown = list(stages(table))
    pictures = [plt.imread(os.path.join(folder, f"{name}.png")) for name, _ in shown]
    height, width = pictures[0].shape[:2]
    figure = plt.figure(figsize=(width * len(shown) / DPI, (height + STRIP) / DPI), dpi=DPI, facecolor="white")
    for i, ((name, what), picture) in enumerate(zip(shown, pictures)):
        figure.figimage(picture, i * width, STRIP)
        middle = (i + 0.5) / len(shown)
        for y, text, size, colour in ((62, f"({name})", 21, "#222222"), (20, what, 18, "#444444")):
            figure.text(middle, y / (height + STRIP), text, ha="center", va="center", fontsize=size, color=colour)
    save(figure, out, dpi=DPI)


if __name__ == "__main__":
    main()
