#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""test_files: files as other programs write them, and what bis must make of each.

    tests/foreign/test_files.py [FOLDER...]      without FOLDER: each folder beside this file that has an `expect`

BIS_PROGRAM names the program. A line of FOLDER/expect is a test: KIND, the arguments of bis, and a check, with tabs
between them. bis runs in FOLDER; a word OUT.pfm or OUT.png of the arguments becomes a scratch file. "A | B": either
holds. A line of `# ` is a comment. The checks:

    exit N [REGEX]        the exit status is N, and REGEX is found in what bis says
    says REGEX            the exit status is 0, and REGEX is found in what bis says
    silent REGEX          the exit status is 0, and REGEX is not found in what bis says
    mean R G B TOL        the mean of all pixels; TOL is relative to the largest of the three
    covered R G B TOL     the mean of the pixels that are not black
    luminance Y TOL       the luminance of the mean; TOL is relative
    covers SHARE TOL      the share of pixels that are not black
    equals FILE TOL       each value is that of the PFM FILE; TOL is relative to it, or to 1e-3 where it is less
    near FILE TOL         the mean absolute difference from the PFM FILE is at most TOL
    same-as SCENE TOL     as `equals`, of what bis makes of SCENE in the place of the last argument
    rgba FILE             OUT.png is a PNG of 8 bits, and its samples are the bytes of FILE

An expected value is worked out by another program or by hand; make.py of a folder says how its binary files were made.
"""
import array
import os
import re
import struct
import subprocess
import sys
import tempfile
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))
BIS = os.path.abspath(os.environ.get('BIS_PROGRAM', 'build/release/bis'))


def read_pfm(path):
    """Returns the size of a PFM of three little-endian channels, and its pixels from the top row on."""
    with open(path, 'rb') as f:
        kind, size, scale, data = f.read().split(b'\n', 3)
    width, height = map(int, size.split())
    if kind != b'PF' or float(scale) >= 0:
        raise ValueError(f'{path}: no PFM of three little-endian channels')
    values = array.array('f', data[:12 * width * height])
    if sys.byteorder != 'little':
        values.byteswap()
    rows = [values[3 * width * y:3 * width * (y + 1)] for y in reversed(range(height))]
    return (width, height), [row[i:i + 3] for row in rows for i in range(0, 3 * width, 3)]


def read_png(path):
    """Returns the samples of a PNG of 8 bits, by its specification: five filters over an inflated stream."""
    with open(path, 'rb') as f:
        data = f.read()
    at, packed, rows = 8, b'', []
    while at < len(data):
        length, kind = struct.unpack('>I4s', data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b'IHDR':
            width, height, depth, colour = struct.unpack('>IIBB', body[:10])
        packed += body if kind == b'IDAT' else b''
        at += 12 + length
    n = {0: 1, 2: 3, 4: 2, 6: 4}[colour]
    if depth != 8:
        raise ValueError(f'{path}: {depth} bits a sample')
    plain, row = zlib.decompress(packed), bytearray(n * width)
    for y in range(height):
        kind, line, above = plain[y * (n * width + 1)], bytearray(n * width), row
        for i in range(n * width):
            a, b, c = line[i - n] if i >= n else 0, above[i], above[i - n] if i >= n else 0
            nearest = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            line[i] = plain[y * (n * width + 1) + 1 + i] + (0, a, b, (a + b) // 2, nearest)[kind] & 255
        row = line
        rows.append(bytes(row))
    return b''.join(rows)


def mean(pixels):
    """Returns the mean of a list of colours, black for none."""
    return [sum(p[k] for p in pixels) / max(1, len(pixels)) for k in range(3)]


def run(arguments, folder):
    """Runs bis in a folder and returns its exit status and all that it says."""
    p = subprocess.run([BIS, *arguments], cwd=folder, capture_output=True, text=True, errors='replace')
    return p.returncode, p.stdout + p.stderr


class Case:
    """One line of a table, and what bis made of it in a scratch folder."""

    def __init__(self, line, folder, scratch):
        """Runs bis for a line of FOLDER/expect."""
        self.kind, command, self.check = line.split('\t')
        self.folder, self.scratch = folder, scratch
        self.command = command.split()
        self.status, self.said = self.run('out', self.command)

    def run(self, name, command):
        """Runs a command whose OUT.* becomes a file of this name."""
        return run([w.replace('OUT', os.path.join(self.scratch, name)) if re.fullmatch(r'OUT\.\w+', w) else w
                    for w in command], self.folder)

    def alike(self, pixels, others, tolerance):
        """Returns whether two pictures agree value by value."""
        return len(pixels) == len(others) and all(
            abs(p[k] - q[k]) <= tolerance * max(abs(q[k]), 1e-3)
            for p, q in zip(pixels, others) for k in range(3))

    def holds(self, check):
        """Returns whether one alternative of the check holds."""
        what, *words = check.split()
        if what == 'exit':
            return self.status == int(words[0]) and re.search(' '.join(words[1:]), self.said) is not None
        if self.status:
            return False
        if what in ('says', 'silent'):
            return (re.search(' '.join(words), self.said) is not None) == (what == 'says')
        if what == 'rgba':
            with open(os.path.join(self.folder, words[0]), 'rb') as f:
                return read_png(os.path.join(self.scratch, 'out.png')) == f.read()
        size, pixels = read_pfm(os.path.join(self.scratch, 'out.pfm'))
        tolerance = float(words[-1])
        lit = [p for p in pixels if max(p) > 0]
        if what in ('equals', 'near'):
            other, others = read_pfm(os.path.join(self.folder, words[0]))
            if what == 'equals':
                return size == other and self.alike(pixels, others, tolerance)
            apart = sum(abs(p[k] - q[k]) for p, q in zip(pixels, others) for k in range(3))
            return size == other and apart <= tolerance * 3 * len(pixels)
        if what == 'same-as':
            status, _ = self.run('other', [*self.command[:-1], words[0]])
            return status == 0 and self.alike(pixels, read_pfm(os.path.join(self.scratch, 'other.pfm'))[1], tolerance)
        if what == 'covers':
            return abs(len(lit) / len(pixels) - float(words[0])) <= tolerance
        m = mean(lit if what == 'covered' else pixels)
        if what == 'luminance':
            y = .2126 * m[0] + .7152 * m[1] + .0722 * m[2]
            return abs(y - float(words[0])) <= tolerance * float(words[0])
        if what not in ('mean', 'covered'):
            raise ValueError(f'no check of the name {what}')
        wanted = [float(w) for w in words[:3]]
        return all(abs(a - b) <= tolerance * max(max(wanted), 1e-6) for a, b in zip(m, wanted))

    def describe(self):
        """Returns what bis made of it, for a message."""
        got = f'exit {self.status}'
        path = os.path.join(self.scratch, 'out.pfm')
        if os.path.exists(path):
            _, pixels = read_pfm(path)
            lit = [p for p in pixels if max(p) > 0]
            got += ', mean {:.4g} {:.4g} {:.4g}'.format(*mean(pixels))
            got += ', of lit {:.4g} {:.4g} {:.4g}, lit {:.4f}'.format(*mean(lit), len(lit) / len(pixels))
        return got + ', says: ' + ' '.join(self.said.split())[:400]


def main():
    """Runs each line of each table, prints as cmocka does, and returns the exit status."""
    folders = sys.argv[1:] or sorted(f.path for f in os.scandir(HERE) if os.path.exists(os.path.join(f, 'expect')))
    failed = count = 0
    for folder in folders:
        with open(os.path.join(folder, 'expect'), encoding='utf-8') as f:
            lines = [line.rstrip('\n') for line in f if line.strip() and not line.startswith('#')]
        for line in lines:
            with tempfile.TemporaryDirectory() as scratch:
                case = Case(line, folder, scratch)
                good = any(case.holds(check.strip()) for check in case.check.split(' | '))
                print(f'[{"       OK" if good else "  FAILED "} ] {case.kind}: bis {" ".join(case.command)}')
                if not good:
                    print(f'    must: {case.check}\n    but: {case.describe()}')
            count += 1
            failed += not good
    print(f'{count - failed} passed, {failed} failed')
    return failed > 0 or not count


if __name__ == '__main__':
    sys.exit(main())
