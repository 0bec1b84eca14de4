# SPDX-License-Identifier: BSD-2-Clause
"""The scene that an operand names."""
from __future__ import annotations

import os
import sys
import warnings
from typing import TYPE_CHECKING, Any

from .._errors import Error
from .command import Say

if TYPE_CHECKING:
    from .._render import Scene


def open_scene(operand: str, say: Say, **how: Any) -> Scene:
    """Open a scene, and tell the warnings of the library.

    Parameters
    ----------
    operand : str
        A file, or "-" for standard input, which messages call <stdin>.
    say : Say
        Where the warnings go.
    **how
        As `bis.Scene` takes it.

    Returns
    -------
    Scene
        Built, and ready to be rendered.

    Raises
    ------
    Error
        As `bis.Scene` does.
    """
    from .._render import Scene

    if operand == "-":
        operand, text = "<stdin>", sys.stdin.buffer.read()
        if b"\0" in text:
            raise Error("<stdin>: error: byte %d is 0: a scene is text" % (text.index(b"\0") + 1))
        how["text"] = os.fsdecode(text)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            return Scene(operand, **how)
        finally:
            for w in told:
                say.of_library(str(w.message), False)
