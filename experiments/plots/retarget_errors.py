"""Error of every method against the strength of every change.

usage: retarget_errors.py RESULTS.csv GROUP OUT-PREFIX

Reads the rows of one group of bases ("(telling)" or "(symmetric)", or one base) from the retargeting experiment's table
and writes PREFIX.png and PREFIX.svg: a panel for each change, a line for each method.
"""

import csv
import sys

import style

style.use(9)
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.ticker import NullFormatter, NullLocator  # noqa: E402

from whole_files import save_both  # noqa: E402

# Method: colour, line, marker, width. What only looks is blue, what follows the surface green, what follows motions red.
STYLES = {
    "fixed": ("#888888", "-", "x", 1.4),
    "nearest": ("#b58900", "-", "v", 1.4),
    "depth-cpu": ("#1f5fa8", ":", "s", 1.2),
    "depth": ("#6c9bd2", "--", "d", 1.2),
    "embree": ("#12355b", "-.", "^", 1.2),
    "exact": ("#1f5fa8", "-", "o", 1.8),
    "surface": ("#2e7d4f", "-", "D", 1.6),
    "mapped": ("#333333", "--", "P", 1.4),
    "aligned": ("#b3261e", "-", "o", 2.2),
}
# Smaller errors, and none, are drawn at the panel's foot. float32 rounds to about as much.
FLOOR = 1e-8
TICKS = {1e-8: "1e-6 %", 1e-6: "0.0001 %", 1e-4: "0.01 %", 1e-2: "1 %", 1: "100 %"}


def read(path, group):
    panels = {}
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["base"] != group:
                continue
            panel = panels.setdefault(row["change"], {"unit": row["unit"], "lines": {}})
            if row["median_rms"]:
                panel["lines"].setdefault(row["method"], []).append(
                    (float(row["strength"]), max(float(row["median_rms"]), FLOOR)))
    if not panels:
        sys.exit(f"{path}: no rows of {group}")
    return panels


def draw(panels, prefix):
    columns = min(3, len(panels))
    rows = -(-len(panels) // columns)
    figure, grid = plt.subplots(rows, columns, figsize=(3.3 * columns + 0.6, 2.7 * rows + 0.7), dpi=160, sharey=True,
                                squeeze=False)
    used = set()
    for axes, (change, panel) in zip(grid.flat, panels.items()):
        strengths = sorted({x for line in panel["lines"].values() for x, _ in line})
        # Strengths are a ladder, not a scale: steps of equal width.
        place = {strength: i for i, strength in enumerate(strengths)}
        for method, (colour, line, marker, width) in STYLES.items():
            points = sorted(panel["lines"].get(method, []))
            if not points:
                continue
            used.add(method)
            axes.plot([place[x] for x, _ in points], [y for _, y in points], line, color=colour, linewidth=width,
                      marker=marker, markersize=4, markerfacecolor=colour if line == "-" else "white",
                      zorder=6 if method == "aligned" else 4, clip_on=False)
        axes.set_yscale("log")
        axes.set_ylim(FLOOR, 20)
        axes.set_xticks(range(len(strengths)), [f"{x:g}" for x in strengths])
        axes.set_xlim(-0.25, len(strengths) - 0.75)
        axes.set_yticks(list(TICKS), list(TICKS.values()))
        axes.yaxis.set_minor_locator(NullLocator())
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.grid(axis="y", color="#dddddd", linewidth=0.7)
        axes.set_axisbelow(True)
        axes.set_title(change, loc="left", fontsize=9.5, color="#222222", fontweight="bold")
        axes.set_title(panel["unit"], loc="right", fontsize=8.5, color="#777777")
    for axes in list(grid.flat)[len(panels):]:
        axes.set_visible(False)
    handles = [Line2D([], [], color=STYLES[m][0], linestyle=STYLES[m][1], marker=STYLES[m][2], linewidth=STYLES[m][3],
                      markersize=4, markerfacecolor=STYLES[m][0] if STYLES[m][1] == "-" else "white")
               for m in STYLES if m in used]
    height = figure.get_figheight()
    figure.subplots_adjust(left=0.62 / figure.get_figwidth() + 0.02, right=0.99, top=1 - 0.62 / height, bottom=0.32 / height,
                           hspace=0.42, wspace=0.08)
    figure.legend(handles, [m for m in STYLES if m in used], loc="upper left", ncols=min(len(used), 9), frameon=False,
                  fontsize=9, handlelength=2.2, columnspacing=1.2, bbox_to_anchor=(0.0, 1.0))
    save_both(figure, prefix)
    plt.close(figure)


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    _, table, group, prefix = sys.argv
    draw(read(table, group), prefix)


if __name__ == "__main__":
    main()
