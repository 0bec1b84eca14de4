# SPDX-License-Identifier: BSD-2-Clause
"""The point sets of the samplers."""
from __future__ import annotations

import ctypes
from typing import Optional

import numpy as np
from numpy.typing import NDArray

from ._errors import Error
from ._library import N, P, SAY, TEXT, call, declare, text_bytes, whole

_U32, _CAMERA = ctypes.c_uint32, (1 << 32) - 1
_points = declare("points", TEXT, ctypes.c_uint64, _U32, _U32, _U32, _U32, N, P, *SAY)


def points(kind: str, n: int, seed: int = 0, *, dim: Optional[int] = 0, pixel: int = 0,
           sample: int = 0, spp: int = 1) -> NDArray[np.float64]:
    """Return points of a sampler, those that an integrator or the camera gets.

    Parameters
    ----------
    kind : {"random", "stratified", "sobol", "halton"}
        As the Sampler of a scene.
    n : int
        How many.
    seed : int
        In [0, 2^64 - 1].
    dim : int or None
        Which pair of dimensions. None: the places in the pixel of n camera samples from `sample`
        on.
    pixel : int
        y * width + x: each pixel has points of its own.
    sample : int
        The camera sample. Over the samples of a pixel, the sets of one `dim` continue each other.
    spp : int
        How many camera samples the pixel has.

    Returns
    -------
    array (n, 2)
        In [0, 1).

    Raises
    ------
    Error
        A number is out of its range, or there is no such kind.
    """
    count = whole("n", n)
    ranges = [("seed", seed, 1 << 64), ("pixel", pixel, 1 << 32), ("sample", sample, 1 << 32),
              ("spp", spp, 1 << 32),
              ("dim", _CAMERA if dim is None else dim, _CAMERA + (dim is None))]
    for name, value, end in [("n", count, 1 << 32)] + ranges:
        if not 0 <= whole(name, value) < end:
            raise Error("%s is %s: give an integer in [0, %d]" % (name, value, end - 1))
    u = np.empty((count, 2))
    call(_points, text_bytes("kind", kind), *[whole(name, value) for name, value, _ in ranges],
         count, u.ctypes.data)
    return u
