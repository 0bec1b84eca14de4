# SPDX-License-Identifier: BSD-2-Clause
"""Scenes with known pictures: small enough for any renderer, and together they tell its mistakes
apart. `write` makes them in the languages of bis, Mitsuba 3 and pbrt-v4, with their maps, and with
a page of numbers for everybody else.

All that a scene is stands in four tables: MAPS, MATERIALS, GEOMETRIES and SCENES. The world is
right-handed, and z is up."""
from __future__ import annotations

import os
from typing import Any, NamedTuple, Union

import numpy as np
from numpy.typing import NDArray

Colour = Union[float, tuple[float, float, float]]

WIDTH, HEIGHT = 64, 48
ROWS, COLUMNS = 16, 32  # cells of a map; one is 11.25 degrees wide and high
TEXELS = 8  # texels of a cell in each direction, so that bilinear maps look like nearest ones


class Lamp(NamedTuple):
    """Cells of a map with one radiance: rows top to bottom - 1, columns left to right - 1."""

    top: int
    bottom: int
    left: int
    right: int
    radiance: Colour


class Shape(NamedTuple):
    """A sphere about the first of its points, or flat triangles over them."""

    material: int
    points: list[tuple[float, float, float]]
    radius: float = 0
    faces: list[tuple[int, int, int]] = []


class Row(NamedTuple):
    """A scene: names of the tables below, a camera, and what it is for."""

    geometry: str
    map: str
    materials: str
    eye: tuple[float, float, float]
    look: tuple[float, float, float]
    fov: float
    about: str


def _ball(material: int, x: float, y: float, z: float, radius: float) -> Shape:
    return Shape(material, [(x, y, z)], radius)


def _quad(material: int, *points: tuple[float, float, float]) -> Shape:
    return Shape(material, list(points), faces=[(0, 1, 2), (0, 2, 3)])


def _flat(material: int, x0: float, x1: float, y0: float, y1: float, z: float = 0) -> Shape:
    return _quad(material, (x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z))


def _box(material: int, x0: float, x1: float, y0: float, y1: float, z1: float) -> Shape:
    """On the floor, without a bottom; its faces look out of it."""
    points = [(x, y, z) for z in (0, z1) for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
    sides = [(i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4) for i in range(4)] + [(4, 5, 6, 7)]
    return Shape(material, points,
                 faces=[face for a, b, c, d in sides for face in ((a, b, c), (a, c, d))])


def _die() -> Shape:
    """An icosahedron, turned, so that no two of its twenty faces see the same light."""
    g = (1 + 5 ** .5) / 2
    p = np.array([q for s in (-1, 1) for t in (-g, g) for q in ((0, s, t), (s, t, 0), (t, 0, s))])
    a, b = np.radians((17, 31))
    turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    tilt = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    p = np.round(p @ turn.T @ tilt.T / 2, 4)
    near = np.linalg.norm(p[:, None] - p, axis=2) < 1.01
    faces = [(i, j, k) for i in range(12) for j in range(12) for k in range(12)
             if i < min(j, k) and near[i, j] and near[j, k] and near[k, i]
             and np.linalg.det(p[[i, j, k]]) > 0]
    return Shape(0, [tuple(q) for q in p.tolist()], faces=faces)


# A map is black, and then its lamps are painted one over the other.
MAPS: dict[str, list[Lamp]] = {
    "white": [Lamp(0, 16, 0, 32, 1)],
    "half": [Lamp(0, 8, 0, 32, 1)],
    "lamps": [Lamp(0, 8, 0, 32, (.25, .3, .4)), Lamp(8, 16, 0, 32, (.2, .15, .1)),
              Lamp(4, 6, 2, 4, (20, 14, 8)), Lamp(6, 7, 9, 10, (6, 22, 10)),
              Lamp(3, 5, 14, 17, (3, 4, 9)), Lamp(5, 7, 24, 25, (30, 6, 18)),
              Lamp(9, 11, 19, 22, (3, 1.5, 1))],
    "day": [Lamp(0, 8, 0, 32, .4), Lamp(0, 3, 6, 16, .8), Lamp(8, 16, 0, 32, .12),
            Lamp(8, 16, 20, 26, .3), Lamp(5, 6, 27, 28, 90), Lamp(6, 8, 12, 14, 5)],
    "low": [Lamp(0, 16, 0, 32, .05), Lamp(7, 8, 5, 6, 120), Lamp(6, 7, 26, 27, 70)],
    "poles": [Lamp(0, 16, 0, 32, .2), Lamp(0, 2, 0, 32, 4), Lamp(0, 2, 4, 13, 20),
              Lamp(14, 16, 0, 32, 3), Lamp(14, 16, 18, 26, 12)],
    "seam": [Lamp(0, 16, 0, 32, .15), Lamp(5, 7, 31, 32, 25), Lamp(5, 7, 0, 1, 50),
             Lamp(9, 10, 31, 32, 14)],
    "ground": [Lamp(0, 16, 0, 32, .1), Lamp(9, 11, 3, 7, 9), Lamp(11, 14, 20, 29, 3),
               Lamp(10, 11, 14, 15, 40)],
    "dim": [Lamp(0, 16, 0, 32, .02), Lamp(0, 8, 0, 9, .05), Lamp(0, 8, 9, 17, .15),
            Lamp(0, 8, 17, 25, .35), Lamp(0, 8, 25, 32, .7), Lamp(9, 12, 6, 14, .25)],
    "bright": [Lamp(0, 8, 0, 32, .3), Lamp(4, 5, 4, 5, 400), Lamp(5, 6, 17, 18, 60),
               Lamp(6, 8, 24, 26, 8), Lamp(2, 4, 12, 14, 2)],
    "colours": [Lamp(0, 16, 0, 32, .1), Lamp(4, 6, 1, 3, (18, .5, .5)),
                Lamp(5, 7, 12, 14, (.5, 14, .5)), Lamp(3, 5, 22, 24, (.5, .5, 20))],
}

# Diffuse: albedo. Conductor: reflectance head on, alpha of GGX. Phong: Kd, Ks, exponent.
MATERIALS: dict[str, tuple[Any, ...]] = {
    "grey": ("diffuse", .5), "pale": ("diffuse", .8), "dark": ("diffuse", .2),
    "black": ("diffuse", .05), "red": ("diffuse", (.7, .2, .1)),
    "green": ("diffuse", (.2, .6, .3)), "blue": ("diffuse", (.1, .25, .7)),
    "silver": ("conductor", .9, .15), "steel": ("conductor", .6, .3),
    "glaze": ("conductor", .1, .2), "broad": ("phong", .2, .5, 5.), "gloss": ("phong", 0, .8, 40.),
    "sharp": ("phong", .1, .7, 200.),
}

_FLOOR = _flat(0, -30, 30, -30, 30)
GEOMETRIES: dict[str, list[Shape]] = {
    "ball": [_ball(0, 0, 0, 0, 1)],
    "floor": [_FLOOR],
    "strips": [_flat(i, x, x + (30 if i % 3 == 0 else 1.25), -30, 30)
               for i, x in enumerate((-31.25, -1.25, 0, 1.25))],
    "die": [_die()],
    "still": [_FLOOR, _ball(1, -.9, -.5, .8, .75), _ball(2, 1.1, .6, .8, .75),
              _box(0, .2, .3, -1.6, -1.5, 1.2)],
    "posts": [_FLOOR, _box(1, -1.5, -1.3, -.9, -.7, .35), _box(1, -.4, -.2, .6, .8, .5),
              _box(1, .5, .7, -.6, -.4, .25), _box(1, 1.2, 1.4, .3, .5, .4)],
    "well": [_FLOOR, _quad(1, (-1, -1, 0), (-1, 1.3, 0), (-1, 1.3, 1.6), (-1, -1, 1.6)),
             _quad(1, (-1, 1.3, 0), (1.2, 1.3, 0), (1.2, 1.3, 1.1), (-1, 1.3, 1.1)),
             _quad(2, (1.2, 1.3, 0), (1.2, -1, 0), (1.2, -1, .8), (1.2, 1.3, .8))],
    "blinds": [_FLOOR] + [_flat(1, x, x + .35, -1.5, 1.8, z)
                          for x, z in ((-1.4, .5), (-.6, .7), (.1, .4), (.9, .6))],
    "table": [_quad(0, (-1.6, -1.1, .9), (1.3, -1.4, .6), (1.7, 1.2, 1), (-1.2, 1.5, 1.3)),
              _ball(1, -.5, -.2, -.1, .6), _ball(2, 1.1, .5, -.4, .4)],
    "three": [_FLOOR, _ball(1, -1.7, .2, .8, .75), _ball(2, 0, -.3, .8, .75),
              _ball(3, 1.7, .4, .8, .75)],
    "speck": [_ball(0, .5, -.15, .1, .12)],
}

SCENES: dict[str, Row] = {
    "furnace": Row("ball", "white", "pale", (3, -4, 2), (.2, .1, 0), 34,
        "A ball under light from everywhere is .8 all over, before 1: any factor."),
    "half-sky": Row("floor", "half", "grey", (1, -4, 3), (0, 0, 0), 30,
        "A floor under half a sphere is .5 all over: any factor, the cosine, the sine, a half."),
    "strips": Row("strips", "half", "black dark grey pale", (0, -.5, 5), (0, 0, 0), 42,
        "Floors of .05, .2, .5 and .8 show an albedo in sRGB, a curve of tone, a mirrored film."),
    "die-lamps": Row("die", "lamps", "grey", (3, -4, 2), (0, 0, .05), 28,
        "Nothing is shadowed, each face has one value: the map's orientation, channels, cosine."),
    "die-day": Row("die", "day", "red", (-3, -3, 2.4), (0, .05, 0), 28,
        "A coloured die: channels of an albedo, an albedo in sRGB, the cosine."),
    "die-below": Row("die", "poles", "grey", (-2, 3, -3), (0, 0, 0), 28,
        "The die from below, under bright poles: upside down, poles, the sine, half a sphere."),
    "still-lamps": Row("still", "lamps", "pale grey pale", (4, -6, 4), (0, 0, .2), 34,
        "Balls, a post and their shadows under coloured lamps: the map's orientation, shadows."),
    "still-day": Row("still", "day", "grey red blue", (4, -6, 4), (0, 0, .2), 34,
        "Coloured balls by day: shadows, channels, the cosine, the map's orientation."),
    "still-bright": Row("still", "bright", "grey pale dark", (-4, -5, 5), (0, 0, .2), 33,
        "Lamps of 400, 60, 8 and 2: a map that is clamped, or read from too few bits."),
    "still-seam": Row("still", "seam", "pale grey grey", (5, 4, 4), (0, 0, .2), 34,
        "All lamps touch the map's first or last column: the seam, a turned map."),
    "still-colours": Row("still", "colours", "pale pale grey", (1, -7, 4), (0, 0, .2), 33,
        "A red, a green and a blue lamp: channels exchanged, a mirrored map."),
    "still-dim": Row("still", "dim", "pale grey pale", (-5, 4, 4), (0, 0, .2), 33,
        "A map between .02 and .7: a map read as sRGB, and nothing is clamped."),
    "posts-low": Row("posts", "low", "pale grey", (1, -4, 5), (.1, 0, 0), 36,
        "Long shadows of two low lamps: half a texel in x and y, half a pixel, filters."),
    "posts-day": Row("posts", "day", "grey green", (-3, 3, 5), (0, 0, 0), 34,
        "Short and long shadows: shadows missing, half a texel, a flipped film."),
    "poles": Row("still", "poles", "pale grey pale", (4, -5, 4), (0, 0, .2), 34,
        "The first and last row of cells are the lamps: poles, the sine missing or twice."),
    "well": Row("well", "lamps", "pale grey pale", (3, -4, 5), (0, .1, .3), 30,
        "A corner sees a part of the sky: shadows, half of the sphere, both sides of a mesh."),
    "blinds": Row("blinds", "day", "pale dark", (.5, -3, 6), (0, .1, 0), 33,
        "Narrow slats: outlines, filters, half a pixel, both sides of a mesh."),
    "table": Row("table", "ground", "grey pale grey", (3, -5, -2), (.1, 0, .2), 33,
        "A tilted board is lit from below: normals flipped, upside down, half of the sphere."),
    "sky": Row("speck", "lamps", "pale", (0, 0, 0), (1, .3, .4), 80,
        "The map itself, seen by the camera: which way columns and rows run, mirrored, film."),
    "metal": Row("three", "lamps", "dark silver steel silver", (2, -6, 3.5), (0, 0, .6), 30,
        "Metals show the lamps sharply: the map's orientation, alpha squared, Fresnel."),
    "metal-floor": Row("still", "day", "glaze pale grey", (-3, -6, 2), (0, 0, .2), 32,
        "A floor that reflects .1 head on and much more at a grazing angle: Fresnel, alpha."),
    "phong-ball": Row("ball", "colours", "sharp", (3, -4, 2), (0, .1, 0), 34,
        "A narrow lobe shows the three lamps: exponent, the map's orientation, channels."),
    "phong-three": Row("three", "day", "grey broad gloss sharp", (2, -6, 3.5), (0, 0, .6), 30,
        "Exponents of 5, 40 and 200: exponent squared, a lobe's factor, shadows."),
    "phong-floor": Row("still", "lamps", "gloss grey broad", (-3, -5, 3), (0, 0, .2), 34,
        "A glossy floor with the shadows of two balls and a post: exponent, shadows, factors."),
}
NAMES = tuple(SCENES)
PBRT = ('Sampler "independent" "integer pixelsamples" 1024\n'
        'Integrator "path" "integer maxdepth" 1')

_INTRO = """\
# The kit: 24 scenes with known pictures

NAME.txt is for bis, NAME.xml for Mitsuba 3, NAME.pbrt for pbrt-v4. Scenes with a Phong material
have NAME.txt alone. Everything that a scene is stands below, for all other renderers.

- **Pictures**: 64 x 48 pixels, linear radiance in float32 (EXR, PFM or .npy) without a tone curve.
  Each pixel is the mean over its own square (a box filter of one pixel). Row 0 is at the top.
- **Light**: one bounce. A surface reflects what comes straight from the map, with shadows.
  A camera ray that hits nothing sees the map.
- **World**: right-handed, z is up: x forward, y to the left, z up. The camera is a pinhole.
  `fov` is the angle in degrees that 48 pixels see. Pictures are not mirrored.
- **Surfaces**: triangles are flat. Both sides of a surface reflect.
- **Map**: maps/MAP.exr has 256 x 128 pixels, latitude and longitude. Row i looks at the angle
  180 (i + 1/2) / 128 degrees from +z; column j looks at the azimuth 360 (j + 1/2) / 256 degrees,
  from +x towards +y. So column 64 looks along +y. The map is not turned in any scene.
  A map is made of 16 x 32 cells of 8 x 8 equal pixels, so nearest and bilinear look-ups agree.
  maps/MAP-mitsuba.exr has the rows where Mitsuba has them, at 180 i / 128 degrees.
  maps/MAP-square.exr is the equal-area square of pbrt-v4.
- **Diffuse**: f = albedo / pi.
- **Conductor**: f = F D G / (4 cos_i cos_o), GGX with `alpha`, which is the width itself
  (not squared, not remapped), D = alpha^2 / (pi ((alpha^2 - 1) cos_h^2 + 1)^2), and Smith's G.
  G may be that of both directions together or a product of two. F is Fresnel's for eta = 1 and
  k = 2 sqrt(r / (1 - r)); r is what it reflects head on.
- **Phong**: f = Kd / pi + Ks (n + 1) / (2 pi) cos^n(angle between light and mirror direction).
- Colours are linear. One number is grey. In a scene either the map or the materials are grey.

## Maps

A map begins black. Then its cells are set in this order; later ones replace earlier ones.
Rows and columns are those of cells, the first and the last; a cell is 11.25 degrees wide.

| map | rows | columns | radiance |
| --- | --- | --- | --- |
"""


def about(name: str) -> str:
    """What the scene shows and which mistakes it is for, in a sentence."""
    return SCENES[name].about


def materials(name: str) -> list[tuple[Any, ...]]:
    """The materials of a scene, as rows of MATERIALS; shapes name them by number."""
    return [MATERIALS[word] for word in SCENES[name].materials.split()]


def is_phong(name: str) -> bool:
    """Whether other renderers lack a material of this scene."""
    return any(kind == "phong" for kind, *_ in materials(name))


def light(name: str) -> NDArray[np.float32]:
    """The map of a scene.

    Returns
    -------
    pixels : array (128, 256, 3) of float32
        Row 0 is at +z; columns run from +x to +y.
    """
    cells = np.zeros((ROWS, COLUMNS, 3), np.float32)
    for lamp in MAPS[SCENES[name].map]:
        cells[lamp.top:lamp.bottom, lamp.left:lamp.right] = lamp.radiance
    return cells.repeat(TEXELS, 0).repeat(TEXELS, 1)


def _words(values: Any) -> str:
    return " ".join("%.9g" % x for x in np.ravel(values))


def _rgb(colour: Colour) -> str:
    return _words(np.broadcast_to(colour, 3))


def _material(kind: str, *values: Any) -> str:
    if kind == "diffuse":
        return 'Material "diffuse" "rgb reflectance" [%s]' % _rgb(values[0])
    if kind == "phong":
        return 'Material "phong" "float Kd" %g "float Ks" %g "float exponent" %g' % values
    return ('Material "conductor" "rgb reflectance" [%s] "float roughness" %g '
            '"bool remaproughness" false' % (_rgb(values[0]), values[1]))


def _pbrt(name: str, picture: str, settings: str, map: str) -> str:
    """A scene in the language of pbrt, which is bis's, too. `Scale -1 1 1` makes the world
    right-handed."""
    row = SCENES[name]
    lines = ["# " + row.about,
             'Film "rgb" "integer xresolution" %d "integer yresolution" %d "string filename" "%s"'
             % (WIDTH, HEIGHT, picture),
             'PixelFilter "box" "float xradius" 0.5 "float yradius" 0.5', settings,
             "Scale -1 1 1", "LookAt %s  %s  0 0 1" % (_words(row.eye), _words(row.look)),
             'Camera "perspective" "float fov" %g' % row.fov, "WorldBegin",
             'LightSource "infinite" "string filename" "maps/%s.exr"' % map]
    kinds = materials(name)
    for shape in GEOMETRIES[row.geometry]:
        lines += ["AttributeBegin", _material(*kinds[shape.material])]
        if shape.radius:
            lines += ["Translate " + _words(shape.points),
                      'Shape "sphere" "float radius" %g' % shape.radius]
        else:
            lines.append('Shape "trianglemesh" "point3 P" [%s] "integer indices" [%s]'
                         % (_words(shape.points), _words(shape.faces)))
        lines.append("AttributeEnd")
    return "\n".join(line for line in lines if line) + "\n"


def text(name: str) -> str:
    """The scene for bis, with its map as "maps/NAME OF THE MAP.exr"."""
    return _pbrt(name, name + ".exr", "", SCENES[name].map)


def _mitsuba_material(kind: str, *values: Any) -> str:
    """A metal of eta 1 and this k reflects `values[0]` head on, as pbrt's "reflectance"."""
    if kind == "diffuse":
        inside = '<bsdf type="diffuse"><rgb name="reflectance" value="%s"/>' % _rgb(values[0])
    else:
        k = 2 * (values[0] / (1 - values[0])) ** .5
        inside = ('<bsdf type="roughconductor"><string name="distribution" value="ggx"/>'
                  '<float name="alpha" value="%g"/><rgb name="eta" value="1 1 1"/>'
                  '<rgb name="k" value="%s"/>' % (values[1], _rgb(k)))
    return '<bsdf type="twosided">%s</bsdf></bsdf>' % inside


def _mitsuba(name: str) -> str:
    """A scene for Mitsuba 3. The matrix takes its map, which has y up, to z up and columns from +x
    to +y."""
    row = SCENES[name]
    look = ['%s="%s"' % (word, ", ".join("%g" % x for x in p)) for word, p in
            (("origin", row.eye), ("target", row.look), ("up", (0, 0, 1)))]
    lines = ['<scene version="3.0.0"><default name="spp" value="1024"/>',
             '<integrator type="direct"/>',
             '<sensor type="perspective"><float name="fov" value="%g"/>' % row.fov,
             '<string name="fov_axis" value="smaller"/>',
             '<transform name="to_world"><lookat %s/></transform>' % " ".join(look),
             '<sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>',
             '<film type="hdrfilm"><integer name="width" value="%d"/>' % WIDTH,
             '<integer name="height" value="%d"/><rfilter type="box"/>' % HEIGHT,
             '<string name="pixel_format" value="rgb"/>'
             '<string name="component_format" value="float32"/></film></sensor>',
             '<emitter type="envmap"><string name="filename" value="maps/%s-mitsuba.exr"/>'
             % row.map,
             '<transform name="to_world"><matrix value="0 0 -1 0  1 0 0 0  0 1 0 0  0 0 0 1"/>'
             '</transform></emitter>']
    kinds = materials(name)
    for i, shape in enumerate(GEOMETRIES[row.geometry]):
        if shape.radius:
            lines.append('<shape type="sphere"><point name="center" value="%s"/>'
                         '<float name="radius" value="%g"/>'
                         % (_words(shape.points), shape.radius))
        else:
            lines.append('<shape type="obj"><string name="filename" value="meshes/%s-%d.obj"/>'
                         '<boolean name="face_normals" value="true"/>' % (row.geometry, i))
        lines.append(_mitsuba_material(*kinds[shape.material]) + "</shape>")
    return "\n".join(lines + ["</scene>"]) + "\n"


def for_mitsuba(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """A map for Mitsuba, whose rows lie at 180 i/(h - 1) degrees: one row more, each the mean of
    the two rows that meet there."""
    ends = np.concatenate([pixels[:1], pixels, pixels[-1:]])
    return (ends[:-1] + ends[1:]) / 2


def _obj(shape: Shape) -> str:
    lines = ["v " + _words(p) for p in shape.points]
    lines += ["f %d %d %d" % (a + 1, b + 1, c + 1) for a, b, c in shape.faces]
    return "\n".join(lines) + "\n"


def _put(path: str, content: str) -> None:
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8", newline="\n") as f:
        f.write(content)


def write(folder: str) -> None:
    """Write all scenes, maps and meshes, and README.md, into a folder that need not exist."""
    import bis  # here, because names and descriptions need no library

    for name, row in SCENES.items():
        base = os.path.join(folder, name)
        _put(base + ".txt", text(name))
        if is_phong(name):
            continue
        _put(base + ".xml", _mitsuba(name))
        _put(base + ".pbrt", _pbrt(name, name + ".exr", PBRT, row.map + "-square"))
        for i, shape in enumerate(GEOMETRIES[row.geometry]):
            if shape.faces:
                _put(os.path.join(folder, "meshes", "%s-%d.obj" % (row.geometry, i)), _obj(shape))
    _put(os.path.join(folder, "README.md"), page())
    maps = {row.map: name for name, row in SCENES.items()}
    os.makedirs(os.path.join(folder, "maps"), exist_ok=True)
    for map, name in maps.items():
        pixels = light(name)
        square = bis.Envmap(pixels).to_mapping("equalarea", 1024)[0]
        for ending, a in (("", pixels), ("-mitsuba", for_mitsuba(pixels)), ("-square", square)):
            bis.save_image(os.path.join(folder, "maps", map + ending + ".exr"), a)


def _shape(shape: Shape) -> str:
    if shape.radius:
        return "sphere about (%s), radius %g" % (_words(shape.points), shape.radius)
    return "triangles %s over the points %s" % (
        " ".join("(%d %d %d)" % face for face in shape.faces),
        " ".join("(%s)" % _words(p) for p in shape.points))


def page() -> str:
    """README.md: what a renderer that reads none of the three languages needs."""
    lines = ["| %s | %d to %d | %d to %d | %s |"
             % (name, a.top, a.bottom - 1, a.left, a.right - 1, _words(a.radiance))
             for name, lamps in MAPS.items() for a in lamps]
    lines += ["", "## Materials", "", "| name | kind | values |", "| --- | --- | --- |"]
    meaning = {"diffuse": "albedo %s", "conductor": "r %s, alpha %s",
               "phong": "Kd %s, Ks %s, n %s"}
    lines += ["| %s | %s | %s |" % (name, kind, meaning[kind] % tuple(map(_words, values)))
              for name, (kind, *values) in MATERIALS.items()]
    lines += ["", "## Shapes", "", "The number is that of the scene's material, from 0."]
    for name, shapes in GEOMETRIES.items():
        lines += ["", "### " + name, ""]
        lines += ["- %d: %s" % (shape.material, _shape(shape)) for shape in shapes]
    lines += ["", "## Scenes", ""]
    for name, row in SCENES.items():
        lines += ["- **%s**: shapes `%s`, map `%s`, materials %s. Camera at (%s), looks at (%s), "
                  "up (0 0 1), fov %g. %s"
                  % (name, row.geometry, row.map, row.materials, _words(row.eye), _words(row.look),
                     row.fov, row.about)]
    return _INTRO + "\n".join(lines) + "\n"
