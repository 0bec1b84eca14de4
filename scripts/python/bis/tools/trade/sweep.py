# SPDX-License-Identifier: BSD-2-Clause
"""The runs of a sweep.

They are made in rounds: all settings at one budget with one seed, then the next seed, then the next
budget. What else the machine does meanwhile then hits all settings alike, and a sweep that ends
early, by Ctrl-C or because the time is used up, has measured all of them equally far. Each run has
a seed of its own, written beside it: no two settings share noise.
"""
from __future__ import annotations

import time
from typing import Optional

from ..._image import compare
from . import files
from .model import LEVELS, SEEDS, Run, Trade

PICTURES_SHARE = 0.2  # of the time, kept back for the advice, the pictures and the page
_SECONDS_BETWEEN_WRITES = 1


def _measure_run(t: Trade, setting: int, level: int, replicate: int) -> Optional[Run]:
    """None: it was interrupted."""
    s = t.plan.settings[setting]
    seed = t.seed_of(1, (setting * LEVELS + level) * SEEDS + replicate)
    picture = t.view.render(s, t.plan.step, 1 << level, seed)
    if picture is None:
        return None
    judge, both = t.references[s.judge].image, t.both.image
    assert judge is not None and both is not None
    c = compare(picture.rgb, judge)
    return Run(setting, level, replicate, seed, picture.seconds, picture.camera_rays,
               picture.shadow_rays,
               picture.candidates, c.rmse, c.relmse, c.bias, compare(picture.rgb, both).relmse)


def planned_left(t: Trade) -> float:
    """Seconds of the runs that are still to be made, as planned."""
    plan = t.plan
    every = sum(plan.n_seeds * plan.planned_seconds(i, level)
                for i, s in enumerate(plan.settings) for level in range(s.levels))
    return max(every - sum(plan.planned_seconds(r.setting, r.level) for r in t.runs), 0)


class _Sweep:
    """A sweep under way."""

    def __init__(self, t: Trade) -> None:
        self.t = t
        self.start = self.last_write = time.monotonic()
        # seconds of what is missing: at the start, and now
        self.planned = self.left = planned_left(t)
        self.known = {(r.setting, r.level, r.replicate) for r in t.runs}
        self.has_advice = any(not t.plan.settings[r.setting].is_biased for r in t.runs)

    def tell(self) -> None:
        """Time left from what the plan thought and what it took so far."""
        t, done = self.t, self.planned - self.left
        spent = time.monotonic() - self.start
        t.tell("run %d of %d" % (len(t.runs) + 1, t.plan.planned_runs()),
               done / self.planned if self.planned > 0 else 1, self.left * spent / done if done > 0
               else self.left)

    def is_over(self, seconds: float) -> bool:
        """Whether there is no time for a run that takes so long. --quick has one run at least that
        gives advice."""
        t = self.t
        if t.options.passes or (t.options.quick and not self.has_advice):
            return False
        return t.spent() + seconds > t.options.seconds * (1 - PICTURES_SHARE)

    def round(self, level: int, replicate: int) -> bool:
        """The runs of one round that are not there yet. Returns whether the sweep goes on."""
        t = self.t
        for i, s in enumerate(t.plan.settings):
            if level >= s.levels or (i, level, replicate) in self.known:
                continue
            seconds = t.plan.planned_seconds(i, level)
            if self.is_over(seconds):
                return False
            self.tell()
            run = _measure_run(t, i, level, replicate)
            if run is None:
                return False
            t.runs.append(run)
            self.left = max(self.left - seconds, 0)
            self.has_advice = self.has_advice or not s.is_biased
            if time.monotonic() - self.last_write >= _SECONDS_BETWEEN_WRITES:
                self.last_write = time.monotonic()
                files.write_runs(t)
        return not t.interrupted()


def run_sweep(t: Trade) -> None:
    """Measure the runs that are not in t.runs, as far as there is time, and write runs.csv.

    Parameters
    ----------
    t : Trade
        With plan and references.

    Raises
    ------
    Error
        A render failed, or runs.csv cannot be written.
    """
    sweep = _Sweep(t)
    try:
        goes_on = not t.interrupted()
        for level in range(LEVELS):
            for replicate in range(t.plan.n_seeds):
                goes_on = goes_on and sweep.round(level, replicate)
    finally:
        files.write_runs(t)  # what was measured, whatever happened
    t.is_complete = len(t.runs) == t.plan.planned_runs()
