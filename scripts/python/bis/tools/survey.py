# SPDX-License-Identifier: BSD-2-Clause
"""What is in an environment map: the figures and the pictures of `bis envmap`.

They show the steps of thesis 3.3 and 3.4 one by one: intensities, levels, regions, importance.
Contrast, and how little of the sphere holds how much of the power, is what importance sampling
lives on.

Median and brightest share are quantiles by solid angle. Pixels are not sorted but counted into
cells of equal leading bits of their intensity (its exponent and 12 bits of the mantissa), so that a
quantile is known to 1 part in 4096.

An intensity is r+g+b. Sums go from pixel to pixel in the order of the map, a block of rows at a
time, so that a large map takes little memory and no sum depends on the size of the blocks.
"""
from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Optional

import numpy as np
from numpy.typing import NDArray

from .._library import Doubles, Floats
from .._sampling import Envmap, Regions, uniform
from . import page

LARGEST = 8  #: regions that are told
SPHERE = 4 * math.pi
PAGE_WIDTH = 720  #: columns of a page's map, at most
CODES = 65535  #: of a density above 0 on the page
MANTISSA = 12  #: bits that tell cells apart
#: Intensities reach from 2^-149, the smallest float, to 3 * 2^128.
FIRST_CELL = (1023 - 149) << MANTISSA
CELLS = (149 + 130) << MANTISSA
BLOCK = 1 << 22  #: pixels
EPSILON = 2.0 ** -23  #: of a float



# ---- sums in order ----

def _add(total: float, values: Doubles) -> float:
    """The total after the values, one by one. numpy's own sum goes in another order."""
    return float(np.add.accumulate(np.concatenate(([total], values.ravel())))[-1])


def _add_by(totals: Doubles, index: NDArray[Any], values: Doubles) -> Doubles:
    """The totals after values[i] was added to totals[index[i]], one by one."""
    n = len(totals)
    return np.bincount(np.concatenate((np.arange(n), index)), np.concatenate((totals, values)), n)


def intensity(pixels: Floats) -> Doubles:
    """r+g+b of pixels (..., 3), added in double, because three floats may be beyond all floats
    together."""
    r, g, b = (pixels[..., k].astype(np.float64) for k in range(3))
    return r + g + b


class Block(NamedTuple):
    """Some rows of a map."""

    rows: slice
    pixels: Floats  #: (rows, width, 3)
    intensity: Doubles  #: (rows, width)
    angles: Doubles  #: of each pixel, in sr, (rows, width)


class Map:
    """A map and its regions, to walk through in blocks."""

    def __init__(self, light: Envmap) -> None:
        self.light = light
        self.height, self.width = light.shape
        self.pixels = light.pixels
        self.angles = light.solid_angles
        self.regions: Regions = light.regions()

    def blocks(self) -> Iterator[Block]:
        """Blocks of rows, from the top."""
        step = max(BLOCK // self.width, 1)
        for y in range(0, self.height, step):
            rows = slice(y, min(y + step, self.height))
            pixels = self.pixels[rows]
            angles = np.broadcast_to(self.angles[rows, None], pixels.shape[:2])
            yield Block(rows, pixels, intensity(pixels), angles)


# ---- the figures ----

class Level(NamedTuple):
    """A level of intensity."""

    least: float
    most: float
    pixels: int
    sphere: float  #: share
    power: float  #: share
    regions: int


class Direction(NamedTuple):
    """A direction in the map's own frame. z is up."""

    theta: float  #: degrees from z
    phi: float  #: degrees, with the columns
    x: float
    y: float
    z: float


class Region(NamedTuple):
    """One of the regions with most power."""

    level: int
    power: float  #: share
    solid_angle: float
    direction: Optional[Direction]  #: of its centre of power; None: as in a constant map


@dataclass
class Survey:
    """The figures of a map. Shares are of the sphere, or of the power."""

    least: float = 0.0  #: of the pixels that are not black
    most: float = 0.0
    mean: float = 0.0
    median: float = 0.0  #: by solid angle
    power: float = 0.0  #: integral over the sphere
    mean_rgb: tuple[float, float, float] = (0.0, 0.0, 0.0)
    black: float = 0.0  #: share of the sphere
    brightest: float = 0.0  #: share of the power in the brightest 0.1% of the sphere
    peak: tuple[int, int] = (0, 0)  #: column and row of the brightest pixel
    peak_direction: Optional[Direction] = None  #: None: the map is black
    levels: list[Level] = field(default_factory=list)
    n_regions: int = 0
    largest: list[Region] = field(default_factory=list)


def direction_of(w: Any) -> Direction:
    """A unit vector with its angles."""
    x, y, z = (float(v) for v in w)
    phi = math.atan2(y, x) * 180 / math.pi
    theta = math.atan2(float(np.hypot(x, y)), z) * 180 / math.pi
    return Direction(theta, phi + 360 if phi < 0 else phi, x, y, z)


def _sum_map(s: Survey, m: Map) -> None:
    mean, least = [0.0, 0.0, 0.0], math.inf
    for b in m.blocks():
        for k in range(3):
            mean[k] = _add(mean[k], b.pixels[..., k].astype(np.float64) * b.angles / SPHERE)
        is_black = b.intensity == 0
        s.black = _add(s.black, b.angles[is_black] / SPHERE)
        least = min(least, np.min(b.intensity, initial=math.inf, where=~is_black))
        for sum_of_row, angle in zip(np.add.accumulate(b.intensity, axis=1)[:, -1], b.angles[:, 0]):
            s.power += float(sum_of_row * angle)
        y, x = divmod(int(np.argmax(b.intensity)), m.width)
        if b.intensity[y, x] > s.most:
            s.most = float(b.intensity[y, x])
            s.peak = x, b.rows.start + y
    s.mean_rgb = mean[0], mean[1], mean[2]
    s.least = float(least) if s.most > 0 else 0.0
    s.mean = s.power / SPHERE
    if s.most > 0:
        s.peak_direction = direction_of(m.light.directions([s.peak[1]], [s.peak[0]])[0])


def _find_quantiles(s: Survey, m: Map) -> None:
    angles, power = np.zeros(CELLS), np.zeros(CELLS)
    for b in m.blocks():
        lit = b.intensity > 0
        value, angle = b.intensity[lit], b.angles[lit]
        cells = (value.view(np.int64) >> (52 - MANTISSA)) - FIRST_CELL
        angles = _add_by(angles, cells, angle)
        power = _add_by(power, cells, value * angle)
    used = np.flatnonzero(angles)[::-1]
    s.median, _ = _from_the_top(angles[used], power[used], 0.5)
    _, above = _from_the_top(angles[used], power[used], 0.001)
    s.brightest = above / s.power if s.power > 0 else 0.0


def _from_the_top(angles: Doubles, power: Doubles, share: float) -> tuple[float, float]:
    """Walk from the brightest cell down until `share` of the sphere is covered.

    Returns the mean intensity of the cell reached (0: the black part is), and the power above, the
    last cell in proportion.
    """
    left = share * SPHERE
    above = 0.0
    for angle, part in zip(angles.tolist(), power.tolist()):
        if angle >= left:
            return part / angle, above + part * (left / angle)
        left -= angle
        above += part
    return 0.0, above


def _sum_levels(s: Survey, m: Map, levels: int) -> None:
    if s.most == 0:
        return
    log_range = math.log(s.most / s.least)
    n = levels if log_range > 0 else 1
    pixels, sphere, power = np.zeros(n), np.zeros(n), np.zeros(n)
    for b in m.blocks():
        level = m.regions.level[b.rows]
        lit = level >= 0
        index, value, angle = level[lit], b.intensity[lit], b.angles[lit]
        pixels += np.bincount(index, minlength=n)
        sphere = _add_by(sphere, index, angle / SPHERE)
        power = _add_by(power, index, value * angle / s.power)
    regions = np.bincount(m.regions.levels, minlength=n)
    edges = [s.least * math.exp(log_range * k / n) for k in range(n + 1)]
    s.levels = list(map(Level, edges, edges[1:], pixels.astype(int).tolist(), sphere.tolist(),
                        power.tolist(), regions.tolist()))


def _rank_regions(s: Survey, m: Map) -> None:
    """The regions with most power, and their centres."""
    s.n_regions = len(m.regions.levels)
    if s.power == 0:
        return
    power = np.zeros(s.n_regions)
    for b in m.blocks():
        label = m.regions.label[b.rows]
        lit = label >= 0
        power = _add_by(power, label[lit], b.intensity[lit] * b.angles[lit])
    share = power / s.power
    order = np.argsort(-share, kind="stable")[:LARGEST]
    centres = [[0.0, 0.0, 0.0] for _ in order]
    for b in m.blocks():
        label = m.regions.label[b.rows]
        for k, region in enumerate(order):
            rows, columns = np.nonzero(label == region)
            w = m.light.directions(rows + b.rows.start, columns).astype(np.float64)
            part = b.intensity[rows, columns] * b.angles[rows, columns] / s.power
            centres[k] = [_add(centres[k][i], w[:, i] * part) for i in range(3)]
    for region, centre in zip(order, centres):
        norm = math.sqrt(centre[0] * centre[0] + centre[1] * centre[1] + centre[2] * centre[2])
        # The centre of the whole sphere is what rounding leaves, below float's precision of the
        # directions summed.
        is_centre = norm > EPSILON * float(share[region])
        w = np.float32(np.array(centre) / norm) if is_centre else None
        s.largest.append(Region(
            int(m.regions.levels[region]), float(share[region]),
            float(m.regions.solid_angles[region]), direction_of(w) if is_centre else None))


def survey(m: Map, levels: int) -> Survey:
    """Find the figures of a map, which was opened with so many levels of intensity."""
    s = Survey()
    _sum_map(s, m)
    _find_quantiles(s, m)
    _sum_levels(s, m, levels)
    _rank_regions(s, m)
    return s


# ---- the pictures ----

STOPS = np.array([
    [0.05, 0.03, 0.20], [0.25, 0.07, 0.43], [0.53, 0.13, 0.42], [0.80, 0.24, 0.30],
    [0.95, 0.47, 0.12], [0.98, 0.76, 0.22], [1.0, 0.99, 0.80]])


def srgb(colours: Any) -> Floats:
    """Colours as they appear, in [0, 1], as linear light, which is what pictures hold (IEC
    61966-2-1)."""
    v = np.asarray(colours, np.float64)
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4).astype(np.float32)


def heat(t: Any) -> Floats:
    """Colours (n, 3) that a lecture hall can tell apart, for t in [0, 1] (n,).

    Dark blue over purple, red and orange to pale yellow. Each is lighter than the one before, so
    that it reads in grey print, too.
    """
    place = np.clip(np.asarray(t, np.float64), 0, 1) * (len(STOPS) - 1)
    i = np.minimum(place.astype(np.int64), len(STOPS) - 2)
    a, b = STOPS[i], STOPS[i + 1]
    return srgb(a + (place - i)[..., None] * (b - a))


def _hues(hue: Doubles, saturation: Doubles, value: Doubles) -> Floats:
    """Colours of hues in turns, by the hexagon."""
    channels = []
    for i in range(3):
        turn = hue + (3 - i) / 3.0
        place = 6 * (turn - np.floor(turn))
        channels.append(value * (1 - saturation * (1 - np.clip(np.abs(place - 3) - 1, 0, 1))))
    return srgb(np.stack(channels, axis=-1))


def levels_picture(m: Map, levels: int) -> Floats:
    """The level of each pixel in the colours of heat. Black pixels stay black."""
    colours = heat(np.arange(levels) / max(levels - 1, 1))
    return np.concatenate((colours, np.zeros((1, 3), np.float32)))[m.regions.level]


def regions_picture(m: Map) -> Floats:
    """Each region in a hue of its own, lighter the brighter it is (thesis figure 3.6)."""
    levels = m.regions.levels
    height = levels / max(float(np.max(levels, initial=1)), 1.0)
    # The golden section: successive labels get hues far apart.
    hue = np.arange(len(levels)) * 0.6180339887498949
    colours = _hues(hue, 0.75 - 0.45 * height, 0.25 + 0.75 * height)
    return np.concatenate((colours, np.zeros((1, 3), np.float32)))[m.regions.label]


def _dot(height: int) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:
    """The places (dy, dx) of a dot, and which of them are its dark rim.

    Its width is a hundredth of the picture's height.
    """
    radius = max(height / 200.0, 0.5)
    reach = math.ceil(1.6 * radius)
    side = np.arange(-reach, reach + 1)
    dy, dx = (a.ravel() for a in np.meshgrid(side, side, indexing="ij"))
    d = np.hypot(dx, dy) / radius
    inside = d <= 1.6
    return dy[inside], dx[inside], d[inside] > 1


def _draw_dots(out: Floats, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> None:
    """Draw dots. They wrap around like the map, a narrow map several times."""
    height, width = out.shape[:2]
    dy, dx, is_rim = _dot(height)
    light = srgb([0.55, 1, 0.95])
    lap = (dx - dx.min()) // width
    laps = [lap == k for k in range(lap.max() + 1)]
    for y0, x0 in zip(rows.tolist(), columns.tolist()):
        for part in laps:
            y, x, rim = y0 + dy[part], (x0 + dx[part]) % width, is_rim[part]
            within = (y >= 0) & (y < height)
            y, x, rim = y[within], x[within], rim[within]
            out[y[rim], x[rim]] = out[y[rim], x[rim]].astype(np.float64) * 0.3
            out[y[~rim], x[~rim]] = light


def _logarithms(q: Doubles) -> tuple[Doubles, float, float]:
    """Where densities lie between the least and the most above 0, in [0, 1], by their logarithm;
    and these two."""
    lit = q > 0
    most = float(np.max(q, initial=0.0))
    least = float(np.min(q, initial=math.inf, where=lit))
    t = np.ones_like(q)
    if most > least:
        t[lit] = np.log(q[lit] / least) / math.log(most / least)
    return t, least if most > 0 else 0.0, most


def draw(light: Envmap, n: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows and columns of n pixels, drawn by the first numbers of the library's own generator; none
    of a black map."""
    if light.power == 0:
        n = 0
    return light.draw(u=uniform(4 * n).reshape(n, 4))


def importance_picture(m: Map, n: int) -> Floats:
    """The density of each pixel on a scale of logarithms, and n directions drawn by it as dots
    (thesis figure 3.5)."""
    q = m.light.density()
    t, _, _ = _logarithms(q)
    out = heat(t)
    out[q == 0] = 0
    _draw_dots(out, *draw(m.light, n))
    return out


# ---- the page ----

def page_data(s: Survey, m: Map, n: int) -> dict[str, Any]:
    """What the page shows beyond the survey: "places", of each step x step pixels one, and n
    directions drawn."""
    step = -(-m.width // PAGE_WIDTH)
    rows = np.minimum(np.arange(-(-m.height // step)) * step + step // 2, m.height - 1)
    columns = np.minimum(np.arange(-(-m.width // step)) * step + step // 2, m.width - 1)
    middle = np.ix_(rows, columns)
    q = _means(m.light.density(), step)
    t, least, most = _logarithms(q)
    codes = np.where(q > 0, 1 + np.floor((CODES - 1) * t + 0.5), 0)
    grey = max(s.median, s.mean / 8) / 3  # of a channel
    places = {
        "width": len(columns), "height": len(rows), "step": step,
        "picture": page.png(m.pixels[middle], math.log2(0.18 / grey) if grey > 0 else 0.0),
        "level": page.numbers(m.regions.level[middle].astype(np.uint32), 1),
        "region": page.numbers(m.regions.label[middle].astype(np.uint32), 4),
        "least": least, "most": most,
        "density": page.numbers(codes.astype(np.uint32), 2),
    }
    samples = [{"theta_deg": 180 * (y + 0.5) / m.height, "phi_deg": 360 * (x + 0.5) / m.width}
               for y, x in zip(*(a.tolist() for a in draw(m.light, n)))]
    return {"places": places, "samples": samples}


def _means(values: Doubles, step: int) -> Doubles:
    """The mean of each step x step values, as far as there are."""
    height, width = values.shape
    shape = -(-height // step), -(-width // step)
    total, n = np.zeros(shape), np.zeros(shape)
    for dy in range(step):
        for dx in range(step):
            part = values[dy::step, dx::step]
            total[:part.shape[0], :part.shape[1]] += part
            n[:part.shape[0], :part.shape[1]] += 1
    return total / n
