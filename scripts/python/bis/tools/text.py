# SPDX-License-Identifier: BSD-2-Clause
"""Numbers, durations, shares, JSON and CSV as text, in the forms that the program itself writes."""
from __future__ import annotations

import math
import re
import sys
from collections.abc import Sequence
from typing import Any, Optional


def digits(value: float) -> str:
    """Return the shortest text that reads back as the same double, in the form of C's %g: "0.05",
    "1e-05", "-0", "inf". numpy's numbers are taken, too."""
    v = float(value)
    if abs(v) < 1e15:  # Python's own shortest text, which is C's but for the ".0"
        text = repr(v)
        return text[:-2] if text.endswith(".0") else text
    # A normal double keeps 15 digits. A subnormal one holds fewer: there the search begins at 1.
    first = 1 if abs(v) < sys.float_info.min else 15
    for n in range(first, 18):
        text = "%.*g" % (n, v)
        if float(text) == v:
            break
    return text


def duration(seconds: float) -> str:
    """Return seconds >= 0 with two to three digits, in the unit that keeps the number small: "42
    ms", "3.1 s", "90 s", "6.5 min", "2.5 h", "12 days"."""
    # The limits lie where rounding would reach the next form: 9.95 would be "1e+01 s" by %.2g.
    if 0 < seconds < 0.0995:
        return "%.2g ms" % (1e3 * seconds)
    if seconds < 9.95:
        return "%.2g s" % seconds
    if seconds < 99.5:
        return "%.0f s" % seconds
    if seconds < 5400:
        return "%.*f min" % (1 if seconds < 597 else 0, seconds / 60)
    if seconds < 48 * 3600:
        return "%.1f h" % (seconds / 3600)
    return "%.3g days" % (seconds / 86400)


def percent(share: float) -> str:
    """Return a share >= 0 in percent as a person writes it, two digits or a whole number: "0.034%",
    "3.4%", "12%", "170%"; "below 0.0001%" and "over 1000000%" beyond these."""
    p = 100 * float(share)
    if 0 < p < 1e-4:  # where %g begins to write 1e-05
        return "below 0.0001%"
    if p < 9.95:
        return "%.2g%%" % p
    if p > 1e6:
        return "over 1000000%"
    return "%.0f%%" % p


def clean(text: str) -> str:
    """Return text in which bytes that are no UTF-8 (a file's name may hold any; `os.fsdecode` makes
    lone surrogates of them) are U+FFFD."""
    return re.sub("[\ud800-\udfff]", "\ufffd", text)


def _string(text: str) -> str:
    """A string of JSON. What is no UTF-8 is written as an escape."""
    if text.isascii() and text.isprintable() and '"' not in text and "\\" not in text:
        return '"%s"' % text
    out = text.replace("\\", "\\\\").replace('"', '\\"')
    out = re.sub("[\x00-\x1f\x7f]", lambda m: "\\u%04x" % ord(m.group()), out)
    return '"%s"' % re.sub("[\ud800-\udfff]", r"\\ufffd", out)


def _lines(value: Any, depth: int) -> str:
    if isinstance(value, dict):
        members = ["%s: %s" % (_string(k), _lines(v, depth + 1)) for k, v in value.items()]
        opening, closing = "{}"
    elif isinstance(value, (list, tuple)):
        members = [_lines(v, depth + 1) for v in value]
        opening, closing = "[]"
    else:
        return _scalar(value)
    if not members:
        return opening + closing
    inner = "\n" + "  " * (depth + 1)
    return opening + inner + ("," + inner).join(members) + "\n" + "  " * depth + closing


def _scalar(value: Any) -> str:
    if value is None:
        return "null"
    if isinstance(value, str):
        return _string(value)
    if isinstance(value, bool) or type(value).__name__ in ("bool_", "bool"):
        return "true" if value else "false"
    return _number(value) or "null"


def _number(value: Any) -> str:
    """A number as text; "" where it is not finite."""
    if isinstance(value, int):
        return str(int(value))
    return digits(value) if math.isfinite(value) else ""


def json(value: Any) -> str:
    """Return a value as JSON (RFC 8259) in the layout of `--stats`: a member a line, and a newline
    at the end. NaN and infinities become null; numpy's scalars are numbers, too."""
    return _lines(value, 0) + "\n"


def csv(*fields: Any) -> str:
    """Return a line of a table (RFC 4180) without its end. A number reads back as the same double;
    what is None, NaN or infinite is an empty field."""
    return ",".join((x or "") if x is None or isinstance(x, str) else _number(x) for x in fields)


def nearest(word: str, names: Sequence[str]) -> Optional[str]:
    """Return the name that word is a slip of, the first of equally near ones; None if none is at
    most a third of word's letters away."""
    best = None
    limit = max(len(word) // 3, 1)
    for name in names:
        distance = _edits(word.lower(), name.lower())
        if distance < limit or (distance == limit and best is None):
            best, limit = name, distance
    return best


def hint(word: str, names: Sequence[str]) -> str:
    """Return a question for a message: whether the nearest name was meant; "" if none is near."""
    near = nearest(word, names)
    return ' (did you mean "%s"?)' % near if near else ""


def _edits(a: str, b: str) -> int:
    """Letters to insert, remove, replace, or swap with their neighbour, to make b of a."""
    before: list[int] = []
    above = list(range(len(b) + 1))
    for i in range(1, len(a) + 1):
        row = [i]
        for j in range(1, len(b) + 1):
            d = min(above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] != b[j - 1]))
            if i > 1 and j > 1 and a[i - 1] == b[j - 2] and a[i - 2] == b[j - 1]:
                d = min(d, before[j - 2] + 1)
            row.append(d)
        before, above = above, row
    return above[-1]
