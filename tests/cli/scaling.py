"""The scaling experiment by the program, at its smoke size: what it writes, and what it refuses."""

import csv
import json
import os
import sys
import unittest

from experiment_case import ExperimentCase

COLUMNS = ("sweep", "value", "primitives", "surfels", "met", "stamp_us_p50", "stamp_us_p99", "undo_ms_p50", "rebuild_1_ms",
           "rebuild_ms", "rays_per_s", "rays_per_s_prefix", "picture_ms", "bytes_per_primitive", "bytes_per_surfel",
           "peak_resident_bytes", "state_hash", "simd", "threads", "revision", "compiler", "options_hash", "seed")


class Scaling(ExperimentCase):
    NAME = "scaling"

    def test_a_small_run_writes_tables_figures_and_a_report(self):
        out = self.path("out")
        done = self.run_experiment("--smoke", "--out", out, "--json", "-", "--threads", "2")
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(done.stdout)
        with open(os.path.join(out, "results.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        with open(os.path.join(out, "results.json"), encoding="utf-8") as file:
            self.assertEqual(len(json.load(file)["rows"]), len(rows))
        self.assertEqual(told["rows"], len(rows))
        self.assertEqual({row["sweep"] for row in rows}, {"extent", "detail", "surfels", "crowding", "spread"})
        for row in rows:
            for column in COLUMNS:
                self.assertTrue(row[column], column)
            self.assertEqual(row["threads"], "2")
        self.assertEqual(sorted(os.listdir(out)), sorted(told["files"]))
        for name in ("manifest.json", "report.html", "scaling-primitives.png", "scaling-primitives.svg"):
            self.assertIn(name, told["files"])

    def test_one_sweep_alone(self):
        out = self.path("out")
        done = self.run_experiment("--smoke", "--out", out, "--sweep", "extent", "--most", "1000", "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["rows"], 1)

    def test_bad_input_is_one_sentence(self):
        out = self.path("out")
        self.refused("--smoke", says="--out")
        self.refused("--smoke", "--out", out, "--most", "10", says="--most")
        self.refused("--smoke", "--out", out, "--sweep", "sideways", says="--sweep")
        self.refused("--smoke", "--out", out, "--most-surfels", "x", says="--most-surfels")
        self.refused("--smoke", "--out", out, self.path("absent.log"), says="absent.log")
        with open(self.path("bare.stamps"), "w", encoding="utf-8") as file:
            file.write("B 0 0 0 1\nS 1 1\n0 0 1 0.1\n")
        self.refused("--smoke", "--out", out, self.path("bare.stamps"), says="bare.stamps")
        self.assertFalse(os.path.exists(out), "nothing is left behind")
        with open(self.path("file"), "w", encoding="utf-8"):
            pass
        self.refused("--smoke", "--out", self.path("file"), says="file")


if __name__ == "__main__":
    ExperimentCase.RESTROKE = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
