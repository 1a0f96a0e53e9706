#!/usr/bin/python3
"""Compares what several builds of restroke make of the same logs, at 1 and at 2 threads.

    state_hashes.py [--shared DIR] NAME=PROGRAM...

Replays every log of experiments/examples and, where DIR is there, its stamp lists and its pen strokes (imported first;
the logs that the builds make must be the same, byte for byte). All builds must agree in state_hash, primitives, strokes
and surfels. Exit 1 when something differs. (tests/determinism compares with hashes that are written down.)
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
KEYS = ("state_hash", "primitives", "strokes", "surfels")
THREADS = (1, 2)


class Differs(Exception):
    """One sentence: what differs from what."""


def call(program: Path, *arguments) -> int:
    """Runs `program`; its exit status when that is 0 or 2 (bad input), else an error with what it said."""
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode not in (0, 2):
        raise Differs(f"{program} {' '.join(map(str, arguments))}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    return done.returncode


def replay(program: Path, log: Path, threads: int, scratch: Path, *options) -> tuple:
    """The values of KEYS after a replay."""
    report = scratch / "replay.json"
    report.unlink(missing_ok=True)
    if call(program, "replay", log, "--threads", threads, "--json", report, *options) != 0:
        raise Differs(f"{program} refuses {log}")
    values = json.loads(report.read_text(encoding="utf-8"))
    return tuple(values[key] for key in KEYS)


def agreed(programs: dict[str, Path], log: Path, scratch: Path, *options) -> tuple:
    """What every program says about `log` at every number of threads; an error when they do not say the same."""
    said = {}
    for name, program in programs.items():
        for threads in THREADS:
            # The comparison with from-scratch is made once; it is the same question in every build.
            check = ["--check"] if not said else []
            said[f"{name}, {threads} threads"] = replay(program, log, threads, scratch, *options, *check)
    if len(set(said.values())) != 1:
        lines = "".join(f"\n    {who}: {dict(zip(KEYS, values))}" for who, values in said.items())
        raise Differs(f"{log.name}: the builds do not agree{lines}")
    return next(iter(said.values()))


def imported(programs: dict[str, Path], strokes: Path, scratch: Path) -> Path | None:
    """The log of pen strokes, the same from every program; None when every program refuses them."""
    logs = {}
    for name, program in programs.items():
        log = scratch / f"{strokes.stem}-{name}.log"
        accepted = call(program, "import", strokes, "--out", log) == 0
        logs[name] = log.read_bytes() if accepted else None
    if len(set(logs.values())) != 1:
        raise Differs(f"{strokes.name}: the builds import it differently")
    return log if accepted else None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shared", type=Path, metavar="DIR")
    parser.add_argument("programs", nargs="+", metavar="NAME=PROGRAM")
    options = parser.parse_args()
    programs = {name: Path(path).resolve() for name, _, path in (word.partition("=") for word in options.programs)}

    examples = sorted((ROOT / "experiments/examples").glob("*.log"))
    if not examples:
        print("no example logs", file=sys.stderr)
        return 1
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder)
        jobs = [(log.name, log, ()) for log in examples]
        if options.shared and options.shared.is_dir():
            # 14,000 is the density at which this list has the paper's number of points.
            jobs += [(f.name, f, ("--density", 14000)) for f in sorted((options.shared / "data/stamps").glob("*.stamps"))]
            jobs += [(f.name, f, None) for f in sorted((options.shared / "data/strokes").glob("*.json"))]
        for name, log, arguments in jobs:
            try:
                if arguments is None:
                    log, arguments = imported(programs, log, scratch), ()
                    if log is None:
                        print(f"{name}: refused by every build")
                        continue
                print(name, *agreed(programs, log, scratch, *arguments))
            except Differs as difference:
                failures.append(str(difference))

    for failure in failures:
        print(failure, file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
