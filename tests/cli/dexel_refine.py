"""restroke dexel refine: new lines where a model is looked at (SPEC R3-R6, R10), from outside.

  dexel_refine.py RESTROKE RABBIT_LOG
"""
import json
import sys
import unittest

import bad_input
from bad_input import Case

RABBIT = None
BOX = "box:-0.7,-0.1,0.2,0.8,0.9,1.4"
TURNED = BOX + ",0.2,0.25,0.1,0.9"


class Refine(Case):
    def setUp(self):
        super().setUp()
        self.model = self.path("m.tridexel")
        self.accepted("dexel", "build", RABBIT, "--resolution", "40", "--history", "--out", self.model)

    def refine(self, *arguments):
        return json.loads(self.accepted("dexel", "refine", self.model, *arguments, "--json", "-").stdout)


class Methods(Refine):
    def test_r5_clusters_are_all_bit_for_bit_and_others_nearly(self):
        for zone in (BOX, TURNED, "sphere:0.3,0.2,0.6,0.5", "frustum"):
            found = {method: self.refine("--zone", zone, "--method", method, "--resolution", "60")
                     for method in ("all", "clusters", "touching", "ends", "document")}
            for method, result in found.items():
                self.assertEqual(result["method"], method)
                self.assertEqual(result["operations"], 3072)
                self.assertEqual(result["lines"], found["all"]["lines"])
                if zone != "frustum":
                    self.assertAlmostEqual(result["volume"], found["all"]["volume"], delta=0.02 * found["all"]["volume"])
            self.assertEqual(found["clusters"]["state_hash"], found["all"]["state_hash"])
            self.assertEqual(found["clusters"]["collected"], found["all"]["collected"])
            self.assertLess(found["ends"]["collected"], 3073)
            self.assertLessEqual(found["touching"]["collected"], found["all"]["collected"] + 1)

    def test_r6_threads_change_nothing(self):
        hashes = {self.refine("--zone", TURNED, "--method", "ends", "--threads", n)["state_hash"] for n in ("1", "2", "5")}
        self.assertEqual(len(hashes), 1)

    def test_r6_opengl_gives_the_same_lines(self):
        done = self.restroke("dexel", "refine", self.model, "--zone", TURNED, "--resolution", "24", "--device", "opengl",
                             "--json", "-")
        if done.returncode != 0:
            self.skipTest("no OpenGL here: " + done.stderr.strip())
        self.assertEqual(json.loads(done.stdout)["state_hash"], self.refine("--zone", TURNED, "--resolution", "24")["state_hash"])


class Lines(Refine):
    def test_r3_lines_are_denser_along_a_direction_or_those_of_the_model(self):
        three = self.refine("--zone", BOX, "--resolution", "50")
        self.assertEqual(three["families"], 3)
        self.assertGreater(self.refine("--zone", BOX, "--resolution", "100")["lines"], 3 * three["lines"])
        one = self.refine("--zone", BOX, "--resolution", "50", "--direction", "1,2,0.5")
        self.assertEqual(one["families"], 1)
        self.assertAlmostEqual(one["volume"], three["volume"], delta=0.03 * three["volume"])
        kept, twice = (self.refine("--zone", BOX, "--times", n)["lines"] for n in ("1", "2"))
        self.assertLess(kept, three["lines"])
        self.assertAlmostEqual(twice / kept, 4, delta=0.4)

    def test_r3_one_line_a_pixel_and_more(self):
        self.assertEqual(self.refine("--zone", "frustum", "--per-pixel", "--size", "40x30")["lines"], 1200)
        many = self.refine("--zone", "frustum", "--size", "40x30", "--samples", "3", "--png", self.path("p.png"))
        self.assertEqual(many["lines"], 9 * 1200)
        self.assertEqual(self.read("p.png")[16:24], (40).to_bytes(4, "big") + (30).to_bytes(4, "big"))


class Files(Refine):
    def test_r10_what_was_refined_is_refined_again_from_its_file(self):
        finer = self.path("finer.tridexel")
        self.refine("--zone", BOX, "--resolution", "80", "--out", finer)
        info = json.loads(self.accepted("dexel", "info", finer, "--json", "-").stdout)
        self.assertEqual(info["operations"], 3072)
        again = json.loads(self.accepted("dexel", "refine", finer, "--zone", "sphere:0.3,0.2,0.6,0.3", "--json", "-").stdout)
        self.assertEqual(again["state_hash"], self.refine("--zone", "sphere:0.3,0.2,0.6,0.3")["state_hash"])

    def test_r3_meshes_points_and_pictures_of_zones(self):
        for name in ("b.stl", "b.ply", "b.xyz"):
            self.refine("--zone", TURNED, "--resolution", "30", "--out", self.path(name), "--png", self.path("b.png"),
                        "--size", "60x50")
            self.assertGreater(len(self.read(name)), 1000)
        # The mesh is where the zone is.
        rows = [list(map(float, line.split()[:3])) for line in self.read("b.xyz").decode().splitlines() if line]
        middle = [sum(row[a] for row in rows) / len(rows) for a in range(3)]
        for a, (low, high) in enumerate(((-0.9, 1.0), (-0.4, 1.2), (0.0, 1.7))):
            self.assertTrue(low < middle[a] < high, middle)
        self.refine("--zone", "frustum", "--resolution", "30", "--out", self.path("r.xyz"))
        self.assertGreater(len(self.read("r.xyz")), 1000)
        self.refine("--zone", "frustum:1,4", "--resolution", "12", "--spans", "left", "--png", self.path("s.png"),
                    "--size", "60x50")
        self.accepted("dexel", "render", self.model, "--spans", "--family", "x", "--png", self.path("t.png"), "--size", "60x50")


class Refusals(Refine):
    def test_what_cannot_be_refined_gets_a_sentence(self):
        no_history = self.path("plain.tridexel")
        self.accepted("dexel", "build", RABBIT, "--resolution", "8", "--out", no_history)
        done = self.restroke("dexel", "refine", no_history, "--zone", BOX, "--method", "touching")
        self.assertEqual(done.returncode, 2)
        self.assertIn("plain.tridexel", done.stderr)
        for words, arguments in (("--zone", ["--zone", "cube"]), ("--zone", ["--zone", "box:0,0,0,1,1"]),
                                 ("--zone", ["--zone", "box:0,0,0,0,1,1"]), ("--zone", ["--zone", "sphere:0,0,0,-1"]),
                                 ("--zone", ["--zone", "frustum:3,1"]), ("--zone", ["--zone", "box:0,0,0,1,1,nan"]),
                                 ("--method", ["--zone", BOX, "--method", "best"]),
                                 ("--zoom", ["--zone", "frustum", "--zoom", "0"]),
                                 ("--direction", ["--zone", BOX, "--direction", "1,2"]),
                                 ("lines", ["--zone", BOX, "--direction", "0,0,0"]),
                                 ("lines", ["--zone", BOX, "--resolution", "10", "--cell", "0.1"]),
                                 ("lines", ["--zone", BOX, "--per-pixel"]), ("lines", ["--zone", "frustum", "--cell", "0.1"]),
                                 ("--samples", ["--zone", BOX, "--samples", "2"]),
                                 ("rays", ["--zone", "frustum", "--samples", "99"]),
                                 ("--spans", ["--zone", BOX, "--spans", "front"]),
                                 ("widened", ["--zone", BOX, "--method", "ends", "--widen", "-1"]),
                                 ("--device", ["--zone", BOX, "--device", "abacus"]),
                                 ("tridexel", ["--zone", TURNED, "--out", self.path("x.tridexel")]),
                                 ("mesh", ["--zone", "frustum", "--resolution", "9", "--out", self.path("x.stl")])):
            self.refused("dexel", "refine", self.model, *arguments, says=words)
        self.assertEqual(self.restroke("dexel", "refine", RABBIT, "--zone", BOX).returncode, 2)


if __name__ == "__main__":
    bad_input.RESTROKE, RABBIT = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1])
