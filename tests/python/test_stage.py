# SPDX-License-Identifier: BSD-2-Clause
"""What bis.Stage promises: its figures against sums over the pixels of a small map with Phong's formula in numpy,
closed forms, and pictures; what it hears of an integrator against that integrator.

Statistical tests compare within 5 standard errors, or 5 of their own deviation (6e-7 each, some sixty); each kind has a
twin, a wrong value that the same test refuses."""
import math
import os
import signal
import sys
import threading
import time
import unittest
import warnings

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "scripts/python"))
import bis  # noqa: E402
from bis._stage import Stage  # noqa: E402

KD, KS, EXPONENT = np.array([0.3, 0.2, 0.4]), np.array([0.5, 0.6, 0.4]), 20
HEAD = """Film "rgb" "integer xresolution" 8 "integer yresolution" 6
Sampler "%s" "integer pixelsamples" 4
Integrator "sir" "integer candidates" 100 "integer shadowrays" 7
Option "bool disablepixeljitter" true
LookAt 3 -5 7  0 0 0  0 0 1
Camera "perspective" "float fov" 30
WorldBegin
LightSource "infinite" "rgb L" [1 0.5 0.25]
"""
GLOSSY = 'Material "phong" "rgb Kd" [.3 .2 .4] "rgb Ks" [.5 .6 .4] "float exponent" 20\n'
DIFFUSE = 'Material "phong" "rgb Kd" [.5 .5 .5] "rgb Ks" [0 0 0]\n'
GROUND = 'Shape "disk" "float radius" 90\n'
# As good as the half space y > 3.
WALL = ('Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-1e5 3 -1e5  1e5 3 -1e5  1e5 3 1e5  '
        '-1e5 3 1e5]\n')
ESTIMATORS = ("em", "brdf", "mis", "rejection ratio", "rejection plain", "sir", "unoccluded")


def world(parts, sampler="stratified", light=None, **settings):
    """A scene of these shapes, seen from above at a slant."""
    return bis.Scene(HEAD % sampler + parts, light=light, **settings)


def stage_of(parts, sampler="stratified", light=None, at=(4, 3), **settings):
    stage = world(parts, sampler, light, **settings).stage()
    assert stage.at(*at)
    return stage


def spotty(seed=3):
    """A map of coloured blocks with black ones, bright pixels and a sun."""
    rng = np.random.default_rng(seed)
    blocks = rng.random((8, 16, 3)) ** 6 * (rng.random((8, 16, 1)) > 0.2)
    pixels = np.repeat(np.repeat(blocks, 4, 0), 4, 1)
    pixels[rng.integers(0, 32, 9), rng.integers(0, 64, 9)] = 20
    pixels[9, 50] = 300
    return pixels.astype(np.float32)


def smooth():
    """A map of a coloured gradient."""
    y, x = np.mgrid[0:32, 0:64]
    return np.stack([1 + np.sin(x / 64 * 2 * np.pi), 1 + y / 32, 0.5 + 0 * x], 2).astype(np.float32)


def directions(pixels, fine=8):
    """The middles of fine x fine cells of each pixel, their solid angles, and the radiance from there."""
    rows, columns = (n * fine for n in pixels.shape[:2])
    edges = np.cos(np.pi * np.arange(rows + 1) / rows)
    theta = np.pi * (np.arange(rows) + 0.5) / rows
    phi = 2 * np.pi * (np.arange(columns) + 0.5) / columns
    theta, phi = np.meshgrid(theta, phi, indexing="ij")
    wi = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], 2).reshape(-1, 3)
    solid = np.repeat((edges[:-1] - edges[1:]) * 2 * np.pi / columns, columns)
    return wi, solid, np.repeat(np.repeat(pixels, fine, 0), fine, 1).reshape(-1, 3).astype(float)


def phong(wi, n, wo, kd=KD, ks=KS):
    """f cos by colour, and the density of drawing wi."""
    n, wo = np.array(n), np.array(wo)
    cosine, both = wi @ n, wi @ wo
    along = np.maximum(2 * cosine * (n @ wo) - both, 0)
    lobe = (EXPONENT + 1) / (2 * np.pi) * along ** EXPONENT
    f = kd / np.pi + ks * lobe[:, None]
    q = (ks.sum() * lobe + kd.sum() * np.maximum(cosine, 0) / np.pi) / (ks.sum() + kd.sum())
    return f * np.maximum(cosine, 0)[:, None], q


def brute_force(stage, pixels, seen):
    """Reflected radiance by colour."""
    hit = stage.about()["hit"]
    wi, solid, L = directions(pixels)
    f_cos, _ = phong(wi, hit["normal"], hit["wo"])
    return (f_cos * L * (solid * seen(wi))[:, None]).sum(0)


def everywhere(wi):
    return np.ones(len(wi))


def half(wi):
    return wi[:, 1] <= 0


class Exact(unittest.TestCase):
    def agrees(self, value, expected):
        """Within 5 standard errors and 2e-4 for the midpoints, in each colour and in their sum."""
        is_ = np.append(value.rgb, value.sum)
        se = np.append(value.standard_error, value.sum_standard_error)
        expected = np.append(expected, expected.sum())
        return bool((abs(is_ - expected) < 5 * se + 2e-4 * expected).all())

    def test_it_is_what_brute_force_gives(self):
        for pixels in (spotty(), smooth(), np.tile(np.float32([1, 0.5, 0.25]), (32, 64, 1))):
            stage = stage_of(GLOSSY + GROUND + WALL, light=pixels)
            e = stage.exact()
            seen, all_ = brute_force(stage, pixels, half), brute_force(stage, pixels, everywhere)
            self.assertTrue(e.by_patches and e.patches == pixels.shape[0] * pixels.shape[1])
            self.assertTrue(self.agrees(e.lit, seen), (e.lit, seen))
            self.assertTrue(self.agrees(e.unoccluded, all_), (e.unoccluded, all_))
            self.assertFalse(self.agrees(e.lit, all_))  # twin: shadows forgotten
            self.assertLess(e.lit.sum_standard_error, 0.01 * e.lit.sum)

    def test_a_constant_light_has_closed_forms(self):
        e = stage_of(DIFFUSE + GROUND).exact()
        self.assertTrue(self.agrees(e.lit, np.array([0.5, 0.25, 0.125])))

    def test_a_sum_has_its_cells(self):
        # One lit patch has all of the bound: cut in four eight times it has 2^16 cells, with two rays each.
        pixels = np.zeros((8, 16, 3), np.float32)
        pixels[1, 4] = 1
        e = stage_of(DIFFUSE + GROUND, light=pixels).exact()
        self.assertEqual((e.patches, e.rays), (128, 2 << 16))

    def test_a_long_mis_stands_in_for_huge_maps(self):
        # Le = 1 + cos theta over a diffuse ground: Kd (1 + 2/3).
        row = 1 + np.cos(np.pi * (np.arange(1100) + 0.5) / 1100)
        pixels = np.broadcast_to(row[:, None, None], (1100, 2200, 3)).astype(np.float32)
        e = stage_of(DIFFUSE + GROUND, light=pixels).exact()
        self.assertFalse(e.by_patches)
        self.assertTrue(self.agrees(e.lit, np.full(3, 0.5 * 5 / 3)))
        self.assertLess(e.lit.sum_standard_error, 1e-3 * e.lit.sum)

    def test_what_the_surface_itself_hides_is_in_unoccluded_alone(self):
        tilted = ('Shape "trianglemesh" "integer indices" [0 1 2] "point3 P" [-90 -90 0  90 -90 0  0 90 0] '
                  '"normal N" [.8 0 .5  .8 0 .5  .8 0 .5]\n')
        pixels = smooth()
        stage = stage_of(GLOSSY + tilted, light=pixels)
        e = stage.exact()
        self.assertTrue(self.agrees(e.unoccluded, brute_force(stage, pixels, everywhere)))
        self.assertTrue(self.agrees(e.lit, brute_force(stage, pixels, lambda wi: wi[:, 2] > 0)))
        self.assertLess(e.lit.sum, 0.97 * e.unoccluded.sum)

    def test_moments_are_those_of_one_direction(self):
        pixels = smooth()
        stage = stage_of(GLOSSY + GROUND + WALL, light=pixels, area_exponent=0.0)
        e, hit = stage.exact(), stage.about()["hit"]
        wi, solid, L = directions(pixels)
        f_cos, q_f = phong(wi, hit["normal"], hit["wo"])
        F = (f_cos * L).sum(1) * half(wi)
        q_L = L.sum(1) / (L.sum(1) @ solid)
        for k, q in enumerate((q_L, q_f, (q_L + q_f) / 2)):
            x = np.divide(F, q, out=np.zeros_like(F), where=F > 0)
            mean = F @ solid
            square, cube = (F * x) @ solid, (F * x * x) @ solid
            self.assertAlmostEqual(e.variance[k] / (square - mean**2), 1, delta=0.02)
            self.assertAlmostEqual(e.third[k] / (cube - 3 * mean * square + 2 * mean**3), 1, delta=0.05)


class Methods(unittest.TestCase):
    def test_each_agrees_with_what_is_exact_and_a_wrong_one_does_not(self):
        stage = stage_of(GLOSSY + GROUND + WALL, light=smooth())
        methods = stage.about()["methods"]
        self.assertEqual(tuple(m["method"] for m in methods)[:7], ESTIMATORS)
        for m in methods:
            settings = dict(m["settings"])
            if m["method"] == "rejection ratio":
                settings["candidates"] = 10000  # its bias is O(1/M)
            r = stage.runs(1000, 70, **settings)
            self.assertLess(abs(r.z), 5, m["method"])
            self.assertTrue(0 < r.relative_error < 3)
            self.assertEqual(r.rays > 0, not m["without_shadows"])
            self.assertEqual(r.accepted > 0, settings["integrator"] == "rejection")
        self.assertLess(abs(stage.runs(300, 69, integrator="sir", proposal="product").z), 5)
        wrong = stage.runs(1000, 70, integrator="sir", proposal="em", as_printed="E23")
        self.assertGreater(abs(wrong.z), 10)

    def test_figures_are_those_of_the_estimates(self):
        for sampler in ("sobol", "random"):
            stage = stage_of(GLOSSY + GROUND + WALL, sampler, light=spotty())
            e = stage.exact(5)
            for m in stage.about()["methods"]:
                r, n = stage.runs(50, 9, **m["settings"]), 50
                x = r.estimates.astype(float)
                x = np.column_stack([x, x.sum(1)])
                is_open = m["method"] == "unoccluded"
                truth = e.unoccluded if is_open else e.lit
                se = x.std(0, ddof=1) / math.sqrt(n)
                np.testing.assert_allclose(np.append(r.mean.rgb, r.mean.sum), x.mean(0), rtol=1e-9)
                np.testing.assert_allclose(np.append(r.mean.standard_error, r.mean.sum_standard_error), se, rtol=1e-9)
                difference, se = x.mean(0)[3] - truth.sum, se[3]
                self.assertAlmostEqual(r.z / (difference / math.hypot(se, truth.sum_standard_error)), 1, places=9)
                self.assertAlmostEqual(r.relative_error / (math.hypot(se * math.sqrt(n), difference) / truth.sum), 1,
                                       places=9)
                y = (x[:, 3] - x[:, 3].mean()) / x[:, 3].std(ddof=1)
                self.assertAlmostEqual(r.skewness, (y**3).mean() / math.sqrt(n), places=9)
                k = {"em": 0, "brdf": 1, "mis": 2}.get(m["method"])
                if k is None:
                    self.assertTrue(math.isnan(r.true_skewness))
                else:
                    by_moments = e.third[k] / e.variance[k] ** 1.5 / math.sqrt(n * m["settings"]["samples"])
                    self.assertAlmostEqual(r.true_skewness / by_moments, 1, places=9)

    def test_a_skewness_is_known_even_of_what_was_not_hit(self):
        stage = stage_of(GLOSSY + GROUND + WALL, "random", light=smooth())
        for name in ("em", "brdf"):
            r = stage.runs(20000, 80, integrator=name)
            self.assertAlmostEqual(r.skewness / r.true_skewness, 1, delta=0.15)
        pixels = smooth()
        pixels[4, 12] = 1e4
        r = stage_of(GLOSSY + GROUND, "random", light=pixels).runs(10, 82, integrator="brdf", samples=2)
        self.assertGreater(r.true_skewness, max(0.1, 2 * abs(r.skewness)))

    def test_what_has_no_figure_is_not_a_number(self):
        warnings.simplefilter("ignore")
        stage = stage_of(GLOSSY + GROUND, light=np.zeros((2, 4, 3), np.float32))
        r = stage.runs(4, integrator="em")
        self.assertTrue(math.isnan(r.z) and math.isnan(r.relative_error) and math.isnan(r.true_skewness))
        self.assertEqual((r.skewness, r.mean.sum, r.mean.sum_standard_error), (0, 0, 0))

    def test_they_have_the_scenes_numbers(self):
        def settings(line):
            scene = bis.Scene((HEAD % "random").replace(
                'Integrator "sir" "integer candidates" 100 "integer shadowrays" 7', line) + GLOSSY + GROUND)
            stage = scene.stage()
            stage.at(4, 3)
            return {m["method"]: m["settings"] for m in stage.about()["methods"]}

        usual = {i["name"]: {p["name"]: p for p in i["parameters"]} for i in bis.about()["integrators"]}
        found = settings('Integrator "em" "integer samples" 1 "bool stratify" true')
        self.assertEqual((found["em"]["samples"], found["brdf"]["samples"], found["mis"]["samples"]), (1, 1, 2))
        self.assertTrue(found["em"]["stratify"])
        self.assertEqual(found["sir"]["candidates"], usual["sir"]["candidates"]["default"])
        found = settings('Integrator "mis" "integer samples" 9 "bool compensate" true')
        self.assertFalse(found["mis"]["compensate"])  # it would need a table of its own
        self.assertEqual((found["em"]["samples"], found["mis"]["samples"]), (9, 9))
        found = settings('Integrator "rejection" "integer candidates" 33 "integer shadowrays" 5 '
                         '"string estimator" "plain"')
        self.assertEqual({s["candidates"] for s in found.values() if "candidates" in s}, {33})
        self.assertEqual((found["sir"]["shadowrays"], found["rejection plain"]["shadowrays"]), (5, 5))
        self.assertEqual((found["rejection ratio"]["estimator"], found["rejection plain"]["estimator"]),
                         ("ratio", "plain"))

    def test_a_compensated_scene_draws_by_the_whole_map(self):
        pixels, text = smooth(), (HEAD % "random").replace(
            '"sir" "integer candidates" 100 "integer shadowrays" 7', '"mis" "bool compensate" true')
        stage = bis.Scene(text + GLOSSY + GROUND, light=pixels).stage()
        stage.at(4, 3)
        wi, solid, L = directions(pixels, 1)
        self.assertAlmostEqual((stage.look(wi).q_map * solid).sum(), 1, delta=1e-3)
        self.assertTrue((stage.look(wi).q_map > 0).all())

    def test_the_best_weights_leave_nothing_of_a_mixture(self):
        # F/q_f is constant under a constant light: the best weights have no variance, and beta is -L n1/N.
        stage, L, z = stage_of(DIFFUSE + GROUND), 0.5 * 1.75, (np.arange(10000) + 0.5) / 10000
        for n1 in (4, 12):
            w = stage.best_weights(1 << 14, 1, samples=16, split=n1 / 16)
            q1, q2 = 1 / (4 * np.pi), z / np.pi
            c, F, d = n1 * q1 + (16 - n1) * q2, L * z / np.pi, 2 * np.pi / len(z)
            variance = ((F * F / c).sum() * d - n1 * ((F / c * q1).sum() * d) ** 2
                        - (16 - n1) * ((F / c * q2).sum() * d) ** 2)
            self.assertAlmostEqual(w.beta / (-L * n1 / 16), 1, delta=1e-5)
            self.assertLess(w.best, 1e-4 * w.balance)
            self.assertAlmostEqual(w.balance**2 / variance, 1, delta=0.02)
            self.assertAlmostEqual(w.overlap / ((16 * q1 * q2 / c).sum() * d), 1, delta=0.02)
            self.assertLess(abs(w.mean - L), 5 * math.sqrt(variance / (1 << 14)))

    def test_the_balance_heuristic_scatters_as_runs_of_mis_do(self):
        stage = stage_of(GLOSSY + GROUND + WALL, "random", light=smooth())
        w, r = stage.best_weights(20000, 3, samples=4), stage.runs(20000, 4, integrator="mis", samples=4)
        self.assertAlmostEqual(w.balance / r.estimates.sum(1, dtype=float).std(), 1, delta=0.05)
        self.assertLess(w.best, w.balance)

    def test_the_noises_of_sir_add_up(self):
        n = stage_of(GLOSSY + GROUND + WALL, light=smooth()).noises(2000, 1, candidates=60, shadowrays=3)
        self.assertAlmostEqual(math.hypot(n.of_candidates, n.of_choice) / n.deviation, 1, delta=0.1)
        self.assertTrue(0 < n.rays <= 3)


class Candidates(unittest.TestCase):
    def test_their_figures_are_those_of_the_definitions(self):
        stage = stage_of(GLOSSY + GROUND + WALL, light=spotty())
        hit = stage.about()["hit"]
        for proposal in ("em", "brdf", "mix", "product"):
            c = stage.candidates(11, candidates=200, shadowrays=9, proposal=proposal)
            w, weighs = c.weight, c.weight > 0
            f_cos, q_f = phong(c.wi[weighs].astype(float), hit["normal"], hit["wo"])
            self.assertEqual((len(w), c.shadowrays, c.chosen.sum(), c.positive), (200, 9, 9, weighs.sum()))
            self.assertEqual((c.distinct, c.n_seen), ((c.chosen > 0).sum(), c.chosen[c.seen].sum()))
            self.assertAlmostEqual(c.weights / w.sum(), 1, places=12)
            self.assertAlmostEqual(c.squared_weights / (w * w).sum(), 1, places=12)
            self.assertAlmostEqual(c.effective_sample_size / (w.sum() ** 2 / (w * w).sum()), 1, places=12)
            self.assertAlmostEqual(c.largest_share / (w.max() / w.sum()), 1, places=12)
            self.assertEqual(c.from_map.sum(), c.n_map)
            self.assertAlmostEqual(c.n_map, c.share_of_map * 200, places=6)
            self.assertTrue(proposal != "em" or c.n_map == 200)
            self.assertTrue(proposal != "brdf" or c.n_map == 0)
            np.testing.assert_allclose(c.q_brdf[weighs], q_f, rtol=2e-4)
            np.testing.assert_allclose(w[weighs] * c.q[weighs], c.product[weighs], rtol=1e-12)
            self.assertTrue(np.isnan(c.q[~weighs]).all() and (c.chosen[~weighs] == 0).all())
            chosen = c.chosen > 0
            np.testing.assert_array_equal(c.seen[chosen], half(c.wi[chosen]))
            if proposal != "product":
                mixed = c.share_of_map * c.q_map + (1 - c.share_of_map) * c.q_brdf
                np.testing.assert_allclose(c.q[weighs], mixed[weighs], rtol=1e-4)
            self.assertAlmostEqual(c.estimate_unoccluded.sum() / w.mean(), 1, places=5)

    def test_the_densities_of_the_product_are_right(self):
        # The mean of a function over q is its integral, whatever the clusters are: here f cos, whose integral over the
        # directions with light is the same by q_L and q_f.
        stage, pixels = stage_of(GLOSSY + GROUND, light=smooth()), smooth()
        hit = stage.about()["hit"]
        wi, solid, _ = directions(pixels)
        f_cos, _ = phong(wi, hit["normal"], hit["wo"])
        expected, means = f_cos.sum(1) @ solid, []
        for seed in range(200):
            c = stage.candidates(seed, proposal="product")
            weighs = c.weight > 0
            f, _ = phong(c.wi[weighs].astype(float), hit["normal"], hit["wo"])
            means.append((f.sum(1) / c.q[weighs]).sum() / len(c.weight))
        off = (np.mean(means) - expected) / (np.std(means) / math.sqrt(200))
        self.assertLess(abs(off), 5)
        self.assertLess(np.std(means), 0.2 * expected)

    def test_the_estimate_shown_is_what_renders(self):  # em and mix share their candidates with other pixels there
        for proposal, printed in (("brdf", "none"), ("product", "none"), ("brdf", "E6"), ("product", "E21")):
            scene = world(GLOSSY + GROUND + WALL, light=spotty())
            settings = {"integrator": "sir", "proposal": proposal, "as_printed": printed, "learn": False}
            picture, stage = scene.render(spp=1, seed=4, **settings).rgb, scene.stage()
            hits = others = 0
            for y in range(6):
                for x in range(8):
                    if not stage.at(x, y):
                        continue
                    hits += 1
                    shown = stage.candidates(4, spp=1, **settings).estimate.astype(np.float32)
                    np.testing.assert_array_equal(shown, picture[y, x])
                    other = stage.candidates(5, spp=1, **settings).estimate.astype(np.float32)
                    others += (other == picture[y, x]).all()
            self.assertGreater(hits, 30)
            self.assertLess(others, hits / 4)  # black ones are equal

    def test_an_equation_as_printed_changes_the_estimate(self):
        stage = stage_of(GLOSSY + GROUND + WALL, light=spotty())
        found = {stage.candidates(4, proposal="em", as_printed=e).estimate.sum() for e in ("none", "E6", "E21", "E23")}
        self.assertEqual(len(found), 4)

    def test_effective_sample_size_is_M_for_equal_weights_and_1_for_one(self):
        stage = stage_of(DIFFUSE + GROUND)
        c = stage.candidates(1, proposal="brdf", candidates=800)
        self.assertAlmostEqual(c.effective_sample_size, 800, delta=1e-3)  # f cos/q_f is constant
        self.assertAlmostEqual(c.largest_share, 1 / 800, places=8)
        c = stage.candidates(1, proposal="brdf", candidates=1, shadowrays=1)
        self.assertAlmostEqual(c.effective_sample_size, 1, places=12)
        self.assertEqual((c.positive, c.distinct, c.n_seen), (1, 1, 1))

    def test_those_without_weight_are_told(self):
        pixels = np.zeros((8, 16, 3), np.float32)
        pixels[7] = 1
        c = stage_of(GLOSSY + GROUND, light=pixels).candidates(1)
        self.assertTrue(math.isnan(c.share_of_map))
        self.assertEqual((c.weights, c.effective_sample_size, c.positive, c.distinct), (0, 0, 0, 0))
        self.assertEqual(c.estimate.sum(), 0)

    def test_there_may_be_many(self):
        c = stage_of(GLOSSY + GROUND, light=smooth()).candidates(1, candidates=100000)
        self.assertEqual(len(c.weight), 100000)


class Directions(unittest.TestCase):
    def test_every_ray_of_every_integrator_is_overheard(self):
        scene = world(GLOSSY + GROUND + WALL, light=spotty())
        stage = scene.stage()
        stage.at(4, 3)
        for i in bis.about()["integrators"]:
            rays = stage.rays(1, 21, integrator=i["name"], spp=1)
            picture = scene.render(spp=1, seed=21, integrator=i["name"], crop=(4 / 8, 5 / 8, 3 / 6, 4 / 6))
            self.assertEqual(len(rays.wi), picture.shadow_rays, i["name"])
            self.assertEqual(len(rays.wi) > 0, i["name"] != "unoccluded")
            np.testing.assert_array_equal(rays.seen, half(rays.wi))
            np.testing.assert_array_equal(rays.seen, stage.sees(rays.wi))
            self.assertTrue((stage.look(rays.wi).product > 0).all())
        many = stage.rays(2000, 21, integrator="em", samples=8)  # more than fit at first
        self.assertTrue(len(many.wi) > 4096 and (np.diff(many.sample.astype(int)) >= 0).all())
        self.assertEqual(many.sample.max(), 1999)

    def test_the_rays_of_sir_go_to_the_chosen_candidates(self):
        stage = stage_of(GLOSSY + GROUND + WALL, light=spotty())
        rays, c = stage.rays(1, 31, integrator="sir"), stage.candidates(31)
        np.testing.assert_array_equal(rays.wi, c.wi[c.chosen > 0])
        np.testing.assert_array_equal(rays.seen, c.seen[c.chosen > 0])

    def test_densities_are_those_of_the_map_and_of_phong(self):
        pixels = spotty()
        stage = stage_of(GLOSSY + GROUND + WALL, light=pixels)
        hit, sky = stage.about()["hit"], bis.Envmap(pixels)
        wi, solid, L = directions(pixels, 2)
        f_cos, q_f = phong(wi, hit["normal"], hit["wo"])
        found = stage.look(wi)
        np.testing.assert_allclose(found.q_map, sky.look(wi)[1], rtol=1e-6)
        np.testing.assert_allclose(found.q_brdf, q_f, rtol=1e-4, atol=1e-9)
        np.testing.assert_allclose(found.product, (f_cos * L).sum(1), rtol=1e-4, atol=1e-9)
        np.testing.assert_array_equal(stage.look(3 * wi).product, stage.look(wi * 3).product)

    def test_the_sphere_has_the_mean_of_each_cell(self):
        pixels = spotty()
        stage = stage_of(GLOSSY + GROUND + WALL, light=pixels)
        wi, _, L = directions(pixels[:, :], 2)  # the middles of 2 x 2 parts of a pixel

        def means(x):
            return x.reshape(32, 2, 64, 2).mean((1, 3))

        hit, s = stage.about()["hit"], stage.sphere(64, 32, 2)
        f_cos, _ = phong(wi, hit["normal"], hit["wo"])
        product = (f_cos * L).sum(1)
        for field, expected in ((s.q_map, stage.look(wi).q_map), (s.f_cos, f_cos.sum(1)), (s.product, product),
                                (s.seen, product * half(wi))):
            np.testing.assert_allclose(field, means(expected), rtol=2e-4, atol=1e-7)
        self.assertEqual(stage.sphere(sub=1).seen.shape, (360, 720))  # as its page says

    def test_a_lamp_of_one_pixel_is_in_its_place(self):
        # A map with 3 x 3 pixels in each place, and a lamp in the middle one: of nine directions one meets it.
        pixels = np.ones((108, 216, 3), np.float32)
        pixels[3 * 12 + 1, 3 * 10 + 1] = 1e5
        stage = stage_of(GLOSSY + GROUND, light=pixels)
        q = stage.look(directions(pixels, 1)[0]).q_map.reshape(36, 3, 72, 3).mean((1, 3))
        np.testing.assert_allclose(stage.sphere(72, 36, 3).q_map[12, 10] / q[12, 10], 1, rtol=1e-5)
        self.assertLess(stage.sphere(72, 36, 2).q_map[12, 10], 0.01 * q[12, 10])  # twin

    def test_angles_are_those_of_the_map(self):
        text = (HEAD % "random").replace("LightSource", "AttributeBegin Rotate 90 0 0 1 LightSource")
        scene = bis.Scene(text.rstrip() + " AttributeEnd\n" + GLOSSY + GROUND)
        found = scene.stage().angles([[0.6, 0, 0.8], [-0.6, 0, 0.8], [0, 0, -1], [0, 2, 0]])
        np.testing.assert_allclose(found[:2], [[36.8699, 270], [36.8699, 90]], atol=1e-4)
        np.testing.assert_allclose(found[2:, 0], [180, 90], atol=1e-5)
        self.assertAlmostEqual(found[3, 1] % 360, 0, places=4)

    def test_rejection_takes_what_lies_below_the_weight(self):
        stage = stage_of(GLOSSY + GROUND, light=smooth())
        for proposal, bound in stage.bounds().items():
            c = stage.candidates(1, proposal=proposal, candidates=1000)
            self.assertLessEqual(c.weight.max(), bound * (1 + 1e-5))
            u = np.random.default_rng(1).random(1000)
            a = stage.accept(proposal, c.weight, u)
            np.testing.assert_allclose(a.height, u * bound)
            np.testing.assert_array_equal(a.taken, u * bound < c.weight)


class About(unittest.TestCase):
    def test_a_hit_knows_its_shape_and_triangle(self):
        square = ('Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-9 -9 0  9 -9 0  9 9 0  -9 9 0]\n')
        for parts, shape, line, triangles in ((GLOSSY + GROUND, "disk", 10, {None}),
                                              (GLOSSY + "\n" + square, "trianglemesh", 11, {0, 1})):
            stage, found = world(parts).stage(), set()
            for x in range(8):
                self.assertTrue(stage.at(x, 3))
                hit = stage.about()["hit"]
                found.add(hit["triangle"])
                self.assertEqual((hit["shape"], hit["line"], hit["file"]), (shape, line, None))
                self.assertEqual(hit["normal"], [0, 0, 1])
                to_eye = np.array([3, -5, 7]) - hit["point"]
                np.testing.assert_allclose(hit["distance"], np.linalg.norm(to_eye), rtol=1e-5)
                np.testing.assert_allclose(hit["wo"], to_eye / np.linalg.norm(to_eye), atol=1e-6)
                np.testing.assert_allclose(hit["mirrored"], np.array(hit["wo"]) * [-1, -1, 1], atol=1e-6)
                self.assertAlmostEqual(hit["cos_wo"], hit["wo"][2], places=6)
            self.assertEqual(found, triangles)

    def test_materials_and_texture_coordinates(self):
        about = stage_of(GLOSSY + 'Shape "disk" "float radius" 90\n').about()
        m, p = about["hit"]["material"], about["hit"]["point"]
        np.testing.assert_allclose([m["Kd"], m["Ks"]], [KD, KS], atol=1e-7)
        self.assertAlmostEqual(m["p_specular"], 1.5 / 2.4, places=6)
        self.assertEqual((m["model"], m["exponent"], m["alpha"]), ("phong", 20, None))
        self.assertEqual(about["lobe"], {"name": "exponent", "value": 20})
        phi = math.atan2(p[1], p[0]) % (2 * math.pi)
        np.testing.assert_allclose(about["uv"], [phi / (2 * math.pi), 1 - math.hypot(p[0], p[1]) / 90], atol=1e-5)
        m = stage_of('Material "microfacet" "rgb Ks" [.1 .1 .1] "float roughness" 0.5\n' + GROUND).about()
        self.assertAlmostEqual(m["hit"]["material"]["alpha"], 0.25)
        self.assertIsNone(m["hit"]["material"]["exponent"])

    def test_why_nothing_is_reflected(self):
        black = 'Material "phong" "rgb Kd" [0 0 0] "rgb Ks" [0 0 0]\n'
        below = ('Shape "trianglemesh" "integer indices" [0 1 2] "point3 P" [-90 -90 0  90 -90 0  0 90 0] '
                 '"normal N" [-3 5 1  -3 5 1  -3 5 1]\n')
        dark = np.zeros((2, 4, 3), np.float32)
        warnings.simplefilter("ignore")
        for parts, light, word in ((GLOSSY + 'Translate 0 0 99 Shape "sphere"\n', None, "no surface"),
                                   (GLOSSY + GROUND, dark, "no light"), (black + GROUND, None, "material is black"),
                                   (GLOSSY + below, None, "below the horizon")):
            stage = world(parts, light=light).stage()
            stage.at(4, 3)
            about = stage.about()
            self.assertIn(word, about["nothing"])
            self.assertEqual(about["radiance"], [0, 0, 0] if about["hit"] else [1, 0.5, 0.25])
        stage = world("Translate 0 0 99 " + GROUND).stage()
        self.assertFalse(stage.at(4, 3))
        for ask in (stage.exact, stage.candidates, stage.bounds, lambda: stage.sees([[0, 0, 1]])):
            self.assertRaisesRegex(bis.Error, "sees no surface", ask)


class Points(unittest.TestCase):
    def test_each_kind_fills_the_square_as_it_promises(self):
        def in_boxes(u, a, b):
            return np.bincount((u[:, 0] * a).astype(int) * b + (u[:, 1] * b).astype(int), minlength=a * b)

        for a, b in ((64, 1), (16, 4), (8, 8), (1, 64)):  # a (0,2)-net in base 2; over the samples of a pixel, too
            u = np.vstack([bis.points("sobol", 16, 7, sample=k, dim=3, spp=4) for k in range(4)])
            self.assertTrue((in_boxes(u, a, b) == 1).all())
        self.assertTrue((in_boxes(bis.points("stratified", 64, 7), 8, 8) == 1).all())
        self.assertTrue((in_boxes(bis.points("halton", 6, 7), 2, 3) == 1).all())
        self.assertTrue((in_boxes(bis.points("stratified", 12, 7, dim=None, spp=12), 4, 3) == 1).all())
        for kind in ("random", "stratified", "sobol", "halton"):
            u = bis.points(kind, 20000, 5)
            self.assertLess(abs(u.mean() - 0.5), 5 / math.sqrt(12 * 40000))
            np.testing.assert_array_equal(u, bis.points(kind, 20000, 5))
            for other in ({"seed": 6}, {"dim": 1}, {"pixel": 1}, {"sample": 1}):
                self.assertTrue((u != bis.points(kind, 20000, **{"seed": 5, **other})).any(), other)
        even = bis.points("sobol", 256, 3, dim=None, spp=256)
        np.testing.assert_allclose(even[::2] + even[1::2], 1, atol=1e-9)  # mirror images through the centre
        for word, arguments in (("no sampler", ("lattice", 3)), ("n is", ("sobol", -1)), ("seed is", ("sobol", 1, -1))):
            self.assertRaisesRegex(bis.Error, word, bis.points, *arguments)
        self.assertRaisesRegex(bis.Error, "a sample or more", bis.points, "sobol", 1, spp=0)
        self.assertEqual(bis.points("sobol", 0).shape, (0, 2))


class Materials(unittest.TestCase):
    def test_every_material_of_scenes_can_be_made(self):
        n, wo = np.array([0, 0, 1.0]), np.array([0.6, 0, 0.8])
        wi = np.random.default_rng(1).normal(size=(1000, 3)) * [1, 1, 0] + [0, 0, 0.7]
        wi /= np.linalg.norm(wi, axis=1)[:, None]
        f, pdf = bis.Material.of(GLOSSY, n, wo).look(wi)
        f_cos, q = phong(wi, n, wo)
        np.testing.assert_allclose(f * wi[:, 2:], f_cos, rtol=1e-3)
        np.testing.assert_allclose(pdf, q, rtol=1e-3)
        f, _ = bis.Material.of('Material "diffuse" "rgb reflectance" [.1 .2 .3]', n, wo).look(wi)
        np.testing.assert_allclose(f, np.tile([0.1, 0.2, 0.3], (1000, 1)) / np.pi, rtol=1e-5)
        # In scenes it is pbrt's alpha, the square of ours.
        own = bis.Material(eta=0.2, k=3.9, roughness=0.3, normal=n, wo=wo).look(wi)[0]
        metal = 'Material "metal" "rgb eta" [.2 .2 .2] "rgb k" [3.9 3.9 3.9] "float roughness" .09'
        np.testing.assert_allclose(bis.Material.of(metal + ' "bool remaproughness" false', n, wo).look(wi)[0], own,
                                   rtol=1e-4)
        for model in ("coateddiffuse", "conductor", "metal", "plastic", "substrate", "uber", "matte"):
            self.assertGreater(bis.Material.of('Material "%s"' % model, n, wo).look(wi)[0].sum(), 0)
        for word, text in (("nothing", 'Material "nothing"'), ("texture", 'Texture "t" "spectrum" "checkerboard" '
                                                               'Material "matte" "texture Kd" "t"')):
            self.assertRaisesRegex(bis.Error, word, bis.Material.of, text)


class Use(unittest.TestCase):
    def test_another_light_takes_the_place_of_the_scenes(self):
        scene = world(GLOSSY + GROUND + WALL, light=spotty())
        stage = scene.stage(light=smooth())
        stage.at(4, 3)
        expected = brute_force(stage, smooth(), half).sum()
        self.assertAlmostEqual(stage.exact().lit.sum / expected, 1, delta=1e-3)
        scene.render(spp=1)  # meanwhile the scene keeps its own
        own = scene.stage()
        own.at(4, 3)
        self.assertNotAlmostEqual(own.exact().lit.sum / expected, 1, delta=1e-2)

    def test_settings_of_one_question_do_not_reach_the_next(self):
        stage = stage_of(GLOSSY + GROUND, light=smooth())
        before = stage.candidates(3)
        stage.candidates(3, candidates=10, proposal="em", as_printed="E6")
        np.testing.assert_array_equal(stage.candidates(3).weight, before.weight)

    def test_unoccluded_takes_a_proposal(self):
        stage = stage_of(GLOSSY + GROUND, light=smooth())
        em, mix, usual = (stage.runs(9, 1, integrator="unoccluded", **p).mean.sum
                          for p in ({"proposal": "em"}, {"proposal": "mix"}, {}))
        self.assertEqual(mix, usual)
        self.assertNotEqual(em, mix)
        self.assertRaisesRegex(bis.Error, "takes em, brdf or mix", stage.runs, 9, integrator="unoccluded",
                               proposal="product")

    def test_mistakes_are_told(self):
        stage = world(GLOSSY + GROUND).stage()
        self.assertRaisesRegex(bis.Error, "choose", stage.about)
        self.assertRaisesRegex(bis.Error, "outside 8 x 6", stage.at, 8, 0)
        stage.at(4, 3)
        for word, ask in (("give an integer in", lambda: stage.runs(1)),
                          ("sir", lambda: stage.candidates(integrator="em")),
                          ("no parameter", lambda: stage.rays(integrator="em", candidates=3)),
                          ("seed", lambda: stage.exact(-1)), ("seed", lambda: stage.exact(1 << 64)),
                          ("1048576", lambda: stage.rays(1 << 21)),
                          ("direction 1", lambda: stage.look([[0, 0, 1], [0, 0, 0]])),
                          ("not finite", lambda: stage.angles([[np.nan, 0, 1]])),
                          ("4096", lambda: stage.sphere(5000, 3)),
                          ("proposal", lambda: stage.accept("mix", [1], [0.5])),
                          ("give a bis.Scene", lambda: Stage("scene.txt"))):
            self.assertRaisesRegex(bis.Error, word, ask)

    def test_ctrl_c_ends_the_runs(self):
        self.addCleanup(signal.signal, signal.SIGINT, signal.getsignal(signal.SIGINT))
        signal.signal(signal.SIGINT, signal.default_int_handler)  # whatever a program before has made of it
        stage = stage_of(GLOSSY + GROUND, light=smooth())
        stage.exact()
        timer, before = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)), time.monotonic()
        timer.start()
        self.assertRaises(KeyboardInterrupt, stage.runs, 10**7, integrator="sir")  # minutes
        self.assertLess(time.monotonic() - before, 20)
        self.assertLess(abs(stage.runs(100, integrator="em").z), 5)  # it can be used again

    def test_threads_change_no_number_and_two_scenes_work_at_once(self):
        found = {}

        def work(name):
            stage = stage_of(GLOSSY + GROUND + WALL, light=smooth())
            found[name] = (stage.exact(3).lit.sum, stage.runs(300, 5, integrator="sir").mean.sum)

        threads = [threading.Thread(target=work, args=(k,)) for k in range(2)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        self.assertEqual(found[0], found[1])


if __name__ == "__main__":
    unittest.main()
