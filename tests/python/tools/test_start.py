# SPDX-License-Identifier: BSD-2-Clause
"""How `bis NAME` becomes Python: a python3 that has numpy, help without it, own programs, another build."""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

PROGRAM = os.path.abspath(os.environ.get("BIS_PROGRAM", "build/release/bis"))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
sys.path.insert(0, os.path.join(ROOT, "scripts/python"))
from bis import _library  # noqa: E402

INSTRUMENTS = ("trade", "pixel", "envmap", "judge", "tev")


class Start(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.bare = self.script("bin/python3", 'exec "%s" -S -E "$@"' % sys.executable)  # has no numpy

    def script(self, name, line):
        path = os.path.join(self.folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as f:
            f.write("#!/bin/sh\n%s\n" % line)
        os.chmod(path, 0o755)
        return path

    def bis(self, *arguments, **variables):
        return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, cwd=self.folder,
                              env={**os.environ, **variables})

    def test_help_needs_no_numpy(self):
        for name in INSTRUMENTS:
            for words in ((name, "--help"), ("help", name)):
                done = self.bis(*words, BIS_PYTHON=self.bare)
                self.assertEqual((done.returncode, done.stderr), (0, ""), words)
                self.assertTrue(done.stdout.startswith("usage: bis " + name), words)
        page = self.bis("help", "--man", BIS_PYTHON=self.bare)
        self.assertEqual((page.returncode, page.stderr), (0, ""))
        self.assertEqual(page.stdout, self.bis("help", "--man", BIS_PYTHON=sys.executable).stdout)

    def test_without_numpy_the_message_says_what_to_install(self):
        for python in (self.bare, os.path.join(self.folder, "missing")):
            done = self.bis("trade", "scene.txt", BIS_PYTHON=python)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn("bis trade needs Python 3.9 or later with numpy (tried: %s)" % python, done.stderr)

    def test_a_file_of_the_working_folder_is_no_module(self):
        for name in ("numpy.py", "types.py"):
            with open(os.path.join(self.folder, name), "w", encoding="utf-8") as f:
                f.write("raise SystemExit(9)\n")
        self.assertIn("needs Python", self.bis("pixel", "scene.txt", BIS_PYTHON=self.bare).stderr)
        self.assertIn("cannot open", self.bis("envmap", "none.hdr", BIS_PYTHON=sys.executable).stderr)

    def test_a_program_on_path_is_a_command(self):
        path = os.path.dirname(self.script("own/bis-mine", 'echo "mine: $*"; exit 3'))
        done = self.bis("mine", "a b", PATH=path + os.pathsep + os.environ["PATH"])
        self.assertEqual((done.returncode, done.stdout), (3, "mine: a b\n"))

    def test_the_library_of_another_build_is_refused(self):
        code = "import bis; bis.points('sobol', 4)"
        package = os.path.join(ROOT, "scripts/python")
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": package, "BIS_BUILD_ID": "0" * 16})
        self.assertEqual(done.returncode, 1)
        self.assertIn("another build", done.stderr)

    def test_the_last_place_of_the_library_is_the_systems(self):
        with mock.patch("ctypes.util.find_library", lambda name: "lib%s.so.0" % name), \
                mock.patch.dict(os.environ, {"BIS_LIBRARY": ""}):
            self.assertEqual(_library._candidates()[-1], "libbis.so.0")

    def test_a_program_without_its_library_measures_by_no_other_one(self):
        alone = os.path.join(self.folder, "alone", "bis")
        os.makedirs(os.path.dirname(alone))
        shutil.copy(PROGRAM, alone)
        programs = os.path.join(ROOT, "scripts/python")
        done = subprocess.run([alone, "envmap", "none.hdr"], capture_output=True, text=True,
                              env={**os.environ, "PATH": programs + os.pathsep + os.environ["PATH"],
                                   "BIS_PYTHON": sys.executable})
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn(os.path.join(self.folder, "alone/library/libbis.so"), done.stderr)


if __name__ == "__main__":
    unittest.main()
