# SPDX-License-Identifier: BSD-2-Clause
"""The scene of a sweep, built once for all settings, and one render of it.

Geometry and accelerator serve every integrator; the map is built once for each b, and once more
where mis wants it compensated. The picture is the one that `bis render` makes with the same
setting, passes and seed.
"""
from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from ..._errors import Error
from ..._render import Picture
from .. import command
from ..scenes import open_scene
from .model import Setting, Trade
from .plan import Frame
from .settings import Integrators, Table

_MANY_PIXELS = 1 << 24  # a map of 8192 x 2048: each further importance takes 28 bytes a pixel


class View:
    """The scene, and what trade needs to know of it. It fills in t.plan.settings.

    Parameters
    ----------
    t : Trade
        A measurement that begins.
    known : Integrators
        All integrators.
    say : command.Say
        Where warnings go.

    Raises
    ------
    Error
        The scene has a mistake, or nothing to trade.
    """

    def __init__(self, t: Trade, known: Integrators, say: command.Say) -> None:
        asked = t.options
        settings: dict[str, Any] = {"threads": asked.threads} if asked.threads else {}
        if asked.size:
            settings.update(width=asked.size[0], height=asked.size[1])
        t.tell("reading the scene", math.nan, math.nan)
        self.t = t
        self.scene = open_scene(asked.scene, say, approximate=asked.approximate, **settings)
        about = self.scene.about()
        if about["as_printed"]:
            say.of_library('%s:%d:%d: warning: Option "asprinted" is left out: the methods are '
                           'measured as they should '
                           'be' % (about["integrator_file"], about["integrator_line"],
                                   about["integrator_column"]),
                           False)
        light = about["light"]
        if not about["has_surface"] or light["is_black"]:
            raise Error("%s: error: the scene has no %s: every method gives the same picture at "
                        "once, and there is nothing to "
                        "trade" % (about["path"], "light" if about["has_surface"]
                                              else "surface"))
        pixels = light["width"] * light["height"]
        if not light["is_constant"] and pixels > _MANY_PIXELS:
            say.warn("the map has more than 2^24 pixels: other values of b and compensation are "
                     "left out")
        self.frame = Frame(about["width"], about["height"], tuple(about["crop"]))
        self.files: list[str] = about["files"]
        self.has_map = not light["is_constant"]
        self.built = {(light["area_exponent"], False)}
        t.stratified = about["is_stratified"]
        own = (about["integrator"],
               about["parameters"]) if about["integrator"] in known.rivals() else None
        t.plan.settings = Table(known, light["area_exponent"]).settings(
            asked, self.has_map and pixels <= _MANY_PIXELS, own)

    def render(self, s: Setting, step: int, passes: int, seed: int,
               crop: Optional[Sequence[float]] = None) -> Optional[Picture]:
        """Render with a setting.

        Parameters
        ----------
        s : Setting
            How.
        step : int
            Of each step x step pixels one; 0: a film of one pixel that sees all.
        passes : int
            Camera samples of a pixel.
        seed : int
            Of the random numbers.
        crop : four floats, optional
            In the place of the scene's.

        Returns
        -------
        Picture or None
            None: it was interrupted.

        Raises
        ------
        Error
            As `bis.render`.
        """
        t = self.t
        how: dict[str, Any] = {"step": step, "width": self.frame.width, "height": self.frame.height}
        if step == 0:
            how, crop = {"width": 1, "height": 1}, (0, 1, 0, 1)
        if self.has_map:  # a constant light is the same for all b
            how["area_exponent"] = s.area_exponent
            self._tell_of_light(s)
        if t.options.threads:
            how["threads"] = t.options.threads
        try:
            picture = self.scene.render(integrator=s.integrator, spp=passes, seed=seed, crop=crop,
                                        as_printed="none",
                                        stop=t.interrupted, **how, **s.values)
        except Error:
            if t.interrupted():
                return None
            raise
        if picture.interrupted:
            return None
        t.threads = picture.threads
        t.nonfinite += picture.nonfinite
        return picture

    def _tell_of_light(self, s: Setting) -> None:
        """Tell of what the render will do first."""
        light = s.area_exponent, bool(s.values.get("compensate"))
        if light not in self.built:
            self.built.add(light)
            self.t.tell("building the map's importance", math.nan, math.nan)

    def coverage(self) -> NDArray[np.float32]:
        """The share of geometry in each pixel of the measured window, (h, w)."""
        plan = self.t.plan
        return self.scene.coverage(width=plan.width, height=plan.height)
