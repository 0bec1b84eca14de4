# SPDX-License-Identifier: BSD-2-Clause
"""The scene that an operand names, warnings of the library, and seeds."""
from __future__ import annotations

import contextlib
import os
import sys
import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from .._errors import Error
from .command import Say

if TYPE_CHECKING:
    from .._render import Scene

_WORD = (1 << 64) - 1


def hashed(x: int) -> int:
    """Mix 64 bits into 64 bits, as bis_hash does (bis/base/hash.h)."""
    x &= _WORD
    x ^= x >> 30
    x = x * 0xbf58476d1ce4e5b9 & _WORD
    x ^= x >> 27
    x = x * 0x94d049bb133111eb & _WORD
    return x ^ (x >> 31)


@contextlib.contextmanager
def telling(say: Say) -> Iterator[None]:
    """Tell the warnings of the library, as messages, at the end of the block."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            yield
        finally:
            for w in told:
                say.of_library(str(w.message), False)


def open_scene(operand: str, say: Say, **how: Any) -> Scene:
    """Open a scene, as `bis.Scene` does, and tell the warnings of the library. "-" is standard
    input, which messages call <stdin>."""
    from .._render import Scene

    if operand == "-":
        operand, text = "<stdin>", sys.stdin.buffer.read()
        if b"\0" in text:
            raise Error("<stdin>: error: byte %d is 0: a scene is text" % (text.index(b"\0") + 1))
        how["text"] = os.fsdecode(text)
    with telling(say):
        return Scene(operand, **how)
