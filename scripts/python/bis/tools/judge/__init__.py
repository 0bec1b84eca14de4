# SPDX-License-Identifier: BSD-2-Clause
"""`bis judge`: is a picture of another renderer right, and if not, what mistake makes it?

verdict.py tests it against a picture whose error is known. causes.py makes the pictures of
mistakes. kit.py has scenes for those who have none. report.py says what was found.
"""
from __future__ import annotations

import os
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Optional, Sequence

from ..._errors import Error, Status
from .. import command, files, text
from ..scenes import telling

if TYPE_CHECKING:
    from .report import Case

ENDINGS = (".exr", ".hdr", ".pfm", ".npy")

COMMAND = command.Command(
    name="judge",
    usage="judge [options] PICTURE... SCENE | DIR | --kit DIR",
    summary="is a picture of another renderer right, and if not, what mistake makes it?",
    options=[
        command.Option("kit", "DIR",
                       "write the kit, in minutes: scenes for bis, Mitsuba 3 and pbrt-v4, their "
                       "maps, exact pictures with errors, which mistakes each scene tells apart, "
                       "and a page of numbers for other renderers"),
        command.Option("json", None, "print JSON instead of text", command.FLAG),
        command.Option("html", "FILE", "write a page: theirs, ours, z, the cause's picture"),
    ],
    min_operands=0, max_operands=1000,
    notes="""PICTURE is linear light of SCENE by the other renderer: .exr, .hdr, .pfm, or
.npy of the shape (h, w, 3); several are of other seeds. From eight on, their
scatter is the noise. DIR holds pictures of the kit's scenes: NAME.exr, or
several, NAME-1.exr and so on. Exit status 0: right, 1: wrong, 2: refused, as a
picture of 8 bits.
""")


def _cases_of(folder: str, say: command.Say) -> list[Case]:
    """The pictures in a folder, by the scenes of the kit: the longest name that a file begins
    with."""
    from . import kit, report

    by_name: dict[str, list[str]] = {}
    for name in sorted(os.listdir(folder)):
        stem, ending = os.path.splitext(name)
        fits = [n for n in kit.NAMES if stem == n or stem.startswith((n + "-", n + ".", n + "_"))]
        if ending in ENDINGS and fits:
            by_name.setdefault(max(fits, key=len), []).append(os.path.join(folder, name))
    if not by_name:
        raise Error('error: "%s" holds no picture of the kit: give NAME.exr (.hdr, .pfm, .npy), '
                    "with NAME as in `bis judge --kit DIR`" % folder)
    return [report.case_of(n, by_name[n], True, say) for n in kit.NAMES if n in by_name]


def _cases(o: SimpleNamespace, operands: list[str], say: command.Say) -> list[Case]:
    from . import report

    if len(operands) == 1 and os.path.isdir(operands[0]):
        return _cases_of(operands[0], say)
    if len(operands) < 2:
        raise Error("error: give PICTURE... SCENE, a folder with pictures of the kit, or --kit DIR "
                    "(bis judge --help)")
    with telling(say):
        return [report.case_of(operands[-1], operands[:-1], False, say)]


def _body(o: SimpleNamespace, operands: list[str], say: command.Say) -> int:
    from . import kit, report

    if o.kit is not None:
        if operands:
            raise Error('error: "%s" beside --kit: give one of them' % operands[0])
        kit.write(o.kit)
        command.put(report.write_exact(o.kit))
        return command.DONE
    if o.html:
        files.check_writable(o.html)
        files.check_distinct(operands, [o.html])
    cases = _cases(o, operands, say)
    words = "\n".join(report.words(case) for case in cases)
    if len(cases) > 1:
        words += "\n" + report.summary(cases)
    if o.html:
        report.write_page(o.html, cases, words)
    command.put(text.json([report.data(c) for c in cases]) if o.json else words)
    if any(case.refusal for case in cases):
        return command.USAGE
    return command.DONE if all(c.verdict.is_right for c in cases) else command.FAILED


def main(argv: Sequence[str]) -> int:
    """Run the command with these arguments. Returns its exit state."""
    return command.run(COMMAND, argv, _body)
