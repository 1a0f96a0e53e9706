#!/usr/bin/python3
"""Checks every #include "..." of the tree against the order of its folders, and that headers stand alone.

implicit <- points <- retarget <- sculpt <- experiments: a folder includes itself and what stands to its left. tests
include everything, and nothing else includes tests. Ours is included with quotes, from the root, and exists; what is
not ours is included with angle brackets.

A header begins with #pragma once, apart from comments. a.cpp includes a.h, where there is one beside it, before all
else: so it shows that a.h names what it needs (the build compiles only the other headers alone).

    layering.py ROOT     prints each offence as FILE:LINE: SENTENCE; exit 0 without any, 1 with some, 2 on bad usage
"""

import re
import sys
from pathlib import Path

ORDER = ["implicit", "points", "retarget", "sculpt", "experiments", "tests"]
# Headers that the build makes, each with the folder that makes it and alone includes it.
GENERATED = {"experiments_revision.h": "experiments"}
SUFFIXES = {".h", ".hpp", ".inc", ".inl", ".c", ".cc", ".cpp"}
INCLUDE = re.compile(r'^\s*#\s*(?:include|include_next|import)\s*(["<])([^">]+)[">]')


def offence(root: Path, folder: str, quote: str, target: str) -> str | None:
    """The sentence about one include in `folder`, or None when it is allowed."""
    if quote == '"' and GENERATED.get(target) == folder:
        return None
    first, *rest = target.split("/")
    ours = first in ORDER and bool(rest) and not {"", ".", ".."} & set(rest)
    if quote == "<":
        return f"<{target}> is ours: include it with quotes" if ours else None
    if not ours:
        return f'"{target}" is not given from the root (ours), or wants angle brackets (not ours)'
    if not (root / target).is_file():
        return f'"{target}" does not exist'
    if ORDER.index(first) > ORDER.index(folder):
        return f'"{target}" stands to the right of {folder}/ in {" <- ".join(ORDER)}'
    return None


def opening(root: Path, path: Path, lines: list[str]) -> tuple[int, str] | None:
    """The line and the sentence about how a file begins, or None when it begins as it should."""
    if path.suffix == ".h":
        begins = ((number, line) for number, line in enumerate(lines, start=1) if line.strip() and not line.startswith("//"))
        number, line = next(begins, (1, ""))
        return None if line == "#pragma once" else (number, "a header begins with #pragma once")
    own = path.with_suffix(".h")
    if path.suffix != ".cpp" or not own.is_file():
        return None
    directives = ((number, line) for number, line in enumerate(lines, start=1) if line.lstrip().startswith("#"))
    number, line = next(directives, (1, ""))
    target = own.relative_to(root).as_posix()
    match = INCLUDE.match(line)
    return None if match and match[2] == target else (number, f'"{target}", its own header, is to be included first')


def sources(root: Path) -> list[tuple[str, Path]]:
    """Every source file with the top-level folder that it stands in, in the order of their names."""
    return [
        (folder, path)
        for folder in ORDER
        for path in sorted((root / folder).rglob("*"))
        if path.suffix in SUFFIXES and path.is_file()
    ]


def offences(root: Path) -> list[str]:
    """All offences below `root`, as FILE:LINE: SENTENCE."""
    found = []
    for folder, path in sources(root):
        lines = path.read_text(encoding="utf-8").splitlines()
        begun = opening(root, path, lines)
        if begun:
            found.append(f"{path.relative_to(root)}:{begun[0]}: {begun[1]}")
        for number, line in enumerate(lines, start=1):
            match = INCLUDE.match(line)
            sentence = match and offence(root, folder, match[1], match[2])
            if sentence:
                found.append(f"{path.relative_to(root)}:{number}: {sentence}")
    return found


def main(arguments: list[str]) -> int:
    if len(arguments) != 1 or not Path(arguments[0]).is_dir():
        print("usage: layering.py ROOT", file=sys.stderr)
        return 2
    root = Path(arguments[0])
    if not sources(root):
        print(f"layering.py: {root} holds no sources: wrong folder?", file=sys.stderr)
        return 2
    found = offences(root)
    for line in found:
        print(line)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
