#!/usr/bin/python3
"""The layering check against a small tree with mistakes planted in it."""

import contextlib
import io
import tempfile
import unittest
from pathlib import Path

import layering


class Layering(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.plant("implicit/side.h", "#pragma once\n")
        self.plant("points/surfel.h", '#pragma once\n#include <vector>\n\n#include "implicit/side.h"\n')
        self.plant("points/surfel.cpp", '#include "points/surfel.h"\n')
        self.plant("sculpt/cli/main.cpp", '#include "points/surfel.h"\n')
        self.plant("tests/points/surfel_test.cpp", '#include <gtest/gtest.h>\n#include "points/surfel.h"\n')

    def plant(self, name: str, text: str):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def exit_code(self, *arguments: str) -> int:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            return layering.main(list(arguments))

    def assert_one_offence(self, place: str, words: str):
        found = layering.offences(self.root)
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith(place + ": "), found[0])
        self.assertIn(words, found[0])
        self.assertEqual(self.exit_code(str(self.root)), 1)

    def test_includes_to_the_left_and_within_a_folder_pass(self):
        self.assertEqual(layering.offences(self.root), [])
        self.assertEqual(self.exit_code(str(self.root)), 0)

    def test_an_include_to_the_right_is_caught(self):
        self.plant("implicit/side.cpp", '#include "implicit/side.h"\n\n#include "points/surfel.h"\n')
        self.assert_one_offence("implicit/side.cpp:3", "stands to the right of implicit/")

    def test_an_include_to_the_right_is_caught_in_a_nested_folder_and_however_it_is_spaced(self):
        self.plant("retarget/methods/depth.cpp", '  #  include   "sculpt/cli/main.cpp"\n')
        self.assert_one_offence("retarget/methods/depth.cpp:1", "stands to the right of retarget/")

    def test_tests_are_included_by_tests_only(self):
        self.plant("tests/points/shapes.h", "#pragma once\n")
        self.plant("tests/points/more_test.cpp", '#include "tests/points/shapes.h"\n')
        self.assertEqual(layering.offences(self.root), [])
        self.plant("experiments/memory.cpp", '#include "tests/points/shapes.h"\n')
        self.assert_one_offence("experiments/memory.cpp:1", "stands to the right of experiments/")

    def test_a_relative_include_is_caught(self):
        self.plant("points/other.cpp", '#include "surfel.h"\n')
        self.assert_one_offence("points/other.cpp:1", "not given from the root")

    def test_an_include_that_climbs_out_of_its_folder_is_caught(self):
        self.plant("implicit/other.cpp", '#include "../points/surfel.h"\n')
        self.assert_one_offence("implicit/other.cpp:1", "not given from the root")

    def test_an_include_that_leaves_its_folder_and_enters_another_is_caught(self):
        self.plant("implicit/other.cpp", '#include "implicit/../points/surfel.h"\n')
        self.assert_one_offence("implicit/other.cpp:1", "not given from the root")

    def test_ours_in_angle_brackets_is_caught(self):
        self.plant("implicit/other.cpp", "#include <points/surfel.h>\n")
        self.assert_one_offence("implicit/other.cpp:1", "include it with quotes")

    def test_an_include_of_nothing_is_caught(self):
        self.plant("points/other.cpp", '#include "implicit/gone.h"\n')
        self.assert_one_offence("points/other.cpp:1", "does not exist")

    def test_a_generated_header_is_for_its_own_folder(self):
        self.plant("experiments/provenance.cpp", '#include "experiments_revision.h"\n')
        self.assertEqual(layering.offences(self.root), [])
        self.plant("sculpt/document.cpp", '#include "experiments_revision.h"\n')
        self.assert_one_offence("sculpt/document.cpp:1", "not given from the root")

    def test_a_commented_include_is_none(self):
        self.plant("implicit/other.cpp", '// #include "points/surfel.h"\n')
        self.assertEqual(layering.offences(self.root), [])

    def test_a_source_that_includes_its_own_header_late_or_never_is_caught(self):
        self.plant("implicit/side.cpp", '// Why.\n\n#include <vector>\n\n#include "implicit/side.h"\n')
        self.assert_one_offence("implicit/side.cpp:3", '"implicit/side.h", its own header')
        self.plant("implicit/side.cpp", '#define SIDE 1\n#include "implicit/side.h"\n')
        self.assert_one_offence("implicit/side.cpp:1", '"implicit/side.h", its own header')
        self.plant("implicit/side.cpp", "int side = 1;\n")
        self.assert_one_offence("implicit/side.cpp:1", '"implicit/side.h", its own header')
        self.plant("implicit/side.cpp", '// Why.\n\n#include "implicit/side.h"\n\n#include <vector>\n')
        self.assertEqual(layering.offences(self.root), [])

    def test_a_header_that_can_be_included_twice_is_caught(self):
        self.plant("implicit/other.h", "// Why.\n#pragma once\n")
        self.assertEqual(layering.offences(self.root), [])
        self.plant("implicit/other.h", "// Why.\n#include <vector>\n#pragma once\n")
        self.assert_one_offence("implicit/other.h:2", "#pragma once")
        self.plant("implicit/other.h", "// Why.\n")
        self.assert_one_offence("implicit/other.h:1", "#pragma once")

    def test_bad_usage_is_told_from_offences(self):
        self.assertEqual(self.exit_code(), 2)
        self.assertEqual(self.exit_code(str(self.root / "absent")), 2)
        (self.root / "empty").mkdir()
        self.assertEqual(self.exit_code(str(self.root / "empty")), 2)


if __name__ == "__main__":
    unittest.main()
