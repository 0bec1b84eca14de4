# SPDX-License-Identifier: BSD-2-Clause
"""`bis irradiance`: what it reads, writes and refuses. The figures themselves: tests/python/test_irradiance.py."""
import contextlib
import io
import os
import sys
import tempfile
import unittest

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
sys.path.insert(0, os.path.join(ROOT, "scripts/python"))
from bis.tools import irradiance  # noqa: E402

POINTS = np.array([(0, 0, 2, 0, 0, 1), (1.5, -2, 0.25, 0, 3, 0)])
SCENE = '''WorldBegin LightSource "infinite" "rgb L" [1 2 4] Material "diffuse" Translate 0 0 -1e4 Shape "sphere"'''


class Command(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(dir=os.path.join(ROOT, "build"))
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.save("scene.txt", SCENE)
        self.save("p.csv", "x,y,z,nx,ny,nz\n0,0,2,0,0,1 # up\n1.5 -2 .25; 0 3 0\n")

    def save(self, name, content):
        with open(os.path.join(self.folder, name), "wb") as f:
            f.write(content.encode() if isinstance(content, str) else content)

    def run_it(self, *words, status=0):
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            found = irradiance.main([w.replace("{}", self.folder) for w in words])
        self.assertEqual(found, status, err.getvalue())
        return out.getvalue(), err.getvalue().replace(self.folder, "{}")

    def test_points_of_each_kind_of_file(self):
        np.save(os.path.join(self.folder, "p.npy"), POINTS)
        head = "ply\nformat %s 1.0\nelement vertex 2\n" + "".join(
            "property float %s\n" % c for c in ("nx", "ny", "nz", "x", "y", "z", "s"))
        rows = np.concatenate((POINTS[:, 3:], POINTS[:, :3], np.ones((2, 1))), axis=1)
        tail = "element face 0\nproperty list uchar int vertex_indices\nend_header\n"
        self.save("a.ply", head % "ascii" + tail + "".join(" ".join(map(str, r)) + "\n" for r in rows))
        for name, form, order in (("l.ply", "binary_little_endian", "<f4"), ("b.ply", "binary_big_endian", ">f4")):
            self.save(name, (head % form + tail).encode() + rows.astype(order).tobytes())
        with open(os.path.join(self.folder, "a.ply"), "rb") as f:
            self.save("windows.ply", f.read().replace(b"\n", b"\r\n"))
        self.save("excel.csv", b"\xef\xbb\xbf" + b"0;0;2;0;0;1\r\n1.5;-2;.25;0;3;0\r\n")
        for name in ("p.csv", "p.npy", "a.ply", "l.ply", "b.ply", "windows.ply", "excel.csv"):
            np.testing.assert_array_equal(irradiance.read_points(os.path.join(self.folder, name)), POINTS, name)

    def test_what_arrives_is_written(self):
        words, _ = self.run_it("--points", "{}/p.csv", "{}/scene.txt", "--spp", "4")
        rows = np.loadtxt(io.StringIO(words), delimiter=",", skiprows=1)
        np.testing.assert_allclose(rows[:, :3], np.pi * np.array([(1, 2, 4)] * 2), rtol=0.02)
        self.run_it("--points", "{}/p.csv", "{}/scene.txt", "--spp", "4", "--scale", "179", "--out", "{}/e.npy")
        np.testing.assert_allclose(np.load(os.path.join(self.folder, "e.npy")), 179 * rows, rtol=6e-3)
        map_of_ours = os.path.join(ROOT, "data/maps/constant.exr")
        words, _ = self.run_it("--points", "{}/p.csv", map_of_ours, "--out", "{}/e.csv")
        with open(os.path.join(self.folder, "e.csv"), encoding="utf-8") as f:
            self.assertEqual(f.read().split("\n")[1:], ["3.14159,3.14159,3.14159,0,0,0"] * 2 + [""])

    def test_at_the_faces_and_vertices_of_a_mesh_in_lux(self):
        self.save("mesh.txt", '''WorldBegin LightSource "infinite" "rgb L" [1 2 4] Material "diffuse" Shape "disk"
            Shape "trianglemesh" "integer indices" [0 1 2 0 0 1 0 2 3] "point3 P" [0 0 9 2 0 9 2 2 9 0 2 9]''')
        E, eye = np.pi * np.array((1, 2, 4)), 0.2126 + 2 * 0.7152 + 4 * 0.0722
        words, _ = self.run_it("--points", "faces", "{}/mesh.txt", "--lm-per-w", "179")
        rows = np.genfromtxt(io.StringIO(words), delimiter=",", names=True)
        np.testing.assert_allclose(rows["x"], (4 / 3, 2 / 3, 2 / 3), rtol=1e-6)
        self.assertTrue(np.isnan(rows["lux"][1]))  # no area, no normal
        for k in (0, 2):
            np.testing.assert_allclose([rows[k][c] for c in ("z", "nx", "nz", "r", "g", "b")], (9, 0, 4, *E), rtol=1e-2)
            self.assertAlmostEqual(rows["lux"][k], 179 * np.pi * eye, delta=5)
        # Three channels may err together: the bound of lux is the sum. The twin forgets two of them.
        sum_of_bounds = 179 * (0.2126 * rows["interval_r"] + 0.7152 * rows["interval_g"] + 0.0722 * rows["interval_b"])
        np.testing.assert_allclose(rows["interval_lux"], sum_of_bounds, rtol=0.02)
        words, _ = self.run_it("--points", "vertices", "--shape", "1", "{}/mesh.txt", "--calibrate", "3=98000")
        rows = np.genfromtxt(io.StringIO(words), delimiter=",", names=True)
        np.testing.assert_allclose(rows["lux"], [98000] * 4, rtol=0.01)
        self.assertEqual(rows["lux"][3], 98000)
        map_of_ours = os.path.join(ROOT, "data/maps/constant.exr")
        words, _ = self.run_it("--points", "{}/p.csv", map_of_ours, "--scale", "3", "--calibrate", "E_up=5e4")
        self.assertEqual([line.split(",")[-2:] for line in words.split()[1:]], [["50000", "0"]] * 2)
        for at in ("4=1", "E_up=1", "0=0", "x=2", "1"):
            self.assertIn("--calibrate %s: give the number" % at, self.run_it(
                "--points", "vertices", "{}/mesh.txt", "--calibrate", at, status=2)[1])
        for words in (("--points", "faces", map_of_ours), ("--points", "{}/p.csv", "--shape", "1", "{}/mesh.txt"),
                      ("--points", "faces", "--lm-per-w", "9", "--calibrate", "0=9", "{}/mesh.txt")):
            self.run_it(*words, status=2)

    def test_what_cannot_be_is_refused(self):
        self.save("short.csv", "1,2,3,0,0,1\n1,2,3\n")
        self.save("words.csv", "1,2,3,0,0,1\n\n1,2,x,0,0,1\n")
        self.save("none.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n")
        self.save("many.ply", "ply\nformat ascii 1.0\nelement vertex many\nend_header\n")
        self.save("cut.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 9\n" + "".join(
            "property double %s\n" % c for c in irradiance.COLUMNS) + "end_header\n12345678")
        self.save("few.ply", "ply\nformat ascii 1.0\nelement vertex 3\n" + "".join(
            "property float %s\n" % c for c in irradiance.COLUMNS) + "end_header\n0 0 2 0 0 1\n")
        self.save("empty.csv", "")
        self.save("nan.csv", "nan,0,0,0,0,1\n0,0,2,0,0,1\n")
        np.save(os.path.join(self.folder, "words.npy"), np.full((2, 6), "a"))
        for name, message in (("short.csv", ":2: error: give six numbers"), ("words.csv", ":3: error: give six"),
                              ("none.ply", "no normals"), ("cut.ply", "ends within its vertices"),
                              ("many.ply", "how many vertices"),
                              ("empty.csv", "no points"), ("few.ply", "ends within"),
                              ("nan.csv", "error: point 0: give finite"), ("words.npy", "words.npy: error: it holds"),
                              ("gone.csv", "cannot read")):
            _, err = self.run_it("--points", "{}/" + name, "{}/scene.txt", status=1 if name == "gone.csv" else 2)
            self.assertIn(message, err)
        gz = os.path.join(ROOT, "data/maps/clouds_verticalcross.hdr.gz")
        self.run_it("--points", "{}/p.csv", gz, "--mapping", "verticalcross")
        for words in ((gz, "--spp", "9"), ("{}/scene.txt", "--mapping", "angular")):
            self.assertIn("leave it out", self.run_it("--points", "{}/p.csv", *words, status=2)[1])
        self.assertIn("--points is missing", self.run_it("{}/scene.txt", status=2)[1])
        _, err = self.run_it("--points", "{}/p.csv", "--out", "{}/p.csv", "{}/scene.txt", status=2)
        self.assertIn("would replace", err)


if __name__ == "__main__":
    unittest.main()
