"""Figure 12 of "Stroke history management for digital sculpting": bytes of history against steps.

usage: figure12.py RESULTS.csv LOG OUT-PREFIX

Reads the rows of one log from the memory experiment's table and writes PREFIX-linear.png, PREFIX-linear.svg,
PREFIX-log.png and PREFIX-log.svg. The linear figure holds what the paper's has: strokes and snapshots of the list.
The logarithmic one holds everything.
"""

import csv
import sys

import style

style.use(10.5)
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import FuncFormatter, MaxNLocator  # noqa: E402

from whole_files import save_both  # noqa: E402

# name in the table: label, colour, line, marker. Ours is drawn strongest; what the paper counts is dashed.
STYLES = {
    "strokes": ("strokes, measured", "#b3261e", "-", "o"),
    "strokes-paper": ("strokes, 304 + 12 n", "#b3261e", "--", "s"),
    "list-snapshots": ("list snapshots, measured", "#1f5fa8", "-", "o"),
    "list-snapshots-paper": ("list snapshots, 48 n", "#1f5fa8", "--", "s"),
    "surfel-snapshots": ("surfel snapshots", "#333333", "-", "^"),
    "surfel-deltas": ("surfel deltas", "#2e7d4f", "-", "D"),
    "surfel-deltas-zstd": ("surfel deltas, zstd", "#2e7d4f", ":", "D"),
    "dexel-deltas": ("tri-dexel lines", "#8a5a00", "-", "v"),
}
IN_PAPER = ["strokes", "strokes-paper", "list-snapshots", "list-snapshots-paper"]


def with_unit(value, _=None):
    for unit, size in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if value >= size:
            return f"{value / size:g} {unit}"
    return f"{value:g} B"


def read(path, log):
    series = {}
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["log"] == log and int(row["step"]) > 0:
                series.setdefault(row["backend"], []).append((int(row["step"]), int(row["bytes"])))
    if not series:
        sys.exit(f"{path}: no rows of {log}")
    return series


def spread(places, gap):
    """Moves label places apart, to at least `gap`, keeping their order and their middle as well as may be."""
    order = sorted(range(len(places)), key=lambda i: places[i])
    out = [places[i] for i in order]
    for _ in range(200):
        for a in range(len(out) - 1):
            lack = gap - (out[a + 1] - out[a])
            if lack > 1e-9:
                out[a] -= lack / 2
                out[a + 1] += lack / 2
    result = [0.0] * len(places)
    for place, i in zip(out, order):
        result[i] = place
    return result


def draw(series, names, logarithmic, title, prefix):
    figure, axes = plt.subplots(figsize=(8.4, 4.7), dpi=160)
    steps = max(point[0] for name in names for point in series[name])
    marked = steps <= 20
    for name in names:
        label, colour, line, marker = STYLES[name]
        xs, ys = zip(*series[name])
        axes.plot(xs, ys, line, color=colour, linewidth=2.2 if name == "strokes" else 1.5, marker=marker if marked else "",
                  markersize=4.5, markerfacecolor=colour if line == "-" else "white", clip_on=False,
                  zorder=5 if name == "strokes" else 4)
    if logarithmic:
        axes.set_yscale("log")
    else:
        axes.set_ylim(0, None)
    axes.yaxis.set_major_formatter(FuncFormatter(with_unit))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlim(1 - 0.02 * steps, steps)
    axes.set_xlabel("step")
    axes.set_title("bytes of history held after each step" + (", logarithmic" if logarithmic else ""), loc="left",
                   fontsize=10.5, color="#222222")
    axes.set_title(title, loc="right", fontsize=9.5, color="#777777")
    axes.grid(axis="y", color="#dddddd", linewidth=0.8)
    axes.set_axisbelow(True)
    # Names stand at the ends of their lines, in the line's colour: no legend to look up.
    figure.subplots_adjust(left=0.1, right=0.7, top=0.92, bottom=0.12)
    figure.canvas.draw()
    to_axes = axes.transData + axes.transAxes.inverted()
    ends = [to_axes.transform((steps, series[name][-1][1]))[1] for name in names]
    for name, end, place in zip(names, ends, spread(ends, 0.062)):
        label, colour, line, _ = STYLES[name]
        axes.annotate(f"{label}  ", xy=(1.0, end), xytext=(1.05, place), xycoords="axes fraction", color=colour,
                      va="center", fontsize=9.5, annotation_clip=False,
                      arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.6, "shrinkA": 1, "shrinkB": 2})
    kind = "log" if logarithmic else "linear"
    save_both(figure, f"{prefix}-{kind}")
    plt.close(figure)


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    _, table, log, prefix = sys.argv
    series = read(table, log)
    names = [name for name in STYLES if name in series]
    draw(series, [name for name in names if name in IN_PAPER], False, log, prefix)
    draw(series, names, True, log, prefix)


if __name__ == "__main__":
    main()
