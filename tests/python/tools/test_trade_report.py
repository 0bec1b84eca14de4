# SPDX-License-Identifier: BSD-2-Clause
"""What follows from the runs of `bis trade`: points, curves, the front, advice, tables, summary, page. A sweep stands
in this file, and what follows from it was worked out on paper."""
import csv
import itertools
import json
import math
import os
import re
import sys
import tempfile
import unittest

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
sys.path.insert(0, os.path.join(ROOT, "scripts/python"))
import bis  # noqa: E402
from bis.tools.trade import advice, files, report, stats, tables  # noqa: E402
from bis.tools.trade.model import Advice, Options, Plan, Reference, Run, Setting, Shot, Trade  # noqa: E402

EM, MIS, MIS_LONG, SIR, REJECTION, BRDF = range(6)
FLOOR = 1 / 64  # what the references add to a relMSE
NAN = math.nan


def setting(name, levels, **more):
    integrator, counts = name.split()[:2]
    if "/" in counts:
        candidates, shadowrays = (int(n) for n in counts.split("/"))
        values = {"candidates": candidates, "shadowrays": shadowrays, "proposal": "mix"}
    else:
        values = {"samples": int(counts)}
    option = "--integrator %s" % integrator + "".join(" --%s %s" % v for v in values.items() if v[0] != "proposal")
    return Setting(name, integrator, values, 1.0, judge=0 if "/" in counts else 1, levels=levels, pass_seconds=1,
                   **{"option_text": option, "scene_text": 'Integrator "%s"' % integrator, **more})


def add_runs(t, which, level, seconds, noise):
    """One run of each seed, the last first: means do not depend on the order, and a median must sort."""
    for k in reversed(range(len(seconds))):
        passes = (k + 1) << level
        t.runs.append(Run(which, level, k, 77, seconds[k], 100 * passes, 10 * passes, 1000 * passes,
                          (3.0, 4.0, 5.0)[k], (0.1, 0.2, 0.6)[k], (-0.1, 0.2, 0.2)[k], noise[k] + FLOOR))


class Covered:
    """A scene whose shapes fill the picture."""

    def coverage(self):
        return None


def forged(folder="hand"):
    """em keeps the root law, with seeds of unlike noise and speed. mis is twice as good for twice the time, until it
    goes below what the references can tell. sir is the best by its mean alone: one of its seeds was far worse. A brdf
    was too slow."""
    plan = Plan(full_width=8, full_height=4, step=2, width=4, height=2, n_seeds=3, run_seconds=4,
                reference=[MIS_LONG, SIR], reference_passes=[5, 7], settings=[
                    setting("em 16", 3), setting("mis 16", 4), setting("mis 64", 1, is_scenes=True),
                    setting("sir 64/4", 1, fill_seconds=0.2, option_text=""),
                    setting("rejection 100/8", 2, is_biased=True), setting("brdf 16", 0)])
    plan.settings[BRDF].pass_seconds = 30
    image = np.ones((2, 4, 3), np.float32)
    t = Trade(Options("a/hand.txt", folder, 1), plan, threads=2, view=Covered(),
              both=Reference(image, FLOOR, 0.5),
              references=[Reference(image, 0.04, 0.5, 0.03), Reference(image, 0.0225, 0.51, 0.04)])
    for level in range(3):
        add_runs(t, EM, level, [s * 2 ** level for s in (1.5, 1, 2)], [0.25 * k / 2 ** level for k in (1, 2, 3)])
    for level, noise in enumerate((0.25, 0.0625, 1 / 64, 1 / 512)):
        add_runs(t, MIS, level, [2.0 ** level] * 3, [noise] * 3)
    add_runs(t, MIS_LONG, 0, [3], [0.0625])
    add_runs(t, SIR, 0, [1, 1, 1], [0.01, 0.01, 0.13])
    add_runs(t, REJECTION, 0, [0.5, 0.5], [0.04, 0.04])
    add_runs(t, REJECTION, 1, [1, 1], [0.04, 0.04])
    stats.summarise(t)
    return t


class Figures(unittest.TestCase):
    def near(self, found, expected, places=12):
        if math.isnan(expected):
            self.assertTrue(math.isnan(found), found)
        else:
            self.assertAlmostEqual(found, expected, places=places)

    def test_points_are_means_and_medians_of_their_seeds(self):
        root = math.sqrt(3)  # of 0.25, 0.5, 0.75 the deviation is 0.25
        expected = [
            (EM, 0, 1.5, 0.5, 0.25 / root, False), (EM, 1, 3, 0.25, 0.125 / root, False),
            (EM, 2, 6, 0.125, 0.0625 / root, False), (MIS, 0, 1, 0.25, 0, False), (MIS, 1, 2, 0.0625, 0, False),
            (MIS, 2, 4, 1 / 64, 0, True), (MIS, 3, 8, 1 / 512, 0, True), (MIS_LONG, 0, 3, 0.0625, NAN, False),
            (SIR, 0, 1, 0.05, 0.04, False),  # sqrt((2 x 0.04^2 + 0.08^2)/2/3)
            (REJECTION, 0, 0.5, 0.04, 0, True), (REJECTION, 1, 1, 0.04, 0, False)]  # as right as before, later
        of_n = {3: (math.sqrt(50 / 3), 0.3, math.sqrt(0.14 / 6), 0.1, 0.1),
                2: (math.sqrt(12.5), 0.15, 0.05, 0.05, 0.15), 1: (3, 0.1, NAN, -0.1, NAN)}
        points = forged().result.points
        self.assertEqual([(p.setting, p.level, p.on_front) for p in points], [(*e[:2], e[5]) for e in expected])
        for p, (which, level, seconds, noise, noise_se, _) in zip(points, expected):
            each = 2 ** level * (p.n + 1) / 2  # of 1 ... n passes
            rmse, relmse, relmse_se, bias, bias_se = of_n[p.n]
            judge = 0.03 if which in (SIR, REJECTION) else 0.04  # of the reference by the other
            for found, wanted in ((p.passes, 2 ** level), (p.seconds, seconds), (p.noise, noise),
                                  (p.noise_se, noise_se), (p.cost_variance, seconds * noise), (p.rmse, rmse),
                                  (p.relmse, relmse), (p.relmse_se, relmse_se), (p.bias, bias),
                                  (p.bias_se, math.hypot(bias_se, judge))):
                self.near(found, wanted)
            self.assertEqual((p.camera_rays, p.shadow_rays, p.candidates), (100 * each, 10 * each, 1000 * each))

    def test_a_median_does_not_depend_on_the_order(self):
        for values in itertools.permutations((1, 2, 3, 4, 5)):
            self.assertEqual(stats.median(values), 3)
        for values in itertools.permutations((1, 2, 4, 8)):
            self.assertEqual(stats.median(values), 3)

    def test_sums_go_term_by_term(self):
        self.assertEqual(stats.total([1.0, 1e16, -1e16]), 0.0)  # sum() of Python 3.12 gives 1

    def test_curves_are_weighted_by_passes_and_leave_out_what_is_hidden(self):
        # em: seconds x noise is 0.25 x 1.5, 2, 6 for the seeds. mis: (1/4 + 2 x 2/16 + 4 x 4/64 + 8 x 8/512)/15; each
        # budget but the last, which the references hide, is half the error for twice the time.
        expected = [(3, 0.25 * 9.5 / 3, 0.25 * 1.4240006242195884, -0.5, 1.5), (4, 0.875 / 15, 0, -1, 1),
                    (1, 0.1875, NAN, NAN, 3), (1, 0.05, 0.04, NAN, 1), (2, 0.1 / 3, 0, NAN, 0.5)]
        t = forged()
        for c, (n, cost, cost_se, slope, one_pass) in zip(t.result.curves, expected):
            self.assertEqual(len(c.points), n)
            for found, wanted in ((c.cost_variance, cost), (c.cost_variance_se, cost_se), (c.slope, slope),
                                  (c.slope_se, NAN if math.isnan(slope) else 0), (c.pass_seconds, one_pass)):
                self.near(found, wanted)
        self.assertEqual(t.result.curves[BRDF].points, [])
        # An error that is seen, and a clock that did not tick: the slope is that of the other three, of errors of
        # 2^-2, 2^-3, 2^-3.5.
        for r in t.runs:
            if r.setting == MIS and r.level == 0:
                r.seconds = 0
            if r.setting == MIS and r.level == 3:
                r.relmse_both = 1 / 64 + 1 / 128
        stats.summarise(t)
        self.near(t.result.curves[MIS].slope, -0.75)
        for r in t.runs:  # a fifth of what the references add is hidden, three tenths are seen
            if r.setting == MIS and r.level == 3:
                r.relmse_both = FLOOR * 1.22
        stats.summarise(t)
        self.near(t.result.curves[MIS].slope, NAN)
        for r in t.runs:
            if r.setting == MIS and r.level == 3:
                r.relmse_both = FLOOR * 1.3
        stats.summarise(t)
        self.near(t.result.curves[MIS].slope, -0.9342414, 6)

    def test_slopes_and_costs_of_the_root_law_are_found_whatever_the_seeds_are(self):
        for n in (1, 2, 3, 5):
            t = Trade(Options("s", "f", 1), Plan(settings=[setting("em 16", 6)], n_seeds=n, full_width=9,
                                                 full_height=4, width=9, height=4, run_seconds=32))
            for level, k in itertools.product(range(6), range(n)):
                t.runs.append(Run(0, level, k, 1, (1 + 0.3 * k) * 2 ** level, 1, 1, 1, 1, 1, 0,
                                  (2 + k) / 2 ** level))
            stats.summarise(t)
            curve = t.result.curves[0]
            self.near(curve.slope, -0.5)
            self.near(curve.cost_variance, np.mean([(1 + 0.3 * k) * (2 + k) for k in range(n)]))
            self.assertEqual(math.isnan(curve.slope_se), n < 3)  # two are often alike by chance

    def test_equal_points_are_both_on_the_front(self):
        t = forged()
        t.runs = []
        for which, level, seconds, noise in ((EM, 0, 2, 0.5), (MIS, 0, 1, 1), (SIR, 0, 2, 0.5), (REJECTION, 0, 1, 2),
                                             (REJECTION, 1, 1.5, 1)):
            add_runs(t, which, level, [seconds], [noise])
        stats.summarise(t)
        self.assertEqual([p.setting for p in tables.front(t)], [MIS, EM, SIR])

    def test_no_point_of_the_front_is_beaten_and_every_other_one_is(self):
        rng = np.random.default_rng(4)
        for _ in range(50):
            points = [stats.Point(0, 0, 1, 1, s, 1, 1, 1, 1, 1, 1, e, 1, 1, 1, s * e)
                      for s, e in rng.integers(1, 6, (12, 2)).tolist()]
            stats.find_front(points)
            for p in points:
                beaten = [q for q in points if q.seconds <= p.seconds and q.noise <= p.noise
                          and (q.seconds, q.noise) != (p.seconds, p.noise)]
                self.assertEqual(p.on_front, not beaten)

    def test_errors_at_a_time_and_times_to_an_error_lie_on_lines_between_the_budgets(self):
        end = math.sqrt(1 / 512)
        t = forged()
        for which, at, value, beyond in (
                (MIS, 0.99, NAN, False), (MIS, 1, 0.5, False), (MIS, 1.6, 0.5 / 1.6, False), (MIS, 3, 0.5 / 3, False),
                (MIS, 4, 0.125, False), (MIS, math.sqrt(32), math.sqrt(0.125 * end), False), (MIS, 8, end, False),
                (MIS, 32, end / 2, True), (MIS, 512, end / 8, True), (MIS, 513, NAN, True), (MIS_LONG, 3, 0.25, False),
                (MIS_LONG, 12, 0.125, True), (REJECTION, 0.7, 0.2, False), (REJECTION, 1.01, NAN, True),
                (BRDF, 1, NAN, False)):
            found, is_beyond = stats.error_at(t, which, at)
            self.near(found, value)
            self.assertEqual(is_beyond, beyond, (which, at))
        for which, at, value, beyond in (
                (MIS, 0.6, 1, False), (MIS, 0.5, 1, False), (MIS, 0.3, 0.5 / 0.3, False), (MIS, 0.2, 2.5, False),
                (MIS, 0.125, 4, False), (MIS, math.sqrt(0.125 * end), math.sqrt(32), False),
                (MIS, end / 2, 32, True), (MIS, end / 8, 512, True),
                (MIS, end / 7.9, 8 * 7.9 ** 2, True), (MIS, end / 8.1, NAN, True), (EM, 0.25, 12, True),
                (REJECTION, 0.2, 0.5, False), (REJECTION, 0.1, NAN, True), (BRDF, 1, NAN, False)):
            found, is_beyond = stats.seconds_to(t, which, at)
            self.near(found, value, 9)
            self.assertEqual(is_beyond, beyond, (which, at))
        points = t.result.curves[MIS].points
        points[1].noise = -0.001  # without a logarithm: the budget before
        self.near(stats.error_at(t, MIS, 1.5)[0], 0.5)
        self.near(stats.seconds_to(t, MIS, 0.3)[0], 2)
        points[0].seconds, points[1].noise = 0, 0.0625
        self.near(stats.error_at(t, MIS, 1.5)[0], 0.5)

    def test_the_best_counts_its_standard_error_and_no_bias(self):
        t = forged()
        self.assertEqual(t.result.best, MIS)  # sir: 0.05 + 0.04; rejection is biased
        self.assertEqual([stats.best_of(t, name) for name in ("rejection", "mis", "brdf", "em")],
                         [REJECTION, MIS, -1, EM])
        self.assertEqual(stats.heads(t), [EM, MIS, MIS_LONG, SIR, REJECTION])  # mis 64 is the scene's own
        t.plan.settings[MIS_LONG].is_scenes = False
        self.assertEqual(stats.heads(t), [EM, MIS, SIR, REJECTION])
        for cost, best in ((0.875 / 15, EM), (0.01, EM), (0.06, MIS)):  # of equal ones the first
            t.result.curves[EM].cost_variance = t.result.curves[MIS].cost_variance if best == EM else cost
            t.result.curves[EM].cost_variance -= 0.01 if cost == 0.01 else 0
            t.result.curves[EM].cost_variance_se = NAN
            self.assertEqual(stats.best_of(t), best)
        for s in t.plan.settings:
            s.is_scenes = True
        t.plan.settings, t.result.curves = t.plan.settings * 2, t.result.curves * 2
        self.assertEqual(len(stats.heads(t)), 8)  # as many as the strip has places

    def test_columns_are_halves_of_the_longest_run_and_round_errors(self):
        t = forged()
        self.assertEqual(stats.times(t), [0.5, 1, 2, 4])
        self.assertEqual(stats.errors(t), [0.02, 0.03, 0.05, 0.1, 0.15, 0.2])  # from sqrt(1/512)/4 = 0.011 on
        for least, expected in ((0.03 * 4, [0.03, 0.05, 0.1, 0.15, 0.2, 0.3]), (0.9 * 4, [1, 2, 5]), (0, [])):
            for p in t.result.points:
                p.noise = least * least
            self.assertEqual(stats.errors(t), expected)


class Advised(unittest.TestCase):
    def test_it_is_the_cheapest_that_keeps_the_error(self):
        # mis 16, 0.875/15 a second of the film, 4 times that many pixels: 0.05 wants 23.3 passes of 4 s. sir has 0.05,
        # 20 passes of 0.2 + 0.8 x 4 s: less, but not with its doubt, 1.8 times.
        t = forged()
        for a, purpose, error, passes in zip(t.result.advice, ("preview", "good picture", "final picture"),
                                             (0.5, 0.15, 0.05), (1, 4, 25)):
            passes = min(n for n in range(1, 40) if n >= 0.875 / 15 / error ** 2
                         and math.ceil(math.sqrt(n)) * round(math.sqrt(n)) == n)
            self.assertEqual((a.purpose, a.error, a.setting, a.passes), (purpose, error, MIS, passes))
            self.assertAlmostEqual(a.seconds, 4.0 * passes)
            self.assertAlmostEqual(a.expected_error, math.sqrt(0.875 / 15 / passes))
            self.assertEqual(a.is_extrapolated, passes > 8)  # 8 passes were measured
        t.stratified = False
        advice.advise(t)
        self.assertEqual([a.passes for a in t.result.advice], [1, 3, 24])
        for passes in (8, 9):
            t.options.error = math.sqrt(0.875 / 15 / (passes - 0.5))
            advice.advise(t)
            self.assertEqual(t.result.advice[2].passes, passes)
            self.assertEqual(t.result.advice[2].is_extrapolated, passes == 9)
        t.result.curves[SIR].cost_variance_se = 0
        t.options.error = 0.2
        advice.advise(t)
        self.assertEqual([a.error for a in t.result.advice], [0.5, 0.2, 0.2])
        self.assertEqual((t.result.best, t.result.advice[2].setting, t.result.advice[2].passes), (SIR, SIR, 2))
        self.assertAlmostEqual(t.result.advice[2].seconds, 6.8)
        t.options.error = 1e-6  # 5e10 passes
        advice.advise(t)
        self.assertEqual(t.result.advice[2].setting, -1)

    def test_nothing_is_advised_that_is_biased_or_was_not_timed(self):
        t = forged()
        for s in t.plan.settings:
            s.is_biased = s.integrator != "em"
        for r in t.runs:
            r.seconds = 0
        stats.summarise(t)
        self.assertEqual([a.setting for a in t.result.advice], [-1] * 3)

    def test_passes_are_on_the_most_square_grid(self):
        for stratified in (True, False):
            t = Trade(Options("s", "f", 1), stratified=stratified)
            for n in range(1, 500):
                found = advice.square_passes(t, n - 0.25)
                good = {k * j for k in range(1, 30) for j in (k, k + 1)} if stratified else {n}
                self.assertEqual(found, min(g for g in good if g >= n))
            self.assertEqual(advice.square_passes(t, -5), 1)

    def test_the_cheapest_that_keeps_an_error_is_taken(self):
        for seconds, errors, is_law, taken in (
                ((1, 2, 9), (.4, .12, .05), False, (0, 1, 2)), ((1, 2, 9), (.14, .15, .05), False, (0, 0, 2)),
                ((2, 1, 9), (.4, .12, .05), False, (1, 1, 2)), ((3, 2, 1), (.4, .12, .05), False, (2, 2, 2)),
                ((2, 2, 2), (.4, .12, .05), False, (2, 2, 2)), ((1, 2, 9), (.151, .15, .05), False, (0, 1, 2)),
                ((1, 2, 9), (.14, .15, .05), True, (0, 1, 2))):
            before = [Advice(purpose, error, k, 5 + k, seconds[k], errors[k], k == 0 and is_law)
                      for k, (purpose, error) in enumerate((("a", .5), ("b", .15), ("c", .05)))]
            after = advice.take_cheapest(before)
            self.assertEqual([a.setting for a in after], list(taken))
            self.assertEqual([(a.purpose, a.error) for a in after], [("a", .5), ("b", .15), ("c", .05)])


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def text(self, name):
        with open(self.path(name)) as f:
            return f.read()

    def test_runs_are_written_in_order_and_read_back(self):
        t = forged(self.folder.name)
        files.write_runs(t)
        u = forged(self.folder.name)
        u.runs = []
        files.read_runs(u)
        self.assertEqual(u.runs, sorted(forged().runs, key=lambda r: (r.setting, r.level, r.replicate)))
        self.assertTrue(self.text("runs.csv").startswith(files.HEADER + "\nem 16,1,1,77,1.5,100,10,1000,3,0.1,-0.1,"))

    def test_each_field_is_taken_up_to_its_limits_and_no_further(self):
        good = ("em 16,1048576,16,9007199254740991,1e12,9223372036854775808,9223372036854775808,9223372036854775808,"
                "1.7e308,1.6e308,-1.5e308,1.4e308").split(",")
        t = Trade(Options("s", self.folder.name, 1), Plan(n_seeds=16, settings=[
            setting("em 16", 21), setting("sir 64/4", 0), setting("mis 64", 3, is_swept=False)]))

        def read(*lines):
            with open(self.path("runs.csv"), "w") as f:
                f.write("\n".join((files.HEADER,) + lines))  # the last line needs no newline
            t.runs = []
            files.read_runs(t)

        read(",".join(good), "em 16,1,1,0,0,0,0,0,0,0,1.3e308,0\n")
        most, least = t.runs
        self.assertEqual((most.level, most.replicate, most.seed, most.seconds, most.candidates, most.rmse, most.bias),
                         (20, 15, 2 ** 53 - 1, 1e12, 2 ** 63, 1.7e308, -1.5e308))
        self.assertEqual((least.level, least.replicate, least.seed, least.bias), (0, 0, 0, 1.3e308))
        names = files.HEADER.split(",")
        for column, value, name in (
                (0, "sir 64/4", "passes"), (0, "mis 64", 0), (0, "x", 0), (1, "2097152", 1), (1, "3", 1), (1, "0", 1),
                (2, "17", 2), (2, "0", 2), (3, "9007199254740994", 3), (3, "-1", 3), (3, "1.5", 3), (3, "1_0", 3),
                (4, "1.1e12", 4), (4, "-1e-9", 4), (4, "nan", 4), (4, " 1", 4), (5, "9223372036854777856", 5),
                (5, "0.5", 5), (6, "-1", 6), (7, "x", 7), (7, "", 7), (8, "1e309", 8), (8, "-1e-9", 8), (9, "inf", 9),
                (10, "-1e309", 10), (10, "nan", 10), (11, "1e309", 11), (11, "", 11), (11, "1,5", 11), (11, "1 1", 11)):
            line = ",".join(good[:column] + [value] + good[column + 1:])
            with self.assertRaises(bis.Error) as c:
                read("em 16,1,1,0,0,0,0,0,0,0,0,0", line)
            self.assertEqual(str(c.exception), '%s:3:1: error: "%s" is no run of plan.txt, by its %s; remove the line '
                             'and it is measured again' % (self.path("runs.csv"), line,
                                                           name if isinstance(name, str) else names[name]))
        with self.assertRaisesRegex(bis.Error, '3:1: error: "em 16.*" is the second of its kind; remove one of them'):
            read("em 16,1,1,0,0,0,0,0,0,0,0,0", "em 16,1,1,5,0,0,0,0,0,0,0,0")
        with open(self.path("runs.csv"), "w") as f:
            f.write("setting\n")
        with self.assertRaisesRegex(bis.Error, 'runs.csv:1:1: error: the first line must be "setting,passes,'):
            files.read_runs(t)

    def test_tables_have_the_figures_in_their_columns(self):
        t = forged(self.folder.name)
        tables.write_tables(t)
        rows = list(csv.DictReader(self.text("trade.csv").splitlines()))
        self.assertEqual(len(rows), 11)
        self.assertEqual(self.text("trade.csv").splitlines()[8], "mis 64,mis,,,64,,1,1,1,3,100,10,1000,3,0.1,,0.0625,"
                         "-0.1,,0.1875,0")
        self.assertEqual([rows[9][k] for k in ("setting", "candidates", "shadowrays", "samples", "proposal", "pareto")],
                         ["rejection 100/8", "100", "8", "", "mix", "1"])
        front = list(csv.DictReader(self.text("pareto.csv").splitlines()))
        self.assertEqual([r["seconds"] for r in front], ["0.5", "4", "8"])  # in the order of time
        self.assertTrue(all(r in rows for r in front))
        at, to = (list(csv.DictReader(self.text("equal_%s.csv" % name).splitlines())) for name in ("time", "error"))
        self.assertEqual([r["setting"] for r in at], ["em 16", "mis 16", "mis 64", "sir 64/4", "rejection 100/8"])
        self.assertEqual(list(at[0])[5:9], ["error_at_0.5s", "error_at_0.5s_extrapolated", "error_at_1s",
                                            "error_at_1s_extrapolated"])
        self.assertEqual((at[1]["error_at_2s"], float(at[1]["slope"]), at[2]["slope"]),
                         ("0.25", t.result.curves[MIS].slope, ""))
        self.assertEqual((at[3]["error_at_4s_extrapolated"], at[4]["error_at_2s"]), ("1", ""))
        self.assertEqual(list(to[0])[5::2], ["seconds_to_%s" % e for e in ("0.02", "0.03", "0.05", "0.1", "0.15",
                                                                           "0.2")])
        self.assertAlmostEqual(float(to[1]["seconds_to_0.2"]), 2.5)
        self.assertEqual(to[4]["seconds_to_0.2"], "0.5")
        for r in rows:  # what is written reads back as it was
            p = [p for p in t.result.points if t.plan.settings[p.setting].name == r["setting"]
                 and p.passes == int(r["passes"])][0]
            self.assertEqual((float(r["noise"]), float(r["rmse"]), float(r["cost_variance"])),
                             (p.noise, p.rmse, p.cost_variance))

    def test_the_summary_says_what_to_use(self):
        t = forged()
        t.stratified = False
        advice.advise(t)
        lines = report.summary(t).splitlines()
        self.assertEqual(lines[2], "final picture  error 4.9%  ~96 s     --integrator mis --samples 16 --spp 24")
        self.assertEqual(lines[3], "29 of 33 runs in hand/report.html")
        t.result.advice[0].setting = SIR  # which the options cannot say
        self.assertIn(' Integrator "sir" --spp 1', report.summary(t))
        for a in t.result.advice:
            a.setting = -1
        self.assertEqual(report.summary(t), "no advice: no setting has enough runs; give --resume --time more\n"
                                            "29 of 33 runs in hand/report.html\n")

    def strip(self, t):
        """Both methods err most at the lower right corner; one has a firefly, which counts as half."""
        reference = np.ones((8, 16, 3), np.float32)
        images = [reference.copy() for _ in range(2)]
        for image in images:
            image[7, 15], image[6, 13] = 9, 1.5
        images[0][3, 5] = 1e6
        t.both.image = reference
        t.strip = [Shot(REJECTION, 8, 3.9, 0.04, images[0]), Shot(MIS, 1, 4.1, 0.0025, images[1])]
        t.plan.width, t.plan.height, t.plan.full_width, t.plan.full_height = 16, 8, 32, 16

    def test_the_page_has_the_data_of_the_measurement(self):
        t = forged(self.folder.name)
        self.strip(t)
        t.result.advice[0].setting = -1
        t.result.curves[MIS].points[2].bias, t.result.curves[MIS].points[2].bias_se = -0.1, NAN
        t.result.curves[EM].points[0].noise = 0  # below what the references tell
        t.result.advice[1].setting = SIR  # which the options cannot say
        report.write_report(t)
        page = self.text("report.html")
        data = json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL).group(1))
        self.assertEqual(" ".join(data), "scene version complete runs planned advice times errors best settings film "
                         "run_seconds seeds threads references given noise difference difference_se left_out crops "
                         "reference shots")
        self.assertEqual([s["name"] for s in data["settings"]], [
            "rejection 100/8", "sir 64/4", "mis 16", "mis 64", "em 16"])  # in the order of cost x variance
        mis = data["settings"][2]
        self.assertEqual(" ".join(mis), "name method biased own head cost_variance cost_variance_se slope slope_se "
                         "points error_at seconds_to")
        self.assertEqual(" ".join(mis["points"][0]), "passes seconds rays error error_se bias bias_se pareto")
        self.assertEqual((mis["points"][2]["bias"], mis["points"][2]["bias_se"]), (-0.1 / 0.51, None))
        self.assertAlmostEqual(mis["points"][3]["error"], math.sqrt(1 / 512))
        self.assertAlmostEqual(data["settings"][1]["points"][0]["error_se"], 0.04 / (2 * math.sqrt(0.05)))
        self.assertEqual(data["settings"][4]["points"][1]["rays"], 110 * 2 * 2 / 128)
        self.assertEqual(mis["error_at"][0], {"value": None, "extrapolated": False})
        self.assertEqual(data["advice"][0], {"purpose": "preview", "setting": None})
        self.assertEqual([data["advice"][1][k] for k in ("candidates", "shadowrays", "samples", "options", "line")],
                         [64, 4, None, "", 'Integrator "sir"'])
        self.assertEqual((data["advice"][2]["samples"], data["advice"][2]["line"]), (16, ""))
        self.assertEqual(data["advice"][2]["options"], "--integrator mis --samples 16")
        self.assertEqual(data["noise"], 0.125)
        self.assertAlmostEqual(data["difference"], 0.02)
        self.assertAlmostEqual(data["difference_se"], math.hypot(0.03, 0.04) / 0.5)
        self.assertEqual(data["references"][0], {
            "judges": "sir and rejection", "name": "mis 64", "renders": 8, "passes": 5, "mean": 0.5, "se": 0.06,
            "noise": 0.2})
        self.assertEqual(data["left_out"], [{"name": "brdf 16", "pass_seconds": 30}])
        self.assertEqual(data["crops"], [{"x": 12, "y": 6, "width": 4, "height": 2},
                                         {"x": 2, "y": 2, "width": 4, "height": 2}])
        self.assertEqual([s["error"] for s in data["shots"]], [0.2, 0.05])
        self.assertTrue(data["shots"][0]["picture"].startswith("data:image/png;base64,"))
        text = re.search(r'<pre id="text">(.*?)</pre>', page, re.DOTALL).group(1)
        self.assertIn("29 of 33 runs in ", text)
        self.assertRegex(text, r"mis 16 +8 +8 s +4.4% yes\n")
        self.assertRegex(text, r"em 16 +1 +1.5 s +- \n")

    def test_a_page_without_pictures_or_runs_is_one(self):
        t = forged(self.folder.name)
        t.references[1] = Reference()
        t.runs = []
        stats.summarise(t)
        found = report.values(t)
        self.assertEqual((found["best"], found["settings"], found["shots"], found["crops"]), (None, [], [], []))
        t.plan.reference, t.result.best = [EM, EM], EM  # the first of the table
        found = report.values(t)
        self.assertEqual((found["best"], found["references"][0]["name"]), ("em 16", "em 16"))
        self.assertEqual((len(found["references"]), found["difference"]), (1, None))

    def test_crops_are_quarters_and_do_not_depend_on_the_unit(self):
        t = forged()
        self.strip(t)
        for unit in (1, 2.0 ** -20, 2.0 ** 20):
            self.assertEqual(report.crops([np.float32(s.image * unit) for s in t.strip], t.both.image * unit),
                             [(12, 6), (2, 2)])
        plain = np.ones((9, 13, 3), np.float32)  # windows of 4 x 3: the first, and the first beside it
        self.assertEqual(report.crops([plain], plain), [(0, 0), (4, 0)])
        t.both.image, t.strip = plain, [Shot(MIS, 1, 1, 1, plain)]
        self.assertEqual([(c["width"], c["height"]) for c in report.values(t)["crops"]], [(4, 3)] * 2)
        for channel in range(3):  # each of them counts
            other = plain.copy()
            other[7, 10, channel] = 2
            self.assertEqual(report.crops([other], plain)[0], (8, 6))


if __name__ == "__main__":
    unittest.main()
