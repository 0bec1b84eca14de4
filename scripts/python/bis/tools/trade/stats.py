# SPDX-License-Identifier: BSD-2-Clause
"""From runs to points, curves and the Pareto front.

A point is a setting at one budget: the mean over its seeds, and their scatter. Seconds are a
median, since what disturbs a clock only ever adds. relMSE = the error of the run + that of the
reference, which are independent: of the relMSE from both references' mean their own share, known
from their replicates, is subtracted, and what is left is called noise. cost x variance = seconds x
noise hardly changes along the curve of an unbiased method (docs/errata.md, E9), and is what an
error costs: smaller is better. The bias is the mean over seeds of the mean difference; its standard
error comes from the seeds and the reference. Pixels of a run share their candidates, so their
scatter within one run would say too little. A slope is fitted to each seed by least squares, log
error over log seconds: -1/2 for independent samples; its standard error is that of the seeds, and
not known from fewer than three.

Sums are made term by term in the order of the runs, because sum() adds in another way from Python
3.12 on, and a table should not depend on that in its last digit.
"""
from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Optional

import numpy as np

from .model import STRIP, Advice, Run, Trade

LEAST_BUDGETS = 3  #: for a slope
#: For its standard error: two slopes are often alike by chance, and would claim to be sure.
LEAST_SLOPES = 3
FARTHEST = 64  #: extrapolation in time: an eighth of the error
COLUMNS = 6  #: of the tables by time and by error, at most
STEPS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.03, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0, 2.0, 5.0)


@dataclass
class Point:
    """All seeds of one setting and budget."""

    setting: int
    level: int
    n: int  #: seeds measured
    passes: int
    seconds: float  #: median
    camera_rays: float
    shadow_rays: float
    candidates: float
    rmse: float
    relmse: float
    relmse_se: float
    noise: float  #: relmse from both references' mean, less their share; <= 0: they are too short
    noise_se: float  #: NaN: one seed
    bias: float
    bias_se: float  #: NaN: one seed
    cost_variance: float  #: seconds x noise
    on_front: bool = False

    @property
    def error(self) -> float:
        """The relative error: the root of the noise."""
        return math.sqrt(max(0.0, self.noise))


@dataclass
class Curve:
    """All budgets of one setting, the shortest first. There are none if it was not measured."""

    points: list[Point] = field(default_factory=list)
    cost_variance: float = math.nan  #: mean over budgets
    cost_variance_se: float = math.nan  #: from the seeds
    slope: float = math.nan  #: of log error over log seconds; NaN: fewer than three budgets
    slope_se: float = math.nan
    pass_seconds: float = math.nan  #: at the longest budget

    @property
    def rank(self) -> float:
        """Cost x variance and its standard error.

        Of thirty settings the least figure is often that of the luckiest, which has a large one.
        """
        return self.cost_variance + (self.cost_variance_se if self.cost_variance_se > 0 else 0.0)


@dataclass
class Result:
    """What follows from the runs."""

    points: list[Point] = field(default_factory=list)
    curves: list[Curve] = field(default_factory=list)  #: one for each setting of the plan
    advice: list[Advice] = field(default_factory=list)
    best: int = -1  #: the unbiased setting of least cost x variance, -1: none


# ---- sums over seeds ----

def total(values: Iterable[float]) -> float:
    """The sum, term by term."""
    result = 0.0
    for v in values:
        result += v
    return result


def mean(values: Sequence[float]) -> float:
    """The mean."""
    return total(values) / len(values)


def standard_error(values: Sequence[float]) -> float:
    """The standard error of the mean. NaN from one value."""
    n = len(values)
    if n < 2:
        return math.nan
    middle = mean(values)
    return math.sqrt(total((v - middle) * (v - middle) for v in values) / (n - 1) / n)


def median(values: Sequence[float]) -> float:
    """The middle value, or the mean of the two in the middle."""
    in_order = sorted(values)
    n = len(in_order)
    return (in_order[(n - 1) // 2] + in_order[n // 2]) / 2


# ---- points ----

def _point(trade: Trade, setting: int, level: int, runs: Sequence[Run]) -> Point:
    n = len(runs)
    reference = trade.references[trade.plan.settings[setting].judge]
    both = [r.relmse_both for r in runs]
    seconds = median([r.seconds for r in runs])
    noise = mean(both) - trade.both.relmse
    bias = [r.bias for r in runs]
    return Point(
        setting, level, n, passes=1 << level, seconds=seconds,
        camera_rays=mean([float(r.camera_rays) for r in runs]),
        shadow_rays=mean([float(r.shadow_rays) for r in runs]),
        candidates=mean([float(r.candidates) for r in runs]),
        rmse=math.sqrt(total(r.rmse * r.rmse for r in runs) / n),
        relmse=mean([r.relmse for r in runs]), relmse_se=standard_error([r.relmse for r in runs]),
        noise=noise, noise_se=standard_error(both), bias=mean(bias),
        # numpy's is that of the C library; that of math has another last digit
        bias_se=float(np.hypot(standard_error(bias), reference.se)),
        cost_variance=seconds * noise)


def find_front(points: Sequence[Point]) -> None:
    """Mark what is not dominated: no other point is as fast and as right, and better in one of the
    two."""
    for p in points:
        p.on_front = not any(q.seconds <= p.seconds and q.noise <= p.noise
                             and (q.seconds < p.seconds or q.noise < p.noise) for q in points)


# ---- curves ----

def _follow_seed(trade: Trade, runs: Sequence[Run]) -> tuple[float, float]:
    """Of one seed: seconds x noise, and the slope of log error over log seconds.

    The first is a mean over budgets, weighted by their passes, since a rare bright sample upsets a
    short run most. The slope is NaN where there are too few budgets. Points that the reference's
    noise all but hides tell nothing of it.
    """
    floor = trade.both.relmse
    passes = cost = sx = sy = sxx = sxy = 0.0
    fitted = 0
    for r in runs:
        noise = r.relmse_both - floor
        passes += 2.0 ** r.level
        cost += 2.0 ** r.level * r.seconds * noise
        if not noise > floor / 4 or r.seconds <= 0:
            continue
        x = math.log(r.seconds)
        y = math.log(noise) / 2
        fitted += 1
        sx += x
        sy += y
        sxx += x * x
        sxy += x * y
    spread = sxx - sx * sx / max(fitted, 1)
    is_known = fitted >= LEAST_BUDGETS and spread > 0
    return cost / passes, (sxy - sx * sy / fitted) / spread if is_known else math.nan


def _curve(trade: Trade, points: list[Point], by_seed: Sequence[Sequence[Run]]) -> Curve:
    seeds = [_follow_seed(trade, runs) for runs in by_seed]
    costs = [cost for cost, _ in seeds]
    slopes = [slope for _, slope in seeds if not math.isnan(slope)]
    return Curve(
        points, mean(costs), standard_error(costs),
        slope=mean(slopes) if slopes else math.nan,
        slope_se=standard_error(slopes) if len(slopes) >= LEAST_SLOPES else math.nan,
        pass_seconds=points[-1].seconds / points[-1].passes)


def summarise(trade: Trade) -> None:
    """Compute trade.result of the runs: points, curves, the front, the best setting and the
    advice."""
    from .advice import advise  # which needs this module

    result = trade.result = Result()
    by_level: dict[tuple[int, int], list[Run]] = {}
    for r in trade.runs:
        by_level.setdefault((r.setting, r.level), []).append(r)
    for i, s in enumerate(trade.plan.settings):
        levels = [by_level.get((i, level), []) for level in range(s.levels)]
        points = [_point(trade, i, level, runs) for level, runs in enumerate(levels) if runs]
        by_seed = [[r for runs in levels for r in runs if r.replicate == k]
                   for k in range(trade.plan.n_seeds)]
        seeds = [runs for runs in by_seed if runs]
        result.curves.append(_curve(trade, points, seeds) if points else Curve())
        result.points += points
    find_front(result.points)
    advise(trade)


# ---- at a time, for an error ----

def _between(xa: float, ya: float, xb: float, yb: float, at: float) -> float:
    """Log-log interpolation of y over x between a and b; a's y where one has no logarithm."""
    if not (xa > 0 and ya > 0 and yb > 0 and xb > xa):
        return ya
    return ya * (yb / ya) ** (math.log(at / xa) / math.log(xb / xa))


def error_at(trade: Trade, setting: int, seconds: float) -> tuple[float, bool]:
    """The error of a setting after so many seconds, and whether that is extrapolated.

    Between budgets it is interpolated. Beyond the longest one an unbiased method goes on by the
    root law, error ~ seconds^-1/2; a biased one has a floor that nobody has seen. NaN where nothing
    is known, as before the first pass.
    """
    points = trade.result.curves[setting].points
    if not points or seconds < points[0].seconds:
        return math.nan, False
    for a, b in zip(points, points[1:]):
        if seconds < b.seconds:
            return _between(a.seconds, a.error, b.seconds, b.error, seconds), False
    factor = seconds / points[-1].seconds if points[-1].seconds > 0 else math.inf
    beyond = factor > 1
    if factor > FARTHEST or (trade.plan.settings[setting].is_biased and beyond):
        return math.nan, beyond
    return points[-1].error / math.sqrt(factor), beyond


def seconds_to(trade: Trade, setting: int, error: float) -> tuple[float, bool]:
    """The seconds to an error > 0, and whether they are extrapolated, as by `error_at`."""
    points = trade.result.curves[setting].points
    if not points:
        return math.nan, False
    if points[0].error <= error:
        return points[0].seconds, False
    for a, b in zip(points, points[1:]):
        if b.error <= error:
            return _between(b.error, b.seconds, a.error, a.seconds, error), False
    factor = (points[-1].error / error) ** 2
    if factor > FARTHEST or trade.plan.settings[setting].is_biased:
        return math.nan, True
    return points[-1].seconds * factor, True


# ---- the best ----

def best_of(trade: Trade, integrator: Optional[str] = None) -> int:
    """The setting of an integrator with the least rank; of all that are unbiased without one. -1:
    none was measured."""
    best = -1
    curves = trade.result.curves
    for i, s in enumerate(trade.plan.settings):
        is_rival = s.integrator == integrator if integrator else not s.is_biased
        if not curves[i].points or not is_rival:
            continue
        if best < 0 or curves[i].rank < curves[best].rank:
            best = i
    return best


def heads(trade: Trade) -> list[int]:
    """The best of each integrator and the scene's own, as far as they were measured and the strip
    has places."""
    found = [i for i, s in enumerate(trade.plan.settings) if trade.result.curves[i].points
             and (s.is_scenes or best_of(trade, s.integrator) == i)]
    return found[:STRIP]


# ---- columns ----

def times(trade: Trade) -> list[float]:
    """Halves of the longest runs' time, ascending, as far as some setting has a picture by then."""
    longest = trade.plan.run_seconds
    least = min([longest] + [p.seconds for p in trade.result.points])
    halves = [longest * 2.0 ** (1 + i - COLUMNS) for i in range(COLUMNS)]
    return [at for at in halves if at >= least]


def errors(trade: Trade) -> list[float]:
    """Of 0.1%, 0.2%, 0.5%, ... those that some setting reaches with what was measured or a little
    more."""
    least = min([p.error for p in trade.result.points if p.noise > 0], default=math.inf)
    return [step for step in STEPS if step >= least / 4][:COLUMNS]
