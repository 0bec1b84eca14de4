# SPDX-License-Identifier: BSD-2-Clause
"""`bis trade`, what measures: whatever the settings cost, a plan keeps to its time and gives the
better more; each run is the render of its seed; a folder goes through interruption and --resume;
bad input is refused with its cause."""
import csv
import math
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from types import SimpleNamespace
from unittest import mock

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
sys.path.insert(0, os.path.join(ROOT, "scripts/python"))
import bis  # noqa: E402
from bis.tools.scenes import hashed  # noqa: E402
from bis.tools.trade import check, pilot, planfile, references, seconds, shots, stats, sweep  # noqa: E402
from bis.tools.trade.model import LEVELS, MOST_PASSES, Advice, Options, Plan, Reference, Setting, Trade  # noqa: E402
from bis.tools.trade.plan import MAKERS, MOST_PIXELS, Film, Frame, fit_plan  # noqa: E402
from bis.tools.trade.settings import Integrators, Table  # noqa: E402

SCENE = """Film "rgb" "integer xresolution" 24 "integer yresolution" 16
Sampler "stratified"
Integrator "sir" "integer candidates" 20 "integer shadowrays" 2
Camera "perspective" "float fov" 60
WorldBegin
AttributeBegin Rotate -90 1 0 0 LightSource "infinite" "string filename" "map.pfm" AttributeEnd
Material "phong" "rgb Kd" [.5 .4 .3] "rgb Ks" [.2 .2 .2] "float exponent" 20
AttributeBegin Translate 0 0 4 Shape "sphere" AttributeEnd
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-9 -1 -9  9 -1 -9  9 -1 9  -9 -1 9]
"""


# ---- the plan ----

KINDS = (("mis 16", "mis"), ("sir 64/4", "sir"), ("mis 64", "mis"), ("sir 256/16", "sir"), ("em 16", "em"),
         ("em 64", "em"), ("brdf 16", "brdf"), ("rejection a", "rejection"), ("rejection b", "rejection"),
         ("mis p", "mis"))
SWEEP, REFERENCES, TINY = 0.5, 0.22, 1 + 1e-9


def made_up(case):
    """A pilot: frame, settings with the seconds of a pixel, how many seeds, seconds that are
    left."""
    r = random.Random(case)

    def between(lo, hi):
        return lo * (hi / lo) ** r.random()

    left = between(1, 1e5 if case % 50 else 1e12)
    frame = Frame(int(between(60, 4000)), int(between(60, 3000)))
    settings = []
    n_seeds = r.randint(1, 5)
    for i, (name, integrator) in enumerate(KINDS[:r.randint(2, 10)]):
        s = Setting(name, integrator, {}, 1, judge=0 if integrator in ("sir", "rejection") else 1)
        s.is_swept = i < 2 or r.random() < 0.9
        s.is_biased = name == "rejection a"
        s.pass_relmse = math.nan if i > 1 and r.random() < 0.05 else between(1e-3, 1)
        s.pass_seconds = between(1e-7, 1e-4)
        settings.append(s)
    return frame, settings, n_seeds, left


def planned(case, times=1.0, order=1, **asked):
    """A plan of this case, or None where it is refused, and the frame."""
    frame, settings, n_seeds, left = made_up(case)
    plan = Plan(settings=settings[::order], n_seeds=n_seeds)
    try:
        fit_plan(plan, Options("s", "f", left * times, **asked), frame, left * times)
    except bis.Error:
        return None, frame
    return plan, frame


def cost(s):
    return s.pass_seconds * s.pass_relmse


def is_best(plan, s):
    """Of its integrator: what is unbiased before what is not."""
    if not s.is_swept:
        return False
    for o in plan.settings:
        if o is s or not o.is_swept or o.integrator != s.integrator:
            continue
        if (s.is_biased if o.is_biased != s.is_biased else cost(o) < cost(s) or math.isnan(cost(s))):
            return False
    return True


class ThePlan(unittest.TestCase):
    CASES = 400

    def test_keeps_to_its_time_and_spends_it(self):
        n_planned = 0
        for case in range(self.CASES):
            plan, frame = planned(case)
            left = made_up(case)[3]
            if plan is None:
                continue
            n_planned += 1
            pixels, whole = frame.film(plan.step).pixels, frame.film(1).pixels
            sums = sum(plan.n_seeds * s.pass_seconds * (2.0 ** s.levels - 1) for s in plan.settings)
            with self.subTest(case=case):
                self.assertTrue(min(whole, 4800) / 2.5 <= pixels <= 2.26 * MOST_PIXELS)
                for s, o in zip(plan.settings, made_up(case)[1]):
                    self.assertAlmostEqual(s.pass_seconds / (o.pass_seconds * pixels), 1)
                self.assertLessEqual(sums, SWEEP * left * TINY)
                best = sum(plan.n_seeds * s.pass_seconds for s in plan.settings if is_best(plan, s))
                self.assertLessEqual(best, SWEEP * left * TINY)
                if all(s.levels < LEVELS for s in plan.settings):
                    self.assertGreater(sums, SWEEP * left / 16)
                taken = 0
                for k, at in enumerate(plan.reference):
                    if at < 0:
                        continue
                    maker, passes = plan.settings[at], plan.reference_passes[k]
                    self.assertIn(maker.name, MAKERS[k])
                    self.assertFalse(any(s.name in MAKERS[k] and cost(s) < cost(maker) for s in plan.settings))
                    self.assertTrue(passes == MOST_PASSES or
                                    (passes + 1) * 16 * maker.pass_seconds > REFERENCES * left)
                    taken += 8 * passes * maker.pass_seconds if passes > 1 else 0
                self.assertLessEqual(taken, REFERENCES * left * TINY)
        self.assertGreater(n_planned, self.CASES / 2)

    def test_between_its_limits_the_film_leaves_the_middle_setting_eight_passes(self):
        found = []
        for case in range(self.CASES):
            plan, frame = planned(case)
            if plan and frame.step_for(MOST_PIXELS) < plan.step < frame.step_for(4800):
                best = sorted((s.pass_seconds, s.levels) for s in plan.settings if is_best(plan, s))
                found.append(best[(len(best) - 1) // 2][1])
        self.assertGreater(len(found), 20)
        self.assertEqual((min(found), sorted(found)[len(found) // 2]), (3, 4))  # 1, 2, 4, 8: four budgets

    def test_gives_the_better_and_the_cheaper_more(self):
        for case in range(self.CASES):
            plan, _ = planned(case)
            swept = [s for s in plan.settings if s.is_swept] if plan else []
            with self.subTest(case=case):
                for s in swept:
                    self.assertTrue(not is_best(plan, s) or s.levels > 0 or s.pass_seconds > 16 * plan.run_seconds)
                    for o in swept:
                        if o.pass_seconds < s.pass_seconds:
                            continue
                        if is_best(plan, s) >= is_best(plan, o):
                            self.assertGreaterEqual(s.levels, o.levels)
                        if is_best(plan, s) and not is_best(plan, o) and s.levels < LEVELS:
                            self.assertLessEqual(o.levels, s.levels - 2 if s.levels > 3 else 1)
                if plan:
                    self.assertFalse(any(s.levels for s in plan.settings if not s.is_swept))

    def test_does_not_depend_on_the_order_of_the_settings(self):
        for case in range(0, self.CASES, 3):
            plan, _ = planned(case)
            other, _ = planned(case, order=-1)
            self.assertEqual(plan is None, other is None, case)
            if plan:
                self.assertEqual([s.levels for s in plan.settings], [s.levels for s in other.settings[::-1]], case)

    def test_what_fits_into_some_time_fits_into_every_longer_one(self):
        n_refused = 0
        for case in range(0, self.CASES, 4):
            accepted, step = False, 1 << 20
            for times in (0.01, 0.03, 0.1, 0.2, 0.4, 0.7, 1, 1.25, 1.6, 2, 3, 10, 100):
                plan, _ = planned(case, times)
                n_refused += plan is None
                self.assertTrue(plan or not accepted, "case %d: %g times the time are refused" % (case, times))
                if plan:
                    self.assertLessEqual(plan.step, step, case)
                    accepted, step = True, plan.step
        self.assertGreater(n_refused, 50)

    def test_quick_is_never_refused_and_has_something_to_advise(self):
        n_less = n_alone = 0
        for case in range(self.CASES):
            for times in (1e-3, 1):
                plan, frame = planned(case, times, quick=True)
                usual, _ = planned(case, times)
                self.assertIsNotNone(plan, case)
                self.assertIn(plan.n_seeds, (1, made_up(case)[2]))
                n_alone += plan.n_seeds < made_up(case)[2]
                asked, _ = planned(case, times, quick=True, n_seeds=made_up(case)[2])
                self.assertEqual(asked.n_seeds, made_up(case)[2])
                self.assertTrue(any(s.levels and not s.is_biased for s in plan.settings), case)
                self.assertGreaterEqual(frame.film(plan.step).pixels, min(2400, frame.film(1).pixels) / 2.5)
                n_less += usual is None
                if usual:
                    self.assertEqual([s.levels for s in plan.settings], [s.levels for s in usual.settings])
        self.assertGreater(min(n_less, n_alone), 100)

    def test_with_passes_every_setting_gets_as_many_whatever_the_time(self):
        for passes in (1, 2, 3, 4, 100, 1 << 20):
            for case in range(40):
                plan, _ = planned(case, passes=passes)
                levels = {s.levels for s in plan.settings if s.is_swept}
                self.assertEqual(levels, {int(math.log2(passes)) + 1})
                self.assertEqual({p for p in plan.reference_passes if p}, {4 * passes})

    def test_an_error_that_is_out_of_reach_is_refused_with_one_that_is_not(self):
        frame, settings, n_seeds, left = made_up(1)
        for s in settings:
            s.pass_relmse = 1.0
        plan = Plan(settings=settings, n_seeds=n_seeds)
        with self.assertRaises(bis.Error) as e:
            fit_plan(plan, Options("s", "f", left, error=1e-6), frame, left)
        reachable = float(re.search(r"Give --error (\S+) or more", str(e.exception)).group(1))
        frame, settings, n_seeds, left = made_up(1)
        for s in settings:
            s.pass_relmse = 1.0
        fit_plan(Plan(settings=settings, n_seeds=n_seeds), Options("s", "f", left, error=1.1 * reachable), frame, left)


class TheFilm(unittest.TestCase):
    def test_a_thin_film_has_one_pixel_of_each_square_inside_the_crop(self):
        for width, height, step, crop in ((24, 16, 3, (0, 1, 0, 1)), (100, 75, 7, (0.25, 0.8, 0.1, 0.9))):
            film = Frame(width, height, crop).film(step)
            x0, x1 = (math.ceil(width * v) for v in crop[:2])
            inside = [x for x in range(step // 2, width, step) if x0 <= x < x1]
            self.assertEqual(film.width, len(inside))
            self.assertEqual(film.x * step + step // 2, inside[0])

    def test_blocks_lie_evenly_inside_and_have_about_the_pixels(self):
        r = random.Random(4)
        for _ in range(300):
            film = Film(r.randint(0, 50), r.randint(0, 50), r.randint(20, 4000), r.randint(20, 2000))
            wanted = film.pixels * r.random()
            found = seconds.blocks(film, wanted, r.choice((1, 2, 64)))
            for b in found:
                self.assertTrue(film.x <= b.x and b.x + b.width <= film.x + film.width and b.width > 0)
                self.assertTrue(film.y <= b.y and b.y + b.height <= film.y + film.height and b.height > 0)
            if found != [film] and wanted > 64000:
                self.assertLess(sum(b.pixels for b in found), 2 * wanted)
                self.assertGreater(sum(b.pixels for b in found), wanted / 2)
                middle = sum(b.y + b.height / 2 for b in found) / len(found)
                self.assertAlmostEqual((middle - film.y) / film.height, 0.5, delta=0.15)


class TheTable(unittest.TestCase):
    def settings(self, own=("sir", {}), small_map=True, **asked):
        known = Integrators.of(bis.about())
        values = dict(known.defaults(own[0]), **own[1])
        return Table(known, 0.15).settings(Options("s", "f", 1, **asked), small_map, (own[0], values))

    def test_names_are_keys_and_hold_no_comma(self):
        names = [s.name for s in self.settings()]
        self.assertEqual(len(names), len(set(names)))
        self.assertFalse([n for n in names if "," in n])

    def test_the_scenes_own_setting_is_swept_once(self):
        for own, name in ((("sir", {"candidates": 64, "shadowrays": 4}), "sir 64/4"),
                          (("em", {"samples": 5}), "em 5 scene's own")):
            self.assertEqual([s.name for s in self.settings(own, quick=True) if s.is_scenes and s.is_swept], [name])

    def test_a_light_without_a_small_map_has_no_importance_to_vary(self):
        names = [s.name for s in self.settings(small_map=False)]
        self.assertFalse([n for n in names if "b=" in n or "compensated" in n])

    def test_integrators_that_are_not_asked_for_may_only_make_references(self):
        settings = self.settings(integrators=["rejection"])
        self.assertEqual({s.integrator for s in settings if s.is_swept}, {"rejection"})
        self.assertTrue(set(MAKERS[0] + MAKERS[1]) <= {s.name for s in settings})

    def test_the_words_of_a_setting_render_it(self):
        """Options and scene line say what the values are: parsed back by the library they are the
        same."""
        head, tail = SCENE.split("Integrator", 1)[0], SCENE.split("\n", 3)[3]
        with tempfile.TemporaryDirectory() as folder:
            write_scene(folder)
            for s in self.settings():
                line, _, b = s.scene_text.partition("; in LightSource: ")
                scene = bis.Scene((head + line + "\n" + tail).replace("map.pfm", folder + "/map.pfm"))
                self.assertEqual(scene.about()["parameters"], s.values, s.name)
                self.assertEqual(bool(b), s.area_exponent != 0.15)
                if s.option_text:
                    words = s.option_text.split(" ")
                    given = dict(zip(words[2::2], words[3::2]))
                    for name, value in s.values.items():
                        said = given.get("--" + name)
                        self.assertIn(said, (None, str(value), {True: "on", False: "off"}.get(value)), s.name)


class TheScatter(unittest.TestCase):
    def test_is_the_error_of_one_render(self):
        """Renders of known noise against a reference of known noise, and without the worst
        pixels."""
        rng = np.random.default_rng(5)
        right = rng.uniform(1, 2, (60, 80, 3))

        def noisy(share):
            return (right * (1 + share * rng.standard_normal(right.shape))).astype(np.float32)

        expected = 0.1 ** 2 * np.mean(right ** 2 / (right ** 2 + right.mean() ** 2 / 100))
        for n, noise in ((2, 0.0), (8, 0.0), (8, 0.2)):
            found = check.scatter([noisy(0.1) for _ in range(n)], 0, Reference(noisy(noise), relmse=noise ** 2))
            self.assertAlmostEqual(found / expected, 1, delta=0.05)
        renders = [noisy(0.1) for _ in range(8)]
        plain = check.scatter(renders, 1, Reference(right.astype(np.float32)))
        renders[3][7, 9] = 1e3
        self.assertAlmostEqual(check.scatter(renders, 1, Reference(right.astype(np.float32))) / plain, 1, delta=0.01)
        self.assertGreater(check.scatter(renders, 0, Reference(right.astype(np.float32))), 5 * plain)

    def test_a_reference_knows_its_own_noise(self):
        rng = np.random.default_rng(6)
        right = rng.uniform(1, 2, (60, 80, 3))
        renders = [(right + 0.3 * rng.standard_normal(right.shape)).astype(np.float32) for _ in range(8)]
        made = references.combine(renders)
        self.assertAlmostEqual(made.relmse / bis.compare(made.image, right).relmse, 1, delta=0.05)
        self.assertLess(abs(made.mean - right.mean()), 4 * made.se)
        self.assertAlmostEqual(made.se / (np.std([r.mean(dtype=float) for r in renders], ddof=1) / math.sqrt(8)), 1)
        both = references.combine_both(made, Reference(right.astype(np.float32), relmse=made.relmse / 3, mean=1))
        self.assertAlmostEqual(both.relmse / made.relmse, 1 / 4, delta=0.001)
        self.assertTrue(np.allclose(both.image, made.image / 4 + right * 3 / 4, rtol=1e-6))


# ---- the command ----


def write_scene(folder, scene=SCENE):
    pixels = np.float32(0.3 * np.random.default_rng(3).random((8, 16, 3)))
    pixels[2, 3], pixels[5, 11] = 50, (8, 4, 2)
    bis.save_image(os.path.join(folder, "map.pfm"), pixels)
    with open(os.path.join(folder, "scene.txt"), "w") as f:
        f.write(scene)


def table(path):
    with open(path, newline="") as f:
        return list(csv.DictReader(f))


def without_seconds(path):
    return [{k: v for k, v in row.items() if k != "seconds"} for row in table(path)]


class Command(unittest.TestCase):
    SMALL = ("scene.txt --nthreads 1 --time 2 --passes 4 --seeds 2 --integrator mis --integrator sir --output ")

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        write_scene(cls.folder)
        cls.run_it(cls, cls.SMALL + "whole")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def start(self, arguments):
        env = dict(os.environ, PYTHONPATH=os.path.join(ROOT, "scripts/python"))
        return subprocess.Popen([sys.executable, "-m", "bis.tools", "trade"] + arguments.split(), cwd=self.folder,
                                env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)

    def run_it(self, arguments, status=0):
        p = Command.start(self, arguments)
        out, err = p.communicate(timeout=120)
        if p.returncode != status:
            raise AssertionError("%s: exit %d: %s%s" % (arguments, p.returncode, out, err))
        return out, err

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def test_each_run_is_the_render_of_its_seed_bit_for_bit(self):
        rows = table(self.path("whole/runs.csv"))
        self.assertEqual(len({r["seed"] for r in rows}), len(rows))
        names = {"mis": [self.path("whole/references/%s-%d.exr" % (k, i)) for k in ("mis",) for i in range(1, 9)]}
        judge = references.combine([bis.read_image(p)[0] for p in names["mis"]]).image
        settings = {"sir 64/4": {"candidates": 64, "shadowrays": 4}, "sir 20/2 scene's own": {},
                    "sir 256/16 brdf": {"candidates": 256, "shadowrays": 16, "proposal": "brdf"}}
        n = 0
        for row in rows:
            if row["setting"] not in settings:
                continue
            n += 1
            picture = bis.render(self.path("scene.txt"), spp=int(row["passes"]), seed=int(row["seed"]), threads=1,
                                 **settings[row["setting"]])
            c = bis.compare(picture.rgb, judge)
            self.assertEqual([float(row[k]) for k in ("rmse", "relmse", "bias")], [c.rmse, c.relmse, c.bias])
            self.assertEqual(int(row["shadow_rays"]), picture.shadow_rays)
        self.assertEqual(n, 18)

    def test_a_scenes_name_may_be_any_bytes(self):
        name = os.fsdecode(b"caf\xe9.txt")
        shutil.copy(self.path("scene.txt"), self.path(name))
        self.assertEqual(bis.Scene(self.path(name)).about()["files"], [self.path(name)])
        self.run_it("%s --time 0.5 --passes 1 --seeds 1 --integrator em --quick --output bytes" % name)

    def test_a_given_reference_judges_all(self):
        given = bis.render(self.path("scene.txt"), integrator="mis", samples=64, spp=64, seed=7).rgb
        bis.save_image(self.path("given.exr"), given)
        self.run_it(self.SMALL + "given --reference given.exr")
        for row in table(self.path("given/runs.csv")):
            self.assertEqual(row["relmse"], row["relmse_both"])
        whole, rows = table(self.path("whole/runs.csv")), table(self.path("given/runs.csv"))
        self.assertEqual([r["seed"] for r in whole], [r["seed"] for r in rows])

    def test_a_given_crop_must_be_that_of_the_scene(self):
        lower = np.zeros((8, 24, 3), np.float32), bis.Place(0, 8, 24, 16)
        with mock.patch.object(references, "read_image", lambda path: lower):
            for crop in ((0, 1, 0, 0.5), (0, 1, 0.25, 0.75)):
                with self.assertRaisesRegex(bis.Error, r"the crop at \(0, 8\)"):
                    references.read_given("crop.exr", Frame(24, 16, crop))
            self.assertEqual(references.read_given("crop.exr", Frame(24, 16, (0, 1, 0.5, 1))).shape, (8, 24, 3))

    def test_a_seed_is_what_it_was_in_older_folders(self):
        self.assertEqual(hashed(0x9e3779b97f4a7c15), 0xe220a8397b1dcdaf)  # the first number of SplitMix64 of seed 0

    def test_a_run_has_the_pixels_of_the_full_render(self):
        size = "--resolution 240x160"
        full = bis.render(self.path("scene.txt"), integrator="mis", samples=4, spp=4, seed=5, width=240, height=160)
        bis.save_image(self.path("large.exr"), full.rgb)
        self.run_it("scene.txt %s --reference large.exr --time 0.01 --passes 1 --seeds 1 --integrator em --quick "
                    "--output thin" % size)
        with open(self.path("thin/plan.txt")) as f:
            k = int(re.search(r"^step (\d+)$", f.read(), re.M).group(1))
        self.assertGreater(k, 1)
        row = [r for r in table(self.path("thin/runs.csv")) if r["setting"] == "em 16"][0]
        run = bis.render(self.path("scene.txt"), integrator="em", samples=16, spp=1, seed=int(row["seed"]), width=240,
                         height=160)
        thin = slice(k // 2, None, k)
        c = bis.compare(run.rgb[thin, thin], full.rgb[thin, thin])
        self.assertEqual([float(row[x]) for x in ("rmse", "relmse", "bias")], [c.rmse, c.relmse, c.bias])

    def test_ctrl_c_keeps_what_was_measured_and_resume_measures_the_rest(self):
        for name, is_there in (("at-references", "references/mis-2.exr"), ("at-runs", "runs.csv")):
            p = self.start(self.SMALL.replace("--passes 4", "--passes 64").replace(" --integrator mis", "") + name)
            end = time.monotonic() + 60
            while not os.path.exists(self.path(name, is_there)) and time.monotonic() < end:
                time.sleep(0.01)
            p.send_signal(signal.SIGINT)
            out, err = p.communicate(timeout=60)
            self.assertEqual(p.returncode, 130, err)
            self.assertTrue(os.path.exists(self.path(name, "plan.txt")))
            if os.path.exists(self.path(name, "runs.csv")):
                self.assertIn("runs in %s/report.html" % name, out)
        before = without_seconds(self.path("at-runs/runs.csv"))
        self.run_it("scene.txt --nthreads 1 --resume --time 60 --output at-runs")
        after = without_seconds(self.path("at-runs/runs.csv"))
        self.assertTrue(all(row in after for row in before))
        self.assertEqual(len(after), len({(r["setting"], r["passes"], r["replicate"]) for r in after}))

    def test_resume_makes_again_what_was_lost_to_the_same_bits(self):
        shutil.copytree(self.path("whole"), self.path("lost"))
        with open(self.path("lost/runs.csv")) as f:
            lines = f.readlines()
        with open(self.path("lost/runs.csv"), "w") as f:
            f.writelines(lines[:20] + lines[50:])
        os.remove(self.path("lost/references/sir-3.exr"))
        shutil.rmtree(self.path("lost/pictures"))
        self.run_it("scene.txt --nthreads 1 --resume --time 60 --output lost")
        self.assertEqual(without_seconds(self.path("lost/runs.csv")), without_seconds(self.path("whole/runs.csv")))
        for which in ("references/sir-3.exr",):
            a, b = (bis.read_image(self.path(folder, which))[0] for folder in ("lost", "whole"))
            self.assertTrue((a == b).all())

    def test_a_changed_scene_is_another_measurement(self):
        shutil.copytree(self.path("whole"), self.path("other"))
        with open(self.path("changed.txt"), "w") as f:
            f.write(SCENE.replace("exponent\" 20", "exponent\" 21"))
        self.assertIn("is of another scene", self.run_it("changed.txt --resume --output other", 2)[1])

    def test_quick_makes_do_with_the_time_and_says_so(self):
        out, err = self.run_it("scene.txt --quick --time 0.05 --resolution 800x600 --nthreads 1 --output few")
        self.assertIn("--quick makes do with", err)
        self.assertIn("final picture", out)
        self.assertTrue(os.path.exists(self.path("few/report.html")))

    def test_what_cannot_be_done_is_refused(self):
        black = SCENE.replace('"string filename" "map.pfm"', '"rgb L" [0 0 0]')
        bare = re.sub(r'Shape ".*?(?= AttributeEnd|\n)', "", SCENE)
        for name, text in (("black.txt", black), ("bare.txt", bare)):
            with open(self.path(name), "w") as f:
                f.write(text)
        os.makedirs(self.path("full"))
        with open(self.path("full/letter"), "w") as f:
            f.write("dear")
        bis.save_image(self.path("tiny.exr"), np.ones((3, 4, 3)))
        for arguments, status, said in (
                ("scene.txt --time 0.01 --output n1", 2, "0.01 s are too few"),
                ("scene.txt --output whole", 2, '"whole" holds a measurement; --resume goes on with it'),
                ("scene.txt --output full", 2, '"full" holds other things ("letter")'),
                ("scene.txt --output scene.txt", 2, "is no folder"),
                ("scene.txt --output no/such/folder", 1, "cannot make the folder"),
                ("scene.txt --integrator sri --output n2", 2, 'must be em, brdf, mis, rejection or sir (did you mean'),
                ("scene.txt --integrator exact --output n3", 2, "--integrator exact: must be"),
                ("scene.txt --quick --integrator rejection --output n4", 2, "all settings to be measured are biased"),
                ("scene.txt --resume --seeds 2 --output whole", 2, "which --seeds would change; leave it out,"),
                ("scene.txt --resume --seed 3 --quick --output whole", 2, "which --quick and --seed would change"),
                ("scene.txt --reference tiny.exr --output n5", 2, "the reference has 4 x 3 pixels"),
                ("scene.txt --reference none.exr --output n6", 1, 'cannot open "none.exr"'),
                ("none.txt --quiet --output n7", 1, "none.txt"),
                ("black.txt --output n8", 2, "the scene has no light"),
                ("bare.txt --output n9", 2, "the scene has no surface"),
                ("- --output n10", 2, "give a file, not -"),
                ("scene.txt --seeds 17 --output n11", 2, "must be an integer in [1, 16]"),
                ("scene.txt --time 0 --output n12", 2, "--time is"),
                ("scene.txt --sed 3 --output n13", 2, 'unknown option "--sed" (did you mean "--seed"?)')):
            with self.subTest(arguments):
                self.assertIn(said, self.run_it(arguments, status)[1])
        self.assertEqual([n for n in os.listdir(self.folder) if re.fullmatch(r"n\d+", n)], [])

    def test_a_damaged_plan_is_refused_with_its_line(self):
        with open(self.path("whole/plan.txt")) as f:
            good = f.read()
        os.makedirs(self.path("damaged"))
        for old, new, said in (("seeds 2", "seeds 0", "a number from 1 to 16"),
                               ("seeds 2", "seeds 2\nseeds 2", "second line of its kind"),
                               ("seeds 2\n", "", 'a plan has a line "seeds"'),
                               ("seeds 2", "sods 2", "no line of a plan"),
                               ("step 1\n", "step 2\n", 'those of "full" divided by "step"'),
                               ("given 0", "given 2", "0 or 1"),
                               ("sir 64/4", "sir 65/4", "name of a setting"),
                               ("reference 0 ", "reference 1 ", "each once"),
                               ("run_seconds ", "run_seconds -", "a number above 0"),
                               ("fingerprint ", "fingerprint x", "16 digits"),
                               ("full 24 16\nstep 1\nsize 24 16", "full 9000 9000\nstep 1\nsize 9000 9000",
                                "at most 360000")):
            self.assertIn(old, good)
            with open(self.path("damaged/plan.txt"), "w") as f:
                f.write(good.replace(old, new, 1))
            with self.subTest(new):
                self.assertIn(said, self.run_it("scene.txt --resume --output damaged", 2)[1])

    def test_a_plan_whose_crop_keeps_no_pixel_is_refused(self):
        with open(self.path("whole/plan.txt")) as f:
            good = f.read()
        os.makedirs(self.path("thinned"))
        with open(self.path("thinned/plan.txt"), "w") as f:
            f.write(good.replace("step 1\nsize 24 16", "step 3\nsize 8 5"))
        for crop, size in (((0, 0.01, 0, 1), "0 x 5"), ((0, 1, 0, 0.01), "8 x 0")):
            with self.assertRaisesRegex(bis.Error, size + " pixels are to be measured, must be at least 1"):
                planfile.read_plan(self.path("thinned"), self.plan_of(good), "scene.txt", crop)

    def plan_of(self, text):
        """A plan with all settings of the scene, for plan.txt of this text."""
        known = Integrators.of(bis.about())
        settings = Table(known, bis.Scene(self.path("scene.txt")).about()["light"]["area_exponent"]).settings(
            Options("s", "f", 1), True, ("sir", dict(known.defaults("sir"), candidates=20, shadowrays=2)))
        return Plan(settings=settings, fingerprint=int(text.split()[1], 16))

    def test_a_plan_reads_back_as_it_was_written(self):
        with open(self.path("whole/plan.txt")) as f:
            good = f.read()
        plan = self.plan_of(good)
        planfile.read_plan(self.path("whole"), plan, "scene.txt", (0, 1, 0, 1))
        self.assertEqual(planfile.plan_text(plan), good)


class Seconds(unittest.TestCase):
    def test_the_advice_tells_what_a_render_takes(self):
        """In user time of one thread, because the clock of a busy machine is no measure."""
        class Clocked:
            """Renders with the seconds of the processor."""

            def __init__(self, scene, frame):
                self.scene, self.frame = scene, frame

            def render(self, s, step, passes, seed, crop=None):
                start = time.process_time()
                picture = self.scene.render(integrator=s.integrator, spp=passes, seed=seed, crop=crop, threads=1,
                                            **s.values)
                object.__setattr__(picture, "seconds", time.process_time() - start)
                return picture

        with tempfile.TemporaryDirectory() as folder:
            write_scene(folder)
            scene = bis.Scene(os.path.join(folder, "scene.txt"), width=640, height=480, threads=1)
        t = Trade(Options("s", "f", 10), threads=1, view=Clocked(scene, Frame(640, 480)))
        t.plan.settings = [Setting("em 64", "em", {"samples": 64}, 0.15)]
        advice = [Advice("final picture", 0.05, 0, 4, seconds=20.0), Advice("none", 0)]
        t.result = type("Result", (), {"advice": advice})()
        seconds.time_advice(t)
        start = time.process_time()
        scene.render(integrator="em", samples=64, spp=4, seed=9, threads=1)
        self.assertAlmostEqual(t.result.advice[0].seconds / (time.process_time() - start), 1, delta=0.4)


class World:
    """A scene whose methods are formulas. A render of n passes takes fill + c pixels seconds a pass
    on a clock of its own, and its noise has relMSE v n^-p, an edge's 1 <= p <= 3/2."""

    def __init__(self, frame, settings, p=1.0, seed=1):
        self.frame, self.p, self.now, self.settings, self.fill = frame, p, 1000.0, settings, 1e-3
        self.rng = np.random.default_rng(seed)
        self.cost = {name: cost for name, cost, _, _ in settings}
        self.variance = {name: variance for name, _, variance, _ in settings}
        self.log = []

    def clock(self):
        return self.now

    def right(self, film):
        y, x = np.mgrid[:film.height, :film.width]
        return np.repeat(1 + 0.5 * np.sin(0.1 * x + 0.2 * y)[:, :, None], 3, axis=2)

    def render(self, s, step, passes, seed, crop=None):
        if crop is not None:
            across, down = ((math.ceil(n * a), math.ceil(n * b)) for n, (a, b) in
                            ((self.frame.width, crop[:2]), (self.frame.height, crop[2:])))
            film = Film(0, 0, across[1] - across[0], down[1] - down[0])
        else:
            film = self.frame.film(step) if step else Film(0, 0, 1, 1)
        seconds = passes * (self.fill + self.cost[s.name] * film.pixels)
        self.now += seconds
        self.log.append((s.name, passes, film))
        right = self.right(film)
        relmse = self.variance[s.name] * passes ** -self.p
        noise = right * math.sqrt(relmse) * self.rng.standard_normal(right.shape)
        return SimpleNamespace(rgb=(right + noise).astype(np.float32), seconds=seconds, error=math.sqrt(relmse),
                               camera_rays=1, shadow_rays=1, candidates=1)


class InAWorld(unittest.TestCase):
    """The measurement where all is known."""

    METHODS = (("mis 16", 4e-6, 0.4, 1), ("mis 64", 1.5e-5, 0.12, 1), ("sir 64/4", 2e-6, 0.3, 0),
               ("sir 256/16", 6e-6, 0.08, 0), ("em 16", 3e-6, 3.0, 1), ("rejection 100/8", 5e-6, 0.5, 0))

    def measured(self, world, seconds_, **asked):
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        t = Trade(Options("s", folder, seconds_, **asked), view=world, start=world.now, stratified=False)
        t.plan.settings = [Setting(name, name.split()[0], {}, 1, judge=judge, is_biased=name.startswith("rej"))
                           for name, _, _, judge in world.settings]
        t.plan.n_seeds = 3
        t.plan.full_width, t.plan.full_height = world.frame.width, world.frame.height
        with mock.patch("time.monotonic", world.clock):
            self.assertEqual(pilot.run_pilot(t), [])
            fit_plan(t.plan, t.options, world.frame, seconds_ - t.spent(), t.spent())
            references.make_references(t)
            sweep.run_sweep(t)
            stats.summarise(t)
            t.swept = t.spent()
            check.check_advice(t)
            seconds.time_advice(t)
            shots.make_shots(t)
        return t

    def test_the_pilot_finds_costs_and_errors_in_its_time(self):
        world = World(Frame(800, 600), self.METHODS)
        t = Trade(Options("s", "f", 60), view=world, start=world.now)
        t.plan.settings = [Setting(name, name.split()[0], {}, 1) for name, _, _, _ in self.METHODS]
        with mock.patch("time.monotonic", world.clock):
            pilot.run_pilot(t)
            self.assertLess(t.spent(), 3 * 0.08 * 60)
        for s, (name, cost_, variance, _) in zip(t.plan.settings, self.METHODS):
            self.assertAlmostEqual(s.pass_seconds / cost_, 1, delta=0.2)
            self.assertAlmostEqual(s.pass_relmse / variance, 1, delta=0.01)
            self.assertAlmostEqual(s.fill_seconds, 1e-3, delta=1e-4)

    def test_all_keeps_to_the_time_and_spends_it(self):
        for total in (10, 40, 150):
            world = World(Frame(800, 600), self.METHODS)
            t = self.measured(world, total)
            self.assertTrue(t.is_complete)
            self.assertLess(t.swept, 0.8 * total * TINY)
            self.assertLess(world.now - 1000, 1.02 * total)
            self.assertGreater(world.now - 1000, 0.5 * total)
            self.assertEqual(len(t.runs), t.plan.planned_runs())

    def test_a_sweep_that_is_out_of_time_has_measured_all_equally_far(self):
        world = World(Frame(800, 600), self.METHODS)
        usual = world.render

        def slower(s, step, passes, seed, crop=None):
            picture = usual(s, step, passes, seed, crop)
            if len(world.log) > 80:
                world.now += picture.seconds  # the machine got other work
            return picture

        world.render = slower
        t = self.measured(world, 40)
        self.assertFalse(t.is_complete)
        self.assertLess(t.swept, 0.85 * 40)
        done = {(r.setting, r.level, r.replicate) for r in t.runs}
        last = max(r.level for r in t.runs)
        for i, s in enumerate(t.plan.settings):
            for level in range(min(s.levels, last)):
                self.assertTrue(all((i, level, k) in done for k in range(3)), s.name)

    def test_what_is_promised_comes_out(self):
        """The error of the advice is that of so many passes, whether noise rules or edges do, and
        its seconds are those of the full picture."""
        for p in (1.0, 1.5):
            for total in (20, 100):
                world = World(Frame(400, 300), self.METHODS, p)
                t = self.measured(world, total)
                for a in t.result.advice:
                    name = t.plan.settings[a.setting].name
                    true = math.sqrt(np.mean(self.share(world)) * world.variance[name] * a.passes ** -p)
                    with self.subTest(p=p, total=total, purpose=a.purpose, extrapolated=a.is_extrapolated):
                        self.assertLess(a.expected_error, 1.08 * a.error)
                        self.assertAlmostEqual(a.expected_error / true, 1, delta=0.1)
                        self.assertAlmostEqual(a.seconds / (a.passes * (1e-3 + world.cost[name] * 120000)), 1,
                                               delta=0.1)

    def share(self, world):
        """Of relMSE: b^2 / (b^2 + m^2/100)."""
        b = world.right(world.frame.film(1))
        return b * b / (b * b + b.mean() ** 2 / 100)

    def test_the_root_law_gives_slope_minus_half_and_a_constant_cost(self):
        world = World(Frame(800, 600), self.METHODS)
        t = self.measured(world, 150)
        pixels = world.frame.film(t.plan.step).pixels
        self.assertGreater(sum(len(curve.points) > 2 for curve in t.result.curves), 3)
        for i, (name, cost_, variance, _) in enumerate(self.METHODS):
            curve = t.result.curves[i]
            if len(curve.points) > 2:
                self.assertAlmostEqual(curve.slope, -0.5, delta=0.03)
            self.assertAlmostEqual(curve.cost_variance / (variance * np.mean(self.share(world)) *
                                                          (1e-3 + cost_ * pixels)), 1, delta=0.05)

    def test_what_any_pass_takes_counts_once_in_the_seconds(self):
        world = World(Frame(800, 600), self.METHODS)
        world.fill = 0.05
        t = Trade(Options("s", "f", 10), view=world, threads=1)
        t.plan.settings = [Setting("em 16", "em", {}, 1, fill_seconds=0.05)]
        t.result = SimpleNamespace(advice=[Advice("final picture", 0.05, 0, 4, seconds=20.0)])
        seconds.time_advice(t)
        self.assertGreater(len(world.log), 2)
        self.assertAlmostEqual(t.result.advice[0].seconds / (4 * (0.05 + 3e-6 * 480000)), 1, delta=0.01)

    def test_a_lamp_that_one_render_of_eight_meets_is_no_promise(self):
        world = World(Frame(80, 60), self.METHODS)
        usual = world.render

        def lucky(*job):
            picture = usual(*job)
            if len(world.log) == 3:
                picture.rgb[7, 9] = 1e3
            return picture

        world.render = lucky
        t = Trade(Options("s", "f", 10, passes=4), view=world, both=Reference(world.right(Film(0, 0, 80, 60))))
        t.plan.step, t.plan.settings = 1, [Setting("em 16", "em", {}, 1)]
        c = check._Check(t, 0, Advice("final picture", 0.05, 0, 4), end=math.inf, now=check._Measured(4))
        self.assertAlmostEqual(c.measure(4, 0) / (3.0 / 4 * np.mean(self.share(world))), 1, delta=0.05)
        self.assertEqual(len(world.log), 8)

    def test_shots_have_the_passes_of_the_longest_runs(self):
        t = self.measured(World(Frame(800, 600), self.METHODS), 40)
        for shot in t.strip:
            each = t.result.curves[shot.setting].pass_seconds
            self.assertTrue(shot.passes == 1 or abs(shot.passes * each - t.plan.run_seconds) <= each)


class Pilot(unittest.TestCase):
    def test_quick_looks_at_one_of_each_integrator_first(self):
        settings = [Setting("a 1", "a", {}, 1), Setting("a 2", "a", {}, 1), Setting("b 1", "b", {}, 1)]
        self.assertEqual([s.name for s in pilot._order(settings)], ["a 1", "b 1", "a 2"])

    def test_quick_leaves_out_the_further_ones_of_each_integrator(self):
        world = World(Frame(800, 600), InAWorld.METHODS)
        t = Trade(Options("s", "f", 0.1, quick=True), view=world, start=world.now)
        t.plan.settings = [Setting(name, name.split()[0], {}, 1, judge=judge) for name, _, _, judge in world.settings]
        with mock.patch("time.monotonic", world.clock):
            left = [s.name for s in pilot.run_pilot(t)]
        self.assertEqual(left[-2:], ["mis 64", "sir 256/16"])


if __name__ == "__main__":
    unittest.main()
