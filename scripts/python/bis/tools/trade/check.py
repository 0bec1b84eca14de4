# SPDX-License-Identifier: BSD-2-Clause
"""What error does the advised number of passes really leave?

The advice comes from the mean cost x variance of a curve's budgets, most of them far shorter than
what is advised. The root law that leads from there to the advice is that of independent samples. A
stratified camera does better: at an edge the error falls faster, and what the short budgets say is
too much. So the advised setting is rendered with the advised passes, in the pixels of the sweep,
with seeds of its own: twice, and more often while there is time. The scatter of these renders is
the error, since only unbiased settings are advised. (Their distance from the references is not
used: these are often noisier than what is advised, and what was left after their share had been
subtracted was up to half too large on scene.txt.) relMSE divides by the square of the right pixel,
which nobody has. A noisy stand-in is too dark in most pixels, and what is divided by its square
comes out too large: twice the error with a reference of 4 passes. So it is the mean of the
references and these renders, weighted by 1/variance.

A pixel at an outline may see a lamp with one camera ray of many. A render that meets it may have
three times the error that most have. What is promised is what half of the pictures have at most.
What a picture meets with probability 1/2 is met log 2 times in the mean, and r log 2 times by
renders with as many pixels as r pictures. So the worst r log 2 pixels, rounded down, are left out:
one of 8 renders of a quarter of the pixels, none if r < 1.45.

The scatter says how many passes are right. When these are others by more than CLOSE_ENOUGH, they
are rendered in turn. Where two such renders take too long, they get the passes that there is time
for, and the rest is a law's, which is said: the relMSE of n passes falls as n^-p. Noise falls as
1/n, the error at edges as n^-3/2 (src/render/film_error.c), so p is in [1, 3/2], and two measured
numbers of passes tell it. The first one is an eighth, rendered four times, so that it takes a
quarter of the time. (The root law, p = 1, promised 5 % where 4 % came out: fine checks, from some
10 passes to 33.) Time that one advice does not need is the next one's. With --passes, which asks
for no clock, there are eight renders, or so many that all together have at most 64 times the passes
of the longest budget, two at least, of that many passes at most, however long they take.
"""
from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import NamedTuple, Optional

import numpy as np
from numpy.typing import NDArray

from .advice import square_passes, take_cheapest
from .model import Advice, Image, Reference, Trade
from .references import in_order

LEAST_RENDERS, FIRST_RENDERS, MOST_RENDERS = 2, 4, 8
MOST_TURNS, MOST_BUDGETS = 6, 64
CHECK_SHARE = 0.03  # of the time, for each advice
CLOSE_ENOUGH = 1.15  # in passes: 7 % in error
FIRST_SHARE = 0.125  # of the passes that there is time for, if the advice has more
NOISE_FALLS, EDGES_FALL = 1.0, 1.5  # p

Doubles = NDArray[np.float64]


# ---- the scatter of renders ----


def _scatter(mean: Doubles, variance: Doubles, spared: int, reference: Doubles, w: float) -> float:
    """b = w reference + (1 - w) mean of the renders."""
    b = w * reference + (1 - w) * mean
    m = in_order(b / b.size)
    with np.errstate(invalid="ignore", divide="ignore"):
        error = np.where(variance > 0, variance / (b * b + m * m / 100), 0).sum(axis=2).ravel()
    if spared:
        error = np.sort(error)[:max(len(error) - spared, 0)]
    return in_order(error) / b.size if len(error) else 0.0


def scatter(images: list[Image], spared: int, reference: Reference) -> float:
    """Return the relMSE of one of several renders that differ in their seeds alone.

    Parameters
    ----------
    images : list of arrays (h, w, 3)
        At least two.
    spared : int
        So many pixels of the largest errors count as 0.
    reference : Reference
        Of the same size. With relmse = 0 it is trusted alone.

    Returns
    -------
    float
        In each pixel and channel the variance of the renders (over n - 1) is divided by b^2 +
        m^2/100, as `bis.compare` does. b is the mean of the reference and of the renders, weighted
        by 1/variance, and m is the mean of b. What noise is left in b makes the result biased, by
        terms of the order of b's own relMSE.
    """
    n = len(images)
    assert reference.image is not None
    renders = np.stack([image.astype(np.float64) for image in images])
    mean = renders.sum(axis=0) / n
    variance = ((renders - mean) ** 2).sum(axis=0) / (n - 1)
    right = reference.image.astype(np.float64)
    of_mean = _scatter(mean, variance, 0, right, 0) / n
    w = of_mean / (of_mean + reference.relmse) if of_mean > 0 else 1
    return _scatter(mean, variance, spared, right, w)


# ---- one advice ----


class _Measured(NamedTuple):
    """What so many passes leave; 0: none were measured."""

    passes: int = 0
    relmse: float = 0


@dataclass
class _Check:
    """The check of one advice, under way."""

    t: Trade
    place: int  # of the advice
    advice: Advice
    end: float  # on time.monotonic's clock
    turn_end: float = 0
    turn: int = 0
    is_short: bool = False  # fewer passes than the advice has
    too_few: int = 0  # passes that left more than the error; 0: none was measured
    first: _Measured = _Measured()
    now: _Measured = _Measured()
    enough: _Measured = _Measured()

    def left(self) -> float:
        """Seconds."""
        return self.end - time.monotonic()

    def goes_on(self, n: int, each: float) -> bool:
        """Is there time for one more render after n of them? A turn leaves half of the time to the
        next ones."""
        passes = self.t.options.passes
        if self.t.interrupted() or n == MOST_RENDERS:
            return False
        if n < LEAST_RENDERS:
            return True
        if self.is_short and n == (LEAST_RENDERS if self.turn else FIRST_RENDERS):
            return False
        if passes:
            return (n + 1) * self.now.passes <= MOST_BUDGETS * passes
        return self.turn_end - time.monotonic() > each

    def measure(self, passes: int, a_pass: float) -> Optional[float]:
        """The scatter of renders of so many passes; None: fewer than two were complete."""
        t, images = self.t, []
        while self.goes_on(len(images), passes * a_pass):
            place = (self.place * MOST_TURNS + self.turn) * MOST_RENDERS + len(images)
            picture = t.view.render(t.plan.settings[self.advice.setting], t.plan.step, passes,
                                    t.seed_of(3, place))
            if picture is None:
                break
            images.append(picture.rgb)
        if len(images) < LEAST_RENDERS:
            return None
        frame = t.view.frame
        pictures = len(images) * frame.film(t.plan.step).pixels / frame.film(1).pixels
        spared = int(math.log(2) * pictures)
        return scatter(images, spared, t.both)

    def exponent(self) -> float:
        """p by two points; that of noise if they do not tell."""
        a, b = self.first, self.now
        if not a.passes or a.passes == b.passes:
            return NOISE_FALLS
        p = math.log(a.relmse / b.relmse) / math.log(b.passes / a.passes)
        return min(max(p, NOISE_FALLS), EDGES_FALL)

    def passes_of(self, most: float) -> int:
        """The passes of the next renders: the advice's, or as many as there is time for."""
        if self.advice.passes <= most:
            return self.advice.passes
        return square_passes(self.t, max(1, most / CLOSE_ENOUGH if self.turn
                                         else most * FIRST_SHARE))

    def take(self, passes: int) -> None:
        """Put what was measured into the advice."""
        a, p = self.advice, self.exponent()
        needed = square_passes(self.t, passes * (self.now.relmse / (a.error * a.error)) ** (1 / p))
        if self.turn == 0:
            self.first = self.now
        if needed > passes:
            self.too_few = passes
        else:
            self.enough = self.now
        by = self.now  # what tells the error of `needed`
        if needed <= self.too_few or (self.enough.passes and needed > self.enough.passes):
            # one measured number says that another, measured before, will do, or will not
            needed, by = self.enough.passes, self.enough
        a.passes = needed
        a.expected_error = math.sqrt(by.relmse * (by.passes / needed) ** p)
        a.is_extrapolated = needed != self.enough.passes and (
            needed > CLOSE_ENOUGH * passes or passes > CLOSE_ENOUGH * needed)

    def run(self) -> None:
        """Measure turn by turn until the advice has the passes that were measured."""
        t, a = self.t, self.advice
        a_pass, full_pass = t.result.curves[a.setting].pass_seconds, a.seconds / a.passes
        while self.turn < MOST_TURNS and (self.turn == 0 or t.options.passes or self.left() > 0):
            most = (MOST_BUDGETS * t.options.passes if t.options.passes
                    else self.left() / (LEAST_RENDERS * a_pass))
            passes = self.passes_of(most)
            self.is_short = passes < a.passes
            self.turn_end = self.end - self.left() / 2
            if self.is_short and passes <= self.now.passes:
                break  # there is no time for more
            self.now = _Measured(passes)
            relmse = self.measure(passes, a_pass)
            if not relmse:
                break  # interrupted, or without noise: the curve's word stands
            self.now = _Measured(passes, relmse)
            self.take(passes)
            if not a.is_extrapolated:
                break
            self.turn += 1
        a.seconds = a.passes * full_pass


def check_advice(t: Trade) -> None:
    """Replace the advice's passes and errors by such as were measured with that many passes, as far
    as there is time.

    Parameters
    ----------
    t : Trade
        With its result.
    """
    start, share = time.monotonic(), CHECK_SHARE * t.options.seconds
    advice = t.result.advice
    for i, a in enumerate(advice):
        if a.setting < 0 or t.interrupted():
            continue
        t.tell("error of the advice", i / len(advice), share * (len(advice) - i))
        _Check(t, i, a, start + share * (i + 1)).run()
    t.result.advice = take_cheapest(advice)
