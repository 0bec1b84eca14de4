# SPDX-License-Identifier: BSD-2-Clause
"""runs.csv, written, and read back by --resume.

It is text that a user may look at, with numbers that read back as the same doubles. It is written
whole under a temporary name and renamed, so that after a crash there is the older one. What is read
is not trusted: a setting that the plan has not, or a number out of its range, is an error with its
line.
"""
from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable
from typing import Any, Callable

from ..._errors import Error
from .. import text
from ..files import outfile
from .model import LEVELS, Plan, Run, Trade

HEADER = ("setting,passes,replicate,seed,seconds,camera_rays,shadow_rays,candidates,rmse,relmse,"
          "bias,relmse_both")
MOST_SEED = 2 ** 53 - 1
MOST = sys.float_info.max

_NUMBER = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?")


def real(field: str, lo: float, hi: float) -> float:
    """The number of a field; a ValueError where none in [lo, hi] stands there.

    float() alone would take blanks, underscores and words, too.
    """
    if not _NUMBER.fullmatch(field) or not lo <= float(field) <= hi:
        raise ValueError
    return float(field)


def count(field: str, lo: float, hi: float) -> int:
    """The whole number of a field; a ValueError where none in [lo, hi] stands there."""
    value = real(field, lo, hi)
    if not value.is_integer():
        raise ValueError
    return int(value)


# What stands in the columns of numbers behind `replicate`.
_COLUMNS: dict[str, tuple[Callable[[str, float, float], float], float, float]] = {
    "seed": (count, 0, MOST_SEED), "seconds": (real, 0, 1e12),
    "camera_rays": (count, 0, 2.0 ** 63), "shadow_rays": (count, 0, 2.0 ** 63),
    "candidates": (count, 0, 2.0 ** 63), "rmse": (real, 0, MOST), "relmse": (real, 0, MOST),
    "bias": (real, -MOST, MOST), "relmse_both": (real, 0, MOST)}


class _Refused(Exception):
    """A column that holds something else than it should."""


def _run(line: str, plan: Plan) -> Run:
    """The run of a line. What is refused is the first column that holds no such thing."""
    names = HEADER.split(",")
    values = line.split(",", len(names) - 1)
    fields = dict(zip(names, values + [""] * len(names)))
    setting = plan.find(fields["setting"])
    if setting < 0 or not plan.settings[setting].is_swept:
        raise _Refused("setting")
    column = "passes"
    try:
        passes = count(fields[column], 1, 1 << (LEVELS - 1))
        level = passes.bit_length() - 1
        if passes != 1 << level or level >= plan.settings[setting].levels:
            raise ValueError
        column = "replicate"
        replicate = count(fields[column], 1, plan.n_seeds) - 1
        numbers: dict[str, Any] = {}
        for column, (kind, lo, hi) in _COLUMNS.items():
            numbers[column] = kind(fields[column], lo, hi)
    except ValueError:
        raise _Refused(column) from None
    return Run(setting, level, replicate, **numbers)


def write_lines(trade: Trade, name: str, lines: Iterable[str]) -> None:
    """Write a file of the measurement's folder."""
    with outfile("%s/%s" % (trade.options.folder, name)) as out:
        out.write("".join(line + "\n" for line in lines).encode())


def read_runs(trade: Trade) -> None:
    """Read the runs of the folder into trade.runs. There is no file if it was interrupted before
    the first one. An Error names a line that is no run of the plan, or the second one of its place.
    """
    path = "%s/runs.csv" % trade.options.folder
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
        except _Refused as column:
            raise Error('%s:%d:1: error: "%s" is no run of plan.txt, by its %s; remove the '
                        'line and it is measured again' % (path, i, line, column)) from None
        place = run.setting, run.level, run.replicate
        if place in known:
            raise Error('%s:%d:1: error: "%s" is the second of its kind; remove one of them'
                        % (path, i, line))
        known.add(place)
        trade.runs.append(run)


def write_runs(trade: Trade) -> None:
    """Sort the runs by setting, budget and seed, and write them."""
    trade.runs.sort(key=lambda r: (r.setting, r.level, r.replicate))
    settings = trade.plan.settings
    write_lines(trade, "runs.csv", [HEADER] + [
        text.csv(settings[r.setting].name, 1 << r.level, r.replicate + 1,
                 *(getattr(r, column) for column in _COLUMNS)) for r in trade.runs])
