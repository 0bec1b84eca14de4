# SPDX-License-Identifier: BSD-2-Clause
"""What does a pass cost with each setting, and what scatter does it leave?

The pilot renders each setting with 3072 pixels or so, fewer where these take too long.
"""
from __future__ import annotations

import math
from typing import Optional

from ..._errors import Error
from .. import text
from .model import Setting, Trade
from .plan import LEAST_PIXELS, SWEEP_SHARE, may_be_reference, set_size, too_few_seconds

PILOT_SHARE = 0.08  # of the time
QUICK_SHARE = 0.4  # where --quick stops looking at further settings
PROBE_PIXELS, PILOT_PIXELS, MOST_PASSES, FILL_PASSES = 48, 3072, 256, 4


class _Interrupted(Exception):
    """A render was interrupted: what it said is no measurement."""


def _seconds(t: Trade, s: Setting, step: int, passes: int, seed: int) -> tuple[float, float]:
    """Seconds of a render, and the relative RMSE that it estimates of itself."""
    picture = t.view.render(s, step, passes, seed)
    if picture is None:
        raise _Interrupted
    return picture.seconds, picture.error


def _probe(t: Trade, s: Setting, pixels: float) -> float:
    """What a pixel of a pass costs, by a film of so few pixels that the slowest setting is no long
    wait. What a pass costs whatever its size does not count. 0: below what the clock tells."""
    step = t.view.frame.step_for(pixels)
    seconds, _ = _seconds(t, s, step, 1, t.plan.seed)
    return max(0, seconds - s.fill_seconds) / t.view.frame.film(step).pixels


def _check_own(t: Trade, s: Setting, of_pixel: float) -> float:
    """The scene's own setting is always measured. If it takes more than the whole time, that is
    said at once. A second probe confirms it, because the machine may have had other work. Returns
    the seconds of a pixel."""
    plan, asked = t.plan, t.options
    if not s.is_scenes or not s.is_swept or asked.passes or asked.quick:
        return of_pixel
    set_size(plan, t.view.frame, t.view.frame.step_for(LEAST_PIXELS))
    passes = plan.n_seeds * t.view.frame.film(plan.step).pixels
    if passes * of_pixel <= SWEEP_SHARE * asked.seconds:
        return of_pixel
    of_pixel = _probe(t, s, 4 * PROBE_PIXELS)
    if passes * of_pixel > SWEEP_SHARE * asked.seconds:
        raise too_few_seconds(plan, asked, "the scene's own setting", passes * of_pixel, t.spent())
    return of_pixel


def _pilot_setting(t: Trade, s: Setting, seconds: float) -> None:
    """A probe, one pass to see what it costs, then as many as the setting's share of the time
    allows, 2 at least."""
    seed, frame = t.plan.seed, t.view.frame
    # what a single pixel takes
    s.fill_seconds = _seconds(t, s, 0, FILL_PASSES, seed)[0] / FILL_PASSES
    of_pixel = _check_own(t, s, _probe(t, s, PROBE_PIXELS))
    wanted: float = PILOT_PIXELS
    if not t.options.passes and of_pixel > 0:
        # So many that three passes fit into twice the setting's share of the time, but so many that
        # what a pass costs whatever its size is 1/16 of it, less than the pilot's scatter: it would
        # count as the pixels' else.
        wanted = min(wanted, max(PROBE_PIXELS, max(2 * seconds / 3,
                                                   16 * s.fill_seconds) / of_pixel))
    step = frame.step_for(wanted)
    pixels = frame.film(step).pixels
    first, _ = _seconds(t, s, step, 1, seed)
    s.pass_seconds, s.pass_relmse = first / pixels, math.nan
    passes = int(min(max(seconds / first, 2), MOST_PASSES))
    second, error = _seconds(t, s, step, passes, seed + 1)
    s.pass_seconds, s.pass_relmse = second / pixels / passes, error * error * passes


def _check_time(t: Trade, done: int, n: int) -> None:
    """A pilot that takes more than the time for everything is not waited for."""
    spent = t.spent()
    if not t.options.passes and spent >= t.options.seconds:
        raise Error("error: %g s are too few: the pilot alone, a look at each of %d settings, "
                    "wants about %s; give --time some times that, or name fewer integrators by "
                    "--integrator"
                    % (t.options.seconds, n, text.duration(spent / done * n)))


def _order(settings: list[Setting]) -> list[Setting]:
    """First the one of each integrator that a plan needs most: where --quick stops early, the
    others are left out."""
    first: dict[str, Setting] = {}
    for s in settings:
        first.setdefault(s.integrator, s)
    return sorted(settings, key=lambda s: (first[s.integrator] is not s, not s.is_scenes))


def _is_enough(t: Trade, looked: list[Setting]) -> bool:
    """Whether --quick has taken its part of the time, and advice can come from what it has seen."""
    if not t.options.quick or t.options.passes or t.spent() < QUICK_SHARE * t.options.seconds:
        return False
    judges = {k for k in range(2) for s in looked if may_be_reference(s, k)}
    needed = {s.judge for s in looked if s.is_swept}
    return (t.plan.is_given or needed <= judges) and any(s.is_swept and not s.is_biased
                                                         for s in looked)


def run_pilot(t: Trade) -> Optional[list[Setting]]:
    """Look at each setting of the plan: fill_seconds, pass_relmse, and pass_seconds of a pixel.

    Parameters
    ----------
    t : Trade
        With settings in its plan.

    Returns
    -------
    list of Setting or None
        Those that --quick had no time to look at; they are not swept. None: it was interrupted.

    Raises
    ------
    Error
        There is too little time.
    """
    piloted = [s for s in t.plan.settings if s.is_swept or may_be_reference(s, 0)
               or may_be_reference(s, 1)]
    n = len(piloted)
    if t.options.quick:
        piloted = _order(piloted)
    try:
        for done, s in enumerate(piloted):
            if t.interrupted():
                return None
            if done and _is_enough(t, piloted[:done]):
                left = piloted[done:]
                for other in left:
                    other.is_swept = False
                return [other for other in left]
            t.tell("pilot", done / n, math.nan)
            _pilot_setting(t, s, PILOT_SHARE * t.options.seconds / n)
            if done + 1 < n and not t.options.quick:
                _check_time(t, done + 1, n)
    except _Interrupted:
        return None
    return []
