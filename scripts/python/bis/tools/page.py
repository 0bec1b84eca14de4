# SPDX-License-Identifier: BSD-2-Clause
"""Pages: a file of HTML that shows a JSON object by its own script, and needs nothing but itself.

`make` puts each page of scripts/python/pages into the frame that all share, with the scripts and
the style of the live figures, and keeps it in the package. The frame has two places to be filled:
the object, and the same as text for a browser without JavaScript.
"""
from __future__ import annotations

import base64
import os
import re
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .. import _image
from .._errors import Error
from . import files, text

_TEXT = '<pre id="text">'
_DATA = '<script type="application/json" id="data">'


def _escaped(words: str) -> str:
    """Text in HTML. A control character, and a byte that no UTF-8 holds, becomes U+FFFD."""
    words = re.sub("[\x00-\x09\x0b-\x1f\x7f]", "\ufffd", text.clean(words))
    return words.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def write(path: str, name: str, data: Any, words: str) -> None:
    """Write page `name` (trade, pixel, envmap), whole or not at all, with the object that it shows
    and the same as text."""
    here = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    source = os.path.join(here, "pages", name + ".html")
    try:
        with open(source, encoding="utf-8", newline="") as f:
            page = f.read()
    except OSError as e:
        raise Error('error: the page "%s" cannot be read: %s; `make` writes it'
                    % (source, e.strerror)) from None
    before, _, rest = page.partition(_TEXT)
    middle, _, rest = rest.partition(_DATA)
    after = rest[rest.index("<"):]  # without the null
    # In JSON a < stands in strings alone, which may have it as an escape.
    filled = "".join((before, _TEXT, _escaped(words), middle, _DATA,
                      text.json(data).replace("<", "\\u003c"), after))
    with files.outfile(path) as out:
        out.write(filled.encode("utf-8"))


def numbers(values: ArrayLike, size: int) -> str:
    """Return integers >= 0 in base64 (RFC 4648) for the page's script: of each its `size` lowest
    bytes, 1 to 4, the highest first."""
    words = np.ascontiguousarray(values, ">u4").reshape(-1, 1).view(np.uint8)
    return base64.b64encode(words[:, 4 - size:].tobytes()).decode("ascii")


def png(pixels: ArrayLike, exposure: float) -> str:
    """Return a picture (h, w, 3) as an address (data:) that a page can show. With exposure 0 (in
    EV) the colours appear as they are."""
    return "data:image/png;base64," + base64.b64encode(_image.png(pixels, exposure)).decode("ascii")
