# SPDX-License-Identifier: BSD-2-Clause
"""How long does what is advised take for the full picture?

A pixel of a thin film costs more than one of the full picture: pools and clusters are made for
every pass, whatever its size, and neighbours share what each of the map's pieces costs to fetch. On
scene.txt one of 4 x 4 pixels costs 1.2 to 1.5 times as much. So whole pixels are timed: a pass of
each advised setting in the full picture, or, where that would take more than TIMING_SHARE of the
time, in blocks that lie evenly in it.
"""
from __future__ import annotations

import math
from typing import Optional

from .model import Advice, Setting, Trade
from .plan import Film

TIMING_SHARE = 0.03  # each of the advised settings takes so much of the time
TILE = 16  # the side of what a thread takes at once
TILES = 8  # of a block for each thread, so that all of them have work until its end
MOST_BLOCKS, LEAST_BLOCKS = 6, 3


def blocks(film: Film, pixels: float, threads: int) -> list[Film]:
    """Choose blocks of whole pixels that lie evenly in a film.

    Parameters
    ----------
    film : Film
        Of the full picture.
    pixels : float
        How many they should have together.
    threads : int
        That render.

    Returns
    -------
    list of Film
        The film itself where they would be most of it.
    """
    n = int(min(max(pixels / (TILE * TILE * TILES * threads), LEAST_BLOCKS), MOST_BLOCKS))
    area = max(pixels / n, TILE * TILE)
    height = min(TILE * math.ceil(area / (TILE * film.width)), film.height)
    width = min(TILE * math.ceil(area / (TILE * height)) if height % TILE == 0 else film.width,
                film.width)
    if n * height * width > 0.6 * film.pixels:
        return [film]
    found = []
    for i in range(n):
        down = int((i + 0.5) / n * film.height - height / 2) // TILE * TILE
        across = int((i * 0.618034 + 0.5) % 1 * (film.width - width)) // TILE * TILE
        found.append(Film(film.x + across, film.y + max(0, min(down, film.height - height)), width,
                          height))
    return found


def _time_block(t: Trade, s: Setting, block: Film) -> Optional[float]:
    """Seconds of a pass; None: interrupted."""
    frame = t.view.frame
    # bis rounds x * width up
    across = [max(0, x - 0.5) / frame.width for x in (block.x, block.x + block.width)]
    down = [max(0, y - 0.5) / frame.height for y in (block.y, block.y + block.height)]
    picture = t.view.render(s, 1, 1, t.options.seed, across + down)
    return None if picture is None else float(picture.seconds)


def _time_pass(t: Trade, s: Setting, about: float) -> Optional[float]:
    """Seconds of a pass of the full picture, which takes about so long; None: interrupted."""
    film = t.view.frame.film(1)
    share = TIMING_SHARE * t.options.seconds / about
    chosen = blocks(film, share * film.pixels, max(t.threads, 1)) if share < 1 else [film]
    seconds = 0.0
    for block in chosen:
        one = _time_block(t, s, block)
        if one is None:
            return None
        seconds += one if chosen == [film] else max(one - s.fill_seconds, 0)
    if chosen == [film]:
        return seconds
    return s.fill_seconds + seconds * film.pixels / sum(block.pixels for block in chosen)


def _known_seconds(earlier: list[Advice], a: Advice) -> Optional[float]:
    """Of a pass, from an earlier advice with the same setting."""
    for other in earlier:
        if other.setting == a.setting:
            return other.seconds / other.passes
    return None


def time_advice(t: Trade) -> None:
    """Replace the advice's seconds, which are the sweep's times the pixels, by better ones.

    Parameters
    ----------
    t : Trade
        With its result.
    """
    timed: list[Advice] = []
    for i, a in enumerate(t.result.advice):
        if a.setting < 0 or t.interrupted():
            continue
        t.tell("seconds of the full picture", i / len(t.result.advice), math.nan)
        one = _known_seconds(timed, a)
        if one is None:
            one = _time_pass(t, t.plan.settings[a.setting], a.seconds / a.passes)
        if one is not None:
            a.seconds = a.passes * one
            timed.append(a)
