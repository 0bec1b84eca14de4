# SPDX-License-Identifier: BSD-2-Clause
"""A measurement from the scene to the page."""
from __future__ import annotations

import contextlib
import math
import os
import sys
from types import SimpleNamespace
from typing import Optional

from ..._render import about
from ..._errors import Error, Status
from ..._library import version
from .. import command, text
from . import DEFAULT_SECONDS, QUICK_SECONDS, files, planfile, references, report, stats, tables
from .check import check_advice
from .model import Options, Trade
from .pilot import run_pilot
from .plan import LEAST_PIXELS, Frame, fit_plan, seeds_for
from .seconds import time_advice
from .settings import Integrators
from .shots import make_shots
from .sweep import PICTURES_SHARE, planned_left, run_sweep
from .view import View

# ---- what is asked ----

_OF_PLAN = ("quick", "seeds", "passes", "seed", "resolution", "reference", "integrator")


def _check_resume(o: SimpleNamespace) -> None:
    """The plan of a measurement stays as it is."""
    changed = ["--" + name for name in _OF_PLAN if name in o.given]
    if o.resume and changed:
        raise Error("error: --resume goes on by the plan in the folder, which %s would change; "
                    "leave %s out, or measure into another folder"
                    % (" and ".join(changed), "it" if len(changed) == 1 else "them"))


def _check_integrators(asked: list[str], rivals: list[str]) -> None:
    among = ", ".join(rivals[:-1]) + " or " + rivals[-1]
    wrong = []
    for name in asked:
        if name not in rivals:
            wrong.append("error: --integrator %s: must be %s%s"
                         % (name, among, text.hint(name, rivals)))
    if wrong:
        raise Error("\n".join(wrong))


def _options(o: SimpleNamespace, scene: str) -> Options:
    seconds = o.time if "time" in o.given else QUICK_SECONDS if o.quick else DEFAULT_SECONDS
    name = os.path.basename(scene)
    dot = name.rfind(".")
    folder = o.output or (name[:dot] if dot > 0 else name) + "-trade"
    return Options(scene, folder, seconds, reference=o.reference, error=o.error, quick=o.quick,
                   resume=o.resume, approximate=o.approximate, size=o.resolution, n_seeds=o.seeds,
                   passes=o.passes, seed=o.seed, threads=o.nthreads, integrators=o.integrator)


# ---- the folder ----

def _check_folder(t: Trade, say: command.Say) -> bool:
    """Whether it was not there before. It is empty, or holds a measurement to go on with."""
    folder = t.options.folder
    is_new = references.make_one(folder)
    try:
        names = os.listdir(folder)
    except OSError as e:
        status = Status.INPUT if isinstance(e, NotADirectoryError) else Status.IO
        raise Error('%s: error: "%s" is no folder that can be read: %s'
                    % (folder, folder, e.strerror), status) from None
    if not names:
        if t.options.resume:
            say.of_library("%s: warning: there is no measurement to go on with; a new one begins"
                           % folder, False)
        t.options.resume = False
    elif "plan.txt" not in names:
        raise Error('%s: error: "%s" holds other things ("%s") and no plan.txt of `bis trade`; '
                    'name a new or empty folder by --output' % (folder, folder, names[0]))
    elif not t.options.resume:
        raise Error('%s: error: "%s" holds a measurement; --resume goes on with it, --output names '
                    'another folder' % (folder, folder))
    return is_new


# ---- the plan ----

def _check_unbiased(t: Trade) -> None:
    """Only what is unbiased is advised. That is known before the first pass, so nobody waits for a
    page without advice."""
    if not any(s.is_swept and not s.is_biased for s in t.plan.settings):
        raise Error("error: all settings to be measured are biased (the ratio estimator of "
                    "rejection), so there would be no advice; name another integrator, too, by "
                    "--integrator%s"
                    % (", or leave out --quick" if t.options.quick else ""))


def _say_less(t: Trade, unseen: int, say: command.Say) -> None:
    """Tell of what --quick made do without."""
    plan = t.plan
    slow = sum(s.is_swept and not s.levels for s in plan.settings)
    less = ["1 seed"] if plan.n_seeds < seeds_for(t.options) else []
    frame = t.view.frame
    if frame.film(plan.step).pixels < frame.film(frame.step_for(LEAST_PIXELS)).pixels:
        less.append("%d x %d pixels" % (plan.width, plan.height))
    if unseen + slow and less:
        less.append("%d settings fewer" % (unseen + slow))
    elif unseen:
        less.append("%d settings fewer" % unseen)
    if less:
        say.warn("%g s are few on this machine: --quick makes do with %s; --time measures more"
                 % (t.options.seconds, ", ".join(less)))


def _make_plan(t: Trade, say: command.Say) -> bool:
    """Returns whether there is one; it was interrupted else."""
    _check_unbiased(t)
    plan, asked = t.plan, t.options
    plan.full_width, plan.full_height = t.view.frame.width, t.view.frame.height
    given = references.read_given(asked.reference, t.view.frame) if asked.reference else None
    plan.is_given, plan.seed, plan.n_seeds = given is not None, asked.seed, seeds_for(asked)
    unseen = run_pilot(t)
    if unseen is None or t.interrupted():
        return False
    spent = t.spent()
    fit_plan(plan, asked, t.view.frame, max(asked.seconds - spent, 0.1 * asked.seconds), spent)
    _say_less(t, len(unseen), say)
    if given is not None:
        references.keep_given(t, given)
    planfile.write_plan(asked.folder, plan)
    return True


# ---- all of it ----

def _nothing_measured(t: Trade) -> Error:
    """A page without a run would be a page without an answer. The plan and its references stay for
    --resume."""
    need = t.spent() + planned_left(t) / (1 - PICTURES_SHARE)
    return Error("error: 0 of %d runs: none fitted into %g s, so there is no advice and no page; "
                 "go on with --resume --time for about %s, or measure into another folder with "
                 "fewer integrators (--integrator)"
                 % (t.plan.planned_runs(), t.options.seconds, text.duration(need)))


def _measure(t: Trade, known: Integrators, say: command.Say) -> None:
    t.view = View(t, known, say)
    names = [s.name for s in t.plan.settings]
    t.plan.fingerprint = planfile.fingerprint(version(), names, t.view.files)
    if t.options.resume:
        planfile.read_plan(t.options.folder, t.plan, t.options.scene, t.view.frame.crop)
        # whatever --resolution was
        t.view.frame = Frame(t.plan.full_width, t.plan.full_height, t.view.frame.crop)
        files.read_runs(t)
    elif not _make_plan(t, say):
        return
    before = len(t.runs)
    references.make_references(t)
    if not all(t.references[s.judge].is_ready for s in t.plan.settings if s.levels):
        return  # interrupted: a plan without them is none
    run_sweep(t)
    if not t.runs and not t.interrupted():
        raise _nothing_measured(t)
    stats.summarise(t)
    check_advice(t)
    time_advice(t)
    make_shots(t)
    has_page = os.path.exists(os.path.join(t.options.folder, "report.html"))
    if t.interrupted() and len(t.runs) == before and has_page:
        return  # its advice was proven
    tables.write_tables(t)
    report.write_report(t)
    t.is_reported = True


def _print_progress(what: str, share: float, seconds_left: float) -> None:
    done = ", %.0f%%" % (100 * share) if share >= 0 else ""
    left = ", %s left" % text.duration(seconds_left) if math.isfinite(seconds_left) else ""
    sys.stderr.write("\r%s%s%s   \033[K" % (what, done, left))
    sys.stderr.flush()


def trade(o: SimpleNamespace, scene: str, say: command.Say) -> int:
    """Run `bis trade` on a scene's file with these options. Returns the exit status."""
    known = Integrators.of(about())
    _check_resume(o)
    _check_integrators(o.integrator, known.rivals())
    if scene == "-":
        raise Error("error: bis trade reads the scene again with --resume: give a file, not -")
    show = not o.quiet and os.isatty(2)
    t = Trade(_options(o, scene), progress=_print_progress if show else None,
              interrupted=command.interrupted)
    command.catch_signals()
    made_folder, failed = False, True
    try:
        made_folder = _check_folder(t, say)
        _measure(t, known, say)
        failed = False
    finally:
        if made_folder:
            with contextlib.suppress(OSError):  # it goes only where nothing was written
                os.rmdir(t.options.folder)
        if show:
            sys.stderr.write("\r\033[K")
        _say_end(t, failed, say)
    if t.is_reported:
        sys.stdout.write(report.summary(t))
    return command.INTERRUPTED if t.interrupted() else command.DONE


def _say_end(t: Trade, failed: bool, say: command.Say) -> None:
    if t.nonfinite:
        say.warn("%d estimates were not finite and count as black (docs/trust.md)" % t.nonfinite)
    if failed or t.is_reported:
        return
    if t.runs:
        say.warn("interrupted before anything new was measured: %s is as it was, with %d of %d runs"
                 % (t.options.folder, len(t.runs), t.plan.planned_runs()))
    else:
        say.warn("interrupted before the first run: there is no table and no page")
