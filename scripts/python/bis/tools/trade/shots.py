# SPDX-License-Identifier: BSD-2-Clause
"""The same seconds for each method: what does one see? (As the thesis's figures 5.1-5.8, 12 seconds
each.)

The best setting of each integrator and the scene's own get as many passes as fit the time of the
longest runs of the sweep, one at least. The pictures stay in pictures/ as EXR, for `bis compare`;
pictures.csv says what they are, and a resumed measurement renders only those that have changed.
"""
from __future__ import annotations

import os
from typing import Optional

from ..._image import compare, read_image, save_image
from .. import text
from ..files import outfile
from .model import Shot, Trade
from .references import make_folder
from .stats import heads

_HEADER = "setting,passes,seconds,relmse,file"
_MOST_PASSES = 1 << 20


def _file_of(setting: int) -> str:
    return "pictures/%02d.exr" % (setting + 1)


def _passes_of(t: Trade, setting: int) -> int:
    a_pass = t.result.curves[setting].pass_seconds
    return int(min(max(t.plan.run_seconds / a_pass + 0.5, 1),
                   _MOST_PASSES)) if a_pass > 0 else _MOST_PASSES


def _seconds_before(t: Trade, setting: int, passes: int) -> float:
    """The seconds of a picture that was made before; 0: it was not, or with another number of
    passes."""
    seconds = 0.0
    start = "%s,%d," % (t.plan.settings[setting].name, passes)
    try:
        with open(os.path.join(t.options.folder, "pictures.csv"), encoding="utf-8",
                  errors="replace") as f:
            for line in f:
                if line.startswith(start):
                    seconds = float(line[len(start):].split(",")[0])
    except (OSError, ValueError):
        return 0
    return seconds if seconds > 0 else 0


def _shot(t: Trade, setting: int) -> Optional[Shot]:
    """Read, or rendered; None: interrupted, and nothing is left."""
    path, passes = os.path.join(t.options.folder, _file_of(setting)), _passes_of(t, setting)
    seconds = _seconds_before(t, setting, passes)
    if seconds > 0 and os.path.exists(path):
        image = read_image(path)[0]
    else:
        picture = None if t.interrupted() else t.view.render(t.plan.settings[setting], t.plan.step,
                                                             passes,
                                                             t.seed_of(2, setting))
        if picture is None:
            return None
        image, seconds = picture.rgb, picture.seconds
        save_image(path, image)
    assert t.both.image is not None
    return Shot(setting, passes, seconds, compare(image, t.both.image).relmse, image)


def make_shots(t: Trade) -> None:
    """Read from pictures/, or render, pictures of equal time of the best setting of each
    integrator.

    Parameters
    ----------
    t : Trade
        With its result; strip is set.

    Raises
    ------
    Error
        A picture cannot be read or written.
    """
    make_folder(t, "pictures")
    settings = heads(t)
    for i, setting in enumerate(settings):
        t.tell("pictures", i / len(settings), t.plan.run_seconds * (len(settings) - i))
        shot = _shot(t, setting)
        if shot:
            t.strip.append(shot)
    lines = [_HEADER] + ["%s,%d,%s,%s,%s" % (t.plan.settings[p.setting].name, p.passes,
                                             text.digits(p.seconds),
                                             text.digits(p.relmse), _file_of(p.setting))
                         for p in t.strip]
    with outfile(os.path.join(t.options.folder, "pictures.csv")) as f:
        f.write(("\n".join(lines) + "\n").encode())
