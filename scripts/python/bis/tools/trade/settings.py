# SPDX-License-Identifier: BSD-2-Clause
"""The settings that are swept, in words and as they stand in a scene file.

One table. Rows differ from the first of their integrator in one thing, so that what is compared is
that thing: N, then M, then the proposal, the stratification, b. The thesis's own setting, 15 of
800, is there for rejection and SIR. A new option of an integrator that changes cost or variance
wants a row here; a new integrator without one is swept with its defaults.
"""
from __future__ import annotations

from typing import Any, NamedTuple, Optional

from .. import text
from .model import Options, Setting


class _Recipe(NamedTuple):
    integrator: str
    candidates: int  # M; 0: none
    rays: int  # N
    variant: str = ""
    quick: bool = False  # in the short sweep, too


_RECIPES = (
    _Recipe("em", 0, 4),
    _Recipe("em", 0, 16, "", True),
    _Recipe("em", 0, 64),
    _Recipe("em", 0, 16, "stratified", True),
    _Recipe("em", 0, 16, "b=0"),
    _Recipe("em", 0, 16, "b=0.5"),
    _Recipe("brdf", 0, 4),
    _Recipe("brdf", 0, 16, "", True),
    _Recipe("brdf", 0, 64),
    _Recipe("mis", 0, 4),
    _Recipe("mis", 0, 16, "", True),
    _Recipe("mis", 0, 64, "", True),
    _Recipe("mis", 0, 16, "stratified", True),
    _Recipe("mis", 0, 16, "power"),
    _Recipe("mis", 0, 16, "compensated", True),
    _Recipe("rejection", 100, 8, "", True),
    _Recipe("rejection", 800, 15),
    _Recipe("rejection", 800, 15, "plain"),
    _Recipe("sir", 16, 1),
    _Recipe("sir", 64, 1),
    _Recipe("sir", 64, 4, "", True),
    _Recipe("sir", 256, 4),
    _Recipe("sir", 256, 16, "", True),
    _Recipe("sir", 1024, 16),
    _Recipe("sir", 800, 15, "", True),
    _Recipe("sir", 256, 16, "em"),
    _Recipe("sir", 256, 16, "brdf"),
    _Recipe("sir", 256, 16, "product", True),
    _Recipe("sir", 256, 16, "product learned", True),
    _Recipe("sir", 256, 16, "independent"),
    _Recipe("sir", 256, 16, "b=0"),
    _Recipe("sir", 256, 16, "b=0.5"),
)

# What a variant changes in its integrator's parameters.
_VARIANTS: dict[str, dict[str, Any]] = {
    "power": {"heuristic": "power"},
    "compensated": {"compensate": True},
    "plain": {"estimator": "plain"},
    "em": {"proposal": "em"},
    "brdf": {"proposal": "brdf"},
    "product": {"proposal": "product"},
    "product learned": {"proposal": "product", "learn": True},
    "stratified": {"stratify": True},
    "independent": {"stratify": False, "resampling": "multinomial"},
}


_TYPES = {"count": "integer", "fraction": "float", "bool": "bool", "choice": "string"}  # in a scene


class Parameter(NamedTuple):
    """A parameter of an integrator, as bis.about() tells of it."""

    name: str
    type: str  #: "count", "fraction", "bool", "choice"
    default: Any
    is_option: bool  #: the command line has --NAME


class Integrators(dict[str, list[Parameter]]):
    """The parameters of each integrator, by its name."""

    @classmethod
    def of(cls, about: dict[str, Any]) -> Integrators:
        """From what bis.about() says."""
        return cls((i["name"], [Parameter(p["name"], p["type"], p["default"], p["is_option"])
                                for p in i["parameters"]])
                   for i in about["integrators"])

    def rivals(self) -> list[str]:
        """Those that are compared. `exact` and `unoccluded` are not, because one is a reference and
        the other leaves the shadows out."""
        return [name for name, parameters in self.items()
                if any(p.name in ("shadowrays", "samples") for p in parameters)]

    def defaults(self, name: str) -> dict[str, Any]:
        """The values of an integrator's parameters where nothing is said."""
        return {p.name: p.default for p in self[name]}

    def scene_text(self, s: Setting, scenes_b: float) -> str:
        """What a scene file says: counts, and what differs from the defaults."""
        words = ['Integrator "%s"' % s.integrator]
        for p in self[s.integrator]:
            value = s.values[p.name]
            if p.type != "count" and value == p.default:
                continue
            quote = '"' if p.type == "choice" else ""
            words.append('"%s %s" %s%s%s' % (_TYPES[p.type], p.name, quote, _word(value), quote))
        b = ""
        if s.area_exponent != scenes_b:
            b = '; in LightSource: "float areaexponent" ' + text.digits(s.area_exponent)
        return " ".join(words) + b

    def option_text(self, s: Setting, scenes_b: float) -> str:
        """What the command line says; "" where it has no such option."""
        words = ["--integrator " + s.integrator]
        is_reachable = s.area_exponent == scenes_b
        for p in self[s.integrator]:
            value = s.values[p.name]
            if p.type != "count" and value == p.default:
                continue
            is_reachable = is_reachable and p.is_option
            words.append("--%s %s" % (p.name, _word(value, ("off", "on"))))
        return " ".join(words) if is_reachable else ""


def _word(value: Any, of_bool: tuple[str, str] = ("false", "true")) -> str:
    if isinstance(value, bool):
        return of_bool[value]
    return value if isinstance(value, str) else text.digits(value)


class Table:
    """Makes the settings for a scene.

    Parameters
    ----------
    known : Integrators
        All integrators and their parameters.
    scenes_b : float
        b of the scene's light.
    """

    def __init__(self, known: Integrators, scenes_b: float) -> None:
        self.known = known
        self.scenes_b = scenes_b

    def _setting(self, integrator: str, values: dict[str, Any], variant: str, b: float) -> Setting:
        rays = values["shadowrays"] if "shadowrays" in values else values["samples"]
        counts = "%d/%d" % (values["candidates"], rays) if "candidates" in values else "%d" % rays
        s = Setting(name=" ".join(["%s %s" % (integrator, counts)] + ([variant] if variant
                                                                      else [])),
                    integrator=integrator, values=values, area_exponent=b,
                    is_biased=values.get("estimator") == "ratio", judge=0 if "shadowrays" in values
                    else 1)
        s.option_text = self.known.option_text(s, self.scenes_b)
        s.scene_text = self.known.scene_text(s, self.scenes_b)
        return s

    def _of(self, r: _Recipe) -> Setting:
        values = self.known.defaults(r.integrator)
        given = {"candidates": r.candidates, "shadowrays": r.rays, "samples": r.rays}
        values.update({name: value for name, value in given.items() if name in values})
        values.update(_VARIANTS.get(r.variant, {}))
        b = float(r.variant[2:]) if r.variant.startswith("b=") else self.scenes_b
        return self._setting(r.integrator, values, r.variant, b)

    def _fits_light(self, r: _Recipe, small_map: bool) -> bool:
        """b and compensation are about the map's importance: nothing of that in a constant light,
        and too much memory for another one in a huge map."""
        if r.variant.startswith("b="):
            return small_map and float(r.variant[2:]) != self.scenes_b
        return small_map or r.variant != "compensated"

    def settings(self, asked: Options, small_map: bool,
                 own: Optional[tuple[str, dict[str, Any]]]) -> list[Setting]:
        """All that make sense for the scene's light, and the scene's own.

        Parameters
        ----------
        asked : Options
            quick and integrators say which of them are swept.
        small_map : bool
            The light is a map that is not huge.
        own : (str, dict) or None
            Integrator and values of the scene; None if it is no rival.

        Returns
        -------
        list of Setting
            In the order of the table; those that are not swept may make a reference.
        """
        settings = []
        for r in _RECIPES:
            if self._fits_light(r, small_map):
                settings.append(self._of(r))
                settings[-1].is_swept = r.quick or not asked.quick
        listed = {r.integrator for r in _RECIPES}
        for name in self.known.rivals():
            if name not in listed:
                settings.append(self._setting(name, self.known.defaults(name), "", self.scenes_b))
        if own:
            self._add_own(settings, *own)
        for s in settings:
            s.is_swept = (s.is_swept or s.is_scenes) and (not asked.integrators
                                                          or s.integrator in asked.integrators)
        return settings

    def _add_own(self, settings: list[Setting], integrator: str, values: dict[str, Any]) -> None:
        for s in settings:
            if (s.integrator, s.values, s.area_exponent) == (integrator, values, self.scenes_b):
                s.is_scenes = True
                return
        settings.append(self._setting(integrator, values, "scene's own", self.scenes_b))
        settings[-1].is_scenes = True
