# SPDX-License-Identifier: BSD-2-Clause
"""plan.txt, which a measurement is resumed by.

It is text that a user may look at, with numbers that read back as the same doubles. What is read is
not trusted: a name that the table has not, or a number out of range, is an error with its line. A
plan belongs to one text of one scene and to one version of bis, which its fingerprint tells.
"""
from __future__ import annotations

import math
import os
import re
import sys
from typing import Callable, Optional

import numpy as np

from ..._errors import Error
from ..._library import flat
from .. import text
from ..files import outfile
from .files import MOST_SEED, count, real
from .model import LEVELS, MOST_PASSES, SEEDS, Plan
from .plan import MOST_PIXELS, Frame, may_be_reference, thinned

_LEAST = 5e-324  # above 0
_MOST_SIDE = 32768
_DAMAGED = "the file is damaged, measure into a new folder"


def fingerprint(version: str, names: list[str], files: list[str]) -> int:
    """Return the hash (FNV-1a, 64 bits) of all that a plan belongs to: the version of bis, the
    names of the settings, the files of the scene's text. Meshes and maps are not looked into."""
    state = np.zeros(2, np.uint32)
    parts = [os.fsencode(word) for word in [version, *names]]
    for path in files:
        with open(path, "rb") as f:
            parts.append(f.read())
    for part in parts:
        flat.fnv(state.ctypes.data, len(part), part)
    return int(state[1]) << 32 | int(state[0])


# ---- writing ----

def plan_text(plan: Plan) -> str:
    """Return plan.txt."""
    lines = ["fingerprint %016x" % plan.fingerprint,
             "full %d %d" % (plan.full_width, plan.full_height), "step %d" % plan.step,
             "size %d %d" % (plan.width, plan.height), "seeds %d" % plan.n_seeds,
             "seed %d" % plan.seed, "run_seconds " + text.digits(plan.run_seconds),
             "given %d" % plan.is_given]
    for k, i in enumerate(plan.reference):
        if i >= 0:
            lines.append("reference %d %d %s" % (k, plan.reference_passes[k],
                                                 plan.settings[i].name))
    for s in plan.settings:
        if s.is_swept:
            seconds = [text.digits(v) for v in (s.pass_seconds, s.fill_seconds, s.pass_relmse)]
            lines.append("setting %d %s %s" % (s.levels, " ".join(seconds), s.name))
    return "\n".join(lines) + "\n"


def write_plan(folder: str, plan: Plan) -> None:
    """Write plan.txt into a folder."""
    with outfile(os.path.join(folder, "plan.txt")) as f:
        f.write(os.fsencode(plan_text(plan)))


# ---- reading ----

def _sides(fields: list[str]) -> tuple[int, int]:
    width, height = fields
    return count(width, 1, _MOST_SIDE), count(height, 1, _MOST_SIDE)


def _read_reference(plan: Plan, which: str, passes: str, name: str) -> None:
    k, i = count(which, 0, 1), plan.find(name)
    if plan.reference[k] >= 0 or i < 0 or not may_be_reference(plan.settings[i], k):
        raise ValueError
    plan.reference[k], plan.reference_passes[k] = i, count(passes, 1, MOST_PASSES)


def _read_setting(plan: Plan, levels: str, seconds: str, fill: str, relmse: str, name: str) -> None:
    i = plan.find(name)
    if i < 0 or plan.settings[i].is_swept:
        raise ValueError
    s = plan.settings[i]
    s.levels = count(levels, 0, LEVELS)
    s.pass_seconds, s.fill_seconds = real(seconds, _LEAST, 1e9), real(fill, 0, 1e9)
    s.pass_relmse = math.nan if relmse in ("nan", "-nan") else real(relmse, 0, sys.float_info.max)
    s.is_swept = True


# The lines of a plan: how many fields, and what must stand in them. All but the last two stand
# once.
_LINES = {
    "fingerprint": (1, "16 digits 0-9, a-f"),
    "full": (2, "width and height in pixels, from 1 to 32768"),
    "step": (1, "a number from 1 to 32768"),
    "size": (2, 'width and height in pixels, those of "full" divided by "step", which stand '
                'before'),
    "seeds": (1, "a number from 1 to 16"),
    "seed": (1, "a whole number from 0 to 2^53 - 1"),
    "run_seconds": (1, "a number above 0, at most 1e9"),
    "given": (1, "0 or 1"),
    "reference": (3, "0 (by a mis) or 1 (by a sir), each once, passes from 1 to 4194304, and the "
                     "name of a setting that may be one"),
    "setting": (5, "levels from 0 to 21, seconds of a pass above 0, of its fill, relMSE of a pass, "
                   "and the name of a setting, once"),
}


# Lines of one number: the member of the plan, and what it is.
_NUMBERS: dict[str, tuple[str, Callable[[str, float, float], float], float, float]] = {
    "step": ("step", count, 1, _MOST_SIDE), "seeds": ("n_seeds", count, 1, SEEDS),
    "seed": ("seed", count, 0, MOST_SEED), "run_seconds": ("run_seconds", real, _LEAST, 1e9),
    "given": ("is_given", lambda *field: count(*field) == 1, 0, 1)}


def _read_fields(plan: Plan, word: str, fields: list[str]) -> None:
    if word == "fingerprint":
        if not re.fullmatch("[0-9a-f]{16}", fields[0]):
            raise ValueError
        plan.fingerprint = int(fields[0], 16)
    elif word == "full":
        plan.full_width, plan.full_height = _sides(fields)
    elif word == "size":
        plan.width, plan.height = _sides(fields)
        step = max(plan.step, 1)
        size = thinned(plan.full_width, step), thinned(plan.full_height, step)
        if plan.step < 1 or (plan.width, plan.height) != size:
            raise ValueError
    elif word in _NUMBERS:
        name, kind, lo, hi = _NUMBERS[word]
        setattr(plan, name, kind(fields[0], lo, hi))
    else:
        (_read_reference if word == "reference" else _read_setting)(plan, *fields)


def _read_line(plan: Plan, line: str, seen: set[str]) -> Optional[str]:
    """What is wrong with a line, or None."""
    word, _, rest = line.partition(" ")
    if word not in _LINES:
        return '"%s" is no line of a plan; %s' % (line, _DAMAGED)
    if word in seen and word not in ("reference", "setting"):
        return '"%s" is the second line of its kind; %s' % (line, _DAMAGED)
    seen.add(word)
    n, rule = _LINES[word]
    fields = rest.split(" ", n - 1)
    try:
        if len(fields) < n:
            raise ValueError
        _read_fields(plan, word, fields)
    except ValueError:
        return '"%s": behind "%s" must stand %s; %s' % (line, word, rule, _DAMAGED)
    return None


def _check(plan: Plan, crop: tuple[float, float, float, float], seen: set[str]) -> Optional[str]:
    """What is missing in a plan, or None. It has no more pixels than a plan has."""
    for word in _LINES:
        if word not in seen and word != "reference":
            return 'a plan has a line "%s", and this one has none; %s' % (word, _DAMAGED)
    film = Frame(plan.full_width, plan.full_height, crop).film(plan.step)
    if film.width < 1 or film.height < 1 or film.pixels > 4 * MOST_PIXELS:
        return ('by "full" and "step" %d x %d pixels are to be measured, must be at least 1 and at '
                'most %d; %s'
                % (film.width, film.height, 4 * MOST_PIXELS, _DAMAGED))
    for s in plan.settings:
        if s.is_swept and s.levels and plan.reference[s.judge] < 0 and not plan.is_given:
            return ('"%s" is to be measured, and the line "reference %d" that says what it is '
                    'compared with is missing; %s' % (s.name, s.judge, _DAMAGED))
    return None


def read_plan(folder: str, plan: Plan, scene: str, crop: tuple[float, float, float, float]) -> None:
    """Read plan.txt of a folder into a plan that has the table of settings and the fingerprint of
    the scene as it is now. An Error names the line that holds something else than it should."""
    path = os.path.join(folder, "plan.txt")
    ours = plan.fingerprint
    seen: set[str] = set()
    with open(path, "rb") as f:
        lines = os.fsdecode(f.read()).split("\n")
    for s in plan.settings:
        s.is_swept = False
    for number, line in enumerate(lines[:-1] if lines[-1] == "" else lines, 1):
        wrong = _read_line(plan, line, seen)
        if wrong:
            raise Error("%s:%d:1: error: %s" % (path, number, wrong))
    if "fingerprint" in seen and plan.fingerprint != ours:
        raise Error('%s: error: this measurement is of another scene than "%s" as it is now, or by '
                    'another version of bis; measure into a new folder' % (path, scene))
    wrong = _check(plan, crop, seen)
    if wrong:
        raise Error("%s: error: %s" % (path, wrong))
