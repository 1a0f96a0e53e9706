"""How figures look. Import it before matplotlib.pyplot: figures are drawn without a display."""

import matplotlib

matplotlib.use("Agg")

# Ours is drawn strongest, rivals recede.
OURS = "#b3261e"
RIVAL = "#1f5fa8"
OTHER = "#2e7d4f"
INK = "#222222"
SOFT = "#777777"
RULE = "#dddddd"


def use(font_size):
    matplotlib.rcParams.update({
        "svg.hashsalt": "restroke",  # the same figure gives the same file
        "svg.fonttype": "none",
        "font.family": "DejaVu Sans",
        "font.size": font_size,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.edgecolor": "#555555",
        "axes.labelcolor": INK,
        "xtick.color": "#444444",
        "ytick.color": "#444444",
    })


def short(value, _=None):
    """12000 as 12k; for tick labels."""
    for unit, size in (("G", 1e9), ("M", 1e6), ("k", 1e3)):
        if value >= size:
            return f"{value / size:g}{unit}"
    return f"{value:g}"
