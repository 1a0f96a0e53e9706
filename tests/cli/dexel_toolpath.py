"""restroke dexel apply --toolpath: cutters and nozzles along G-code and poses (SPEC R8), from outside.

  dexel_toolpath.py RESTROKE SHARED_DIR
"""
import json
import math
import os
import sys
import unittest

import bad_input
from bad_input import Case

SHARED = None
TOOLS = {"1": {"shape": "cylindrical", "length": 20, "diameter": 4},
         "2": {"shape": "ballnose", "length": 20, "diameter": 4},
         "3": {"shape": "bullnose", "length": 20, "diameter": 4, "corner_radius": 0.5},
         "4": {"shape": "conical", "length": 20, "diameter": 4},
         "5": {"shape": "cylindrical", "length": 2, "diameter": 2, "mode": "add"},
         "6": {"units": "imperial", "shape": "cylindrical", "length": 1, "diameter": 0.25}}
STOCK = {"units": "metric", "tools": TOOLS, "workpiece": {"bounds": {"min": [-20, -20, -10], "max": [20, 20, 0]}}}
VOLUME = 40 * 40 * 10


def pose(x, y, z, rows=((1, 0, 0), (0, 1, 0), (0, 0, 1))):
    return "".join("%g %g %g %g " % (*row, p) for row, p in zip(rows, (x, y, z))) + "0 0 0 1\n"


class Toolpath(Case):
    def setUp(self):
        super().setUp()
        self.project = self.file("stock.camotics", json.dumps(STOCK, indent=2))
        self.model = self.path("m.tridexel")
        self.out = self.path("o.tridexel")

    def dexel(self, command, *arguments):
        return json.loads(self.accepted("dexel", command, *arguments, "--json", "-").stdout)

    def stock(self, resolution="160"):
        return self.dexel("build", self.project, "--resolution", resolution, "--out", self.model)

    def cut(self, program, *arguments, out=None):
        return self.dexel("apply", self.model, "--toolpath", self.file("p.nc", program), "--tools", self.project, "--out",
                          out or self.out, *arguments)

    def removed(self, program, *arguments):
        return VOLUME - self.cut(program, *arguments)["volume"]


class Paths(Toolpath):
    def test_r8_the_stock_is_the_projects_workpiece(self):
        made = self.stock("40")
        self.assertEqual(made["counts"], [40, 40, 10])
        self.assertAlmostEqual(made["volume"], VOLUME, places=3)
        self.assertEqual(made["initial"], "mesh")

    def test_r8_slots_and_rings_have_their_volume(self):
        self.stock()
        slot = 20 * 4 + math.pi * 4
        ring = math.pi * (12 ** 2 - 8 ** 2)
        for program, area in (
                ("T1 G1 X-10 Y0 Z5\nZ-3\nX10\nZ5\n", slot),
                ("T6 G1 X-10 Y0 Z5\nZ-3\nX10\nZ5\n", 20 * 6.35 + math.pi * 3.175 ** 2),
                ("T1 G0 X10 Y0 Z5\nG1 Z-3\nG2 I-10\nG0 Z5\n", ring),
                ("T1 G0 X10 Y0 Z5\nG1 Z-3\nG3 X-10 R10\nG3 X10 R10\nG0 Z5\n", ring),
                ("T1 G20 G0 X.5 Y0 Z.2\nG21 G91 G1 Z-8.08\nG90 G2 I-12.7\nG0 Z5\n",
                 math.pi * (14.7 ** 2 - 10.7 ** 2))):
            with self.subTest(program):
                self.assertLess(abs(self.removed(program) / (3 * area) - 1), 2e-2)
        # Round ends below: a ball takes a half cylinder less, a bull nose little less than a flat one.
        flat, ball, bull = (self.removed("T%d G1 X-10 Y0 Z5\nZ-3\nX10\nZ5\n" % tool) for tool in (1, 2, 3))
        self.assertLess(ball, bull)
        self.assertLess(bull, flat)
        self.assertLess(abs(ball / (20 * (2 * math.pi + 4) + math.pi * 4 + 16 * math.pi / 3) - 1), 2e-2)

    def test_r8_each_element_is_an_operation_and_tools_are_kept_once(self):
        self.stock("32")
        program = "(two tools)\nT1 M6\nG0 Z5\nX0 Y0\nG1 Z-2 F100\nX5\nX5\nT2\nG1 Y5\nM30\nG28\n"
        made = self.cut(program)
        # It stays at Z5; there is where it goes; then down, along, up in Y.
        self.assertEqual((made["elements"], made["still"], made["approaches"]), (4, 2, 1))
        self.assertEqual((made["operations"], made["cutters"], made["tool_numbers"]), (4, 2, [1, 2]))
        again = self.dexel("apply", self.out, "--toolpath", self.path("p.nc"), "--tools", self.project, "--out",
                           self.path("again.tridexel"))
        self.assertEqual((again["operations"], again["cutters"]), (8, 2))
        self.assertEqual(again["volume"], made["volume"])
        self.assertEqual(again["state_hash"], made["state_hash"])
        info = self.dexel("info", self.out)
        self.assertEqual((info["operations"], info["cutters"], info["state_hash"]), (4, 2, made["state_hash"]))

    def test_r7_the_history_of_a_path_is_merged_when_asked(self):
        self.stock("32")
        again = "T1 G0 Z5\nG1 Z-2\nX5\nX0\nX5\nX0\n"
        plain, merged = self.cut(again), self.cut(again, "--resultants", out=self.path("r.tridexel"))
        self.assertEqual(merged["elements"], plain["elements"])
        self.assertEqual(merged["resultants"]["operations_before"], plain["operations"])
        self.assertLess(merged["operations"], plain["operations"])
        self.assertEqual(merged["volumes"], plain["volumes"])

    def test_r8_nozzles_add_and_the_grid_grows(self):
        self.stock("80")
        program = "T5 G1 X-10 Y0 Z0\nX10\n"
        wall = 2 * (20 * 2 + math.pi)
        added = self.cut("T5 G0 X-10 Y0 Z0\nG1 X10\n")
        self.assertLess(abs((added["volume"] - VOLUME) / wall - 1), 0.02)
        self.assertAlmostEqual(added["bounds"][1][2], 2, places=4)
        self.assertEqual(self.cut("T5 G0 X-10 Y0 Z0\nG1 X10\n", "--mode", "add")["state_hash"], added["state_hash"])
        self.assertEqual(self.cut(program, "--mode", "cut")["volume"], VOLUME)
        self.assertGreater(self.cut("T1 G0 X0 Y0 Z0\nG1 X10\n", "--mode", "add")["volume"], VOLUME + 1000)

    def test_r8_threads_and_runs_change_nothing(self):
        self.stock()
        program = "T3 G0 Z5\n" + "".join("G1 X%g Y%g Z%g\nG%d X%g Y%g R40\n" % (
            -15 + k % 30, -15 + k % 7, -1 - k % 5, 2 + k % 2, -15 + (k + 9) % 30, -10 + k % 11) for k in range(120))
        hashes = {self.cut(program, "--threads", threads)["state_hash"] for threads in ("1", "2", "8")}
        self.assertEqual(len(hashes), 1)

    def test_r8_poses_are_swept_between(self):
        self.stock()
        poses = "# down, along\n" + pose(-10, 0, 5) + pose(-10, 0, -3) + pose(10, 0, -3)
        made = self.cut(poses, "--tool", "1")
        self.assertEqual((made["format"], made["elements"], made["turns"]), ("poses", 2, 0))
        self.assertLess(abs((VOLUME - made["volume"]) / (3 * (80 + math.pi * 4)) - 1), 2e-2)
        # Lying along y from y = -30 on, its length of 20 reaches -10.
        lying = ((1, 0, 0), (0, 0, 1), (0, -1, 0))
        made = self.cut(pose(0, -30, -5, lying), "--tool", "1")
        self.assertLess(abs((VOLUME - made["volume"]) / (10 * math.pi * 4) - 1), 2e-2)
        done = self.accepted("dexel", "apply", self.model, "--toolpath",
                             self.file("turn.txt", pose(0, 0, -1) + pose(0, -30, -5, lying)), "--tool", "2", "--tools",
                             self.project, "--out", self.out)
        self.assertIn("turns between poses once", done.stderr)

    def test_r8_the_only_tool_is_in_hand(self):
        self.stock("32")
        one = self.file("one.json", json.dumps({"tools": {"7": TOOLS["2"]}}))
        made = self.dexel("apply", self.model, "--toolpath", self.file("p.nc", "G1 Z-2\nX5\n"), "--tools", one, "--out", self.out)
        self.assertEqual(made["tool_numbers"], [7])
        self.assertEqual(self.cut("G1 Z-2\nX5\n", "--tool", "2")["state_hash"], made["state_hash"])
        self.assertEqual(self.cut("G1 Z-2\nT1 X5\n", "--tool", "2")["tool_numbers"], [1, 2])

    def test_r8_programs_of_others_are_machined(self):
        folder = os.path.join(SHARED, "data", "toolpaths")
        if not os.path.isdir(folder):
            self.skipTest("the shared tool paths are not here")
        for name, program, elements, tools in (("wave", "wave.gcode", 1153, [3]), ("scorpion", "scorpion.nc", 270, [1])):
            project = os.path.join(folder, name + ".camotics")
            stock = self.dexel("build", project, "--resolution", "128", "--out", self.model)
            done = self.dexel("apply", self.model, "--toolpath", os.path.join(folder, program), "--tools", project, "--out",
                              self.out)
            self.assertEqual((done["elements"], done["tool_numbers"]), (elements, tools))
            self.assertLess(done["volume"], stock["volume"])
            self.assertGreater(done["volume"], 0.7 * stock["volume"])


class BadInput(Toolpath):
    def test_programs_are_refused_with_their_line(self):
        self.stock("16")
        for program, says in (("T4\nG1 X1\n", "p.nc: line 2: "), ("T4\nG1 X1\n", "conical"), ("T9 G1 X1\n", "no tool 9"),
                              ("G1 X1\n", "no T has selected"), ("T1\nG28\n", "p.nc: line 2: G28"), ("T1 G1 Xnan\n", "line 1"),
                              ("T1 G1 X1e5\n", "letter E"), ("T1 G1 A5\n", "letter A"), ("T1 X5\n", "motion"),
                              ("T1 G2 X5\n", "no centre"), ("T1 G1 X-1 G2 X5 R1\n", "second word"),
                              ("T1 G2 X5 R1\n", "at least half"), ("T1 G1 X9999999\n", "must stay within")):
            with self.subTest(program):
                self.refused("dexel", "apply", self.model, "--toolpath", self.file("p.nc", program), "--tools", self.project,
                             "--out", self.out, says=says)

    def test_options_that_do_not_fit_are_refused(self):
        self.stock("16")
        nc, poses = self.file("p.nc", "T1 G1 X1\n"), self.file("poses.txt", pose(0, 0, 0))
        scaled = self.file("scaled.txt", pose(0, 0, 0, ((2, 0, 0), (0, 2, 0), (0, 0, 2))))
        mesh = self.file("tool.off", "OFF\n0 0 0\n")
        path, tools = ("--toolpath", nc), ("--tools", self.project)
        for arguments, says in (
                ((), "--tool: must be given"),
                (("--tool", "sphere", *tools), "--tools"),
                (path, "--tools must be given"),
                ((*path, *tools, "--poses", poses), "not both"),
                ((*path, *tools, "--tool", mesh), "number of a tool"),
                ((*path, *tools, "--tool", "-1"), "--tool"),
                ((*path, *tools, "--mode", "intersect"), "--mode"),
                ((*path, *tools, "--device", "opengl"), "opengl"),
                ((*path, "--tools", self.path("missing.json")), "missing.json"),
                ((*path, "--tools", self.file("bad.json", '{"tools":{"1":{"length":NaN}}}')), "bad.json"),
                ((*path, "--tools", self.file("none.json", "{}")), "the tools are none"),
                (("--toolpath", self.path("missing.nc"), *tools), "missing.nc"),
                (("--toolpath", poses, *tools), "poses name no tool"),
                (("--toolpath", poses, *tools, "--tool", "4"), "conical"),
                (("--toolpath", scaled, *tools, "--tool", "1"), "pose 1 scales"),
                (("--toolpath", self.file("far.txt", pose(3e4, 0, 0)), *tools, "--tool", "5"), "at most 8192")):
            with self.subTest(arguments):
                self.refused("dexel", "apply", self.model, *arguments, "--out", self.out, says=says)
        self.refused("dexel", "build", self.file("flat.camotics", json.dumps(
            {"workpiece": {"bounds": {"min": [0, 0, 0], "max": [1, 1, 0]}}})), "--out", self.out, says="must have an inside")
        self.refused("dexel", "build", self.file("auto.camotics", '{"workpiece": {"automatic": true}}'), "--out", self.out,
                     says="workpiece.bounds")


if __name__ == "__main__":
    bad_input.RESTROKE, SHARED = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1])
