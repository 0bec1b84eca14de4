# SPDX-License-Identifier: BSD-2-Clause
"""`bis irradiance SCENE`: how much light arrives at points, each with its 95 % interval."""
from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from .._errors import Error, Status
from . import command, files
from .command import COUNT, DONE, NAME, REAL, SHARE, Command, Heading, Option, Say
from .envmap import MAPPINGS
from .scenes import open_scene, telling

if TYPE_CHECKING:  # they need numpy, and the help does not
    from .._library import Doubles

MAPS = (".hdr", ".exr", ".pfm")
COLUMNS = ("x", "y", "z", "nx", "ny", "nz")

COMMAND = Command(
    "irradiance", "irradiance --points FILE [options] SCENE|MAP",
    "how much light arrives at points of a scene, or under a map that nothing hides",
    [
        Heading("what to measure"),
        Option("points", "F",
               "a point and its normal a line, x,y,z,nx,ny,nz, as CSV; or .npy (n, 6); or the "
               "vertices of a .ply with normals"),
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
        Option("out", "F", "write .csv or .npy (n, 6) instead of CSV to standard output"),
    ],
    1, 1,
    "Printed are E in r, g, b, the integral of radiance times cosine times\n"
    "visibility, and the half-width of its 95% interval, nan where too little is\n"
    "known. A map has no unit: E is in the map's own times sr, until --scale\n"
    "gives it one. Three colours have no infrared.\n"
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


def _measured(o: SimpleNamespace, operand: str, points: Doubles, say: Say) -> Any:
    """E and its interval (n, 6)."""
    import numpy as np

    is_map = operand.lower().removesuffix(".gz").endswith(MAPS)
    for name in ("lift", "spp", "error", "seed") if is_map else ("mapping",):
        if getattr(o, name) is not None:
            raise Error("error: --%s belongs to a %s, and \"%s\" is none: leave it out" % (
                name, "scene" if is_map else "map", operand))
    if is_map:
        from .._sampling import Envmap
        with telling(say):
            E = Envmap(operand, "cdf", 0, o.mapping).irradiance(points[:, 3:])
        return np.concatenate((E, np.zeros_like(E)), axis=1)
    how = {k: getattr(o, k) for k in ("spp", "error", "seed") if getattr(o, k) is not None}
    if "spp" not in how and "error" not in how:
        how["spp"] = 16
    with telling(say):
        found = open_scene(operand, say).irradiance(points[:, :3], points[:, 3:], lift=o.lift,
                                                    **how)
    return np.concatenate((found.E, found.interval), axis=1)


def _body(o: SimpleNamespace, operands: list[str], say: Say) -> int:
    import numpy as np

    if not o.points:
        raise Error("error: --points is missing: name a file of points and normals")
    if o.out:
        if os.path.splitext(o.out)[1].lower() not in (".csv", ".npy"):
            raise Error('error: --out "%s": the ending must be .csv or .npy' % o.out)
        files.check_writable(o.out)
        files.check_distinct([operands[0], o.points], [o.out])
    found = o.scale * _measured(o, operands[0], read_points(o.points), say)
    if o.out and o.out.lower().endswith(".npy"):
        with files.outfile(o.out) as f:
            np.save(f, found)
        return DONE
    words = "r,g,b,interval_r,interval_g,interval_b\n" + "".join(
        "%.6g,%.6g,%.6g,%.3g,%.3g,%.3g\n" % tuple(row) for row in found.tolist())
    if o.out:
        with files.outfile(o.out) as f:
            f.write(words.encode())
    else:
        sys.stdout.write(words)
    return DONE


def main(argv: Sequence[str]) -> int:
    """Run the command with these arguments. Returns its exit state."""
    return command.run(COMMAND, argv, _body)
