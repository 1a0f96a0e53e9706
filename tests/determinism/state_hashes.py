"""One table of state hashes: logs and stamp lists x SIMD levels x threads, against those that are written down (SPEC X1, DESIGN
invariant 5).

  state_hashes.py RESTROKE SOURCE_DIR SHARED_DIR [--built TEXT]    compare and print the table
  state_hashes.py RESTROKE SOURCE_DIR SHARED_DIR --write           write the hashes down anew

TEXT says how RESTROKE was built, for the table's head; `ctest -R determinism -V` prints it all. Every compiler, build type, sanitizer
and Debian compares with the same state_hashes.txt, so all of them agree. What is in the shared folder is left out where that is absent.

Shipped logs and shared stamp lists are replayed at every SIMD level that the processor has with 1, 2 and 8 threads; the stages of a
figure and imported pen strokes with each of these once. Logs, stamp lists and two meshes also become tri-dexels, and logs and machined stocks are refined. Each shipped log and stamp list is also made from its primitives all at
once, every sample evaluated anew, and each stamp list with a stroke of its own for every stamp: the same hash.
"""
import argparse
import concurrent.futures
import itertools
import json
import os
import subprocess
import sys
import tempfile

SIMD_LEVELS = ["sse2", "avx2", "avx512"]
THREADS = [1, 2, 8]
EXPECTED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "state_hashes.txt")


class Source:
    """Something to replay: `log`, under a name, on every combination (`full`) or on each level and thread count once."""

    def __init__(self, name, log, full):
        self.name, self.log, self.full = name, log, full

    def variants(self, levels):
        """(SIMD level, threads) to replay with."""
        if self.full:
            return list(itertools.product(levels, THREADS))
        return [(level, 1) for level in levels] + [(levels[-1], threads) for threads in THREADS[1:]]


def names(folder, ending):
    return sorted(name for name in os.listdir(folder) if name.endswith(ending))


def imported(program, strokes, log):
    done = subprocess.run([program, "import", strokes, "--out", log], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit("import of %s failed: %s" % (strokes, done.stderr))
    return log


def sources(program, source_dir, shared_dir, scratch):
    examples = os.path.join(source_dir, "experiments", "examples")
    out = [Source("examples/" + name, os.path.join(examples, name), True) for name in names(examples, ".log")]
    with open(os.path.join(examples, "figure10.log"), encoding="utf-8") as f:
        figure = f.readlines()
    with open(os.path.join(examples, "figure10-stages.txt"), encoding="utf-8") as f:
        for stage, lines, *_ in (line.split() for line in f if not line.startswith("#")):
            log = os.path.join(scratch, "stage-%s.log" % stage)
            with open(log, "w", encoding="utf-8") as begun:
                begun.writelines(figure[:int(lines)])
            out.append(Source("examples/figure10.log(%s)" % stage, log, False))
    if not os.path.isdir(os.path.join(shared_dir, "data")):
        print("no shared folder at %s: its stamp lists and pen strokes are skipped, the shipped logs are compared" % shared_dir)
        return out
    stamps = os.path.join(shared_dir, "data", "stamps")
    out += [Source("shared/stamps/" + name, os.path.join(stamps, name), True) for name in names(stamps, ".stamps")]
    strokes = os.path.join(shared_dir, "data", "strokes")
    out += [Source("shared/strokes/" + name, imported(program, os.path.join(strokes, name), os.path.join(scratch, name + ".log")), False)
            for name in names(strokes, ".json")]
    return out


def restroke(program, words, simd, threads):
    """The JSON that the program prints."""
    env = dict(os.environ, **({"RESTROKE_SIMD": simd} if simd else {}))
    done = subprocess.run([program, *words, "--threads", str(threads), "--json", "-"], env=env, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit("%s with %s and %d threads failed: %s" % (" ".join(words), simd, threads, done.stderr))
    out = json.loads(done.stdout[done.stdout.index("{"):])
    if simd and out["simd"] != simd:
        sys.exit("asked for %s, the program used %s" % (simd, out["simd"]))
    return out


def replay(program, log, simd=None, threads=1, *options):
    return restroke(program, ["replay", log, *options], simd, threads)


def tri_dexel(program, source, simd, threads):
    with tempfile.TemporaryDirectory() as scratch:
        return restroke(program, ["dexel", "build", source, "--resolution", "48", "--out", os.path.join(scratch, "m.tridexel")],
                        simd, threads)


def few_lines(program, source, threads, model):
    """The path `model`, to which a model of few lines is written, and cut with the tool path that lies beside the source, if any."""
    restroke(program, ["dexel", "build", source, "--resolution", "48", "--out", model], None, threads)
    if source.endswith(".camotics"):
        path = next(p for p in (source[:-9] + end for end in (".nc", ".gcode")) if os.path.isfile(p))
        restroke(program, ["dexel", "apply", model, "--toolpath", path, "--tools", source, "--out", model], None, threads)
    return model


def refined(program, model, simd, threads):
    """The model that few_lines is writing, as a camera's rays see it."""
    return restroke(program, ["dexel", "refine", model.result(), "--zone", "frustum", "--size", "96x72", "--method", "ends"],
                    simd, threads)


def refined_sources(all_sources, shared_dir, once):
    """What is refined: shipped logs, stamp lists and machined stocks, each with every combination."""
    paths = os.path.join(shared_dir, "data", "toolpaths")
    out = [Source("refine:" + source.name, source.log, not once) for source in all_sources if source.full]
    return out + [Source("refine:shared/toolpaths/" + name, os.path.join(paths, name), not once) for name in (names(paths, ".camotics") if os.path.isdir(paths) else [])]


def dexel_sources(all_sources, shared_dir, once):
    """What becomes a tri-dexel: shipped logs, stamp lists and meshes, each with every combination."""
    meshes = os.path.join(shared_dir, "data", "meshes", "closed")
    out = [Source("dexel:" + source.name, source.log, not once) for source in all_sources if source.full]
    return out + [Source("dexel:shared/meshes/" + name, os.path.join(meshes, name), not once)
                  for name in ("elephant.off", "thingi112932.stl") if os.path.isfile(os.path.join(meshes, name))]


def one_by_one(stamps, out):
    """Writes a stamp list with a stroke for every stamp; returns their number."""
    count, head = 0, None
    with open(stamps, encoding="utf-8") as lines, open(out, "w", encoding="utf-8") as f:
        for line in lines:
            if line.startswith("S "):
                head = "S %s 1\n" % line.split()[1]
            elif head and line.strip() and not line.startswith("#"):
                f.write(head + line)
                count += 1
            else:
                f.write(line)
    return count


class Table:
    """Prints rows; keeps what was found and how many rows differ from what is written down."""

    def __init__(self, expected):
        self.expected, self.found, self.failures = expected, {}, 0

    def judge(self, name, hashes):
        """Whether all of them are the one that is written down, in words."""
        self.found.setdefault(name, hashes[0])
        expected = self.expected.get(name)
        different = [h for h in hashes if h != expected]
        if not different:
            return "equal"
        self.failures += 1
        return "DIFFERENT: %s is written down" % (expected or "nothing")

    def row(self, name, *cells):
        print(("%-47s %-26s %s" % (name, cells[0], " ".join("%-16s" % c for c in cells[1:]))).rstrip(), flush=True)


def compare_variants(table, all_sources, levels, results):
    table.row("log or list", "SIMD", *["%d thread%s" % (t, "" if t == 1 else "s") for t in THREADS], "written down")
    for source in all_sources:
        for level in levels:
            cells = [results[source.name, level, t].result()["state_hash"] if (source.name, level, t) in results else ""
                     for t in THREADS]
            table.row(source.name, level, *cells, table.judge(source.name, [c for c in cells if c]))


def compare_ways(table, ways):
    print("\nthree ways to the same list, with the highest SIMD level and 1 thread")
    table.row("log or list", "made", "state", "written down")
    for name, way, result in ways:
        state = result.result()["state_hash"]
        table.row(name, way, state, table.judge(name, [state]))


def ways_of(source, pool, program, scratch):
    """(name, how it is made, what the program will say) of a shipped log or a stamp list."""
    # --check fails unless the list made all at once, with every sample evaluated anew, has the hash that is printed.
    checked = pool.submit(replay, program, source.log, None, 1, "--check")
    out = [(source.name, "as strokes", checked), (source.name, "all at once, and rebuilt", checked)]
    if source.log.endswith(".stamps"):
        log = os.path.join(scratch, "one-by-one-" + os.path.basename(source.log))
        count = one_by_one(source.log, log)
        out.append((source.name, "%d strokes of one stamp" % count, pool.submit(replay, program, log)))
    return out


def read_expected():
    with open(EXPECTED, encoding="utf-8") as f:
        return dict(line.split() for line in f if line.strip() and not line.startswith("#"))


def write_expected(expected, found):
    with open(EXPECTED, "w", encoding="utf-8") as f:
        f.write("# State hashes of replayed logs: the same on every machine. Made by state_hashes.py --write.\n")
        for name in sorted({**expected, **found}):
            f.write("%s %s\n" % (name, found.get(name, expected.get(name))))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("source_dir")
    parser.add_argument("shared_dir")
    parser.add_argument("--built", default="a program of unknown build")
    parser.add_argument("--once", action="store_true",
                        help="each SIMD level and thread count once for every log, for builds that are slow")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    table = Table(read_expected())
    with tempfile.TemporaryDirectory() as scratch, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        all_sources = sources(options.program, options.source_dir, options.shared_dir, scratch)
        highest = replay(options.program, all_sources[-1].log)["simd"]
        levels = SIMD_LEVELS[:SIMD_LEVELS.index(highest) + 1]
        print("built by %s; the processor has %s" % (options.built, ", ".join(levels)))
        ways = [way for source in all_sources if source.full for way in ways_of(source, pool, options.program, scratch)]
        dexels = dexel_sources(all_sources, options.shared_dir, options.once)
        refinements = refined_sources(all_sources, options.shared_dir, options.once)
        for source in all_sources:
            source.full = source.full and not options.once
        results = {(source.name, level, threads): pool.submit(replay, options.program, source.log, level, threads)
                   for source in all_sources for level, threads in source.variants(levels)}
        results.update({(source.name, level, threads): pool.submit(tri_dexel, options.program, source.log, level, threads)
                        for source in dexels for level, threads in source.variants(levels)})
        models = {(source.name, threads): pool.submit(few_lines, options.program, source.log, threads,
                                                      os.path.join(scratch, "few-lines-%d-%d.tridexel" % (number, threads)))
                  for number, source in enumerate(refinements) for threads in THREADS}
        results.update({(source.name, level, threads): pool.submit(refined, options.program, models[source.name, threads], level, threads)
                        for source in refinements for level, threads in source.variants(levels)})
        dexels += refinements
        compare_variants(table, all_sources + dexels, levels, results)
        compare_ways(table, ways)
    if options.write:
        write_expected(table.expected, table.found)
        return 0
    print("\n%d logs, lists and models: %s" % (len(all_sources) + len(dexels), "all hashes are those written down in state_hashes.txt"
                                       if table.failures == 0 else "%d rows differ" % table.failures))
    return 1 if table.failures else 0


if __name__ == "__main__":
    sys.exit(main())
