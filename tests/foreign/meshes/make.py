#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""make: the binary files of this folder, by Python's standard library. No test runs it.

    make.py
"""
import math
import random
import struct
import zlib


def write_pfm(path, width, height, colour):
    """Writes a PFM of three channels; colour(x, y) counts rows from the bottom."""
    with open(path, 'wb') as f:
        f.write(f'PF\n{width} {height}\n-1.0\n'.encode())
        for y in range(height):
            for x in range(width):
                f.write(struct.pack('<3f', *colour(x, y)))


def write_png(path, width, height, colour):
    """Writes a PNG of 8 bits; colour(x, y) counts rows from the top and is of [0, 1]."""
    rows = b''.join(b'\0' + bytes(min(255, max(0, round(255 * v))) for x in range(width) for v in colour(x, y))
                    for y in range(height))
    with open(path, 'wb') as f:
        f.write(b'\x89PNG\r\n\x1a\n')
        for kind, body in ((b'IHDR', struct.pack('>2I5B', width, height, 8, 2, 0, 0, 0)),
                           (b'IDAT', zlib.compress(rows, 9)), (b'IEND', b'')):
            f.write(struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body)))


def unit(x, y):
    """Returns the colour of a unit vector of these slopes: (n + 1) / 2."""
    size = math.sqrt(x * x + y * y + 1)
    return [(v / size + 1) / 2 for v in (x, y, 1)]


def write_corners(path):
    """Writes a PLY in big-endian order, with coordinates by corner before the indices: two triangles that share an
    edge, all of the first at (1, 0), all of the second at (0, 1)."""
    with open(path, 'wb') as f:
        f.write(b'ply\nformat binary_big_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n'
                b'property float z\nelement face 2\nproperty list uint8 double texcoord\n'
                b'property list uint8 int32 vertex_indices\nproperty int texnumber\nend_header\n')
        for p in ((-4, -4), (4, -4), (4, 4), (-4, 4)):
            f.write(struct.pack('>3f', *p, 0))
        for k, corners in enumerate(((0, 1, 2), (0, 2, 3))):
            uv = (0.75, 0) if k == 0 else (0, 0.75)
            f.write(struct.pack('>B6dB3ii', 6, *(3 * uv), 3, *corners, k))


def main():
    """Writes them."""
    noise = random.Random(1)
    write_pfm('ochre.pfm', 1, 1, lambda x, y: (1, .5, .25))
    # up: from above, a half dome of light over the upper half of the sky, with the horizon in the middle
    write_pfm('above.pfm', 8, 4, lambda x, y: (1, 1, 1) if y >= 2 else (0, 0, 0))
    write_png('lean.png', 2, 2, lambda x, y: unit(0, .5))
    write_png('slopes.png', 16, 16, lambda x, y: unit(.8 * math.sin(x), .8 * math.cos(y)))
    write_png('short.png', 2, 2, lambda x, y: (.55, .55, .86))  # as JPEG and mipmaps shorten normals
    write_png('heights.png', 16, 16, lambda x, y: 3 * [(201 + noise.randrange(3)) / 255])
    write_corners('corners.ply')
    with open('model.glb', 'wb') as f:  # the head of a file
        f.write(struct.pack('<4sIII4s', b'glTF', 2, 20, 0, b'JSON'))


if __name__ == '__main__':
    main()
