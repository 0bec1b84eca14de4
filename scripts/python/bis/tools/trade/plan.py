# SPDX-License-Identifier: BSD-2-Clause
"""How many pixels, passes and seeds fit into the time?

A small picture is not a large one made small: its pixels are larger, more of them hold an edge, and
each is noisier (scene.txt: 12 % at 98 x 74 where 800 x 600 have 8 %). So what is measured is a thin
film: of each k x k pixels of the full picture one, at its size, with its random numbers. The pilot
says what a pixel of a pass costs with each setting, c, and what scatter it leaves, v. From that:

- the setting of least c v of each integrator, and the scene's own, get budgets of up to r seconds;
  the others r/4, because cost x variance hardly changes along a curve, so that a short one says
  nearly as much;
- so few pixels that the middle one of the longer curves has some 8 passes, four budgets, at its
  end, and that one pass of each of them fits;
- r such that all runs fill 50 % of what is left of the time; the references get 22 %, the pictures
  6 %, the seconds of the full picture 9 % (seconds.py), the error of the advice as much (check.py),
  and the rest is for surprises.

With --passes all of them get that many instead, however long that takes, and only the pixels depend
on the clock. With --quick the time is given and not asked for. Where it is too short, there are
fewer pixels, then one seed, then fewer settings.
"""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from ..._errors import Error
from .. import text
from .model import LEVELS, MOST_PASSES, REPLICATES, Options, Plan, Setting

LEAST_PIXELS = 4800
FEWEST_PIXELS = 2400  # where --quick makes do with less
MOST_PIXELS = 90000  # in the mean; a step is a whole number: up to 2.25 times as many
MIDDLE_PASSES = 8
REFERENCE_BUDGETS = 4  # with --passes: a replicate of a reference has so many times the passes
SWEEP_SHARE, REFERENCE_SHARE = 0.5, 0.22
SHORT_CURVE = 0.25  # of r, for settings that are not the best of their integrator
# a setting whose single pass takes so many r is left out; the best of an integrator: 4 times that
TOO_SLOW = 4
SLACK = 2  # in reaching an error: budgets are doubled, and a pilot is short
# of the references
MAKERS = (("mis 16", "mis 64"), ("sir 64/4", "sir 256/16", "sir 256/16 product"))


# ---- the film ----


class Film(NamedTuple):
    """The pixels that are rendered, in those of the thin picture."""

    x: int
    y: int
    width: int
    height: int

    @property
    def pixels(self) -> int:
        return self.width * self.height


@dataclass(frozen=True)
class Frame:
    """The full picture and its crop, in shares of it."""

    width: int
    height: int
    crop: tuple[float, float, float, float] = (0, 1, 0, 1)

    def film(self, step: int) -> Film:
        """Of each step x step pixels one, as `bis_film_place` rounds."""
        x0, x1 = (thinned(math.ceil(self.width * share), step) for share in self.crop[:2])
        y0, y1 = (thinned(math.ceil(self.height * share), step) for share in self.crop[2:])
        return Film(x0, y0, x1 - x0, y1 - y0)

    def step_for(self, pixels: float) -> int:
        """The step of the film with about so many pixels; each row and column keeps one at
        least."""
        whole = self.film(1)
        step = math.floor(math.sqrt(whole.pixels / pixels) + 0.5)
        return max(1, min(step, whole.width, whole.height))


def thinned(at: int, step: int) -> int:
    """How many pixels of a thin film lie before pixel `at` of the picture."""
    return (at - step // 2 + step - 1) // step


# ---- who is the best of the pilot? ----


def may_be_reference(s: Setting, which: int) -> bool:
    """Whether a setting may make reference 0 (a mis) or 1 (a sir)."""
    return s.name in MAKERS[which]


def _is_better(a: Setting, b: Setting) -> bool:
    if a.is_biased != b.is_biased:
        return not a.is_biased
    cost_a, cost_b = a.pass_seconds * a.pass_relmse, b.pass_seconds * b.pass_relmse
    return cost_a < cost_b or math.isnan(cost_b)


def _gets_long_curve(plan: Plan, s: Setting) -> bool:
    """Best of its integrator among the swept, or the scene's own."""
    if not s.is_swept:
        return False
    rivals = [o for o in plan.settings if o is not s and o.is_swept
              and o.integrator == s.integrator]
    return s.is_scenes or not any(_is_better(o, s) for o in rivals)


# ---- budgets ----


class _Fit:
    """A plan that is being fitted. pass_seconds are those of a pixel until the size is known."""

    def __init__(self, plan: Plan, asked: Options, frame: Frame, seconds: float) -> None:
        self.plan = plan
        self.asked = asked
        self.frame = frame
        self.seconds = seconds  # of the sweep
        self.is_long = [_gets_long_curve(plan, s) for s in plan.settings]

    def best(self) -> list[Setting]:
        """Those that get long curves."""
        return [s for s, is_long in zip(self.plan.settings, self.is_long) if is_long]

    def levels_of(self, i: int, run_seconds: float) -> int:
        """Budgets of a setting where the longest runs take so long."""
        s = self.plan.settings[i]
        if not s.is_swept:
            return 0
        if self.asked.passes:
            return self.asked.passes.bit_length()
        passes = run_seconds * (1 if self.is_long[i] else SHORT_CURVE) / s.pass_seconds
        if passes * TOO_SLOW * (4 if self.is_long[i] else 1) < 1:
            return 0
        return min(1 + math.floor(math.log2(max(passes, 1)) + 0.5), LEVELS)

    def sweep_seconds(self, run_seconds: float) -> float:
        """Of the whole sweep, for each pixel until the size is known."""
        return sum(self.plan.n_seeds * s.pass_seconds * (2.0 ** self.levels_of(i, run_seconds) - 1)
                   for i, s in enumerate(self.plan.settings))

    def least_seconds(self, pixels: float = 1) -> float:
        """One pass of each of the best for each seed, the least that says anything."""
        return sum(self.plan.n_seeds * s.pass_seconds for s in self.best()) * pixels

    def longest_run(self) -> float:
        """The seconds of the longest runs, such that the sweep fills its time."""
        lo, hi = self.seconds * 1e-9, self.seconds
        for _ in range(60):
            middle = math.sqrt(lo * hi)
            if self.sweep_seconds(middle) <= self.seconds:
                lo = middle
            else:
                hi = middle
        return lo

    def step(self, least_pixels: float) -> int:
        """Of the film. What fits into some time fits into every longer one, because it is measured
        with as few pixels where it has to be."""
        costs = sorted(s.pass_seconds for s in self.best())
        # what each one adds
        a_pixel = self.sweep_seconds(MIDDLE_PASSES * costs[(len(costs) - 1) // 2])
        most = self.frame.step_for(least_pixels)
        step = min(most, self.frame.step_for(min(max(self.seconds / a_pixel, least_pixels),
                                                 MOST_PIXELS)))
        while not self.asked.passes and step < most and not self.fits(step):
            step += 1
        return step

    def fits(self, step: int) -> bool:
        """Whether the least that says anything does."""
        return self.least_seconds(self.frame.film(step).pixels) <= self.seconds

    def set_size(self, step: int) -> None:
        """Take a size; pass_seconds become those of a pass."""
        plan = self.plan
        set_size(plan, self.frame, step)
        pixels = self.frame.film(step).pixels
        for s in plan.settings:
            s.pass_seconds *= pixels

    def keep_one(self) -> None:
        """Where even a single pass of everything is too slow, the cheapest advice is left."""
        swept = [s for s in self.plan.settings if s.is_swept and not s.is_biased
                 and s.pass_seconds > 0]
        if not any(s.levels for s in swept):
            cheapest = min(swept, key=lambda s: s.pass_seconds)
            cheapest.levels = 1
            self.plan.run_seconds = cheapest.pass_seconds


def set_size(plan: Plan, frame: Frame, step: int) -> None:
    """Store step and size of the thin film."""
    plan.step = step
    plan.width, plan.height = thinned(frame.width, step), thinned(frame.height, step)


# ---- references ----


def _choose_references(plan: Plan, asked: Options, seconds: float) -> None:
    needed = {s.judge for s in plan.settings if s.is_swept}
    for k in range(2):
        plan.reference[k] = -1
        if plan.is_given or k not in needed:
            continue
        for i, s in enumerate(plan.settings):
            if not may_be_reference(s, k) or not s.pass_seconds > 0:
                continue
            if plan.reference[k] < 0 or _is_better(s, plan.settings[plan.reference[k]]):
                plan.reference[k] = i
        share = seconds / len(needed) / REPLICATES
        passes = share / plan.settings[plan.reference[k]].pass_seconds
        plan.reference_passes[k] = int(min(max(passes, 1), MOST_PASSES))
        if asked.passes:
            plan.reference_passes[k] = REFERENCE_BUDGETS * asked.passes


# ---- can it be done? ----


def too_few_seconds(plan: Plan, asked: Options, what: str, least: float, spent: float) -> Error:
    """The error that says how much time is needed.

    Parameters
    ----------
    plan : Plan
        With its size.
    asked : Options
        The time that there is.
    what : str
        What does not fit.
    least : float
        Seconds of a single pass of it, with all seeds.
    spent : float
        Seconds until now.

    Returns
    -------
    Error
        To be raised.
    """
    return Error("error: %g s are too few: a single pass of %s, %d x %d pixels and %d seeds, wants "
                 "about %s in all; give --time more than that, or name fewer integrators by "
                 "--integrator"
                 % (asked.seconds, what, plan.width, plan.height, plan.n_seeds,
                    text.duration(1.2 * (least / SWEEP_SHARE + spent))))


def _check_error(plan: Plan, asked: Options) -> None:
    """Whether the best of the pilot reaches the error in one run of the sweep."""
    if asked.error <= 0 or asked.passes:
        return
    seconds, best = math.inf, plan.settings[0]
    for s in plan.settings:
        it = max(1, s.pass_relmse / (asked.error * asked.error)) * s.pass_seconds
        if s.is_swept and not s.is_biased and it < seconds:
            seconds, best = it, s
    if seconds <= SLACK * plan.run_seconds:
        return
    raise Error('error: a relative error of %g is out of reach: by the pilot "%s", the best, needs '
                'about %s for one picture of %d x %d pixels, and in %g s of measurement a run gets '
                '%.2g s. Give --error %.2g or more, or --time for about %s'
                % (asked.error, best.name, text.duration(seconds), plan.width, plan.height,
                   asked.seconds,
                   plan.run_seconds, asked.error * math.sqrt(seconds / plan.run_seconds),
                   text.duration(asked.seconds * seconds / plan.run_seconds)))


def seeds_for(asked: Options) -> int:
    """How many seeds each budget gets."""
    if asked.n_seeds:
        return asked.n_seeds
    if asked.quick:
        return 2
    return 5 if asked.seconds >= 600 else 3


def _step_that_fits(fit: _Fit, spent: float) -> int:
    """The step of the film, and fewer seeds where --quick needs it."""
    plan, asked = fit.plan, fit.asked
    step = fit.step(LEAST_PIXELS)
    if asked.passes or fit.fits(step):
        return step
    if asked.quick:
        step = fit.step(FEWEST_PIXELS)
        if not fit.fits(step) and not asked.n_seeds:
            plan.n_seeds = 1
            step = fit.step(FEWEST_PIXELS)
        return step
    set_size(plan, fit.frame, step)
    raise too_few_seconds(plan, asked, "the best setting of each integrator",
                          fit.least_seconds(fit.frame.film(step).pixels), spent)


def fit_plan(plan: Plan, asked: Options, frame: Frame, left: float, spent: float = 0) -> None:
    """Fit a plan to a time: its size, levels, run_seconds and references.

    Parameters
    ----------
    plan : Plan
        With n_seeds and settings from the pilot: pass_seconds of a pixel, which become those of a
        pass, and pass_relmse. With --quick it may get fewer seeds.
    asked : Options
        passes, error, quick.
    frame : Frame
        The full picture.
    left : float
        Seconds for all that comes.
    spent : float
        Seconds until now, for messages.

    Raises
    ------
    Error
        Not even one pass of the best settings fits, or the error is out of reach.
    """
    fit = _Fit(plan, asked, frame, SWEEP_SHARE * left)
    fit.set_size(_step_that_fits(fit, spent))
    plan.run_seconds = fit.longest_run()
    for i, s in enumerate(plan.settings):
        s.levels = fit.levels_of(i, plan.run_seconds)
    if asked.passes:
        plan.run_seconds = max(plan.planned_seconds(i, s.levels - 1)
                               for i, s in enumerate(plan.settings) if s.levels)
    elif asked.quick:
        fit.keep_one()
    _choose_references(plan, asked, REFERENCE_SHARE * left)
    _check_error(plan, asked)
