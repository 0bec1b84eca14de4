"""Pictures of scenes."""
from __future__ import annotations

import ctypes
import json
import os
import threading
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from ._library import P, SAY, TEXT, declare, judge, run, shape, text_bytes

_render = declare("render", P, TEXT, P, P, *SAY)
_picture_close = declare("picture_close", P, result=None)
_picture_shape = declare("picture_shape", P, P, result=None)
_picture_pixels = declare("picture_pixels", P, P, result=None)
_picture_stats = declare("picture_stats", P, result=TEXT)


def _text(value: Any) -> str:
    return str(value).lower() if isinstance(value, (bool, np.bool_)) else str(value)


def _wait(worker: threading.Thread, stop: ctypes.c_int) -> None:
    """Wait for a thread in small steps, because Python hears of Ctrl-C only between calls."""
    worker.start()
    try:
        while worker.is_alive():
            worker.join(0.1)
    except BaseException:
        stop.value = 1
        worker.join()
        raise


def render(scene: Union[str, os.PathLike[str]], **settings: Any) -> tuple[NDArray[np.float32], dict[str, Any]]:
    """Render a scene, to the bits of the program `bis` with the same settings. Ctrl-C ends the render.

    Parameters
    ----------
    scene : str or path
        The file of the scene.
    **settings
        integrator, accelerator, spp, seed, seconds, error, threads, width, height, and the parameters of the
        integrator (`bis help integrators`), as in ``integrator="sir", candidates=256, spp=16``.

    Returns
    -------
    picture : array (h, w, 3)
        Radiance, row 0 at the top.
    stats : dict
        The figures of `bis --stats`.

    Raises
    ------
    Error
        A mistake in the scene or in a setting; the message names file, line and column.
    """
    texts = [text_bytes("a setting", "%s=%s" % (name, _text(value))) for name, value in settings.items()]
    path = text_bytes("scene", scene)
    wanted = (ctypes.c_char_p * (len(texts) + 1))(*texts, None)
    handle, stop, said = P(), ctypes.c_int(0), []
    try:
        _wait(threading.Thread(target=lambda: said.append(run(_render, ctypes.byref(handle), path, wanted,
                                                              ctypes.byref(stop)))), stop)
        judge(*said[0])
        rgba = np.empty(shape(_picture_shape, handle) + (4,), np.float32)
        _picture_pixels(handle, rgba.ctypes.data)
        return np.ascontiguousarray(rgba[:, :, :3]), json.loads(_picture_stats(handle).decode())
    finally:
        _picture_close(handle)
