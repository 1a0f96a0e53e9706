"""restroke dexel: tri-dexels of logs and meshes, cut by tools, drawn and exported (SPEC D1-D10), from outside.

  dexel.py RESTROKE GALLERY_LOG SHARED_DIR
"""
import json
import os
import sys
import unittest

import bad_input
from bad_input import Case

GALLERY = SHARED = None
# A cube of side 1 about the origin, facing out; and one with a face too few.
CUBE = ("OFF\n8 6 0\n" + "".join("%g %g %g\n" % ((i & 1) - 0.5, (i >> 1 & 1) - 0.5, (i >> 2) - 0.5) for i in range(8)) +
        "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n")
OPEN = CUBE.replace("8 6 0", "8 5 0").replace("4 4 5 7 6\n", "")
IDENTITY = "1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1\n"


def moved(x, y, z, size=1.0):
    return "%g 0 0 %g  0 %g 0 %g  0 0 %g %g  0 0 0 1\n" % (size, x, size, y, size, z)


class Dexel(Case):
    def dexel(self, command, *arguments):
        return json.loads(self.accepted("dexel", command, *arguments, "--json", "-").stdout)

    def build(self, source, *arguments, out="m.tridexel"):
        return self.dexel("build", source, "--out", self.path(out), *arguments)

    def cube(self, *arguments):
        return self.build(self.file("cube.off", CUBE), *(arguments or ("--resolution", "32")))

    def has_opengl(self):
        done = self.restroke("dexel", "build", self.file("cube.off", CUBE), "--device", "opengl", "--out",
                             self.path("probe.tridexel"))
        return done.returncode == 0


class Models(Dexel):
    def test_d1_a_cube_is_its_volume_and_says_what_it_holds(self):
        made = self.cube()
        self.assertEqual(made["counts"], [32, 32, 32])
        self.assertEqual(made["lines"], 3 * 32 * 32)
        self.assertEqual(made["ends"], 2 * 3 * 32 * 32)
        self.assertAlmostEqual(made["volume"], 1, places=6)
        self.assertEqual(made["initial"], "mesh")
        self.assertEqual(made["operations"], 0)
        self.assertEqual(made["file_bytes"], len(self.read("m.tridexel")))
        info = self.dexel("info", self.path("m.tridexel"))
        for key in ("counts", "cell", "lines", "ends", "bounds", "volume", "volumes", "model_bytes"):
            self.assertEqual(info[key], made[key], key)
        self.assertIn("32 x 32 x 32 lines", self.accepted("dexel", "info", self.path("m.tridexel")).stdout)

    def test_d4_a_tool_cuts_and_adds_in_each_pose(self):
        self.cube()
        tool = self.file("tool.off", CUBE)
        poses = self.file("poses.txt", "# two corners\n" + moved(0.5, 0.5, 0.5, 0.5) + "\n" + moved(-0.5, -0.5, -0.5, 0.5))
        cut = self.dexel("apply", self.path("m.tridexel"), "--tool", tool, "--poses", poses, "--out",
                         self.path("cut.tridexel"))
        self.assertAlmostEqual(cut["volume"], 1 - 2 * 0.25 ** 3, delta=2e-3)
        self.assertEqual((cut["poses"], cut["operations"], cut["tools"]), (2, 2, 1))
        # What is added beyond the lines gets lines of its own.
        grown = self.dexel("apply", self.path("m.tridexel"), "--tool", tool, "--poses",
                           self.file("beside.txt", moved(1, 0, 0)), "--mode", "add", "--out", self.path("g.tridexel"))
        self.assertAlmostEqual(grown["volume"], 2, delta=2e-2)
        self.assertGreater(grown["counts"][0], 60)
        kept = self.dexel("apply", self.path("m.tridexel"), "--tool", tool, "--poses",
                          self.file("corner.txt", moved(0.5, 0.5, 0.5)), "--mode", "intersect", "--out",
                          self.path("k.tridexel"))
        self.assertAlmostEqual(kept["volume"], 0.125, delta=5e-3)
        kept = self.dexel("apply", self.path("m.tridexel"), "--tool", "sphere:0,0,0,0.4", "--mode", "intersect", "--out",
                          self.path("k.tridexel"))
        self.assertAlmostEqual(kept["volume"], 0.2681, delta=2e-3)
        # A shape in words; the same tool mesh again is not held twice.
        ball = self.dexel("apply", self.path("cut.tridexel"), "--tool", "sphere:0,0,0,0.3", "--out",
                          self.path("ball.tridexel"))
        self.assertAlmostEqual(cut["volume"] - ball["volume"], 0.1131, delta=2e-3)
        again = self.dexel("apply", self.path("ball.tridexel"), "--tool", tool, "--poses", poses, "--out",
                           self.path("again.tridexel"))
        self.assertEqual((again["tools"], again["operations"]), (1, 5))
        self.assertEqual(again["volume"], ball["volume"])

    def test_x1_a_log_becomes_a_model_whose_operations_are_its_stamps(self):
        made = self.build(GALLERY, "--resolution", "96")
        replayed = self.replay(GALLERY)
        self.assertEqual(made["operations"], replayed["primitives"] - 1)
        self.assertEqual(made["initial"], "primitives")
        exported = json.loads(self.accepted("export", GALLERY, "--resolution", "96", "--out", self.path("g.stl"), "--json",
                                            "-").stdout)
        # Most of the gallery is a plate that the lines along y meet squarely: the others know its thickness to a cell.
        self.assertLess(abs(made["volumes"][1] / exported["volume"] - 1), 0.005)
        self.assertLess(abs(made["volume"] / exported["volume"] - 1), 0.03)
        for threads in ("1", "2", "8"):
            self.build(GALLERY, "--resolution", "96", "--threads", threads, out="again.tridexel")
            self.assertEqual(self.read("again.tridexel"), self.read("m.tridexel"), "threads change nothing")

    def test_d5_opengl_gives_the_same_cuts(self):
        if not self.has_opengl():
            self.skipTest("no OpenGL 4.3 on this machine")
        self.cube("--resolution", "31")
        opengl = self.build(self.path("cube.off"), "--resolution", "31", "--device", "opengl", out="gl.tridexel")
        self.assertAlmostEqual(opengl["volume"], 1, places=5)
        tool = self.file("tool.off", CUBE)
        poses = self.file("poses.txt", "".join(moved(0.05 * k - 0.5, 0.31, 0.27, 0.4) for k in range(20)))
        volumes = []
        for device in ("cpu", "opengl"):
            done = self.dexel("apply", self.path("m.tridexel"), "--tool", tool, "--poses", poses, "--device", device,
                              "--out", self.path(device + ".tridexel"))
            volumes.append(done["volume"])
        self.assertAlmostEqual(*volumes, places=6)


class Histories(Dexel):
    def test_r2b_lines_keep_what_changed_them_from_build_to_apply(self):
        plain = self.build(GALLERY, "--resolution", "48")
        self.assertIsNone(plain["history"])
        kept = self.build(GALLERY, "--resolution", "48", "--history", out="h.tridexel")
        self.assertEqual(kept["state_hash"], plain["state_hash"])
        self.assertGreater(kept["history"]["entries"], 100)
        self.assertEqual(kept["model_bytes"] - plain["model_bytes"], kept["history"]["bytes"])
        info = self.dexel("info", self.path("h.tridexel"))
        self.assertEqual(info["history"]["entries"], kept["history"]["entries"])
        self.assertIn("histories of lines:", self.accepted("dexel", "info", self.path("h.tridexel")).stdout)
        cut = self.dexel("apply", self.path("h.tridexel"), "--tool", "sphere:0,0,0,3", "--out", self.path("c.tridexel"))
        self.assertGreater(cut["history"]["entries"], kept["history"]["entries"])
        mesh = self.cube("--resolution", "16", "--history")
        self.assertEqual(mesh["history"]["entries"], 0)
        self.assertEqual(mesh["cutters"], 0)
        self.refused("dexel", "apply", self.path("m.tridexel"), "--tool", self.path("cube.off"), "--device", "opengl", "--out",
                     self.path("x.tridexel"), says="m.tridexel: its lines keep every operation")

    def test_r7_resultants_keep_the_model_and_say_what_they_saved(self):
        self.cube("--resolution", "24", "--history")
        poses = self.file("poses.txt", "".join(moved(0.02 * k - 0.4, 0.45, 0.4) for k in range(40)) * 2)
        arguments = ("--tool", "sphere:0,0,0,0.2", "--poses", poses)
        before = self.dexel("apply", self.path("m.tridexel"), *arguments, "--out", self.path("b.tridexel"))
        after = self.dexel("apply", self.path("m.tridexel"), *arguments, "--resultants", "--out", self.path("a.tridexel"))
        saved = after["resultants"]
        self.assertEqual((saved["operations_before"], saved["operations_after"]), (80, after["operations"]))
        self.assertEqual(saved["without_effect"], 40)
        self.assertLess(saved["history_entries_after"], saved["history_entries_before"] / 4)
        self.assertLess(saved["document_bytes_after"], saved["document_bytes_before"])
        self.assertEqual(after["history"]["entries"], saved["history_entries_after"])
        self.assertNotIn("resultants", before)
        for key in ("counts", "ends", "volumes", "bounds"):
            self.assertEqual(after[key], before[key], key)
        self.assertLess(after["file_bytes"], before["file_bytes"])
        text = self.accepted("dexel", "build", GALLERY, "--resolution", "32", "--resultants", "--out",
                             self.path("g.tridexel")).stdout
        self.assertIn("without effect", text)


class PicturesAndFiles(Dexel):
    def test_d7_d8_pictures_meshes_and_points(self):
        self.cube()
        model = self.path("m.tridexel")
        for family in ("x", "y", "z", "all"):
            done = self.dexel("render", model, "--family", family, "--size", "80x60", "--png", self.path(family + ".png"))
            self.assertGreater(done["surfels"], 1000)
            self.assertEqual(self.read(family + ".png")[:8], b"\x89PNG\r\n\x1a\n")
        self.assertNotEqual(self.read("x.png"), self.read("all.png"))
        for ending in ("stl", "ply", "obj", "3mf", "amf"):
            out = self.path("c." + ending)
            made = json.loads(self.accepted("export", model, "--out", out, "--json", "-").stdout)
            self.assertTrue(made["closed"], ending)
            self.assertEqual(made["self_intersections"], 0)
            self.assertAlmostEqual(made["volume"], 1, places=4)
        self.accepted("dexel", "export", model, "--out", self.path("c.xyz"))
        lines = self.read("c.xyz").decode().splitlines()
        self.assertEqual(len(lines), 2 * 3 * 32 * 32)
        self.assertTrue(all(len(line.split()) == 6 for line in lines))


class BadInput(Dexel):
    def test_words_are_refused(self):
        self.cube()
        model, tool = self.path("m.tridexel"), self.file("tool.off", CUBE)
        out = ("--out", self.path("o.tridexel"))
        cube = self.path("cube.off")
        for arguments, says in (
                (("build", cube, *out, "--resolution", "0"), "resolution"),
                (("build", cube, *out, "--resolution", "9000"), "8192"),
                (("build", cube, *out, "--cell", "nan"), "cell"),
                (("build", cube, *out, "--cell", "1e-9"), "float32"),
                (("build", cube, *out, "--cell", "1e-5"), "GB"),
                (("build", cube, *out, "--resolution", "9", "--cell", "1"), "give one"),
                (("build", cube, *out, "--device", "abacus"), "--device"),
                (("build", cube, *out, "--repair", "glue"), "--repair"),
                (("build", model, *out), "tri-dexel"),
                (("build", self.path("missing.off"), *out), "missing.off"),
                (("apply", cube, "--tool", tool, *out), "cube.off"),
                (("apply", model, "--tool", tool, "--mode", "melt", *out), "--mode"),
                (("apply", model, "--tool", "teapot.obj", *out), "teapot.obj"),
                (("apply", model, "--tool", self.file("open.off", OPEN), *out), "open.off"),
                (("apply", model, "--tool", tool, "--poses", self.file("far.txt", moved(4000, 0, 0)), "--mode", "add", *out),
                 "at most 8192"),
                (("apply", model, "--tool", "sphere:0,5000,0,1", "--mode", "add", *out), "at most 8192"),
                (("render", model, "--family", "w", "--png", self.path("p.png")), "--family"),
                (("render", model, "--view", "beside", "--png", self.path("p.png")), "--view"),
                (("export", model, "--resolution", "9", "--out", self.path("p.stl")), "--resolution"),
                (("info", cube), "cube.off")):
            with self.subTest(arguments):
                self.refused("dexel", *arguments, says=says)

    def test_an_open_mesh_is_refused_with_where_and_repaired_when_asked(self):
        mesh = self.file("open.off", OPEN)
        done = self.refused("dexel", "build", mesh, "--resolution", "16", "--out", self.path("o.tridexel"), says="odd number")
        self.assertIn("along z", done.stderr)
        self.assertIn("repair winding", done.stderr)
        made = self.build(mesh, "--resolution", "16", "--repair", "winding")
        self.assertTrue(made["repaired"])
        self.assertGreater(made["volume"], 0.5)

    def test_poses_are_refused_with_their_line(self):
        self.cube()
        tool = self.file("tool.off", CUBE)
        for text, says in (("1 2 3\n", "1:"), (IDENTITY + "1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 x\n", "2:"),
                           (IDENTITY.replace("0 0 0 1\n", "0 0 1 1\n"), "1:"),
                           ("0 0 0 0  0 0 0 0  0 0 0 0  0 0 0 1\n", "1:"),
                           ("2 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1\n", "1:"),
                           ("-1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1\n", "1:"),
                           ("nan 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1\n", "1:")):
            with self.subTest(text):
                self.refused("dexel", "apply", self.path("m.tridexel"), "--tool", tool, "--poses",
                             self.file("poses.txt", text), "--out", self.path("o.tridexel"), says="poses.txt: line " + says)

    def test_cut_off_and_changed_files_are_refused(self):
        self.cube("--resolution", "6")
        whole = self.read("m.tridexel")
        for length in range(0, len(whole), max(1, len(whole) // 60)):
            self.refused("dexel", "info", self.file("t.tridexel", whole[:length]), says="t.tridexel")
        for at in range(8, len(whole), max(1, len(whole) // 60)):
            changed = bytearray(whole)
            changed[at] ^= 1 << at % 8
            self.refused("dexel", "info", self.file("t.tridexel", bytes(changed)), says="t.tridexel")

    def test_shared_meshes_are_models_or_sentences(self):
        folders = [os.path.join(SHARED, "data", "meshes", name) for name in ("bad", "formats")]
        if not all(map(os.path.isdir, folders)):
            self.skipTest("the shared meshes are not here")
        models = 0
        for folder in folders:
            for name in sorted(os.listdir(folder)):
                with self.subTest(name):
                    done = self.restroke("dexel", "build", os.path.join(folder, name), "--resolution", "24", "--out",
                                         self.path("s.tridexel"))
                    self.assertIn(done.returncode, (0, 2), done.stderr)
                    if done.returncode == 0:
                        models += 1
                        self.accepted("dexel", "info", self.path("s.tridexel"))
                    else:
                        self.assertIn(name, done.stderr)
        self.assertGreater(models, 3)


if __name__ == "__main__":
    bad_input.RESTROKE, GALLERY, SHARED = sys.argv[1:4]
    unittest.main(argv=sys.argv[:1])
