# SPDX-License-Identifier: BSD-2-Clause
"""Is a picture right? A test of its differences from a picture whose error is known.

The picture is cut into some 100 tiles. What they tell, in each channel, becomes four p-values:
all tiles together (the sum of z^2 over them), the worst tile, the mean of the whole, and outlines
apart. Pixels at outlines are in no tile: there a filter or a film that lies half a pixel off shows,
as the sum of the differences times the slope of the true picture in x, in y, or times its
curvature.

The noise of eight pictures or more is their scatter, and z is Student's. Of fewer, it is estimated
from the picture: from differences of neighbours for one, from the scatter in each pixel for some.
This asks that pixels are independent, which a filter wider than a pixel or a denoiser breaks.

The p-values are made one by Cauchy's combination (Liu and Xie 2020), which needs no independence:
channels, and the four tests, tell much of the same. Where there is no noise, a difference of up to
a share `ROUNDING` of a tile's radiance costs nothing, because floats that are added in another
order are off by the same in all tiles.
"""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..._library import Doubles

Flags = NDArray[np.bool_]

TILES = 100
MANY = 8  #: pictures, from which on their scatter is the noise
WRONG = 1e-3  #: p below which a picture is called wrong
ROUNDING = 1e-4  #: of renderers that trace rays in floats, systematic (seen: 1.3e-5)
HALF = 2.0 ** -11  #: of a value that is rounded to a half


class Truth(NamedTuple):
    """A picture with its error: copies by several seeds, whose mean counts. Pixels of one copy may
    depend on one another, as those of bis do, which share candidates."""

    copies: Doubles  #: (n, h, w, 3), n >= 2
    outlines: Flags  #: (h, w)
    background: Flags  #: (h, w)
    unknown: Any = False  #: pixels (h, w) of which nothing is said
    spread: float = 1.0  #: of a tile's variance over that of independent pixels, by a wide filter

    @property
    def mean(self) -> Doubles:
        """The picture (h, w, 3)."""
        return self.copies.mean(0)


@dataclass
class Verdict:
    """What the test tells."""

    p: float  #: of all tests together
    parts: dict[str, float]  #: p of each test
    ratio: float  #: of the means, theirs over ours, of what is in tiles
    ratio_se: float
    noise: float  #: of their tiles: root mean squared error as a share of the whole mean
    own: float  #: of ours
    z: Doubles  #: (h, w): of each pixel's tile, of the channel that is farthest off; 0 at outlines
    is_sure_of_noise: bool  #: its noise is known by MANY pictures

    @property
    def is_right(self) -> bool:
        """Whether nothing speaks against it."""
        return self.p >= WRONG


# ---- distributions ----

def normal_p(z: Doubles) -> Doubles:
    """Two-sided p-values of standard normal numbers."""
    flat = [math.erfc(abs(v) / math.sqrt(2)) for v in np.ravel(z).tolist()]
    return np.array(flat).reshape(np.shape(z))


def student_z(t: Doubles, dof: Doubles) -> Doubles:
    """Standard normal numbers with the p-values of Student's t, to 0.5 % (Wallace 1959)."""
    size = np.sqrt(dof * np.log1p(t * t / dof)) * (8 * dof + 1) / (8 * dof + 3)
    return np.copysign(size, t)


def chi_square_p(total: float, dof: int) -> float:
    """The p-value of a sum of dof squares (Wilson and Hilferty 1931)."""
    spread = 2 / (9 * dof)
    z = ((total / dof) ** (1 / 3) - (1 - spread)) / math.sqrt(spread)
    return math.erfc(z / math.sqrt(2)) / 2


def together(p: Doubles) -> float:
    """One p-value of many, which may depend on one another (Liu and Xie 2020). A p near 1 would
    outweigh a small one, so .99 is the most."""
    p = np.clip(p, 1e-300, 0.99)
    return float(np.arctan2(1.0, np.mean(1 / np.tan(np.pi * p))) / np.pi)


# ---- tiles ----

class _Tiles:
    """Tiles of a picture, and what is in them: pixels that are no outlines, of surfaces and of
    background apart, because their noise differs. A pixel with no neighbour in its tile, whose
    noise nothing would show, is in none."""

    def __init__(self, truth: Truth) -> None:
        h, w = truth.outlines.shape
        rows = min(max(round(math.sqrt(TILES * h / w)), 1), h)
        columns = min(max(round(TILES / rows), 1), w)
        y, x = np.arange(h) * rows // h, np.arange(w) * columns // w
        place = 2 * (y[:, None] * columns + x) + truth.background
        place = np.where(truth.outlines | truth.unknown, -1, place)
        near = np.zeros((h, w), bool)
        for axis in (0, 1):
            a, n = np.moveaxis(place, axis, 0), np.moveaxis(near, axis, 0)
            same = a[1:] == a[:-1]
            n[1:] |= same
            n[:-1] |= same
        place = np.where(near, place, -1)
        count = np.bincount(place[place >= 0], minlength=2 * rows * columns)
        enough = count >= 8
        number = np.append(np.where(enough, np.cumsum(enough) - 1, -1), -1)
        self.n = int(enough.sum())
        self.count = count[enough][:, None]  #: pixels, (n, 1)
        self.of = number[place]  #: (h, w): the tile, or -1
        self.spread = truth.spread  #: at most

    def sums(self, values: Doubles, of: NDArray[np.int64]) -> Doubles:
        """Sums over tiles (n, 3) of values (h, w, 3), with the tile of each pixel."""
        inside = of >= 0
        index = of[inside]
        return np.stack([np.bincount(index, values[inside][:, c], self.n) for c in range(3)], 1)

    def means(self, values: Doubles) -> Doubles:
        """Means over tiles (n, 3)."""
        return self.sums(values, self.of) / self.count

    def variance(self, copies: Doubles) -> Doubles:
        """The variance (n, 3) of the mean of copies (k, h, w, 3), by their scatter. A few may agree
        by chance, so for them it is no less than its mean over all tiles, as a share, and is known
        as well as by MANY."""
        each = np.stack([self.means(one) for one in copies])
        own = each.var(0, ddof=1) / len(copies)
        if len(copies) < MANY:
            square = each.mean(0) ** 2
            own = np.maximum(own, square * np.sum(own) / max(np.sum(square), 1e-300))
        return own

    def noise(self, d: Doubles, copies: Doubles) -> tuple[Doubles, Doubles]:
        """The variance of the tiles' means (n, 3) as the differences (k, h, w, 3) from the mean of
        copies show it, without that of the copies, and degrees of freedom (n, 1)."""
        k = len(d)
        if k >= MANY:
            return self.variance(d), np.full((self.n, 1), k - 1.0)
        if k > 1:
            variance = self.means(d.var(0, ddof=1)) / self.count / k
            if self.spread > 1 and (variance > 0).any():  # some pictures tell it
                seen = np.mean(self.variance(d) / np.where(variance > 0, variance, np.inf))
                self.spread = min(self.spread, max(float(seen), 1.0))
            return self.spread * variance, self.count * (k - 1.0)
        total, fourth, pairs = (np.zeros((self.n, c)) for c in (3, 3, 1))
        for a, b in ((np.s_[:, 1:], np.s_[:, :-1]), (np.s_[1:], np.s_[:-1])):
            same = np.where(self.of[a] == self.of[b], self.of[a], -1)
            square = (d[0][a] - d[0][b]) ** 2 / 2
            ours = [one[a] - one[b] for one in copies]
            total += self.sums(square - np.var(ours, 0, ddof=1) / 2 / len(copies), same)
            fourth += self.sums(square ** 2, same)
            pairs += np.bincount(same[same >= 0], minlength=self.n)[:, None]
        # Two pairs a pixel, which share pixels, tell as much as 0.8 independent squares; less where
        # few pixels have most of the noise (the fourth moment of a normal number is 3).
        total = np.maximum(total, 0)
        dof = np.minimum(1.2 * total ** 2 / np.maximum(fourth, 1e-300), 0.4 * pairs)
        return self.spread * total / pairs / self.count, np.maximum(dof, 1)

    def skewness(self, d: Doubles) -> Doubles:
        """The skewness of the tiles' means (n, 3), from that of all pixels about their tiles'."""
        at = self.of >= 0
        of = self.of[at]
        r = np.stack([one[at] - self.means(one)[of] for one in d])
        square = np.zeros(self.of.shape + (3,))
        square[at] = np.mean(r * r, 0)
        spread = np.sqrt(self.means(square))[of]
        u = np.divide(r, spread, out=np.zeros_like(r), where=spread > 0)
        return np.mean(u ** 3, axis=(0, 1)) / np.sqrt(self.count * len(d))


def tile_means(truth: Truth, copies: Doubles) -> Doubles:
    """Means of copies (k, h, w, 3) over the truth's tiles, (n, 3)."""
    return _Tiles(truth).means(copies.mean(0))


def features(truth: Truth, right: Truth) -> Doubles:
    """What tells a cause's copies (k, h, w, 3) apart, (k, m): means of tiles, and sums of outlines
    times slopes; as shares of the mean, and so that all have the noise of a tile."""
    tiles = _Tiles(right)
    unknown = np.broadcast_to(truth.unknown, right.outlines.shape)[..., None]
    copies = np.where(unknown, right.copies, truth.copies)
    at = right.outlines
    slopes = np.array([s[at] for s in _slopes(right.mean)])
    size = np.sqrt(np.sum(slopes ** 2, (1, 2)) * tiles.count.mean())
    slopes /= np.maximum(size, 1e-300)[:, None, None]
    return np.array([np.append(tiles.means(c), np.sum(slopes * c[at], (1, 2)))
                     for c in copies]) / right.mean.mean()


def outlines_of(normal: Doubles, depth: Doubles, alpha: Doubles, rgb: Doubles) -> Flags:
    """Pixels at outlines: a share is background, normal or depth leap to a neighbour's, or the
    background does."""
    found = (alpha > 0) & (alpha < 1)
    for axis in (0, 1):
        n, z, a, c = (np.moveaxis(v, axis, 0) for v in (normal, depth, alpha, rgb))
        leap = np.abs(n[1:] - n[:-1]).max(-1) > 0.25
        leap |= np.abs(z[1:] - z[:-1]) > 0.1 * np.maximum(z[1:], z[:-1])
        leap |= a[1:] != a[:-1]
        leap |= (a[1:] == 0) & (np.abs(c[1:] - c[:-1]) > 0.02 * c[1:] + 0.02 * c[:-1]).any(-1)
        out = np.moveaxis(found, axis, 0)
        out[1:] |= leap
        out[:-1] |= leap
    return found


# ---- the tests ----

def _welch(d: Doubles, errors: list[tuple[Doubles, Any]], skewness: Any = 0.0) -> Doubles:
    """z of differences d with independent errors, a list of variances and degrees of freedom (Welch
    and Satterthwaite), for a skewness of their sum (Hall 1992; his series is for t up to the root
    of their number). No error at all tells nothing: z is 0."""
    total = sum(v for v, _ in errors)
    known = total > 0
    safe = np.where(known, total, 1.0)
    dof = safe ** 2 / np.maximum(sum(v * v / k for v, k in errors), 1e-9 * safe ** 2)
    t = d / np.sqrt(safe)
    u = np.clip(t, -np.sqrt(dof), np.sqrt(dof))
    t = t + skewness * (1 + 2 * u * u) / 6 + skewness ** 2 * u ** 3 / 27
    return np.where(known, student_z(t, dof), 0.0)


def _slopes(mean: Doubles) -> list[Doubles]:
    """How a picture changes if it is moved in x, in y, or blurred."""
    around = np.pad(mean, ((1, 1), (1, 1), (0, 0)), mode="edge")
    left, right, up, down = (around[1:-1, :-2], around[1:-1, 2:], around[:-2, 1:-1],
                             around[2:, 1:-1])
    return [(right - left) / 2, (down - up) / 2, left + right + up + down - 4 * mean]


def _outlines_z(d: Doubles, truth: Truth, spread: float) -> Doubles:
    """z of the sums over outlines of d times what a shift or a blur would be; none without them."""
    at = truth.outlines & np.logical_not(truth.unknown)
    z = []
    for slope in _slopes(truth.mean):
        u = np.sum(d[:, at] * slope[at], axis=-1)  # (k, pixels)
        each = np.sum(truth.copies[:, at] * slope[at], axis=-1)
        own = each.sum(1).var(ddof=1) / len(each)
        if len(each) < MANY:  # which may agree by chance
            own = max(own, each.var(0, ddof=1).sum() / len(each))
        if len(d) >= MANY:
            variance, dof = u.sum(1).var(ddof=1) / len(d), len(d) - 1.0
        else:
            variance, dof = spread * np.sum(u.mean(0) ** 2), float(at.sum())
        if variance + own > 0:
            t = u.sum() / len(d) / math.sqrt(variance + own)
            z.append(float(student_z(np.float64(t), np.float64(dof))))
    return np.array(z)


def _beyond(d: Doubles, free: Doubles, variance: Doubles) -> Doubles:
    """Differences beyond what costs nothing, where noise does not hide it."""
    return np.where(variance > free * free, d, np.copysign(np.maximum(np.abs(d) - free, 0), d))


def _size(variance: Doubles, mean: float) -> float:
    """The root of the mean variance, as a share of the mean of a channel."""
    return math.sqrt(float(variance.mean())) / mean if mean > 0 and variance.size else 0.0


def judge(theirs: Doubles, truth: Truth, rounding: float = ROUNDING) -> Verdict:
    """Test pictures (k, h, w, 3) of one scene, by other seeds, against the truth. Their values are
    rounded by up to a share of a tile's brightest channel."""
    d = theirs - truth.mean
    tiles = _Tiles(truth)
    ours = tiles.means(truth.mean)
    noise, dof = tiles.noise(d, truth.copies)
    own = tiles.variance(truth.copies)
    free = np.broadcast_to(rounding * np.abs(ours).max(1, keepdims=True, initial=0), ours.shape)
    of_floats = (free / 10) ** 2  # what is beyond it is a mistake even where nothing is noisy
    each = np.stack([tiles.means(one) for one in d])
    errors = [(noise, dof), (own, max(len(truth.copies), MANY) - 1.0), (of_floats, math.inf)]
    total = noise + own + of_floats
    skewness = tiles.skewness(d) * (noise / np.maximum(total, 1e-300)) ** 1.5
    off = _beyond(each.mean(0), free, noise + own)
    tells = (off != 0) | (noise + own > free * free)  # a tile without noise is right by itself
    z = np.where(tells, _welch(off, errors, skewness), 0.0)
    parts = {}
    if tells.any():
        squares = [chi_square_p(float(np.sum(z[t, c] ** 2)), int(t.sum()))
                   for c, t in enumerate(tells.T) if t.any()]
        parts = {"all tiles": together(np.array(squares)),
                 "worst tile": together(normal_p(z[tells]))}

    share = tiles.count / max(tiles.count.sum(), 1)
    means = np.sum(share * each, 1)  # (k, 3)
    variance, freedom = np.sum(share ** 2 * total, 0), float(dof.sum())
    if len(d) >= MANY:
        variance = means.var(0, ddof=1) / len(d) + np.sum(share ** 2 * (own + of_floats), 0)
        freedom = len(d) - 1.0
    mean_z = _welch(_beyond(means.mean(0), np.sum(share * free, 0), variance),
                    [(variance, freedom)])
    if mean_z.any():
        parts["mean"] = together(normal_p(mean_z[mean_z != 0]))
    edge = _outlines_z(d, truth, tiles.spread)
    if len(edge):
        parts["outlines"] = together(normal_p(edge))

    mean = float(np.sum(share * ours)) / 3
    ratio = 1 + float(means.mean()) / mean if mean > 0 else math.inf
    farthest = np.append(np.take_along_axis(z, np.abs(z).argmax(1)[:, None], 1)[:, 0], 0.0)
    p = together(np.array(list(parts.values()))) if parts else 1.0
    return Verdict(p, parts, ratio,
                   math.sqrt(float(variance.mean())) / mean if mean > 0 else math.inf,
                   _size(noise[tells], mean), _size(own[tells], mean), farthest[tiles.of],
                   len(d) >= MANY)


def fit(theirs: Doubles, truth: Truth) -> tuple[float, float]:
    """The factor of the truth that fits pictures best, by weighted least squares over tiles, and
    its standard error."""
    tiles = _Tiles(truth)
    noise, _ = tiles.noise(theirs - truth.mean, truth.copies)
    own = tiles.variance(truth.copies)
    ours, x = tiles.means(truth.mean), np.mean([tiles.means(one) for one in theirs], 0)
    f, power = 1.0, 0.0
    for _ in range(3):  # the error of ours grows with the factor
        weight = 1 / np.maximum(noise + f * f * own + (ROUNDING * x) ** 2, 1e-300)
        power = max(float(np.sum(weight * ours ** 2)), 1e-300)
        f = float(np.sum(weight * ours * x)) / power
    return f, 1 / math.sqrt(power)
