# SPDX-License-Identifier: BSD-2-Clause
"""What a scene is made of, as text in the format of scenes: a mesh of arrays, a camera."""
from __future__ import annotations

from typing import Any, NamedTuple, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._library import Doubles, Error, WrongType, array, real


def _words(a: NDArray[np.generic]) -> str:
    """Numbers as text. %.9g tells each float32 from the next one."""
    form = "%d" if a.dtype.kind in "iu" else "%.9g"
    return " ".join([form] * a.size) % tuple(a.ravel().tolist())


class Mesh:
    """Triangles from arrays. ``str(mesh)``, and ``"%s" % mesh`` in the text of a scene, is a Shape.

    Parameters
    ----------
    vertices : array (n, 3)
        Points, as float32.
    faces : array (m, 3)
        Three vertices of each triangle, from 0.
    normals : array (n, 3), optional
        Of the vertices.
    uv : array (n, 2), optional
        Texture coordinates of the vertices.

    Raises
    ------
    Error
        The arrays do not fit each other, or a value is not finite.
    """

    def __init__(self, vertices: ArrayLike, faces: ArrayLike, normals: Optional[ArrayLike] = None,
                 uv: Optional[ArrayLike] = None) -> None:
        self.vertices = array(vertices, 3, np.float32, "vertices")
        if np.asarray(faces).dtype.kind not in "iu":
            raise WrongType("faces holds values of the type %s: give integers"
                            % np.asarray(faces).dtype)
        self.faces = array(faces, 3, np.int64, "faces")
        self.normals = None if normals is None else array(normals, 3, np.float32, "normals")
        self.uv = None if uv is None else array(uv, 2, np.float32, "uv")
        n = len(self.vertices)
        for name, a in (("vertices", self.vertices), ("normals", self.normals), ("uv", self.uv)):
            if a is not None and len(a) != n:
                raise Error("%s has %d rows, and vertices has %d" % (name, len(a), n))
            if a is not None and not np.isfinite(a).all():
                raise Error("%s holds a value that is not finite" % name)
        if not len(self.faces) or self.faces.min() < 0 or self.faces.max() >= n:
            raise Error("faces has %d rows: give 1 or more, of vertices 0 to %d"
                        % (len(self.faces), n - 1))

    def crosses(self) -> Doubles:
        """Normals of the faces, as long as twice their areas, (m, 3)."""
        a, b, c = self.vertices[self.faces.T].astype(np.float64)
        return np.cross(b - a, c - a)

    def centres(self) -> Doubles:
        """Middles of the faces, (m, 3)."""
        return self.vertices[self.faces].astype(np.float64).mean(axis=1)

    def __str__(self) -> str:
        text = 'Shape "trianglemesh" "integer indices" [%s] "point3 P" [%s]' % (
            _words(self.faces), _words(self.vertices))
        if self.normals is not None:
            text += ' "normal N" [%s]' % _words(self.normals)
        if self.uv is not None:
            text += ' "point2 uv" [%s]' % _words(self.uv)
        return text


def _place(name: str, value: Any) -> list[float]:
    """Three numbers of a camera. What is none is told by its name: float() would not say it."""
    try:
        values = list(value)
    except TypeError:
        raise WrongType("%s is %r: give three numbers" % (name, value)) from None
    if len(values) != 3:
        raise Error("%s is %r: give three numbers" % (name, value))
    return [real(name, x) for x in values]


class Camera(NamedTuple):
    """A perspective camera. ``str(camera)`` is its text in a scene; `render` takes both.

    Parameters
    ----------
    eye, to : tuple of float
        Where it is, and a point that it looks at.
    up : tuple of float
        The direction that is upright in the picture.
    fov : float
        Degrees along the shorter side of the picture.

    Raises
    ------
    Error
        By ``str(camera)`` and `render`: a member is no number, or no three numbers.
    """

    eye: tuple[float, float, float]
    to: tuple[float, float, float]
    up: tuple[float, float, float] = (0, 0, 1)
    fov: float = 40

    def __str__(self) -> str:
        places = [x for name in ("eye", "to", "up")
                  for x in _place("camera." + name, getattr(self, name))]
        fov = real("camera.fov", self.fov)
        return 'LookAt %s\nCamera "perspective" "float fov" %r' % (" ".join(map(repr, places)), fov)
