# SPDX-License-Identifier: BSD-2-Clause
"""trade.csv, pareto.csv, equal_time.csv, equal_error.csv.

Numbers read back as the same doubles; what is not known is an empty field. docs/command-line.md
says what each column is.
"""
from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Callable

from .. import text
from . import stats
from .files import write_lines
from .model import Trade
from .stats import Point

PARAMETERS = ("candidates", "shadowrays", "samples", "proposal")
POINTS = (
    "setting,integrator," + ",".join(PARAMETERS) + ",areaexponent,passes,seeds,seconds,camera_rays,"
    "shadow_rays,candidates_drawn,rmse,relmse,relmse_se,noise,bias,bias_se,cost_variance,pareto")


def _point(trade: Trade, p: Point) -> str:
    s = trade.plan.settings[p.setting]
    return text.csv(
        s.name, s.integrator, *(s.values.get(name, "") for name in PARAMETERS), s.area_exponent,
        p.passes, p.n, p.seconds, p.camera_rays, p.shadow_rays, p.candidates, p.rmse, p.relmse,
        p.relmse_se, p.noise, p.bias, p.bias_se, p.cost_variance, int(p.on_front))


def front(trade: Trade) -> list[Point]:
    """The points of the front, in the order of time."""
    return sorted((p for p in trade.result.points if p.on_front), key=lambda p: p.seconds)


def _curves(trade: Trade, headings: Iterable[str], at: Iterable[float],
            reach: Callable[[Trade, int, float], tuple[float, bool]]) -> Iterable[str]:
    """A row a setting: what it comes to, by `reach`, at each time or for each error."""
    columns = ["setting", "cost_variance", "cost_variance_se", "slope", "slope_se"]
    for heading in headings:
        columns += [heading, heading + "_extrapolated"]
    yield ",".join(columns)
    for i, curve in enumerate(trade.result.curves):
        if not curve.points:
            continue
        row: list[Any] = [trade.plan.settings[i].name, curve.cost_variance, curve.cost_variance_se,
                          curve.slope, curve.slope_se]
        for x in at:
            value, is_extrapolated = reach(trade, i, x)
            row += [value, int(is_extrapolated)]
        yield text.csv(*row)


def write_tables(trade: Trade) -> None:
    """Write the four tables of the folder."""
    times = stats.times(trade)
    errors = stats.errors(trade)
    write_lines(trade, "trade.csv", [POINTS] + [_point(trade, p) for p in trade.result.points])
    write_lines(trade, "pareto.csv", [POINTS] + [_point(trade, p) for p in front(trade)])
    at = ["error_at_%.4gs" % t for t in times]
    to = ["seconds_to_%.6g" % e for e in errors]
    write_lines(trade, "equal_time.csv", _curves(trade, at, times, stats.error_at))
    write_lines(trade, "equal_error.csv", _curves(trade, to, errors, stats.seconds_to))
