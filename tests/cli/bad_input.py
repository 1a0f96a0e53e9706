"""The program restroke against bad input, full disks and crashes, from outside.

  bad_input.py RESTROKE

Every refusal: exit 2, one sentence on standard error, no partial output, existing files untouched.
"""
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

RESTROKE = None

HEADER = ('{"restroke":1,"unit":"mm","density":300,"grid":1.5258789e-05,'
          '"base":{"sphere":{"center":[0,0,0],"radius":1}}}\n')
CAMERA = ('"camera":{"position":[0,0,4],"view":[0,0,-1],"up":[0,1,0],"halfHeight":0.3,"viewport":[400,400],'
          '"near":0.1,"far":10}')
BRUSH = '"brush":{"radius":0.1,"spacing":0.25,"pressureToRadius":0,"mode":"add"}'


def stroke(points, camera=CAMERA, brush=BRUSH, method="exact"):
    return '{"stroke":{%s,%s,"method":"%s","points":%s}}\n' % (camera, brush, method, json.dumps(points))


STROKE = stroke([[2400 + 160 * i, 3200, 8 * i, 512] for i in range(11)])
PEN = {"width": 100, "height": 80, "strokes": [{"points": [[20, 40, 0.0, 0.5], [80, 40, 0.1, 0.5]]}]}


def pen(**change):
    return json.dumps({**PEN, **change})


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="restroke-test-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def file(self, name, text):
        with open(self.path(name), "wb") as f:
            f.write(text if isinstance(text, bytes) else text.encode())
        return self.path(name)

    def read(self, name):
        with open(self.path(name), "rb") as f:
            return f.read()

    def restroke(self, *arguments, **options):
        return subprocess.run([RESTROKE, *arguments], capture_output=True, text=True, **options)

    def refused(self, *arguments, says="", **options):
        before = {name: self.read(name) for name in os.listdir(self.folder) if os.path.isfile(self.path(name))}
        done = self.restroke(*arguments, **options)
        self.assertEqual(done.returncode, 2, "%s: %s" % (arguments, done.stderr))
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertTrue(done.stderr.startswith("restroke: "), done.stderr)
        self.assertIn(says, done.stderr)
        after = {name: self.read(name) for name in os.listdir(self.folder) if os.path.isfile(self.path(name))}
        self.assertEqual(before.keys(), after.keys(), "files came or went")
        for name in before:
            self.assertEqual(before[name], after[name], name)
        return done

    def accepted(self, *arguments, **options):
        done = self.restroke(*arguments, **options)
        self.assertEqual(done.returncode, 0, "%s: %s" % (arguments, done.stderr))
        return done

    def replay(self, log, *arguments):
        return json.loads(self.accepted("replay", log, "--json", "-", *arguments).stdout)


class Usage(Case):
    def test_unknown_words_are_refused(self):
        log = self.file("a.log", HEADER)
        for arguments in ([], ["sculpt"], ["replay"], ["replay", log, "--frob"], ["replay", log, "--threads", "-1"],
                          ["replay", log, "--threads", "x"], ["replay", log, "--density", "x"],
                          ["replay", log, "--density", "0"], ["replay", log, "--density", "nan"],
                          ["replay", log, "--density", "-5"], ["replay", log, "--density", "1e30"],
                          ["render", log], ["render", log, "--png", self.path("a.png"), "--view", "beside"],
                          ["render", log, "--png", self.path("a.png"), "--view", "stroke:1"],
                          ["render", log, "--png", self.path("a.png"), "--view", "0,0,3:0,0,0"],
                          ["render", log, "--png", self.path("a.png"), "--size", "0x10"],
                          ["render", log, "--png", self.path("a.png"), "--size", "10"],
                          ["render", log, "--png", self.path("a.png"), "--size", "65536x65536"],
                          ["render", log, "--png", self.path("a.png"), "--renderer", "pencil"],
                          ["export", log, "--out", self.path("a.dxf")], ["export", log, "--out", self.path("a")],
                          ["history", log, "frobnicate"], ["history", log, "undo"], ["history", log, "redo"],
                          ["retarget", log, "--method", "magic", "--out", self.path("b.log")],
                          ["retarget", log, "--base", "teapot.obj", "--out", self.path("b.log")],
                          ["retarget", log, "--base", "sphere:0,0,0,-1", "--out", self.path("b.log")],
                          ["retarget", log, "--base", "sphere:0,0,nan,1", "--out", self.path("b.log")],
                          ["retarget", log, "--transform", "scale 1 -2 1", "--out", self.path("b.log")],
                          ["retarget", log, "--transform", "scale 0", "--out", self.path("b.log")],
                          ["retarget", log, "--transform", "rotate 0 0 0 30", "--out", self.path("b.log")],
                          ["retarget", log, "--transform", "shear 1", "--out", self.path("b.log")],
                          ["retarget", log, "--transform", "translate 1e9 0 0", "--out", self.path("b.log")]):
            with self.subTest(arguments):
                self.refused(*arguments)

    def test_help_is_no_error(self):
        for arguments in (["--help"], ["replay", "--help"]):
            self.assertIn("restroke", self.accepted(*arguments).stdout)


class BadLogs(Case):
    def test_missing_and_odd_files(self):
        self.refused("replay", self.path("missing.log"), says="missing.log")
        self.refused("import", self.path("missing.json"), "--out", self.path("o.log"), says="missing.json")
        self.refused("replay", self.folder, says="folder")
        self.refused("replay", "/dev/zero", says="device")
        self.refused("replay", self.file("empty.log", ""), says="empty")
        if os.geteuid() != 0:
            os.chmod(self.file("secret.log", HEADER), 0)
            self.refused("replay", self.path("secret.log"), says="Permission denied")

    def test_malformed_lines_are_named(self):
        bad = {
            "not JSON": "{oops}\n",
            "binary": b"\xff\xfe\x00\x01\n",
            "NaN": STROKE.replace("[0,0,4]", "[0,NaN,4]"),
            "infinite": STROKE.replace("[0,0,4]", "[0,1e999,4]"),
            "absurd": STROKE.replace("[0,0,4]", "[0,1e300,4]"),
            "absurd point": stroke([[99999999999, 0, 0, 0]]),
            "negative radius": STROKE.replace('"radius":0.1', '"radius":-0.1'),
            "zero radius": STROKE.replace('"radius":0.1', '"radius":0'),
            "no points": stroke([]),
            "viewport of zero": STROKE.replace("[400,400]", "[400,0]"),
            "too deep": "[" * 100000 + "\n",
            "unknown key": '{"erase":{}}\n',
            "undo at the root": '{"undo":{}}\n{"undo":{}}\n',
            "fixed, negative radius": '{"fixed":{"mode":"add","stamps":[[0,0,1,-1]]}}\n',
            "fixed, too large": '{"fixed":{"mode":"add","stamps":[[0,0,1,1e7]]}}\n',
        }
        for name, line in bad.items():
            line = line if isinstance(line, bytes) else line.encode()
            log = self.file("a.log", HEADER.encode() + STROKE.encode() + line)
            at = 4 if name == "undo at the root" else 3
            for arguments in (["replay", log], ["history", log, "undo"], ["export", log, "--out", self.path("a.ply")],
                              ["render", log, "--png", self.path("a.png")],
                              ["retarget", log, "--out", self.path("b.log")]):
                with self.subTest(name=name, arguments=arguments):
                    self.refused(*arguments, says="a.log:%d: " % at)

    def test_newer_versions_say_what_is_needed(self):
        self.refused("replay", self.file("a.log", HEADER.replace(":1,", ":9,", 1)), says="version 9 is needed")

    def test_logs_cut_in_the_header_are_refused(self):
        for size in (1, 10, len(HEADER) - 1):
            self.refused("replay", self.file("a.log", HEADER[:size]), says="a.log:1")

    def test_stamp_lists(self):
        for text, says in (("B 0 0 0 -1\n", ":1: "), ("B 0 0 0 1\nS 1 3\n0 0 1 0.1\n", ":3: "), ("B nan 0 0 1\n", ":1: "),
                           ("B 0 0 0 1\nS 1 1\n0 0 1 0\n", ":3: ")):
            self.refused("replay", self.file("a.stamps", text), says="a.stamps" + says)
        stamps = self.file("a.stamps", "B 0 0 0 1\nS 1 1\n0 0 1 0.1\n")
        self.refused("history", stamps, "undo", says="stamp list")
        self.refused("history", stamps, "show", says="stamp list")
        self.refused("retarget", stamps, "--out", self.path("b.log"), says="stamp list")
        self.assertEqual(self.replay(stamps)["primitives"], 2)
        self.accepted("import", stamps, "--out", self.path("b.log"))
        self.assertEqual(self.replay(self.path("b.log"))["state_hash"], self.replay(stamps)["state_hash"])

    def test_a_torn_last_line_is_dropped_and_cut_off_by_the_next_append(self):
        log = self.file("a.log", HEADER + STROKE + STROKE + STROKE[:-20])
        done = self.accepted("replay", log, "--json", "-")
        self.assertIn("a.log:4: the last line is torn", done.stderr)
        self.assertEqual(json.loads(done.stdout)["strokes"], 2)
        self.assertEqual(self.read("a.log").decode(), HEADER + STROKE + STROKE + STROKE[:-20])
        self.accepted("history", log, "undo")
        self.assertEqual(self.read("a.log").decode(), HEADER + STROKE + STROKE + '{"undo":{}}\n')
        self.assertEqual(self.accepted("replay", log).stderr, "")

    def test_a_stroke_that_hits_nothing_says_so(self):
        done = self.accepted("replay", self.file("a.log", HEADER + stroke([[1, 1, 0, 0], [2, 2, 0, 0]])), "--json", "-")
        self.assertIn("a.log:2: the stroke hits nothing", done.stderr)
        result = json.loads(done.stdout)
        self.assertEqual((result["primitives"], result["misses"], result["strokes"]), (1, 2, 1))


class BadPenStrokes(Case):
    def test_each_kind_has_its_sentence(self):
        point = lambda text: '{"width":100,"height":80,"strokes":[{"points":[%s]}]}' % text
        bad = {
            "truncated": (pen()[:-10], "ends in the middle"),
            "not JSON": ("{width}", "not valid JSON"),
            "zero strokes": (pen(strokes=[]), "at least 1 stroke"),
            "no points": (pen(strokes=[{"points": []}]), "at least 1 point"),
            "width 0": (pen(width=0), "width is 0"),
            "missing": (json.dumps({"width": 1, "strokes": []}), "height is missing"),
            "NaN": (point("[NaN,0,0,0]"), "not valid JSON"),
            "infinite": (point("[1e999,0,0,0]"), "overflows"),
            "absurd": (point("[1e12,0,0,0]"), "strokes[0].points[0][0]"),
            "a string": (point('["1",0,0,0]'), "strokes[0].points[0][0]"),
            "pressure": (point("[1,0,0,2]"), "strokes[0].points[0][3]"),
        }
        for name, (text, says) in bad.items():
            with self.subTest(name):
                self.refused("import", self.file("a.json", text), "--out", self.path("o.log"), says=says)
                self.file("o.log", "precious")
                self.refused("import", self.file("a.json", text), "--out", self.path("o.log"), says=says)
                os.remove(self.path("o.log"))

    def test_options_out_of_range(self):
        source = self.file("a.json", pen())
        for arguments in (["--radius", "0"], ["--radius", "-1"], ["--radius", "nan"], ["--radius", "inf"], ["--radius", "1e9"],
                          ["--density", "-1"], ["--mode", "dig"], ["--base", "bunny.off"], ["--fill", "0"],
                          ["--base", "sphere:0,0,0,0"]):
            with self.subTest(arguments):
                self.refused("import", source, "--out", self.path("o.log"), *arguments, says=arguments[0])

    def test_one_point_strokes_and_repeated_points_are_strokes(self):
        source = self.file("a.json", pen(strokes=[{"points": [[50, 40, 0, 0.5]]}, {"points": [[50, 40, 0, 0.5]] * 5}]))
        self.accepted("import", source, "--out", self.path("o.log"))
        result = self.replay(self.path("o.log"), "--check")
        self.assertEqual((result["primitives"], result["strokes"], result["stroke_points"]), (3, 2, 6))

    def test_a_million_points_are_a_stroke(self):
        points = [[50 + 30 * ((i % 1000) / 1000 - 0.5), 40 + 30 * (i / 1e6 - 0.5), i * 0.001, 0.5] for i in range(1000000)]
        source = self.file("a.json", pen(strokes=[{"points": points}]))
        self.accepted("import", source, "--radius", "0.2", "--density", "5", "--out", self.path("o.log"))
        self.assertEqual(self.replay(self.path("o.log"))["stroke_points"], 1000000)


# A tetrahedron, the same without a face, and inside out.
OFF = "OFF\n4 %d 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
FACES = ["3 0 2 1\n", "3 0 1 3\n", "3 1 2 3\n", "3 0 3 2\n"]
CLOSED = OFF % 4 + "".join(FACES)
OPEN = OFF % 3 + "".join(FACES[:3])
INWARDS = OFF % 4 + "".join("3 " + " ".join(reversed(face.split()[1:])) + "\n" for face in FACES)


class Meshes(Case):
    """Bases and tips that are meshes from files (S13)."""

    def both(self, base, *more):
        """The commands that take a base, with one."""
        source, log = self.file("a.json", pen()), self.file("a.log", HEADER + STROKE)
        return [["import", source, "--base", base, "--out", self.path("o.log"), *more],
                ["retarget", log, "--base", base, "--out", self.path("o.log"), *more]]

    def test_files_that_are_no_solid_are_refused(self):
        bad = {
            "missing.off": (None, "is no file"),
            "words.off": ("a mesh would be nice\n", "words.off"),
            "cut.off": (CLOSED[:-9], "cut.off"),
            "nothing.off": ("OFF\n0 0 0\n", "no triangles"),
            "open.off": (OPEN, "3 edges belong to one triangle only"),
            "inwards.off": (INWARDS, "inside out"),
        }
        for name, (text, says) in bad.items():
            base = self.path(name) if text is None else self.file(name, text)
            for arguments in self.both(base):
                with self.subTest(name=name, command=arguments[0]):
                    done = self.refused(*arguments, says=says)
                    self.assertIn("--base: ", done.stderr)
                    self.assertIn(name, done.stderr)

    def test_repair_must_be_winding_and_find_a_solid(self):
        for arguments in self.both(self.file("open.off", OPEN), "--repair", "glue"):
            self.refused(*arguments, says="--repair: ")
        sheet = self.file("sheet.off", OFF % 1 + FACES[0])
        for arguments in self.both(sheet, "--repair", "winding"):
            self.refused(*arguments, says="sheet.off: no solid can be made of this mesh")

    def test_a_mesh_without_faults_is_a_base_and_a_tip_and_nothing_is_said(self):
        mesh = self.file("closed.off", CLOSED)
        for more in ([], ["--repair", "winding"]):
            for arguments in self.both(mesh, *more):
                self.assertEqual(self.accepted(*arguments).stderr.count("no boundary"), 0)
                self.assertNotIn(b"repair", self.read("o.log"))
                self.replay(self.path("o.log"), "--check")
        self.accepted("import", self.path("a.json"), "--tip", mesh, "--out", self.path("o.log"))
        self.assertGreater(self.replay(self.path("o.log"), "--check")["primitives"], 1)

    def test_a_repair_is_said_and_the_log_gives_the_same_again(self):
        for name, text, says in (("open.off", OPEN, "generalised winding number at resolution"),
                                 ("inwards.off", INWARDS, "turned around")):
            # Every use of a log repairs the file again, which takes seconds: one command has to do for it.
            commands = self.both(self.file(name, text), "--repair", "winding")
            for arguments in commands if name == "inwards.off" else commands[:1]:
                with self.subTest(name=name, command=arguments[0]):
                    done = self.accepted(*arguments)
                    notes = [line for line in done.stderr.splitlines() if "no boundary of a solid" in line]
                    self.assertEqual(len(notes), 1, done.stderr)
                    self.assertIn(name, notes[0])
                    self.assertIn(says, notes[0])
                    self.assertIn(b'"repair":"winding"', self.read("o.log"))
                    first = self.replay(self.path("o.log"), "--check", "--threads", "1")
                    again = self.replay(self.path("o.log"), "--threads", "2")
                    self.assertEqual(first["state_hash"], again["state_hash"])
                    if name == "inwards.off":
                        self.accepted("retarget", self.path("o.log"), "--out", self.path("p.log"))
                        self.assertEqual(self.replay(self.path("p.log"))["state_hash"], first["state_hash"])
        tip = self.accepted("import", self.path("a.json"), "--tip", self.path("inwards.off"), "--repair", "winding",
                            "--out", self.path("o.log"))
        self.assertIn("inwards.off is no boundary of a solid", tip.stderr)
        self.replay(self.path("o.log"), "--check")

    def test_logs_whose_mesh_is_another_one_or_gone_are_refused(self):
        mesh = self.file("closed.off", CLOSED)
        self.accepted(*self.both(mesh)[0])
        log = self.path("o.log")
        self.replay(log, "--check")
        uses = (["replay", log], ["render", log, "--png", self.path("a.png")],
                ["export", log, "--out", self.path("a.ply")], ["retarget", log, "--out", self.path("b.log")])
        for text in (CLOSED.replace("0 0 1", "0 0 2", 1), OPEN):
            self.file("closed.off", text)
            for arguments in uses:
                self.refused(*arguments, says="has the hash")
        os.remove(mesh)
        for arguments in uses:
            self.assertIn("o.log:1: ", self.refused(*arguments, says="closed.off").stderr)

    def test_a_mesh_takes_any_transform_and_a_torus_only_similarities(self):
        retarget = self.both(self.file("closed.off", CLOSED))[1]
        self.accepted(*retarget, "--transform", "scale 1 2 1; rotate 0 1 0 30")
        torus = ["retarget", self.path("a.log"), "--base", "torus:radius=1,tube=0.4", "--out", self.path("t.log")]
        self.refused(*torus, "--transform", "scale 1 2 1", says="a torus can only be turned, scaled evenly and moved")
        self.accepted(*torus, "--transform", "scale 2; rotate 0 1 0 30")

    def test_a_mesh_cannot_be_swept(self):
        source, mesh = self.file("a.json", pen()), self.file("closed.off", CLOSED)
        self.refused("import", source, "--tip", mesh, "--trace", "sweep", "--out", self.path("o.log"), says="sweep")


class Disks(Case):
    def outputs(self, folder):
        log, source = self.file("in.log", HEADER + STROKE), self.file("in.json", pen())
        at = lambda name: os.path.join(folder, name)
        return [["import", source, "--out", at("o.log")],
                ["retarget", log, "--out", at("o.log")],
                ["export", log, "--density", "8000", "--out", at("o.ply")],
                ["export", log, "--density", "8000", "--out", at("o.xyz")],
                ["render", log, "--size", "200x200", "--png", at("o.png")],
                ["render", log, "--size", "200x200", "--exr", at("o.exr")],
                ["replay", log, "--json", at("o.json")]]

    def check_refused_in(self, folder, **options):
        for arguments in self.outputs(folder):
            with self.subTest(arguments[0], out=arguments[-1]):
                before = sorted(os.listdir(folder))
                done = self.restroke(*arguments, **options)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
                self.assertIn(arguments[-1], done.stderr)
                self.assertEqual(sorted(os.listdir(folder)), before)

    def test_a_missing_folder(self):
        for arguments in self.outputs(self.path("nowhere")):
            self.refused(*arguments, says="nowhere")

    def test_files_that_may_not_grow(self):
        # As a full disk: write fails after some bytes. The signal's disposition is the program's matter.
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (64, 64))
        os.mkdir(self.path("out"))
        self.check_refused_in(self.path("out"), preexec_fn=limit)
        log = self.file("a.log", HEADER + STROKE)
        # Appending to a log: it stays as it was.
        self.refused("history", log, "undo", preexec_fn=limit, says="a.log")

    def mounted(self, options):
        folder = self.path("mount")
        os.mkdir(folder)
        done = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", folder], capture_output=True, text=True)
        if done.returncode != 0:
            self.skipTest("cannot mount a tmpfs here: " + done.stderr.strip())
        self.addCleanup(subprocess.run, ["umount", "-l", folder])
        return folder

    def test_a_full_disk(self):
        folder = self.mounted("size=64k")
        log = os.path.join(folder, "a.log")
        with open(log, "w") as f:
            f.write(HEADER + STROKE)
        with open(os.path.join(folder, "ballast"), "wb", buffering=0) as f:
            try:
                while True:
                    f.write(b"x" * 4096)
            except OSError:
                pass
        self.check_refused_in(folder)
        with open(log) as f:
            self.assertEqual(f.read(), HEADER + STROKE)

    def test_a_read_only_disk(self):
        folder = self.mounted("size=1m")
        log = os.path.join(folder, "a.log")
        with open(log, "w") as f:
            f.write(HEADER + STROKE)
        subprocess.run(["mount", "-o", "remount,ro", folder], check=True)
        self.check_refused_in(folder)
        self.refused("history", log, "undo", says="a.log")
        self.assertEqual(self.replay(log)["strokes"], 1)

    def test_standard_output_that_is_full(self):
        log = self.file("a.log", HEADER + STROKE)
        for arguments in (["replay", log], ["replay", log, "--json", "-"]):
            with open("/dev/full", "w") as full:
                done = subprocess.run([RESTROKE, *arguments], stdout=full, stderr=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn("standard output", done.stderr)


class Crashes(Case):
    def test_x6_a_log_survives_kills_at_any_moment(self):
        """Undo and redo are killed at random moments; what is left is always a log of whole lines, never shorter than before."""
        log = self.file("a.log", HEADER + STROKE + STROKE + STROKE)
        seed = random.randrange(1 << 30)
        rng = random.Random(seed)
        lines = 0
        for _ in range(60):
            before = self.read("a.log")
            before = before[:before.rfind(b"\n") + 1]
            action = "undo" if rng.random() < 0.5 else "redo"
            process = subprocess.Popen([RESTROKE, "history", log, action], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(rng.random() * 0.03)
            process.send_signal(signal.SIGKILL)
            process.wait()
            after = self.read("a.log")
            self.assertTrue(after.startswith(before), "seed %d" % seed)
            lines = after.count(b"\n") - 4
        self.accepted("replay", log, "--check")
        print("kills: %d lines of 60 were appended" % lines, file=sys.stderr)

    def test_x6_two_processes_append_whole_lines(self):
        log = self.file("a.log", HEADER + STROKE * 12)
        processes = [subprocess.Popen([RESTROKE, "history", log, "undo"], stdout=subprocess.DEVNULL) for _ in range(6)]
        self.assertEqual([p.wait() for p in processes], [0] * 6)
        self.assertEqual(self.read("a.log").count(b'{"undo":{}}\n'), 6)
        self.accepted("replay", log)


class Commands(Case):
    def test_history_walks_and_branches(self):
        log = self.file("a.log", HEADER + STROKE + STROKE.replace("3200", "3500"))
        first = self.replay(log)["state_hash"]
        self.accepted("history", log, "undo")
        second = self.replay(log, "--check")["state_hash"]
        self.assertNotEqual(first, second)
        self.accepted("history", log, "redo")
        self.assertEqual(self.replay(log, "--check")["state_hash"], first)
        self.refused("history", log, "redo", says="nothing lies ahead")
        self.accepted("history", log, "undo")
        with open(log, "a") as f:
            f.write(STROKE.replace("3200", "2900").replace('"add"', '"carve"'))
        tree = json.loads(self.accepted("history", log, "show", "--json", "-").stdout)
        self.assertEqual(tree["cursor"], 3)
        self.assertEqual([n["parent"] for n in tree["nodes"]], [None, 0, 1, 1])
        self.assertEqual(tree["nodes"][3]["mode"], "carve")
        text = self.accepted("history", log, "show").stdout
        self.assertIn("├─+ 2", text)
        self.assertIn("> └─- 3", text)

    def test_replay_has_the_contracts_keys_and_threads_change_nothing(self):
        log = self.file("a.log", HEADER + STROKE)
        result = self.replay(log, "--threads", "1")
        self.assertEqual(sorted(result), sorted(
            ["primitives", "strokes", "stroke_points", "surfels", "misses", "state_hash", "history_bytes", "model_bytes",
             "log_bytes", "seconds", "simd", "stamp_us"]))
        self.assertEqual(sorted(result["stamp_us"]), ["max", "p50", "p99"])
        self.assertEqual(result["log_bytes"], len(HEADER + STROKE))
        self.assertEqual(self.replay(log, "--threads", "2")["state_hash"], result["state_hash"])
        self.accepted("replay", log, "--json", self.path("r.json"))
        self.assertEqual(json.loads(self.read("r.json"))["state_hash"], result["state_hash"])

    def test_retarget_moves_the_base_and_records_what_depends_on_the_machine(self):
        log = self.file("a.log", HEADER + STROKE + '{"undo":{}}\n' + STROKE + '{"fixed":{"mode":"carve","stamps":[[0,0,1,0.2]]}}\n')
        out = self.path("b.log")
        result = json.loads(self.accepted("retarget", log, "--transform", "rotate 0 1 0 90; translate 0 0 0.5; scale 0.9",
                                          "--out", out, "--json", "-").stdout)
        self.assertEqual([s["points"] for s in result["strokes"]], [11, 11])
        self.assertEqual(result["overall"]["points"], 22)
        self.assertEqual(self.replay(out, "--check")["state_hash"], result["overall"]["state_hash"])
        self.assertIn(b'"center":[0,0,0.45],"radius":0.9', self.read("b.log"))
        # Unchanged, `exact` again: the same shape.
        self.accepted("retarget", log, "--out", out)
        self.assertEqual(self.replay(out)["state_hash"], self.replay(log)["state_hash"])
        self.accepted("retarget", log, "--method", "embree", "--out", out)
        self.assertIn(b'"outcome"', self.read("b.log"))
        self.assertEqual(self.replay(out, "--recompute", "--check")["differences"], 0)
        altered = self.read("b.log").replace(b'"misses":0', b'"misses":1', 1)
        self.assertEqual(self.replay(self.file("c.log", altered), "--recompute")["differences"], 1)

    def test_render_and_export_write_their_files(self):
        log = self.file("a.log", HEADER + STROKE)
        png, exr = self.path("a.png"), self.path("a.exr")
        for view in ("front", "back", "left", "right", "top", "bottom", "three-quarter", "stroke:1", "-1,0,3:0.3,0,-1"):
            self.accepted("render", log, "--view", view, "--size", "64x48", "--png", png, "--exr", exr)
            self.assertEqual(self.read("a.png")[:8], b"\x89PNG\r\n\x1a\n")
            self.assertEqual(self.read("a.exr")[:4], b"\x76\x2f\x31\x01")
        surfels = self.replay(log)["surfels"]
        self.accepted("export", log, "--out", self.path("a.xyz"))
        self.assertEqual(self.read("a.xyz").count(b"\n"), surfels)
        self.accepted("export", log, "--ascii", "--out", self.path("a.PLY"))
        self.assertIn(b"element vertex %d\n" % surfels, self.read("a.PLY"))

    def test_experiment_is_handed_on(self):
        if not os.path.exists(os.path.join(os.path.dirname(RESTROKE), "restroke-experiment")):
            self.refused("experiment", "memory", says="restroke-experiment")
        else:
            self.assertIn("memory", self.accepted("experiment", "--help").stdout)


if __name__ == "__main__":
    RESTROKE = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
