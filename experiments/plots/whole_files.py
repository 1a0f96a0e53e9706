"""Pictures that are there whole or not at all."""

import os


def save(figure, path, **options):
    """Writes the figure beside its final name and renames it; `options` are those of Figure.savefig."""
    part = f"{path}.tmp-{os.getpid()}"
    try:
        figure.savefig(part, format=os.path.splitext(path)[1][1:], **options)
        os.replace(part, path)
    finally:
        if os.path.exists(part):
            os.remove(part)


def save_both(figure, prefix):
    """PREFIX.png and PREFIX.svg, the second without a date: the same figure gives the same file."""
    save(figure, f"{prefix}.png")
    save(figure, f"{prefix}.svg", metadata={"Date": None})
