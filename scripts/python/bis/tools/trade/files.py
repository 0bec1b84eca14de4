# SPDX-License-Identifier: BSD-2-Clause
"""runs.csv, written, and read back by --resume.

It is text that a user may look at, with numbers that read back as the same doubles. It is written
whole under a temporary name and renamed, so that after a crash there is the older one. What is read
is not trusted: a setting that the plan has not, or a number out of its range, is an error with its
line.
"""
from __future__ import annotations

import math
import os
import re
import sys
from typing import Any, Optional

from ..._errors import Error
from .. import text
from ..files import outfile
from .model import LEVELS, Plan, Run, Trade

HEADER = ("setting,passes,replicate,seed,seconds,camera_rays,shadow_rays,candidates,rmse,relmse,"
          "bias,relmse_both")
MOST_SEED = float(2 ** 53 - 1)
MOST_RAYS = 2.0 ** 63
MOST = sys.float_info.max

_NUMBER = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\Z", re.ASCII)


def number(field: str, lo: float, hi: float) -> float:
    """The number of a field, or NaN where none in [lo, hi] stands there.

    float() alone would take blanks, underscores and words, too.
    """
    value = float(field) if _NUMBER.match(field) else math.nan
    return value if lo <= value <= hi else math.nan


def whole(field: str, lo: float, hi: float) -> Optional[int]:
    """The whole number of a field, or None where none in [lo, hi] stands there."""
    value = number(field, lo, hi)
    return int(value) if value.is_integer() else None


def _wrong(column: str) -> Error:
    return Error(column)


def _count(fields: dict[str, str], column: str, lo: float, hi: float) -> int:
    value = whole(fields[column], lo, hi)
    if value is None:
        raise _wrong(column)
    return value


def _real(fields: dict[str, str], column: str, lo: float, hi: float) -> float:
    value = number(fields[column], lo, hi)
    if math.isnan(value):
        raise _wrong(column)
    return value


def _run(line: str, plan: Plan) -> Run:
    """The run of a line. An Error names the first column that holds no such thing."""
    names = HEADER.split(",")
    values = line.split(",")
    fields = dict(zip(names, values + [""] * len(names)))
    if len(values) > len(names):
        fields[names[-1]] = ",".join(values[len(names) - 1:])
    setting = plan.find(fields["setting"])
    if setting < 0 or not plan.settings[setting].is_swept:
        raise _wrong("setting")
    passes = _count(fields, "passes", 1, 1 << (LEVELS - 1))
    level = passes.bit_length() - 1
    if passes != 1 << level or level >= plan.settings[setting].levels:
        raise _wrong("passes")
    return Run(
        setting, level,
        replicate=_count(fields, "replicate", 1, plan.n_seeds) - 1,
        seed=_count(fields, "seed", 0, MOST_SEED),
        seconds=_real(fields, "seconds", 0, 1e12),
        camera_rays=_count(fields, "camera_rays", 0, MOST_RAYS),
        shadow_rays=_count(fields, "shadow_rays", 0, MOST_RAYS),
        candidates=_count(fields, "candidates", 0, MOST_RAYS),
        rmse=_real(fields, "rmse", 0, MOST),
        relmse=_real(fields, "relmse", 0, MOST),
        bias=_real(fields, "bias", -MOST, MOST),
        relmse_both=_real(fields, "relmse_both", 0, MOST))


def _path(trade: Trade) -> str:
    return "%s/runs.csv" % trade.options.folder


def read_runs(trade: Trade) -> None:
    """Read the runs of the folder into trade.runs. There is no file if it was interrupted before
    the first one. An Error names a line that is no run of the plan, or the second one of its place.
    """
    path = _path(trade)
    if not os.path.exists(path):
        return
    with open(path, encoding="utf-8", errors="surrogateescape", newline="\n") as f:
        lines = f.read().split("\n")
    if lines[0] != HEADER:
        raise Error('%s:1:1: error: the first line must be "%s"' % (path, HEADER))
    if lines[-1] == "":
        lines.pop()
    known = {(r.setting, r.level, r.replicate) for r in trade.runs}
    for i, line in enumerate(lines[1:], 2):
        try:
            run = _run(line, trade.plan)
        except Error as column:
            raise Error('%s:%d:1: error: "%s" is no run of plan.txt, by its %s; remove the '
                        'line and it is measured again' % (path, i, line, column)) from None
        place = run.setting, run.level, run.replicate
        if place in known:
            raise Error('%s:%d:1: error: "%s" is the second of its kind; remove one of them'
                        % (path, i, line))
        known.add(place)
        trade.runs.append(run)


def _fields(run: Run, plan: Plan) -> list[Any]:
    return [plan.settings[run.setting].name, 1 << run.level, run.replicate + 1, run.seed,
            run.seconds, run.camera_rays, run.shadow_rays, run.candidates, run.rmse, run.relmse,
            run.bias, run.relmse_both]


def write_runs(trade: Trade) -> None:
    """Sort the runs by setting, budget and seed, and write them."""
    trade.runs.sort(key=lambda r: (r.setting, r.level, r.replicate))
    lines = [HEADER] + [text.csv(*_fields(run, trade.plan)) for run in trade.runs]
    with outfile(_path(trade)) as out:
        out.write("".join(line + "\n" for line in lines).encode())
