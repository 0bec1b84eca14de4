# SPDX-License-Identifier: BSD-2-Clause
"""`bis trade SCENE`: measure error against time for several estimators, into a folder with tables
and a page.

Ctrl-C (SIGTERM, SIGHUP) abandons the render under way; what was measured is written, tables and
page included, and the exit status is 130. A second one kills, and loses a second of measurements at
most.
"""
from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace

from .. import command
from ..command import COUNT, FLAG, LIST, SECONDS, SHARE, SIZE, TEXT, Command, Heading, Option

DEFAULT_SECONDS, QUICK_SECONDS = 150, 28

COMMAND = Command(
    name="trade",
    usage="trade [options] SCENE",
    summary="measure error against time for several estimators",
    options=(
        Heading("what is written"),
        Option("output", "DIR", "folder for tables, pictures and report.html (default: the scene's "
                                "name with -trade, in the working folder); new, empty, or with "
                                "--resume", TEXT),
        Option("resume", None, "go on with the measurement in the folder, by its plan", FLAG),
        Option("quiet", None, "no progress and no warnings", FLAG),
        Heading("how long"),
        Option("time", "SECONDS", "for everything (150); size, passes and seeds follow from it",
               SECONDS, above=True, hi=1e7),
        Option("quick", None, "a shorter table of settings, in 30 s", FLAG),
        Option("error", "E", "the relative RMSE of a final picture (0.05): measure until there; an "
                             "error right after the pilot where that is out of reach",
               SHARE, above=True, hi=10, default=0.0),
        Option("seeds", "N", "renders of each setting and budget (2, 3 or 5, by the time)", COUNT,
               lo=1, hi=16, default=0),
        Option("passes", "N", "budgets of 1, 2, 4 ... up to N passes for every setting, instead of "
                              "what the time allows", COUNT, lo=1, hi=1 << 20, default=0),
        Heading("what is measured"),
        Option("integrator", "NAME", "em, brdf, mis, rejection or sir alone; may be repeated",
               LIST),
        Option("reference", "F", "compare with this picture (.exr, .pfm, .hdr) of the scene's "
                                 "size, instead of rendering references", TEXT),
        Option("approximate", None, "what of pbrt bis does not model is replaced by the nearest "
                                    "that it does, and listed", FLAG),
        Option("resolution", "WxH", "size of the full picture; measured is a smaller one of the "
                                    "same view", SIZE),
        Option("seed", "N", "other random numbers (1)", COUNT, hi=command.SEED_MAX, default=1),
        Option("nthreads", "N", "threads (default: one for each processor)", COUNT, lo=1, hi=1024,
               default=0),
    ),
    min_operands=1,
    max_operands=1,
    notes="Ctrl-C ends it with what was measured; --resume goes on.\n"
          "Exit status: 0 done; 1 could not read or write, or out of memory; 2 bad usage or\n"
          "bad scene, or what cannot be done in the time; 130 interrupted.\n",
)


def _body(o: SimpleNamespace, operands: list[str], say: command.Say) -> int:
    from .run import trade  # here, because it needs numpy, and help does not

    return trade(o, operands[0], say)


def main(arguments: Sequence[str]) -> int:
    """Run the command.

    Parameters
    ----------
    arguments : sequence of str
        Behind its name.

    Returns
    -------
    int
        The exit state.
    """
    return command.run(COMMAND, arguments, _body)
