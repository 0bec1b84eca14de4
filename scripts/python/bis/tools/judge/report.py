# SPDX-License-Identifier: BSD-2-Clause
"""From files to verdicts, and what is said of them: text, JSON, a page."""
from __future__ import annotations

import math
import os
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, Callable, Sequence

import numpy as np

from ... import Envmap, Error, Scene, read_image, save_image
from ..._image import exposure_of
from ..._library import Doubles
from .. import page
from ..command import Say
from ..survey import heat
from . import kit
from .causes import (ANY_FACTOR, CONVENTIONS, CURVES, CUT, LEVELS, MOST, REJECTED, SMALL,
                     Convention, Found, Studio, apart, kind, search)
from .verdict import HALF, MANY, ROUNDING, WRONG, Truth, Verdict, judge

NOISES = (0.03, 0.01, 0.001)  #: of a tile, at which the kit counts what it tells apart
NEAREST = 24  #: causes that are tried by other conventions if none fits by the first
SATURATED = 65504.0  #: the largest half
RGBE = 2.0 ** -8  #: by how much an .hdr is off, as a share of the largest channel
FACETS = ("conductor", "metal", "microfacet", "plastic", "substrate", "uber", "coateddiffuse")


@dataclass
class Case:
    """Pictures of one scene, and what was found."""

    scene: str
    pictures: list[str]
    theirs: Doubles  #: (k, h, w, 3)
    truth: Truth
    verdict: Verdict
    like: str = ""  #: the convention by which it is right
    causes: list[Found] = field(default_factory=list)
    refusal: str = ""

    @property
    def named(self) -> list[Found]:
        """The causes that nothing speaks against, one of each kind; mere factors last."""
        fits = [f for f in self.causes if f.verdict.is_right]
        kinds = [kind(f.name) for f in fits]
        first = [f._replace(name=of) if kinds.count(of) > 1 else f
                 for i, (f, of) in enumerate(zip(fits, kinds)) if of not in kinds[:i]]
        return sorted(first, key=self.is_mere)

    def is_mere(self, cause: Found) -> bool:
        """Whether a cause dims all by a number that has no reason, which may be what is left of
        another mistake: a factor, or a cut of the map that makes the picture of a factor."""
        return cause.name.startswith(ANY_FACTOR) or cause.name.startswith(CUT) and any(
            f.makes(cause) for f in self.causes if f.name.startswith(ANY_FACTOR))

    @property
    def is_told(self) -> bool:
        """Whether a cause is named that is no mere factor."""
        return bool(self.named) and not self.is_mere(self.named[0])

    @property
    def is_sure(self) -> bool:
        """Whether one cause is told, or several that make one picture."""
        named = self.named
        return self.is_told and all(f.makes(named[0]) for f in named[1:])


# ---- files ----

def _read(path: str, say: Say) -> tuple[Doubles, float]:
    """A picture, and the share of a value that its rounding is off by."""
    if path.endswith(".npy"):
        try:
            pixels = np.load(path, allow_pickle=False)
        except (OSError, ValueError) as e:
            raise Error('error: cannot read "%s": %s' % (path, e)) from None
        if pixels.ndim != 3 or pixels.shape[2] < 3 or pixels.dtype.kind != "f":
            raise Error('error: "%s" holds %s of the shape %s: give floats (h, w, 3)'
                        % (path, pixels.dtype, pixels.shape))
        pixels = pixels[..., :3]
    else:
        pixels, _ = read_image(path)
    a = pixels.astype(np.float64)
    if not np.isfinite(a).all():
        raise Error('error: "%s" has %d values that are not finite: they are a mistake of their own'
                    % (path, int((~np.isfinite(a)).sum())))
    if len(np.unique(a)) <= 256 and a.std() > 0 and a.size > 4096:
        raise Error('error: "%s" holds %d different values: it is of 8 bits. Write linear floats '
                    "(.exr, .pfm, .npy), without a tone curve" % (path, len(np.unique(a))))
    if path.endswith(".hdr"):
        return a, RGBE
    is_half = bool((np.abs(a) <= SATURATED).all() and (a.astype(np.float16) == a).all())
    if is_half and a.max() == SATURATED:
        say.warn('"%s" is saturated: it holds 65504, the largest half' % path)
    return a, HALF if is_half and a.std() > 0 else ROUNDING


def _stack(paths: list[str], size: tuple[int, int], say: Say) -> tuple[Doubles, float]:
    read = [_read(path, say) for path in paths]
    for path, (a, _) in zip(paths, read):
        if a.shape[:2] != size:
            raise Error('error: "%s" has %d x %d pixels, the scene %d x %d'
                        % (path, a.shape[1], a.shape[0], size[1], size[0]))
    return np.array([a for a, _ in read]), max(share for _, share in read)


# ---- verdicts ----

def truth_for(studio: Studio, theirs: Doubles, rounding: float) -> tuple[Truth, Verdict]:
    """The right picture, as exact as the noise of theirs asks for."""
    for level in LEVELS[1:]:
        studio.at(level)
        truth = studio.right()
        verdict = judge(theirs, truth, rounding)
        if verdict.own < SMALL * max(verdict.noise, rounding) or verdict.p < REJECTED:
            break
    return truth, verdict


#: Makes a studio by a step and a convention, each once.
Studios = Callable[[int, Convention], Studio]


def judged(name: str, pictures: list[str], theirs: Doubles, rounding: float,
           made: Studios) -> Case:
    """Judge pictures (k, h, w, 3) with these names, and look for the cause of a wrong one."""
    studio = made(1, CONVENTIONS[0])
    case = Case(name, pictures, theirs, *truth_for(studio, theirs, rounding))
    if case.verdict.is_right:
        return case
    facets = any('"%s"' % word in studio.text for word in FACETS)
    likes = [like for like in CONVENTIONS if (facets or not like.is_separable)
             and (studio.map is not None or not like.is_bilinear)]
    for like in likes[1:]:
        other = Case(name, pictures, theirs, *truth_for(made(1, like), theirs, rounding), like.name)
        if other.verdict.is_right:
            return other
    step = max(math.ceil(math.sqrt(studio.alpha.size / MOST)), 1)
    thin = theirs[:, step // 2::step, step // 2::step]
    for like in likes:
        studio = made(step, like)
        thin = thin[:, :studio.alpha.shape[0], :studio.alpha.shape[1]]
        before = case.causes
        case.causes = search(studio, thin, rounding,
                             {f.key: f.make for f in before[:NEAREST]} or None)
        if case.is_told:
            break
        if before and not case.named:
            case.causes = before
    if case.named and case.named[0].name in CURVES:
        case.refusal = "the picture holds %s: write linear light" % case.named[0].name
    return case


def studios_of_kit(name: str) -> Studios:
    """Studios of a scene of the kit."""
    light = Envmap(kit.light(name))
    return lru_cache(None)(lambda step, like: Studio(kit.text(name), light, light, step, like))


def _studios_of_scene(path: str) -> Studios:
    light = Scene(path).about()["light"]
    map_ = Envmap(light["file"]) if light["file"] else None
    if map_ is not None and map_.shape != (light["height"], light["width"]):
        map_ = None
    return lru_cache(None)(lambda step, like: Studio(path, None, map_, step, like))


def case_of(scene: str, pictures: list[str], is_kit: bool, say: Say) -> Case:
    """Judge files of a scene of the kit, or of the user's."""
    made = studios_of_kit(scene) if is_kit else _studios_of_scene(scene)
    theirs, rounding = _stack(pictures, made(1, CONVENTIONS[0]).alpha.shape, say)
    return judged(scene, pictures, theirs, rounding, made)


# ---- what is said ----

def _p(p: float) -> str:
    return "%.2g" % p if p > 1e-99 else "below 1e-99"


def _said(case: Case) -> str:
    if case.verdict.is_right:
        return "right%s: p = %s" % (case.like and ", " + case.like, _p(case.verdict.p))
    return "wrong: p = %s" % _p(case.verdict.p)


def _cause(case: Case) -> str:
    named = ["%s (p = %s)" % (f.name, _p(f.verdict.p)) for f in case.named]
    if not named:
        return "unknown; none of %d predicted pictures fits" % len(case.causes)
    if len(named) == 1 and case.is_sure:
        rest = max((f for f in case.causes if f is not case.named[0]), key=lambda f: f.verdict.p)
        return "%s; the next, %s, has p = %s" % (named[0], rest.name, _p(rest.verdict.p))
    return ("these make one picture: " if case.is_sure else "one of these: ") + "; ".join(named)


def words(case: Case) -> str:
    """What was found, as text."""
    v = case.verdict
    k = len(case.theirs)
    lines = ["scene       %s" % case.scene,
             "theirs      %d picture%s: %s" % (k, "s" * (k > 1), ", ".join(case.pictures)),
             "verdict     %s%s" % (_said(case), "" if v.is_sure_of_noise else
                                   ", if its noise is as it looks (%d pictures tell)" % MANY),
             "tests       %s" % ", ".join("%s %s" % (name, _p(p)) for name, p in v.parts.items()),
             "mean        theirs is %.5g +- %.1g times ours" % (v.ratio, v.ratio_se),
             "noise       of a tile: theirs %.2g %%, ours %.2g %%" % (100 * v.noise, 100 * v.own)]
    if not v.is_right:
        lines.append("cause       " + _cause(case))
    if case.refusal:
        lines.append("refused     " + case.refusal)
    return "\n".join(lines) + "\n"


def summary(cases: list[Case]) -> str:
    """One line of all."""
    wrong = [case for case in cases if not case.verdict.is_right]
    causes = sorted({f.name for case in wrong for f in case.named[:1] if case.is_sure})
    return "%d of %d right%s\n" % (len(cases) - len(wrong), len(cases),
                                   "; causes: " + "; ".join(causes) if causes else "")


def data(case: Case) -> dict[str, Any]:
    """What was found, for JSON."""
    v = case.verdict
    return {"scene": case.scene, "pictures": case.pictures, "right": v.is_right, "p": v.p,
            "tests": v.parts, "ratio": v.ratio, "ratio_se": v.ratio_se,
            "noise": v.noise, "own": v.own, "noise_is_known": v.is_sure_of_noise,
            "convention": case.like or None, "refusal": case.refusal or None,
            "sure": case.is_sure,
            "causes": [{"name": f.name, "p": f.verdict.p} for f in case.named]}


def write_page(path: str, cases: list[Case], said: str) -> None:
    """Write a page: of each scene theirs, ours, z, and the cause's picture."""
    shown = []
    for case in cases:
        ours = case.truth.mean.astype(np.float32)
        ev, z = exposure_of(ours), case.verdict.z
        pictures = {"theirs": page.png(case.theirs.mean(0), ev), "ours": page.png(ours, ev),
                    "z": page.png(heat(np.abs(z).ravel() / 8).reshape(z.shape + (3,)), 0.0)}
        if case.named:
            pictures["cause"] = page.png(case.named[0].truth.mean, ev)
        shown.append({**data(case), "verdict": _said(case), "shown": pictures,
                      "cause": "" if case.verdict.is_right else _cause(case)})
    page.write(path, "judge", {"cases": shown, "wrong_below": WRONG}, said)


def write_exact(folder: str, names: Sequence[str] = kit.NAMES,
                level: tuple[int, int] = LEVELS[-1]) -> str:
    """Write the right pictures of the kit and their standard errors, and which causes each scene
    tells apart; return a line for each."""
    lines, rows = [], ["scene,cause,from_right,from_all,nearest"]
    place = os.path.join(folder, "exact")
    os.makedirs(place, exist_ok=True)
    for name in names:
        studio = studios_of_kit(name)(1, CONVENTIONS[0])
        studio.at((MANY, 2))
        causes, noise = apart(studio)
        others = noise + np.diag([np.inf] * len(noise))
        least = others.min(1)[1:]
        rows += ['%s,"%s",%.2g,%.2g,"%s"' % (name, cause, from_right, from_all, causes[nearest])
                 for cause, from_right, from_all, nearest
                 in zip(causes[1:], noise[0, 1:], least, others.argmin(1)[1:])]
        studio.at(level)
        copies = studio.right().copies
        mean, error = copies.mean(0), copies.std(0, ddof=1) / math.sqrt(len(copies))
        save_image(os.path.join(place, name + ".exr"), mean)
        save_image(os.path.join(place, name + "-stderr.exr"), error)
        share = math.sqrt(np.mean(error ** 2)) / max(mean.mean(), 1e-300)
        told = ", ".join("%d at %g %%" % (np.sum(least >= s), 100 * s) for s in NOISES)
        lines.append("%-16s %.2g %% a pixel; tells of %d causes, by the noise of a tile, %s. %s\n"
                     % (name, 100 * share, len(least), told, kit.SCENES[name].about))
    with open(os.path.join(folder, "tells.csv"), "w", encoding="utf-8") as f:
        f.write("\n".join(rows) + "\n")
    return "".join(lines)
