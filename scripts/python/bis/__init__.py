# SPDX-License-Identifier: BSD-2-Clause
"""bis from Python: pictures, maps, alias tables and materials as numpy arrays.

    import bis
    picture, stats = bis.render("scene.txt", integrator="sir", spp=16)     # (h, w, 3) float32, dict
    w, L, pdf = bis.Envmap("map.hdr").sample(1000)                         # (n, 3), (n, 3), (n,)

The library is that of the environment variable BIS_LIBRARY, else a libbis.so in this folder (a wheel brings one), in
build/release/library of the repository, or where the system looks for libraries. A mistake raises bis.Error with the
library's own message; warnings of the library become Python's. `python -m bis` is the program. docs/library.md
explains the functions.
"""
from ._image import Comparison, Place, compare, compare_colours, exposure_of, read_image, save_image
from ._library import Error, Status, WrongType, version
from ._render import LAYERS, Picture, Progress, render
from ._sampling import AliasTable, Envmap, Material
from ._scene import Camera, Mesh

__all__ = ["AliasTable", "Camera", "Comparison", "Envmap", "Error", "LAYERS", "Material", "Mesh", "Picture", "Place",
           "Progress", "Status", "WrongType", "compare", "compare_colours", "exposure_of", "read_image", "render",
           "save_image", "version"]
__version__ = version()
