"""The paper's figure 10 by hand: the README's commands make the shipped log, and its tree is drawn readably (SPEC S8, S9).

  figure10.py RESTROKE SOURCE_DIR
"""
import os
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

RESTROKE = SOURCE = None
SVG = "{http://www.w3.org/2000/svg}"


class Readme(unittest.TestCase):
    def test_its_commands_make_the_shipped_log(self):
        with open(os.path.join(SOURCE, "README.md"), encoding="utf-8") as file:
            blocks = [block for block in re.findall(r"```sh\n(.*?)```", file.read(), re.S) if "figure10.log" in block]
        self.assertEqual(len(blocks), 1)
        self.assertIn("cmp head.log experiments/examples/figure10.log", blocks[0])
        with tempfile.TemporaryDirectory() as folder:
            os.symlink(os.path.join(SOURCE, "experiments"), os.path.join(folder, "experiments"))
            environment = dict(os.environ, PATH=os.path.dirname(RESTROKE) + os.pathsep + os.environ["PATH"])
            done = subprocess.run(["bash", "-euo", "pipefail", "-c", blocks[0]], cwd=folder, env=environment,
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            with open(os.path.join(folder, "tree.svg"), encoding="utf-8") as made, \
                    open(os.path.join(SOURCE, "experiments", "examples", "figure10-tree.svg"), encoding="utf-8") as shipped:
                self.assertEqual(made.read(), shipped.read())


class Drawing(unittest.TestCase):
    def drawing(self, log):
        """Size, icons (number -> x, y, width, height, opacity) and links (lists of points) of the log's tree."""
        with tempfile.TemporaryDirectory() as folder:
            svg = os.path.join(folder, "tree.svg")
            done = subprocess.run([RESTROKE, "history", log, "show", "--svg", svg], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            root = ElementTree.parse(svg).getroot()
        icons = {}
        for group in root.iter(SVG + "g"):
            title = group.find(SVG + "title")
            if title is None:
                continue
            icon = group.find(SVG + "g")
            rect = icon.find(SVG + "rect")
            number = int(icon.find(SVG + "text").text)
            self.assertTrue(title.text.startswith("%d " % number), title.text)
            self.assertNotIn(number, icons)
            icons[number] = tuple(int(rect.get(key)) for key in ("x", "y", "width", "height")) + (float(icon.get("opacity")), )
        links = []
        for path in root.iter(SVG + "path"):
            points = []
            for letter, numbers in re.findall(r"([MHV])([\d ]+)", path.get("d")):
                if letter == "M":
                    x, y = map(int, numbers.split())
                elif letter == "H":
                    x = int(numbers)
                else:
                    y = int(numbers)
                points.append((x, y))
            links.append(points)
        return (int(root.get("width")), int(root.get("height"))), icons, links

    def check(self, log, nodes):
        (width, height), icons, links = self.drawing(log)
        self.assertEqual(sorted(icons), list(range(nodes)))
        self.assertEqual(len(links), nodes - 1)
        self.assertEqual(len({icon[:2] for icon in icons.values()}), nodes, "two icons in one place")
        self.assertLess(width, 1200, "long rows are to be folded")
        for x, y, w, h, _ in icons.values():
            self.assertTrue(0 <= x and x + w <= width and 0 <= y and y + h <= height)
        for points in links:
            for (x0, y0), (x1, y1) in zip(points, points[1:]):
                self.assertTrue(x0 == x1 or y0 == y1)
                for number, (x, y, w, h, _) in icons.items():
                    crosses = min(x0, x1) < x + w and max(x0, x1) > x and min(y0, y1) < y + h and max(y0, y1) > y
                    self.assertFalse(crosses, "a link crosses icon %d" % number)
        return icons

    def test_of_figure_10(self):
        icons = self.check(os.path.join(SOURCE, "experiments", "examples", "figure10.log"), 44)
        self.assertEqual([number for number in sorted(icons) if icons[number][4] < 1], [24, 25, 26])

    def test_of_one_long_branch(self):
        self.check(os.path.join(SOURCE, "experiments", "examples", "rabbit.log"), 71)

    def test_of_branches_that_leave_late(self):
        """From strokes near the right edge, and from folded rows, branches that are folded themselves."""
        example = os.path.join(SOURCE, "experiments", "examples", "paper-scale.log")
        with tempfile.TemporaryDirectory() as folder:
            log = os.path.join(folder, "a.log")
            with open(example, encoding="utf-8") as file:
                lines = file.readlines()
            strokes = lines[2:9]
            with open(log, "w", encoding="utf-8") as file:
                file.writelines(lines[:2])
                nodes = 2
                for at in (0, 20, 22, 23, 24, 40, 22, 50):
                    file.write('{"goto":{"node":%d}}\n' % min(at, nodes - 1))
                    for i in range(40 if at in (0, 22) else 3):
                        file.write(strokes[i % len(strokes)])
                        nodes += 1
            self.check(log, nodes)


if __name__ == "__main__":
    RESTROKE, SOURCE = os.path.abspath(sys.argv.pop(1)), os.path.abspath(sys.argv.pop(1))
    unittest.main()
