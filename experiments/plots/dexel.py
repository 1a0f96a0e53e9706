"""Voxels, one family of dexels and three: memory and error against resolution, a figure for each solid.

usage: dexel.py RESULTS.csv OUT-FOLDER SOLID...

Reads the dexel experiment's table and writes dexel-SOLID.png and dexel-SOLID.svg into the folder. All axes are logarithmic.
"""

import csv
import os
import sys

import style

style.use(9)
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullLocator  # noqa: E402

from whole_files import save_both  # noqa: E402

# Name in the table: what it is called, colour.
STYLES = {"voxels": ("voxels", style.RIVAL), "one-family": ("one family of dexels", style.OTHER),
          "three-families": ("three families", style.OURS)}
FLOOR = 1e-6  # cells: as small as rounding makes them; smaller ones, and none, are drawn there
# Title, unit, what stands across, columns with what each is called (the first is drawn whole, the others broken).
PANELS = [
    ("memory", "bytes", "resolution", [("bytes", "as they are"), ("bytes_without_operations", "without operations")]),
    ("volume on the wrong side", "% of the solid", "resolution", [("wrong_percent", None)]),
    ("the same by memory", "% of the solid", "bytes", [("wrong_percent", None)]),
    ("from surface to element", "cells", "resolution", [("coverage_max_cells", "most"), ("coverage_mean_cells", "mean")]),
    ("from surface to element", "model units", "resolution", [("coverage_max", "most"), ("coverage_mean", "mean")]),
    ("from element to surface", "cells", "resolution", [("accuracy_max_cells", "most"), ("accuracy_mean_cells", "mean")]),
]
LINES = ["-", "--"]


def plain(value, _=None):
    """0.01, 1, 10k; of small ones the power."""
    return style.short(value) if value >= 1e-3 else f"{value:.0e}".replace("e-0", "e-")



def read(path, solid):
    series = {}
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["source"] == solid:
                row["wrong_percent"] = 100 * float(row["wrong_volume"])
                series.setdefault(row["representation"], []).append(row)
    if not series:
        sys.exit(f"{path}: no rows of {solid}")
    return series


def draw(series, prefix):
    figure, grid = plt.subplots(2, 3, figsize=(10.4, 6.2), dpi=160)
    for axes, (title, unit, across, columns) in zip(grid.flat, PANELS):
        values = []
        for name, (_, colour) in STYLES.items():
            for (column, _), line in zip(columns, LINES):
                rows = [row for row in series.get(name, []) if row[column] != ""]
                points = sorted((float(row[across]), max(float(row[column]), FLOOR)) for row in rows)
                if not points:
                    continue
                axes.plot(*zip(*points), line, color=colour, linewidth=1.8 if line == "-" else 1.2, marker="o", markersize=4,
                          markerfacecolor=colour if line == "-" else "white", zorder=6 if name == "three-families" else 4,
                          clip_on=False)
                values += [y for _, y in points]
        axes.set_xscale("log")
        axes.set_yscale("log")
        # At least two decades: what is flat must look flat.
        middle = (max(values) * min(values)) ** 0.5
        axes.set_ylim(min(min(values) / 1.6, middle / 10), max(max(values) * 1.6, middle * 10))
        if across == "resolution":
            resolutions = sorted({int(row["resolution"]) for rows in series.values() for row in rows})
            axes.xaxis.set_major_locator(FixedLocator(resolutions))
            axes.xaxis.set_major_formatter(FuncFormatter(lambda n, _: f"{n:g}"))
        else:
            axes.xaxis.set_major_locator(LogLocator(numticks=9))
            axes.xaxis.set_major_formatter(FuncFormatter(style.short))
        axes.yaxis.set_major_locator(LogLocator(numticks=9))
        axes.yaxis.set_major_formatter(FuncFormatter(plain))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.yaxis.set_minor_locator(NullLocator())
        axes.grid(axis="y", color=style.RULE, linewidth=0.7)
        axes.set_axisbelow(True)
        axes.set_title(title, loc="left", fontsize=9.5, color=style.INK, fontweight="bold")
        axes.set_title(unit, loc="right", fontsize=8.5, color=style.SOFT)
        axes.set_xlabel("points along the longest side" if across == "resolution" else across)
        if len(columns) > 1:
            handles = [Line2D([], [], color="#444444", linestyle=line, marker="o", markersize=4, linewidth=1.4,
                              markerfacecolor="#444444" if line == "-" else "white") for line in LINES]
            axes.legend(handles, [called for _, called in columns], fontsize=7.5, frameon=False, loc="best",
                        handlelength=2.6)
    figure.subplots_adjust(left=0.06, right=0.985, top=0.885, bottom=0.085, hspace=0.42, wspace=0.22)
    figure.legend([Line2D([], [], color=colour, linewidth=2.5) for _, colour in STYLES.values()],
                  [called for called, _ in STYLES.values()], loc="upper left", ncols=3, frameon=False, fontsize=9.5,
                  bbox_to_anchor=(0.045, 1.0))
    save_both(figure, prefix)
    plt.close(figure)


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    _, table, folder, *solids = sys.argv
    for solid in solids:
        draw(read(table, solid), os.path.join(folder, f"dexel-{solid}"))


if __name__ == "__main__":
    main()
