# SPDX-License-Identifier: BSD-2-Clause
"""What mistake makes this picture? Each cause is a picture that bis predicts, with its error.

A wrong density of a light has the mean of a right render under another map: L' = L x (true density
/ claimed density). So mistakes of the map, of its sampler and of its reader are maps. Others are
other scenes, other films, or functions of the picture. A mistake of the cosine, or another masking
of facets, weighs directions: its picture is the right one times a quotient of two sums over shadow
rays at each pixel's centre.

A cause is held against the picture by the same test as the truth. Four camera samples a pixel
reject most causes. What they do not reject is refined, until its own error is small beside that of
the picture. A studio keeps what it has predicted for the next picture of its scene.
"""
from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterable, Sequence
from typing import Any, Callable, NamedTuple, Optional

import numpy as np

from ... import Envmap, Scene
from ..._library import Doubles, Floats
from ..survey import srgb
from .verdict import (MANY, ROUNDING, Flags, Truth, Verdict, features, fit, judge, outlines_of,
                      tile_means)

#: Copies of a picture, camera samples of a copy; the last for right pictures alone.
LEVELS = ((2, 2), (8, 8), (16, 32), (16, 128))
REJECTED = 1e-10  #: p below which a cause is refined no more
SMALL = 0.3  #: an own error beside that of the picture's noise, which needs no refining
SIGMAS = 6  #: by which the kit tells causes apart
ONE = 1e-3  #: of a tile: what differs by less is one picture
TURNS = 2048  #: of the map, any of which is found
FINE = 6  #: subpixels along a pixel's side, for films and filters
RAYS = 32  #: at a pixel for a copy, at least, for a quotient
MOST = 10000  #: pixels of a cause's picture: of larger pictures each k-th pixel is taken
LAYERS = ("normal", "depth", "unoccluded")


#: Of directions to the light (m, 3) and of what is hit.
Weight = Callable[[Doubles, "dict[str, Any]"], Doubles]


def kind(name: str) -> str:
    """A cause's name without what differs between programs."""
    return name.split(" (")[0]


class Found(NamedTuple):
    """A cause that was held against the picture."""

    name: str
    verdict: Verdict
    truth: Truth
    key: str  #: its name without a number
    make: Make  #: its picture in any studio of the scene
    fixed: Any = None  #: of a factor, what it leaves as it is

    def makes(self, other: Found) -> bool:
        """Whether this makes the other's picture, too, perhaps by another factor. Of the share of
        outlines that a factor on surfaces is for, too little is known."""
        truth = self.truth
        if self.fixed is not None:
            _, truth = _factor(other.truth.copies, truth, self.fixed)
        unknown = truth.unknown | other.truth.unknown | (
            self.fixed is not None and truth.outlines)
        return judge(other.truth.copies, truth._replace(unknown=unknown), ONE).is_right


# ---- the pictures ----

class Convention(NamedTuple):
    """What renderers may do differently, and all of them are right."""

    name: str
    is_bilinear: bool = False  #: the map between the centres of its pixels
    is_separable: bool = False  #: masking of facets is a product of two


CONVENTIONS = (Convention(""), Convention("with a bilinear map", True),
               Convention("with masking as a product of two", False, True),
               Convention("with a bilinear map, and masking as a product of two", True, True))


class Studio:
    """Pictures of one scene, by several seeds each. All are kept."""

    def __init__(self, source: str, light: Optional[Envmap], map_: Optional[Envmap], step: int = 1,
                 like: Convention = Convention("")) -> None:
        self.source = source  #: of the scene, a file's name or a text
        self.light = light  #: in the place of its own
        self.map = map_  #: what may be changed; None: it has none, or it is not known
        self.step = step
        self.like = like
        self.lit = Envmap(_bilinear(map_.pixels)) if like.is_bilinear else map_  #: as it shines
        self.scene = Scene(source, light=self.lit if like.is_bilinear else light)
        self._kept: dict[Any, Any] = {}
        self.at(LEVELS[0])
        p = self.scene.render(spp=4, step=step, layers=LAYERS)
        self.alpha = p.alpha.astype(float)
        self._shapes = [p.layers[name].astype(float) for name in ("normal", "depth")]
        self.outlines = self._outlines(p.rgb.astype(float))

    def _outlines(self, rgb: Doubles) -> Flags:
        """Outlines of shapes, and of lamps that a camera sees in a picture (h, w, 3)."""
        return outlines_of(*self._shapes, self.alpha, rgb)

    def at(self, level: tuple[int, int]) -> None:
        """Make pictures of so many copies and camera samples from here on."""
        self.n, self.spp = level

    def once(self, key: Any, make: Callable[[], Any]) -> Any:
        """What `make` returns at this level, made only once."""
        key = (self.n, self.spp, key)
        if key not in self._kept:
            self._kept[key] = make()
        return self._kept[key]

    def rendered(self, light: Any = None, scene: Optional[Scene] = None, layer: str = "",
                 **how: Any) -> Doubles:
        """Copies (n, h, w, 3) of the picture, or of a layer, under another light."""
        how = {"spp": self.spp, "step": self.step, "layers": layer or "none", **how}
        out = []
        for i in range(self.n):
            p = (scene or self.scene).render(light=light, seed=7919 * self.spp + i, **how)
            out.append(p.layers[layer] if layer else p.rgb)
        copies = np.array(out, float)
        if self.like.is_separable and not layer:
            fine = copies.shape[1] // len(self.alpha)
            q = self.quotient(separable)
            if (light or scene) and self.n >= MANY:  # its own, where pictures are exact
                other = scene or Scene(self.source, light=light)
                q = self._quotients(other, light or self.lit)[separable]
            copies *= q.repeat(fine, 1).repeat(fine, 2)
        return copies

    def copies(self, layer: str = "") -> Doubles:
        """Copies (n, h, w, 3) of the right picture, or of a layer."""
        return self.once("copies " + layer, lambda: self.rendered(layer=layer))

    def truth(self, copies: Doubles, unknown: Any = False) -> Truth:
        """The copies with their outlines; nothing is said of pixels that are unknown."""
        return Truth(copies, self._outlines(copies.mean(0)), self.alpha == 0, unknown)

    def right(self) -> Truth:
        """The right picture."""
        return self.truth(self.copies())

    def flipped(self, at: Any) -> Truth:
        """The right picture with another order of rows and columns."""
        t = self.right()
        return Truth(t.copies[(np.s_[:],) + at], t.outlines[at], t.background[at])

    def under(self, change: Callable[[Floats], Any]) -> Optional[Truth]:
        """The picture under a changed map; None: the map is not known."""
        if self.map is None:
            return None
        pixels = np.ascontiguousarray(change(self.map.pixels), np.float32)
        if self.like.is_bilinear:
            pixels = _bilinear(pixels)
        return self.truth(self.rendered(light=Envmap(pixels)))

    @property
    def text(self) -> str:
        """The text of the scene."""
        if "WorldBegin" in self.source:
            return self.source
        with open(self.source, encoding="utf-8", errors="surrogateescape") as f:
            return f.read()

    def edited(self, change: Callable[[str], str]) -> Optional[Truth]:
        """The picture of a changed text; None: the text has nothing to change, or names files,
        which the text alone would look for elsewhere."""
        changed = change(self.text)
        if changed == self.text or (self.light is None and "filename" in self.text):
            return None
        light = self.lit if self.like.is_bilinear else self.light
        return self.truth(self.rendered(scene=Scene(changed, light=light)))

    def _fine(self) -> Doubles:
        """Copies of FINE x FINE subpixels a pixel."""
        size = self.scene.about()
        spp = max(self.spp // (FINE * FINE), 1)
        return self.rendered(width=FINE * size["width"], height=FINE * size["height"], spp=spp)

    def filtered(self, taps: Doubles, y: int = 0, x: int = 0) -> Optional[Truth]:
        """The picture by a filter along x and y, as weights of subpixels about a place (y, x)
        subpixels from a pixel's centre. Nothing is said of the rim, where a filter lacks pixels.
        None: pixels are left out."""
        if self.step > 1:
            return None
        c = self.once("fine", self._fine)
        for axis, offset in ((1, y), (2, x)):
            c = np.moveaxis(c, axis, 0)
            n, half = len(c), len(taps) // 2
            reach = half + FINE
            c = np.pad(c, [(reach, reach)] + [(0, 0)] * 3, mode="edge")
            start = reach + FINE // 2 - half + offset
            c = sum(t * c[start + i:start + i + n:FINE] for i, t in enumerate(taps))
            c = np.moveaxis(c, 0, axis)
        rim = np.ones(c.shape[1:3], bool)
        rim[3:-3, 3:-3] = False
        return self.truth(c, rim)._replace(spread=(FINE * np.sum(taps ** 2)) ** -2)

    def _quotients(self, other: Optional[Scene] = None,
                   light: Optional[Envmap] = None) -> dict[Weight, Doubles]:
        """Of all weights; of another scene, under its light, only that of the masking."""
        weights = [separable] if other else [*WEIGHTS.values(), separable]
        made = weights
        if self.like.is_separable:
            made = [lambda *a, w=w: w(*a) * separable(*a) for w in weights[:-1]] + [separable]
        q = np.ones((len(weights), self.n) + self.alpha.shape + (3,))
        stage, rays = (other or self.scene).stage(), max(RAYS, self.spp)
        for y, x in np.argwhere((self.alpha == 1) & (self.n > 1)).tolist():
            if not stage.at(*(self.step * v + self.step // 2 for v in (x, y))):
                continue
            hit = stage.about()["hit"]
            if not other or hit["material"]["alpha"] is not None:
                drawn = stage.rays(runs=self.n, seed=y * 65537 + x, integrator="em", samples=rays)
                q[:, :, y, x] = _quotients(stage, hit, light or self.lit, made, self.n, drawn)
        return dict(zip(weights, q))

    def quotient(self, weight: Weight) -> Doubles:
        """What the weight multiplies the picture with (n, h, w, 3)."""
        return self.once("quotients", self._quotients)[weight]

    def weighed(self, weight: Weight) -> Optional[Truth]:
        """The picture with f cos times a weight; None: it is 1. A pixel's centre does not tell what
        is at an outline."""
        q = self.quotient(weight)
        if (q == 1).all():
            return None
        over = self.quotient(separable) if self.like.is_separable else 1.0
        return self.truth(self.copies() / over * q, self.outlines)


Make = Callable[[Studio], Optional[Truth]]


def _quotients(stage: Any, hit: dict[str, Any], light: Optional[Envmap], weights: list[Weight],
               n: int, drawn: Any) -> Doubles:
    """How each weight changes the radiance (weights, n, 3) at a stage's point: pseudo-values of a
    jackknife over n groups of rays. The light has the colours of its map, if that is known."""
    look = stage.look(drawn.wi)
    part = np.divide(look.product * drawn.seen, look.q_map, out=np.zeros(len(drawn.wi)),
                     where=look.q_map > 0)
    colours = np.ones((len(part), 3))
    if light is not None:
        theta, phi = stage.angles(drawn.wi).T  # in degrees
        h, w = light.shape
        row, column = (theta / 180 * h).astype(int), (phi / 360 * w).astype(int)
        Le = light.pixels[np.minimum(row, h - 1), column % w].astype(float)
        colours = Le / np.maximum(Le.sum(1, keepdims=True), 1e-300)
    wi = drawn.wi.astype(float)
    factors = [np.ones(len(wi)), *(weight(wi, hit) for weight in weights)]
    sums = np.zeros((len(factors), n, 3))
    np.add.at(sums, (np.s_[:], drawn.sample),
              np.array(factors)[:, :, None] * (part[:, None] * colours))
    total = sums.sum(1, keepdims=True)
    without = total - sums
    if not (without[0] > 0).all():
        return np.ones((len(weights), n, 3))
    return n * total[1:] / total[0] - (n - 1) * without[1:] / without[0]


# ---- maps ----

def _sines(m: Floats) -> Doubles:
    return np.sin((np.arange(len(m)) + 0.5) * np.pi / len(m))[:, None, None]


def _seen(m: Floats, rows: int, columns: int, where: Callable[..., Any]) -> Floats:
    """A map of so many rows and columns for each of m, which shows what m has elsewhere: `where`
    gives the place (y, x) in pixels of m for one of the new map."""
    y, x = np.indices((rows * len(m), columns * m.shape[1]))
    y, x = where((y + 0.5) / rows, (x + 0.5) / columns)
    row = np.clip(np.floor(y).astype(int), 0, len(m) - 1)
    return m[row, np.floor(x).astype(int) % m.shape[1]]


def _moved(m: Floats, x: float, y: float) -> Floats:
    """Moved by texels to the right and down; the rim's row is repeated."""
    return _seen(m, 2, 2, lambda row, column: (row - y, column - x))


def _turned(m: Floats, share: float) -> Floats:
    """Turned by a share of 360 degrees, to a half of 1/TURNS."""
    move = round(share * TURNS) / TURNS * m.shape[1]
    return _seen(m, 1, 1 if move % 1 == 0 else max(TURNS // m.shape[1], 1),
                 lambda row, column: (row, column - move))


def _z_up(m: Floats, sign: int) -> Floats:
    """A map whose y was taken for z, or the other way round."""
    h, w = m.shape[:2]

    def where(row: Doubles, column: Doubles) -> Any:
        theta, phi = row * np.pi / h, column * 2 * np.pi / w
        x, y, z = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)
        return (np.arccos(np.clip(sign * y, -1, 1)) * h / np.pi,
                np.arctan2(-sign * z, x) * w / (2 * np.pi))
    fine = max(512 // h, 1)
    return _seen(m, fine, fine, where)


def _bilinear(m: Floats) -> Floats:
    """A map of k x k pixels for each, with the values between the centres of its pixels; k is 8 for
    small maps, where a camera that sees the map would tell 4 from Mitsuba's."""
    k = min(max(2048 // m.shape[1], 2), 8)
    x = (np.arange(k * m.shape[1]) + 0.5) / k - 0.5
    y = np.clip((np.arange(k * len(m)) + 0.5) / k - 0.5, 0, len(m) - 1)
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = (x - left)[None, :, None], (y - top)[:, None, None]
    rows = m[:, left % m.shape[1]] * (1 - fx) + m[:, (left + 1) % m.shape[1]] * fx
    low = np.minimum(top + 1, len(m) - 1)
    return np.ascontiguousarray(rows[top] * (1 - fy) + rows[low] * fy, np.float32)


def _cut(m: Floats, keep: Any) -> Floats:
    out = np.zeros_like(m)
    out[keep] = m[keep]
    return out


def _encoded(v: Any) -> Doubles:
    """Linear values as sRGB's, without an upper end."""
    v = np.maximum(np.asarray(v, np.float64), 0)
    return np.where(v <= 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)


MAPS: dict[str, Callable[[Floats], Any]] = {
    "the map turned by 90 degrees": lambda m: _turned(m, 0.25),
    "the map turned by -90 degrees": lambda m: _turned(m, -0.25),
    "the map turned by 180 degrees": lambda m: _turned(m, 0.5),
    "the map mirrored": lambda m: m[:, ::-1],
    "the map mirrored and turned by 90 degrees": lambda m: _turned(m[:, ::-1], 0.25),
    "the map mirrored and turned by -90 degrees": lambda m: _turned(m[:, ::-1], -0.25),
    "the map mirrored and turned by 180 degrees": lambda m: _turned(m[:, ::-1], 0.5),
    "the map upside down": lambda m: m[::-1],
    "the map upside down and mirrored": lambda m: m[::-1, ::-1],
    "y of the map taken for z": lambda m: _z_up(m, 1),
    "z of the map taken for y": lambda m: _z_up(m, -1),
    "the map half a texel to the right": lambda m: _moved(m, 0.5, 0),
    "the map half a texel to the left": lambda m: _moved(m, -0.5, 0),
    "the map half a texel down": lambda m: _moved(m, 0, 0.5),
    "the map half a texel up": lambda m: _moved(m, 0, -0.5),
    "the rows at the poles missing": lambda m: _cut(m, np.s_[1:-1]),
    "the last column missing (the seam)": lambda m: _cut(m, np.s_[:, :-1]),
    "sin(theta) missing in the density (1/sin too much light)": lambda m: m / _sines(m),
    "sin(theta) twice": lambda m: m * _sines(m),
    "the map decoded from sRGB": srgb,
    "the map encoded as sRGB": _encoded,
    "the lower half of the map missing": lambda m: _cut(m, np.s_[:len(m) // 2]),
    "the upper half of the map missing": lambda m: _cut(m, np.s_[len(m) // 2:]),
    "the left half of the map missing": lambda m: _cut(m, np.s_[:, m.shape[1] // 2:]),
    "the right half of the map missing": lambda m: _cut(m, np.s_[:, :m.shape[1] // 2]),
}
CHANNELS = {"red and blue": [2, 1, 0], "red and green": [1, 0, 2], "green and blue": [0, 2, 1]}

# ---- factors ----

FACTOR, ON_SURFACES = "factor", ", on surfaces"
ANY_FACTOR, CUT = "the light times ", "the map cut off at "  #: with any number

FACTORS = {
    "twice the light (MIS without weights, or +1 EV)": 2.0,
    "half of the light (one of two samplers lost, or -1 EV)": 0.5,
    "pi times the light (1/pi of the albedo missing)": math.pi,
    "1/pi of the light (1/pi twice)": 1 / math.pi,
    "4 pi times the light": 4 * math.pi, "1/(4 pi) of the light": 1 / (4 * math.pi),
    "2 pi times the light": 2 * math.pi, "1/(2 pi) of the light": 1 / (2 * math.pi),
    "four times the light (+2 EV)": 4.0, "a quarter of the light (-2 EV)": 0.25}


def _factor(theirs: Doubles, of: Truth, fixed: Doubles) -> tuple[str, Truth]:
    """The factor of a picture, without a fixed part (h, w, 3), by least squares over tiles; and its
    name."""
    f, se = fit(theirs - fixed, of._replace(copies=of.copies - fixed))
    name = ANY_FACTOR + "%.4g +- %.1g" % (f, se)
    for known, value in FACTORS.items():
        if abs(f - value) <= 4 * se:
            name, f = known, value
    return name, of._replace(copies=fixed + f * (of.copies - fixed))


# ---- scenes and films ----

def _numbers(names: str, change: Callable[[float], float]) -> Callable[[str], str]:
    """An edit of a scene's text: the numbers of parameters."""
    find = re.compile(r'("(?:float|rgb|color|spectrum) (?:%s)"\s*\[?)([-+.\deE\s]+)' % names)

    def each(m: re.Match[str]) -> str:
        values = [repr(change(float(v))) for v in m.group(2).split()]
        return m.group(1) + " ".join(values) + " "
    return lambda text: find.sub(each, text)


_ROUGH = "exponent|roughness|uroughness|vroughness"
_ALBEDO = r'Kd|(?<="diffuse" "rgb )reflectance'  # a metal's is no albedo
TEXTS: dict[str, Callable[[str], str]] = {
    "the roughness (or exponent) squared": _numbers(_ROUGH, lambda v: v * v),
    "the root of the roughness (or exponent)": _numbers(_ROUGH, math.sqrt),
    "the albedo decoded from sRGB": _numbers(_ALBEDO, lambda v: float(srgb(v))),
    "the albedo encoded as sRGB": _numbers(_ALBEDO, lambda v: float(_encoded(v))),
}
_HALF = FINE // 2
FILMS = {"the film half a pixel to the right": (0, -_HALF),
         "the film half a pixel to the left": (0, _HALF),
         "the film half a pixel down": (-_HALF, 0), "the film half a pixel up": (_HALF, 0)}


def _gauss(x: Doubles, sigma: float) -> Doubles:
    return np.exp(-x * x / (2 * sigma * sigma))


def _taps(f: Callable[[Doubles], Doubles], radius: float) -> Doubles:
    """Weights of subpixels of a filter, in pixels from the centre."""
    n = math.ceil(radius * FINE)
    x = (np.arange(-n, n) + 0.5) / FINE
    t = np.where(abs(x) < radius, f(x), 0)
    return t / t.sum()


FILTERS = {
    "a tent as filter": _taps(lambda x: 1 - abs(x), 1),
    "a Gaussian as filter (pbrt-v4's)": _taps(lambda x: _gauss(x, .5) - _gauss(1.5, .5), 1.5),
    "a Gaussian as filter (Mitsuba's)": _taps(lambda x: _gauss(x, .5) - _gauss(2, .5), 2),
}


def _cos(wi: Doubles, hit: dict[str, Any]) -> Doubles:
    return np.maximum(wi @ hit["normal"], 1e-6)


def separable(wi: Doubles, hit: dict[str, Any]) -> Doubles:
    """The masking of facets as a product of two, over the one that is correlated in height."""
    alpha = hit["material"]["alpha"]
    if alpha is None:
        return np.ones(len(wi))
    a, b = (np.sqrt(1 + alpha ** 2 * (1 / (c * c) - 1)) for c in (_cos(wi, hit), hit["cos_wo"]))
    return 2 * (a + b) / ((1 + a) * (1 + b))


def head_on(wi: Doubles, hit: dict[str, Any]) -> Doubles:
    """What a metal of eta 1 reflects head on, over what it reflects at the angle of facets."""
    r = np.mean(hit["material"]["Ks"])
    if hit["material"]["alpha"] is None or any(hit["material"]["Kd"]) or not 0 < r < 1:
        return np.ones(len(wi))
    c2 = (1 + wi @ hit["wo"]) / 2
    k2 = 4 * r / (1 - r)
    q = np.sqrt((c2 - k2) ** 2 + 4 * k2)
    t = np.sqrt(2 * (q + c2 - k2) * c2)
    s = (q + c2 - t) / (q + c2 + t)
    s2 = 1 - c2
    p = s * (c2 * q + s2 * s2 - t * s2) / (c2 * q + s2 * s2 + t * s2)
    return 2 * r / (s + p)


WEIGHTS: dict[str, Weight] = {
    "the cosine missing": lambda wi, hit: 1 / _cos(wi, hit), "the cosine twice": _cos,
    "Fresnel missing": head_on}
CURVES: dict[str, Callable[[Doubles], Doubles]] = {
    "sRGB's curve": _encoded,
    "sRGB's curve (cut off at 1)": lambda v: np.minimum(_encoded(v), 1),
    "a gamma of 2.2": lambda v: np.maximum(v, 0) ** (1 / 2.2),
    "a gamma of 2.2 (cut off at 1)": lambda v: np.clip(v, 0, 1) ** (1 / 2.2),
    "Reinhard's curve": lambda v: np.maximum(v, 0) / (1 + np.maximum(v, 0)),
    "values cut off at 1": lambda v: np.minimum(v, 1)}


# ---- which of them ----

def _of_picture(change: Callable[[Doubles], Doubles]) -> Make:
    return lambda s: s.truth(change(s.copies()))


def _of_map(change: Callable[[Floats], Any]) -> Make:
    return lambda s: s.under(change)


CAUSES: dict[str, Make] = {
    FACTOR: Studio.right,
    FACTOR + ON_SURFACES: lambda s: s.right() if (s.alpha < 1).any() else None,
    **{name: _of_picture(curve) for name, curve in CURVES.items()},
    "shadows missing": lambda s: s.truth(np.where(
        s.alpha[..., None] > 0, s.copies("unoccluded"), s.copies())),
    "surfaces black (as by normals that point inwards)": lambda s: s.truth(
        s.copies() * (1 - s.alpha[..., None]), s.outlines),
    "the film mirrored": lambda s: s.flipped(np.s_[:, ::-1]),
    "the film upside down": lambda s: s.flipped((np.s_[::-1],)),
    **{name + " exchanged in the picture": _of_picture(lambda c, o=order: c[..., o])
       for name, order in CHANNELS.items()},
    **{name: lambda s, t=text: s.edited(t) for name, text in TEXTS.items()},
    **{name: lambda s, w=weight: s.weighed(w) for name, weight in WEIGHTS.items()},
    **{name: _of_map(change) for name, change in MAPS.items()},
    **{name + " exchanged in the map": _of_map(lambda m, o=order: m[..., o])
       for name, order in CHANNELS.items()},
    **{name: lambda s, y=y, x=x: s.filtered(np.ones(FINE) / FINE, y, x)
       for name, (y, x) in FILMS.items()},
    **{name: lambda s, t=taps: s.filtered(t) for name, taps in FILTERS.items()},
}


def _far(verdict: Verdict) -> float:
    """How far a picture is off, also where all p are 0."""
    return float(np.mean(verdict.z ** 2))


def _try(studio: Studio, name: str, make: Make, theirs: Doubles,
         rounding: float) -> Optional[Found]:
    """Hold a cause against the picture, at a studio's level. None: the scene cannot have it."""
    truth = studio.once(make, lambda: make(studio))
    key = name
    if truth is None:
        return None
    fixed = None
    if name.startswith(FACTOR):
        fixed = truth.mean * (1 - studio.alpha[..., None]) * name.endswith(ON_SURFACES)
        said, truth = _factor(theirs, truth, fixed)
        name = name.replace(FACTOR, said)
    return Found(name, judge(theirs, truth, rounding), truth, key, make, fixed)


def _cut_off(m: Floats, power: float) -> Floats:
    return np.minimum(m, 2.0 ** power)


NUMBERS: dict[str, Callable[[Floats, float], Any]] = {
    "the map turned by %.4g degrees": _turned,
    "the map mirrored and turned by %.4g degrees": lambda m, v: _turned(m[:, ::-1], v),
    CUT + "%.3g": _cut_off}


def _fitted(studio: Studio, theirs: Doubles, name: str, coarse: Sequence[float]) -> float:
    """The number with which a change of the map fits best: the best of the coarse ones, then by
    halves of their step, last by least squares on the line between its neighbours. One copy is
    enough for this, as whether the number fits is tested later."""
    studio.at(LEVELS[1])
    right = studio.right()
    x = tile_means(right, theirs)
    weight = 1 / (x + x.mean()) ** 2

    def off(value: float) -> Doubles:
        return studio.once((name, value), lambda: tile_means(
            right, studio.under(lambda m: NUMBERS[name](m, value)).copies)) - x

    def far(value: float) -> float:
        return float(np.sum(weight * off(value) ** 2))
    step = abs(coarse[1] - coarse[0])
    studio.at((1, 2))
    best = min(coarse, key=far)
    studio.at((1, 8))
    for _ in range(4):
        step /= 2
        best = min((best, best - step, best + step), key=far)
    slope = off(best + step) - off(best - step)
    power = float(np.sum(weight * slope ** 2))
    move = -2 * float(np.sum(weight * slope * off(best))) / power if power > 0 else 0.0
    return best + step * min(max(move, -1), 1)


def _of_numbers(studio: Studio, theirs: Doubles, names: Iterable[str]) -> dict[str, Make]:
    """Causes with a number that no list holds. A cut is tried where it is printed, because a camera
    that sees the map would tell 7.503 from 7.5."""
    causes: dict[str, Make] = {}
    if not theirs.any():
        return causes
    most = math.log2(studio.map.pixels.max())
    for name in names:
        change = NUMBERS[name]
        if change is _cut_off:
            v = _fitted(studio, theirs, name, [most - i for i in range(1, 9)])
            name = name % 2 ** v
            v = math.log2(float(name.split()[-1]))
        else:
            v = _fitted(studio, theirs, name, [i / 32 for i in range(32)])
            name = name % (360 * (v - round(v)))
            if abs(4 * v - round(4 * v)) < 4 / TURNS:
                continue  # quarters are in the list
        causes[name] = _of_map(lambda m, f=change, v=v: f(m, v))
    return causes


def _open_numbers(found: list[Found]) -> list[str]:
    """Which numbers have to be fitted: all if nothing fits; else those by which the causes that fit
    have a twin under some maps."""
    fits = " ".join(f.name for f in found if f.verdict.is_right)
    turned, mirrored, cut = NUMBERS
    if not fits:
        return [turned, mirrored, cut]
    return ([turned] * ("map mirrored" in fits) + [mirrored] * ("map turned" in fits)
            + [cut] * ("the light" in fits))


def _refined(studio: Studio, causes: dict[str, Make], theirs: Doubles,
             rounding: float) -> list[Found]:
    """Hold causes against pictures, each at levels until it is rejected or exact enough."""
    found: list[Found] = []
    for level in LEVELS[:-1]:
        if not causes:
            break
        studio.at(level)
        left = {}
        for name, make in causes.items():
            one = _try(studio, name, make, theirs, rounding)
            if one is None:
                continue
            enough = one.verdict.own < SMALL * max(one.verdict.noise, rounding)
            if one.verdict.p < REJECTED or enough or level == LEVELS[-2]:
                found.append(one)
            else:
                left[name] = make
        causes = left
    return found


def search(studio: Studio, theirs: Doubles, rounding: float = ROUNDING,
           causes: Optional[dict[str, Make]] = None) -> list[Found]:
    """Hold all causes, or some, against pictures (k, h, w, 3) that are wrong. The one that fits
    best comes first."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a half of a map may be black
        found = _refined(studio, causes or CAUSES, theirs, rounding)
        if causes is None and studio.map is not None:
            more = _of_numbers(studio, theirs, _open_numbers(found))
            found += _refined(studio, more, theirs, rounding)
    return sorted(found, key=lambda f: (-max(f.verdict.p, REJECTED), _far(f.verdict)))


def apart(studio: Studio, names: Sequence[str] = ()) -> tuple[list[str], Doubles]:
    """Names of the right picture and of all kinds, or some, without a number of their own, (n,),
    and up to which noise of a tile any two differ by SIGMAS, (n, n): where they differ most, less
    the error of the pictures."""
    right = studio.right()
    makes: dict[str, Make] = {}
    for name, make in CAUSES.items():
        if not name.startswith(FACTOR):
            makes.setdefault(kind(name), make)
    makes.update((kind(k), _of_picture(lambda c, v=v: v * c)) for k, v in FACTORS.items())
    told = {"right": features(right, right)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for name in names or makes:
            if name in makes:
                told[name] = features(makes[name](studio) or right, right)
    f = np.array(list(told.values()))
    noise = []
    for one in f:
        d = one - f
        own = d.var(1, ddof=1) / studio.n
        own = np.maximum(own, np.median(own, 0))  # copies may agree by chance
        noise.append(np.sqrt(np.max(d.mean(1) ** 2 / SIGMAS ** 2 - own, -1, initial=0)))
    return list(told), np.array(noise)
