# SPDX-License-Identifier: BSD-2-Clause
"""Pictures from files and into them, and how far one is from another."""
from __future__ import annotations

import ctypes
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._library import Error, Floats, call, flat, opened, real, text_bytes, texts
from ._sampling import _picture, taken


Path = Union[str, "os.PathLike[str]"]


class Place(NamedTuple):
    """Where the pixels of a file lie in their picture.

    Parameters
    ----------
    x, y : int
        Column and row of the first pixel.
    width, height : int
        Size of the picture that they are a part of.
    """

    x: int
    y: int
    width: int
    height: int


@dataclass(frozen=True)
class Comparison:
    """What `compare` returns: the figures of `bis compare`.

    Attributes
    ----------
    mean_a, mean_b : float
        Over pixels and channels.
    bias, bias_se : float
        mean_a - mean_b, and its standard error from the scatter of the pixels.
    rmse, relmse : float
        relmse is the mean of (a-b)^2 / (b^2 + m^2/100), m = mean_b.
    max_abs : float
        The largest difference.
    pixels, nonfinite : int
        How many pixels were compared, and how many left out, because a value in them is NaN or
        infinite.
    """

    mean_a: float
    mean_b: float
    bias: float
    bias_se: float
    rmse: float
    relmse: float
    max_abs: float
    pixels: int
    nonfinite: int


def read_image(path: Path) -> tuple[Floats, Place]:
    """Read a picture.

    Parameters
    ----------
    path : str or path
        An .exr, .hdr or .pfm file; its first bytes tell which.

    Returns
    -------
    pixels : array (h, w, 3)
        Linear radiance, row 0 at the top. Of an EXR, its data window.
    place : Place
        Where they lie. Only EXR tells: the others are the whole picture.

    Raises
    ------
    Error
        The file cannot be read, or is no picture.
    """
    pixels, place = taken(opened(flat.image_read, text_bytes("path", path)))
    return pixels, Place(*place)


def _weights(name: str, values: Optional[ArrayLike], picture: Floats) -> Optional[Floats]:
    """A value for each pixel of a picture, if there are values."""
    a = None if values is None else np.ascontiguousarray(values, np.float32)
    if a is not None and a.shape != picture.shape[:2]:
        raise Error("%s has the shape %s: give %s" % (name, a.shape, picture.shape[:2]))
    return a


def save_image(path: Path, pixels: ArrayLike, exposure: Optional[float] = None,
               attributes: Optional[Mapping[str, str]] = None, *,
               alpha: Optional[ArrayLike] = None) -> None:
    """Write a picture, under a temporary name that is renamed at the end.

    Parameters
    ----------
    path : str or path
        Its ending tells the format: .exr (float32), .pfm, .hdr, or .png (sRGB, 8 bit).
    pixels : array (h, w, 3)
        Linear radiance.
    exposure : float, optional
        Of a .png, in EV; without it, the log-average of the picture becomes middle grey.
    attributes : dict of str, optional
        Texts for the header of an .exr, as ``{"bis:mapping": "angular"}`` for a map.
    alpha : array (h, w), optional
        Of an .exr and a .png; pixels are premultiplied by it.

    Raises
    ------
    Error
        The ending is unknown, the file cannot be written, or .hdr cannot hold a value.
    """
    a = _picture("pixels", pixels)
    ev = float("nan") if exposure is None else real("exposure", exposure)
    shares = _weights("alpha", alpha, a)
    said = [text_bytes("an attribute", "%s=%s" % pair) for pair in (attributes or {}).items()]
    call(flat.image_save, text_bytes("path", path), a.shape[1], a.shape[0], a, shares, ev,
         texts(said))


def png(pixels: ArrayLike, exposure: float) -> bytes:
    """The .png that `save_image` writes, as bytes."""
    a = _picture("pixels", pixels)
    # Three bytes a pixel, and what packing in vain adds.
    room = 4 * a.shape[0] * a.shape[1] + (1 << 16)
    data, length = ctypes.create_string_buffer(room), ctypes.c_size_t()
    call(flat.image_png, a.shape[1], a.shape[0], a, real("exposure", exposure), room, data,
         ctypes.byref(length))
    return data.raw[:length.value]


def exposure_of(pixels: ArrayLike, coverage: Optional[ArrayLike] = None) -> float:
    """The exposure that `save_image` gives a .png.

    Parameters
    ----------
    pixels : array (h, w, 3)
        Linear radiance.
    coverage : array (h, w), optional
        The weight of each pixel in the log-average, in [0, 1]: alpha, so that a background does not
        count.

    Returns
    -------
    float
        In EV.

    Raises
    ------
    Error
        The shapes do not fit.
    """
    a = _picture("pixels", pixels)
    weights = _weights("coverage", coverage, a)
    found = ctypes.c_double()
    call(flat.image_exposure, ctypes.byref(found), a.shape[1], a.shape[0], a, weights)
    return found.value


def _two(a: ArrayLike, b: ArrayLike) -> tuple[Floats, Floats]:
    """Two pictures of one size."""
    first, second = _picture("a", a), _picture("b", b)
    if first.shape != second.shape:
        raise Error("images of %d x %d and %d x %d pixels cannot be compared; sizes must be equal"
                    % (first.shape[1], first.shape[0], second.shape[1], second.shape[0]))
    return first, second


def compare(a: ArrayLike, b: ArrayLike) -> Comparison:
    """Tell how far a picture is from a reference.

    Parameters
    ----------
    a, b : array (h, w, 3)
        The picture and the reference.

    Returns
    -------
    Comparison
        The figures of `bis compare`, to the bit.

    Raises
    ------
    Error
        The sizes differ.
    """
    a, b = _two(a, b)
    figures = (ctypes.c_double * 9)()
    call(flat.image_compare, figures, a.shape[1], a.shape[0], a, b)
    return Comparison(*figures[:7], int(figures[7]), int(figures[8]))


def compare_colours(a: ArrayLike, b: ArrayLike) -> Floats:
    """Show where a picture is far from a reference, in the false colours of `bis compare --diff`.

    Parameters
    ----------
    a, b : array (h, w, 3)
        The picture and the reference.

    Returns
    -------
    array (h, w, 3)
        Black, blue, red, yellow, white for relative errors from 0.001 to 10; magenta where a value
        is not finite.

    Raises
    ------
    Error
        The sizes differ.
    """
    a, b = _two(a, b)
    colours = np.empty(a.shape, np.float32)
    call(flat.image_errors, colours, a.shape[1], a.shape[0], a, b)
    return colours
