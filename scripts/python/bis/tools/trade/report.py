# SPDX-License-Identifier: BSD-2-Clause
"""report.html, and the summary on standard output.

All that the page says of this measurement is one JSON object, made here. Its members have the names
of model.py and stats.py. The page has the words, and its script draws them. Numbers are those of the
measurement, in seconds and shares: how they are printed and where they stand is the page's affair.
"""
from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray

from ..._image import compare_colours, exposure_of
from ..._library import Doubles, version
from .. import page, text
from . import stats
from .model import REPLICATES, Advice, Image, Shot, Trade
from .references import in_order
from .stats import Point

JUDGED = ("sir and rejection", "em, brdf and mis")  #: by reference 0 and 1
CROP = 4  #: a crop is 1/CROP of the sides
CROPS = 2

Json = dict[str, Any]


def _share(part: float, whole: float) -> float:
    """part/whole. NaN for a whole of 0, which becomes null."""
    return part / whole if whole else math.nan


# ---- settings ----

def _point(trade: Trade, p: Point) -> Json:
    mean = trade.references[trade.plan.settings[p.setting].judge].mean
    pixels = float(trade.plan.width) * trade.plan.height
    error = math.sqrt(p.noise) if p.noise > 0 else math.nan
    return {
        "passes": p.passes, "seconds": p.seconds, "rays": (p.camera_rays + p.shadow_rays) / pixels,
        "error": error, "error_se": p.noise_se / (2 * error),  # of the root: half the relative one
        "bias": _share(p.bias, mean), "bias_se": _share(p.bias_se, mean), "pareto": p.on_front,
    }


def _reached(trade: Trade, setting: int, at: Iterable[float],
             reach: Callable[[Trade, int, float], tuple[float, bool]]) -> list[Json]:
    return [dict(zip(("value", "extrapolated"), reach(trade, setting, x))) for x in at]


def _setting(trade: Trade, i: int, heads: list[int], times: list[float],
             errors: list[float]) -> Json:
    s = trade.plan.settings[i]
    curve = trade.result.curves[i]
    return {
        "name": s.name, "method": s.integrator, "biased": s.is_biased, "own": s.is_scenes,
        "head": i in heads,
        "cost_variance": curve.cost_variance, "cost_variance_se": curve.cost_variance_se,
        "slope": curve.slope, "slope_se": curve.slope_se,
        "points": [_point(trade, p) for p in curve.points],
        "error_at": _reached(trade, i, times, stats.error_at),
        "seconds_to": _reached(trade, i, errors, stats.seconds_to),
    }


def _settings(trade: Trade) -> Json:
    """In the order of cost x variance, as bars and tables have them."""
    curves = trade.result.curves
    order = sorted((i for i, c in enumerate(curves) if c.points),
                   key=lambda i: curves[i].cost_variance)
    heads, times, errors = stats.heads(trade), stats.times(trade), stats.errors(trade)
    best = trade.result.best
    return {
        "times": times, "errors": errors,
        "best": trade.plan.settings[best].name if best >= 0 else None,
        "settings": [_setting(trade, i, heads, times, errors) for i in order],
    }


# ---- advice ----

def _advice(trade: Trade, a: Advice) -> Json:
    if a.setting < 0:
        return {"purpose": a.purpose, "setting": None}
    s = trade.plan.settings[a.setting]
    by_candidates = s.integrator in ("sir", "rejection")
    return {
        "purpose": a.purpose, "setting": s.name, "method": s.integrator,
        "candidates": s.values["candidates"] if by_candidates else None,
        "shadowrays": s.values["shadowrays"] if by_candidates else None,
        "samples": None if by_candidates else s.values.get("samples"),
        "error": a.expected_error, "seconds": a.seconds, "passes": a.passes,
        "extrapolated": a.is_extrapolated,
        "options": s.option_text, "line": "" if s.option_text else s.scene_text,
    }


# ---- how it was measured ----

def _reference(trade: Trade, k: int) -> Json:
    reference = trade.references[k]
    return {
        "judges": JUDGED[k], "name": trade.plan.settings[trade.plan.reference[k]].name,
        "renders": REPLICATES, "passes": trade.plan.reference_passes[k], "mean": reference.mean,
        "se": reference.se / reference.mean if reference.mean > 0 else 0,
        "noise": math.sqrt(reference.relmse),
    }


def _method(trade: Trade) -> Json:
    plan = trade.plan
    a, b = trade.references
    both_are_ours = not plan.is_given and a.is_ready and b.is_ready and a.mean > 0
    return {
        "film": {"width": plan.width, "height": plan.height, "full_width": plan.full_width,
                 "full_height": plan.full_height, "step": plan.step},
        "run_seconds": plan.run_seconds, "seeds": plan.n_seeds, "threads": trade.threads,
        "references": [_reference(trade, k) for k in range(2)
                       if plan.reference[k] >= 0 and trade.references[k].is_ready],
        "given": plan.is_given,
        "noise": math.sqrt(trade.both.relmse),
        "difference": abs(a.mean - b.mean) / a.mean if both_are_ours else None,
        "difference_se": float(np.hypot(a.se, b.se)) / a.mean if both_are_ours else None,
        "left_out": [{"name": s.name, "pass_seconds": s.pass_seconds} for s in plan.settings
                     if s.is_swept and not s.levels],
    }


# ---- pictures ----

def _intensity(image: Image) -> Doubles:
    r, g, b = np.moveaxis(image.astype(np.float64), 2, 0)
    return r + g + b


def crops(images: list[Image], reference: Image) -> list[tuple[int, int]]:
    """Where to look: the corners (x, y) of the windows, a quarter of the sides, in which the
    pictures err most.

    The second one does not overlap the first. Each pixel's difference is bounded, so that one
    firefly does not choose the place.
    """
    height, width = (-(-side // CROP) for side in reference.shape[:2])
    b = _intensity(reference)
    a = np.stack([_intensity(image) for image in images])
    difference = np.abs(a - b)
    with np.errstate(divide="ignore", invalid="ignore"):
        error = np.where(difference > 0, np.minimum(difference / np.maximum(a, b), 0.5), 0)
    found: list[tuple[int, int]] = []
    for _ in range(CROPS):
        most, place = -1.0, (0, 0)
        for y in range(0, reference.shape[0] - height + 1, height // 3 + 1):
            for x in range(0, reference.shape[1] - width + 1, width // 3 + 1):
                if any(abs(x - u) < width and abs(y - v) < height for u, v in found):
                    continue
                here = in_order(error[:, y:y + height, x:x + width])
                if here > most:
                    most, place = here, (x, y)
        found.append(place)
    return found


def _shot(trade: Trade, shot: Shot, reference: Image, ev: float) -> Json:
    return {
        "setting": trade.plan.settings[shot.setting].name, "passes": shot.passes,
        "seconds": shot.seconds, "error": math.sqrt(shot.relmse),
        "picture": page.png(shot.image, ev),
        "errors": page.png(compare_colours(shot.image, reference), 0),
    }


def _pictures(trade: Trade) -> Json:
    """All have one exposure, from the reference, so that what differs is the method."""
    reference = trade.both.image
    assert reference is not None
    # For the shapes: one does not look at the background.
    ev = exposure_of(reference, trade.view.coverage())
    height, width = (-(-side // CROP) for side in reference.shape[:2])
    corners = crops([shot.image for shot in trade.strip], reference) if trade.strip else []
    return {
        "crops": [{"x": x, "y": y, "width": width, "height": height} for x, y in corners],
        "reference": page.png(reference, ev),
        "shots": [_shot(trade, shot, reference, ev) for shot in trade.strip],
    }


# ---- the page ----

def values(trade: Trade) -> Json:
    """All that the page says of this measurement."""
    return {
        "scene": trade.options.scene, "version": version(), "complete": trade.is_complete,
        "runs": len(trade.runs), "planned": trade.plan.planned_runs(),
        "advice": [_advice(trade, a) for a in trade.result.advice],
        **_settings(trade), **_method(trade), **_pictures(trade),
    }


def summary(trade: Trade) -> str:
    """What a user wants to know at once: the advice in short, and where the page is."""
    lines = []
    for a in trade.result.advice:
        if a.setting < 0:
            continue
        s = trade.plan.settings[a.setting]
        lines.append("%-14s error %-5s %s%-8s %s --spp %d" % (
            a.purpose, text.percent(a.expected_error), "~" if a.is_extrapolated else " ",
            text.duration(a.seconds), s.option_text or s.scene_text, a.passes))
    if not lines:
        lines.append("no advice: no setting has enough runs; give --resume --time more")
    lines.append("%d of %d runs in %s/report.html" % (len(trade.runs), trade.plan.planned_runs(),
                                                       trade.options.folder))
    return "".join(line + "\n" for line in lines)


def _text(trade: Trade) -> str:
    """For a browser without JavaScript."""
    form = "%-32s %8s %10s %10s %s\n"
    lines = [form % ("setting", "passes", "time", "error", "on the Pareto front")]
    for p in trade.result.points:
        lines.append(form % (
            trade.plan.settings[p.setting].name, p.passes, text.duration(p.seconds),
            text.percent(p.error) if p.noise > 0 else "-", "yes" if p.on_front else ""))
    return summary(trade) + "\n" + "".join(lines)


def write_report(trade: Trade) -> None:
    """Write report.html. The scene (trade.view) says how much of each pixel shapes cover, for the
    exposure."""
    page.write("%s/report.html" % trade.options.folder, "trade", values(trade), _text(trade))
