# SPDX-License-Identifier: BSD-2-Clause
"""Pictures of scenes."""
from __future__ import annotations

import contextlib
import ctypes
import json
import os
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import count
from numbers import Real
from typing import TYPE_CHECKING, Any, Callable, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._library import D, P, TEXT, Error, Floats, Handle, WrongType, call, filled, flat, judge, opened
from ._library import real, run, shape, text_bytes, texts, whole
from ._sampling import Envmap
from ._scene import Camera, Mesh

if TYPE_CHECKING:
    from ._irradiance import Arriving
    from ._stage import Stage

_WATCHER = ctypes.CFUNCTYPE(None, D, D, D, P)

Light = Union[None, Envmap, str, "os.PathLike[str]", ArrayLike]
Asked = Optional[Callable[[], bool]]


class Progress(NamedTuple):
    """How far a render is.

    Parameters
    ----------
    share : float
        Of the budget that is used, in [0, 1].
    seconds : float
        Of rendering.
    seconds_left : float
        NaN while it is unknown.
    """

    share: float
    seconds: float
    seconds_left: float


Watcher = Optional[Callable[[Progress], Any]]


@dataclass(frozen=True)
class Picture:
    """What `render` returns. ``picture, stats = render(...)`` takes rgb and stats of it.

    Attributes
    ----------
    rgb : array (h, w, 3)
        Radiance, row 0 at the top.
    alpha : array (h, w)
        The share of samples that hit a surface.
    layers : dict of arrays
        The layers that were asked for, by their names: (h, w, 3), or (h, w) of one value.
    stats : dict
        The figures of `bis --stats`.
    seconds : float
        Of the render alone.
    passes : int
        Complete ones.
    camera_rays, shadow_rays, candidates, accepted : int
        As counted.
    nonfinite : int
        Estimates that were not finite, and count as black.
    threads : int
        As used.
    interrupted : bool
        It was stopped; the picture has the passes that were complete.
    error : float
        The relative RMSE that its passes tell of; NaN: fewer than two. Where few pixels carry it,
        it may be far off; then ``stats["estimated_relative_rmse"]`` is None.
    """

    rgb: Floats
    alpha: Floats
    layers: dict[str, Floats]
    stats: dict[str, Any]
    seconds: float
    passes: int
    camera_rays: int
    shadow_rays: int
    candidates: int
    accepted: int
    nonfinite: int
    threads: int
    interrupted: bool
    error: float

    @property
    def pass_seconds(self) -> float:
        """Seconds of a pass in the mean."""
        return self.seconds / self.passes

    def __iter__(self) -> Iterator[Any]:
        return iter((self.rgb, self.stats))


def _text(value: Any) -> str:
    return str(value).lower() if isinstance(value, (bool, np.bool_)) else str(value)


def _listed(name: str, values: Any, what: str, word: Callable[[Any], str]) -> str:
    """Values as the library reads a list of them."""
    try:
        return ",".join([word(x) for x in values])
    except TypeError as e:
        if isinstance(e, WrongType):
            raise
        raise WrongType("%s is %r: give %s" % (name, values, what)) from None


def _said(layers: Any, crop: Any, camera: Any, progress: Any,
          settings: dict[str, Any]) -> list[bytes]:
    """What is said of a picture, for the library."""
    if progress is not None and not callable(progress):
        raise WrongType("progress is %r: give a function" % (progress,))
    said = dict(settings)
    for name, value in said.items():
        if name in ("integrator", "accelerator", "as_printed") and not isinstance(value, str):
            raise WrongType("%s is %r: give a text" % (name, value))
        if not isinstance(value, (str, Real, np.bool_)):
            raise WrongType("%s is %r: give a number, a text, True or False" % (name, value))
    if layers is not None:
        said["layers"] = (layers if isinstance(layers, str) else
                          _listed("layers", layers, "a list of names", lambda x: x))
    if crop is not None:
        said["crop"] = _listed("crop", crop, "four numbers", lambda x: repr(real("crop", x)))
    if camera is not None:
        if not isinstance(camera, (str, Camera)):
            raise WrongType("camera is %r: give a bis.Camera, or the text of one" % (camera,))
        said["camera"] = camera
    return [text_bytes("scene" if name == "text" else "a setting", "%s=%s" % (name, _text(value)))
            for name, value in said.items()]


def _opened(scene: Any, approximate: Any, settings: dict[str, Any]) -> tuple[bytes, dict[str, Any]]:
    """The name of a scene, and the settings that say how it is read."""
    said = dict(settings)
    if approximate is not False:
        said["approximate"] = approximate
    if isinstance(scene, str) and "WorldBegin" in scene:
        said["text"], scene = scene, "scene"
    return text_bytes("scene", scene), said


def settings_of(settings: dict[str, Any]) -> Any:
    """Settings alone as the library takes them."""
    return texts(_said(None, None, None, None, settings))


def sky_of(light: Any) -> Optional[Envmap]:
    """The map of an argument `light`, if there is one."""
    if light is None or isinstance(light, Envmap):
        return light
    if not isinstance(light, (str, bytes, os.PathLike)) and not np.ndim(light):
        raise WrongType("light is %r: give an Envmap, a path, or an array (h, w, 3)" % (light,))
    return Envmap(light)


def wait(work: Callable[[], Any], stop: ctypes.c_int, seen: Optional[list[Progress]] = None,
         progress: Watcher = None, asked: Asked = None) -> None:
    """Do work in a thread, and wait in small steps: Python hears of Ctrl-C only between calls.

    The library tells of its progress in a thread of its own, where an exception would be lost: here
    it ends the work, which has always ended when this returns or raises, because it writes to what
    the caller frees.
    """
    # Not a join: one that Ctrl-C interrupts takes the thread for dead (Python 3.10 to 3.12).
    done = threading.Event()

    def all_of_it() -> None:
        try:
            work()
        finally:
            done.set()

    threading.Thread(target=all_of_it).start()
    try:
        while not done.wait(0.1):
            if progress and seen:
                progress(seen.pop())
            if asked is not None and asked():
                stop.value = 1
        if progress and seen:
            progress(seen.pop())
    except BaseException:
        stop.value = 1
        while not done.is_set():
            with contextlib.suppress(KeyboardInterrupt):
                done.wait()
        raise


def _layers(handle: Any, size: tuple[int, int], names: Sequence[str]) -> dict[str, Floats]:
    found = {}
    for name in names:
        n = flat.picture_layer(handle, name.encode(), None)
        if n:
            found[name] = np.empty(size + (n,) if n > 1 else size, np.float32)
            flat.picture_layer(handle, name.encode(), found[name].ctypes.data)
    return found


LAYERS: tuple[str, ...] = tuple(name.decode() for name in
                                iter(map(flat.layer_name, count()).__next__, None))


def render(scene: Union[str, os.PathLike[str]], *, layers: Union[None, str, Sequence[str]] = None,
           approximate: bool = False, light: Light = None,
           crop: Optional[Sequence[float]] = None, camera: Union[None, Camera, str] = None,
           progress: Watcher = None, **settings: Any) -> Picture:
    """Render a scene, to the bits of the program `bis` with the same settings. Ctrl-C ends it.

    Parameters
    ----------
    scene : str or path
        The file of the scene, or its text: a str with the word WorldBegin. Files that a text names
        are looked for in the working directory.
    layers : str or list of str, optional
        What to keep beside the colours: names of `bis.LAYERS`, or "all". A standard error needs two
        passes, and is left out of the result where there is one.
    approximate : bool
        Replace what of pbrt bis does not model; warnings list what was replaced.
    light : Envmap, path or array (h, w, 3), optional
        A map in the place of all lights of the scene, upright as with `--light`.
    crop : four floats, optional
        x0, x1, y0, y1 of the part to render, in shares of the picture.
    camera : Camera or str, optional
        A camera in the place of the scene's.
    progress : callable, optional
        It is given a `Progress` a few times a second, in the thread of the caller. What it raises
        ends the render.
    **settings
        integrator, accelerator, spp, seed, seconds, error, threads, width, height, and the
        parameters of the integrator (`bis help integrators`), as in
        ``integrator="sir", candidates=256, spp=16``.

    Returns
    -------
    Picture
        rgb, alpha, layers and stats; it unpacks as (rgb, stats).

    Raises
    ------
    Error
        A mistake in the scene or in a setting; the message names file, line and column.
    """
    path, said = _opened(scene, approximate, settings)
    how = texts(_said(layers, crop, camera, progress, said))
    return _picture(flat.render_with, path, how, light, progress)


def _picture(f: Any, what: Any, how: Any, light: Any, progress: Watcher,
             stop: Asked = None) -> Picture:
    """Render in a thread of its own, and take the picture over."""
    sky = sky_of(light)
    given = sky and sky._handle  # here, because nobody hears what a thread raises
    handle, ended, said, seen = P(), ctypes.c_int(0), [], []  # type: ignore[var-annotated]

    def look_on(share: float, seconds: float, left: float, user: Any) -> None:
        seen[:] = [Progress(share, seconds, left)]

    watcher = _WATCHER(look_on) if progress else _WATCHER()

    def work() -> None:
        said.append(run(f, ctypes.byref(handle), what, how, given, watcher, None,
                        ctypes.byref(ended)))

    try:
        wait(work, ended, seen, progress, stop)
        judge(*said[0])
        size = shape(flat.picture_shape, handle)
        rgba = filled(flat.picture_pixels, handle, size + (4,), np.float32)
        figures = filled(flat.picture_figures, handle, 10).tolist()
        return Picture(np.ascontiguousarray(rgba[:, :, :3]), np.ascontiguousarray(rgba[:, :, 3]),
                       _layers(handle, size, LAYERS),
                       json.loads(flat.picture_stats(handle).decode()),
                       figures[0], *map(int, figures[1:8]), bool(figures[8]), figures[9])
    finally:
        flat.picture_close(handle)


def about() -> dict[str, Any]:
    """Tell what the library has.

    Returns
    -------
    dict
        "integrators" (a list: name, claim, parameters with type, default, range or choices),
        "layers", "accelerators", "embree_version", "limits", "defaults".
    """
    return dict(json.loads(flat.about().decode()))


class Scene(Handle):
    """A scene that is parsed and built once, and rendered often.

    Meshes and accelerator are loaded when it is made. Its pictures may differ in integrator,
    samples, seed, size, crop, camera and light. Two scenes may be rendered in two threads at the
    same time; one scene makes one picture at a time.

    Parameters
    ----------
    scene : str or path
        The file of the scene, or its text: a str with the word WorldBegin.
    approximate : bool
        Replace what of pbrt bis does not model; warnings list what was replaced.
    light : Envmap, path or array (h, w, 3), optional
        A map in the place of all lights of the scene, upright as with `--light`.
    **settings
        As those of `bis.render`, and accelerator: what each picture begins with.

    Raises
    ------
    Error
        A mistake in the scene or in a setting; the message names file, line and column.
    """

    _close = staticmethod(flat.scene_close)
    _made = ("_handle",)

    def __init__(self, scene: Union[str, os.PathLike[str]], *, approximate: bool = False,
                 light: Light = None, **settings: Any) -> None:
        path, said = _opened(scene, approximate, settings)
        self._sky = sky_of(light)
        self._handle = opened(flat.scene_open, path, settings_of(said),
                              self._sky and self._sky._handle)
        self._busy = threading.Lock()

    def render(self, *, layers: Union[None, str, Sequence[str]] = None, light: Light = None,
               crop: Optional[Sequence[float]] = None, camera: Union[None, Camera, str] = None,
               progress: Watcher = None, stop: Asked = None, **settings: Any) -> Picture:
        """Render a picture, to the bits of `bis.render` with the same settings.

        Parameters
        ----------
        layers, light, crop, camera, progress
            As those of `bis.render`, for this picture alone.
        stop : callable, optional
            It is asked some times a second; True ends the render after what is complete.
        **settings
            As those of `bis.render` but accelerator, and for maps and thin pictures

            step : k renders of each k x k pixels one;
            turn : degrees by which the map is turned about its own upright axis;
            area_exponent : b of the map's importance (thesis 3.4);
            as_printed : errata to follow as printed, as "E3,E13", or "none".

        Returns
        -------
        Picture
            rgb, alpha, layers, stats and counts.

        Raises
        ------
        Error
            A mistake in a setting, or it was stopped before its first pass was complete.
        """
        how = texts(_said(layers, crop, camera, progress, settings))
        with self._busy:
            return _picture(flat.scene_render, self._handle, how, light, progress, stop)

    def irradiance(self, points: ArrayLike, normals: ArrayLike, *, lift: Optional[float] = None,
                   **settings: Any) -> Arriving:
        """Estimate how much light arrives at points, which need not lie on shapes.

        Parameters
        ----------
        points, normals : array (n, 3)
            In world space; a normal may have any length but 0.
        lift : float, optional
            How far points are moved along their normals, off the surfaces on which they may lie;
            without it, 2e-6 of the largest coordinate, the error of six digits.
        **settings
            As those of `render`: spp, error, seed, integrator and the like.

        Returns
        -------
        Arriving
            E (n, 3), the half-width of its 95 % interval, and stats.
        """
        from ._irradiance import at_points
        return at_points(self, points, normals, lift, **settings)

    def mesh(self, shape: Optional[int] = None) -> Mesh:
        """Take the triangles of the scene, in world space.

        Parameters
        ----------
        shape : int, optional
            The number of one of its shapes, from 0, each instance of an object counted; without
            it, all that are meshes.

        Returns
        -------
        Mesh
            Vertices, faces that turn counterclockwise from outside, and normals of the vertices;
            where the scene has none, the mean of the faces' by area.
        """
        size = (ctypes.c_size_t * 2)()
        flat.scene_mesh(self._handle, size, None, None, None, None)
        point, normal = np.empty((2, size[0], 3), np.float32)
        face, of = np.empty((size[1], 3), np.uint32), np.empty(size[1], np.uint32)
        flat.scene_mesh(self._handle, size, *(a.ctypes.data for a in (point, normal, face, of)))
        if shape is not None:
            face = face[of == whole("shape", shape)]
        if not len(face):
            raise Error("the scene has no meshes" if not len(of) else
                        "shape %d has no triangles; others have: %s" % (
                            shape, ", ".join(map(str, np.unique(of)[:8]))))
        used, face = np.unique(face, return_inverse=True)
        found = Mesh(point[used], face.reshape(-1, 3), normal[used])
        sums = np.stack([np.bincount(found.faces.ravel(), np.repeat(a, 3), len(used))
                         for a in found.crosses().T], axis=1)
        lacking = ~found.normals.any(axis=1)
        found.normals[lacking] = sums[lacking]
        return found

    def _of_points(self, points: Floats, normals: Floats, settings: dict[str, Any]) -> Picture:
        """The picture in which points (h, w, 3) stand in the place of pixels."""
        height, width = points.shape[:2]
        how = texts(_said(["interval", "unoccluded"], None, None, None, settings))
        with self._busy:
            call(flat.scene_points, self._handle, width, height, points, normals)
            try:
                return _picture(flat.scene_render, self._handle, how, None, None, None)
            finally:
                call(flat.scene_points, self._handle, 0, 0, None, None)

    def stage(self, light: Light = None) -> Stage:
        """Look at points of the scene.

        Parameters
        ----------
        light : Envmap, path or array (h, w, 3), optional
            A map in the place of the scene's light.

        Returns
        -------
        Stage
            Its method `at` chooses a pixel.
        """
        from ._stage import Stage
        return Stage(self, light)

    def about(self, **settings: Any) -> dict[str, Any]:
        """Tell what a picture with these settings would be of.

        Parameters
        ----------
        **settings
            As those of `render`.

        Returns
        -------
        dict
            path, files (all that hold its text); width, height and crop of the picture, film (x0,
            y0, width, height of what is rendered); integrator, claim, parameters, line (the
            Integrator line that says it; whole_line: with defaults), as_printed; spp, seed,
            is_stratified; accelerator, triangles, has_surface; light (file, is_black, is_constant,
            width, height, area_exponent, levels).
        """
        text = TEXT()
        with self._busy:
            call(flat.scene_about, ctypes.byref(text), self._handle, settings_of(settings))
            return dict(json.loads((text.value or b"").decode()))

    def coverage(self, side: int = 4, **settings: Any) -> Floats:
        """Tell how much of each pixel shapes cover: the rest is background.

        Parameters
        ----------
        side : int
            So many times so many camera rays go through each pixel.
        **settings
            As those of `render`; crop and size count.

        Returns
        -------
        array (h, w)
            Shares in [0, 1].
        """
        film = self.about(**settings)["film"]
        share = np.empty((film["height"], film["width"]), np.float32)
        with self._busy:
            call(flat.scene_coverage, self._handle, settings_of(settings),
                 whole("side", side), share)
        return share
