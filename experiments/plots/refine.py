"""What refinement by references loses, and how long it takes: a figure for each sweep of the refine experiment.

usage: refine.py RESULTS.csv TIMES.csv OUT-FOLDER FIGURE...

FIGURE is lines, zoom, feature, density, additions, thin or time. Writes refine-FIGURE.png and refine-FIGURE.svg into the folder.
Zones of one model are taken together: lengths and counts are summed.
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

# Method: what it is called, colour, line.
METHODS = {"document": ("document", style.OTHER, "-"), "ends": ("ends", style.OURS, "-"),
           "ends-uncorrected": ("ends, uncorrected", style.OURS, ":"), "touching": ("touching", style.RIVAL, "-")}
TIMED = {"document": ("document", style.OTHER, "-"), "ends": ("ends", style.OURS, "-"), "touching": ("touching", style.RIVAL, "-"),
         "clusters": ("clusters", "#8a5a00", "-"), "all": ("all", "#555555", "-"),
         "all-by-bounds": ("all, by bounds, line by line", "#555555", "--"), "all-plain": ("all, plain", "#555555", ":")}
ACROSS = {"lines": "lines along the longest side", "zoom": "zone, % of the volume", "feature": "mean radius, cells",
          "density": "operations that cover a point", "additions": "part of additions", "thin": "thickness, cells"}
FLOOR = 1e-5  # %: what is less, and nothing, stands there
TARGET = 0.02


def plain(value, _=None):
    return style.short(value) if value >= 1e-3 else f"{value:.0e}".replace("e-0", "e-")


def read(path, key, name):
    with open(path, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row[key] == name]
    if not rows:
        sys.exit(f"{path}: no rows of {name}")
    return rows


def pooled(rows, method, part, whole):
    """(value, 100 * sum of parts / sum of wholes), by value."""
    sums = {}
    for row in rows:
        if row["method"] == method:
            entry = sums.setdefault(float(row["value"]), [0.0, 0.0])
            entry[0] += sum(float(row[column]) for column in part)
            entry[1] += float(row[whole])
    return sorted((value, 100 * a / b) for value, (a, b) in sums.items() if b > 0)


def across(axes, sweep, values):
    if sweep != "additions":
        axes.set_xscale("log")
    axes.xaxis.set_major_locator(FixedLocator(sorted(values)))
    factor = 100 if sweep == "zoom" else 1
    axes.xaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{factor * v:g}"))
    axes.xaxis.set_minor_locator(NullLocator())


def draw_loss(rows, sweep, prefix):
    histories = list(dict.fromkeys(row["history"] for row in rows))
    columns, highest = len(histories), 1
    figure, grid = plt.subplots(2, columns, figsize=(max(5.2, 2.05 * columns + 1), 5.0), dpi=160, squeeze=False,
                                sharey="row")
    for column, history in enumerate(histories):
        own = [row for row in rows if row["history"] == history]
        values = {float(row["value"]) for row in own}
        for axes, part, whole in ((grid[0][column], ["missing", "extra"], "reference_length"),
                                  (grid[1][column], ["sides_missed"], "sides")):
            for method, (_, colour, line) in METHODS.items():
                points = [(x, max(y, FLOOR)) for x, y in pooled(own, method, part, whole)]
                if whole == "sides":
                    if method == "ends-uncorrected":
                        continue  # collects what ends does
                    points = pooled(own, method, part, whole)  # a part of a hundred, down to none
                    highest = max([highest] + [y for _, y in points])
                if points:
                    axes.plot(*zip(*points), line, color=colour, linewidth=1.6, marker="o", markersize=3.5, zorder=5, clip_on=False)
            across(axes, sweep, values)
            axes.grid(axis="y", color=style.RULE, linewidth=0.7)
            axes.set_axisbelow(True)
        top, bottom = grid[0][column], grid[1][column]
        top.set_yscale("log")
        top.axhline(TARGET, color=style.SOFT, linestyle=":", linewidth=1)
        top.yaxis.set_major_locator(LogLocator(numticks=12))
        top.yaxis.set_major_formatter(FuncFormatter(plain))
        top.yaxis.set_minor_locator(NullLocator())
        top.set_title(history.replace(", between", ",\nbetween"), loc="left", fontsize=8.5, color=style.INK, fontweight="bold")
        bottom.set_xlabel(ACROSS[sweep], fontsize=8)
        for axes in (top, bottom):
            axes.tick_params(axis="x", labelsize=7.5)
    grid[0][0].set_ylim(FLOOR, 200)
    grid[1][0].set_ylim(0, 1.05 * highest)
    grid[0][0].set_ylabel("wrong length, %")
    grid[1][0].set_ylabel("missed at an end, %")
    figure.tight_layout(rect=(0, 0, 1, 0.94), h_pad=1.2, w_pad=0.8)
    figure.legend([Line2D([], [], color=colour, linestyle=line, linewidth=2.2) for _, colour, line in METHODS.values()],
                  [called for called, _, _ in METHODS.values()], loc="upper left", ncols=4, frameon=False, fontsize=8.5,
                  bbox_to_anchor=(0.01, 1.0))
    save_both(figure, prefix)
    plt.close(figure)


def draw_time(path, prefix):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    growths = list(dict.fromkeys(row["growth"] for row in rows))
    figure, grid = plt.subplots(1, len(growths), figsize=(3.5 * len(growths), 3.9), dpi=160, squeeze=False, sharey=True)
    for axes, growth in zip(grid[0], growths):
        lowest, first = float("inf"), float("inf")
        for method, (_, colour, line) in TIMED.items():
            own = sorted((float(row["operations"]), float(row["seconds_p25"]), float(row["seconds"]), float(row["seconds_p75"]))
                         for row in rows if row["growth"] == growth and row["method"] == method)
            if not own:
                continue
            counts, low, median, high = zip(*own)
            axes.fill_between(counts, low, high, color=colour, alpha=0.15, linewidth=0)
            axes.plot(counts, median, line, color=colour, linewidth=1.6, marker="o", markersize=3.5, zorder=5, clip_on=False)
            lowest, first = min(lowest, *median), min(first, counts[0])
        axes.set_xscale("log")
        axes.set_yscale("log")
        right = max(float(row["operations"]) for row in rows)
        axes.plot([first, right], [lowest, lowest * right / first], ":", color=style.SOFT, linewidth=1, zorder=1)
        axes.xaxis.set_major_locator(LogLocator(numticks=9))
        axes.xaxis.set_major_formatter(FuncFormatter(style.short))
        axes.yaxis.set_major_locator(LogLocator(numticks=12))
        axes.yaxis.set_major_formatter(FuncFormatter(plain))
        axes.minorticks_off()
        axes.grid(axis="y", color=style.RULE, linewidth=0.7)
        axes.set_axisbelow(True)
        axes.set_title(growth, loc="left", fontsize=9.5, color=style.INK, fontweight="bold")
        axes.set_xlabel("operations")
    grid[0][0].set_ylabel("seconds")
    figure.tight_layout(rect=(0, 0, 1, 0.86), w_pad=1)
    figure.legend([Line2D([], [], color=colour, linestyle=line, linewidth=2.2) for _, colour, line in TIMED.values()],
                  [called for called, _, _ in TIMED.values()], loc="upper left", ncols=4, frameon=False, fontsize=8.5,
                  bbox_to_anchor=(0.01, 1.0))
    save_both(figure, prefix)
    plt.close(figure)


def main():
    if len(sys.argv) < 5 or any(name != "time" and name not in ACROSS for name in sys.argv[4:]):
        sys.exit(__doc__)
    _, results, times, folder, *names = sys.argv
    for name in names:
        prefix = os.path.join(folder, f"refine-{name}")
        if name == "time":
            draw_time(times, prefix)
        else:
            draw_loss(read(results, "sweep", name), name, prefix)


if __name__ == "__main__":
    main()
