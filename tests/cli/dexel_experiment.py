"""The dexel experiment by the program, at its smoke size: what it writes, and what it refuses."""

import csv
import json
import os
import sys
import unittest

from experiment_case import ExperimentCase



class DexelExperiment(ExperimentCase):
    NAME = "dexel"

    def test_a_small_run_writes_tables_figures_and_a_report(self):
        out = self.path("out")
        done = self.run_experiment("--smoke", "--out", out, "--json", "-", "--threads", "2")
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(done.stdout)
        with open(os.path.join(out, "results.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(told["rows"], len(rows))
        self.assertEqual({(row["source"], row["representation"], row["resolution"]) for row in rows},
                         {(source, kind, n) for source in ("ball", "gallery")
                          for kind in ("voxels", "one-family", "three-families") for n in ("8", "16", "32")})
        self.assertEqual(sorted(os.listdir(out)), sorted(told["files"]))
        for name in ("results.json", "manifest.json", "report.html", "figure1.png", "figure1.svg", "dexel-ball.svg"):
            self.assertIn(name, told["files"])

    def test_bad_input_is_one_sentence(self):
        out = self.path("out")
        self.refused("--smoke", says="--out")
        self.refused("--smoke", "--out", out, "--most", "7", says="--most")
        self.refused("--smoke", "--out", out, "--most", "4000", says="--most")
        self.refused("--smoke", "--out", out, "--points", "0", says="--points")
        self.refused("--smoke", "--out", out, self.path("absent.log"), says="absent.log")
        self.assertFalse(os.path.exists(out), "nothing is left behind")
        with open(self.path("file"), "w", encoding="utf-8"):
            pass
        self.refused("--smoke", "--out", self.path("file"), says="file")


if __name__ == "__main__":
    ExperimentCase.RESTROKE = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
