# SPDX-License-Identifier: BSD-2-Clause
"""rooms: squared error times seconds in rooms lit through openings, without and with portals, beside a portal
integrator in Mitsuba 3. docs/theory.md reads the table.

    python3 scripts/bench/rooms.py BIS MAPS OUT [WORD]     OUT keeps scenes; only rooms with WORD in their name

Every method renders each room with five seeds. All are unbiased, so the error of a method is the variance over its
seeds, over r^2 + (0.1 mean r)^2, where r is the mean of all pictures of the room. The seconds are the least of the
seeds, of rendering alone, on the one core that the caller allows (taskset)."""
import json
import math
import os
import subprocess
import sys
import time

import numpy as np
import drjit as dr
import mitsuba as mi

mi.set_variant('llvm_ad_rgb')
dr.set_thread_count(2)  # a pool of one hangs
bis, maps, out = (os.path.abspath(p) for p in sys.argv[1:4])
WIDTH, HEIGHT, SEEDS = 160, 120, 5
EYE, LOOK, FOV = (-1.7, -1.7, 1.6), (1, .6, .9), 70
TURNS = {'overcast': 0, 'outdoor': -200, 'studio': -100}  # degrees about z: the sun and the lamps are behind the window


def box(low, high):
    """Its rectangles: each a corner and two edges."""
    low, edges = np.array(low, float), np.diag(np.subtract(high, low))
    return [(low + far * edges[i], edges[(i + 1) % 3], edges[(i + 2) % 3]) for i in range(3) for far in (0, 1)]


def upright(axis, a, b, low, high):
    """Of the wall x = 2 (axis 0) or y = 2."""
    along = np.eye(3)[1 - axis]
    return 2 * np.eye(3)[axis] + a * along + [0, 0, low], (b - a) * along, np.array([0, 0, high - low])


def room(openings):
    """4 x 4 x 3; a wall with an opening is four rectangles around it."""
    walls = [r for i, r in enumerate(box((-2, -2, 0), (2, 2, 3))) if i not in (1, 3)]
    for axis in (0, 1):
        a, b, low, high = next((o[1:] for o in openings if o[0] == axis), (2, 2, 3, 3))
        walls += [upright(axis, *r) for r in ((-2, a, 0, 3), (b, 2, 0, 3), (a, b, 0, low), (a, b, high, 3))
                  if r[0] < r[1] and r[2] < r[3]]
    return walls


SIDE, BACK, DOOR = (0, -.5, .5, 1, 2), (1, -.6, .6, 1, 2), (0, -.4, .5, 0, 2.1)
BLINDS = [(np.array((2, -.5, 1 + .1 * i)), np.array((0, 1, 0)), np.array((.06, 0, .06))) for i in range(10)]
TABLE = [r for low, high in [((-.2, -.4, .7), (1, .8, .75)), ((.2, 0, .75), (.5, .3, 1.1))] + [
    ((x, y, 0), (x + .06, y + .06, .7)) for x in (-.2, .94) for y in (-.4, .74)] for r in box(low, high)]
ROOMS = {
    'one window, overcast': ('overcast', [SIDE], []), 'two windows, outdoor': ('outdoor', [SIDE, BACK], []),
    'blinds, outdoor': ('outdoor', [SIDE], BLINDS), 'door, overcast': ('overcast', [DOOR], []),
    'furniture, outdoor': ('outdoor', [SIDE], TABLE), 'one window, studio': ('studio', [SIDE], []),
    'one window, rgb L': (None, [SIDE], [])}


def points(rectangle):
    c, a, b = rectangle
    return [c, c + a, c + a + b, c + b]


def numbers(rectangle):
    return ' '.join(f'{x:g}' for p in points(rectangle) for x in p)


def bis_scene(sky, openings, things, portals, settings=''):
    """The text."""
    light = f'"string filename" "{maps}/{sky}.hdr"' if sky else '"rgb L" [1 1 1]'
    lights = [f'LightSource "infinite" {light} "bool visible" false {portal}' for portal in (
        [f'"point3 portal" [{numbers(upright(*o))}]' for o in openings] if portals else [''])]
    shapes = [f'Shape "trianglemesh" "point3 P" [{numbers(r)}] "integer indices" [0 1 2 0 2 3]'
              for r in room(openings) + things]
    return '\n'.join([
        'Scale -1 1 1', 'LookAt ' + ' '.join(map(str, (*EYE, *LOOK, 0, 0, 1))),
        f'Camera "perspective" "float fov" {FOV}', settings,
        f'Film "rgb" "integer xresolution" {WIDTH} "integer yresolution" {HEIGHT}', 'WorldBegin',
        'AttributeBegin', f'Rotate {TURNS.get(sky, 0)} 0 0 1', *lights, 'AttributeEnd',
        'Material "diffuse" "rgb reflectance" [.5 .5 .5]', *shapes, ''])
