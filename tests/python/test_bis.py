# SPDX-License-Identifier: BSD-2-Clause
"""What the package bis of scripts/python promises. Expected values are closed forms, sums over
pixels, or pictures of the program.

Statistical tests compare a mean with its expectation within 5 standard errors (two-sided 6e-7 each, ten tests); each
has a twin."""
import copy
import gc
import glob
import importlib.util
import io
import json
import os
import pickle
import re
import subprocess
import sys
import tempfile
import unittest
import warnings
from contextlib import redirect_stdout
from unittest import mock

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "scripts/python"))
import bis  # noqa: E402

MAP = os.path.join(ROOT, "data/maps/interior.hdr")
SCENE = """Film "rgb" "integer xresolution" 24 "integer yresolution" 16 "string filename" "out.pfm"
Sampler "random" "integer pixelsamples" 2
Integrator "sir" "integer candidates" 20 "integer shadowrays" 2
LookAt 0 -5 1  0 0 0  0 0 1
Camera "perspective" "float fov" 40
WorldBegin
LightSource "infinite" "rgb L" [1 2 3]
Material "phong" "rgb Kd" [.5 .4 .3] "rgb Ks" [.2 .2 .2] "float exponent" 5
Shape "sphere" "float radius" 1
"""


def off(x, expected):
    """How many standard errors the mean of x is from the expected one."""
    return abs(x.mean() - expected) / (x.std() / np.sqrt(len(x)))


class Maps(unittest.TestCase):
    def test_mean_of_radiance_over_density_is_the_integral(self):
        for table in ("alias", "cdf"):
            em = bis.Envmap(MAP, table=table)
            h, w = em.shape
            edges = np.cos(np.pi * np.arange(h + 1) / h)
            integral = (em.pixels.sum(2, dtype=np.float64).sum(1) * (edges[:-1] - edges[1:])).sum() * 2 * np.pi / w
            self.assertAlmostEqual(em.power / integral, 1, places=9)
            _, L, pdf = em.sample(200000, seed=3)
            ratio = L.sum(1, dtype=np.float64) / pdf
            self.assertLess(off(ratio, integral), 5)
            self.assertGreater(off(1.02 * ratio, integral), 5)  # twin

    def test_look_and_sample_agree(self):
        em = bis.Envmap(MAP)
        w, L, pdf = em.sample(1000)
        # A float direction at the edge of a pixel may round into its neighbour: few of them, and never far.
        L2, pdf2 = em.look(w * np.float32(7))
        self.assertGreater(np.mean(pdf == pdf2), 0.99)
        self.assertGreater(np.mean((L == L2).all(1)), 0.99)
        np.testing.assert_allclose(np.linalg.norm(w, axis=1), 1, atol=1e-6)

    def test_same_seed_same_directions(self):
        em = bis.Envmap(MAP)
        self.assertTrue((em.sample(10, seed=5)[0] == em.sample(10, seed=5)[0]).all())
        self.assertFalse((em.sample(10, seed=5)[0] == em.sample(10, seed=6)[0]).all())


    def test_an_array_is_a_map(self):
        em = bis.Envmap(MAP, table="cdf")
        made = bis.Envmap(em.pixels, table="cdf")
        for a, b in zip(em.sample(500, seed=2), made.sample(500, seed=2)):
            self.assertTrue((a == b).all())
        self.assertTrue((made.pixels == em.pixels).all())
        view = bis.Envmap(em.pixels.astype(np.float64)[:, ::-1])  # neither dense nor float
        self.assertTrue((view.pixels == em.pixels[:, ::-1]).all())
        # All pixels of an equal-area square have one solid angle: its integral is 4 pi times its mean.
        square = np.random.default_rng(3).random((8, 8, 3))
        self.assertAlmostEqual(bis.Envmap(square, mapping="equalarea").power / (4 * np.pi * square.sum() / 64), 1,
                               places=5)
        self.assertNotAlmostEqual(bis.Envmap(square, mapping="latlong").power / (4 * np.pi * square.sum() / 64), 1,
                                  places=3)

    def test_what_is_no_map(self):
        for a, text in (
            (np.ones((2, 4)), "map has the shape (2, 4): give (h, w, 3)"),
            (np.ones((0, 4, 3)), "4 x 0"),
            (np.ones((4, 4, 3)), '"the array" is square'),
            (np.ones((2, 4, 3), bool), "map is"),
            ([["a"]], "map is"),
            (5, "map is 5: give a path, or an array of numbers"),
        ):
            with self.assertRaises(bis.Error) as e:
                bis.Envmap(a)
            self.assertIn(text, str(e.exception))
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            holes = bis.Envmap(np.array([[[1, np.nan, 1], [-1, 1, 1e300]]]))
        self.assertIn("1 NaN, 1 infinite, 1 negative", str(said[0].message))
        self.assertEqual(holes.pixels.ravel().tolist(), [1, 0, 1, 0, 1, 0])


class Tables(unittest.TestCase):
    def test_the_tables_of_the_thesis(self):
        t = bis.AliasTable([0.1, 0.2, 0.4, 0.3])  # figure 3.4
        np.testing.assert_allclose(t.prob, [0.4, 0.8, 1, 1], rtol=1e-12)
        self.assertEqual(list(t.alias[:2]), [2, 3])
        items = t.sample(100000, seed=1)
        for i, p in enumerate([0.1, 0.2, 0.4, 0.3]):
            self.assertLess(off((items == i).astype(float), p), 5)
        self.assertGreater(off((items == 0).astype(float), 0.11), 5)  # twin


class Materials(unittest.TestCase):
    def test_densities_and_reflectance(self):
        """E[cos^2 / pdf] over the hemisphere is 2 pi/3, whatever the density; E[f cos / pdf] of a diffuse surface is
        Kd."""
        for width in ({"exponent": 5}, {"roughness": 0.5}):
            m = bis.Material(0.5, 0.5, normal=(1, 2, 3), wo=(1, 2, 4), **width)
            wi, lobe = m.sample(200000, seed=2)
            _, pdf = m.look(wi)
            cos = np.maximum(0, wi @ np.array([1, 2, 3]) / np.sqrt(14))
            self.assertLess(off(cos**2 / pdf, 2 * np.pi / 3), 5)
            self.assertGreater(off(1.05 * cos**2 / pdf, 2 * np.pi / 3), 5)  # twin
            self.assertTrue(lobe.any() and not lobe.all())
        m = bis.Material((0.5, 0.2, 0.1), 0, exponent=1)
        f, _ = m.look([[0, 0, 1], [0, 3, 4], [0, 0, -1]])
        np.testing.assert_allclose(f[:2], np.array([[0.5, 0.2, 0.1]] * 2) / np.pi, rtol=1e-6)
        self.assertEqual(f[2].sum(), 0)


    def test_a_metal_of_eta_and_k(self):
        """Copper's red, head on: ((eta - 1)^2 + k^2)/((eta + 1)^2 + k^2), where Schlick's facets of that colour are the
        same."""
        eta, k = np.array([0.2, 0.92, 1.1]), np.array([3.9, 2.45, 2.14])
        Ks = ((eta - 1) ** 2 + k**2) / ((eta + 1) ** 2 + k**2)
        for wo, is_same in (((0, 0, 1), True), ((-0.97, 0, 0.25), False)):  # the second is the twin
            metal = bis.Material(eta=eta, k=k, roughness=0.4, wo=wo)
            facets = bis.Material(0, Ks, roughness=0.4, wo=wo)
            wi = [[-wo[0], 0, wo[2]]]
            self.assertEqual(np.allclose(metal.look(wi)[0], facets.look(wi)[0], rtol=1e-5), is_same)


class Pictures(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.scene = os.path.join(self.folder.name, "scene.txt")
        with open(self.scene, "w") as f:
            f.write(SCENE)

    def tearDown(self):
        self.folder.cleanup()

    def by_program(self, *options):
        out = os.path.join(self.folder.name, "out.pfm")
        program = os.environ.get("BIS_PROGRAM", os.path.join(ROOT, "bis"))
        r = subprocess.run([program, self.scene, "--outfile", out, "--stats", "-", *options], check=True,
                           capture_output=True)
        with open(out, "rb") as f:
            f.readline(), f.readline(), f.readline()
            data = np.frombuffer(f.read(), "<f4")
        return data.reshape(16, -1, 3)[::-1], json.loads(r.stdout)

    def test_same_bits_as_the_program(self):
        for settings in ({}, {"integrator": "em", "samples": 3}, {"spp": 3, "seed": 2**53 - 1}, {"proposal": "brdf"}):
            options = [o for name, value in settings.items() for o in ("--" + name, str(value))]
            expected, figures = self.by_program(*options)
            picture, stats = bis.render(self.scene, **settings)
            self.assertEqual(picture.shape, (16, 24, 3))
            self.assertTrue((picture == expected).all())
            for key in ("integrator", "samples", "candidates", "spp", "seed", "triangles", "rays"):
                self.assertEqual(stats[key], figures[key])
        self.assertFalse((bis.render(self.scene, seed=2).rgb == expected).all())  # twin

    def test_size_and_switches(self):
        picture, _ = bis.render(self.scene, width=12, height=8, threads=1, accelerator="grid", stratify=False, spp=1)
        self.assertEqual(picture.shape, (8, 12, 3))


    def test_the_text_of_a_scene_is_the_scene(self):
        expected = bis.render(self.scene).rgb
        self.assertTrue((bis.render(SCENE).rgb == expected).all())
        with self.assertRaises(bis.Error) as e:
            bis.render(SCENE + 'Shape "cube"')
        self.assertIn("scene:10:7: error", str(e.exception))
        eye = bis.Camera((0, -5, 1), (0, 0, 0))
        self.assertTrue((bis.render(SCENE, camera=eye).rgb == expected).all())
        other = bis.render(SCENE, camera=eye._replace(fov=50)).rgb
        self.assertTrue((bis.render(SCENE.replace("fov\" 40", "fov\" 50")).rgb == other).all())
        self.assertFalse((other == expected).all())  # twin
        self.assertTrue((bis.render(SCENE, camera=str(eye)).rgb == expected).all())

    def test_layers_alpha_and_crop(self):
        p = bis.render(SCENE, layers=["albedo", "depth", "stderr"], spp=8)
        self.assertEqual({k: v.shape for k, v in p.layers.items()},
                         {"stderr": (16, 24, 3), "albedo": (16, 24, 3), "depth": (16, 24)})
        # In the middle the sphere of radius 1 is sqrt(26) - 1 away, at its nearest point.
        np.testing.assert_allclose(p.layers["albedo"][8, 12], [0.7, 0.6, 0.5], atol=1e-6)
        self.assertTrue(np.sqrt(26) - 1 <= p.layers["depth"][8, 12] < 4.2)
        self.assertEqual((p.alpha[8, 12], p.alpha[0, 0]), (1, 0))
        rgb, stats = p
        self.assertTrue(rgb is p.rgb and stats is p.stats)
        self.assertEqual(set(bis.render(SCENE, layers="all", spp=4).layers), set(bis.LAYERS))
        self.assertEqual(set(bis.render(SCENE, layers="all", spp=1).layers), set(bis.LAYERS) - {"stderr", "interval"})
        self.assertEqual(bis.render(SCENE).layers, {})
        cut = bis.render(SCENE, crop=(0.25, 0.75, 0, 0.5), spp=8)
        self.assertTrue((cut.rgb == p.rgb[:8, 6:18]).all())

    def test_another_light(self):
        expected, _ = self.by_program("--light", MAP)
        em = bis.Envmap(MAP)
        for light in (MAP, em, em.pixels):
            self.assertTrue((bis.render(self.scene, light=light).rgb == expected).all())
        # A white furnace: a diffuse sphere of Kd = 1/2 under radiance 1 has the radiance 1/2.
        white = SCENE.replace('"rgb Kd" [.5 .4 .3] "rgb Ks" [.2 .2 .2]', '"rgb Kd" [.5 .5 .5] "rgb Ks" [0 0 0]')
        p = bis.render(white, light=np.ones((4, 8, 3)), integrator="exact", spp=16)
        inside = p.alpha == 1
        self.assertLess(off(p.rgb[inside].mean(1, dtype=np.float64), 0.5), 5)
        self.assertGreater(off(1.1 * p.rgb[inside].mean(1, dtype=np.float64), 0.5), 5)  # twin

    def test_a_mesh_of_arrays_is_the_mesh_of_a_file(self):
        rng = np.random.default_rng(1)
        points = rng.normal(size=(30, 3)).astype(np.float32)
        faces, normals, uv = rng.permutation(30).reshape(10, 3), points + np.float32(0.1), rng.random((30, 2))
        mesh = bis.Mesh(points, faces, normals, uv)
        with open(os.path.join(self.folder.name, "mesh.ply"), "wb") as f:
            f.write(b"ply\nformat binary_little_endian 1.0\nelement vertex 30\n")
            f.write(b"".join(b"property float %s\n" % name
                             for name in (b"x", b"y", b"z", b"nx", b"ny", b"nz", b"u", b"v")))
            f.write(b"element face 10\nproperty list uchar int vertex_indices\nend_header\n")
            f.write(np.hstack([points, normals, uv]).astype("<f4").tobytes())
            for face in faces:
                f.write(b"\3" + face.astype("<i4").tobytes())
        texture = 'Texture "t" "spectrum" "checkerboard" Material "phong" "texture Kd" "t" "rgb Ks" [0 0 0] '
        begin = SCENE[:SCENE.index("Material")] + texture
        with open(self.scene, "w") as f:
            f.write(begin + 'Shape "plymesh" "string filename" "mesh.ply"')
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that the last one has no texture coordinates
            pictures = [bis.render(s, layers="all")
                        for s in (self.scene, begin + str(mesh), begin + str(bis.Mesh(points, faces)))]
        for name in ("normal", "albedo", "depth"):
            self.assertTrue((pictures[0].layers[name] == pictures[1].layers[name]).all())
        self.assertTrue((pictures[0].rgb == pictures[1].rgb).all())
        self.assertFalse((pictures[0].rgb == pictures[2].rgb).all())  # twin: without normals and uv

    def test_a_model_stands_where_fit_puts_it(self):
        # A box of 4 x 2 x 1 far away; the vertex that no face has does not count.
        with open(os.path.join(self.folder.name, "far.obj"), "w") as f:
            f.write("v 100 7 3\nv 100 9 3\nv 104 7 4\nv 9999 0 0\nf 1 2 3\nusemtl other\nf 3 2 1\n")
        begin = SCENE[:SCENE.index("Material")] + 'Translate 0 0 5 Shape "objmesh" "string filename" "far.obj" '
        corners = {'"float fit" 2': [(-1, -0.5, 5), (-1, 0.5, 5), (1, -0.5, 5.5)],
                   '"float fit" 8 "string up" "y" "bool materials" true': [(-4, 1, 5), (-4, 1, 9), (4, -1, 5)],
                   '"float fit" 2 "bool smooth" true ' + begin[begin.index("Translate"):]: [
                       (-1, -0.5, 5), (-1, 0.5, 5), (1, -0.5, 5.5), (100, 7, 13), (100, 9, 13), (104, 7, 14)]}
        for words, expected in corners.items():
            with open(self.scene, "w") as f:
                f.write(begin + words)
            mesh = bis.Scene(self.scene, approximate=True).mesh()
            np.testing.assert_allclose(np.unique(mesh.vertices, axis=0), np.unique(expected, axis=0), atol=1e-5,
                                       err_msg=words)
        with self.assertRaisesRegex(bis.Error, 'unknown parameter "up"'):
            bis.Scene(begin + '"string up" "y"')

    def test_approximate_replaces_and_warns(self):
        glass = SCENE[:SCENE.index("Material")] + 'Material "dielectric" Shape "sphere"'
        with self.assertRaises(bis.Error):
            bis.render(glass)
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            bis.render(glass, approximate=True)
        self.assertIn("dielectric", str(said[0].message))

    def test_progress_is_told_and_may_end_the_render(self):
        seen = []
        bis.render(SCENE, seconds=0.8, progress=seen.append)
        self.assertTrue(seen)
        self.assertTrue(all(a.share <= b.share <= 1 for a, b in zip(seen, seen[1:])))

        def stop(p):
            raise KeyError(p.share)

        with self.assertRaises(KeyError):
            bis.render(SCENE, seconds=60, progress=stop)


def table(**changes):
    t = bis.AliasTable([1, 1])
    for name, value in changes.items():
        setattr(t, name, np.array(value))
    return t


class Objects(unittest.TestCase):
    """What Python can do with any object, and what must not be done with one that the library holds."""

    def test_a_handle_is_neither_copied_nor_pickled(self):
        """Two objects with one handle would free it twice, and a pickled address would be read in another process."""
        for made in (bis.Envmap(MAP), bis.Material(0.5, 0.5, exponent=5)):
            expected = made.sample(5, seed=1)[0]
            for do in (copy.copy, copy.deepcopy, *(lambda x, p=p: pickle.dumps(x, p) for p in range(6))):
                with self.assertRaises(TypeError) as e:
                    do(made)
                self.assertIn("bis.%s cannot be copied or pickled" % type(made).__name__, str(e.exception))
            gc.collect()
            self.assertTrue((made.sample(5, seed=1)[0] == expected).all())

    def test_a_table_is_copied_and_pickled_because_it_is_arrays(self):
        first = bis.AliasTable([1, 2, 3])
        for second in (copy.copy(first), copy.deepcopy(first), pickle.loads(pickle.dumps(first))):
            self.assertTrue((second.sample(50, seed=1) == first.sample(50, seed=1)).all())
            self.assertEqual(second.total, 6)

    def test_an_object_that_was_never_made_says_so(self):
        for kind, uses in (
            (bis.AliasTable, (lambda t: t.sample(1), lambda t: t.prob, lambda t: t.total)),
            (bis.Envmap, (lambda t: t.sample(1), lambda t: t.shape, lambda t: t.pixels, lambda t: t.power,
                          lambda t: bis.render(SCENE, spp=1, light=t))),
            (bis.Material, (lambda t: t.sample(1), lambda t: t.look([[0, 0, 1]]))),
        ):
            for use in uses:
                with self.assertRaises(TypeError) as e:
                    use(kind.__new__(kind))
                self.assertIn("this %s was never made" % kind.__name__, str(e.exception))
        with self.assertRaises(AttributeError):  # twin: a name that no object has
            bis.AliasTable([1]).probability

    def test_a_truth_value_is_no_number(self):
        em = bis.Envmap(MAP)
        for what, text in (
            (lambda: em.sample(True), "n is True: give an integer"),
            (lambda: em.sample(np.bool_(True)), "give an integer"),
            (lambda: em.sample(1, seed=False), "seed is False: give an integer"),
            (lambda: em.sample(u=[[False, False, False, False]]), "u holds values of the type bool"),
            (lambda: em.look([[True, False, False]]), "w holds values of the type bool"),
            (lambda: bis.AliasTable([True, True]), "weights holds values of the type bool"),
            (lambda: bis.AliasTable(["1"]), "weights holds values of the type <U1"),
            (lambda: bis.Envmap(MAP, area_exponent=True), "area_exponent is True: give a number"),
            (lambda: bis.Material(True, 0, exponent=1), "Kd is True: give a number or three"),
            (lambda: bis.Material(0.5, 0, exponent=True), "exponent is True: give a number"),
            (lambda: bis.Material(0.5, 0, roughness="1"), "roughness is '1': give a number"),
        ):
            with self.subTest(text), self.assertRaises(TypeError) as e:
                what()
            self.assertIn(text, str(e.exception))
        self.assertEqual(len(em.sample(np.int64(1))[0]), 1)  # twin

    def test_an_error_names_its_status(self):
        for path, status in (("nothing.hdr", bis.Status.IO), (__file__, bis.Status.INPUT)):
            with self.assertRaises(bis.Error) as e:
                bis.Envmap(path)
            self.assertIs(e.exception.status, status)


class Mistakes(unittest.TestCase):
    def assert_refused(self, cases):
        for what, text in cases:
            with self.subTest(text), warnings.catch_warnings(), self.assertRaises(bis.Error) as e:
                warnings.simplefilter("ignore")
                what()
            self.assertIn(text, str(e.exception))

    def test_an_exposure_takes_the_mean_of_what_is_covered_to_middle_grey(self):
        pixels = np.full((3, 4, 3), 0.18)
        pixels[0] = 7
        for scale in (1, 4):
            self.assertAlmostEqual(bis.exposure_of(scale * pixels, [[0] * 4, [1] * 4, [1] * 4]), -np.log2(scale),
                                   places=5)
        self.assert_refused([(lambda: bis.exposure_of(pixels, np.ones(3)), "has the shape (3,): give (3, 4)")])

    def test_each_of_a_map_material_or_mesh_has_its_message(self):
        em, nan = bis.Envmap(MAP), float("nan")
        self.assert_refused([
            (lambda: bis.Envmap("nothing.hdr"), 'cannot open "nothing.hdr"'),
            (lambda: bis.Envmap(MAP, table="walker"), 'no table "walker"'),
            (lambda: bis.Envmap(MAP, area_exponent=nan), "area_exponent is nan"),
            (lambda: bis.Material(0.5, 0.5, exponent=1e39), "the exponent is 1e+39: give a number in"),
            (lambda: bis.Material(0.5, np.ma.array([1, 2, 3], mask=[0, 1, 0]), 5), "Ks has masked values"),
            (lambda: bis.Envmap(np.ma.masked_less(np.zeros((2, 4, 3)), 1)), "has masked values"),
            (lambda: bis.Mesh([np.ma.masked_less(np.zeros(3), 1)] * 3, [[0, 1, 2]]), "vertices has masked values"),
            (lambda: em.sample(u=[[0, 0, 0, 1]]), "u of sample 0 is 1"),
            (lambda: em.sample(u=[[0, 0, 0]]), "give (n, 4)"),
            (lambda: em.sample(-1), "n is -1: give a count in [0, 1099511627775]"),
            (lambda: em.sample(2**40), "n is 1099511627776: give a count in [0, 1099511627775]"),
            (lambda: em.sample(2.7), "n is 2.7"),
            (lambda: em.sample(), "give n (how many) or u"),
            (lambda: em.sample(1, u=[[0, 0, 0, 0]]), "one of both"),
            (lambda: em.sample(1, seed=0.5), "seed is 0.5"),
            (lambda: em.sample(1, seed=None), "seed is None"),
            (lambda: em.sample(1, seed=2**53), "seed is 9007199254740992"),
            (lambda: bis.Envmap(MAP + "\0.txt"), "map holds a NUL"),
            (lambda: bis.Envmap(MAP, table="cdf\0x"), "table holds a NUL"),
            (lambda: bis.Envmap(None), "map is None"),
            (lambda: table(prob=[1, nan]).sample(1), "prob of bin 1 is nan"),
            (lambda: table(alias=[0, 2]).sample(1), "alias of bin 1 is 2"),
            (lambda: table(alias=[0, -1]).sample(1), "no item"),
            (lambda: table(alias=[0, 1 << 32]).sample(1), "no item"),
            (lambda: table(alias=[0, 0.5]).sample(1), "no item"),
            (lambda: em.look([[0, 0, 0]]), "direction 0 is (0, 0, 0)"),
            (lambda: em.look([[0, 0, 1], [0, nan, 0]]), "direction 1 is (0, nan, 0)"),
            (lambda: bis.AliasTable([1, -1]), "weight 1 is -1"),
            (lambda: bis.AliasTable([0, 0]), "all weights are 0"),
            (lambda: bis.AliasTable([]), "0 weights"),
            (lambda: bis.Material(2, 0, exponent=1), "Kd is (2, 2, 2)"),
            (lambda: bis.Material(0, 0, roughness=0), "the roughness is 0"),
            (lambda: bis.Material(0, 0, exponent=1).sample(1), "black"),
            (lambda: bis.Material(0, 0), "one of both"),
            (lambda: bis.Envmap(MAP, mapping="cube"), 'no mapping "cube"'),
            (lambda: bis.Material(eta=0, k=1, roughness=1), "eta and k of channel 0 are 0 and 1"),
            (lambda: bis.Material(eta=1, k=nan, roughness=1), "eta and k of channel 0 are 1 and nan"),
            (lambda: bis.Material(eta=1, roughness=1), "of a metal eta and k"),
            (lambda: bis.Material(0, 0, eta=1, k=1, roughness=1), "of a metal eta and k"),
            (lambda: bis.Material(eta=1, k=1, exponent=1), "one of both"),
            (lambda: bis.Material(0.5, roughness=1), "give Kd and Ks"),
            (lambda: bis.Mesh([[0, 0, 0]], [[0, 0, 1]]), "of vertices 0 to 0"),
            (lambda: bis.Mesh([[0, 0, 0]], [[0, 0, -1]]), "of vertices 0 to 0"),
            (lambda: bis.Mesh([[0, 0, 0]], np.empty((0, 3), int)), "faces has 0 rows"),
            (lambda: bis.Mesh([[0, 0, 0]], [[0, 0, 0.5]]), "faces holds values of the type float64"),
            (lambda: bis.Mesh([[0, 0, nan]], [[0, 0, 0]]), "vertices holds a value that is not finite"),
            (lambda: bis.Mesh([[0, 0, 0]], [[0, 0, 0]], uv=[[0, 0], [1, 1]]), "uv has 2 rows, and vertices has 1"),
        ])

    def test_each_of_a_render_has_its_message(self):
        nan = float("nan")
        with tempfile.TemporaryDirectory() as folder:
            scene = os.path.join(folder, "scene.txt")
            with open(scene, "w") as f:
                f.write(SCENE)
            self.assert_refused([
                (lambda: bis.render(None), "scene is None"),
                (lambda: bis.render(scene + "\0"), "scene holds a NUL"),
                (lambda: bis.render(scene, integrator="em\0x"), "a setting holds a NUL"),
                (lambda: bis.render(scene, error=0), 'error is "0"'),
                (lambda: bis.render(scene, seconds=0), 'seconds is "0"'),
                (lambda: bis.render(scene + "x"), "cannot open"),
                (lambda: bis.render(scene, integrator="si"), 'no integrator "si"'),
                (lambda: bis.render(scene, samples=3), 'integrator "sir" has no parameter "samples"'),
                (lambda: bis.render(scene, spp=0), 'spp is "0"'),
                (lambda: bis.render(scene, seed=-1), 'seed is "-1"'),
                (lambda: bis.render(scene, seed=2**53), "seed is"),
                (lambda: bis.render(scene, seed=2**53 + 1), "seed is"),
                (lambda: bis.render(scene, integrator="mis", samples=1), "needs at least 2"),
                (lambda: bis.render(scene, layers="deth"), 'did you mean "depth"'),
                (lambda: bis.render(scene, layers=["albedo", "x"]), 'no layer "x"'),
                (lambda: bis.render(scene, crop=(0, 1)), 'crop is "0.0,1.0"'),
                (lambda: bis.render(scene, crop=(0, 1, nan, 1)), "crop is"),
                (lambda: bis.render(scene, crop="0,1,0,1"), "crop is '0': give a number"),
                (lambda: bis.render(scene, camera=(1, 2)), "camera is (1, 2): give a bis.Camera"),
                (lambda: bis.render(scene, camera=bis.Camera((0, 0, 0), (0, 0, 0))), "camera:1:1"),
                (lambda: bis.render(scene, approximate=1), 'approximate is "1"'),
                (lambda: bis.render(scene, light=np.ones((2, 2))), "give (h, w, 3)"),
                (lambda: bis.render(scene, light=5), "light is 5: give an Envmap, a path, or an array"),
                (lambda: bis.render(SCENE + "\0"), "scene holds a NUL"),
            ])


    def test_a_member_of_a_camera_that_is_no_place_is_told_by_its_name(self):
        right = dict(eye=(1, -5, 2), to=(3, 4, 6), up=(0.5, 7, 8), fov=9)
        self.assertEqual(str(bis.Camera(**right)),
                         'LookAt 1.0 -5.0 2.0 3.0 4.0 6.0 0.5 7.0 8.0\nCamera "perspective" "float fov" 9.0')
        self.assertEqual(str(bis.Camera(*map(np.array, right.values()))), str(bis.Camera(**right)))  # twin
        for name in ("eye", "to", "up"):
            for value, text, is_type in ((3, "3: give three numbers", True), (None, "None: give three numbers", True),
                                         ((1, "2", 3), "'2': give a number", True),
                                         ((1, 2), "(1, 2): give three numbers", False),
                                         ((1, 2, 3, 4), "(1, 2, 3, 4): give three numbers", False)):
                with self.subTest(name=name, value=value), self.assertRaises(bis.Error) as e:
                    bis.render(SCENE, camera=bis.Camera(**{**right, name: value}))
                self.assertEqual(str(e.exception), "camera.%s is %s" % (name, text))
                self.assertIs(isinstance(e.exception, TypeError), is_type)
        with self.assertRaises(bis.WrongType) as e:
            bis.render(SCENE, camera=bis.Camera(**{**right, "fov": (40,)}))
        self.assertEqual(str(e.exception), "camera.fov is (40,): give a number")

    def test_a_wrong_type_is_a_type_error_and_a_wrong_value_is_none(self):
        for values, text in (
            (dict(spp=None), "spp is None: give a number, a text, True or False"),
            (dict(integrator=3), "integrator is 3: give a text"),
            (dict(accelerator=True), "accelerator is True: give a text"),
            (dict(layers=3), "layers is 3: give a list of names"),
            (dict(layers=[3]), "layers is [3]: give a list of names"),
            (dict(progress=3), "progress is 3: give a function"),
            (dict(crop=3), "crop is 3: give four numbers"),
            (dict(crop=(0, "1", 0, 1)), "crop is '1': give a number"),
        ):
            with self.subTest(text), self.assertRaises(bis.WrongType) as e:
                bis.render(SCENE, **values)
            self.assertIn(text, str(e.exception))
        for values in (dict(spp=0), dict(seed=-1), dict(error=0), dict(error=11.5), dict(spp="x"), dict(seed=1.5),
                       dict(spp=True), dict(stratify=1), dict(layers="x"), dict(crop=(0, 0, 0, 0))):  # twins
            with self.subTest(values), self.assertRaises(bis.Error) as e:
                bis.render(SCENE, **values)
            self.assertNotIsInstance(e.exception, TypeError)
        self.assertEqual(bis.render(SCENE, spp=np.int64(1), seed=2.0, error=np.float32(5), stratify=np.bool_(True),
                                    layers=("albedo",), crop=(0, 1, 0, 1)).rgb.shape, (16, 24, 3))


def run_notebook(path):
    """The variables that the cells leave. Where matplotlib is missing, they draw into nothing."""
    with open(path) as f:
        cells = json.load(f)["cells"]
    drawing = {}
    if importlib.util.find_spec("matplotlib") is None:
        drawing = {name: mock.MagicMock() for name in ("matplotlib", "matplotlib.pyplot")}
    space, old = {}, (os.getcwd(), list(sys.path), os.environ.get("MPLBACKEND"))
    os.environ["MPLBACKEND"] = "Agg"
    os.chdir(os.path.dirname(path))
    try:
        with mock.patch.dict(sys.modules, drawing), warnings.catch_warnings(), redirect_stdout(io.StringIO()):
            warnings.simplefilter("ignore")
            for i, cell in enumerate(cells):
                if cell["cell_type"] == "code":
                    exec(compile("".join(cell["source"]), "%s, cell %d" % (path, i), "exec"), space)
    finally:
        os.chdir(old[0])
        sys.path[:] = old[1]
        os.environ.pop("MPLBACKEND") if old[2] is None else os.environ.update(MPLBACKEND=old[2])
    return cells, space


class Page(unittest.TestCase):
    def test_the_example_of_the_page_runs(self):
        with open(os.path.join(ROOT, "docs/library.md")) as f:
            example = f.read().split("```python\n")[1].split("```")[0]
        space, old = {}, os.getcwd()
        os.chdir(ROOT)
        try:
            with redirect_stdout(io.StringIO()):
                exec(compile(example, "docs/library.md", "exec"), space)
        finally:
            os.chdir(old)
        self.assertEqual(space["picture"].layers["albedo"].shape, (30, 80, 3))

    def test_the_floor_of_the_page_catches_shadows(self):
        with open(os.path.join(ROOT, "docs/show.md")) as f:
            example = f.read().split("```python\n")[1].split("```")[0]
        small = example.replace("width=240, height=160", "width=48, height=32")
        small = small.replace("width=120, height=80", "width=6, height=4")
        with tempfile.TemporaryDirectory() as folder:
            space, old = {}, os.getcwd()
            os.chdir(folder)
            os.symlink(os.path.join(ROOT, "data"), "data")
            try:
                exec(compile(small, "docs/show.md", "exec"), space)
                self.assertEqual(len(os.listdir("build/show")), 8 + 2 + 2 * 20)
            finally:
                os.chdir(old)
        # Over the floor's own light, the transparent picture is that of both. Twin: the model without its shadow.
        whole = space["scene"](space["MODEL"] + "true " + space["GREY"] + space["FLOOR"])
        both = whole.render(camera=space["camera"], **space["size"]).rgb.sum(2)
        floor, colours = space["floor"].sum(2), space["colours"].sum(2)
        self.assertLess(np.mean(abs(colours + (1 - space["alpha"]) * floor - both)), 0.02 * both.mean())
        covered = whole.render(camera=space["camera"], layers="albedo", **space["size"]).layers["albedo"][..., 0] != 0.5
        self.assertGreater(np.mean(abs(np.where(covered, colours, floor) - both)), 0.05 * both.mean())


class Notebooks(unittest.TestCase):
    def test_the_figures_run_and_their_claims_hold(self):
        cells, space = run_notebook(os.path.join(ROOT, "docs/figures.ipynb"))
        self.assertEqual([c["outputs"] for c in cells if c["cell_type"] == "code" and c["outputs"]], [])
        # Figure 3.9 of docs/trust.md: about as many of each term; 300 draws with p = 1/2 lie within 5 x 8.7 of 150.
        self.assertLess(abs(int(space["lobe"].sum()) - 150), 44)
        # Each density of figure 4.1 integrates to 1 (the BRDF's lobe is wide: n = 50), within the grid's error.
        for density in space["densities"]:
            self.assertAlmostEqual(float((density * space["solid_angle"]).sum()), 1, delta=0.01)
        self.assertEqual(space["middle"].rgb.shape, (40, 60, 3))
        self.assertTrue(space["heard"])
        self.assertIs(space["refused"].status, bis.Status.INPUT)
        self.assertIn("dielectric", str(space["said"][-1].message))

    def test_each_notebook_asks_and_runs(self):
        """Its last cell asserts what its text claims; its first cell of text says for whom it is."""
        books = sorted(glob.glob(os.path.join(ROOT, "docs/notebooks/*.ipynb")))
        self.assertEqual(len(books), 5)
        for path in books:
            with self.subTest(os.path.basename(path)):
                cells, _ = run_notebook(path)
                text = ["".join(c["source"]) for c in cells if c["cell_type"] == "markdown"]
                code = [c for c in cells if c["cell_type"] == "code"]
                self.assertTrue(8 <= len(cells) <= 15)
                self.assertEqual([c["outputs"] for c in code if c["outputs"]], [])
                self.assertIn("*For students", text[0])
                self.assertGreaterEqual("".join(text).count("**Question "), 5)
                self.assertGreaterEqual("".join(code[-1]["source"]).count("assert "), 4)

    def test_the_page_installs_what_the_notebooks_import(self):
        with open(os.path.join(ROOT, "docs/notebooks/README.md")) as f:
            page = f.read()
        installed = page.split("bin/pip install ")[1].split("\n")[0].split()
        for path in glob.glob(os.path.join(ROOT, "docs/**/*.ipynb"), recursive=True):
            with open(path) as f:
                code = "".join("".join(c["source"]) + "\n" for c in json.load(f)["cells"] if c["cell_type"] == "code")
            for name in re.findall(r"^ *(?:import|from) (\w+)", code, re.MULTILINE):
                self.assertIn(name, installed + ["bis"] + list(sys.stdlib_module_names), path)

    def test_a_notebook_with_a_wrong_formula_is_found(self):
        """The twins: in each, one formula is wrong by a factor or a sign."""
        for name, right, wrong in (
            ("uniform", "return to_xyz(1 - 2 * u[:, 0]", "return to_xyz(1 - 2 * u[:, 0] ** 1.1"),
            ("cdf-alias", "< prob[bin], bin, alias[bin]", "< prob[bin], alias[bin], bin"),
            ("mis", "return h1 * F1 / m1 + h2", "return 1.1 * h1 * F1 / m1 + h2"),
            ("sir", "return W / M * is_seen", "return W / (M + 1) * is_seen"),
            ("visibility", "* (seen - g[k])", "* (seen - 0.9 * g[k])"),
        ):
            with open(os.path.join(ROOT, "docs/notebooks", name + ".ipynb")) as f:
                book = f.read()
            self.assertEqual(book.count(right), 1, name)
            with tempfile.TemporaryDirectory(dir=os.path.join(ROOT, "build")) as folder:
                path = os.path.join(folder, name + ".ipynb")
                with open(path, "w") as f:
                    f.write(book.replace(right, wrong))
                with self.subTest(name), self.assertRaises(AssertionError):
                    run_notebook(path)


if __name__ == "__main__":
    unittest.main()
