"""restroke export: meshes and points of logs, and mesh files of mesh files (SPEC S13), from outside.

  export.py RESTROKE GALLERY_LOG
"""
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import unittest
import zipfile

import bad_input
from bad_input import HEADER, STROKE, Case

GALLERY = None
MESHES = ("stl", "ply", "obj", "amf", "3mf")
CUBE = ("OFF\n8 6 0\n" + "".join("%d %d %d\n" % (i & 1, i >> 1 & 1, i >> 2) for i in range(8)) +
        "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n")


class Export(Case):
    def export(self, source, out, *arguments):
        done = self.accepted("export", source, "--out", self.path(out), "--json", "-", *arguments)
        return json.loads(done.stdout)


class Meshes(Export):
    def test_the_gallery_has_nothing_that_admesh_would_repair(self):
        made = self.export(GALLERY, "g.stl", "--resolution", "96")
        self.assertEqual(made["self_intersections"], 0)
        self.assertTrue(made["closed"])
        self.assertEqual(made["resolution"], 96)
        self.assertEqual(len(self.read("g.stl")), 84 + 50 * made["triangles"])
        # tests/sculpt compares with Monte Carlo; this is the whole way through the program, at another size.
        finer = self.export(GALLERY, "finer.obj", "--cell", str(made["cell"] * 0.6))
        self.assertGreater(finer["triangles"], 2 * made["triangles"])
        self.assertLess(abs(made["volume"] / finer["volume"] - 1), 0.01)
        if shutil.which("admesh") is None:
            self.skipTest("the program admesh is not installed")
        done = subprocess.run(["admesh", "--exact", "--normal-directions", self.path("g.stl")], capture_output=True,
                              text=True, errors="replace")  # it prints bytes behind the STL header's end
        self.assertEqual(done.returncode, 0, done.stderr)

        def value(label):
            found = re.search(re.escape(label) + r"\s*:\s*(\S+)", done.stdout)
            self.assertIsNotNone(found, done.stdout)
            return float(found[1])

        for label in ("Total disconnected facets", "Degenerate facets", "Edges fixed", "Facets removed", "Facets added",
                      "Facets reversed", "Backwards edges", "Normals fixed"):
            self.assertEqual(value(label), 0, label)
        self.assertEqual(value("Number of facets"), made["triangles"])
        # admesh sums in float32.
        self.assertLess(abs(value("Volume") / made["volume"] - 1), 1e-3)

    def test_every_format_becomes_every_other_with_nothing_lost(self):
        log = self.file("a.log", HEADER + STROKE)
        first = self.export(log, "a.stl", "--resolution", "24")
        self.assertGreater(first["triangles"], 1000)
        for source in MESHES:
            made = self.export(self.path("a.stl"), "from." + source)
            for target in MESHES:
                with self.subTest(source=source, target=target):
                    self.assertNotIn("cell", made)
                    again = self.export(self.path("from." + source), "to." + target)
                    self.assertEqual((again["vertices"], again["triangles"], again["closed"]),
                                     (first["vertices"], first["triangles"], True))
                    self.assertEqual(self.export(self.path("to." + target), "back.stl")["out"], self.path("back.stl"))
                    self.assertEqual(self.read("back.stl"), self.read("a.stl"))

    def test_formats_agree_about_a_log(self):
        log = self.file("a.log", HEADER + STROKE)
        made = [self.export(log, "a." + ending, "--resolution", "20") for ending in MESHES]
        for other in made[1:]:
            for key in ("vertices", "triangles", "cell", "volume", "area", "self_intersections"):
                self.assertEqual(other[key], made[0][key], key)

    def test_threads_and_repetition_change_no_byte(self):
        log = self.file("a.log", HEADER + STROKE)
        for ending in MESHES:
            written = set()
            for threads in ("1", "2", "8"):
                self.export(log, "a." + ending, "--resolution", "24", "--threads", threads)
                written.add(self.read("a." + ending))
            self.assertEqual(len(written), 1, ending)

    def test_ascii_stl_and_ply_hold_the_same_mesh(self):
        log = self.file("a.log", HEADER + STROKE)
        for ending, begin in (("stl", b"solid"), ("ply", b"ply\nformat ascii")):
            self.export(log, "text." + ending, "--cell", "0.1", "--ascii")
            self.export(log, "binary." + ending, "--cell", "0.1")
            self.assertTrue(self.read("text." + ending).startswith(begin))
            self.export(self.path("text." + ending), "text.obj")
            self.export(self.path("binary." + ending), "binary.obj")
            self.assertEqual(self.read("text.obj"), self.read("binary.obj"))

    def test_endings_count_in_any_case_and_stamp_lists_are_logs(self):
        stamps = self.file("a.stamps", "B 0 0 0 1\nS -1 1\n0 0 1 0.5\n")
        made = self.export(stamps, "A.STL", "--resolution", "30")
        self.assertLess(abs(made["volume"] - 3.9), 0.1)
        self.assertEqual(self.export(self.path("A.STL"), "A.Ply")["triangles"], made["triangles"])

    def test_a_mesh_file_is_told_by_its_contents(self):
        cube = self.export(self.file("cube.log", CUBE), "cube.stl")
        self.assertEqual((cube["vertices"], cube["triangles"], cube["volume"], cube["area"]), (8, 12, 1, 6))
        self.assertEqual(struct.unpack("<I", self.read("cube.stl")[80:84]), (12,))
        for begin in (b"{", b"B 0 0 0 1\n"):  # a binary STL file may have any header
            odd = self.file("odd.stl", begin.ljust(80, b" ") + self.read("cube.stl")[80:])
            self.assertEqual(self.export(odd, "odd.obj")["triangles"], 12)

    def test_an_open_mesh_is_converted_and_said_to_be_open(self):
        done = self.export(self.file("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "open.stl")
        self.assertEqual((done["triangles"], done["closed"], done["area"]), (1, False, 0.5))
        self.assertNotIn("volume", done)

    def test_unit_and_scale(self):
        cube = self.file("cube.off", CUBE)
        self.export(cube, "cube.amf")
        self.assertIn(b'unit="millimeter"', self.read("cube.amf"))
        self.export(cube, "cube.amf", "--unit", "m")
        self.assertIn(b'unit="meter"', self.read("cube.amf"))
        self.export(cube, "cube.3mf", "--unit", "cm")
        with zipfile.ZipFile(self.path("cube.3mf")) as archive:
            self.assertIn(b'unit="centimeter"', archive.read("3D/3dmodel.model"))
        self.assertEqual(self.export(cube, "cube.stl", "--scale", "2.5")["volume"], 15.625)
        self.assertEqual(self.export(self.path("cube.stl"), "cube.obj")["volume"], 15.625)
        log = self.file("a.log", HEADER.replace('"mm"', '"cm"') + STROKE)
        self.export(log, "a.obj", "--resolution", "10")
        self.assertIn(b"# unit centimeter", self.read("a.obj"))
        self.export(log, "a.obj", "--resolution", "10", "--unit", "mm")
        self.assertIn(b"# unit millimeter", self.read("a.obj"))

    def test_an_empty_shape_is_an_empty_mesh_with_a_note(self):
        stamps = self.file("a.stamps", "B 0 0 0 1\nS -1 1\n0 0 0 2\n")
        done = self.accepted("export", stamps, "--out", self.path("a.stl"), "--resolution", "10")
        self.assertIn("no triangles", done.stderr)
        self.assertEqual(len(self.read("a.stl")), 84)
        self.refused("export", stamps, "--out", self.path("a.3mf"), "--resolution", "10", says="a.3mf")


class Points(Export):
    def test_ply_of_a_log_is_points_unless_a_grid_is_asked_for(self):
        log = self.file("a.log", HEADER + STROKE)
        surfels = self.replay(log)["surfels"]
        points = self.export(log, "a.ply")
        self.assertEqual(points["surfels"], surfels)
        self.assertIn(b"element vertex %d\n" % surfels, self.read("a.ply"))
        self.assertNotIn(b"element face", self.read("a.ply"))
        mesh = self.export(log, "a.ply", "--resolution", "20")
        self.assertIn(b"element face %d\n" % mesh["triangles"], self.read("a.ply"))
        self.assertNotIn("surfels", mesh)

    def test_points_are_scaled_and_have_a_unit(self):
        log = self.file("a.log", HEADER)
        self.export(log, "a.ply", "--ascii", "--scale", "10", "--unit", "m")
        header, body = self.read("a.ply").split(b"end_header\n")
        self.assertIn(b"unit m\n", header)
        for line in body.splitlines()[:50]:
            x, y, z, nx, ny, nz, radius = map(float, line.split())
            self.assertAlmostEqual((x * x + y * y + z * z) ** 0.5, 10, 4)
            self.assertAlmostEqual(nx * nx + ny * ny + nz * nz, 1, 5)
            self.assertGreater(radius, 0.1)


class Refusals(Export):
    def test_options_that_make_no_sense(self):
        log = self.file("a.log", HEADER)
        for out, arguments, says in (
                ("x.obj", ["--ascii"], "--ascii"), ("x.amf", ["--ascii"], "--ascii"), ("x.3mf", ["--ascii"], "--ascii"),
                ("x.xyz", ["--ascii"], "--ascii"), ("x.xyz", ["--resolution", "9"], "--resolution"),
                ("x.xyz", ["--cell", "0.1"], "--cell"), ("x.stl", ["--cell", "0.1", "--resolution", "9"], "--cell"),
                ("x.stl", ["--resolution", "0"], "--resolution"), ("x.stl", ["--resolution", "4097"], "--resolution"),
                ("x.stl", ["--resolution", "1.5"], "--resolution"), ("x.stl", ["--cell", "0"], "--cell"),
                ("x.stl", ["--cell", "nan"], "--cell"), ("x.stl", ["--cell", "1e-12"], "cells of"),
                ("x.stl", ["--cell", "1e-4"], "grid"),
                ("x.stl", ["--scale", "0"], "--scale"), ("x.stl", ["--scale", "-1"], "--scale"),
                ("x.ply", ["--scale", "inf"], "--scale"), ("x.xyz", ["--scale", "1e60"], "finite"),
                ("x.stl", ["--scale", "1e60"], "finite"), ("x.stl", ["--unit", "inch"], "--unit"),
                ("x.stl", ["--density", "0"], "density"), ("x.gltf", [], ".gltf"), ("x", [], "must end in"),
                ("nowhere/x.stl", ["--resolution", "9"], "nowhere")):
            with self.subTest(out=out, arguments=arguments):
                self.refused("export", log, "--out", self.path(out), *arguments, says=says)

    def test_mesh_files_refuse_what_is_of_logs(self):
        cube = self.file("cube.off", CUBE)
        for arguments in (["--resolution", "9"], ["--cell", "0.1"], ["--density", "100"]):
            self.refused("export", cube, "--out", self.path("x.ply"), *arguments, says=arguments[0])
        self.refused("export", cube, "--out", self.path("x.xyz"), says="is a mesh")

    def test_sources_that_are_nothing(self):
        for text, says in (("", "empty"), ("hello\n", "does not begin with OFF"), ("OFF\n3 1 0\n0 0 0\n", "a.off"),
                           (CUBE.replace("4 1 3 7 5", "4 1 3 7 8"), "a.off"), ("{", "a.off:1")):
            self.refused("export", self.file("a.off", text), "--out", self.path("x.stl"), says=says)
        self.refused("export", self.path("missing.stl"), "--out", self.path("x.stl"), says="missing.stl")
        self.refused("export", self.folder, "--out", self.path("x.stl"), says="folder")

    def test_what_was_there_stays_when_the_export_is_refused(self):
        self.file("x.stl", "precious")
        self.refused("export", self.file("a.log", HEADER), "--out", self.path("x.stl"), "--scale", "1e60")

    def test_help_says_what_ply_is(self):
        self.assertIn(".ply gets points", self.accepted("export", "--help").stdout)


if __name__ == "__main__":
    bad_input.RESTROKE = os.path.abspath(sys.argv.pop(1))
    GALLERY = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
