# SPDX-License-Identifier: BSD-2-Clause
"""`bis judge`: p-values of right pictures, mistakes and their names, the kit, what is refused."""
import json
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
sys.path.insert(0, os.path.join(ROOT, "scripts/python"))
import bis  # noqa: E402
from bis.tools.judge import causes, kit, report, verdict  # noqa: E402

PROGRAM = os.path.join(ROOT, "bis")
SEED = int(os.environ.get("BIS_TEST_SEED", "0"))


def pictures(n, skewness, size=(48, 64), seed=0, own=0.002, quiet=0):
    """A picture by hand, some copies of it by other seeds, and n with noise of a gamma distribution.
    Columns on the left are quiet: without any noise, as a background is."""
    rng = np.random.default_rng([SEED, seed])
    y, x = np.mgrid[:size[0], :size[1]]
    right = (1 + 0.5 * np.sin(x / 7) * np.cos(y / 5))[..., None] * [1, 0.8, 0.5]
    noisy = (x >= quiet)[..., None]
    copies = right * (1 + own * noisy * rng.standard_normal((16,) + right.shape))
    shape = 4 / skewness ** 2
    noise = noisy * (rng.gamma(shape, 1, (n,) + right.shape) - shape) / np.sqrt(shape)
    none = np.zeros(size, bool)
    return verdict.Truth(copies, none, none), right * (1 + 0.03 * noise)


def p_values(k, skewness, together=None, **how):
    """p of 200 right pictures of k seeds each, by the judge or by another sum of its tests."""
    found = []
    for i in range(200):
        truth, theirs = pictures(k, skewness, seed=1000 * k + i, **how)
        v = verdict.judge(theirs, truth)
        found.append(together(v) if together else v.p)
    return np.array(found)


def too_many(p):
    """Whether more lie below a level than 200 uniform numbers have but once in 10^5 (Poisson, for
    the levels .001, .01, .05)."""
    return [float(np.mean(p < level)) > most / 200 for level, most in
            ((0.001, 4), (0.01, 11), (0.05, 26))]


class Verdicts(unittest.TestCase):
    def test_right_pictures_are_rarely_called_wrong(self):
        for k, skewness, how in ((1, 1.0, {}), (4, 1.0, {}), (8, 0.1, {}),
                                 (1, 0.5, {"own": 0.05}), (8, 0.1, {"quiet": 40})):
            with self.subTest(k=k, skewness=skewness, **how):
                p = p_values(k, skewness, **how)
                self.assertFalse(any(too_many(p)))
                self.assertGreater(np.mean(p < 0.5), 0.4)  # a standard error is 0.035

    def test_a_judge_that_forgets_its_correction_calls_right_pictures_wrong(self):
        def worst(v):  # of 300 tiles and channels, as if it were one
            return float(verdict.normal_p(v.z).min())
        self.assertTrue(all(too_many(p_values(1, 1.0, worst))))

    def test_a_filter_wider_than_a_pixel_makes_neighbours_alike(self):
        truth, theirs = pictures(4, 0.5)
        noise, taps = theirs - truth.mean, (0.25, 0.5, 0.25)
        for axis in (1, 2):
            noise = sum(t * np.roll(noise, i, axis) for i, t in enumerate(taps))
        for spread, is_right in ((0.375 ** -2, True), (1.0, False)):  # 0.375: of squared taps
            v = verdict.judge(truth.mean + noise, truth._replace(spread=spread))
            self.assertEqual(v.is_right, is_right)

    def test_small_mistakes_are_seen(self):
        truth, theirs = pictures(8, 0.1)
        for name, wrong in (("0.2 %", theirs * 1.002), ("moved", np.roll(theirs, 1, 2)),
                            ("a spot", theirs * (1 + 0.05 * (np.arange(64) < 6)[:, None]))):
            with self.subTest(name):
                self.assertFalse(verdict.judge(wrong, truth).is_right)

    def test_distributions(self):
        # Tables of any book: chi2(100) at 5 % is 124.342, Student's t(7) at 1 % two-sided 3.499.
        self.assertAlmostEqual(verdict.chi_square_p(124.342, 100), 0.05, 4)
        z = verdict.student_z(np.float64(3.499), np.float64(7))
        self.assertAlmostEqual(float(verdict.normal_p(z)), 0.01, 3)
        self.assertAlmostEqual(verdict.together(np.full(9, 0.03)), 0.03, 9)


class Causes(unittest.TestCase):
    def studio(self, name="still-lamps"):
        """Of 40 x 30 pixels, a third of the work of the kit's 64 x 48."""
        light = bis.Envmap(kit.light(name))
        text = kit.text(name).replace('xresolution" 64', 'xresolution" 40').replace(
            'yresolution" 48', 'yresolution" 30')
        studio = causes.Studio(text, light, light)
        self.assertEqual(studio.alpha.shape, (30, 40))
        return studio

    def pictures(self, studio, **how):
        return np.array([studio.scene.render(seed=100 + SEED + i, spp=3, **how).rgb
                         for i in range(8)], float)

    def search(self, change, name="still-lamps"):
        studio = self.studio(name)
        theirs = change(studio, lambda **how: self.pictures(studio, **how))
        studio.at(causes.LEVELS[2])
        v = verdict.judge(theirs, studio.right())
        self.assertFalse(v.is_right)
        return causes.search(studio, theirs)

    def assert_named(self, found, name):
        self.assertEqual(found[0].name, name)
        self.assertGreater(found[0].verdict.p, 1e-4)
        self.assertLess(found[1].verdict.p, verdict.WRONG)

    def test_sin_missing_is_named(self):
        def change(studio, render):
            m = studio.map.pixels
            rows = np.sin((np.arange(len(m)) + 0.5) * np.pi / len(m))[:, None, None]
            return render(light=np.float32(m / rows))
        self.assert_named(self.search(change),
                          "sin(theta) missing in the density (1/sin too much light)")

    def test_a_turn_and_a_cut_are_fitted(self):
        studio = self.studio()
        m = studio.map.pixels
        for name, coarse, value, off in (
                ("the map turned by %.4g degrees", np.arange(2, 6) / 32, 213 / 2048, 1 / 512),
                ("the map cut off at %.3g", np.arange(2.0, 5.0), 2.9, 0.1)):
            with self.subTest(name):
                changed = causes.NUMBERS[name](m, value)
                theirs = self.pictures(studio, light=np.ascontiguousarray(changed))
                fitted = causes._fitted(studio, theirs, name, coarse.tolist())
                self.assertLess(abs(fitted - value), off)

    def test_twice_the_light_is_named_with_all_that_it_may_be(self):
        light = bis.Envmap(kit.light("still-lamps"))
        studio = causes.Studio(kit.text("still-lamps"), light, light)
        studio.at(causes.LEVELS[1])
        truth = studio.right()
        noise = 1 + 0.01 * np.random.default_rng(SEED).standard_normal((8,) + truth.mean.shape)
        found = causes._try(studio, causes.FACTOR, causes.Studio.right, 2 * truth.mean * noise, 1e-4)
        self.assertEqual(found.name, "twice the light (MIS without weights, or +1 EV)")
        self.assertTrue(found.verdict.is_right)

    def not_apart(self, scenes, noise):
        """Pairs of causes that no scene tells apart at a noise of a tile. Each scene has to tell
        those alone which the scenes before it do not."""
        left = None
        for name, spp in scenes:
            studio = self.studio(name)
            studio.at((8, spp))
            said, apart = causes.apart(studio, sorted(set(sum(left or [], ()))))
            alike = [(said[j], a) for i, a in enumerate(said) for j in range(i)
                     if apart[i, j] < noise]
            left = alike if left is None else [pair for pair in left if pair in alike
                                               or pair[::-1] in alike]
        return left

    def test_the_kit_tells_every_cause_from_all_others(self):
        """Four scenes do, at a noise of 0.05 %. A kit without the last, of bright poles, would not."""
        scenes = [("die-day", 2), ("sky", 2), ("metal-floor", 2), ("poles", 32)]
        self.assertEqual(self.not_apart(scenes, 5e-4), [])
        self.assertIn(("right", "the rows at the poles missing"), self.not_apart(scenes[:2], 5e-4))

    def test_what_makes_one_picture_is_one_class(self):
        """A judge that took the first of them for the cause would be sure of a mistake that need not
        be there: under grey materials, channels of the map and of the picture are exchanged alike."""
        found = self.search(lambda studio, render: render()[..., ::-1], "still-colours")
        alike = [f for f in found if f.verdict.p >= verdict.WRONG]
        self.assertEqual({f.name for f in alike}, {"red and blue exchanged in the map",
                                                   "red and blue exchanged in the picture"})


class Kit(unittest.TestCase):
    def test_its_files_are_its_scenes(self):
        self.assertEqual(len(kit.NAMES), 24)
        with tempfile.TemporaryDirectory() as folder:
            names = "half-sky", "metal", kit.NAMES[-1]
            kit.write(folder, names)
            for name in names:
                file = bis.render(os.path.join(folder, name + ".txt"), spp=1)
                text = bis.render(kit.text(name), spp=1, light=kit.light(name))
                np.testing.assert_array_equal(file.rgb, text.rgb)

    def test_mitsubas_rows_make_the_bilinear_map(self):
        m = np.random.default_rng(SEED).random((8, 1, 3), np.float32).repeat(16, 1)
        rows = kit.for_mitsuba(m)
        y = (np.arange(64) + 0.5) / 64 * (len(rows) - 1)  # row i at 180 i/(h - 1) degrees
        low, part = y.astype(int), (y % 1)[:, None, None]
        np.testing.assert_allclose(rows[low] * (1 - part) + rows[low + 1] * part,
                                   causes._bilinear(m)[:, :16], rtol=1e-6)

    def test_its_exact_pictures_have_errors(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertIn("furnace ", report.write_exact(folder, ["furnace"], causes.LEVELS[1]))
            mean, error = (bis.read_image(os.path.join(folder, "exact", name))[0]
                           for name in ("furnace.exr", "furnace-stderr.exr"))
            self.assertAlmostEqual(float(mean[0, 0, 0]), 1, 6)  # the sky
            self.assertEqual(float(error[0, 0, 0]), 0)

    def test_the_closed_forms(self):
        """In a furnace of radiance 1 a ball shows its albedo (bis's own ground truth is no part of
        this); the sky shows 1."""
        p = bis.render(kit.text("furnace"), light=kit.light("furnace"), spp=64)
        albedo = kit.MATERIALS[kit.SCENES["furnace"].materials[0]][1][0][0]
        np.testing.assert_allclose(p.rgb[p.alpha == 1].mean(), albedo, rtol=2e-4)
        np.testing.assert_array_equal(p.rgb[p.alpha == 0], 1)


class Program(unittest.TestCase):
    def judge(self, *arguments):
        return subprocess.run([PROGRAM, "judge", *arguments], capture_output=True, text=True)

    def test_exit_states(self):
        light = kit.light("half-sky")
        right = bis.render(kit.text("half-sky"), light=light, spp=64, integrator="mis").rgb
        noise = 1 + 0.01 * np.random.default_rng(3).standard_normal(right.shape)
        with tempfile.TemporaryDirectory() as folder:
            def at(name):
                return os.path.join(folder, name)
            kit.write(at("kit"), ["half-sky"])
            np.save(at("half-sky.npy"), np.float32(right * noise))
            r = self.judge(folder, "--json", "--html", at("page.html"))
            self.assertEqual(r.returncode, 0, r.stdout + r.stderr)
            self.assertTrue(json.loads(r.stdout)[0]["right"])
            with open(at("page.html"), encoding="utf-8") as page:
                self.assertIn('"right": true', page.read())
            for name, a, said in (
                    ("eight.npy", np.round(right * noise * 40) / 40, "8 bits"),
                    ("bad.npy", np.where(right > 0.5, np.nan, right), "not finite"),
                    ("small.npy", (right * noise)[:, :9], "9 x 48 pixels, the scene 64 x 48"),
                    ("flat.npy", (right * noise)[..., 0], "give floats (h, w, 3)")):
                with self.subTest(name):
                    np.save(at(name), np.float32(a))
                    r = self.judge(at(name), at("kit/half-sky.txt"))
                    self.assertEqual(r.returncode, 2, r.stdout)
                    self.assertIn(said, r.stderr)


if __name__ == "__main__":
    unittest.main()
