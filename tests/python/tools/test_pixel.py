# SPDX-License-Identifier: BSD-2-Clause
"""`bis pixel`: a report by hand, whose figures stand in this file, as text, JSON, tables and page; and the command on a
scene with closed forms. That text, JSON and tables agree with one another is tested figure by figure; what the figures
are worth, in tests/python/test_stage.py."""
import base64
import contextlib
import csv
import io
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from types import SimpleNamespace
from unittest import mock

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
sys.path.insert(0, os.path.join(ROOT, "scripts/python"))
from bis._stage import Candidates, Densities, Exact, Radiance, Rays, Runs, Sphere  # noqa: E402
from bis.tools import pixel, text  # noqa: E402

NONE = math.nan
SCENE = """Film "rgb" "integer xresolution" 8 "integer yresolution" 4
Integrator "sir" "integer candidates" 60 "integer shadowrays" 5
LookAt 0 0 10  0 0 0  0 1 0
Camera "orthographic" "float screenwindow" [-4 4 -2 2]
WorldBegin
%sMaterial "phong" "rgb Kd" [0.4 0.3 0.2] "rgb Ks" [0.3 0.3 0.3] "float exponent" 30
Shape "trianglemesh" "point3 P" [-4 -2 0  -2 -2 0  -2 2 0  -4 2 0] "integer indices" [0 1 2  0 2 3]
Translate 0 0 -1
Shape "sphere" "float radius" 1.5
Shape "trianglemesh" "point3 P" [1.6 -2 0  3 -2 0  1.6 9 0] "integer indices" [0 1 2]
%s"""
MAP = 'LightSource "infinite" "string filename" "map.pfm"\n'
WALL = ('Shape "trianglemesh" "point3 P" [-1.9 -9 1  -1.9 9 1  -1.9 9 9  -1.9 -9 9] "integer indices" '
        "[0 1 2  0 2 3]\n")


# ---- a report by hand: a constant light (1, .5, .25), turned by 90 degrees, on a diffuse surface that faces z ----

class Turned:
    """What the report asks of a stage."""

    @staticmethod
    def angles(w):
        w = np.asarray(w, float).reshape(-1, 3)
        phi = np.degrees(np.arctan2(w[:, 1], w[:, 0])) - 90
        return np.stack([np.degrees(np.arctan2(np.hypot(w[:, 0], w[:, 1]), w[:, 2])), phi % 360], 1)

    @staticmethod
    def look(w):
        z = np.maximum(np.asarray(w, float).reshape(-1, 3)[:, 2], 0)
        return Densities(np.full(len(z), 1 / (4 * np.pi)), z / np.pi, 0.5 * z / np.pi)

    @staticmethod
    def sphere(columns, rows, sub):
        cosine = np.maximum(np.cos(np.pi * (np.arange(rows) + 0.5) / rows), 0)[:, None] * np.ones(columns)
        x = np.arange(columns)
        product = 0.5 * cosine / np.pi
        seen = product * ((x > 180) & (x < 540))
        fields = 0 * cosine + 1 / (4 * np.pi), 0.9 * cosine / np.pi, product, seen
        return Sphere(*(np.float32(f) for f in fields))


def radiance(rgb, se, total, total_se):
    return Radiance(np.array(rgb), np.array(se), total, total_se)


def method(name, settings, total, se, z, skewness, true_skewness, error, rays, shown=None):
    is_open = name == "unoccluded"
    mean = radiance([1.0, 2.0, 3.0], [0.1, 0.2, 0.3], total, se)
    found = Runs(np.zeros((50, 3), np.float32), mean, z, skewness, true_skewness, error, rays, 3.5)
    return pixel.Method(name, "a claim of " + name, is_open, settings, found, 0 if is_open else 3, shown)


def by_hand(**changed):
    wi = np.float32([[0, 0, 0], [0, 1, 0], [0.6, 0, 0.8], [0, -1, 0], [-0.6, 0, 0.8]])
    c = Candidates(wi, np.array([0, 1, 4, 100, 0.01]), np.array([0, 1, 0, 1, 0]) > 0, np.uint32([0, 0, 3, 1, 0]),
                   np.array([0, 0, 1, 0, 0]) > 0, np.array([NONE, 0.5, 1, 5, 9]), np.array([NONE, 0.25, 2, 6, 10]),
                   np.array([NONE, 0.75, 3, 7, 11]), np.array([0.0, 7, 4, 8, 12]), 4, 5.0, 30.0, 2.125, 0.625, 0.4, 2,
                   4, 2, 3, np.array([0.1, 0.2, 0.3]), np.array([0.25, 0.5, 0.75]))
    rays = Rays(np.float32([[0.6, 0, 0.8], [0, 0, -1]]), np.uint32([1, 0]), np.array([True, False]))
    none = Rays(rays.wi[:0], rays.sample[:0], rays.seen[:0])
    hit = {"shape": "plymesh", "file": "mesh.ply", "line": 8, "triangle": 6, "distance": 2.5, "point": [1, 2, 3],
           "normal": [0, 0, 1], "geometric_normal": [0, 0, 1], "wo": [0.6, 0, 0.8], "mirrored": [-0.6, 0, 0.8],
           "cos_wo": 0.8, "material": {"model": "phong", "Kd": [0.3, 0.2, 0.4], "Ks": [0, 0, 0], "exponent": 20,
                                       "alpha": None, "p_specular": 0}}
    about = {"scene": "dir/scene.txt", "light": "maps/sky.exr", "map_width": 100, "width": 8, "height": 4, "seed": 5,
             "x": 3, "y": 2, "hit": hit, "lobe": {"name": "exponent", "value": 20}, "nothing": None}
    exact = Exact(radiance([1.0, 2, 3], [0.1, 0.2, 0.3], 6.0, 0.5), radiance([2.0, 4, 6], [0.4, 0.5, 0.6], 12.0, 0.25),
                  True, 100, 250, np.zeros(3), np.zeros(3))
    sir = {"integrator": "sir", "candidates": 64, "shadowrays": 4}
    plain = {"integrator": "rejection", "candidates": 800, "shadowrays": 15, "estimator": "plain"}
    methods = [method("em", {"integrator": "em", "samples": 16}, 6.5, 0.25, 2.0, 0.05, 0.06, 0.5, 16.0, rays),
               method("rejection plain", plain, 6.0, 0.5, -1.5, 0.05, -0.2, NONE, 7.25, none),
               method("sir", sir, 9.0, 0.125, NONE, NONE, NONE, 1.25, 4.0, Rays(*(a[:1] for a in rays))),
               method("unoccluded", {"integrator": "unoccluded", "candidates": 64}, 12.0, 0.5, 0.5, -0.2, NONE, 0.25,
                      0.0)]
    report = pixel.Report(Turned(), about, "out", False, 50, exact, methods, c)
    for name, value in changed.items():
        setattr(report, name, value)
    return report


TEXT = """pixel       (3, 2) of 8 x 4, dir/scene.txt
shape       plymesh "mesh.ply" of line 8, triangle 6; 2.5 from the eye
point       (1 2 3)
normal      (0 0 1)   in the map: theta 0.00, phi 270.00 degrees
to the eye  (0.6 0 0.8)   in the map: theta 36.87, phi 270.00 degrees
mirrored    (-0.6 0 0.8)   in the map: theta 36.87, phi 90.00 degrees
material    phong, exponent 20, Kd (0.3 0.2 0.4), Ks (0 0 0); seen at 36.87 degrees

reflected radiance, r+g+b and (r g b), by 250 rays, at least 2 in each patch above the horizon, of 100
exact       6 +- 0.5   (1 2 3)
unoccluded  12 +- 0.2   (2 4 6)
seen        50.00 %

method               draws        mean         +- of exact        z error of one     rays
em                      16         6.5       0.25   1.0833    2.00          50 %       16
rejection plain     15/800           6        0.5   1.0000   -1.50?            -     7.25
sir                   4/64           9       0.12   1.5000        -        125 %        4
unoccluded              64          12        0.5   1.0000    0.50?         25 %        0
Means of 50 estimates; z: the difference from exact (unoccluded: from that) in standard errors; error of one: the
root mean square difference of a single estimate from exact; rays: cast by one. z with a ?: rare and bright estimates
make the mean too skew for its standard error, which misses what has not been hit: ask for more --repeats.

one estimate by sir
candidates  5 drawn, 2 from the map, 3 from the BRDF; 4 weigh something
weights     sum 5, mean 1 (estimates 12); the largest is 62.5 % of all
effective   sample size 2.125 = (sum w)^2 / sum w^2
chosen      4 rays at 2 candidates, 3 of them see the light
estimate    0.6   (0.1 0.2 0.3)

written     out/methods.csv candidates.csv rays.csv
"""
TABLES = {
    "methods.csv": """method,repeats,r,g,b,sum,se_r,se_g,se_b,se_sum,z,skewness,relative_error,rays,accepted
exact,,1,2,3,6,0.1,0.2,0.3,0.5,,,,,
without visibility,,2,4,6,12,0.4,0.5,0.6,0.25,,,,,
em,50,1,2,3,6.5,0.1,0.2,0.3,0.25,2,0.05,0.5,16,
rejection plain,50,1,2,3,6,0.1,0.2,0.3,0.5,-1.5,0.05,,7.25,3.5
sir,50,1,2,3,9,0.1,0.2,0.3,0.125,,,1.25,4,
unoccluded,50,1,2,3,12,0.1,0.2,0.3,0.5,0.5,-0.2,0.25,0,
""", "candidates.csv": """candidate,from,theta_deg,phi_deg,x,y,z,q_map,q_brdf,q,product,weight,share,chosen,seen
0,brdf,,,,,,,,,0,0,0,0,
1,map,90,0,0,1,0,0.5,0.25,0.75,7,1,0.2,0,
2,brdf,36.87,270,0.6,0,0.8,1,2,3,4,4,0.8,3,1
3,map,90,180,0,-1,0,5,6,7,8,100,20,1,0
4,brdf,36.87,90,-0.6,0,0.8,9,10,11,12,0.01,0.002,0,
""", "rays.csv": """method,sample,theta_deg,phi_deg,x,y,z,q_map,q_brdf,product,seen
em,1,36.87,270,0.6,0,0.8,0.079577,0.254648,0.127324,1
em,0,180,270,0,0,-1,0.079577,0,0,0
sir,1,36.87,270,0.6,0,0.8,0.079577,0.254648,0.127324,1
"""}


def numbers(line):
    """The fields of a line; numbers rounded, since directions are floats."""
    found = []
    for field in line.split(","):
        try:
            found.append(round(float(field), 3))
        except ValueError:
            found.append(field)
    return found


class ByHand(unittest.TestCase):
    maxDiff = None

    def test_the_text_has_each_figure_in_its_place(self):
        self.assertEqual(pixel.text_of(by_hand()), TEXT)

    def test_the_text_knows_what_is_not_known(self):
        r = by_hand(html=True)
        hit, e, c = r.about["hit"], r.exact, r.candidates
        hit.update(shape="sphere", file=None, triangle=None, geometric_normal=[0, 1, 0])
        r.exact = Exact(*[radiance([0.0] * 3, [0.1] * 3, 0.0, 0.5)] * 2, False, 100, 0, e.variance, e.third)
        r.candidates = Candidates(*[NONE if k == "share_of_map" else 0.0 if k == "weights" else v
                                    for k, v in vars(c).items()])
        words = pixel.text_of(r)
        for part in ("sphere of line 8; 2.5", "of the face (0 1 0)   in the map: theta 90.00, phi 0.00 degrees",
                     "by 16384 runs of mis; 100 patches are too many for their sum", "\nseen        -\n",
                     "em                      16         6.5       0.25        -    2.00 ",
                     "5 drawn; 4 weigh something\n", "written     out/pixel.html methods.csv"):
            self.assertIn(part, words)
        self.assertNotIn("weights     sum", words)

    def test_the_json_has_each_figure_under_its_name(self):
        j = json.loads(text.json(pixel.json_of(by_hand())))
        self.assertEqual(list(j), ["scene", "x", "y", "width", "height", "seed", "hit", "nothing", "exact",
                                   "unoccluded", "methods", "candidates", "folder"])
        self.assertEqual(j["hit"], by_hand().about["hit"])
        self.assertEqual(j["exact"], {"by": "patches", "patches": 100, "radiance": [1, 2, 3],
                                      "standard_error": [0.1, 0.2, 0.3], "sum": 6, "sum_standard_error": 0.5})
        self.assertEqual(j["unoccluded"]["standard_error"], [0.4, 0.5, 0.6])
        rows = [[m[k] for k in ("method", "samples", "candidates", "shadowrays", "repeats", "sum", "sum_standard_error",
                                "z", "skewness", "relative_error", "rays", "accepted")] for m in j["methods"]]
        self.assertEqual(rows, [
            ["em", 16, None, None, 50, 6.5, 0.25, 2, 0.05, 0.5, 16, None],
            ["rejection plain", None, 800, 15, 50, 6, 0.5, -1.5, 0.05, None, 7.25, 3.5],
            ["sir", None, 64, 4, 50, 9, 0.125, None, None, 1.25, 4, None],
            ["unoccluded", None, 64, None, 50, 12, 0.5, 0.5, -0.2, 0.25, 0, None]])
        self.assertEqual(list(j["candidates"].values()), [5, 0.4, 4, 5, 30, 2.125, 0.625, 4, 2, 3, [0.1, 0.2, 0.3],
                                                          [0.25, 0.5, 0.75]])

    def test_tables_have_each_figure_in_its_column(self):
        with tempfile.TemporaryDirectory() as folder:
            pixel.write_files(by_hand(folder=folder))
            self.assertEqual(sorted(os.listdir(folder)), sorted(TABLES))
            for name, expected in TABLES.items():
                with open(os.path.join(folder, name)) as f:
                    found = f.read().split("\n")
                self.assertEqual([numbers(line) for line in found], [numbers(line) for line in expected.split("\n")])

    def test_the_page_has_rays_candidates_and_marks(self):
        d = pixel._page_data(by_hand())
        s = d["sphere"]
        self.assertEqual((s["width"], s["height"], s["top"], s["decades"]), (720, 360, 0, 7))
        for name, angles in (("n", (0, 270)), ("eye", (36.8699, 270)), ("R", (36.8699, 90))):
            np.testing.assert_allclose([s[name]["theta_deg"], s[name]["phi_deg"]], angles, atol=1e-4)
        self.assertEqual([list(m.values()) for m in d["shown"]], [
            ["em", 3, 2, False], ["rejection plain", 3, 0, True], ["sir", 3, 1, False], ["unoccluded", 0, 0, True]])
        self.assertEqual([(r["method"], r["sample"], r["seen"]) for r in d["rays"]],
                         [("em", 1, True), ("em", 0, False), ("sir", 1, True)])
        self.assertEqual([(c["candidate"], c["from"], c["weight"], c["share"], c["chosen"], c["seen"])
                          for c in d["candidate_list"]],
                         [(1, "map", 1, 0.2, 0, None), (2, "brdf", 4, 0.8, 3, True), (3, "map", 100, 20, 1, False),
                          (4, "brdf", 0.01, 0.002, 0, None)])
        self.assertEqual((d["light"], d["material_name"]), ("maps/sky.exr", "phong, exponent 20"))

    def test_the_page_has_the_first_of_many(self):
        with mock.patch.object(pixel, "SHOWN", 1):
            d = pixel._page_data(by_hand())
        self.assertEqual([(r["method"], r["sample"]) for r in d["rays"]], [("em", 1), ("sir", 1)])
        self.assertEqual([c["candidate"] for c in d["candidate_list"]], [1, 2, 3])  # the chosen are beside the limit
        self.assertEqual(d["shown"][0]["rays"], 2)

    def test_the_sphere_has_densities(self):
        # Half a step of a code is a factor of 10^(7/65534/2), and what is below the scale is 0.
        s = pixel._json_sphere(by_hand())
        cosine = np.maximum(np.cos(np.pi * (np.arange(360) + 0.5) / 360), 0)[:, None] * np.ones(720)
        x = np.arange(720)
        product = 0.5 * cosine / np.pi / 12  # over L_ns
        for name, expected in (("map", 0 * cosine + 1 / (4 * np.pi)), ("brdf", cosine / np.pi), ("product", product),
                               ("seen", product * ((x > 180) & (x < 540)))):
            codes = np.frombuffer(base64.b64decode(s[name]), ">u2").reshape(360, 720).astype(float)
            found = np.where(codes > 0, 10 ** (s["top"] - 7 * (1 - (codes - 1) / 65534)), 0)
            np.testing.assert_allclose(found, np.where(expected >= 1e-7, expected, 0), rtol=1.4e-4, atol=1e-12)
        for width, sub in ((None, 2), (1440, 2), (1441, 3), (2160, 3), (99999, 8)):  # as many as the map has pixels
            r = by_hand()
            r.about["map_width"] = width
            with mock.patch.object(r.stage, "sphere", side_effect=r.stage.sphere) as asked:
                pixel._json_sphere(r)
            asked.assert_called_once_with(720, 360, sub)
        bright = by_hand()
        bright.exact = Exact(bright.exact.lit, radiance([0.0] * 3, [0.0] * 3, 0.001, 0.0), True, 1, 1, None, None)
        self.assertEqual(pixel._json_sphere(bright)["top"], 3)  # 0.5/pi over 0.001 is 159
        bright.exact = Exact(bright.exact.lit, radiance([0.0] * 3, [0.0] * 3, 0.0, 0.0), True, 1, 1, None, None)
        self.assertEqual(pixel._json_sphere(bright)["top"], 0)  # of nothing it stays as it is

    @unittest.skipUnless(shutil.which("node"), "no node here, which shows what a page looks like")
    def test_the_page_has_dots_where_the_rays_go(self):
        # Fields begin at (34, 8), two pixels for a degree. A candidate's area is its weight over the mean one.
        with tempfile.TemporaryDirectory() as folder:
            pixel.write_files(by_hand(folder=folder, html=True))
            shown = subprocess.run(["node", os.path.join(ROOT, "tests/tools/page.js"), folder + "/pixel.html#all"],
                                   check=True, capture_output=True, text=True).stdout
        shown, at = re.sub(r"\s+", " ", shown), 0
        for part in ('<h1>Pixel (3, 2) of scene.txt</h1>', "under sky.exr; ", "seen at 36.9 degrees",
                     "L/L<sub>ns</sub> = 0.5", '<figure data-panel="em">',
                     "2 shadow rays of 3 estimates, 1 saw the light; error of one: 50 %",
                     '<circle cx="574" cy="81.74" r="3.6" fill="#59ffeb"/>',
                     '<circle cx="574" cy="368" r="3" fill="none" stroke-width="1.7" stroke="#ff6b52"/>',
                     '<figure data-panel="candidates of sir">',
                     "5 drawn, 4 weigh something; effective sample size 2.125",
                     '<circle cx="34" cy="188" r="2.4" fill="#59ffeb"/>',
                     '<circle cx="214" cy="81.74" r="0.9" fill="#bffa59"/>',
                     '<circle cx="394" cy="188" r="9" fill="#59ffeb"/>', '<figure data-panel="sir">',
                     "exact</th><td></td><td>6</td> <td>0.5</td>", "2.00</td> <td>50 %</td><td>16</td>", "-1.50?</td>"):
            self.assertIn(part, shown[at:])
            at = shown.index(part, at) + len(part)
        self.assertNotIn('data-panel="rejection', shown)


class Command(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder.name)
        pixels = np.random.default_rng(3).random((16, 32, 3)).astype("<f4") ** 4
        with open("map.pfm", "wb") as f:
            f.write(b"PF\n32 16\n-1\n" + pixels.tobytes())
        self.write("scene.txt")

    @staticmethod
    def write(path, light=MAP, more="", change=("", "")):
        with open(path, "w") as f:
            f.write((SCENE % (light, more)).replace(*change))

    def run_it(self, *arguments, status=0):
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            self.assertEqual(pixel.main([str(a) for a in arguments]), status, err.getvalue())
        self.said = err.getvalue()
        return out.getvalue()

    @staticmethod
    def table(path):
        with open(path) as f:
            return list(csv.DictReader(f))

    def test_tables_sum_to_what_it_says(self):
        j = json.loads(self.run_it("--json", "--html", "--repeats", 50, "--output", "out", "scene.txt", 3, 2))
        self.assertEqual(sorted(os.listdir("out")), ["candidates.csv", "methods.csv", "pixel.html", "rays.csv"])
        c, rows = j["candidates"], self.table("out/candidates.csv")
        w = np.array([float(r["weight"]) for r in rows])
        chosen = np.array([int(r["chosen"]) for r in rows])
        self.assertEqual((len(rows), chosen.sum()), (60, 5))
        self.assertAlmostEqual(w.sum() / c["weights"], 1, places=12)
        self.assertAlmostEqual(sum(float(r["share"]) for r in rows), 1, places=12)
        self.assertAlmostEqual(c["effective_sample_size"] / (w.sum() ** 2 / (w * w).sum()), 1, places=12)
        self.assertAlmostEqual(c["share_of_map"] * 60, sum(r["from"] == "map" for r in rows), places=9)
        self.assertEqual(c["seen"], sum(n for n, r in zip(chosen, rows) if r["seen"] == "1"))
        rows = self.table("out/methods.csv")
        self.assertEqual([r["method"] for r in rows[:3]], ["exact", "without visibility", "em"])
        self.assertEqual(len(rows), 2 + len(j["methods"]))
        self.assertEqual(float(rows[0]["sum"]), j["exact"]["sum"])
        self.assertEqual(float(rows[1]["se_sum"]), j["unoccluded"]["sum_standard_error"])
        for r in rows:
            self.assertAlmostEqual(sum(float(r[k]) for k in "rgb") / float(r["sum"]), 1, places=9)
        with open("out/pixel.html") as f:
            page = f.read()
        data = json.loads(re.search(r'id="data">(.*?)</script>', page, re.S).group(1))
        self.assertEqual({k: data[k] for k in j}, j)
        self.assertIn('<pre id="text">pixel       (3, 2) of 8 x 4', page)
        self.assertEqual(len(data["rays"]), len(self.table("out/rays.csv")))

    def test_each_column_is_what_it_is_called(self):
        # At (6, 3) n, wo and the mirrored direction are z: the BRDF's density is a formula of z.
        self.write("scene.txt", more=WALL)
        j = json.loads(self.run_it("--json", "--repeats", 20, "--output", "out", "scene.txt", 6, 3))
        beta, seen = j["candidates"]["share_of_map"], j["exact"]["sum"] / j["unoccluded"]["sum"]
        self.assertTrue(0.1 < seen < 0.95 and abs(beta - 0.5) > 0.01)  # else the checks below could not tell
        n = 0
        for name in ("candidates", "rays"):
            for r in self.table("out/%s.csv" % name):
                if not r["x"]:
                    continue
                x, y, z, theta, phi, q_map, q_brdf = (float(r[k]) for k in ("x", "y", "z", "theta_deg", "phi_deg",
                                                                            "q_map", "q_brdf"))
                theta, phi = math.radians(theta), math.radians(phi)
                np.testing.assert_allclose([x, y, z], [math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi),
                                                       math.cos(theta)], atol=1e-6)
                q = 0.5 * 31 / (2 * math.pi) * z**30 + 0.5 * z / math.pi if z > 0 else 0
                self.assertAlmostEqual(q_brdf, q, delta=1e-5 * (1 + q))
                if name == "candidates":
                    mixed = beta * q_map + (1 - beta) * q_brdf
                    self.assertAlmostEqual(float(r["q"]) / mixed, 1, delta=1e-5)
                    self.assertAlmostEqual(float(r["weight"]) * mixed / float(r["product"]), 1, delta=1e-5)
                n += 1
        self.assertGreater(n, 200)
        self.assertIn("seen        %.2f %%\n" % (100 * seen),
                      self.run_it("--repeats", 20, "--output", "out", "scene.txt", 6, 3))

    def test_where_nothing_is_reflected_it_says_why(self):
        self.write("dark.txt", light="")
        self.write("black.txt", more='Material "phong" "rgb Kd" [0 0 0] "rgb Ks" [0 0 0]\n'
                                     'Shape "disk" "float radius" 50 "float height" 5\n')
        self.write("constant.txt", light='LightSource "infinite" "rgb L" [1 0.5 0.25]\n')
        for scene, place, words, light in (("scene.txt", (0, 0), "no surface", None),
                                           ("dark.txt", (6, 3), "no light", None),
                                           ("black.txt", (0, 0), "the material is black", None),
                                           ("constant.txt", (0, 0), "no surface", "(1 0.5 0.25), the light's own")):
            found = self.run_it(scene, *place)
            self.assertIn("nothing     " + words if words != "the material is black" else words, found)
            self.assertIn("radiance    " + (light or "("), found)
            j = json.loads(self.run_it("--json", scene, *place))
            self.assertIn(words, j["nothing"])
            self.assertEqual(j["hit"] is None, words == "no surface")
            self.assertEqual(list(j)[-1], "radiance")
        self.assertFalse([f for f in os.listdir() if f.startswith("pixel_")])  # no files for nothing

    def test_wrong_places_and_folders_are_refused(self):
        with open("file", "w"):
            pass
        for status, arguments, message in (
                (2, ("scene.txt", 8, 4), 'bis: error: X is "8", must be an integer in [0, 7]: the film of the scene '
                                         'has 8 x 4 pixels\nbis: error: Y is "4", must be an integer in [0, 3]'),
                (2, ("scene.txt", "1.5", 0), 'X is "1.5"'), (2, ("scene.txt", "\u0661", 0), "X is"),
                (2, ("scene.txt", 0, "-1"), 'unknown option "-1"'),
                (2, ("scene.txt", 1), "too few operands: 2 given; usage: bis pixel [options] SCENE X Y"),
                (2, ("--repeats", 1, "scene.txt", 1, 1), "must be an integer in [2, 100000000]"),
                (1, ("--repeats", 2, "--output", "file", "scene.txt", 1, 1), "is no folder"),
                (1, ("--repeats", 2, "--output", "no/such", "scene.txt", 1, 1), "cannot be made: No such file"),
                (1, ("missing.txt", 1, 1), 'cannot open "missing.txt"')):
            self.assertEqual(self.run_it(*arguments, status=status), "")
            self.assertIn(message, self.said)
        os.mkdir("out")
        os.mkdir("out/rays.csv")  # a folder stands where the file should
        self.run_it("--repeats", 2, "--output", "out", "scene.txt", 1, 1, status=1)
        self.assertIn("rays.csv", self.said)
        self.assertFalse([f for f in os.listdir("out") if f.startswith(".")])

    def test_options_override_the_scene_for_all_methods(self):
        options = ("--repeats", 3, "--candidates", 17, "--shadowrays", 4, "--samples", 6, "--proposal", "em", "--seed",
                   5, "--json", "--output", "o", "scene.txt", 3, 2)
        found = self.run_it(*options)
        j = json.loads(found)
        self.assertEqual((j["seed"], j["candidates"]["drawn"], j["candidates"]["shadowrays"]), (5, 17, 4))
        self.assertEqual(j["candidates"]["share_of_map"], 1)
        self.assertEqual({m["samples"] for m in j["methods"]} - {None}, {6})
        self.assertEqual({m["candidates"] for m in j["methods"]} - {None}, {17})
        self.assertEqual({m["repeats"] for m in j["methods"]}, {3})
        self.assertEqual(self.run_it(*options), found)  # the same seed, the same numbers

    def test_each_proposal_is_measured_by_its_name(self):
        def rows():
            return {r["method"]: r["r"] for r in self.table("p/methods.csv")}

        sir, unoccluded = {}, {}
        for name in ("em", "brdf", "mix", "product"):
            self.run_it("--repeats", 3, "--seed", 5, "--proposal", name, "--output", "p", "scene.txt", 3, 2)
            sir[name], unoccluded[name] = rows()["sir"], rows()["unoccluded"]
            self.write("named.txt", change=('"sir"', '"sir" "string proposal" "%s"' % name))
            self.run_it("--repeats", 3, "--seed", 5, "--output", "p", "named.txt", 3, 2)
            self.assertEqual(rows()["sir"], sir[name])
        self.assertEqual(len(set(sir.values())), 4)
        self.assertEqual(len(set(unoccluded.values())), 3)
        self.assertEqual(unoccluded["product"], unoccluded["mix"])  # which has no product

    def test_as_many_runs_are_shown_as_make_150_rays(self):
        for samples, shadowrays in ((149, 4), (150, 150)):
            self.run_it("--repeats", 2, "--samples", samples, "--shadowrays", shadowrays, "--output", "s", "scene.txt",
                        3, 2)
            last = {r["method"]: int(r["sample"]) for r in self.table("s/rays.csv")}
            for name, rays in (("em", samples), ("brdf", samples), ("sir", shadowrays)):
                self.assertEqual(last[name], math.ceil(150 / rays) - 1)

    def test_a_scene_may_come_from_standard_input(self):
        with open("scene.txt", "rb") as f:
            scene = f.read()
        expected = self.run_it("--repeats", 2, "scene.txt", 3, 2).replace("scene.txt", "<stdin>")
        for given, status in ((scene, 0), (scene + b"\0", 2)):
            with mock.patch.object(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(given))):
                found = self.run_it("--repeats", 2, "-", 3, 2, status=status)
            self.assertEqual(found, "" if status else expected)
        self.assertIn("<stdin>: error: byte %d is 0: a scene is text" % (len(scene) + 1), self.said)


if __name__ == "__main__":
    unittest.main()
