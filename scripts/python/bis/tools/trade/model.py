# SPDX-License-Identifier: BSD-2-Clause
"""What a measurement is made of: settings, the plan, runs, references, pictures, the advice.

A sweep is a table of settings (integrator, M, N, proposal, b, ...) x budgets of 1, 2, 4, ... passes
x seeds. Each of these runs is a render of its own, the one that `bis render --spp --seed` would
make, compared with a reference that no method of its own family has made:

    pilot (what does a pass cost?) -> plan.txt -> references/ -> runs.csv, a line a run
        -> pictures/ -> tables, page

Everything that was measured is in the folder at once, so that a run can be interrupted and resumed
anywhere; what follows from the runs (means, slopes, the front, the page) is computed again from
runs.csv.
"""
from __future__ import annotations

import math
import time
from dataclasses import dataclass, field
from typing import Any, Callable, Optional

import numpy as np
from numpy.typing import NDArray

LEVELS = 21  #: budgets of 1 ... 2^20 passes
SEEDS = 16  #: at most
MOST_PASSES = 1 << 22  #: of a replicate of a reference: four times the longest budget
REPLICATES = 8  #: independent renders behind a reference: where its standard error comes from
ADVICE = 3  #: preview, good picture, final picture
STRIP = 8  #: pictures in the report

Image = NDArray[np.float32]  # (height, width, 3)


_WORD = (1 << 64) - 1


def hashed(x: int) -> int:
    """Mix 64 bits into 64 bits, as bis_hash does."""
    x &= _WORD
    x ^= x >> 30
    x = x * 0xbf58476d1ce4e5b9 & _WORD
    x ^= x >> 27
    x = x * 0x94d049bb133111eb & _WORD
    return x ^ (x >> 31)


@dataclass
class Setting:
    """One way to render: an integrator, its parameters, and b of the map's importance."""

    name: str  #: "sir 256/16", without a comma: the key in all files
    integrator: str
    #: the parameters that the integrator reads, as bis.Scene.render takes them
    values: dict[str, Any]
    area_exponent: float  #: b
    is_biased: bool = False  #: by its claim
    is_scenes: bool = False  #: the scene's own setting
    is_swept: bool = True  #: else only a candidate for the reference
    #: the reference that judges it: 0, by mis, or 1, by sir; never one of its own family
    judge: int = 0
    #: "--integrator sir --candidates 256 ...", "" where the options cannot say it
    option_text: str = ""
    scene_text: str = ""  #: 'Integrator "sir" "integer candidates" 256 ...'
    pass_seconds: float = 0  #: of one pass of the sweep's size, from the pilot
    fill_seconds: float = 0  #: of these, what a pass of any size takes: pools, clusters
    #: estimated by the pilot from the scatter of passes; NaN: not known
    pass_relmse: float = math.nan
    levels: int = 0  #: budgets 1 ... 2^(levels-1) passes; 0: one pass is too slow for this plan


@dataclass
class Plan:
    """What is measured, for how long, and by which references."""

    settings: list[Setting] = field(default_factory=list)
    fingerprint: int = 0  #: of the scene's text
    full_width: int = 0  #: as the scene asks for
    full_height: int = 0
    step: int = 0  #: of each step x step pixels one is measured
    width: int = 0  #: of the thin film, as if it had no crop
    height: int = 0
    n_seeds: int = 0
    seed: int = 1
    run_seconds: float = 0  #: of the longest runs: the time of the equal-time pictures
    #: settings, a mis and a sir; -1: none is needed
    reference: list[int] = field(default_factory=lambda: [-1, -1])
    reference_passes: list[int] = field(default_factory=lambda: [0, 0])  #: of each replicate
    is_given: bool = False  #: --reference: references/given.exr

    def find(self, name: str) -> int:
        """The index of the setting with this name, or -1."""
        for i, s in enumerate(self.settings):
            if s.name == name:
                return i
        return -1

    def planned_runs(self) -> int:
        """How many runs the sweep has."""
        return sum(s.levels for s in self.settings) * self.n_seeds

    def planned_seconds(self, setting: int, level: int) -> float:
        """What one of them takes."""
        return self.settings[setting].pass_seconds * 2.0 ** level


@dataclass
class Run:
    """One render of the sweep, and its error."""

    setting: int  #: index in plan.settings
    level: int  #: 2^level passes
    replicate: int  #: from 0
    seed: int
    seconds: float
    camera_rays: int
    shadow_rays: int
    candidates: int
    rmse: float  #: these three of bis.compare, with the reference by another method
    relmse: float
    bias: float
    relmse_both: float  #: and with the mean of both


@dataclass
class Reference:
    """What runs are compared with."""

    image: Optional[Image] = None  #: None: it is not ready
    relmse: float = 0  #: what its own noise adds to anyone's relMSE; 0 where given: not known
    mean: float = 0  #: over the picture
    se: float = 0  #: of the mean, from the replicates; 0 where given

    @property
    def is_ready(self) -> bool:
        return self.image is not None


@dataclass
class Shot:
    """A picture of the equal-time strips."""

    setting: int
    passes: int
    seconds: float
    relmse: float
    image: Image


@dataclass
class Advice:
    """What to use for an error."""

    purpose: str
    error: float
    setting: int = -1  #: -1: nothing was measured
    passes: int = 0
    seconds: float = 0  #: expected for the full picture
    expected_error: float = 0
    is_extrapolated: bool = False  #: it was measured with another number of passes


@dataclass
class Options:
    """What is asked of a measurement."""

    scene: str
    folder: str
    seconds: float  #: of everything
    reference: Optional[str] = None  #: a file
    error: float = 0  #: relative RMSE to reach; 0: none asked for
    quick: bool = False
    resume: bool = False
    approximate: bool = False
    #: width and height of the full picture; None: the scene's
    size: Optional[tuple[int, int]] = None
    n_seeds: int = 0  #: 0: by the time
    passes: int = 0  #: the largest budget of every setting; 0: by the time
    seed: int = 1
    threads: int = 0  #: 0: all
    integrators: list[str] = field(default_factory=list)  #: the only ones to sweep; empty: all


#: What is done, the share of it that is done, the seconds that are left; the last two may be NaN.
Progress = Callable[[str, float, float], None]


@dataclass
class Trade:
    """A measurement: what was asked, planned and measured. What follows from that is in
    `result`."""

    options: Options
    plan: Plan = field(default_factory=Plan)
    runs: list[Run] = field(default_factory=list)
    #: by mis, by sir
    references: list[Reference] = field(default_factory=lambda: [Reference(), Reference()])
    both: Reference = field(default_factory=Reference)  #: their mean; its se is not known
    strip: list[Shot] = field(default_factory=list)
    result: Any = None  #: stats.Result
    stratified: bool = True  #: the scene's sampler: whether square numbers of passes are better
    threads: int = 0  #: as used
    nonfinite: int = 0
    is_complete: bool = False  #: every run of the plan was measured
    is_reported: bool = False  #: tables and page agree with runs
    view: Any = None  #: view.View: the scene, which renders
    start: float = field(default_factory=time.monotonic)
    progress: Optional[Progress] = None
    is_interrupted: Callable[[], bool] = lambda: False

    def spent(self) -> float:
        """Seconds since the measurement began."""
        return time.monotonic() - self.start

    def interrupted(self) -> bool:
        """Whether the user has interrupted the measurement."""
        return self.is_interrupted()

    def tell(self, what: str, share: float, seconds_left: float) -> None:
        """Tell how far the measurement is, if somebody looks on."""
        if self.progress:
            self.progress(what, share, seconds_left)

    def seed_of(self, purpose: int, place: int) -> int:
        """The seed of a render: other purposes and places have others; 53 bits, as --seed takes."""
        return hashed(hashed(self.plan.seed + purpose) + place) >> 11

    def find_run(self, setting: int, level: int, replicate: int) -> Optional[Run]:
        """The run of this place, or None."""
        for r in self.runs:
            if (r.setting, r.level, r.replicate) == (setting, level, replicate):
                return r
        return None
