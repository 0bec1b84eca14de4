# SPDX-License-Identifier: BSD-2-Clause
"""Scenes with known pictures: small enough for any renderer, and together they tell its mistakes
apart. kit.md is the kit: its tables of maps, materials, shapes and scenes are read here, and it is
the page of numbers for those who build the scenes by hand. `write` makes them in the languages of
bis, Mitsuba 3 and pbrt-v4, with their maps. The world is right-handed, and z is up."""
from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

WIDTH, HEIGHT = 64, 48
ROWS, COLUMNS = 16, 32  # cells of a map
TEXELS = 8  # pixels of a cell in each direction, so that bilinear maps look like nearest ones
PBRT = ('Sampler "independent" "integer pixelsamples" 1024\n'
        'Integrator "path" "integer maxdepth" 1\n')
_PAGE = os.path.join(os.path.dirname(__file__), "kit.md")


class Shape(NamedTuple):
    """A sphere about its only point, `size` its radius; or flat triangles over its points, `size`
    three of their numbers for each triangle."""

    material: int
    kind: str
    points: list[list[float]]
    size: list[list[float]]


class Row(NamedTuple):
    """A scene: names of the other tables, a camera, and what it is for."""

    shapes: str
    map: str
    materials: list[str]
    eye: list[float]
    look: list[float]
    fov: float
    about: str


def _numbers(cell: str) -> list[list[float]]:
    """The vectors in a cell of a table, which commas separate."""
    return [[float(word) for word in vector.split()] for vector in cell.split(",")]


def _tables() -> dict[str, list[list[str]]]:
    """The tables of kit.md by the name of their first column; rows without the head."""
    tables: dict[str, list[list[str]]] = {}
    with open(_PAGE, encoding="utf-8") as f:
        lines = [line.strip()[2:-2].split(" | ") for line in f if line.startswith("| ")]
    rows: list[list[str]] = []
    for i, cells in enumerate(lines):
        if cells[0].startswith("---"):
            rows = tables.setdefault(lines[i - 1][0], [])
        elif i + 1 == len(lines) or not lines[i + 1][0].startswith("---"):
            rows.append(cells)
    return tables


_TABLES = _tables()
SHAPES: dict[str, list[Shape]] = {}
for _name, _slot, _kind, _points, _size in _TABLES["shapes"]:
    SHAPES.setdefault(_name, []).append(
        Shape(int(_slot), _kind, _numbers(_points), _numbers(_size)))
# Values of diffuse: the albedo; of conductor: r, alpha; of phong: Kd, Ks, n.
MATERIALS = {name: (kind, _numbers(values)) for name, kind, values in _TABLES["material"]}
SCENES = {name: Row(shapes, map_, materials.split(), *_numbers(eye), *_numbers(look), float(fov),
                    about_)
          for name, shapes, map_, materials, eye, look, fov, about_ in _TABLES["scene"]}
NAMES = tuple(SCENES)


def is_phong(name: str) -> bool:
    """Whether the scene has a material that Mitsuba and pbrt-v4 lack."""
    return any(MATERIALS[material][0] == "phong" for material in SCENES[name].materials)


def light(name: str) -> NDArray[np.float32]:
    """The map of a scene.

    Returns
    -------
    pixels : array (128, 256, 3) of float32
        Row 0 is at +z; columns run from +x to +y.
    """
    cells = np.zeros((ROWS, COLUMNS, 3), np.float32)
    for map, top, bottom, left, right, radiance in _TABLES["map"]:
        if map == SCENES[name].map:
            cells[int(top):int(bottom) + 1, int(left):int(right) + 1] = _numbers(radiance)[0]
    return cells.repeat(TEXELS, 0).repeat(TEXELS, 1)


def for_mitsuba(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """A map for Mitsuba, whose rows lie at 180 i/(h - 1) degrees: those of this one, and between
    any two and at the poles one more, so that Mitsuba's is the bilinear map of these pixels."""
    ends = np.concatenate([pixels[:1], pixels, pixels[-1:]])
    rows = ((ends[:-1] + ends[1:]) / 2).repeat(2, 0)[:-1]
    rows[1::2] = pixels
    return rows


def _words(values: Any) -> str:
    return " ".join("%.9g" % x for x in np.ravel(values))


def _rgb(colour: list[float]) -> str:
    return _words(np.broadcast_to(colour, 3))


def _material(kind: str, values: list[list[float]]) -> str:
    first, *others = values
    if kind == "diffuse":
        return 'Material "diffuse" "rgb reflectance" [%s]' % _rgb(first)
    if kind == "phong":
        return ('Material "phong" "float Kd" %s "float Ks" %s "float exponent" %s'
                % tuple(map(_words, values)))
    return ('Material "conductor" "rgb reflectance" [%s] "float roughness" %s '
            '"bool remaproughness" false' % (_rgb(first), _words(others)))


def _pbrt(name: str, settings: str, map: str) -> str:
    """A scene in the language of pbrt, which is bis's, too. `Scale -1 1 1` makes the world
    right-handed."""
    row = SCENES[name]
    lines = ["# " + row.about,
             'Film "rgb" "integer xresolution" %d "integer yresolution" %d "string filename" '
             '"%s.exr"' % (WIDTH, HEIGHT, name),
             'PixelFilter "box" "float xradius" 0.5 "float yradius" 0.5',
             settings + "Scale -1 1 1",
             "LookAt %s  %s  0 0 1" % (_words(row.eye), _words(row.look)),
             'Camera "perspective" "float fov" %g' % row.fov, "WorldBegin",
             'LightSource "infinite" "string filename" "maps/%s.exr"' % map]
    for shape in SHAPES[row.shapes]:
        lines += ["AttributeBegin", _material(*MATERIALS[row.materials[shape.material]])]
        if shape.kind == "sphere":
            lines += ["Translate " + _words(shape.points),
                      'Shape "sphere" "float radius" ' + _words(shape.size)]
        else:
            lines.append('Shape "trianglemesh" "point3 P" [%s] "integer indices" [%s]'
                         % (_words(shape.points), _words(shape.size)))
        lines.append("AttributeEnd")
    return "\n".join(lines) + "\n"


def text(name: str) -> str:
    """The scene for bis, with its map as "maps/NAME OF THE MAP.exr"."""
    return _pbrt(name, "", SCENES[name].map)


def _mitsuba_material(kind: str, values: list[list[float]]) -> str:
    """A metal of eta 1 and this k reflects r head on, as pbrt's "reflectance"."""
    if kind == "diffuse":
        inside = '<bsdf type="diffuse"><rgb name="reflectance" value="%s"/>' % _rgb(values[0])
    else:
        (r,), (alpha,) = values
        inside = ('<bsdf type="roughconductor"><string name="distribution" value="ggx"/>'
                  '<float name="alpha" value="%g"/><rgb name="eta" value="1 1 1"/>'
                  '<rgb name="k" value="%s"/>' % (alpha, _rgb([2 * (r / (1 - r)) ** .5])))
    return '<bsdf type="twosided">%s</bsdf></bsdf>' % inside


# The matrix takes a map, which has y up in Mitsuba, to z up and columns from +x to +y.
_MITSUBA = """\
<scene version="3.0.0"><default name="spp" value="1024"/>
<integrator type="direct"/>
<sensor type="perspective"><float name="fov" value="%g"/>
<string name="fov_axis" value="smaller"/>
<transform name="to_world"><lookat origin="%s" target="%s" up="0, 0, 1"/></transform>
<sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
<film type="hdrfilm"><integer name="width" value="%d"/>
<integer name="height" value="%d"/><rfilter type="box"/>
<string name="pixel_format" value="rgb"/><string name="component_format" value="float32"/>
</film></sensor>
<emitter type="envmap"><string name="filename" value="maps/%s-mitsuba.exr"/>
<transform name="to_world"><matrix value="0 0 -1 0  1 0 0 0  0 1 0 0  0 0 0 1"/></transform>
</emitter>
"""


def _mitsuba(name: str) -> str:
    row = SCENES[name]
    lines = []
    for i, shape in enumerate(SHAPES[row.shapes]):
        if shape.kind == "sphere":
            lines.append('<shape type="sphere"><point name="center" x="%.9g" y="%.9g" z="%.9g"/>'
                         '<float name="radius" value="%s"/>'
                         % (*shape.points[0], _words(shape.size)))
        else:
            lines.append('<shape type="obj"><string name="filename" value="meshes/%s-%d.obj"/>'
                         '<boolean name="face_normals" value="true"/>' % (row.shapes, i))
        lines.append(_mitsuba_material(*MATERIALS[row.materials[shape.material]]) + "</shape>")
    places = [", ".join("%g" % x for x in place) for place in (row.eye, row.look)]
    return (_MITSUBA % (row.fov, *places, WIDTH, HEIGHT, row.map)
            + "\n".join(lines) + "\n</scene>\n")


def _obj(shape: Shape) -> str:
    """Corners are counted from 1."""
    lines = ["v " + _words(point) for point in shape.points]
    lines += ["f " + _words(np.add(face, 1)) for face in shape.size]
    return "\n".join(lines) + "\n"


def _files() -> dict[str, str]:
    """All files of the kit that are text."""
    with open(_PAGE, encoding="utf-8") as f:
        files = {"README.md": f.read()}
    for name, row in SCENES.items():
        files[name + ".txt"] = text(name)
        if not is_phong(name):
            files[name + ".xml"] = _mitsuba(name)
            files[name + ".pbrt"] = _pbrt(name, PBRT, row.map + "-square")
    for name, shapes in SHAPES.items():
        files.update(("meshes/%s-%d.obj" % (name, i), _obj(shape))
                     for i, shape in enumerate(shapes) if shape.kind != "sphere")
    return files


def write(folder: str, names: Iterable[str] = NAMES) -> None:
    """Write all scenes and meshes, the maps of some scenes, and README.md, into a folder that need
    not exist."""
    import bis  # here, because names and descriptions need no library

    for part in ("maps", "meshes"):
        os.makedirs(os.path.join(folder, part), exist_ok=True)
    for name, content in _files().items():
        with open(os.path.join(folder, name), "w", encoding="utf-8", newline="\n") as f:
            f.write(content)
    for map, name in {SCENES[name].map: name for name in names}.items():
        pixels = light(name)
        square = bis.Envmap(pixels).to_mapping("equalarea", 1024)[0]
        for ending, a in (("", pixels), ("-mitsuba", for_mitsuba(pixels)), ("-square", square)):
            bis.save_image(os.path.join(folder, "maps", map + ending + ".exr"), a)
