"""What the tests of `restroke experiment NAME` from outside share."""

import os
import shutil
import subprocess
import tempfile
import unittest


class ExperimentCase(unittest.TestCase):
    RESTROKE = ""
    NAME = ""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="restroke-test-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def run_experiment(self, *arguments):
        return subprocess.run([self.RESTROKE, "experiment", self.NAME, *arguments], capture_output=True, text=True,
                              stdin=subprocess.DEVNULL, check=False)

    def refused(self, *arguments, says):
        done = self.run_experiment(*arguments)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn(says, done.stderr)
