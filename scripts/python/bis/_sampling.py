# SPDX-License-Identifier: BSD-2-Clause
"""Maps, alias tables and materials on arrays."""
from __future__ import annotations

import ctypes
import os
from typing import Any, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._library import D, INT, Doubles, Error, Floats, Handle, Made, WrongType, array, call, filled
from ._library import flat, given, numbers, opened, real, shape, text_bytes, texts, whole
from ._irradiance import Harmonics, harmonics, irradiance


def uniform(n: int, seed: int = 0, stream: int = 0) -> Doubles:
    """n numbers of the library's own generator, in [0, 1)."""
    u = np.empty(n)
    flat.uniform(seed, stream, n, u.ctypes.data)
    return u


def _picture(name: str, a: ArrayLike) -> Floats:
    """An array (h, w, 3). The library looks at the sides, but they must fit into its int."""
    raw = given(name, a)
    if raw.dtype.kind not in "iuf" or not raw.ndim:
        raise WrongType("%s is %.60r: give a path, or an array of numbers" % (name, a))
    if raw.ndim != 3 or raw.shape[2] != 3 or max(raw.shape) >= 1 << 31:
        raise Error("%s has the shape %s: give (h, w, 3)" % (name, raw.shape))
    with np.errstate(over="ignore"):  # beyond all floats is infinite, of which the library tells
        return np.ascontiguousarray(raw, np.float32)


def taken(handle: Any) -> tuple[Floats, list[int]]:
    """The pixels (h, w, 3) of an image of the library, and their place. The image is freed."""
    size, place = (INT * 2)(), (INT * 4)()
    try:
        flat.image_place(handle, size, place)
        return filled(flat.image_pixels, handle, (size[1], size[0], 3), np.float32), list(place)
    finally:
        flat.image_close(handle)


class Defects(NamedTuple):
    """Values of a map's file that no radiance has. They count as 0.

    Parameters
    ----------
    nan, infinite, negative : int
        How many there are of each kind.
    solid_angle : float
        Of their pixels, in sr.
    """

    nan: int
    infinite: int
    negative: int
    solid_angle: float


class Regions(NamedTuple):
    """The light sources of a map, as thesis 3.4 finds them: connected pixels of one level.

    Parameters
    ----------
    label : array (h, w)
        The region of each pixel, from 0; -1 where it is black.
    level : array (h, w)
        The level of each pixel, equal steps of the logarithm of r+g+b; -1 where it is black.
    factor : array (h, w)
        The factor of the importance, min(0.01 sr, solid angle of the region)^b over 0.01^b.
    levels : array (n,)
        The level of each region.
    solid_angles : array (n,)
        In sr, of each region.
    """

    label: NDArray[np.signedinteger[Any]]
    level: NDArray[np.int32]
    factor: Doubles
    levels: NDArray[np.int32]
    solid_angles: Doubles


# Rows and columns: an index of the pixels' array.
Pixels = tuple[NDArray[np.int64], NDArray[np.int64]]


class Envmap(Handle):
    """An environment map, in its own frame with z up.

    Parameters
    ----------
    map : str, path or array (h, w, 3)
        An HDR, EXR or PFM file, or radiance with row 0 at the top.
    table : {"alias", "cdf"}
        How directions are drawn: by alias tables (thesis 3.2.2) or by CDFs.
    area_exponent : float
        b of thesis 3.4; 0 is the plain importance.
    mapping : str, optional
        How the map covers the sphere: "latlong", "angular", "equalarea", "mirrorball",
        "verticalcross", "horizontalcross", "cubestrip". A map that is not "latlong" is resampled to
        one.
    levels : int
        Of intensity, in [1, 254], in which regions are found (thesis 3.4).
    width : int, optional
        Of the lat-long map that another one is resampled to; without it, as many pixels as show
        all detail.

    Attributes
    ----------
    shape : tuple of int
        Height and width in pixels.

    Raises
    ------
    Error
        The file cannot be read, or a value is out of its range.
    """

    _close = staticmethod(flat.light_close)
    _made = ("_handle", "shape")

    def __init__(self, map: Union[str, os.PathLike[str], ArrayLike], table: str = "alias",
                 area_exponent: float = 0.15, mapping: Optional[str] = None, *, levels: int = 8,
                 width: Optional[int] = None) -> None:
        said = [b"kind=" + text_bytes("table", table),
                b"area_exponent=" + repr(real("area_exponent", area_exponent)).encode(),
                b"levels=%d" % whole("levels", levels)]
        if mapping is not None:
            said.append(b"mapping=" + text_bytes("mapping", mapping))
        if width is not None:
            said.append(b"width=%d" % whole("width", width))
        if isinstance(map, (str, bytes, os.PathLike)):
            self._handle = opened(flat.light_open_as, text_bytes("map", map), texts(said))
        else:
            a = _picture("map", map)
            self._handle = opened(flat.light_make_as, a.shape[1], a.shape[0], a, texts(said))
        self._levels, self._area_exponent = levels, area_exponent
        self.shape = shape(flat.light_shape, self._handle)

    @property
    def pixels(self) -> Floats:
        """A copy of the radiance, (h, w, 3), row 0 at +z."""
        return filled(flat.light_pixels, self._handle, self.shape + (3,), np.float32)

    @property
    def power(self) -> float:
        """The integral of r+g+b over the sphere."""
        return float(flat.light_power(self._handle))

    @property
    def mapping(self) -> str:
        """How the file covered the sphere. A map that was not "latlong" was resampled to it."""
        return str(flat.light_source(self._handle), "ascii")

    def _facts(self) -> Doubles:
        return filled(flat.light_facts, self._handle, 7)

    @property
    def resampled(self) -> Optional[tuple[float, float]]:
        """The power before and after resampling; None of a map that was not resampled."""
        before, after = self._facts()[:2].tolist()
        return None if self.mapping == "latlong" else (before, after)

    @property
    def defects(self) -> Defects:
        """Values of the file that count as 0."""
        nan, infinite, negative, solid_angle = self._facts()[2:6].tolist()
        return Defects(int(nan), int(infinite), int(negative), solid_angle)

    @property
    def table_bytes(self) -> int:
        """The memory that drawing directions takes, beyond the map."""
        return int(self._facts()[6])

    @property
    def solid_angles(self) -> Doubles:
        """The solid angle in sr of one pixel of each row, (h,)."""
        return filled(flat.light_angles, self._handle, self.shape[0])

    def density(self) -> Doubles:
        """The density with which `sample` draws directions.

        Returns
        -------
        array (h, w)
            In 1/sr, inside each pixel.
        """
        pdf, peak, share = np.empty(self.shape), D(), np.empty(self.shape[0])
        call(flat.light_density, self._handle, pdf, ctypes.byref(peak), share)
        return pdf

    def regions(self, levels: Optional[int] = None,
                area_exponent: Optional[float] = None) -> Regions:
        """Find the light sources of thesis 3.4.

        Parameters
        ----------
        levels : int, optional
            Of intensity, in [1, 254]; without it, those of the map.
        area_exponent : float, optional
            b, for `factor`; without it, that of the map.

        Returns
        -------
        Regions
            Labels and levels of the pixels, and of each region its level and solid angle.
        """
        label, level = np.empty(self.shape, np.uint32), np.empty(self.shape, np.uint32)
        area, factor, n = np.empty(self.shape), np.empty(self.shape), ctypes.c_uint32()
        wanted = whole("levels", self._levels if levels is None else levels)
        # What C's int cannot hold is out of range, too.
        call(flat.light_regions, self._handle, min(max(wanted, 0), 255),
             real("area_exponent", self._area_exponent if area_exponent is None else area_exponent),
             label, level, area, factor, ctypes.byref(n))
        # Black is 2^32 - 1 there, and -1 as a signed number of as many bits. Few maps have 2^31
        # regions.
        kind = np.int32 if n.value < 1 << 31 else np.int64
        lit = level.view(np.int32) >= 0
        levels_of, angles = np.empty(n.value, np.int32), np.empty(n.value)
        levels_of[label[lit]] = level[lit]
        angles[label[lit]] = area[lit]
        labels = label.view(np.int32) if kind is np.int32 else np.where(lit, label, -1).astype(kind)
        return Regions(labels, level.view(np.int32), factor, levels_of, angles)

    def _pixels(self, index: NDArray[np.uint32]) -> Pixels:
        rows, columns = np.divmod(index.astype(np.int64), self.shape[1])
        return rows, columns

    def find(self, w: ArrayLike) -> Pixels:
        """Find the pixels in which directions lie.

        Parameters
        ----------
        w : array (n, 3)
            Directions of any length but 0.

        Returns
        -------
        rows, columns : array (n,)
            So that ``map.pixels[map.find(w)]`` is the radiance from there.
        """
        w = array(w, 3, np.float32, "w")
        pixel = np.empty(len(w), np.uint32)
        call(flat.light_find, self._handle, len(w), w, pixel)
        return self._pixels(pixel)

    def directions(self, rows: ArrayLike, columns: ArrayLike) -> Floats:
        """Where pixels lie.

        Parameters
        ----------
        rows, columns : array (n,)
            Pixels, from 0.

        Returns
        -------
        array (n, 3)
            Unit directions to the middle, by solid angle, of each.
        """
        y, x = array(rows, 0, np.int64, "rows"), array(columns, 0, np.int64, "columns")
        height, width = self.shape
        if y.shape != x.shape or ((y < 0) | (y >= height) | (x < 0) | (x >= width)).any():
            raise Error("rows and columns are no pixels of the map: give as many of each, below %d "
                        "and %d" % self.shape)
        pixel, w = (y * self.shape[1] + x).astype(np.uint32), np.empty((len(y), 3), np.float32)
        call(flat.light_centres, self._handle, len(w), pixel, w)
        return w

    def draw(self, n: Optional[int] = None, seed: int = 0, u: Optional[ArrayLike] = None) -> Pixels:
        """Draw pixels by the importance of the map: those in which the directions of `sample` lie.

        Parameters
        ----------
        n, seed, u
            As in `sample`.

        Returns
        -------
        rows, columns : array (n,)
            Pixels, from 0.
        """
        u = numbers(n, 4, seed, u)
        pixel = np.empty(len(u), np.uint32)
        call(flat.light_draw, self._handle, len(u), u, pixel)
        return self._pixels(pixel)

    def to_mapping(self, mapping: str, width: Optional[int] = None) -> tuple[Floats, float, float]:
        """Resample the map to another mapping; its energy is kept.

        Parameters
        ----------
        mapping : str
            As in `Envmap`.
        width : int, optional
            Of the new picture; without it, as many pixels around the sphere as the map has.

        Returns
        -------
        pixels : array (h, w, 3)
            The new picture. What lies outside a disc or a cross is black.
        before, after : float
            The power of the map and of the new one, which agree but for rounding.
        """
        power = np.empty(2)
        image = opened(flat.image_of_light, self._handle, text_bytes("mapping", mapping),
                       0 if width is None else min(max(whole("width", width), -1), 1 << 30), power)
        before, after = power.tolist()
        return taken(image)[0], before, after

    def irradiance(self, normals: ArrayLike) -> Doubles:
        """Integrate what arrives at surfaces, exactly: nothing hides them.

        Parameters
        ----------
        normals : array (n, 3)
            Of any length but 0.

        Returns
        -------
        array (n, 3)
            The integral of radiance times cosine over the hemisphere, thesis eq. 2.2 without V.
        """
        return irradiance(self, normals)

    def harmonics(self, frame: str = "bis") -> Harmonics:
        """Project the map on nine spherical harmonics, and find how wrong they are.

        Parameters
        ----------
        frame : {"bis", "blender", "mitsuba", "three", "unity"}
            Whose axes: those of a program that shows the same picture.

        Returns
        -------
        Harmonics
            Coefficients of radiance and of irradiance, and the error of the second.
        """
        return harmonics(self, frame)

    def sample(self, n: Optional[int] = None, seed: int = 0,
               u: Optional[ArrayLike] = None) -> tuple[Floats, Floats, Doubles]:
        """Draw directions by the importance of the map.

        Parameters
        ----------
        n : int, optional
            How many. Give n or u.
        seed : int
            Of numpy's random numbers, in [0, 2^53 - 1].
        u : array (n, 4), optional
            Random numbers in [0, 1) in their place.

        Returns
        -------
        w : array (n, 3)
            Unit directions.
        L : array (n, 3)
            Radiance from there.
        pdf : array (n,)
            The density in 1/sr.
        """
        u = numbers(n, 4, seed, u)
        w, L = np.empty((2, len(u), 3), np.float32)
        pdf = np.empty(len(u))
        call(flat.light_sample, self._handle, len(u), u, w, L, pdf)
        return w, L, pdf

    def look(self, w: ArrayLike) -> tuple[Floats, Doubles]:
        """Look into directions.

        Parameters
        ----------
        w : array (n, 3)
            Directions of any length but 0.

        Returns
        -------
        L : array (n, 3)
            Radiance from there.
        pdf : array (n,)
            The density in 1/sr with which `sample` draws them.
        """
        w = array(w, 3, np.float32, "w")
        L, pdf = np.empty((len(w), 3), np.float32), np.empty(len(w))
        call(flat.light_look, self._handle, len(w), w, L, pdf)
        return L, pdf


class AliasTable(Made):
    """The two tables of thesis 3.2.2.

    Parameters
    ----------
    weights : array (n,)
        Finite numbers >= 0, not all of them 0.

    Attributes
    ----------
    prob : array (n,)
        The probability to stay in a bin.
    alias : array (n,)
        The item that is drawn otherwise.
    total : float
        The sum of the weights.
    """

    _made = ("prob", "alias", "total")

    def __init__(self, weights: ArrayLike) -> None:
        w = array(weights, 0, np.float64, "weights")
        prob, alias, total = np.empty(len(w)), np.empty(len(w), np.uint32), D()
        call(flat.alias_build, len(w), w, prob, alias, ctypes.byref(total))
        self.prob, self.alias, self.total = prob, alias, total.value

    def sample(self, n: Optional[int] = None, seed: int = 0,
               u: Optional[ArrayLike] = None) -> NDArray[np.uint32]:
        """Draw items by their weights.

        Parameters
        ----------
        n, seed, u
            As in `Envmap.sample`; u is an array (n,).

        Returns
        -------
        array (n,)
            Items from 0.
        """
        items = np.asarray(self.alias)
        # uint32 would wrap
        if items.dtype.kind not in "iu" or np.any(items < 0) or np.any(items >= 1 << 32):
            raise Error("alias holds what is no item: give integers in [0, 4294967295]")
        prob = array(self.prob, 0, np.float64, "prob")
        alias = array(self.alias, 0, np.uint32, "alias")
        if len(prob) != len(alias):
            raise Error("prob has %d items and alias has %d" % (len(prob), len(alias)))
        u = numbers(n, 0, seed, u)
        items = np.empty(len(u), np.uint32)
        call(flat.alias_sample, len(prob), prob, alias, len(u), u, items)
        return items


def _three(name: str, value: ArrayLike) -> Doubles:
    """Three numbers of a colour; one number is grey."""
    raw = given(name, value)
    if raw.shape not in ((), (3,)) or raw.dtype.kind not in "iuf":
        raise WrongType("%s is %s: give a number or three" % (name, raw))
    return np.ascontiguousarray(np.broadcast_to(raw.astype(np.float64), 3))


def _vectors(normal: ArrayLike, wo: ArrayLike) -> list[Doubles]:
    return [array(given(name, v)[None], 3, np.float64, name)
            for name, v in (("normal", normal), ("wo", wo))]


class Material(Handle):
    """A material at a point, seen from wo.

    Give Kd and Ks with an exponent or a roughness, or a metal's eta and k with a roughness.

    Parameters
    ----------
    Kd, Ks : float or array (3,)
        The diffuse and the specular colour, in [0, 1].
    exponent : float, optional
        Of Phong's model.
    roughness : float, optional
        Of microfacets (GGX), in [0.01, 1].
    normal, wo : array (3,)
        The normal, and the direction to the eye, of any length but 0.
    eta, k : float or array (3,), optional
        Of a metal: refractive index (> 0) and absorption (>= 0) of R, G and B. Facets then reflect
        by Fresnel's equations.
    """

    _close = staticmethod(flat.bsdf_close)
    _made = ("_handle",)

    def __init__(self, Kd: Optional[ArrayLike] = None, Ks: Optional[ArrayLike] = None,
                 exponent: Optional[float] = None, roughness: Optional[float] = None,
                 normal: ArrayLike = (0, 0, 1), wo: ArrayLike = (0, 0, 1),
                 eta: Optional[ArrayLike] = None, k: Optional[ArrayLike] = None) -> None:
        is_metal = eta is not None or k is not None
        if (exponent is None) == (roughness is None) or is_metal and roughness is None:
            raise Error("give exponent (Phong) or roughness (microfacets, a metal), one of both")
        names = ("eta", "k") if is_metal else ("Kd", "Ks")
        parts = {"Kd": Kd, "Ks": Ks, "eta": eta, "k": k}
        if [name for name in parts if parts[name] is not None] != list(names):
            raise Error("give Kd and Ks, or of a metal eta and k")
        colours = [_three(name, parts[name]) for name in names]
        vectors = _vectors(normal, wo)
        width = real("exponent", exponent) if roughness is None else real("roughness", roughness)
        if is_metal:
            self._handle = opened(flat.bsdf_metal, *colours, width, *vectors)
        else:
            model = b"phong" if roughness is None else b"microfacet"
            self._handle = opened(flat.bsdf_open, model, *colours, width, *vectors)

    @classmethod
    def of(cls, text: str, normal: ArrayLike = (0, 0, 1), wo: ArrayLike = (0, 0, 1)) -> Material:
        """Make a material of its text in a scene.

        Parameters
        ----------
        text : str
            Of any model that scenes have, as ``'Material "coateddiffuse" "rgb reflectance" .5'``.
        normal, wo : array (3,)
            As of `Material`.

        Returns
        -------
        Material
            At a point, seen from wo.
        """
        vectors = _vectors(normal, wo)
        made = cls.__new__(cls)
        made._handle = opened(flat.bsdf_read, text_bytes("text", text), *vectors)
        return made

    def sample(self, n: Optional[int] = None, seed: int = 0,
               u: Optional[ArrayLike] = None) -> tuple[Floats, NDArray[np.bool_]]:
        """Draw directions by the density of the material.

        Parameters
        ----------
        n, seed, u
            As in `Envmap.sample`; u is an array (n, 3).

        Returns
        -------
        wi : array (n, 3)
            Unit directions. Some are below the horizon.
        is_specular : array (n,)
            Whether each is of the specular lobe.
        """
        u = numbers(n, 3, seed, u)
        wi, lobe = np.empty((len(u), 3), np.float32), np.empty(len(u), np.uint8)
        call(flat.bsdf_sample, self._handle, len(u), u, wi, lobe)
        return wi, lobe.astype(bool)

    def look(self, wi: ArrayLike) -> tuple[Floats, Doubles]:
        """Look into directions.

        Parameters
        ----------
        wi : array (n, 3)
            Directions of any length but 0.

        Returns
        -------
        f : array (n, 3)
            The BRDF in 1/sr, without the cosine.
        pdf : array (n,)
            The density in 1/sr with which `sample` draws them.
        """
        wi = array(wi, 3, np.float32, "wi")
        f, pdf = np.empty((len(wi), 3), np.float32), np.empty(len(wi))
        call(flat.bsdf_look, self._handle, len(wi), wi, f, pdf)
        return f, pdf
