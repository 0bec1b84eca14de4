#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""make: the files of this folder that no editor writes, and the values of `expect` that are sums.

The colour matching functions are the fits of Wyman, Sloan and Shirley 2013 (Journal of Computer Graphics Techniques 2,
2), good to 1 %, and no table of bis; the matrix is that of IEC 61966-2-1.
"""
import array
import gzip
import math
import os
import struct
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))


def lobe(nm, mean, left, right):
    """Returns a Gaussian of two widths."""
    return math.exp(-0.5 * ((nm - mean) / (left if nm < mean else right)) ** 2)


def observer(nm):
    """Returns x, y and z of the CIE 1931 observer at a wavelength in nm."""
    return (1.056 * lobe(nm, 599.8, 37.9, 31.0) + .362 * lobe(nm, 442, 16, 26.7) - .065 * lobe(nm, 501.1, 20.4, 26.2),
            .821 * lobe(nm, 568.8, 46.9, 40.5) + .286 * lobe(nm, 530.9, 16.3, 31.1),
            1.217 * lobe(nm, 437, 11.8, 36) + .681 * lobe(nm, 459, 26, 13.8))


def emitted(spectrum):
    """Returns RGB of light; of 1 at all wavelengths the luminance is 1. Negative parts are 0."""
    xyz = [sum(spectrum(nm) * observer(nm)[k] for nm in range(360, 831)) for k in range(3)]
    x, y, z = (v / sum(observer(nm)[1] for nm in range(360, 831)) for v in xyz)
    return [max(0, 3.2404542 * x - 1.5371385 * y - .4985314 * z), max(0, -.969266 * x + 1.8760108 * y + .041556 * z),
            max(0, .0556434 * x - .2040259 * y + 1.0572252 * z)]


def planck(nm, kelvin):
    """Returns the radiance of a black body by SI, but for a factor."""
    return nm ** -5 / math.expm1(6.62607015e-34 * 299792458 / (nm * 1e-9 * 1.380649e-23 * kelvin))


def peak_body(kelvin, factor):
    """Returns pbrt-v3's "blackbody" [kelvin factor]: BlackbodyNormalized in src/core/spectrum.cpp."""
    peak = planck(2897771.955 / kelvin, kelvin)
    return emitted(lambda nm: factor * planck(nm, kelvin) / peak)


def between(nm, pairs):
    """Returns a spectrum that is linear between its pairs and 0 outside, as in pbrt-v4."""
    for (a, u), (b, v) in zip(pairs, pairs[1:]):
        if a <= nm <= b:
            return u + (v - u) * (nm - a) / (b - a)
    return 0


def decoded(v):
    """Returns what a byte of sRGB stands for."""
    v /= 255
    return v / 12.92 if v <= .04045 else ((v + .055) / 1.055) ** 2.4


def write(name, data):
    """Writes a file of this folder."""
    with open(os.path.join(HERE, name), 'wb') as f:
        f.write(data)


def write_png(name, colour, rgb):
    """Writes a PNG of 2 x 2 equal pixels by its specification; colour 2: RGB, 6: RGBA."""
    def chunk(kind, body):
        return struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body))
    rows = 2 * (b'\0' + 2 * bytes(rgb))
    write(name, b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', 2, 2, 8, colour, 0, 0, 0)) +
          chunk(b'IDAT', zlib.compress(rows)) + chunk(b'IEND', b''))


HEAD = ('LookAt 0 0 0  1 0 0  0 0 1', 'Camera "perspective" "float fov" 60', 'Film "rgb" "integer xresolution" 8 '
        '"integer yresolution" 8', 'Sampler "independent" "integer pixelsamples" 1', 'WorldBegin', '# the sky',
        'LightSource "infinite" "rgb L" [1 1 1]', '# a ball around # of colour', 'Material "diffuse" "rgb reflectance" '
        '[0 1 0]', 'Translate 3 0 0', 'Shape "sphere" "float radius" 2.5')


def main():
    """Writes the files and prints the sums."""
    write('ends-cr.txt', '\r'.join(HEAD).encode())
    write('ends-mixed.txt', ''.join(line + end for line, end in zip(HEAD, 4 * ('\n', '\r\n', '\r'))).encode())
    write('cr-string.txt', b'WorldBegin\rLightSource "infinite\rShape "sphere"\r')
    latin = '\n'.join(HEAD[:7]) + ('\nTexture "weiß" "spectrum" "constant" "rgb value" [0 0 1]\nMaterial "diffuse" '
                                   '"texture reflectance" "weiß"\nTranslate 3 0 0\nShape "sphere" "float radius" 2.5\n')
    write('latin-texture.txt', latin.encode('latin-1'))
    write('blanks.inc.gz', gzip.compress(4000000 * b' ', mtime=0))
    write_png('ochre.png', 2, (200, 100, 50))
    write_png('ochre-half.png', 6, (200, 100, 50, 128))
    write_png('ochre-opaque.png', 6, (200, 100, 50, 255))
    write('ochre.pfm', b'PF\n1 1\n-1.0\n' + array.array('f', (.8, .4, .1)).tobytes())
    rows = 4 * (9., 9., 9.) + 4 * (2., 1., .5)  # from below
    write('above.pfm', b'PF\n4 2\n-1.0\n' + array.array('f', rows).tobytes())
    # lights.cpp of pbrt-v4: the upper half of N pixels, luminance times cosine times 2 pi / N: pi / 2 of luminance 1
    print('illuminance 10', [10 / (math.pi / 2 * (.2126 * 2 + .7152 + .0722 / 2)) * v for v in (2, 1, .5)])
    print('blackbody [5000 2]', peak_body(5000, 2))
    pairs = ((450, 1), (550, 3), (650, 2))
    colour = emitted(lambda nm: between(nm, pairs))
    y = .2126 * colour[0] + .7152 * colour[1] + .0722 * colour[2]
    print('spectrum in v4', [c / y for c in colour])
    print('spectrum of 3 in v3', emitted(lambda nm: 3))
    weights = .212671, .715160, .072169
    y = sum(w * v for w, v in zip(weights, (200, 100, 50)))
    print('ochre.png in v3', decoded(y), 'linear in v3', y / 255, 'in v4', sum(map(decoded, (200, 100, 50))) / 3)
    print('ochre.pfm in v3', sum(w * v for w, v in zip(weights, (.8, .4, .1))), 'in v4', 1.3 / 3)


if __name__ == '__main__':
    main()
