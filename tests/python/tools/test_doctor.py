# SPDX-License-Identifier: BSD-2-Clause
"""The doctor of `bis envmap`: forty maps with a planted defect, of which each is named; forty without one, of which
none is accused; and how many samples a method needs."""
import os
import sys
import unittest
import unittest.mock
import warnings

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
sys.path.insert(0, os.path.join(ROOT, "scripts/python"))
import bis  # noqa: E402
from bis.tools import doctor, survey  # noqa: E402


def ours(name):
    """One of our maps, at most 512 wide."""
    p = bis.Envmap(os.path.join(ROOT, "data/maps", name + ".hdr")).pixels
    return p if p.shape[1] <= 512 else (p[::2, ::2] + p[1::2, ::2] + p[::2, 1::2] + p[1::2, 1::2]) / 4


MAPS = {name: ours(name) for name in ("outdoor", "interior", "studio", "overcast")}
DETAIL = np.exp(np.random.default_rng(1).normal(size=(8, 16, 3)))  # a photograph's


def exposed(p, share=0.95):
    """The map with so many of its values below 1."""
    return p / np.quantile(p, share)


def srgb(p):
    p = np.clip(p, 0, 1)
    return np.where(p <= 0.0031308, 12.92 * p, 1.055 * p ** (1 / 2.4) - 0.055)


def linear(p):
    return np.where(p <= 0.04045, p / 12.92, ((p + 0.055) / 1.055) ** 2.4)


def eight_bits(p):
    return np.round(255 * srgb(exposed(p))) / 255


def with_values(p, *values):
    p = p.copy()
    p[len(p) // 3, 5:5 + len(values), 1] = values
    return p


def with_cap(p, degrees, colour, at_top=False):
    p = p.copy()
    n = round(len(p) * degrees / 180)
    p[slice(n) if at_top else slice(-n, None)] = colour
    return p


def with_seam(p):
    """As of a panorama whose exposure drifted: three times as bright at the right side, not at the poles."""
    sin = np.sin(np.pi * (np.arange(len(p)) + 0.5) / len(p))[:, None, None]
    return p * 3 ** (np.linspace(0, 1, p.shape[1])[None, :, None] * sin ** 0.1)


def photograph(p):
    """A window of the map on all of the sphere; things stand in it."""
    h, w = p.shape[:2]
    return np.repeat(np.repeat(DETAIL, h // 8, 0), w // 16, 1) * p[h // 2:h // 2 + 1]


PLANTED = {
    "cut off at the ceiling 1:": lambda p: np.minimum(exposed(p), 1),
    "NaN": lambda p: with_values(p, np.nan, np.nan),
    "negative": lambda p: with_values(p, -1, -2),
    "infinite": lambda p: with_values(p, np.inf),
    "a black pole": lambda p: with_cap(p, 12, 0),
    "a patch of one colour": lambda p: with_cap(p, 20, (0.3, 0.2, 0.1)),
    "upside down": lambda p: p[::-1],
    "stretched": photograph,
    "sRGB not undone": eight_bits,
    "banded": lambda p: linear(eight_bits(p)) * 3,
    "a seam": with_seam,
}


def found(p):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        m = survey.Map(bis.Envmap(np.ascontiguousarray(p, np.float32)))
        return doctor.find(m, survey.intensity(m.pixels))


class Planted(unittest.TestCase):
    def test_each_defect_is_named(self):
        for name, plant in PLANTED.items():
            for of, p in MAPS.items():
                if (name, of) == ("a seam", "interior"):
                    continue  # its pillars are steps of 60 % in most rows
                with self.subTest(name=name, map=of):
                    self.assertTrue(any(name in words for words in found(plant(p))), found(plant(p)))

    def test_a_sun_that_was_cut_off(self):
        for most in (16, 100, 1000):
            words = " ".join(found(np.minimum(MAPS["outdoor"], most)))
            self.assertIn("cut off at %s%g: " % ("the ceiling " if most == 16 else "", most), words)
            self.assertIn("it is the sun, and 40 %", words)
        # Lamps that were are no sun, nor is one that lost only its tip.
        self.assertNotIn("sun", " ".join(found(np.minimum(exposed(MAPS["interior"]), 1))))
        y, x = np.mgrid[:512, :1024]
        lamp = 4140 * np.exp(-((y - 100) ** 2 + (x - 300.5) ** 2) / 150)[..., None] * np.ones(3)
        grain = np.random.default_rng(3).random((512, 1024, 3)) * np.sin(np.pi * (y + 0.5) / 512)[..., None] ** 2
        words = " ".join(found(np.minimum(lamp + 1 + grain / 10, 4096)))
        self.assertIn("cut off at 4096", words)
        self.assertNotIn("sun", words)

    def test_few_pixels_tell_nothing(self):
        for size in ((1, 128), (8, 16), (11, 22), (32, 64)):
            self.assertEqual(found(np.random.default_rng(6).random(size + (3,))), [])


def drawn(colour=0.1):
    return np.full((128, 256, 3), colour, np.float32)


def clean():
    """Names and maps that nothing is wrong with."""
    for name, p in MAPS.items():
        yield name, p
        for k in (13, 100):
            yield "%s turned by %d" % (name, k), np.roll(p, k, 1)
        yield name + " mirrored", p[:, ::-1]
        yield name + " darker", p * np.float32(0.01)
        yield name + " of half floats", np.minimum(p, 65000).astype(np.float16)
        yield name + " brighter", p * np.float32(30)
    yield "constant", drawn(1)
    for size in (1, 8, 32):
        cells = np.add.outer(np.arange(128) // size, np.arange(256) // size)
        yield "checker %d" % size, cells[..., None] % 2 * drawn(1)
    grain = 1 + 0.1 * np.random.default_rng(2).random((128, 256, 1)) * np.sin(
        np.pi * (np.arange(128)[:, None, None] + 0.5) / 128)  # less at the poles, where pixels are small
    for most in (1, 16, 300):
        p = drawn(0.05) * grain
        p[20:50, 30:60] = p[30:60, 150:200] = most
        yield "softboxes of %d" % most, p
    p = drawn(0.05) * grain
    p[30, 50] = 5000
    yield "one lamp", p
    yield "night", np.float32(0.001) * grain ** 4 * drawn()
    # A small sun of one radiance, drawn in a sky: flat, and whole.
    p = MAPS["outdoor"].copy()
    p[p.sum(2) > 100] = 60000
    yield "a drawn sun", p
    yield "black below", with_cap(MAPS["outdoor"], 90, 0)
    yield "a floor of one colour", with_cap(MAPS["studio"], 80, 0.2)


class Clean(unittest.TestCase):
    def test_none_is_accused(self):
        maps = list(clean())
        self.assertGreaterEqual(len(maps), 40)
        for name, p in maps:
            with self.subTest(name):
                self.assertEqual(found(p), [])

    def test_a_doctor_who_takes_any_sun_for_a_cut_off_one_is_caught(self):
        with unittest.mock.patch.object(doctor, "SKY", 1e9):
            self.assertIn("it is the sun", " ".join(found(dict(clean())["a drawn sun"])))


class Light(unittest.TestCase):
    def test_samples_of_a_constant_map(self):
        # Cosine-drawn samples of a constant map have no spread. Drawn over the sphere: E = pi, and the second moment of
        # 4 pi cos+ is 4 pi 2 pi/3, so that the relative variance is 5/3.
        d = doctor.diagnose(survey.Map(bis.Envmap(drawn(1), "alias", 0)))
        self.assertEqual(round(d.samples["brdf"]), 1)
        self.assertAlmostEqual(d.samples["em"] / (1e4 * 5 / 3), 1, places=2)
        self.assertAlmostEqual(d.exposure, 0, places=5)

    def test_a_lamp_and_the_sun_are_found(self):
        lamps = doctor.diagnose(survey.Map(bis.Envmap(MAPS["outdoor"]))).lamps
        self.assertEqual([lamp.is_sun for lamp in lamps], [True])
        p = drawn(0.01)
        p[60:64, 254:] = p[60:64, :2] = 10  # round the seam, at theta 87 and phi 0
        lamp, = doctor.diagnose(survey.Map(bis.Envmap(p))).lamps
        self.assertFalse(lamp.is_sun)
        angle = bis.Envmap(p).solid_angles[60:64].sum() * 4
        self.assertAlmostEqual(lamp.solid_angle, angle)
        self.assertAlmostEqual(lamp.share, 10 * angle / (10 * angle + 0.01 * (4 * np.pi - angle)), places=5)
        np.testing.assert_allclose(lamp.direction[2:], (1, 0, np.cos(np.pi * 62 / 128)), atol=0.01)


if __name__ == "__main__":
    unittest.main()
