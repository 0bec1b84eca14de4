# SPDX-License-Identifier: BSD-2-Clause
"""What is wrong with an environment map, as far as its pixels tell, and how much light it gives.

A finding accuses; a fact does not. A drawn map (of few different values, as a checker) has no
findings, because a drawing may look like any of these mistakes.
"""
from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._irradiance import Harmonics, arriving, project
from .._library import Doubles, Floats
from .._sampling import Envmap
from .survey import Direction, Map, direction_of, intensity

CEILINGS = (1.0, 16.0, 65504.0)  #: of 8 bits, of some converters, of half floats
LEAST = 4096  #: pixels; fewer tell nothing
DRAWN = 64  #: different values: a map of fewer is drawn, not seen
EIGHT_BITS = 256
ROWS = 512  #: that are looked at for how many values there are, spread over the map
SUN = 2 * math.pi * (1 - math.cos(math.radians(1)))  #: sr of a disc of 2 degrees, with blur
LAMPS = 5  #: that are told
#: A lamp is brighter than this many medians, and gives at least this share of the light.
LAMP_LEVEL, LAMP_SHARE = 16, 0.01
SKY = 1.0  #: a sun that gives less light than so many skies was cut off: a clear day's gives four
RING = 3  #: pixels beside a spot
NEXT = 8  #: values below the brightest


class Lamp(NamedTuple):
    """Connected pixels much brighter than the rest."""

    share: float  #: of the power
    solid_angle: float
    direction: Direction
    is_sun: bool


class Diagnosis(NamedTuple):
    """What `diagnose` finds."""

    irradiance: Doubles  #: on a surface that faces up, r, g, b
    exposure: float  #: EV that puts a grey card of it at middle grey
    lamps: list[Lamp]
    samples: dict[str, float]  #: by method, to 1 % of this irradiance, nothing hidden
    harmonics: Harmonics
    findings: list[str]


# ---- light ----

def _parts(mask: NDArray[np.bool_]) -> tuple[NDArray[Any], Doubles]:
    """Connected pixels of a mask: labels, -1 outside, and solid angles. Columns join round."""
    drawn = np.repeat(mask[..., None], 3, axis=2).astype(np.float32)
    regions = Envmap(drawn, "cdf", 0).regions(1)
    return regions.label, regions.solid_angles


def _grown(mask: NDArray[np.bool_], steps: int) -> NDArray[np.bool_]:
    """The mask and its neighbours to this distance."""
    for _ in range(steps):
        wide = mask | np.roll(mask, 1, 1) | np.roll(mask, -1, 1)
        mask = wide.copy()
        mask[1:] |= wide[:-1]
        mask[:-1] |= wide[1:]
    return mask


def _lamps(light: Envmap, pixels: Floats, grey: Doubles, angles: Doubles) -> list[Lamp]:
    lit = grey > LAMP_LEVEL * np.median(grey)
    power = float((grey * angles).sum())
    if not lit.any() or power == 0:
        return []
    label, solid_angles = _parts(lit)
    share = np.bincount(label[lit], (grey * angles)[lit]) / power
    found = []
    for k in np.argsort(-share, kind="stable")[:LAMPS]:
        if share[k] < LAMP_SHARE:
            break
        spot = label == k
        rows, columns = np.nonzero(spot)
        w = (grey * angles)[spot] @ light.directions(rows, columns).astype(np.float64)
        core = spot & (grey > grey[spot].max() / 2)
        is_sun = grey[spot].max() == grey.max() and _is_sun(pixels, grey, core, angles)
        found.append(Lamp(float(share[k]), float(solid_angles[k]),
                          direction_of(w / np.linalg.norm(w)), is_sun))
    return found


def _is_sun(pixels: Floats, grey: Doubles, spot: NDArray[np.bool_], angles: Doubles) -> bool:
    """Whether a spot is a small disc above the horizon with sky beside it: light that falls off,
    and is not red."""
    rows = np.nonzero(spot)[0]
    if angles[spot].sum() > SUN or rows.max() >= len(grey) // 2:
        return False
    near = _grown(spot, RING) & ~spot
    far = _grown(spot, 5 * RING) & ~_grown(spot, 4 * RING)
    colour = np.median(pixels[far], axis=0)
    return bool(np.median(grey[near]) > 1.05 * np.median(grey[far]) > 0 and colour[2] >= colour[0])


def _samples(light: Envmap, grey: Doubles, E: float) -> dict[str, float]:
    """How many independent samples of each method give E of a surface that faces up to 1 %."""
    z = np.zeros(light.shape)
    rows = np.arange(light.shape[0])
    z[:] = light.directions(rows, np.zeros_like(rows))[:, 2:]
    up = np.maximum(z, 0)
    value = grey * up * light.solid_angles[:, None]
    by_map, by_cosine = light.density(), up / np.pi
    densities = {"em": by_map, "brdf": by_cosine, "mis": (by_map + by_cosine) / 2}
    if E == 0:
        return dict.fromkeys(densities, 0.0)
    return {name: max(1.0, 1e4 * (float(np.divide(value * grey * up, q, out=np.zeros_like(z),
                                                   where=value > 0).sum()) / E ** 2 - 1))
            for name, q in densities.items()}


# ---- findings ----

def _bad_values(light: Envmap) -> list[str]:
    bad = light.defects
    kinds = [(bad.nan, "NaN"), (bad.infinite, "infinite"), (bad.negative, "negative")]
    said = ", ".join("%d %s" % kind for kind in kinds if kind[0])
    return ["%s: these values count as 0" % said] if said else []


def _plateau(pixels: Floats, grey: Doubles, angles: Doubles) -> list[str]:
    """Equal brightest values, many more than of the next ones. Where light falls off smoothly
    towards them, or channels reach them apart, they are cut off; a flat lamp has an edge and one
    colour."""
    most = pixels.max()
    at = pixels == most
    values, counts = np.unique(pixels[pixels > most / 2], return_counts=True)
    if counts[-1] < 4 or counts[-1] < 3 * counts[-1 - NEXT:-1].max(initial=0):
        return []
    texels = at.any(2)
    patterns = np.bincount((at @ np.array((1, 2, 4)))[texels], minlength=8)
    ring = _grown(texels, 1) & ~texels
    beside = np.median(pixels[ring].max(1)) / most if ring.any() else 0.0
    sky = np.pi * np.median(grey[:len(grey) // 2])
    # Of a lamp that lost its tip alone, little is missing.
    is_most = 8 * texels.sum() > (grey > grey.max() / 2).sum()
    is_weak_sun = (is_most and _is_sun(pixels, grey, texels, angles)
                   and (grey * angles)[texels].sum() < SKY * sky)
    if beside < 0.6 and (patterns > 1).sum() < 2 and not is_weak_sun:
        return []
    ceiling = "the ceiling " if float(most) in CEILINGS else ""
    lost = "; it is the sun, and 40 % of the light is probably missing" if is_weak_sun else ""
    return ["cut off at %s%.6g: %d values are equal%s" % (ceiling, most, counts[-1], lost)]


def _differences(a: Doubles, b: Doubles) -> Doubles:
    """Relative, in [0, 1]."""
    return np.divide(abs(a - b), a + b, out=np.zeros_like(a), where=a + b > 0)


def _seam(grey: Doubles) -> list[str]:
    """A step in most of the rows. The edges of things go through some of them."""
    rows = grey[len(grey) // 8:len(grey) * 7 // 8]
    steps = np.median(_differences(rows, np.roll(rows, -1, axis=1)), axis=0)
    most = steps[:-1].max()
    if steps[-1] > 0.02 and steps[-1] > 1.5 * most:
        return ["a seam: across the sides of the picture light changes by %.0f %% in half of the "
                "rows, elsewhere by at most %.0f %%" % (200 * steps[-1], 200 * most)]
    return []


def _poles(grey: Doubles) -> list[str]:
    """A cap around a pole that is black, or at the bottom of one colour."""
    found = []
    for name, rows in (("top", grey), ("bottom", grey[::-1])):
        same = (rows == rows[0, 0]).all(1)
        degrees = 180 * int(np.argmin(same)) / len(grey)
        if 3 <= degrees <= 45:
            if rows[0, 0] == 0:
                found.append("a black pole: %.0f degrees around the %s" % (degrees, name))
            elif name == "bottom":
                found.append("a patch of one colour: %.0f degrees around the bottom, as over a "
                             "tripod" % degrees)
    return found


def _upside_down(grey: Doubles) -> list[str]:
    up, down = arriving(grey.mean(1)[:, None, None], np.array(((0, 0, 1.0), (0, 0, -1.0))))[:, 0]
    if down > 1.5 * up:
        return ["upside down: %s times as much light comes from below as from above"
                % ("%.1f" % (down / up) if up > 0 else "infinitely many")]
    return []


def _change(row: Doubles) -> float:
    """From one sixteenth of a row to the next, relative to its mean."""
    parts = row[:len(row) // 16 * 16].reshape(16, -1).mean(1)
    return float(np.sqrt((np.diff(parts) ** 2).mean()) / parts.mean()) if parts.any() else 0.0


def _stretched(grey: Doubles) -> list[str]:
    """At a pole all columns look into one direction."""
    if grey.shape[1] < 128:
        return []
    changes = [_change(row) for row in grey]
    least, usual = min(changes[0], changes[-1]), float(np.median(changes))
    if least > max(0.08, 0.4 * usual):
        return ["stretched: along the first and the last row light changes as along others, but "
                "at a pole all columns look the same way: a photograph, or another mapping"]
    return []


def _some_rows(a: NDArray[Any]) -> NDArray[Any]:
    return a[::max(len(a) // ROWS, 1)]


def _is_drawn(grey: Doubles) -> bool:
    """Whether there are few different values in all, or in most rows."""
    rows = np.sort(_some_rows(grey), axis=1)
    return len(np.unique(rows)) < DRAWN or np.median((np.diff(rows) > 0).sum(1)) < DRAWN / 4


def _eight_bits(pixels: Floats) -> list[str]:
    """Few different values in a picture that is not drawn. An .hdr has its own 8 bits, which leave
    the last 16 bits of a float empty; it tells nothing."""
    if not (pixels.view(np.uint32) & 0xFFFF).any():
        return []
    for part in (_some_rows(pixels), pixels):  # most maps have more in some rows
        values = [np.unique(part[..., k]) for k in range(3)]
        if max(len(v) for v in values) > EIGHT_BITS:
            return []
    v = max(values, key=len).astype(np.float64)
    v = v[v > 0]
    grid = v / np.diff(v).min()
    # Half floats move a value by 2^-11 of itself.
    if (abs(grid - grid.round()) < 0.1 + grid / 1024).all() and grid[-1] < 2 * EIGHT_BITS:
        return ["sRGB not undone: %d values in equal steps, as of a picture of 8 bits that was "
                "read as if it were linear" % len(v)]
    return ["banded: %d different values in a channel, a picture of 8 bits" % len(v)]


def find(m: Map, grey: Doubles) -> list[str]:
    """What is probably wrong, a line each; grey is r+g+b of the pixels. What pixels tell
    is told of a lat-long map alone, because another was resampled, and not of a few pixels."""
    found = _bad_values(m.light)
    if m.light.mapping != "latlong" or grey.size < LEAST or _is_drawn(grey):
        return found
    angles = np.broadcast_to(m.angles[:, None], grey.shape)
    return (found + _plateau(m.pixels, grey, angles) + _seam(grey) + _poles(grey)
            + _upside_down(grey) + _stretched(grey) + _eight_bits(m.pixels))


def diagnose(m: Map, convention: str = "bis") -> Diagnosis:
    """Look at a map; convention: the axes of the harmonics. Its power may be 0."""
    light, grey = m.light, intensity(m.pixels)
    angles = np.broadcast_to(m.angles[:, None], grey.shape)
    # What arrives from around the pole does not know of columns.
    E = arriving(m.pixels.mean(1, keepdims=True, dtype=np.float64), np.array(((0, 0, 1.0),)))[0]
    mean = float(E.mean())
    return Diagnosis(E, -math.log2(mean / math.pi) + 0.0 if mean > 0 else 0.0,
                     _lamps(light, m.pixels, grey, angles), _samples(light, grey, 3 * mean),
                     project(m.pixels, convention), find(m, grey))
