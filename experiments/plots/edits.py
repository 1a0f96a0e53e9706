#!/usr/bin/python3
"""Time of edits in a history against its length, from the table that bench_edits writes.

  edits.py EDITS.csv PICTURE
"""
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from whole_files import save  # noqa: E402

LINES = [("replay_us", "replay from the start", "#555555", "o"), ("goto_us", "goto, ten strokes back", "#3565c4", "s"),
         ("cancel_us", "cancel one stroke", "#cf3b32", "D"), ("undo_us", "undo", "#3f9b57", "^"),
         ("show_us_per_node", "show, each node", "#b08900", "v")]


def main(table: str, picture: str) -> int:
    try:
        with open(table, newline="") as file:
            rows = list(csv.DictReader(file))
        strokes = [int(row["strokes"]) for row in rows]
        if not rows:
            raise KeyError("no rows")
        figure, axes = plt.subplots(figsize=(7, 4.5))
        for column, label, colour, marker in LINES:
            axes.plot(strokes, [float(row[column]) / 1000 for row in rows], color=colour, marker=marker, label=label)
    except (OSError, KeyError, ValueError) as error:
        print(f"edits.py: {table}: {error}, but a table of bench_edits is needed", file=sys.stderr)
        return 2
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("strokes in the history")
    axes.set_ylabel("milliseconds, median")
    axes.set_title("Edits follow what changes; a replay follows the length of the log", fontsize=11)
    axes.grid(True, which="major", alpha=0.4)
    axes.legend(fontsize=9, loc="center left", bbox_to_anchor=(0.02, 0.22))
    figure.tight_layout()
    save(figure, picture, dpi=130)
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(*sys.argv[1:]))
