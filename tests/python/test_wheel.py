# SPDX-License-Identifier: BSD-2-Clause
"""What the wheel promises: pip makes it, and in an empty place it renders and samples without a
compiler."""
import glob
import importlib.util
import os
import subprocess
import sys
import tempfile
import unittest
import zipfile

import numpy as np

from test_bis import MAP, ROOT, SCENE

USE = """
import os, sys
import bis
assert os.path.realpath(bis.__file__).startswith(os.path.realpath(sys.prefix)), bis.__file__
em = bis.Envmap(sys.argv[1])
print(b"".join(a.tobytes() for a in em.sample(1000, seed=1)).hex())
print(bis.render(sys.argv[2], accelerator="grid").rgb.tobytes().hex())
assert any(p for p in open("/proc/self/maps") if "site-packages/bis/libbis.so" in p)
"""


def skips():
    """Why there can be no wheel here, or None."""
    for module in ("pip", "venv"):
        if importlib.util.find_spec(module) is None:
            return "this Python has no " + module
    return None


@unittest.skipIf(skips(), skips())
class Wheel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        at = cls.folder.name
        # Without the network: what pip would fetch for the build is optional, and numpy is the one of this Python.
        cls.pip("wheel", "--no-deps", "--no-index", "--no-build-isolation", "-w", at, ROOT)
        cls.wheel = glob.glob(os.path.join(at, "*.whl"))[0]
        cls.venv = os.path.join(at, "venv")
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", cls.venv], check=True)
        cls.python = os.path.join(cls.venv, "bin", "python")
        site = subprocess.run([cls.python, "-c", "import site; print(site.getsitepackages()[0])"], check=True,
                              capture_output=True, text=True).stdout.strip()
        cls.pip("install", "--no-deps", "--no-index", "--target", site, cls.wheel)
        os.symlink(os.path.dirname(np.__file__), os.path.join(site, "numpy"))
        for libs in glob.glob(os.path.join(os.path.dirname(os.path.dirname(np.__file__)), "numpy.libs")):
            os.symlink(libs, os.path.join(site, "numpy.libs"))
        cls.scene = os.path.join(at, "scene.txt")
        with open(cls.scene, "w") as f:
            f.write(SCENE)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @staticmethod
    def pip(*arguments):
        r = subprocess.run([sys.executable, "-m", "pip", "-q", "--disable-pip-version-check", *arguments],
                           capture_output=True, text=True)
        if r.returncode:
            raise AssertionError("pip %s failed:\n%s%s" % (" ".join(arguments), r.stdout, r.stderr))

    def run_in_venv(self, *arguments, path=""):
        """Python of the venv, in another folder, without a PATH where a compiler could be."""
        return subprocess.run([self.python, *arguments], cwd=self.folder.name, env={"PATH": path}, capture_output=True,
                              text=True)

    def test_it_renders_and_samples(self):
        r = self.run_in_venv("-c", USE, MAP, self.scene)
        self.assertEqual(r.returncode, 0, r.stderr)
        samples, picture = r.stdout.split()
        import bis

        self.assertEqual(samples, b"".join(a.tobytes() for a in bis.Envmap(MAP).sample(1000, seed=1)).hex())
        self.assertEqual(picture, bis.render(self.scene, accelerator="grid").rgb.tobytes().hex())

    def test_it_is_the_program_too(self):
        r = self.run_in_venv("-m", "bis", self.scene, "--outfile", "out.pfm", "--quiet")
        self.assertEqual((r.returncode, r.stderr), (0, ""))
        self.assertTrue(os.path.exists(os.path.join(self.folder.name, "out.pfm")))
        r = self.run_in_venv("-m", "bis", "trade", "--help")
        self.assertIn("bis trade", r.stdout)
        r = self.run_in_venv("-m", "bis", "nothing.txt")
        self.assertEqual(r.returncode, 1)
        self.assertIn("cannot open", r.stderr)

    def test_without_the_program_it_says_so(self):
        program = os.path.join(self.venv, "hidden")
        here = glob.glob(os.path.join(self.venv, "lib/python*/site-packages/bis/program/bis"))[0]
        os.rename(here, program)
        try:
            r = self.run_in_venv("-m", "bis", "scene.txt")
            self.assertIn("is not installed", r.stderr)
            self.assertEqual(r.returncode, 1)
            # An installed one takes its place.
            os.mkdir(os.path.join(self.venv, "elsewhere"))
            os.symlink(program, os.path.join(self.venv, "elsewhere", "bis"))
            r = self.run_in_venv("-m", "bis", "--version", path=os.path.join(self.venv, "elsewhere"))
            self.assertTrue(r.stdout.startswith("bis "), r.stderr)
        finally:
            os.rename(program, here)

    def test_it_holds_what_it_should(self):
        with zipfile.ZipFile(self.wheel) as z:
            names = z.namelist()
            info = [n for n in names if n.endswith("METADATA")][0]
            text = z.read(info).decode()
        import bis

        for name in ("bis/__init__.py", "bis/py.typed", "bis/libbis.so", "bis/program/bis"):
            self.assertIn(name, names)
        self.assertFalse([n for n in names if n.endswith(".pyc")])
        self.assertTrue([n for n in names if n.endswith("licenses/LICENSE")])
        self.assertIn("Version: %s\n" % bis.version(), text)
        self.assertIn("Requires-Dist: numpy", text)


if __name__ == "__main__":
    unittest.main()
