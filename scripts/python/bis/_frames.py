# SPDX-License-Identifier: BSD-2-Clause
"""Which way round other programs show a map. No numpy here, because the help names them."""

#: World axes of programs that show a lat-long picture as `bis` shows it: the rows give their x, y
#: and z in the map's own frame, with phi = 0 at column 0 and z up. docs/command-line.md has the
#: sources.
FRAMES = {
    "bis": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "blender": ((-1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "mitsuba": ((0, 1, 0), (0, 0, 1), (-1, 0, 0)),
    "three": ((-1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "unity": ((-1, 0, 0), (0, 0, 1), (0, 1, 0)),
}
