# SPDX-License-Identifier: BSD-2-Clause
"""How much light of a map arrives: irradiance for any normal, spherical harmonics, and irradiance
at points of a scene.

Of a map alone, where nothing hides a point, irradiance is exact. A pixel has one radiance all over,
so the integral over a circle of latitude is a difference of running sums. Over the latitudes it is
taken by Gauss and Legendre. At points of a scene it is estimated, by a render.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._frames import FRAMES
from ._library import Doubles, Error, Floats, array

if TYPE_CHECKING:
    from ._render import Scene
    from ._sampling import Envmap

NODES = 3  #: of Gauss and Legendre in a row, at least
SMALL = 16  #: rows or columns: where there are fewer, more nodes
LATITUDES = 1024  #: of the whole map, at least: where a horizon begins, the integrand has a bend
NORMALS = 1000  #: over which the error of harmonics is told
CELLS = 1 << 20  #: latitudes times normals at once, and pixels
WIDEST = 1024  #: columns that the error of harmonics needs: E hardly sees a texel

_BANDS = np.repeat((0, 1, 2), (1, 3, 5))
#: Of a clamped cosine in each band (Ramamoorthi and Hanrahan 2001, eq. 8).
_COSINE = np.array((np.pi, 2 * np.pi / 3, np.pi / 4))[_BANDS]


def _latitudes(height: int, nodes: int) -> tuple[Doubles, Doubles]:
    """Nodes theta and their weights, (height, nodes)."""
    x, weight = np.polynomial.legendre.leggauss(nodes)
    step = np.pi / height
    theta = (np.arange(height)[:, None] + (x + 1) / 2) * step
    return theta, np.tile(weight * step / 2, (height, 1))


class _Circles:
    """Integrals of L, L cos(phi) and L sin(phi) along the rows of a map, from phi = 0 to any
    angle."""

    def __init__(self, pixels: Doubles) -> None:
        self.width = pixels.shape[1]
        self.phi = np.arange(self.width + 1) * (2 * np.pi / self.width)
        self.pixels = pixels
        parts = np.diff(self._primitive(self.phi), axis=0)  # (width, 3)
        sums = np.einsum("ykc,kj->ykjc", pixels, parts)
        self.before = np.zeros((pixels.shape[0], self.width + 1, 3, pixels.shape[2]))
        np.cumsum(sums, axis=1, out=self.before[:, 1:])

    @staticmethod
    def _primitive(phi: Doubles) -> Doubles:
        """Of 1, cos and sin."""
        return np.stack((phi, np.sin(phi), -np.cos(phi)), axis=-1)

    def until(self, row: ArrayLike, phi: Doubles) -> Doubles:
        """The three integrals at the angles phi (...), (..., 3, colours)."""
        turns = np.floor(phi / (2 * np.pi))
        phi = phi - 2 * np.pi * turns
        k = np.minimum((phi * (self.width / (2 * np.pi))).astype(int), self.width - 1)
        part = self._primitive(phi) - self._primitive(self.phi[k])
        inside = part[..., None] * self.pixels[row, k][..., None, :]
        return self.before[row, k] + inside + turns[..., None, None] * self.before[row, -1]


def _from_rows(pixels: Doubles, theta: Doubles, weight: Doubles, normals: Doubles) -> Doubles:
    """What arrives from rows, of which each has so many of the latitudes theta."""
    row = np.repeat(np.arange(len(pixels)), len(theta) // len(pixels))
    circles = _Circles(pixels)
    sin, cos = np.sin(theta), np.cos(theta)
    E = np.empty((len(normals), pixels.shape[2]))
    step = max(CELLS // len(theta), 1)
    for i in range(0, len(normals), step):
        x, y, z = normals[i:i + step, :, None].transpose(1, 0, 2)  # each (step, 1)
        middle, reach = np.arctan2(y, x), np.hypot(x, y) * sin
        # Where the cosine to the normal, reach cos(phi - middle) + z cos, is above 0.
        with np.errstate(divide="ignore", invalid="ignore"):
            edge = np.where(reach > 0, -z * cos / reach, np.where(z * cos > 0, -1, 1))
        half = np.arccos(np.clip(edge, -1, 1))
        arcs = circles.until(row, middle + half) - circles.until(row, middle - half)
        factors = np.stack(np.broadcast_arrays(z * cos, x * sin, y * sin), axis=-1)
        E[i:i + step] = np.einsum("nkjc,nkj,k->nc", arcs, factors, weight * sin, optimize=True)
    return E


def arriving(pixels: NDArray[Any], normals: Doubles) -> Doubles:
    """The irradiance from pixels (h, w, colours) at unit normals (n, 3): (n, colours)."""
    height, width, colours = pixels.shape
    theta, weight = _latitudes(height, max(NODES, -(-LATITUDES // height)))
    E = np.zeros((len(normals), colours))
    rows = max(CELLS // width, 1)
    for y in range(0, height, rows):
        some = slice(y, y + rows)
        E += _from_rows(pixels[some].astype(np.float64), theta[some].ravel(), weight[some].ravel(),
                        normals)
    return E


def irradiance(light: Envmap, normals: ArrayLike) -> Doubles:
    """See `Envmap.irradiance`."""
    n = array(normals, 3, np.float64, "normals")
    length = np.linalg.norm(n, axis=1, keepdims=True)
    if not ((length > 0) & np.isfinite(length)).all():
        raise Error("error: normals holds one of length 0, or that is not finite: give directions")
    return arriving(light.pixels, n / length)


def _moments(pixels: NDArray[Any]) -> Doubles:
    """The integrals of L v v^T for v = (1, x, y, z), (4, 4, colours): all of degree 2."""
    height, width = pixels.shape[:2]
    theta, weight = _latitudes(height, NODES + SMALL // height)
    x, share = np.polynomial.legendre.leggauss(NODES + SMALL // width)
    phi = (np.arange(width)[:, None] + (x + 1) / 2) * (2 * np.pi / width)
    sin, cos, one = np.sin(theta), np.cos(theta), np.ones_like(theta)
    along = np.stack((np.ones_like(phi), np.cos(phi), np.sin(phi)))  # of 1 and z, x, y
    circle = np.einsum("iwp,jwp,p->ijw", along, along, share * (np.pi / width))
    down = np.einsum("iht,jht,ht->ijh", *2 * (np.stack((one, sin, sin, cos)),), weight * sin)
    which = np.ix_(*2 * ((0, 1, 2, 0),))
    total = np.zeros((4, 4, pixels.shape[2]))
    step = max(CELLS // width, 1)
    for y in range(0, height, step):
        some = pixels[y:y + step].astype(np.float64)
        rows = np.einsum("ijw,hwc->ijhc", circle, some, optimize=True)
        total += np.einsum("ijh,ijhc->ijc", down[..., y:y + step], rows[which])
    return total


# ---- points of a scene ----

SQUARE = 64  #: pixels; points on a film lie in squares of this side, in each along a curve
BITS = 10  #: of a coordinate, along the curve
#: What coordinates of six digits may be off, of the largest coordinate: so far points are lifted.
LIFT = 2e-6
DARK = 0.05  #: where less than this of the light arrives, intervals miss too often


class Arriving(NamedTuple):
    """Irradiance at points.

    Parameters
    ----------
    E : array (n, 3)
        The integral of radiance times cosine times visibility.
    interval : array (n, 3)
        The half-width of its 95 % interval; NaN after one pass, and where less than 5 % of the
        light arrives, but for rooms whose windows are given or found.
    stats : dict
        What `--stats` tells of the render.
    """

    E: Doubles
    interval: Doubles
    stats: dict[str, Any]


def _spread(k: NDArray[np.int64], step: int) -> NDArray[np.int64]:
    """Bit i of k moves to bit i step."""
    bits = (k[..., None] >> np.arange(BITS)) & 1
    return (bits << (step * np.arange(BITS))).sum(-1)


def _gathered(k: NDArray[np.int64], first: int) -> NDArray[np.int64]:
    """Every second bit of k, from the first on."""
    bits = (k[..., None] >> (first + 2 * np.arange(BITS))) & 1
    return (bits << np.arange(BITS)).sum(-1)


def _order(p: Doubles, n: Doubles) -> NDArray[np.intp]:
    """Points that look the same way, along a curve through space: neighbours learn together."""
    low = p.min(0)
    size = max(float((p.max(0) - low).max()), np.finfo(float).tiny)
    cell = ((p - low) / size * ((1 << BITS) - 1)).astype(np.int64)
    curve = sum(_spread(cell[:, k], 3) << k for k in range(3))
    looks = (n > 0) @ np.array((1, 2, 4))
    return np.lexsort((curve, looks))


def at_points(scene: Scene, points: ArrayLike, normals: ArrayLike, lift: Optional[float],
              **settings: Any) -> Arriving:
    """See `Scene.irradiance`."""
    if "layers" in settings:
        raise Error("irradiance at points has no layers: leave them out")
    p, n = (array(a, 3, np.float64, name) for a, name in ((points, "points"), (normals, "normals")))
    if p.shape != n.shape or not len(p):
        raise Error("%d points have %d normals: give one to each" % (len(p), len(n)))
    if lift is None:
        lift = LIFT * float(abs(p[np.isfinite(p)]).max(initial=0))
    with np.errstate(all="ignore"):
        n = n / np.linalg.norm(n, axis=1, keepdims=True)
        lifted = (p + n * lift).astype(np.float32)
    bad = ~np.isfinite(lifted + n).all(1)
    if bad.any():
        raise Error("error: point %d: give finite numbers, and a normal that is not 0"
                    % np.argmax(bad))
    order = _order(p, n)
    side = SQUARE
    while side > 1 and side * side >= 4 * len(p):
        side //= 2
    rows = side * -(-len(p) // (side * side))
    k = np.arange(rows * side)
    square, inside = np.divmod(k, side * side)
    y, x = square * side + _gathered(inside, 1), _gathered(inside, 0)
    place = np.empty((rows, side), np.intp)
    place[y, x] = order[np.minimum(k, len(p) - 1)]
    picture = scene._of_points(lifted[place], n[place].astype(np.float32), settings)
    E, interval = np.full((2, len(p), 3), np.nan)
    E[place] = np.pi * picture.rgb
    if "interval" in picture.layers:  # one pass tells none
        told = picture.layers["interval"]
        if "portals" not in picture.stats:  # in a room with them 0.91 to 0.96 of intervals hold
            dark = picture.rgb.sum(2) < DARK * picture.layers["unoccluded"].sum(2)
            told = np.where(dark[..., None], np.nan, told)
        interval[place] = np.pi * told
    return Arriving(E, interval, picture.stats)


# ---- harmonics ----

class Harmonics(NamedTuple):
    """Nine coefficients of a map, and what they get wrong.

    Parameters
    ----------
    radiance : array (9, 3)
        The integrals of radiance times each harmonic.
    irradiance : array (9, 3)
        The same after the cosine: their sum with the harmonics of a normal is its irradiance.
    of_mean, of_itself : (float, float)
        How far this sum is off, in r+g+b: root of the mean square over all normals, and the most.
        Relative to the mean irradiance, and to what arrives at the same normal (infinite where
        nothing does).
    worst : array (3,)
        The normal with the most, relative to the mean, in the frame.
    """

    radiance: Doubles
    irradiance: Doubles
    of_mean: tuple[float, float]
    of_itself: tuple[float, float]
    worst: Doubles


def basis(w: Doubles) -> Doubles:
    """The nine real harmonics of directions (..., 3), in the order of three.js and Unity."""
    v = np.concatenate((np.ones_like(w[..., :1]), w), axis=-1)
    return _project(v[..., :, None, None] * v[..., None, :, None])[..., 0]


def _project(m: Doubles) -> Doubles:
    """The nine harmonics of moments (..., 4, 4, colours), (..., 9, colours)."""
    one, (x, y, z) = m[..., 0, 0, :], (m[..., 0, i, :] for i in (1, 2, 3))
    a, b = np.sqrt(3 / (4 * np.pi)), np.sqrt(15 / (4 * np.pi))
    return np.stack((
        0.5 / np.sqrt(np.pi) * one, a * y, a * z, a * x,
        b * m[..., 1, 2, :], b * m[..., 2, 3, :],
        np.sqrt(5 / (16 * np.pi)) * (3 * m[..., 3, 3, :] - one),
        b * m[..., 1, 3, :], b / 2 * (m[..., 1, 1, :] - m[..., 2, 2, :])), axis=-2)


def sphere(n: int) -> Doubles:
    """n directions that cover the sphere evenly: Fibonacci's spiral."""
    k = np.arange(n) + 0.5
    z, phi = 1 - 2 * k / n, k * np.pi * (3 - np.sqrt(5))
    s = np.sqrt(1 - z * z)
    return np.stack((s * np.cos(phi), s * np.sin(phi), z), axis=1)


def _error(wrong: Doubles, scale: Doubles) -> tuple[float, float]:
    """The root of the mean square, and the most. What is 0 and told as 0 is not wrong."""
    with np.errstate(divide="ignore"):
        r = np.divide(wrong, scale, out=np.zeros_like(wrong), where=wrong != 0)
    return float(np.sqrt((r * r).mean())), float(abs(r).max())


def harmonics(light: Envmap, frame: str = "bis") -> Harmonics:
    """See `Envmap.harmonics`."""
    return project(light.pixels, frame)


def project(pixels: Floats, frame: str) -> Harmonics:
    """The harmonics of pixels (h, w, 3) of a lat-long map."""
    if frame not in FRAMES:
        raise Error("frame is \"%s\": give one of %s" % (frame, ", ".join(FRAMES)))
    axes = np.eye(4)
    axes[1:, 1:] = FRAMES[frame]
    radiance = _project(np.einsum("ai,bj,ijc->abc", axes, axes, _moments(pixels)))
    after = radiance * _COSINE[:, None]
    n = sphere(NORMALS)
    grey = pixels.sum(2, keepdims=True, dtype=np.float64)
    while grey.shape[1] > WIDEST and grey.shape[0] % 2 == grey.shape[1] % 2 == 0:
        grey = (grey[::2, ::2] + grey[1::2, ::2] + grey[::2, 1::2] + grey[1::2, 1::2]) / 4
    exact = arriving(grey, n)[:, 0]
    wrong = (basis(n @ axes[1:, 1:].T) @ after).sum(1) - exact
    return Harmonics(radiance, after, _error(wrong, np.full_like(exact, exact.mean())),
                     _error(wrong, exact), n[np.argmax(abs(wrong))] @ axes[1:, 1:].T)
