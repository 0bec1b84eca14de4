# SPDX-License-Identifier: BSD-2-Clause
"""Maps, alias tables and materials on arrays."""
from __future__ import annotations

import ctypes
import os
from typing import Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._library import D, INT, N, P, SAY, TEXT, Error, Handle, Made, WrongType, array, call, declare, given
from ._library import numbers, real, shape, text_bytes

_light_open = declare("light_open", P, TEXT, TEXT, D, TEXT, *SAY)
_light_make = declare("light_make", P, INT, INT, P, TEXT, D, TEXT, *SAY)
_light_close = declare("light_close", P, result=None)
_light_shape = declare("light_shape", P, P, result=None)
_light_pixels = declare("light_pixels", P, P, result=None)
_light_power = declare("light_power", P, result=D)
_light_sample = declare("light_sample", P, N, P, P, P, P, *SAY)
_light_look = declare("light_look", P, N, P, P, P, *SAY)
_alias_build = declare("alias_build", N, P, P, P, P, *SAY)
_alias_sample = declare("alias_sample", N, P, P, N, P, P, *SAY)
_bsdf_open = declare("bsdf_open", P, TEXT, P, P, D, P, P, *SAY)
_bsdf_metal = declare("bsdf_metal", P, P, P, D, P, P, *SAY)
_bsdf_read = declare("bsdf_read", P, TEXT, P, P, *SAY)
_bsdf_close = declare("bsdf_close", P, result=None)
_bsdf_sample = declare("bsdf_sample", P, N, P, P, P, *SAY)
_bsdf_look = declare("bsdf_look", P, N, P, P, P, *SAY)

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]


def _picture(name: str, a: ArrayLike) -> Floats:
    """An array (h, w, 3). The library looks at the sides, but they must fit into its int."""
    raw = given(name, a)
    if raw.dtype.kind not in "iuf":
        raise WrongType("%s is %.60r: give a path, or an array of numbers" % (name, a))
    if raw.ndim != 3 or raw.shape[2] != 3 or max(raw.shape) >= 1 << 31:
        raise Error("%s has the shape %s: give (h, w, 3)" % (name, raw.shape))
    with np.errstate(over="ignore"):  # a double beyond all floats becomes infinite, of which the library tells
        return np.ascontiguousarray(raw, np.float32)


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
        How the map covers the sphere: "latlong", "angular", "equalarea", "mirrorball", "verticalcross",
        "horizontalcross", "cubestrip". A map that is not "latlong" is resampled to one.

    Attributes
    ----------
    shape : tuple of int
        Height and width in pixels.

    Raises
    ------
    Error
        The file cannot be read, or a value is out of its range.
    """

    _close = staticmethod(_light_close)
    _made = ("_handle", "shape")

    def __init__(self, map: Union[str, os.PathLike[str], ArrayLike], table: str = "alias", area_exponent: float = 0.15,
                 mapping: Optional[str] = None) -> None:
        handle = P()
        how = (text_bytes("table", table), real("area_exponent", area_exponent),
               None if mapping is None else text_bytes("mapping", mapping))
        if isinstance(map, (str, bytes, os.PathLike)):
            call(_light_open, ctypes.byref(handle), text_bytes("map", map), *how)
        else:
            a = _picture("map", map)
            call(_light_make, ctypes.byref(handle), a.shape[1], a.shape[0], a.ctypes.data, *how)
        self._handle = handle
        self.shape = shape(_light_shape, handle)

    @property
    def pixels(self) -> Floats:
        """A copy of the radiance, (h, w, 3), row 0 at +z."""
        a = np.empty(self.shape + (3,), np.float32)
        _light_pixels(self._handle, a.ctypes.data)
        return a

    @property
    def power(self) -> float:
        """The integral of r+g+b over the sphere."""
        return float(_light_power(self._handle))

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
        w, L, pdf = np.empty((len(u), 3), np.float32), np.empty((len(u), 3), np.float32), np.empty(len(u))
        call(_light_sample, self._handle, len(u), u.ctypes.data, w.ctypes.data, L.ctypes.data, pdf.ctypes.data)
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
        call(_light_look, self._handle, len(w), w.ctypes.data, L.ctypes.data, pdf.ctypes.data)
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
        call(_alias_build, len(w), w.ctypes.data, prob.ctypes.data, alias.ctypes.data, ctypes.byref(total))
        self.prob, self.alias, self.total = prob, alias, total.value

    def sample(self, n: Optional[int] = None, seed: int = 0, u: Optional[ArrayLike] = None) -> NDArray[np.uint32]:
        """Draw items by their weights.

        Parameters
        ----------
        n : int, optional
            How many. Give n or u.
        seed : int
            Of numpy's random numbers, in [0, 2^53 - 1].
        u : array (n,), optional
            Random numbers in [0, 1) in their place.

        Returns
        -------
        array (n,)
            Items from 0.
        """
        items = np.asarray(self.alias)
        if items.dtype.kind not in "iu" or np.any(items < 0) or np.any(items >= 1 << 32):  # uint32 would wrap
            raise Error("alias holds what is no item: give integers in [0, 4294967295]")
        prob, alias = array(self.prob, 0, np.float64, "prob"), array(self.alias, 0, np.uint32, "alias")
        if len(prob) != len(alias):
            raise Error("prob has %d items and alias has %d" % (len(prob), len(alias)))
        u = numbers(n, 0, seed, u)
        items = np.empty(len(u), np.uint32)
        call(_alias_sample, len(prob), prob.ctypes.data, alias.ctypes.data, len(u), u.ctypes.data, items.ctypes.data)
        return items


def _three(name: str, value: ArrayLike) -> Doubles:
    """Three numbers of a colour; one number is grey."""
    raw = given(name, value)
    if raw.shape not in ((), (3,)) or raw.dtype.kind not in "iuf":
        raise WrongType("%s is %s: give a number or three" % (name, raw))
    return np.ascontiguousarray(np.broadcast_to(raw.astype(np.float64), 3))


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
        Of a metal: refractive index (> 0) and absorption (>= 0) of R, G and B. Facets then reflect by Fresnel's
        equations.
    """

    _close = staticmethod(_bsdf_close)
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
        vectors = [array(given(name, v)[None], 3, np.float64, name) for name, v in (("normal", normal), ("wo", wo))]
        arrays = [a.ctypes.data for a in colours + vectors]
        width = real("exponent", exponent) if roughness is None else real("roughness", roughness)
        handle = P()
        if is_metal:
            call(_bsdf_metal, ctypes.byref(handle), *arrays[:2], width, *arrays[2:])
        else:
            call(_bsdf_open, ctypes.byref(handle), b"phong" if roughness is None else b"microfacet", *arrays[:2],
                 width, *arrays[2:])
        self._handle = handle

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
        vectors = [array(given(name, v)[None], 3, np.float64, name)
                   for name, v in (("normal", normal), ("wo", wo))]
        handle, made = P(), cls.__new__(cls)
        call(_bsdf_read, ctypes.byref(handle), text_bytes("text", text),
             *[v.ctypes.data for v in vectors])
        made._handle = handle
        return made

    def sample(self, n: Optional[int] = None, seed: int = 0,
               u: Optional[ArrayLike] = None) -> tuple[Floats, NDArray[np.bool_]]:
        """Draw directions by the density of the material.

        Parameters
        ----------
        n : int, optional
            How many. Give n or u.
        seed : int
            Of numpy's random numbers, in [0, 2^53 - 1].
        u : array (n, 3), optional
            Random numbers in [0, 1) in their place.

        Returns
        -------
        wi : array (n, 3)
            Unit directions. Some are below the horizon.
        is_specular : array (n,)
            Whether each is of the specular lobe.
        """
        u = numbers(n, 3, seed, u)
        wi, lobe = np.empty((len(u), 3), np.float32), np.empty(len(u), np.uint8)
        call(_bsdf_sample, self._handle, len(u), u.ctypes.data, wi.ctypes.data, lobe.ctypes.data)
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
        call(_bsdf_look, self._handle, len(wi), wi.ctypes.data, f.ctypes.data, pdf.ctypes.data)
        return f, pdf
