"""How cost grows: each sweep of the scaling experiment, a panel for each figure, logarithmic on both axes.

usage: scaling.py RESULTS.csv OUT-FOLDER FIGURE...

FIGURE is primitives (the sweeps extent and detail in one), surfels, crowding or spread. Writes scaling-FIGURE.png
and scaling-FIGURE.svg into the folder. The paper's size, 3,426 primitives or 280,000 surfels, and a 60th of a second are marked.
"""

import csv
import os
import sys

import style

style.use(9)
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.ticker import FuncFormatter, LogLocator  # noqa: E402

from whole_files import save_both  # noqa: E402

FRAME = 1000 / 60  # milliseconds
PAPER = {"primitives": (3426, "3,426"), "surfels": (280000, "280,000")}
FIGURES = {"primitives": ["extent", "detail"], "surfels": ["surfels"], "crowding": ["crowding"], "spread": ["spread"]}
# What stands across, and the column that has it.
ACROSS = {"primitives": ("primitives", "primitives"), "surfels": ("surfels", "surfels"),
          "crowding": ("primitives that a stamp meets", "met"), "spread": ("largest radius : smallest", "value")}
COLOURS = {"extent": "#b3261e", "detail": "#1f5fa8", "surfels": "#b3261e", "crowding": "#b3261e", "spread": "#b3261e"}
NAMES = {"extent": "more surface", "detail": "more detail"}
# Title, unit, columns with what each is called (the first is drawn whole, the others broken), what is in proportion.
PANELS = [
    ("stamp", "µs", [("stamp_us_p50", "median"), ("stamp_us_p99", "p99")]),
    ("undo of a stroke in the middle", "ms", [("undo_ms_p50", "median"), ("undo_ms_p99", "p99")]),
    ("rebuild of everything", "ms", [("rebuild_ms", "all threads"), ("rebuild_1_ms", "one thread")]),
    ("rays, one thread", "a second", [("rays_per_s", "whole list"), ("rays_per_s_prefix", "first half")]),
    ("picture on the CPU", "ms", [("picture_ms", "drawing"), ("listing_ms", "listing the surfels")]),
    ("memory", "bytes", [("bytes_per_primitive", "a primitive"), ("bytes_per_surfel", "a surfel")]),
]
LINES = [("-", "o"), ("--", "o")]


def read(path, figure):
    sweeps = {}
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["sweep"] in FIGURES[figure]:
                sweeps.setdefault((row["sweep"], row["source"]), []).append(row)
    if not sweeps:
        sys.exit(f"{path}: no rows of {figure}")
    return sweeps


def mark_paper(axes, figure, title):
    if figure not in PAPER:
        return
    place, text = PAPER[figure]
    axes.axvline(place, color="#777777", linestyle=":", linewidth=1, zorder=1)
    axes.annotate(text, (place, 1), xycoords=("data", "axes fraction"), xytext=(3, -2), textcoords="offset points",
                  va="top", fontsize=7.5, color="#777777")
    if title.startswith("picture"):
        axes.axhline(FRAME, color="#777777", linestyle=":", linewidth=1, zorder=1)
        left, right = axes.get_xlim()
        at_right = place ** 2 < left * right  # on the side where the star is not
        axes.annotate("a 60th of a second", (at_right, FRAME), xycoords=("axes fraction", "data"), xytext=(0, 2),
                      textcoords="offset points", ha="right" if at_right else "left", fontsize=7.5, color="#777777")
        axes.plot([place], [FRAME], marker="*", markersize=11, color="#222222", zorder=8)


def draw(sweeps, figure, prefix):
    plot, grid = plt.subplots(2, 3, figsize=(10.4, 6.1), dpi=160)
    label, across = ACROSS[figure]
    for axes, (title, unit, columns) in zip(grid.flat, PANELS):
        highest, lowest = 0, float("inf")
        for (sweep, _), rows in sweeps.items():
            for (column, _), (line, marker) in zip(columns, LINES):
                points = sorted((float(row[across]), float(row[column])) for row in rows if row[column])
                if not points:
                    continue
                colour = COLOURS[sweep]
                axes.plot(*zip(*points), line, color=colour, linewidth=1.8 if line == "-" else 1.2, marker=marker,
                          markersize=4, markerfacecolor=colour if line == "-" else "white", zorder=5, clip_on=False)
                highest = max(highest, *(y for _, y in points))
                lowest = min(lowest, *(y for _, y in points))
        axes.set_xscale("log")
        axes.set_yscale("log")
        if highest > 0:
            # At least two decades: what is flat must look flat.
            middle = (highest * lowest) ** 0.5
            axes.set_ylim(min(lowest / 1.6, middle / 10), max(highest * 1.6, middle * 10))
        axes.xaxis.set_major_locator(LogLocator(numticks=9))
        axes.yaxis.set_major_locator(LogLocator(numticks=9))
        axes.xaxis.set_major_formatter(FuncFormatter(style.short))
        axes.yaxis.set_major_formatter(FuncFormatter(style.short))
        axes.minorticks_off()
        axes.grid(axis="y", color="#dddddd", linewidth=0.7)
        axes.set_axisbelow(True)
        axes.set_title(title, loc="left", fontsize=9.5, color="#222222", fontweight="bold")
        axes.set_title(unit, loc="right", fontsize=8.5, color="#777777")
        if axes in grid[1]:
            axes.set_xlabel(label)
        handles = [Line2D([], [], color="#444444", linestyle=line, marker=marker, markersize=4, linewidth=1.4,
                          markerfacecolor="#444444" if line == "-" else "white") for line, marker in LINES]
        axes.legend(handles, [name for _, name in columns], fontsize=7.5, frameon=False, loc="best", handlelength=2.6)
        mark_paper(axes, figure, title)
    plot.subplots_adjust(left=0.06, right=0.985, top=0.89 if figure == "primitives" else 0.94, bottom=0.085, hspace=0.32, wspace=0.2)
    if figure == "primitives":
        shown = [sweep for sweep, _ in sweeps]
        plot.legend([Line2D([], [], color=COLOURS[sweep], linewidth=2.5) for sweep in shown],
                    [NAMES[sweep] for sweep in shown], loc="upper left", ncols=2, frameon=False, fontsize=9.5,
                    bbox_to_anchor=(0.045, 1.0))
    save_both(plot, prefix)
    plt.close(plot)


def main():
    if len(sys.argv) < 4 or any(figure not in FIGURES for figure in sys.argv[3:]):
        sys.exit(__doc__)
    _, table, folder, *figures = sys.argv
    for figure in figures:
        draw(read(table, figure), figure, os.path.join(folder, f"scaling-{figure}"))


if __name__ == "__main__":
    main()
