# SPDX-License-Identifier: BSD-2-Clause
"""`bis envmap` and what bis.Envmap tells of a map: figures against sorting and closed forms, a map by hand, pictures
against what they stand for, what is refused."""
import base64
import contextlib
import io
import json
import math
import os
import re
import sys
import tempfile
import unittest
import warnings

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
sys.path.insert(0, os.path.join(ROOT, "scripts/python"))
import bis  # noqa: E402
from bis.tools import envmap, survey  # noqa: E402

SR = math.pi / 2  # of a pixel of the map by hand
# r+g+b: 3 0 1 0 above, 3 3 16 3 below; what is 0 was bad: in all 3 negative, 2 infinite values, and a NaN in the pixel
# below the first bad one. Four levels, 1 to 2 to 4 to 8 to 16.
BY_HAND = np.float32([[[1, 1, 1], [-1, -2, -3], [1, 0, 0], [np.inf, np.inf, 0]],
                      [[0, 3, 0], [np.nan, 2, 1], [8, 6, 2], [0, 0, 3]]])
INTENSITY = np.array([[3, 0, 1, 0], [3, 3, 16, 3]])
REPORT = """map         %s, 4 x 2, latlong
intensity   min 1, median 3, mean 3.625, max 16 (r+g+b; min: of the pixels that are not black)
mean        1.25 1.5 0.875 (red, green, blue)
power       45.5531 (r+g+b integrated over the sphere)
bad values  1 NaN, 2 infinite, 3 negative, set to 0
black       25%% of the sphere
contrast    16 : 1
brightest   0.1%% of the sphere holds 0.44%% of the power
peak        pixel (2, 1), theta 120.0, phi 225.0 degrees, direction (-0.612 -0.612 -0.500)
regions     3 in 4 levels
table       %s bytes a pixel beyond the map

level       from         to    pixels    sphere     power   regions
    0          1          2         1  12.5000%%   3.4483%%         1
    1          2          4         4  50.0000%%  41.3793%%         1
    2          4          8         0   0.0000%%   0.0000%%         0
    3          8         16         1  12.5000%%  55.1724%%         1

regions with most power
  rank level     power   solid angle  theta    phi   direction
     1     3  55.1724%%      1.571 sr  120.0  225.0   (-0.612 -0.612 -0.500)
     2     1  41.3793%%      6.283 sr  120.0   45.0   (0.612 0.612 -0.500)
     3     0   3.4483%%      1.571 sr   60.0  225.0   (-0.612 -0.612 0.500)
"""


def random_map(width, height, decades, black, seed):
    rng = np.random.default_rng(seed)
    pixels = np.exp(rng.uniform(0, decades * math.log(10), (height, width, 1)) / 2) * rng.random((height, width, 3))
    pixels[rng.random((height, width)) < black] = 0
    return np.float32(pixels)


def opened(pixels, levels=8, b=0.15, **more):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return survey.Map(bis.Envmap(pixels, area_exponent=b, levels=levels, **more))


class Figures(unittest.TestCase):
    def test_quantiles_agree_with_sorting(self):
        m = opened(random_map(128, 64, 9, 0.1, 3))
        s = survey.survey(m, 8)
        value = survey.intensity(m.pixels).ravel()
        angle = np.repeat(m.angles, m.width)
        order = np.argsort(-value, kind="stable")
        value, angle = value[order], angle[order]
        before = np.cumsum(angle) - angle
        above = (value * np.clip(0.001 * 4 * math.pi - before, 0, angle)).sum()
        median = value[before < 2 * math.pi][-1]
        self.assertAlmostEqual(s.median / median, 1, delta=1 / 2048)
        self.assertAlmostEqual(s.brightest / (above / m.light.power), 1, delta=1 / 2048)
        self.assertEqual(s.most, value[0])
        self.assertEqual(survey.intensity(m.pixels)[s.peak[1], s.peak[0]], s.most)

    def test_levels_and_regions_account_for_everything(self):
        m = opened(random_map(40, 20, 6, 0.2, 5), levels=5)
        s = survey.survey(m, 5)
        self.assertEqual(len(s.levels), 5)
        self.assertAlmostEqual(s.black + sum(level.sphere for level in s.levels), 1)
        self.assertAlmostEqual(sum(level.power for level in s.levels), 1)
        self.assertEqual(sum(level.regions for level in s.levels), s.n_regions)
        self.assertEqual(sum(level.pixels for level in s.levels), np.count_nonzero(survey.intensity(m.pixels)))
        for level in s.levels:
            self.assertAlmostEqual(level.most / level.least, (s.most / s.least) ** 0.2)
        self.assertEqual(s.largest, sorted(s.largest, key=lambda r: -r.power))
        self.assertAlmostEqual(s.power, m.light.power)

    def test_sums_do_not_depend_on_the_blocks(self):
        pixels = random_map(96, 48, 6, 0.2, 8)
        whole = survey.survey(opened(pixels), 8)
        self.addCleanup(setattr, survey, "BLOCK", survey.BLOCK)
        for block in (1, 500):
            survey.BLOCK = block
            self.assertEqual(survey.survey(opened(pixels), 8), whole)

    def test_a_lamp_is_found_where_it_hangs(self):
        pixels = np.full((32, 64, 3), [0, 1e-3, 0], np.float32)
        pixels[10, [0, 63]] = [1e4, 0, 0]  # on the seam: phi = 0
        m = opened(pixels)
        s = survey.survey(m, 8)
        self.assertEqual(s.n_regions, 2)
        self.assertAlmostEqual(s.largest[0].solid_angle, 2 * m.angles[10])
        theta = math.pi * 10.5 / 32
        d = s.largest[0].direction
        np.testing.assert_allclose((d.x, d.y, d.z), (math.sin(theta), 0, math.cos(theta)), atol=1e-3)

    def test_the_centre_of_a_region_weighs_pixels_by_their_solid_angles(self):
        # Two pixels, from theta 0 to 45 and to 90 degrees. With a = cos 45 their shares of the solid angle are 1 - a
        # and a, the cosines in their middle (1 + a)/2 and a/2; the sum of the cosines is (1 - a^2)/2 + a^2/2 = 1/2.
        pixels = np.ones((4, 8, 3), np.float32)
        pixels[0, 0] = pixels[1, 0] = 16
        largest = survey.survey(opened(pixels), 8).largest[0]
        a = math.sqrt(0.5)
        sines = (1 - a) * math.sqrt(1 - (1 + a) ** 2 / 4) + a * math.sqrt(1 - a * a / 4)
        self.assertAlmostEqual(largest.solid_angle, math.pi / 4)
        self.assertAlmostEqual(largest.direction.theta, math.degrees(math.atan(2 * sines)), places=4)

    def test_constant_and_black_maps_have_plain_figures(self):
        s = survey.survey(opened(np.zeros((8, 16, 3))), 8)
        self.assertEqual((s.power, s.n_regions, s.levels, s.median, s.least, s.peak_direction), (0, 0, [], 0, 0, None))
        self.assertAlmostEqual(s.black, 1)
        s = survey.survey(opened(np.full((8, 16, 3), [1, 2, 4])), 8)
        self.assertAlmostEqual(s.median, 7)
        self.assertAlmostEqual(s.brightest, 0.001)
        self.assertAlmostEqual(s.mean_rgb[2], 4)
        self.assertEqual((s.n_regions, len(s.levels), s.largest[0].direction), (1, 1, None))
        smallest = survey.survey(opened(np.full((8, 16, 3), [0, 2.0 ** -149, 0])), 8)
        self.assertEqual(smallest.median, 2.0 ** -149)

    def test_the_map_tells_what_it_is(self):
        pixels = random_map(64, 32, 4, 0.1, 1)
        em = bis.Envmap(pixels, levels=6, area_exponent=0.5)
        self.assertEqual((em.mapping, em.resampled, em.defects[:3]), ("latlong", None, (0, 0, 0)))
        self.assertAlmostEqual((em.solid_angles * 64).sum(), 4 * math.pi)
        self.assertAlmostEqual((em.density() * em.solid_angles[:, None]).sum(), 1)
        self.assertGreaterEqual(em.table_bytes, 8 * 64 * 32)
        r = em.regions()
        lit = r.label >= 0
        np.testing.assert_array_equal(lit, pixels.sum(2) > 0)
        np.testing.assert_array_equal(r.levels[r.label[lit]], r.level[lit])
        angles = np.bincount(r.label[lit], np.broadcast_to(em.solid_angles[:, None], lit.shape)[lit])
        np.testing.assert_allclose(angles, r.solid_angles)
        np.testing.assert_allclose(r.factor[lit], np.minimum(r.solid_angles[r.label[lit]] / 0.01, 1) ** 0.5)
        weights = np.where(lit, r.factor * pixels.sum(2, dtype=np.float64), 0)  # thesis 3.4
        np.testing.assert_allclose(em.density(), weights / (weights * em.solid_angles[:, None]).sum(), rtol=1e-6)
        self.assertEqual(em.regions(levels=1, area_exponent=0).level.max(), 0)
        rows, columns = em.draw(500, seed=4)
        np.testing.assert_array_equal(em.find(em.directions(rows, columns)), (rows, columns))
        w, L, _ = em.sample(500, seed=4)
        np.testing.assert_array_equal(em.pixels[rows, columns], L)
        for wrong in ([32], [-1]):
            with self.assertRaisesRegex(bis.Error, "no pixels of the map"):
                em.directions(wrong, [0])
        for wrong in (0, 255):
            with self.assertRaisesRegex(bis.Error, "levels"):
                bis.Envmap(pixels, levels=wrong)
            with self.assertRaisesRegex(bis.Error, "levels"):
                em.regions(levels=wrong)

    def test_a_map_goes_to_each_mapping_and_comes_back(self):
        pixels = np.full((32, 64, 3), 0.5, np.float32)
        pixels[9, 25] = [1000, 500, 250]
        em = bis.Envmap(pixels)
        for mapping in envmap.MAPPINGS[1:]:
            other, before, after = em.to_mapping(mapping)
            self.assertAlmostEqual(before / em.power, 1, places=5)
            self.assertAlmostEqual(after / em.power, 1, places=5)
            there = bis.Envmap(other, mapping=mapping, width=64)
            self.assertEqual((there.shape, there.mapping), ((32, 64), mapping))
            self.assertAlmostEqual(there.resampled[1] / em.power, 1, places=3)
            self.assertEqual(np.argmax(there.pixels.sum(2)), 9 * 64 + 25)
        self.assertEqual(em.to_mapping("verticalcross", 9)[0].shape, (12, 9, 3))
        for width, said in ((10, "its width, 10, must be a multiple of 3"), (-1, "width is -1: give a width")):
            with self.assertRaisesRegex(bis.Error, said):
                em.to_mapping("verticalcross", width)
        with self.assertRaises(bis.Error) as e:  # all of them are named
            em.to_mapping("x")
        said = str(e.exception)
        self.assertIn('there is no mapping "x"', said)
        self.assertEqual([m for m in envmap.MAPPINGS if m not in said], [])


class Pictures(unittest.TestCase):
    def test_they_show_levels_regions_and_importance(self):
        m = opened(random_map(48, 24, 6, 0.1, 9), b=0)
        levels, regions = survey.levels_picture(m, 8), survey.regions_picture(m)
        importance = survey.importance_picture(m, 0)
        grey = [p.reshape(-1, 3) @ [0.2126, 0.7152, 0.0722] for p in (levels, importance)]
        value, level, label = (a.ravel() for a in (survey.intensity(m.pixels), m.regions.level, m.regions.label))
        for by, shown in ((level, grey[0]), (value, grey[1])):
            order = np.lexsort((shown, by))
            self.assertTrue((np.diff(shown[order]) >= -1e-7).all())
        for picture, by in ((levels, level), (regions, label)):
            flat = picture.reshape(-1, 3)
            _, first = np.unique(by, return_index=True)
            index = np.searchsorted(by[first], by)
            np.testing.assert_array_equal(flat, flat[first][index])
            np.testing.assert_array_equal((flat == 0).all(1), by < 0)
        self.assertTrue((regions >= 0).all() and (regions <= 1).all())

    def test_a_map_by_hand_has_the_colours_by_hand(self):
        # Its regions are, in reading order, of levels 1, 0 and 3: hues 0, 0.618 and 0.236 turns, saturations 0.75 -
        # 0.45 h, values 0.25 + 0.75 h, h = 1/3, 0, 1. In sixths of a turn 0.618 is 3.708, between cyan and blue:
        # least, least + what is left, most; 0.236 is 1.416, between yellow and green. All regions are larger than a
        # small light: importance is as intensity is.
        m = opened(BY_HAND, levels=4)
        g = 0.6180339887498949
        blue, green = 6 * g - 3, 6 * (2 * g - 1) - 1
        of = {-1: (0, 0, 0), 1: survey.srgb([0.5, 0.2, 0.2]), 3: survey.srgb([0.7 + 0.3 * (1 - green), 1, 0.7]),
              0: survey.srgb([0.0625, 0.0625 + (1 - blue) * 0.1875, 0.25])}
        level = [1, -1, 0, -1, 1, 1, 3, 1]
        np.testing.assert_allclose(survey.regions_picture(m).reshape(8, 3), [of[k] for k in level], atol=1e-6)
        lit = INTENSITY.ravel() > 0
        expected = np.zeros((8, 3))
        expected[lit] = survey.heat(np.log(INTENSITY.ravel()[lit]) / math.log(16))
        np.testing.assert_allclose(survey.importance_picture(m, 0).reshape(8, 3), expected, atol=1e-5)
        expected[lit] = survey.heat(np.array(level)[lit] / 3)
        np.testing.assert_allclose(survey.levels_picture(m, 4).reshape(8, 3), expected, atol=1e-6)

    def test_heat_has_its_ends_and_grows_lighter(self):
        colours = survey.heat(np.linspace(-0.5, 1.5, 400))
        stops = [(0.05, 0.03, 0.2), (0.25, 0.07, 0.43), (0.53, 0.13, 0.42), (0.8, 0.24, 0.3), (0.95, 0.47, 0.12),
                 (0.98, 0.76, 0.22), (1, 0.99, 0.8)]
        np.testing.assert_allclose(survey.heat(np.arange(7) / 6), survey.srgb(stops), atol=1e-6)
        np.testing.assert_array_equal(colours[[0, -1]], survey.srgb([stops[0], stops[-1]]))
        self.assertTrue((np.diff(colours @ [0.2126, 0.7152, 0.0722]) >= -1e-7).all())
        np.testing.assert_allclose(survey.heat([1.5 / 6])[0], survey.srgb((survey.STOPS[1] + survey.STOPS[2]) / 2))

    def test_a_dot_has_a_rim_and_goes_around_the_seam(self):
        out = np.ones((200, 40, 3), np.float32)  # the radius is 1 pixel, the rim reaches to 1.6
        survey._draw_dots(out, np.array([100, 0]), np.array([0, 20]))
        light = survey.srgb([0.55, 1, 0.95])
        for y, x, expected in ((100, 0, light), (100, 39, light), (101, 0, light), (101, 39, 0.3), (99, 1, 0.3),
                               (100, 38, 1), (102, 0, 1), (0, 20, light), (1, 21, 0.3), (199, 20, 1)):
            np.testing.assert_allclose(out[y, x], expected, atol=1e-6)
        narrow = np.ones((1, 1, 3), np.float32)
        survey._draw_dots(narrow, np.array([0]), np.array([0]))
        np.testing.assert_allclose(narrow[0, 0], light)


class Command(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.save("map.pfm", random_map(32, 16, 4, 0.1, 2))
        self.save("probe.pfm", random_map(16, 16, 4, 0.1, 2))

    def save(self, name, pixels):
        pixels = np.asarray(pixels, "<f4")
        with open(self.at(name), "wb") as f:
            f.write(b"PF\n%d %d\n-1.0\n" % (pixels.shape[1], pixels.shape[0]) + pixels[::-1].tobytes())
        return self.at(name)

    def at(self, name):
        return os.path.join(self.folder, name)

    def run_it(self, *words, status=0):
        """What the command prints, and its messages. {} stands for the folder."""
        out, err = io.TextIOWrapper(io.BytesIO()), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            found = envmap.main([w.replace("{}", self.folder) for w in words])
        self.assertEqual(found, status, err.getvalue())
        return out.buffer.getvalue().decode(), err.getvalue().replace(self.folder, "{}")

    def page(self, name):
        with open(self.at(name), encoding="utf-8") as f:
            page = f.read()
        return page, json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL).group(1))

    def test_light_that_does_not_arrive(self):
        below = np.zeros((8, 16, 3), np.float32)
        below[4:] = 1
        self.save("below.pfm", below)
        one = np.zeros((32, 64, 3), np.float32)
        one[5, 5] = 1
        self.save("one.pfm", one)
        self.assertIn("E = 0 0 0: no light comes from above\nnine", self.run_it("{}/below.pfm")[0])
        self.assertIn("% of the mean; there is some where no light arrives\n", self.run_it("{}/one.pfm")[0])

    def test_a_map_by_hand_has_the_report_by_hand(self):
        path = self.save("hand.pfm", BY_HAND)
        words, messages = self.run_it("{}/hand.pfm", "--levels", "4")
        found = json.loads(self.run_it("{}/hand.pfm", "--levels", "4", "--json")[0])
        diagnosis = re.search("\nfrom above .*\nsuspicious .*?\n", words, re.DOTALL).group()
        self.assertEqual(words.replace(diagnosis, ""), REPORT % (path, "%.1f" % (found["table_bytes"] / 8)))
        # A pixel of the upper row is a quarter of the hemisphere: pi/4.
        self.assertIn("E = 1.571 0.7854 0.7854; exposure +1.6 EV", diagnosis)
        self.assertIn("suspicious  1 NaN, 2 infinite, 3 negative: these values count as 0\n", diagnosis)
        self.assertIn("{}/hand.pfm: warning: ", messages)
        self.assertEqual(found["convention"], "bis")
        a = math.sqrt(3 / 8)
        self.assertEqual({k: found[k] for k in ("width", "height", "mapping", "power_before", "power_after")}, {
            "width": 4, "height": 2, "mapping": "latlong", "power_before": None, "power_after": None})
        self.assertEqual([level["pixels"] for level in found["levels"]], [1, 4, 0, 1])
        np.testing.assert_allclose([r["power_share"] for r in found["largest_regions"]], [16 / 29, 12 / 29, 1 / 29])
        np.testing.assert_allclose([r["solid_angle"] for r in found["largest_regions"]], [SR, 4 * SR, SR])
        peak = found["peak"]["direction"]
        np.testing.assert_allclose([peak[k] for k in ("theta_deg", "phi_deg", "x", "y", "z")],
                                   [120, 225, -a, -a, -0.5], rtol=3e-7)
        self.assertAlmostEqual(found["power"], 29 * SR)
        self.assertAlmostEqual(found["brightest_0.1_percent"], 0.001 * 8 * 16 / 29)
        self.assertAlmostEqual(found["bad_values"].pop("sphere_share"), 0.375)
        self.assertEqual(found["bad_values"], {"nan": 1, "infinite": 2, "negative": 3})

    def test_a_scene_with_the_axes_of_a_program_sees_the_map_where_that_shows_it(self):
        # Where the table of docs/command-line.md has the picture's middle, a quarter to the right of it, and up.
        table = {"blender": ((1, 0, 0), (0, -1, 0), (0, 0, 1)), "mitsuba": ((0, 0, 1), (-1, 0, 0), (0, 1, 0)),
                 "three": ((1, 0, 0), (0, 0, 1), (0, 1, 0)), "unity": ((1, 0, 0), (0, 0, -1), (0, 1, 0))}
        with open(os.path.join(ROOT, "docs/command-line.md"), encoding="utf-8") as f:
            lines = f.read().split("```python\n")[1].split("```")[0]
        path = self.at("card.exr")
        exec(lines.replace("card.exr", path), {"np": np, "bis": bis})
        colours = ((1, 1, 1), (1, 0, 0), (0, 0, 1))
        for program, axes in table.items():
            words, _ = self.run_it(path, "--convention", program)
            line, = re.findall(r"in a scene  AttributeBegin (Transform \[.*?\]) LightSource ... AttributeEnd", words)
            self.assertEqual("Scale -1 1 1" in words, np.linalg.det(axes) < 0, program)
            for k, axis in enumerate(axes):
                camera = bis.Camera(eye=(0, 0, 0), to=axis, up=np.roll(axis, 1), fov=1)
                scene = 'WorldBegin %s LightSource "infinite" "string filename" "%s"' % (line, path)
                seen = bis.render(scene, camera=camera, width=1, height=1, spp=1).rgb[0, 0]
                np.testing.assert_array_equal(seen, colours[k], err_msg="%s %s" % (program, axis))

    def test_a_black_map_and_a_plain_one_have_short_reports(self):
        self.save("black.pfm", np.zeros((2, 4, 3)))
        self.save("plain.pfm", np.full((2, 4, 3), [1, 2, 4]))
        words, messages = self.run_it("{}/black.pfm")
        self.assertRegex(words, "black       100% of the sphere\nregions     0 in 0 levels\ntable .* the map\n$")
        self.assertIn("gives no light", messages)
        found = json.loads(self.run_it("{}/black.pfm", "--json")[0])
        self.assertEqual((found["peak"], found["contrast"], found["levels"], found["largest_regions"]),
                         (None, None, [], []))
        words, _ = self.run_it("{}/plain.pfm")
        self.assertIn("regions     1 in 1 level\n", words)
        self.assertIn("     1     0 100.0000%      12.57 sr  on all sides\n", words)

    def test_a_probe_has_its_power_before_and_after(self):
        words, _ = self.run_it("--mapping", "angular", "{}/probe.pfm", "--width", "8")
        found = json.loads(self.run_it("--mapping", "angular", "{}/probe.pfm", "--width", "8", "--json")[0])
        self.assertEqual((found["width"], found["height"], found["mapping"]), (8, 4, "angular"))
        self.assertIn("8 x 4, resampled from angular\npower       %.6g before, %.6g after" % (
            found["power_before"], found["power_after"]), words)
        self.assertRegex(words, r"resampling \([+-]0\.000%\)\n")
        self.assertAlmostEqual(found["power_after"] / found["power_before"], 1, places=5)

    def test_a_page_has_levels_regions_and_densities(self):
        # Densities are r+g+b over their integral; codes are logarithms between 1 and 16.
        self.save("hand.pfm", BY_HAND)
        self.run_it("{}/hand.pfm", "--levels", "4", "--areaexponent", "0", "--samples", "50", "--html", "{}/p.html")
        page, data = self.page("p.html")
        places = data["places"]
        self.assertEqual((places["width"], places["height"], places["step"], data["max"]), (4, 2, 1, 16))
        np.testing.assert_allclose((places["least"], places["most"]), (1 / (29 * SR), 16 / (29 * SR)), rtol=1e-6)
        level, region, density = (np.frombuffer(base64.b64decode(places[k]), kind).astype(int) for k, kind in (
            ("level", "u1"), ("region", ">u4"), ("density", ">u2")))
        value = INTENSITY.ravel()
        np.testing.assert_array_equal(level, [1, 255, 0, 255, 1, 1, 3, 1])
        np.testing.assert_array_equal(region == 0xffffffff, value == 0)
        np.testing.assert_array_equal(region == region[0], value == 3)
        np.testing.assert_array_equal(density, np.where(
            value > 0, 1 + np.round(65534 * np.log(np.maximum(value, 1)) / math.log(16)), 0))
        for s in data["samples"]:  # in the middle of a pixel that is not black
            y, x = s["theta_deg"] / 90 - 0.5, s["phi_deg"] / 90 - 0.5
            self.assertTrue(INTENSITY[int(y), int(x)] > 0 and (y, x) == (int(y), int(x)))
        self.assertEqual(len(data["samples"]), 50)
        self.assertIn('<pre id="text">map         %s, 4 x 2' % self.at("hand.pfm"), page)
        self.save("faint.pfm", BY_HAND / 4096)
        self.run_it("{}/faint.pfm", "--levels", "4", "--html", "{}/p.html")
        self.assertEqual(self.page("p.html")[1]["places"]["picture"], places["picture"])  # whatever the unit

    def test_a_page_of_a_large_map_has_some_of_its_pixels(self):
        # Of 1441 columns each third pixel is there, the one in the middle, or the last one. A place has the mean
        # density of its pixels, of nine, or of one in the corner.
        pixels = np.ones((4, 1441, 3))
        pixels[1, 4] = pixels[3, 1440] = pixels[1, 6] = 16  # the second place, the last one, no middle
        self.save("large.pfm", pixels)
        self.run_it("{}/large.pfm", "--levels", "2", "--areaexponent", "0", "--html", "{}/large.html")
        places = self.page("large.html")[1]["places"]
        self.assertEqual((places["width"], places["height"], places["step"]), (481, 2, 3))
        level, density = (np.frombuffer(base64.b64decode(places[k]), kind) for k, kind in (
            ("level", "u1"), ("density", ">u2")))
        self.assertEqual(np.flatnonzero(level).tolist(), [1, 961])
        self.assertAlmostEqual(density[1], 1 + 65534 * math.log(24 / 9) / math.log(16), delta=1)
        self.assertEqual((density[0], density[1], density[961]), (1, density[2], 65535))

    def test_an_option_that_is_not_given_has_the_value_of_the_help(self):
        self.save("lamp.pfm", np.where(np.arange(64 * 128 * 3).reshape(64, 128, 3) < 6, 50, 1))
        for name, options in (("a", ()), ("b", ("--levels", "8", "--areaexponent", "0.15", "--samples", "300"))):
            self.run_it("{}/lamp.pfm", *options, "--html", "{}/%s.html" % name)
        self.assertEqual(self.page("a.html"), self.page("b.html"))
        self.run_it("{}/lamp.pfm", "--areaexponent", "0.2", "--html", "{}/c.html")
        self.assertNotEqual(self.page("a.html"), self.page("c.html"))  # twin

    def test_samples_are_the_dots_of_the_picture(self):
        self.run_it("{}/map.pfm", "--samples", "3", "--html", "{}/p.html", "--out", "{}/p.pfm", "--json")
        samples = self.page("p.html")[1]["samples"]
        picture, _ = bis.read_image(self.at("p-importance.pfm"))
        for s in samples:
            y, x = int(s["theta_deg"] / 180 * 16), int(s["phi_deg"] / 360 * 32)
            np.testing.assert_allclose(picture[y, x], survey.srgb([0.55, 1, 0.95]))

    def test_pictures_have_the_name_of_their_map(self):
        for name, stem in (("a.b.pfm", "a.b"), (".pfm", ".pfm")):
            self.save(name, random_map(8, 4, 2, 0, 1))
            self.run_it("{}/" + name, "--outdir", "{}")
            for what in envmap.PICTURES:
                self.assertTrue(os.path.exists(self.at("%s-%s.png" % (stem, what))))
        for what in envmap.PICTURES:
            self.save("sky-%s.pfm" % what, np.ones((2, 4, 3)))
            _, messages = self.run_it("{}/sky-%s.pfm" % what, "--out", "{}/sky.pfm", status=2)
            self.assertIn("which is read; give the output another name", messages)
            os.unlink(self.at("sky-%s.pfm" % what))
        long = self.folder + "/" * (4000 - len(self.folder) - 5) + "x.png"
        self.run_it("{}/map.pfm", "--out", long)
        _, messages = self.run_it("{}/map.pfm", "--out", long.replace("x.png", "/x.png"), status=2)
        self.assertEqual(messages, "bis: error: --out: the name is longer than 4000 bytes\n")

    def test_a_conversion_tells_what_it_wrote(self):
        words, _ = self.run_it("{}/map.pfm", "--to", "angular", "--width", "20", "--out", "{}/to.exr")
        self.assertRegex(words, r"wrote       .*/to.exr, 20 x 20, angular\npower       (\S+) before, \1")
        self.assertEqual(bis.read_image(self.at("to.exr"))[0].shape, (20, 20, 3))
        with open(self.at("to.exr"), "rb") as f:
            self.assertIn(b"bis:mapping\0string\0\x07\0\0\0angular", f.read())

    def test_what_cannot_be_done_is_refused(self):
        page = "--html", "{}/x.html"
        with open(self.at("text.pfm"), "w") as f:
            f.write("no map")
        for words, status, message in (
                (("--levels", "0"), 2, 'bis: error: --levels is "0", must be an integer in [1, 254]'),
                (("--width", "65537"), 2, 'bis: error: --width is "65537", must be an integer in [1, 65536]'),
                (("--areaexponent", "10.001"), 2, 'must be a number in [0, 10]'),
                (("--samples", "1000001"), 2, "must be an integer in [0, 1000000]"),
                (("--mapping", "sphere"), 2, 'bis: error: --mapping: no such thing as "sphere"'),
                (("--out", "{}/x.gif"), 2, 'bis: error: --out "{}/x.gif": the ending must be .exr, .pfm, .hdr or .png'),
                (("--out", "{}/x.png", "--outdir", "{}"), 2, "bis: error: --out and --outdir exclude each other"),
                (("--to", "equalarea"), 2, "bis: error: --to equalarea writes one map: name it by --out FILE"),
                (("--to", "equalarea", "--out", "{}/x.exr", *page), 2, "writes one map"),
                (("--to", "equalarea", "--out", "{}/x.jpg"), 2, "the ending must be"),
                (("--to", "equalarea", "--out", "{}/no/x.exr"), 1,
                 'bis: error: "{}/no/x.exr" cannot be written: folder "{}/no": No such file or directory'),
                (("--to", "equalarea", "--out", "{}/map.pfm"), 2, "would replace"),
                (("--to", "verticalcross", "--width", "100", "--out", "{}/x.exr"), 2, "must be a multiple of 3"),
                (("--html", "{}/no/x.html"), 1, "cannot be written"), (("--html", "{}/map.pfm"), 2, "would replace"),
                (("--outdir", "{}/no"), 1, '"{}/no/map-map.png" cannot be written')):
            self.assertIn(message, self.run_it("{}/map.pfm", *words, status=status)[1])
        self.assertIn("is square", self.run_it("{}/probe.pfm", status=2)[1])
        self.assertIn("{}/missing.hdr", self.run_it("{}/missing.hdr", "--levels", "254", status=1)[1])
        self.run_it("{}/text.pfm", status=1)
        self.assertIn("too few operands", self.run_it(status=2)[1])


if __name__ == "__main__":
    unittest.main()
