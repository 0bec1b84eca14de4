# SPDX-License-Identifier: BSD-2-Clause
"""The point sets of the samplers."""
from __future__ import annotations

from typing import Optional

import numpy as np
from numpy.typing import NDArray

from ._library import call, flat, in_range, text_bytes

_MOST = (1 << 32) - 1
_CAMERA = _MOST  # as a dimension: places in the pixel


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
    count = in_range("n", n, 0, _MOST)
    words = [in_range("seed", seed, 0, (1 << 64) - 1), in_range("pixel", pixel, 0, _MOST),
             in_range("sample", sample, 0, _MOST), in_range("spp", spp, 0, _MOST),
             _CAMERA if dim is None else in_range("dim", dim, 0, _CAMERA - 1)]
    u = np.empty((count, 2))
    call(flat.points, text_bytes("kind", kind), *words, count, u)
    return u
