"""restroke history and restroke retarget from outside: the tree edited by one line a command, refused in one
sentence, drawn, and the same after a replay of the file (SPEC S8).

  history.py RESTROKE RABBIT-LOG
"""
import json
import os
import shutil
import sys
import unittest
import xml.etree.ElementTree as xml

import bad_input
from bad_input import BRUSH, HEADER

RABBIT = None


def stroke(row, mode="add", method="exact"):
    return bad_input.stroke([[2400 + 160 * i, row, 8 * i, 512] for i in range(11)],
                            brush=BRUSH.replace('"add"', '"%s"' % mode), method=method)


class Case(bad_input.Case):
    def log(self, *lines, name="a.log"):
        return self.file(name, HEADER + "".join(lines))

    def text(self, path):
        with open(path) as file:
            return file.read()

    def json(self, *arguments):
        return json.loads(self.accepted(*arguments, "--json", "-").stdout)

    def hash(self, log, *arguments):
        return self.json("replay", log, *arguments)["state_hash"]


class Edits(Case):
    def test_every_edit_is_one_line_and_survives_a_replay(self):
        log = self.log(stroke(3200), stroke(3200, "carve"), stroke(3000), stroke(3400))
        drawn = self.hash(log)
        for arguments, line in [
                (["cancel", "1"], {"cancel": {"node": 1}}),
                (["restore", "1"], {"restore": {"node": 1}}),
                (["goto", "2"], {"goto": {"node": 2}}),
                (["copy", "3", "--to", "2", "--single"], {"copy": {"node": 3, "to": 2, "single": True}}),
                (["move", "4", "--to", "1"], {"move": {"node": 4, "to": 1}}),
                (["move", "1", "--to", "2", "--single"], {"move": {"node": 1, "to": 2, "single": True}}),
                (["cancel", "2", "--branch"], {"cancel": {"node": 2, "branch": True}}),
                (["restore", "2", "--branch"], {"restore": {"node": 2, "branch": True}}),
                (["redo"], {"redo": {}}), (["undo"], {"undo": {}})]:
            before = self.text(log)
            done = self.restroke("history", log, *arguments)
            self.assertEqual(done.returncode, 0, done.stderr)
            after = self.text(log)
            self.assertTrue(after.startswith(before))
            self.assertEqual(json.loads(after[len(before):]), line)
            self.assertEqual(self.restroke("replay", log, "--check").returncode, 0, arguments)
        shown = self.json("history", log, "show")
        self.assertEqual(len(shown["nodes"]), 6)
        self.assertEqual(shown["cursor"], 2)
        self.assertEqual([n["parent"] for n in shown["nodes"]], [None, 2, 0, 2, 0, 2])
        self.assertNotEqual(self.hash(log), drawn)

    def test_a_cancelled_stroke_is_as_if_it_had_not_been_drawn(self):
        log = self.log(stroke(3200), stroke(3200, "carve"), stroke(2400))
        report = self.json("history", log, "cancel", "1")
        self.assertEqual(report["retargeted"], 1)
        self.assertEqual(report["changed"], 1)
        self.assertEqual(self.hash(log), self.hash(self.log(stroke(3200, "carve"), stroke(2400), name="b.log")))

    def test_another_base_and_a_transform_are_nodes_under_all_strokes(self):
        log = self.log(stroke(3200))
        self.json("history", log, "base", "sphere:0,0,0,0.8")
        self.json("history", log, "transform", "translate 0.1 0 0; scale 1.1")
        kinds = [(n["kind"], n["parent"]) for n in self.json("history", log, "show")["nodes"]]
        self.assertEqual(kinds, [("base", None), ("stroke", 0), ("base", 1), ("transform", 2)])
        self.assertEqual(self.restroke("replay", log, "--check").returncode, 0)
        self.restroke("history", log, "goto", "1")
        self.assertEqual(self.hash(log), self.hash(self.log(stroke(3200), name="b.log")))

    def test_what_depends_on_the_machine_is_recorded_with_the_edit(self):
        log = self.log(stroke(3200), stroke(3200, method="embree"))
        self.json("history", log, "cancel", "1")
        line = json.loads(self.text(log).splitlines()[-1])
        self.assertEqual([r["node"] for r in line["cancel"]["recasts"]], [2])
        self.assertGreater(len(line["cancel"]["recasts"][0]["stamps"]), 3)
        # Replay uses what is recorded: with fewer stamps there is another shape.
        before = self.hash(log)
        line["cancel"]["recasts"][0]["stamps"] = line["cancel"]["recasts"][0]["stamps"][:1]
        rows = self.text(log).splitlines()[:-1] + [json.dumps(line)]
        with open(log, "w") as file:
            file.write("\n".join(rows) + "\n")
        self.assertNotEqual(self.hash(log), before)
        self.assertEqual(self.hash(log, "--recompute"), before)

    def test_an_aligned_stroke_follows_its_base_and_its_camera_is_recorded(self):
        log = self.log(stroke(3200, method="aligned"))
        with open(log) as file:
            text = file.read().replace('{"sphere":{"center":[0,0,0],"radius":1}}',
                                       '{"ellipsoid":{"x":1,"y":0.6,"z":0.8,"position":[0.1,0,0]}}')
        with open(log, "w") as file:
            file.write(text)
        self.json("history", log, "transform", "translate 0.2 0 0")
        line = json.loads(self.text(log).splitlines()[-1])
        recast = line["transform"]["recasts"][0]
        self.assertEqual(recast["node"], 1)
        self.assertIn("position", recast["camera"])
        self.assertEqual(self.restroke("replay", log, "--check").returncode, 0)


class Retargeting(Case):
    def measures(self, method, *arguments):
        log = self.log(stroke(3200), stroke(2800), name="%s.log" % method)
        result = self.json("retarget", log, "--method", method, "--out", self.path(method + "-out.log"), *arguments)
        self.assertEqual(self.restroke("replay", self.path(method + "-out.log"), "--check").returncode, 0, method)
        return result

    def test_measures_tell_the_methods_apart(self):
        move = ("--transform", "translate 0.3 0.1 0; rotate 0 0 1 20")
        follows = self.measures("mapped", *move)["overall"]["measures"]
        self.assertLess(follows["error_max"], 2e-6)
        self.assertEqual(follows["missed"], 0)
        stays = self.measures("fixed", *move)["overall"]["measures"]
        self.assertGreater(stays["error_rms"], 0.2)
        self.assertAlmostEqual(stays["stretch_median"], 1, places=5)
        cast = self.measures("exact", *move, "--surface-distance")
        self.assertLess(cast["overall"]["measures"]["surface_distance_max"], 1e-6)
        self.assertLess(cast["overall"]["measures"]["drift_max_pixels"], 1e-3)
        self.assertGreater(cast["overall"]["measures"]["error_rms"], 0.01)
        self.assertEqual(len(cast["strokes"]), 2)
        self.assertIn("error_rms", cast["strokes"][0]["measures"])

    def test_another_base_has_no_truth_but_every_method_a_result(self):
        for method in ("exact", "fixed", "nearest", "mapped", "surface", "aligned", "depth-cpu"):
            result = self.measures(method, "--base", "sphere:0,0,0,0.9")["overall"]
            self.assertNotIn("error_rms", result["measures"], method)
            self.assertGreater(result["stamps"], 10, method)


class Refusals(Case):
    def test_each_in_one_sentence_and_the_log_unchanged(self):
        log = self.log(stroke(3200), stroke(3000), '{"cancel":{"node":2}}\n')
        for arguments, says in [
                (["cancel", "9"], "cancel: node 9 does not exist, but must be one of 0 to 2"),
                (["cancel", "2"], "cancel: node 2 is cancelled already, but must not be"),
                (["restore", "1"], "restore: node 1 is not cancelled, but must be"),
                (["cancel", "0"], "cancel: node 0 is the root"),
                (["move", "0", "--to", "1"], "move: node 0 is the root"),
                (["move", "1", "--to", "2"], "move: node 2 lies in the branch of node 1"),
                (["move", "1"], "--to is \"\", but must be the number of a node"),
                (["goto", "x"], "the node is \"x\", but must be the number of a node"),
                (["goto", "1", "--to", "2"], "--to is given, but has no meaning here"),
                (["undo", "1"], "an argument is given, but has no meaning here"),
                (["undo", "--single"], "--single is given, but has no meaning here"),
                (["goto", "3"], "goto: node 3 does not exist"),
                (["redo"], "redo: nothing lies ahead"),
                (["base", "no-such-file.stl"], "no-such-file.stl"),
                (["transform", "scale 0"], "scales by a factor that is not more than 0"),
                (["transform", "turn 1"], "\"turn 1\" is not understood"),
                (["prune", "1"], "\"prune\" is not an action")]:
            self.refused("history", log, *arguments, says=says)

    def test_a_log_whose_command_refers_to_a_later_node_names_the_line(self):
        log = self.log(stroke(3200), '{"cancel":{"node":2}}\n', stroke(3000))
        for command in (["replay", log], ["history", log, "show"], ["history", log, "undo"]):
            done = self.restroke(*command)
            self.assertEqual(done.returncode, 2)
            self.assertIn(log + ":3: cancel: node 2 does not exist", done.stderr)

    def test_malformed_edits_name_the_line_and_the_rule(self):
        for line, says in [('{"cancel":{}}', "node"), ('{"goto":{"node":-1}}', "the number of a node"),
                           ('{"goto":{"node":1.5}}', "the number of a node"),
                           ('{"move":{"node":1,"to":0,"single":1}}', "true or false"),
                           ('{"undo":{"node":1}}', "node"), ('{"copy":{"node":1,"to":0,"recasts":[]}}', "recasts"),
                           ('{"transform":{"matrix":[1,2,3]}}', "12 numbers"),
                           ('{"transform":{"matrix":[0,0,0,0,0,1,0,0,0,0,1,0]}}', "determinant"),
                           ('{"base":{"shape":{"cube":{}}}}', "cube")]:
            log = self.log(stroke(3200), line + "\n")
            done = self.restroke("replay", log)
            self.assertEqual(done.returncode, 2, line)
            self.assertIn(log + ":3", done.stderr)
            self.assertIn(says, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

    def test_a_base_file_that_has_changed_is_refused(self):
        mesh = self.path("cube.off")
        cube = ("OFF\n8 12 0\n" + "".join("%d %d %d\n" % (x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)) +
                "3 0 1 3\n3 0 3 2\n3 4 6 7\n3 4 7 5\n3 0 4 5\n3 0 5 1\n3 2 3 7\n3 2 7 6\n3 0 2 6\n3 0 6 4\n"
                "3 1 5 7\n3 1 7 3\n")
        with open(mesh, "w") as file:
            file.write(cube)
        log = self.log(stroke(3200))
        self.json("history", log, "base", mesh)
        with open(mesh, "w") as file:
            file.write(cube.replace("1 1 1", "1 1 2"))
        self.refused("history", log, "cancel", "1", says="hash")


class Drawing(Case):
    def test_the_tree_is_drawn_as_in_the_papers_figure_9(self):
        log = self.log(stroke(3200), stroke(3200, "carve"), '{"undo":{}}\n', stroke(3000), '{"cancel":{"node":1}}\n')
        drawing = self.path("tree.svg")
        done = self.restroke("history", log, "show", "--svg", drawing)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("x 1", done.stdout)
        root = xml.parse(drawing).getroot()
        texts = [t.text for t in root.iter("{http://www.w3.org/2000/svg}text")]
        for number in "0123":
            self.assertIn(number, texts)
        whole = self.text(drawing)
        for colour in ("#ffffff", "#cf3b32", "#3565c4", "#ffd21f"):  # root, add, carve, cursor
            self.assertIn(colour, whole)
        self.assertIn('opacity="0.35"', whole)

    def test_a_drawing_that_cannot_be_written_is_refused_before_the_work(self):
        self.refused("history", self.log(stroke(3200)), "show", "--svg", "/no/such/folder/tree.svg", says="/no/such/folder")


class Shipped(Case):
    def test_the_rabbit_is_edited_and_every_state_is_that_of_a_replay(self):
        log = self.path("rabbit.log")
        shutil.copy(RABBIT, log)
        before = self.hash(log, "--density", "300")
        self.json("history", log, "cancel", "5")
        self.json("history", log, "goto", "60")
        self.json("history", log, "copy", "61", "--to", "30")
        self.json("history", log, "move", "10", "--to", "20", "--single")
        done = self.restroke("replay", log, "--check", "--density", "300")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.json("history", log, "move", "10", "--to", "9", "--single")
        self.json("history", log, "move", "11", "--to", "10")
        self.json("history", log, "restore", "5")
        last = max(n["node"] for n in self.json("history", RABBIT, "show")["nodes"])
        self.json("history", log, "goto", str(last))
        self.assertEqual(self.hash(log, "--density", "300"), before)


if __name__ == "__main__":
    bad_input.RESTROKE = os.path.abspath(sys.argv.pop(1))
    RABBIT = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
