"""Figure 1 of "Free Form Shape Modelling by Hand Movement in Virtual Environment": a disc as voxels, as dexels along one
axis, and with dexels along two.

usage: figure1.py SLICE.csv OUT-PREFIX

SLICE.csv is a plane through a real model (experiments/dexel/slice.h). Writes OUT-PREFIX.png and OUT-PREFIX.svg. In the
second and third panel the parts of the circle that are farther than a cell from any end are bold.
"""

import csv
import math
import sys

import style

style.use(11)
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import LineCollection, PatchCollection  # noqa: E402
from matplotlib.patches import Circle, Rectangle  # noqa: E402

from whole_files import save_both  # noqa: E402

FILL, EDGE = "#c9d8ea", "#7f9cc0"
FAR = 1.0  # cells
STEPS = 2880


def read(path):
    table = {}
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            table.setdefault(row["kind"], []).append(tuple(float(row[c]) for c in ("x0", "y0", "x1", "y1")))
    return table


def ends_of(spans):
    return [point for x0, y0, x1, y1 in spans for point in ((x0, y0), (x1, y1))]


def bare_arcs(disc, ends, cell):
    """Runs of the circle that are far from every end, as lists of points."""
    x, y, radius = disc
    around = [(x + radius * math.cos(2 * math.pi * i / STEPS), y + radius * math.sin(2 * math.pi * i / STEPS))
              for i in range(STEPS)]
    far = [min(math.dist(p, end) for end in ends) > FAR * cell for p in around]
    if all(far):
        return [around + around[:1]]
    start = far.index(False)  # so that no run goes over the seam
    runs, run = [], []
    for i in range(start, start + STEPS):
        if far[i % STEPS]:
            run.append(around[i % STEPS])
        elif run:
            runs.append(run)
            run = []
    return runs + ([run] if run else [])


def grid_lines(axes, table, cell):
    _, (columns, rows) = table["cells"][0][0], table["cells"][0][2:]
    x, y = table["disc"][0][:2]
    left, low = x - columns * cell / 2, y - rows * cell / 2
    lines = [[(left + i * cell, low), (left + i * cell, low + rows * cell)] for i in range(int(columns) + 1)]
    lines += [[(left, low + i * cell), (left + columns * cell, low + i * cell)] for i in range(int(rows) + 1)]
    axes.add_collection(LineCollection(lines, colors="#e4e4e4", linewidths=0.6, zorder=1))


def outline(axes, table):
    x, y, radius, _ = table["disc"][0]
    axes.add_patch(Circle((x, y), radius, fill=False, edgecolor=style.INK, linewidth=1.4, zorder=6))


def bold(axes, table, ends, cell):
    x, y, radius, _ = table["disc"][0]
    arcs = bare_arcs((x, y, radius), ends, cell)
    axes.add_collection(LineCollection(arcs, colors=style.OURS, linewidths=4.5, capstyle="butt", zorder=7))


def dots(axes, points):
    axes.plot(*zip(*points), "o", color=style.INK, markersize=3.6, markeredgewidth=0, zorder=9)


def voxels(axes, table, cell):
    grid_lines(axes, table, cell)
    patches = [Rectangle((x0, y0), x1 - x0, y1 - y0) for x0, y0, x1, y1 in table["cell"]]
    axes.add_collection(PatchCollection(patches, facecolor=FILL, edgecolor=EDGE, linewidth=0.8, zorder=3))
    outline(axes, table)
    return f"{len(patches)} voxels inside"


def one_family(axes, table, cell):
    patches = [Rectangle((x0 - cell / 2, y0), cell, y1 - y0) for x0, y0, _, y1 in table["column"]]
    axes.add_collection(PatchCollection(patches, facecolor=FILL, edgecolor=EDGE, linewidth=0.8, zorder=3))
    axes.add_collection(LineCollection([[(x0, y0), (x1, y1)] for x0, y0, x1, y1 in table["column"]], colors=EDGE,
                                       linewidths=0.8, linestyles=(0, (4, 2)), zorder=4))
    ends = ends_of(table["column"])
    outline(axes, table)
    bold(axes, table, ends, cell)
    dots(axes, ends)
    return f"{len(table['column'])} dexels, {len(ends)} ends"


def two_families(axes, table, cell):
    spans = table["column"] + table["row"]
    axes.add_patch(Circle(table["disc"][0][:2], table["disc"][0][2], facecolor="#eef3f9", edgecolor="none", zorder=2))
    axes.add_collection(LineCollection([[(x0, y0), (x1, y1)] for x0, y0, x1, y1 in spans], colors=style.RIVAL,
                                       linewidths=0.9, zorder=4))
    ends = ends_of(spans)
    outline(axes, table)
    bold(axes, table, ends, cell)
    dots(axes, ends)
    # Ends keep the surface's normal.
    normals = [[(x, y), (x + 0.55 * cell * nx, y + 0.55 * cell * ny)] for x, y, nx, ny in table["end"]]
    axes.add_collection(LineCollection(normals, colors=style.INK, linewidths=0.7, zorder=8))
    return f"{len(spans)} dexels, {len(ends)} ends with normals"


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    _, path, prefix = sys.argv
    table = read(path)
    cell = table["cells"][0][0]
    x, y, radius, _ = table["disc"][0]
    reach = radius + 1.1 * cell
    figure, panels = plt.subplots(1, 3, figsize=(11.4, 4.45), dpi=160)
    for axes, letter, title, draw in zip(panels, "abc", ("voxels", "dexels along one axis", "dexels along two axes"),
                                         (voxels, one_family, two_families)):
        below = draw(axes, table, cell)
        axes.set_xlim(x - reach, x + reach)
        axes.set_ylim(y - reach, y + reach)
        axes.set_aspect("equal")
        axes.set_axis_off()
        axes.text(0.5, -0.035, f"({letter})  {title}", transform=axes.transAxes, ha="center", va="top", fontsize=12.5,
                  color=style.INK)
        axes.text(0.5, -0.115, below, transform=axes.transAxes, ha="center", va="top", fontsize=10, color=style.SOFT)
    figure.subplots_adjust(left=0.005, right=0.995, top=0.995, bottom=0.135, wspace=0.02)
    save_both(figure, prefix)
    plt.close(figure)


if __name__ == "__main__":
    main()
