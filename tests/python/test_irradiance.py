# SPDX-License-Identifier: BSD-2-Clause
"""Irradiance and spherical harmonics of a map, and irradiance at points of a scene, against integrals that are known in
closed form."""
import os
import sys
import unittest
import unittest.mock

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "scripts/python"))
import bis  # noqa: E402
from bis import _irradiance  # noqa: E402

COLOUR = np.array([1, 2, 4])


def lit(mask):
    """A map of COLOUR where mask (h, w) is."""
    return bis.Envmap((mask[..., None] * COLOUR).astype(np.float32), "cdf", 0)


def normals(n, seed):
    v = np.random.default_rng(seed).normal(size=(n, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


class Irradiance(unittest.TestCase):
    def test_of_a_hemisphere(self):
        # Seen by a normal of angle t to its axis: pi (1 + cos t)/2.
        n = normals(50, 1)
        for height in (2, 32):
            upper = np.arange(height)[:, None] * np.ones(2 * height) < height / 2
            np.testing.assert_allclose(lit(upper).irradiance(3 * n), np.pi / 2 * (1 + n[:, 2:]) * COLOUR, rtol=1e-4)
            right = (np.arange(2 * height) < height) & np.ones((height, 1), bool)  # phi in [0, pi]: y > 0
            np.testing.assert_allclose(lit(right).irradiance(n), np.pi / 2 * (1 + n[:, 1:2]) * COLOUR, atol=4e-4)

    def test_of_a_lune_and_of_all(self):
        # A lune of half-angle a around x: along x pi sin a, along z a.
        w = lit((abs(np.arange(64) - 31.5) < 4) & np.ones((32, 1), bool))
        a, middle = 4 * 2 * np.pi / 64, np.array((-1, 0, 0))
        np.testing.assert_allclose(w.irradiance([middle, (0, 0, 1), (0, 0, -2), -middle])[:, 0],
                                   [np.pi * np.sin(a), a, a, 0], atol=1e-5)
        np.testing.assert_allclose(lit(np.ones((4, 8))).irradiance(normals(20, 2)), np.pi * np.tile(COLOUR, (20, 1)),
                                   rtol=2e-3)

    def test_of_one_pixel_turns_with_it(self):
        # What the moved pixel gives to the moved normal is the same, across column 0, too.
        n, turn = normals(20, 3), 2 * np.pi * 5 / 16
        there = np.stack((np.cos(turn) * n[:, 0] - np.sin(turn) * n[:, 1],
                          np.sin(turn) * n[:, 0] + np.cos(turn) * n[:, 1], n[:, 2]), axis=1)
        one = np.zeros((8, 16), bool)
        one[3, 13] = True
        np.testing.assert_allclose(lit(one).irradiance(n), lit(np.roll(one, 5, 1)).irradiance(there), atol=1e-9)

    def test_in_blocks_of_rows(self):
        light, n = bis.Envmap(np.random.default_rng(4).random((16, 32, 3))), normals(20, 5)
        whole = light.irradiance(n)
        with unittest.mock.patch.object(_irradiance, "CELLS", 32 * 5):
            np.testing.assert_allclose(light.irradiance(n), whole)

    def test_what_is_no_direction_is_refused(self):
        for wrong in ([[0, 0, 0]], [[np.nan, 0, 1]], [1, 2]):
            with self.assertRaises((bis.Error, TypeError)):
                lit(np.ones((2, 4))).irradiance(wrong)


class Harmonics(unittest.TestCase):
    def test_of_few_pixels(self):
        for size in ((1, 2), (1, 3), (2, 3), (17, 40)):
            h = lit(np.ones(size)).harmonics()
            np.testing.assert_allclose(h.radiance[0], 2 * np.sqrt(np.pi) * COLOUR, err_msg=size)
            np.testing.assert_allclose(h.radiance[1:], 0, atol=1e-6, err_msg=size)

    def test_of_a_constant_map_and_a_hemisphere(self):
        h = lit(np.ones((16, 32))).harmonics()
        np.testing.assert_allclose(h.radiance[0], 2 * np.sqrt(np.pi) * COLOUR)
        np.testing.assert_allclose(h.radiance[1:], 0, atol=1e-6)
        self.assertLess(h.of_itself[1], 1e-3)
        # Above: sqrt(3/(4 pi)) pi for z, and nothing in band 2; E is pi (1 + cos)/2, which two bands tell.
        upper = lit(np.arange(16)[:, None] * np.ones(32) < 8).harmonics()
        expected = np.zeros(9)
        expected[0], expected[2] = np.sqrt(np.pi), np.sqrt(3 * np.pi) / 2
        np.testing.assert_allclose(upper.radiance[:, 0], expected, atol=1e-6)
        self.assertLess(upper.of_mean[1], 1e-3)

    def test_along_the_axes_of_each_program(self):
        # A lamp in the middle of the picture, above its horizon. Where the programs see it:
        middle = np.zeros((16, 32), bool)
        middle[4, 15:17] = True
        up = np.cos(np.pi * 4.5 / 16)
        side = np.sqrt(1 - up * up)
        for frame, (x, y, z) in (("bis", (-1, 0, up)), ("blender", (1, 0, up)), ("mitsuba", (0, up, 1)),
                                 ("three", (1, up, 0)), ("unity", (1, up, 0))):
            band1 = lit(middle).harmonics(frame).radiance[[3, 1, 2], 0]
            np.testing.assert_allclose(band1 / np.linalg.norm(band1), np.where(np.array((x, y, z)) == up, up, np.array(
                (x, y, z)) * side), atol=0.02, err_msg=frame)
        # A quarter to the right of it: the pictures are not mirrored.
        right = np.roll(middle, 8, 1)
        for frame, axis, sign in (("bis", 1, -1), ("blender", 1, -1), ("mitsuba", 0, -1), ("three", 2, 1),
                                  ("unity", 2, -1)):
            band1 = lit(right).harmonics(frame).radiance[[3, 1, 2], 0]
            self.assertGreater(sign * band1[axis], 0.5 * np.linalg.norm(band1), frame)
        with self.assertRaisesRegex(bis.Error, "blender"):
            lit(middle).harmonics("maya")

    def test_the_error_is_told(self):
        # A lamp of one pixel lights half of all normals; nine coefficients give some to the other half: without end.
        one = np.zeros((128, 256), bool)
        one[40, 7] = True
        h = lit(one).harmonics()
        self.assertEqual(h.of_itself[1], np.inf)
        # In three bands the clamped cosine c is 1/4 + c/2 + 5 (3 c^2 - 1)/32: off by 3/32 at c = 0, of a mean of 1/4.
        self.assertAlmostEqual(h.of_mean[1], 4 * 3 / 32, delta=0.02)


SCENE = '''Film "rgb" "integer xresolution" 8 "integer yresolution" 8
    LookAt 0 -3 5  0 0 0  0 0 1  Camera "perspective" "float fov" 30
    WorldBegin LightSource "infinite" "rgb L" [1 2 4] Material "diffuse" "rgb reflectance" [0.5 0.5 0.5] %s'''


class Points(unittest.TestCase):
    def test_beside_a_wall_and_under_a_ball(self):
        # A wall from the point up hides half. A ball of radius r straight above at the distance d hides (r/d)^2 of pi.
        wall = bis.Mesh([(0, -1e4, 0), (0, 1e4, 0), (0, 1e4, 1e4), (0, -1e4, 1e4)], [(0, 1, 2), (0, 2, 3)])
        up = np.tile((0, 0, 1), (300, 1))
        p = np.random.default_rng(5).random((300, 3)) * (-0.01, 1, 1) - (0.001, 0, 0)
        ball = 'Translate 0 0 3 Shape "sphere" "float radius" 1.5'
        for shapes, points, share in ((wall, p, 1 / 2), (ball, np.zeros((300, 3)), 3 / 4), (ball, up * 99, 1)):
            scene = bis.Scene(SCENE % shapes)
            found = scene.irradiance(points, 3 * up, spp=16, seed=6)
            E = share * np.pi * COLOUR
            # All 300 estimate one number; the mean is off by less than 4 standard errors, and each by its interval.
            mean, spread = found.E.mean(0), found.E.std(0, ddof=1)
            self.assertTrue((abs(mean - E) <= 4 * spread / np.sqrt(300) + 2e-6 * E).all(), (mean, E, spread))
            self.assertTrue((abs(mean - 0.97 * E) > 4 * spread / np.sqrt(300)).all())  # twin
            self.assertGreater((abs(found.E - E) <= found.interval + 1e-5 * E).mean(), 0.9)

    def test_the_triangles_of_a_scene(self):
        triangle = 'Shape "trianglemesh" "integer indices" [0 1 2] "point3 P" [0 0 0  1 0 0  0 1 0  7 7 7]'
        scene = bis.Scene(SCENE % ('''Shape "sphere"
            AttributeBegin Translate 1 2 3 %s AttributeEnd
            AttributeBegin Scale -2 1 1 %s "normal N" [0 0 -1  0 0 -1  0 0 -1  0 0 -1] AttributeEnd
            ObjectBegin "a" %s ObjectEnd
            Rotate 90 0 0 1 ObjectInstance "a"''' % (triangle, triangle, triangle)))
        corners = {1: [(1, 2, 3), (2, 2, 3), (1, 3, 3)], 2: [(0, 0, 0), (0, 1, 0), (-2, 0, 0)],  # a mirrored one turns
                   3: [(0, 0, 0), (0, 1, 0), (-1, 0, 0)]}
        for shape, p in corners.items():
            mesh = scene.mesh(shape)
            self.assertEqual(len(mesh.vertices), 3)
            np.testing.assert_allclose(mesh.vertices[mesh.faces[0]], p, atol=1e-6)
            np.testing.assert_allclose(mesh.crosses()[0], (0, 0, 2 if shape == 2 else 1), atol=1e-6)
            np.testing.assert_allclose(mesh.normals, [(0, 0, -1 if shape == 2 else 1)] * 3, atol=1e-6)
        whole = scene.mesh()
        np.testing.assert_allclose(whole.centres(), np.mean([corners[k] for k in (1, 2, 3)], axis=1), atol=1e-6)
        with self.assertRaisesRegex(bis.Error, "shape 0 has no triangles; others have: 1, 2, 3"):
            scene.mesh(0)
        with self.assertRaisesRegex(bis.Error, "no meshes"):
            bis.Scene(SCENE % 'Shape "sphere"').mesh()

    def test_on_a_mesh_no_point_shadows_itself_and_order_does_not_count(self):
        rng = np.random.default_rng(7)
        p = rng.random((700, 3)) * (8, 8, 0) - (4, 4, -1e3)  # three digits before the point
        square = bis.Mesh([(-9, -9, 1e3), (9, -9, 1e3), (9, 9, 1e3), (-9, 9, 1e3)], [(0, 1, 2), (0, 2, 3)])
        scene = bis.Scene(SCENE % square)
        up = np.tile((0, 0, 1), (700, 1))
        found = scene.irradiance(p, up, spp=4)
        np.testing.assert_allclose(found.E, np.pi * np.tile(COLOUR, (700, 1)), rtol=0.05)
        order = rng.permutation(700)
        np.testing.assert_array_equal(scene.irradiance(p[order], up, spp=4).E, found.E[order])
        # A twin below the surface, where little comes in beside the rim: how little is not known.
        below = scene.irradiance(p - 0.1 * up, up, lift=0, spp=4)
        self.assertLess(below.E.mean(), 0.02)
        self.assertTrue(np.isnan(below.interval).all())
        # The scene's own pictures have pixels again.
        self.assertEqual(scene.render(spp=1).rgb.shape, (8, 8, 3))

    def test_intervals_hold_at_each_point(self):
        # Under a map with a sun, in the open, E is known. One interval of 20 misses; over 2000 points that share
        # directions of the map, fewer than one of ten. Twin: intervals of half the size miss far more.
        light = bis.Envmap(os.path.join(ROOT, "data/maps/outdoor.hdr"))
        scene = bis.Scene(SCENE % 'Translate 0 0 -1e3 Shape "sphere" "float radius" 1', light=light)
        n = normals(2000, 8)
        E = light.irradiance(n)
        found = scene.irradiance(n, n, spp=16, seed=9)
        missed = np.nanmean(abs(found.E - E) > found.interval)
        self.assertLess(missed, 0.1)
        self.assertGreater(np.mean(abs(found.E - E) > found.interval / 2), 0.15)
        self.assertLess(np.median(abs(found.E / E - 1)), 0.01)

    def test_intervals_hold_in_a_room_whose_window_is_found(self):
        # Lambert's formula: a polygon of radiance 1 gives half the sum of its edges' angles times their normals.
        window = np.array([(2, -0.5, 1), (2, 0.5, 1), (2, 0.5, 2), (2, -0.5, 2)], float)
        walls = [[(a, b, c) for a, b in ((-2, -2), (2, -2), (2, 2), (-2, 2))] for c in (0, 3)]
        walls += [[(a * x, a * -2, z) for x, z in ((-2, 0), (2, 0), (2, 3), (-2, 3))] for a in (1, -1)]
        walls += [[(-2, y, z) for y, z in ((-2, 0), (2, 0), (2, 3), (-2, 3))]]
        outer = np.array([(2, -2, 0), (2, 2, 0), (2, 2, 3), (2, -2, 3)], float)
        walls += [[outer[k], outer[(k + 1) % 4], window[(k + 1) % 4], window[k]] for k in range(4)]
        faces = (4 * np.arange(len(walls))[:, None, None] + [(0, 1, 2), (0, 2, 3)]).reshape(-1, 3)
        room = bis.Mesh(np.concatenate(walls), faces)
        p = np.random.default_rng(11).random((400, 3)) * (3.8, 3.8, 0) - (1.9, 1.9, -0.8)
        up = np.tile((0, 0, 1.0), (400, 1))
        to = (window - p[:, None]) / np.linalg.norm(window - p[:, None], axis=2, keepdims=True)
        turned = np.roll(to, -1, axis=1)
        cross = np.cross(to, turned)
        angle = np.arccos((to * turned).sum(2)) / np.linalg.norm(cross, axis=2)
        E = np.outer(abs((angle[..., None] * cross).sum(1)[:, 2]) / 2, COLOUR)
        found = bis.Scene(SCENE % room).irradiance(p, up, spp=16, seed=12)
        self.assertLess(np.median(abs(found.E / E - 1)), 0.02)
        self.assertGreater(np.mean(abs(found.E - E) <= found.interval), 0.9)
        self.assertLess(np.mean(abs(found.E - E) <= found.interval / 3), 0.75)  # twin
        # Without the window less than 5 % of the light arrives at most points: nothing is promised there.
        closed = SCENE.replace("[1 2 4]", '[1 2 4] "bool windows" false')
        self.assertGreater(np.isnan(bis.Scene(closed % room).irradiance(p, up, spp=16).interval).mean(), 0.8)

    def test_what_cannot_be_is_refused(self):
        scene = bis.Scene(SCENE % 'Shape "sphere"')
        up = np.array([(0, 0, 1.0)])
        for p, n, words in ((up, up[:0], "1 points have 0 normals"), (np.nan * up, up, "finite"),
                            (up, 0 * up, "a normal that is not 0"), (up[:0], up[:0], "0 points")):
            with self.assertRaisesRegex(bis.Error, words):
                scene.irradiance(p, n)
        many = np.tile(up, (40, 1))
        for wrong in (np.nan, np.inf, 1e39):
            other = many.copy()
            other[37, 1] = wrong
            with self.assertRaisesRegex(bis.Error, "point 37: give finite"):
                scene.irradiance(other, many)
        if bis.about()["embree_version"]:
            with self.assertRaisesRegex(bis.Error, "accelerator=grid"):
                scene.irradiance(1e30 * up, up)
        for what in ({"width": 99}, {"step": 2}, {"crop": "0,0.5,0,1"}, {"camera": 'Camera "perspective"'}):
            with self.assertRaisesRegex(bis.Error, "points stand in the place of pixels"):
                scene.irradiance(many, many, **what)
        with self.assertRaisesRegex(bis.Error, "no layers"):
            scene.irradiance(many, many, layers="albedo")
        with self.assertRaisesRegex(bis.Error, "no shapes"):
            bis.Scene(SCENE % "").irradiance(up, up)


class Groups(unittest.TestCase):
    def test_pictures_of_parts_add_up(self):
        # A surface that faces up, under a lamp and its surroundings. The camera's up is z, and so the map's (upright).
        square = bis.Mesh([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [(0, 1, 2), (0, 2, 3)])
        scene = bis.Scene('''Film "rgb" "integer xresolution" 8 "integer yresolution" 8
            LookAt 0 -3 5  0 0 0  0 0 1  Camera "perspective" "float fov" 30
            WorldBegin LightSource "infinite" Material "diffuse" "rgb reflectance" [0.5 0.5 0.5] %s''' % square)
        p = np.random.default_rng(4).random((16, 32, 3))
        p[3, 9] = 1000
        lamp = p > 1
        pictures = [scene.render(light=p * part, spp=64, seed=k).rgb.mean((0, 1))
                    for k, part in enumerate((lamp, ~lamp, p > 0))]
        np.testing.assert_allclose(pictures[0] + pictures[1], pictures[2], rtol=0.002)
        E = bis.Envmap(p).irradiance([(0, 0, 1)])[0]
        np.testing.assert_allclose(pictures[2], 0.5 / np.pi * E, rtol=0.002)


if __name__ == "__main__":
    unittest.main()
