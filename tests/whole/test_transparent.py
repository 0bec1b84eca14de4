#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""test_transparent: --transparent in a PNG, by the formulas of its specification.

The same camera samples see a constant light b of the background or nothing. So a pixel is f + (1 - a) b in the one
picture and f in the other: both, as PFM, tell a and f without the code that writes alpha. Standard library alone.
"""
import os
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, '..', 'foreign'))
from test_files import read_pfm, read_png, run  # noqa: E402

LIGHT = 8
SCENE = f"""Film "rgb" "integer xresolution" 40 "integer yresolution" 30
LookAt 0 -6 0  0 0 0  0 0 1
Camera "perspective" "float fov" 40
Sampler "stratified" "integer xsamples" 4 "integer ysamples" 4
WorldBegin
LightSource "infinite" "rgb L" [{LIGHT} {LIGHT} {LIGHT}]VISIBLE
Material "diffuse" "rgb reflectance" [0.02 0.05 0.11]
Shape "sphere"
"""
failed, passed = [], []


def claim(name, good, why=''):
    """Prints a test as cmocka does."""
    print(f'[{"       OK" if good else "  FAILED "} ] {name}' + ('' if good else f': {why}'))
    (passed if good else failed).append(name)


def srgb(v):
    """Returns the code of 8 bits of a linear value (IEC 61966-2-1)."""
    v = min(max(v, 0), 1)
    return int(255 * (12.92 * v if v <= .0031308 else 1.055 * v ** (1 / 2.4) - .055) + .5)


def expected(front, all_of_it, opaque):
    """Returns the samples of a PNG: colours not premultiplied, alpha linear."""
    codes = []
    for f, whole in zip(front, all_of_it):
        a = 1 if opaque else round(16 * (1 - (whole[0] - f[0]) / LIGHT)) / 16  # 16 camera samples
        codes += [srgb(v / a) if a else 0 for v in f] + ([] if opaque else [int(255 * a + .5)])
    return codes


def apart(png, codes):
    """Returns the largest difference of two lists of codes. A rounding on the border of two may go either way."""
    return max(abs(p - q) for p, q in zip(png, codes)) if len(png) == len(codes) else 256


def darkest(png, back):
    """Returns the least of the composite over a background, as a viewer mixes codes, less the darker of its parts."""
    pixels = [png[i:i + 4] for i in range(0, len(png), 4)]
    subject = [min(p[k] for p in pixels if p[3] == 255) for k in range(3)]
    return min((p[3] * p[k] + (255 - p[3]) * back) / 255 - min(subject[k], back) for p in pixels for k in range(3))


def main():
    """Renders, compares, and returns the exit status."""
    with tempfile.TemporaryDirectory() as scratch:
        def render(name, scene, *options):
            """Renders into a file of this name, and returns its path."""
            with open(os.path.join(scratch, 'scene.txt'), 'w', encoding='utf-8') as f:
                f.write(scene)
            status, said = run(['scene.txt', '--quiet', '--exposure', '0', '--outfile', name, *options], scratch)
            if status:
                raise RuntimeError(said)
            return os.path.join(scratch, name)

        plain, hidden = SCENE.replace('VISIBLE', ''), SCENE.replace('VISIBLE', ' "bool visible" false')
        with open(os.path.join(scratch, 'map.pfm'), 'wb') as f:
            f.write(b'PF\n2 1\n-1\n' + b'\0\0\0\x41' * 6)  # 8
        whole, front = read_pfm(render('whole.pfm', plain))[1], read_pfm(render('front.pfm', hidden))[1]
        codes = expected(front, whole, False)
        png = read_png(render('a.png', plain, '--transparent'))
        shares = [s for s in codes[3::4] if 0 < s < 255]
        claim('some pixels are covered in part', len(shares) > 40, f'{len(shares)} are')
        claim('colours are divided by alpha, and alpha is linear', apart(png, codes) <= 1, f'{apart(png, codes)} apart')
        claim('the scene may say it itself', png == read_png(render('b.png', hidden)))
        lit = read_png(render('c.png', hidden, '--light', 'map.pfm'))  # other samples of light, the same of the camera
        claim('--light keeps it', png[3::4] == lit[3::4] and len(png) == len(lit))
        claim('an EXR keeps it', png == converted(scratch, render('d.exr', plain, '--transparent')))
        claim('PNG to PNG keeps it', apart(png, converted(scratch, render('e.png', plain, '--transparent'))) <= 1)
        claim('no fringe: nothing is darker than both', all(darkest(png, back) > -1 for back in (0, 90, 255)))
        premultiplied = [c * png[4 * (i // 4) + 3] // 255 if i % 4 < 3 else c for i, c in enumerate(png)]
        claim('twin: a picture that is not divided has one', darkest(premultiplied, 255) < -20)
        opaque = read_png(render('f.png', plain))
        claim('a background that is seen is opaque', apart(opaque, expected(whole, whole, True)) <= 1)
        for k in '12':
            render(f'{k}.bispart', hidden, '--part', f'{k}/2')
        run(['merge', '1.bispart', '2.bispart', '--quiet', '--exposure', '0', '--outfile', 'g.png'], scratch)
        claim('merge keeps it', png == read_png(os.path.join(scratch, 'g.png')))
    print(f'{len(passed)} passed, {len(failed)} failed')
    return len(failed) > 0


def converted(scratch, path):
    """Returns the samples of a PNG that `bis convert` makes of a picture."""
    status, said = run(['convert', path, 'converted.png', '--exposure', '0'], scratch)
    if status:
        raise RuntimeError(said)
    return read_png(os.path.join(scratch, 'converted.png'))


if __name__ == '__main__':
    sys.exit(main())
