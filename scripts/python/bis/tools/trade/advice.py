# SPDX-License-Identifier: BSD-2-Clause
"""What to use: three recommendations.

Passes are counted, since a render has whole ones, on a square grid: the fewest that reach the error
by cost x variance, of whatever setting needs the least time for them, standard error added, in the
full picture. Half of a pixel's value will do for a preview, and 5% for the eye.
"""
from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from .model import Advice, Trade
from .stats import best_of

MOST_PASSES = 10 ** 9
FINAL = 0.05  #: the error of a final picture, if none is asked for
PURPOSES = (("preview", 0.5), ("good picture", 0.15), ("final picture", 0.0))


def square_passes(trade: Trade, least: float) -> int:
    """The least number of passes >= least, in [1, 1e9], that the scene's sampler uses well.

    A stratified one divides the pixel into the most square grid of so many cells: n x n and n x (n
    + 1) are good. 13 = 1 x 13 leaves twice the relMSE of 12 = 3 x 4 where a picture has many edges.
    """
    n = math.ceil(min(max(least, 1.0), float(MOST_PASSES)))
    if not trade.stratified:
        return n
    side = math.ceil(math.sqrt(n))
    return side * (side - 1) if side * (side - 1) >= n else side * side


def _full_pass_seconds(trade: Trade, setting: int) -> float:
    """Of a pass of the full picture: what any pass takes, and the rest in proportion to the
    pixels."""
    plan = trade.plan
    pixels = float(plan.full_width) * plan.full_height / (float(plan.width) * plan.height)
    one = trade.result.curves[setting].pass_seconds
    fill = min(plan.settings[setting].fill_seconds, one)
    return fill + (one - fill) * pixels


def _advice_of(trade: Trade, setting: int, purpose: str, error: float) -> Advice:
    """The least time in which a setting has the error, in whole passes.

    Cost x variance is what an error costs, whatever the budget.
    """
    curve = trade.result.curves[setting]
    if not curve.pass_seconds > 0:  # the clock did not tick: nothing tells how long it takes
        return Advice(purpose, error)
    variance = max(0.0, curve.cost_variance) / curve.pass_seconds
    least = variance / (error * error)
    if not least < MOST_PASSES:
        return Advice(purpose, error)
    passes = square_passes(trade, least)
    return Advice(purpose, error, setting, passes,
                  seconds=passes * _full_pass_seconds(trade, setting),
                  expected_error=math.sqrt(variance / passes),
                  is_extrapolated=passes > curve.points[-1].passes)


def _advise_for(trade: Trade, purpose: str, error: float) -> Advice:
    best = Advice(purpose, error)
    least = math.inf
    for i, curve in enumerate(trade.result.curves):
        if not curve.points or trade.plan.settings[i].is_biased:
            continue
        one = _advice_of(trade, i, purpose, error)
        doubt = curve.rank / curve.cost_variance if curve.cost_variance > 0 else 1.0
        if one.setting >= 0 and one.seconds * doubt < least:
            best = one
            least = one.seconds * doubt
    return best


def advise(trade: Trade) -> None:
    """Make the advice by the curves alone. Its seconds are those of the sweep's film, times the
    pixels."""
    final = trade.options.error if trade.options.error > 0 else FINAL
    trade.result.best = best_of(trade)
    trade.result.advice = [_advise_for(trade, purpose, max(error, final))
                           for purpose, error in PURPOSES]


def take_cheapest(advice: Sequence[Advice]) -> list[Advice]:
    """Replace each by the one for another error that keeps this error, too, in less time.

    A check by renders may find that. One that was measured is not replaced by one that was not.
    """
    result = list(advice)
    for i, wanted in enumerate(result):
        best = wanted
        for other in result:
            is_cheaper = (other.seconds, other.expected_error) < (best.seconds, best.expected_error)
            keeps_it = other.expected_error <= wanted.error
            is_as_sure = best.is_extrapolated or not other.is_extrapolated
            if best.setting >= 0 and other.setting >= 0 and is_cheaper and keeps_it and is_as_sure:
                best = other
        result[i] = replace(best, purpose=wanted.purpose, error=wanted.error)
    return result
