# SPDX-License-Identifier: BSD-2-Clause
"""What the runs are compared with.

No method may judge itself: an error that its render and its reference share would not be seen. So
there are two references, by the best mis of the pilot for sir and rejection, and by the best sir
for em, brdf and mis, each the mean of eight renders with seeds of their own. That shows a bias.
Noise needs no other method, but the least noise: it is measured from the mean of both references,
weighted by 1/variance (a reference by mis may be ten times as noisy as what it judges, and would
hide which is the better). The eight say what the reference itself is worth: the standard error of
its mean, and its noise as a share of relMSE, which adds to that of whoever is compared with it (the
errors are independent) and can be subtracted. Each is a file in references/, so an interrupted
measurement loses one at most. A given reference is trusted: nothing tells its noise.

All sums run in the order of the pixels, because a sum in pairs, as numpy's, would have other last
digits than those of an older measurement of the folder.
"""
from __future__ import annotations

import math
import os
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from ..._errors import Error, Status
from ..._image import read_image, save_image
from ..scenes import hashed
from .model import REPLICATES, Image, Reference, Trade
from .plan import Frame
from .stats import total

_MAKERS = ("mis", "sir")


def in_order(values: NDArray[np.float64]) -> float:
    """The sum of values, one after the other."""
    return float(np.add.accumulate(values.ravel())[-1])


def mean_of(image: Image) -> float:
    """The mean over pixels and channels."""
    a = image.astype(np.float64)
    return in_order(a[:, :, 0] + a[:, :, 1] + a[:, :, 2]) / (3.0 * a.shape[0] * a.shape[1])


# ---- from replicates to one ----

def combine(replicates: list[Image]) -> Reference:
    """The mean over renders that differ in their seeds alone, and what it is worth.

    relmse is the variance of the mean over pixels and channels, each divided by (mean^2 + m^2/100),
    m the mean of all.
    """
    n = len(replicates)
    means = [mean_of(r) for r in replicates]
    mean = total(v / n for v in means)
    m2 = total((v - mean) * (v - mean) for v in means)
    image, squares = np.zeros(replicates[0].shape), np.zeros(replicates[0].shape)
    for r in replicates:
        image += r.astype(np.float64) / n
    for r in replicates:
        squares += (r.astype(np.float64) - image) ** 2
    scale = image * image + mean * mean / 100
    variance = squares / (n - 1) / n
    relative = np.divide(variance, scale, out=np.zeros_like(scale), where=scale > 0)
    return Reference(image.astype(np.float32), in_order(relative) / image.size, mean,
                     math.sqrt(m2 / (n - 1) / n))


def combine_both(a: Reference, b: Reference) -> Reference:
    """The mean of two references, or what there is of them."""
    if a.image is None or b.image is None:
        one = a if b.image is None else b
        return Reference(one.image, one.relmse, one.mean)
    # of given ones no noise is known; they are the same
    w = b.relmse / (a.relmse + b.relmse) if b.relmse > 0 else 0.5
    image = np.zeros(a.image.shape)
    if w > 0:
        image += w * a.image.astype(np.float64)
    if w < 1:
        image += (1 - w) * b.image.astype(np.float64)
    return Reference(image.astype(np.float32), w * w * a.relmse + (1 - w) * (1 - w) * b.relmse,
                     w * a.mean + (1 - w) * b.mean)


# ---- making them ----

def _check_size(t: Trade, image: Image, path: str) -> Image:
    film = t.view.frame.film(t.plan.step)
    if image.shape[:2] != (film.height, film.width):
        raise Error("%s: error: %d x %d pixels, must have the %d x %d of plan.txt; remove it and "
                    "it is made again"
                    % (path, image.shape[1], image.shape[0], film.width, film.height))
    return image


def _replicate(t: Trade, which: int, r: int) -> Optional[Image]:
    """Read, or rendered and kept; None: interrupted."""
    path = os.path.join(t.options.folder, "references/%s-%d.exr" % (_MAKERS[which], r + 1))
    setting, passes = t.plan.settings[t.plan.reference[which]], t.plan.reference_passes[which]
    t.tell("reference by " + _MAKERS[which], r / REPLICATES,
           setting.pass_seconds * passes * (REPLICATES - r))
    if os.path.exists(path):
        return _check_size(t, read_image(path)[0], path)
    seed = hashed(hashed(~t.plan.seed) + REPLICATES * which + r) >> 11  # that no run has
    picture = t.view.render(setting, t.plan.step, passes, seed)
    if picture is None:
        return None
    save_image(path, picture.rgb)
    return _check_size(t, picture.rgb, path)


def make_references(t: Trade) -> None:
    """Read what references/ holds and render what it lacks. Where that is interrupted, they are not
    ready."""
    make_folder(t, "references")
    if t.plan.is_given:
        path = os.path.join(t.options.folder, "references/given.exr")
        image = _check_size(t, read_image(path)[0], path)
        t.references = [Reference(image, mean=mean_of(image)) for _ in range(2)]
    for which in range(2):
        replicates: list[Any] = []
        while t.plan.reference[which] >= 0 and len(replicates) < REPLICATES and not t.interrupted():
            replicates.append(_replicate(t, which, len(replicates)))
            if replicates[-1] is None:
                return
        if len(replicates) == REPLICATES:
            t.references[which] = combine(replicates)
    t.both = combine_both(*t.references)


def make_folder(t: Trade, name: str) -> None:
    """Make a folder in that of the measurement, if it is not there."""
    make_one(os.path.join(t.options.folder, name))


def make_one(path: str) -> bool:
    """Make a folder; returns whether it was not there before."""
    try:
        os.mkdir(path)
    except FileExistsError:
        return False
    except OSError as e:
        raise Error('%s: error: cannot make the folder "%s": %s' % (path, path, e.strerror),
                    Status.IO) from None
    return True


# ---- a given one ----

def read_given(path: str, frame: Frame) -> Image:
    """Read a reference of the full picture, the pixels of the scene's crop. An Error tells if it
    has another size."""
    image, at = read_image(path)
    height, width = image.shape[:2]
    film = frame.film(1)
    if (at.width, at.height) != (width, height) and (at.x, at.y) != (film.x, film.y):
        raise Error("%s: error: the reference is the crop at (%d, %d), the scene's is at (%d, %d)"
                    % (path, at.x, at.y, film.x, film.y))
    if (width, height) != (film.width, film.height):
        raise Error("%s: error: the reference has %d x %d pixels, the scene's picture has %d x %d; "
                    "give --resolution %dx%d, or a reference of the scene's size"
                    % (path, width, height, film.width, film.height, width, height))
    return image


def keep_given(t: Trade, full: Image) -> None:
    """Keep the pixels of a given reference that the plan has in the folder."""
    k = t.plan.step
    whole, film = t.view.frame.film(1), t.view.frame.film(k)
    x, y = film.x * k + k // 2 - whole.x, film.y * k + k // 2 - whole.y
    make_folder(t, "references")
    save_image(os.path.join(t.options.folder, "references/given.exr"),
               full[y::k, x::k][:film.height, :film.width])
