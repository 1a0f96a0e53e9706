"""State hashes of logs, against those that are written down (SPEC X1, DESIGN invariant 5).

  state_hashes.py RESTROKE SOURCE_DIR SHARED_DIR            compare, for every SIMD level and 1, 2 and 8 threads
  state_hashes.py RESTROKE SOURCE_DIR SHARED_DIR --write    write them down anew

Every compiler, build type, sanitizer and Debian runs this same test, so all of them agree. Logs of the shared folder are left out where it is absent.
"""
import itertools
import json
import os
import subprocess
import sys
import tempfile

SIMD_LEVELS = ["sse2", "avx2", "avx512"]


def sources(source_dir, shared_dir):
    """Name -> a log to replay, a stroke file to import first, or a log and the number of its lines to replay."""
    out = {}
    examples = os.path.join(source_dir, "experiments", "examples")
    for name in sorted(os.listdir(examples)):
        if name.endswith(".log"):
            out["examples/" + name] = ("replay", os.path.join(examples, name))
    with open(os.path.join(examples, "figure10-stages.txt"), encoding="utf-8") as f:
        for stage, lines, *_ in (line.split() for line in f if not line.startswith("#")):
            out["examples/figure10.log(%s)" % stage] = ("lines", os.path.join(examples, "figure10.log"), int(lines))
    strokes = os.path.join(shared_dir, "data", "strokes")
    if os.path.isdir(strokes):
        for name in sorted(os.listdir(strokes)):
            if name.endswith(".json"):
                out["shared/strokes/" + name] = ("import", os.path.join(strokes, name))
        stamps = os.path.join(shared_dir, "data", "stamps")
        for name in sorted(os.listdir(stamps)):
            if name.endswith(".stamps"):
                out["shared/stamps/" + name] = ("replay", os.path.join(stamps, name))
    else:
        print("no shared folder at %s: only the shipped logs are compared" % shared_dir)
    return out


def replay(program, log, threads, simd=None):
    env = dict(os.environ)
    if simd:
        env["RESTROKE_SIMD"] = simd
    done = subprocess.run([program, "replay", log, "--threads", str(threads), "--json", "-"], env=env,
                          capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit("replay of %s failed: %s" % (log, done.stderr))
    return json.loads(done.stdout[done.stdout.index("{"):])


def main():
    program, source_dir, shared_dir = sys.argv[1:4]
    expected_file = os.path.join(os.path.dirname(os.path.abspath(__file__)), "state_hashes.txt")
    expected = {}
    if os.path.exists(expected_file):
        with open(expected_file) as f:
            expected = dict(line.split() for line in f if line.strip() and not line.startswith("#"))
    failures = 0
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, (kind, path, *lines) in sources(source_dir, shared_dir).items():
            log = path
            if kind == "lines":
                log = os.path.join(folder, "begun.log")
                with open(path, encoding="utf-8") as whole, open(log, "w", encoding="utf-8") as begun:
                    begun.writelines(itertools.islice(whole, lines[0]))
            if kind == "import":
                log = os.path.join(folder, "imported.log")
                if os.path.exists(log):
                    os.remove(log)
                done = subprocess.run([program, "import", path, "--out", log], capture_output=True, text=True)
                if done.returncode != 0:
                    sys.exit("import of %s failed: %s" % (path, done.stderr))
            first = replay(program, log, 1)
            found[name] = first["state_hash"]
            variants = [(t, None) for t in (2, 8)]
            variants += [(1, level) for level in SIMD_LEVELS[:SIMD_LEVELS.index(first["simd"])]]
            for threads, simd in variants:
                other = replay(program, log, threads, simd)["state_hash"]
                if other != found[name]:
                    failures += 1
                    print("%s: %s with 1 thread and %s, but %s with %d threads and %s" %
                          (name, found[name], first["simd"], other, threads, simd or first["simd"]))
            print("%-45s %s" % (name, found[name]))
    if "--write" in sys.argv:
        with open(expected_file, "w") as f:
            f.write("# State hashes of replayed logs: the same on every machine. Made by state_hashes.py --write.\n")
            for name in sorted({**expected, **found}):
                f.write("%s %s\n" % (name, found.get(name, expected.get(name))))
        return 0
    for name, value in found.items():
        if expected.get(name) != value:
            failures += 1
            print("%s: expected %s, found %s" % (name, expected.get(name, "nothing written down"), value))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
