"""The refine experiment by the program, at its smoke size: what it writes, and what it refuses."""

import csv
import json
import os
import sys
import unittest

from experiment_case import ExperimentCase


class RefineExperiment(ExperimentCase):
    NAME = "refine"

    def test_a_small_run_writes_tables_figures_and_a_report(self):
        out = self.path("out")
        stamps = self.path("dents.stamps")
        with open(stamps, "w", encoding="utf-8") as file:
            file.write("B 0 0 0 1\nS -1 2\n0 0 1 0.5\n0 1 0 0.5\n")
        done = self.run_experiment("--smoke", "--out", out, "--json", "-", "--threads", "2", stamps)
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(done.stdout)
        with open(os.path.join(out, "results.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(told["rows"], len(rows))
        self.assertIn("dents", {row["history"] for row in rows})
        for row in rows:
            if row["method"] == "clusters":
                self.assertEqual((row["identical"], float(row["wrong"] or 0)), ("true", 0.0), row)
        with open(os.path.join(out, "times.csv"), newline="", encoding="utf-8") as file:
            times = list(csv.DictReader(file))
        self.assertEqual({(row["growth"], row["operations"]) for row in times},
                         {(growth, n) for growth in ("elsewhere", "deeper", "finer") for n in ("1000", "3000")})
        self.assertEqual(sorted(os.listdir(out)), sorted(told["files"]))
        for name in ("results.json", "manifest.json", "report.html", "refine-lines.png", "refine-time.svg",
                     "lost-dense-ends.png"):
            self.assertIn(name, told["files"])

    def test_bad_input_is_one_sentence(self):
        out = self.path("out")
        self.refused("--smoke", says="--out")
        self.refused("--smoke", "--out", out, "--most", "7", says="--most")
        self.refused("--smoke", "--out", out, "--lines", "1", says="--lines")
        self.refused("--smoke", "--out", out, "--places", "0", says="--places")
        self.refused("--smoke", "--out", out, self.path("absent.log"), says="absent.log")
        self.assertFalse(os.path.exists(out), "nothing is left behind")
        with open(self.path("file"), "w", encoding="utf-8"):
            pass
        self.refused("--smoke", "--out", self.path("file"), says="file")


if __name__ == "__main__":
    ExperimentCase.RESTROKE = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
