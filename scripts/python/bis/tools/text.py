# SPDX-License-Identifier: BSD-2-Clause
"""Numbers, durations, shares, JSON and CSV as text, in the forms that the program itself writes."""
from __future__ import annotations

import math
import re
import sys
from typing import Any, Optional


def digits(value: float) -> str:
    """Return the shortest text that reads back as the same double, in the form of C's %g.

    Parameters
    ----------
    value : float
        Any number; numpy's, too.

    Returns
    -------
    str
        As "0.05", "1e-05", "-0", "inf".
    """
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
    """Return a duration with two to three digits, in the unit that keeps the number small.

    Parameters
    ----------
    seconds : float
        At least 0.

    Returns
    -------
    str
        As "42 ms", "3.1 s", "90 s", "6.5 min", "2.5 h", "12 days".
    """
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
    """Return a share in percent as a person writes it: two digits, or a whole number.

    Parameters
    ----------
    share : float
        At least 0; 1 is the whole.

    Returns
    -------
    str
        As "0.034%", "3.4%", "12%", "170%"; "below 0.0001%" and "over 1000000%" beyond these.
    """
    p = 100 * float(share)
    if 0 < p < 1e-4:  # where %g begins to write 1e-05
        return "below 0.0001%"
    if p < 9.95:
        return "%.2g%%" % p
    if p > 1e6:
        return "over 1000000%"
    return "%.0f%%" % p


def clean(text: str) -> str:
    """Return text in which bytes that are no UTF-8 (a file's name may hold any) are U+FFFD.

    Parameters
    ----------
    text : str
        As `os.fsdecode` makes it: such bytes are lone surrogates in it.

    Returns
    -------
    str
        Text that UTF-8 can hold.
    """
    return re.sub("[\ud800-\udfff]", "\ufffd", text)


def _string(text: str) -> str:
    """A string of JSON. What is no UTF-8 is written as an escape."""
    if text.isascii() and text.isprintable() and '"' not in text and "\\" not in text:
        return '"%s"' % text
    out = text.replace("\\", "\\\\").replace('"', '\\"')
    out = re.sub("[\x00-\x1f\x7f]", lambda m: "\\u%04x" % ord(m.group()), out)
    return '"%s"' % re.sub("[\ud800-\udfff]", r"\\ufffd", out)


def _lines(value: Any, depth: int) -> str:
    is_object = isinstance(value, dict)
    if not is_object and not isinstance(value, (list, tuple)):
        return _scalar(value)
    if is_object:
        members = ["%s: %s" % (_string(k), _lines(v, depth + 1)) for k, v in value.items()]
    else:
        members = [_lines(v, depth + 1) for v in value]
    opening, closing = "{}" if is_object else "[]"
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
    if isinstance(value, int):
        return str(value)
    v = float(value)
    return digits(v) if math.isfinite(v) else "null"


def json(value: Any) -> str:
    """Return a value as JSON in the layout of `--stats`: a member a line, and a newline at the end.

    Parameters
    ----------
    value : dict, list, str, float, int, bool or None
        NaN and infinities become null. numpy's scalars are numbers, too.

    Returns
    -------
    str
        Valid JSON (RFC 8259).
    """
    return _lines(value, 0) + "\n"


def csv(*fields: Any) -> str:
    """Return a line of a table (RFC 4180) without its end.

    Parameters
    ----------
    *fields : str, float or None
        A number reads back as the same double. What is None, NaN or infinite is an empty field.

    Returns
    -------
    str
        The fields with commas between them.
    """
    return ",".join(_field(x) for x in fields)


def _field(value: Any) -> str:
    if value is None or isinstance(value, str):
        return value or ""
    if isinstance(value, int):
        return str(int(value))
    v = float(value)
    return digits(v) if math.isfinite(v) else ""


def nearest(word: str, names: list[str]) -> Optional[str]:
    """Return the name that word is a slip of.

    Parameters
    ----------
    word : str
        What was written.
    names : list of str
        What may be meant; the first of equally near ones is taken.

    Returns
    -------
    str or None
        A name at most a third of word's letters away; None if there is none.
    """
    best = None
    limit = max(len(word) // 3, 1)
    for name in names:
        distance = _edits(word.lower(), name.lower())
        if distance < limit or (distance == limit and best is None):
            best, limit = name, distance
    return best


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
