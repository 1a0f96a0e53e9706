#!/usr/bin/python3
"""Counts the instructions of the core's operations (callgrind) and compares them with what is recorded.

    instruction_counts.py --program BUILD/bin/bench_instructions [--recorded FILE] [--record] [--list LOG]
                          [--skip-unless COMPILER]

Exit 0: no count has grown by more than 3 %; 1: one has; 2: bad usage, or the program failed; 77 (ctest: skipped):
valgrind is missing, or --skip-unless names another compiler than the record. Counts of another compiler or build type
than the recorded one are printed, and never fail.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ALLOWED_GROWTH = 0.03
SKIPPED = 77
# valgrind knows no AVX-512.
SIMD = "avx2"
# What bench_instructions reports, and what one of each is.
OPERATIONS = [
    ("stamp", "one stamp of a replay"),
    ("undo", "undo of one stroke in the middle"),
    ("rebuild", "rebuild of everything, 1 thread"),
    ("ray", "one exact ray on the list"),
    ("picture", "1280 x 720, surfels laid out and drawn, 1 sample, 1 thread"),
]


class Failure(Exception):
    """A sentence for the user; exit 2."""


class Skip(Exception):
    """Why nothing can be counted here; exit 77."""


def callgrind(program: Path, arguments: list[str], folder: Path) -> str:
    """Runs the program under callgrind, whose dumps go to `folder`; returns what the program prints."""
    command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out", "--instr-atstart=no",
               "--collect-atstart=no", str(program), *arguments]
    environment = {**os.environ, "RESTROKE_SIMD": SIMD}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        last = (done.stderr.strip() or "it said nothing").splitlines()[-1]
        raise Failure(f"{program.name} under valgrind ended with {done.returncode}: {last}")
    return done.stdout


def instructions_of(folder: Path) -> dict[str, int]:
    """Instructions by operation: each is reported by a dump of its own."""
    found = {}
    for dump in folder.glob("out.*"):
        text = dump.read_text(encoding="utf-8", errors="replace")
        trigger = re.search(r"^desc: Trigger: Client Request: (\w+)$", text, re.MULTILINE)
        totals = re.search(r"^totals: (\d+)", text, re.MULTILINE)
        if trigger and totals:
            found[trigger[1]] = int(totals[1])
    return found


def count(program: Path, arguments: list[str]) -> tuple[str, dict[str, float]]:
    """The compiler of the program, and instructions per operation by name."""
    with tempfile.TemporaryDirectory(prefix="restroke-callgrind-") as folder:
        printed = callgrind(program, arguments, Path(folder))
        instructions = instructions_of(Path(folder))
    built = re.search(r"^built by (.+); simd (\w+); (.+)$", printed, re.MULTILINE)
    if not built or built[2] != SIMD:
        raise Skip(f"{program.name} did not run with {SIMD}: the processor lacks it")
    if built[3] != "tells callgrind":
        raise Skip(f"{program.name} was {built[3]}: install valgrind, and compile it again")
    counts = {}
    for name, _ in OPERATIONS:
        times = re.search(rf"^{name} (\d+)$", printed, re.MULTILINE)
        if not times or not int(times[1]) or not instructions.get(name):
            raise Failure(f"callgrind counted nothing for '{name}'")
        counts[name] = instructions[name] / int(times[1])
    return built[1], counts


def read_record(file: Path) -> tuple[str, dict[str, float]]:
    """The recorded compiler, and instructions per operation by name."""
    compiler, counts = "", {}
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), start=1):
        if line.startswith("compiler "):
            compiler = line.removeprefix("compiler ")
        elif line and not line.startswith("#"):
            try:
                name, value = line.split()
                counts[name] = float(value)
            except ValueError:
                raise Failure(f"{file}:{number}: '{line}'; a line is a name and a count") from None
    return compiler, counts


def write_record(file: Path, compiler: str, counts: dict[str, float]) -> None:
    """Replaces the record."""
    lines = ["# Instructions per operation (callgrind, AVX2), on experiments/examples/paper-scale.log at density 14000.",
             "# Made by: tests/bench/instructions --record", f"compiler {compiler}"]
    lines += [f"{name} {counts[name]:.1f}" for name, _ in OPERATIONS]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")


def compare(counts: dict[str, float], recorded: dict[str, float], binding: bool) -> bool:
    """Prints a table; whether all is well."""
    well = True
    print(f"{'operation':<10}{'instructions':>16}{'recorded':>16}{'change':>10}")
    for name, what in OPERATIONS:
        before = recorded.get(name)
        change = counts[name] / before - 1 if before else None
        shown = (f"{before:>16,.0f}{100 * change:>+9.2f}%" if before else f"{'-':>16}{'-':>10}")
        grown = binding and (change is None or change > ALLOWED_GROWTH)
        well = well and not grown
        print(f"{name:<10}{counts[name]:>16,.0f}{shown}  {what}{'  HAS GROWN' if grown else ''}")
    return well


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="instruction_counts.py", description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, required=True, help="bench_instructions")
    parser.add_argument("--recorded", type=Path, default=Path(__file__).with_name("instructions.txt"))
    parser.add_argument("--record", action="store_true", help="write the counts instead of comparing them")
    parser.add_argument("--list", help="another log or stamp list; then nothing is compared")
    parser.add_argument("--skip-unless", metavar="COMPILER", help="what built the program; skip unless it is recorded")
    options = parser.parse_args(arguments)
    if options.record and options.list:
        raise Failure("--record is for the list that ships: leave --list out")
    if shutil.which("valgrind") is None:
        raise Skip("valgrind is not installed (tests/bench/instructions installs it)")
    if options.skip_unless and options.skip_unless != read_record(options.recorded)[0]:
        raise Skip(f"built by {options.skip_unless}; the record is of {read_record(options.recorded)[0]}")
    compiler, counts = count(options.program, [options.list] if options.list else [])
    if options.record:
        write_record(options.recorded, compiler, counts)
        print(f"recorded in {options.recorded}")
        return 0
    recorded_compiler, recorded = read_record(options.recorded)
    binding = compiler == recorded_compiler and not options.list
    well = compare(counts, {} if options.list else recorded, binding)
    if not binding and not options.list:
        print(f"built by {compiler}; the record is of {recorded_compiler}: compared, but not a failure")
    if not well:
        print(f"A count has grown by more than {100 * ALLOWED_GROWTH:.0f} %. Where it is meant: tests/bench/instructions "
              "--record")
    return 0 if well else 1


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except Skip as reason:
        print(f"skipped: {reason}")
        sys.exit(SKIPPED)
    except (Failure, OSError) as error:
        print(f"instruction_counts.py: {error}", file=sys.stderr)
        sys.exit(2)
