# SPDX-License-Identifier: BSD-2-Clause
"""`bis irradiance SCENE`: how much light arrives at points, each with its 95 % interval."""
from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from types import SimpleNamespace
from typing import TYPE_CHECKING, Optional

from .._errors import Error, Status
from . import command, files
from .command import COUNT, DONE, NAME, REAL, SHARE, Command, Heading, Option, Say
from .envmap import MAPPINGS
from .scenes import open_scene, telling

if TYPE_CHECKING:  # they need numpy, and the help does not
    from .._library import Doubles
    from .._render import Scene

MAPS = (".hdr", ".exr", ".pfm")
COLUMNS = ("x", "y", "z", "nx", "ny", "nz")
MESHES = ("vertices", "faces")
LUMINANCE = (0.2126, 0.7152, 0.0722)  #: of the colours of a map as it was read, Rec. 709

COMMAND = Command(
    "irradiance", "irradiance --points FILE [options] SCENE|MAP",
    "how much light arrives at points of a scene, or under a map that nothing hides",
    [
        Heading("what to measure"),
        Option("points", "F",
               "a point and its normal a line, x,y,z,nx,ny,nz, as CSV; or .npy (n, 6); or the "
               "vertices of a .ply with normals; or a word, vertices or faces: those of SCENE's "
               "meshes, printed before what arrives there"),
        Option("shape", "N", "of these, shape N of SCENE alone, from 0", COUNT, hi=2 ** 32 - 1),
        Option("lift", "D",
               "move points by D along their normals, off the surfaces they may lie on (2e-6 of "
               "the largest coordinate)", REAL, lo=0),
        Option("mapping", "M", "of MAP, as `bis envmap` names them", NAME, names=MAPPINGS),
        Heading("how long"),
        Option("spp", "N", "samples of each point (16)", COUNT, lo=1, hi=2 ** 32 - 1),
        Option("error", "E", "go on until the relative RMSE over all points is at most E", SHARE,
               lo=0, above=True),
        Option("seed", "N", "of the random numbers (0)", COUNT, hi=2 ** 53),
        Heading("what to write"),
        Option("scale", "S",
               "times S, as 179 lm/W, or what a meter read over what is printed for its place (1)",
               REAL, lo=0, default=1.0),
        Option("lm-per-w", "K",
               "print lux, too: K times what the eye sees of r, g, b (K = 179 for daylight in "
               "W/m^2)", REAL, lo=0, above=True),
        Option("calibrate", "I=LUX",
               "the same, so that point I, from 0, has what a meter read there; E_up=LUX: what it "
               "read under MAP, facing up"),
        Option("out", "F", "write .csv or .npy instead of CSV to standard output"),
    ],
    1, 1,
    "Printed are E in r, g, b, the integral of radiance times cosine times\n"
    "visibility, and the half-width of its 95% interval, nan where too little is\n"
    "known. A map has no unit: E is in the map's own times sr, until --scale\n"
    "gives it one. Lux are of Rec. 709 colours, and their interval holds at least\n"
    "95%. Three colours have no infrared.\n"
    "Points that lie side by side and look the same way learn together.\n")


def _table(lines: Sequence[str], path: str) -> Doubles:
    """Rows of six numbers; a first line of words is passed over, and so are comments."""
    import numpy as np

    rows = []
    for k, line in enumerate(lines, 1):
        words = line.split("#")[0].replace(",", " ").replace(";", " ").split()
        if not words or (k == 1 and all(w.strip('"')[:1].isalpha() for w in words)):
            continue
        try:
            rows.append([float(w) for w in words])
        except ValueError:
            rows.append([])
        if len(rows[-1]) != 6:
            raise Error("%s:%d: error: give six numbers, x,y,z,nx,ny,nz" % (path, k))
    return np.array(rows).reshape(-1, 6)


_TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
          "float": "f4", "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2",
          "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8"}


def _ply(data: bytes, path: str) -> Doubles:
    """The vertices of a PLY, which stand before its faces."""
    import numpy as np

    head, found, body = data.partition(b"end_header")
    body = body.partition(b"\n")[2]  # a line may end by \r\n
    words = [line.split() for line in head.decode("ascii", "replace").splitlines()]
    form = next((w[1] for w in words if w[:1] == ["format"] and len(w) > 1), "")
    elements = [k for k, w in enumerate(words) if w[:1] == ["element"]]
    if not found or not elements or words[elements[0]][1] != "vertex":
        raise Error("%s: error: this is no PLY that begins with vertices" % path)
    last = elements[1] if len(elements) > 1 else len(words)
    own = [w for w in words[elements[0]:last] if w[:1] == ["property"]]
    names = [w[-1] for w in own]
    if not words[elements[0]][-1].isdecimal():
        raise Error("%s: error: it does not say how many vertices it has" % path)
    if not set(COLUMNS) <= set(names) or any(w[1] not in _TYPES for w in own):
        raise Error("%s: error: its vertices have no normals nx, ny, nz" % path)
    n = int(words[elements[0]][2])
    if form == "ascii":
        words = [line.split() for line in body.decode("ascii", "replace").splitlines()[:n]]
        if len(words) < n or any(len(w) < len(names) for w in words):
            raise Error("%s: error: it ends within its vertices" % path)
        return np.array([[w[names.index(c)] for c in COLUMNS] for w in words], np.float64)
    order = ">" if form == "binary_big_endian" else "<"
    vertex = np.dtype([(name, order + _TYPES[w[1]]) for name, w in zip(names, own)])
    if not 0 < n <= len(body) // vertex.itemsize:
        raise Error("%s: error: it ends within its vertices" % path)
    rows = np.frombuffer(body, vertex, n)
    return np.stack([rows[c].astype(np.float64) for c in COLUMNS], axis=1)


def read_points(path: str) -> Doubles:
    """The points (n, 6) of a file."""
    import numpy as np

    from .._library import array

    try:
        with open(path, "rb") as f:
            data = f.read()
        if path.endswith(".npy"):
            points = np.load(path, allow_pickle=False)
        elif data[:3] == b"ply":
            points = _ply(data, path)
        else:
            points = _table(data.decode("utf-8-sig", "replace").splitlines(), path)
        points = array(points, 6, np.float64, path + ": error: it")
    except OSError as e:
        raise Error('error: cannot read "%s": %s' % (path, e.strerror), Status.IO) from None
    except (ValueError, IndexError, EOFError) as e:
        raise Error("%s: error: %s" % (path, e)) from None
    if not len(points):
        raise Error("%s: error: it has no points: give x,y,z,nx,ny,nz in each line" % path)
    return points


def _mesh_points(scene: Scene, which: str, shape: Optional[int]) -> Doubles:
    """The vertices or faces of a scene's meshes, as points (n, 6). A triangle without area has the
    normal 0."""
    import numpy as np

    mesh = scene.mesh(shape)
    at = ((mesh.vertices, mesh.normals) if which == "vertices" else
          (mesh.centres(), mesh.crosses()))
    return np.concatenate(at, axis=1).astype(np.float64)


def _of_scene(o: SimpleNamespace, operand: str, say: Say) -> tuple[Doubles, Doubles]:
    """Points (n, 6), and E with its interval (n, 6); NaN where a mesh has no normal."""
    import numpy as np

    how = {k: getattr(o, k) for k in ("spp", "error", "seed") if getattr(o, k) is not None}
    if "spp" not in how and "error" not in how:
        how["spp"] = 16
    is_of_mesh = o.points in MESHES
    with telling(say):
        scene = open_scene(operand, say)
        points = _mesh_points(scene, o.points, o.shape) if is_of_mesh else read_points(o.points)
        E = np.full((len(points), 6), np.nan)
        known = points[:, 3:].any(axis=1) | (not is_of_mesh)
        found = scene.irradiance(points[known, :3], points[known, 3:], lift=o.lift, **how)
    E[known] = np.concatenate((found.E, found.interval), axis=1)
    return points, E


def _of_map(o: SimpleNamespace, operand: str, say: Say) -> tuple[Doubles, Doubles, Doubles]:
    """Points, E with intervals of 0, and E of a surface that faces up (3)."""
    import numpy as np

    from .._sampling import Envmap

    with telling(say):
        points = read_points(o.points)
        light = Envmap(operand, "cdf", 0, o.mapping)
        E = light.irradiance(np.concatenate((points[:, 3:], [(0, 0, 1)])))
    return points, np.concatenate((E, np.zeros_like(E)), axis=1)[:-1], E[-1]


def _factor(o: SimpleNamespace, E: Doubles, up: Optional[Doubles], say: Say) -> Optional[float]:
    """Lux of what the eye sees of E; None: not asked for."""
    import math

    import numpy as np

    efficacy: Optional[float] = getattr(o, "lm-per-w")
    if not o.calibrate:
        return efficacy
    if efficacy:
        raise Error("error: --calibrate and --lm-per-w exclude each other")
    at, _, lux = o.calibrate.partition("=")
    try:
        reading = float(lux)
        seen = up if at == "E_up" and up is not None else E[int(at)] if at.isdecimal() else None
    except (ValueError, IndexError):
        seen = None
    if seen is None or not 0 < reading < math.inf:
        raise Error("error: --calibrate %s: give the number of a point, 0 to %d%s, =, and lux above"
                    " 0" % (o.calibrate, len(E) - 1, "" if up is None else " or E_up"))
    arrives = float(np.dot(LUMINANCE, seen[:3]))
    if not arrives > 0:
        raise Error("error: --calibrate %s: no light arrives there" % o.calibrate)
    off = float(np.dot(LUMINANCE, seen[3:])) / arrives if len(seen) == 6 else 0.0
    if not off < 0.01:
        say.warn("--calibrate: E there is known to %.2g %%, and so are all lux: --error 0.1%% "
                 "makes it better" % (100 * off))
    return reading / arrives


def _write(out: Optional[str], columns: Sequence[str], rows: Doubles) -> None:
    """As .npy, or as CSV to a file or to standard output."""
    import numpy as np

    if out and out.lower().endswith(".npy"):
        with files.outfile(out) as f:
            np.save(f, rows)
        return
    line = ",".join("%.3g" if "interval" in c else "%.9g" if c in COLUMNS else "%.6g"
                    for c in columns) + "\n"
    words = ",".join(columns) + "\n" + "".join(line % tuple(row) for row in rows.tolist())
    if out:
        with files.outfile(out) as f:
            f.write(words.encode())
    else:
        sys.stdout.write(words)


def _check(o: SimpleNamespace, operand: str, is_map: bool) -> None:
    if not o.points:
        raise Error("error: --points is missing: name a file of points and normals, or say "
                    "vertices or faces")
    for name in ("lift", "spp", "error", "seed", "shape") if is_map else ("mapping",):
        if getattr(o, name) is not None:
            raise Error("error: --%s belongs to a %s, and \"%s\" is none: leave it out" % (
                name, "scene" if is_map else "map", operand))
    if is_map and o.points in MESHES or o.shape is not None and o.points not in MESHES:
        raise Error("error: --points vertices and --points faces, with --shape, are of a scene")
    if o.out:
        if os.path.splitext(o.out)[1].lower() not in (".csv", ".npy"):
            raise Error('error: --out "%s": the ending must be .csv or .npy' % o.out)
        files.check_writable(o.out)
        files.check_distinct([operand, o.points], [o.out])


def _body(o: SimpleNamespace, operands: list[str], say: Say) -> int:
    import numpy as np

    is_map = operands[0].lower().removesuffix(".gz").endswith(MAPS)
    _check(o, operands[0], is_map)
    up = None
    if is_map:
        points, E, up = _of_map(o, operands[0], say)
        up = o.scale * up
    else:
        points, E = _of_scene(o, operands[0], say)
    E = o.scale * E
    columns = ["r", "g", "b", "interval_r", "interval_g", "interval_b"]
    factor = _factor(o, E, up, say)
    if factor is not None:
        E = np.concatenate((E, factor * E.reshape(-1, 2, 3) @ LUMINANCE), axis=1)
        columns += ["lux", "interval_lux"]
    if o.points in MESHES:
        E, columns = np.concatenate((points, E), axis=1), [*COLUMNS, *columns]
    _write(o.out, columns, E)
    return DONE


def main(argv: Sequence[str]) -> int:
    """Run the command with these arguments. Returns its exit state."""
    return command.run(COMMAND, argv, _body)
