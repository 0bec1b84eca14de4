# SPDX-License-Identifier: BSD-2-Clause
"""bis from Python: pictures, maps, points, alias tables and materials as numpy arrays.

    import bis
    picture, stats = bis.render("scene.txt", integrator="sir", spp=16)     # (h, w, 3) float32, dict
    scene = bis.Scene("scene.txt")                         # built once, rendered often
    w, L, pdf = bis.Envmap("map.hdr").sample(1000)                         # (n, 3), (n, 3), (n,)

The library is that of the environment variable BIS_LIBRARY, else a libbis.so in this folder (a
wheel brings one), in build/release/library of the repository, or where the system looks for
libraries. A mistake raises bis.Error with the library's own message; warnings of the library become
Python's. `python -m bis` is the program. docs/library.md explains the functions.
"""
from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from ._errors import Error, Status, WrongType

if TYPE_CHECKING:
    from ._image import Comparison, Place, compare, compare_colours, exposure_of, read_image
    from ._image import save_image
    from ._irradiance import Harmonics
    from ._library import version
    from ._points import points
    from ._render import LAYERS, Picture, Progress, Scene, about, render
    from ._sampling import AliasTable, Defects, Envmap, Material, Regions
    from ._scene import Camera, Mesh
    from ._stage import Stage

# What needs the library and numpy is loaded when it is asked for, because the help of the
# instruments needs neither.
_HOMES = {
    "_image": ("Comparison", "Place", "compare", "compare_colours", "exposure_of", "read_image",
               "save_image"),
    "_irradiance": ("Harmonics",),
    "_library": ("version",),
    "_points": ("points",),
    "_render": ("LAYERS", "Picture", "Progress", "Scene", "about", "render"),
    "_sampling": ("AliasTable", "Defects", "Envmap", "Material", "Regions"),
    "_scene": ("Camera", "Mesh"),
    "_stage": ("Stage",),
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = ["AliasTable", "Camera", "Comparison", "Defects", "Envmap", "Error",
           "Harmonics", "LAYERS", "Material", "Mesh", "Picture", "Place", "Progress", "Regions",
           "Scene", "Stage", "Status", "WrongType", "about", "compare", "compare_colours",
           "exposure_of", "points", "read_image", "render", "save_image", "version"]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return __getattr__("version")()
    if name not in _HOME:
        raise AttributeError("module %r has no attribute %r" % (__name__, name))
    value = getattr(importlib.import_module("." + _HOME[name], __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
