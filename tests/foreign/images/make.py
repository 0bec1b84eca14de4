#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""make: the binary files of this folder, and what bis must make of them.

Needs numpy, OpenEXR 3.5 and Pillow from PyPI; tests need only what it wrote. Files are written by these libraries, or
byte by byte after a format's specification. Expected values (*.ref.pfm) are what was written, what the OpenEXR wheel
reads (of lossy compression), or a formula: the matrix of IEC 61966-2-1, OpenEXR's layouts of maps (ImfEnvmap.h).
"""
import io
import struct
import zlib

import numpy as np
import OpenEXR
from PIL import Image

WIDTH, HEIGHT = 8, 6


def pixels(width=WIDTH, height=HEIGHT, seed=1, kind='float32'):
    """Returns colours of which no two are alike."""
    return np.random.default_rng(seed).uniform(.1, 2, (height, width, 3)).astype(kind)


def window(x, y, width, height):
    """Returns a window as the wheel takes it."""
    return np.array([x, y], 'i'), np.array([x + width - 1, y + height - 1], 'i')


def header(**more):
    """Returns a header: scanlines, ZIP."""
    return {'compression': OpenEXR.ZIP_COMPRESSION, 'type': OpenEXR.scanlineimage, **more}


def split(rgb, names=('R', 'G', 'B'), prefix=''):
    """Returns channels of these names."""
    return {prefix + name: np.ascontiguousarray(rgb[..., k]) for k, name in enumerate(names)}


def write_exr(name, channels, **more):
    """Writes an EXR of one part."""
    OpenEXR.File(header(**more), channels).write(name)


def write_pfm(name, rgb, head=b'PF\n%d %d\n-1.0\n', tail=b''):
    """Writes a PFM of floats, low byte first."""
    size = rgb.shape[1], rgb.shape[0]
    with open(name, 'wb') as f:
        f.write(head % size + rgb[::-1].astype('<f4').tobytes() + tail)


def write(name, data):
    """Writes bytes."""
    with open(name, 'wb') as f:
        f.write(data)


def compressions():
    """B44 stores a chunk as it is where it would not be shorter: of floats, and where a row stands alone."""
    for kind in 'B44', 'B44A':
        name = kind.lower()
        compression = getattr(OpenEXR, kind + '_COMPRESSION')
        write_exr(name + '-float.exr', split(pixels()), compression=compression)
        write_exr(name + '-half.exr', split(pixels(4, 33, kind='float16')), compression=compression)
        with OpenEXR.File(name + '-half.exr', separate_channels=True) as f:
            c = f.channels()
            write_pfm(name + '-half.ref.pfm', np.stack([c[k].pixels for k in 'RGB'], -1).astype('f'))
    tiles = OpenEXR.TileDescription()
    tiles.xSize = tiles.ySize = 3
    tiles.mode, tiles.roundingMode = OpenEXR.ONE_LEVEL, OpenEXR.ROUND_DOWN
    write_exr('b44-tiles.exr', split(pixels()), compression=OpenEXR.B44_COMPRESSION, type=OpenEXR.tiledimage,
              tiles=tiles)
    write_pfm('plain.ref.pfm', pixels())
    for kind in 'HTJ2K256', 'HTJ2K32', 'ZSTD':
        write_exr(kind.lower() + '.exr', split(pixels(kind='float16')),
                  compression=getattr(OpenEXR, kind + '_COMPRESSION'))


RGB_TO_XYZ = np.array([[.4123908, .3575843, .1804808], [.2126390, .7151687, .0721923], [.0193308, .1191948, .9505322]])


def primaries():
    """The values are X, Y, Z: linear sRGB by the matrix of IEC 61966-2-1 with more digits."""
    xyz = (pixels().astype('d') @ RGB_TO_XYZ.T).astype('f')
    write_exr('xyz.exr', split(xyz), chromaticities=(1., 0., 0., 1., 0., 0., 1 / 3, 1 / 3))
    exponent = 2
    rgbe = np.concatenate([np.floor(xyz / 2.**exponent * 256), np.full(xyz.shape[:2] + (1,), 128 + exponent)], -1)
    write('xyz.hdr', b'#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y %d +X %d\n' % (HEIGHT, WIDTH)
          + rgbe.astype('u1').tobytes())
    write_pfm('xyz-hdr.ref.pfm', (rgbe[..., :3] / 64) @ np.linalg.inv(RGB_TO_XYZ).T)


def radiance(d):
    """Returns a radiance that is smooth on the sphere, of directions (n, 3); each axis has its own."""
    x, y, z = np.moveaxis(d, -1, 0)
    return np.stack([2 + x + .5 * y * z, 2 + y - .5 * x * z, 2 + z + .5 * x * y], -1)


def latlong(width, height, on_edges):
    """Returns a lat-long map in OpenEXR's frame: +z in the middle, -x to its right, y up; pixels on edges, or cells."""
    i = np.arange(width) / (width - 1) if on_edges else (np.arange(width) + .5) / width
    j = np.arange(height) / (height - 1) if on_edges else (np.arange(height) + .5) / height
    longitude, latitude = np.meshgrid(np.pi - 2 * np.pi * i, np.pi / 2 - np.pi * j)
    return radiance(np.stack([np.sin(longitude) * np.cos(latitude), np.sin(latitude),
                              np.cos(longitude) * np.cos(latitude)], -1))


def cube(n):
    """Returns OpenEXR's six faces, one below the other: the comments of ImfEnvmap.h (CubeMap)."""
    a = np.linspace(-1, 1, n)
    u, v = np.meshgrid(a, a)
    one = np.ones_like(u)
    faces = [(one, -v, u), (-one, -v, -u), (u, one, -v), (u, -one, v), (-u, -v, one), (u, -v, -one)]
    d = np.concatenate([np.stack(f, -1) for f in faces])
    return radiance(d / np.linalg.norm(d, axis=-1, keepdims=True))


def maps():
    """OpenEXR's own layouts."""
    write_exr('cube.exr', split(cube(25).astype('float16')), envmap=OpenEXR.ENVMAP_CUBE)
    write_exr('latlong.exr', split(latlong(24, 12, True).astype('float16')), envmap=OpenEXR.ENVMAP_LATLONG)
    write_pfm('latlong.ref.pfm', latlong(24, 12, False))
    write_pfm('latlong-fine.pfm', latlong(48, 24, False))
    write_exr('no-cube.exr', split(pixels(4, 9)), envmap=OpenEXR.ENVMAP_CUBE)


def windows():
    """Data windows that are not the display window."""
    rgb = pixels()
    full = pixels(12, 10, 2)
    full[3:3 + HEIGHT, 2:2 + WIDTH] = rgb
    black = np.zeros_like(full)
    black[3:3 + HEIGHT, 2:2 + WIDTH] = rgb
    write_exr('inside-dark.exr', split(.4 * rgb), dataWindow=window(102, 203, WIDTH, HEIGHT),
              displayWindow=window(100, 200, 12, 10))
    write_exr('inside.exr', split(rgb), dataWindow=window(102, 203, WIDTH, HEIGHT),
              displayWindow=window(100, 200, 12, 10))
    write_pfm('inside.ref.pfm', black)
    write_pfm('full.pfm', full)
    write_exr('full.exr', split(full))
    write_exr('beyond.exr', split(rgb), dataWindow=window(-2, -1, WIDTH, HEIGHT), displayWindow=window(0, 0, 4, 5))
    write_pfm('beyond.ref.pfm', rgb[1:6, 2:6])
    write_exr('across.exr', split(rgb), dataWindow=window(-2, 1, WIDTH, HEIGHT), displayWindow=window(0, 0, 8, 7))
    across = np.zeros((7, 8, 3))
    across[1:7, 0:6] = rgb[:, 2:]
    write_pfm('across.ref.pfm', across)
    write_exr('elsewhere.exr', split(rgb), dataWindow=window(8, 0, WIDTH, HEIGHT), displayWindow=window(0, 0, 8, 6))
    write_exr('right.exr', split(rgb), dataWindow=window(4, 0, WIDTH, HEIGHT), displayWindow=window(0, 0, 12, 10))
    write_exr('far.exr', split(pixels(2, 2)), dataWindow=window(0, 0, 2, 2), displayWindow=window(0, 0, 12, 10))
    write_exr('moved.exr', split(pixels(8, 6, 5)), dataWindow=window(8, 0, WIDTH, HEIGHT),
              displayWindow=window(8, 0, WIDTH, HEIGHT))
    write_exr('huge.exr', split(pixels(2, 2)), dataWindow=window(0, 0, 2, 2), displayWindow=window(0, 0, 30000, 30000))


def layers():
    """Names of layers, as programs write them. What must be found is pixels(), the rest is others."""
    rgb, other, more = pixels(), pixels(seed=3), pixels(seed=4)
    vector = split(other, 'XYZ', 'N.')
    write_exr('view-layers.exr', {**split(other, prefix='View A.AO.'), **split(rgb, prefix='View A.Combined.'),
                                  **split(more, prefix='View B.Combined.')})
    write_exr('beauty.exr', {**split(other, prefix='albedo.'), **split(rgb, prefix='beauty.'), **vector})
    write_exr('grey-and-beauty.exr', {'Y': other[..., 0].copy(), **split(rgb, prefix='beauty.')})
    write_exr('rgba.exr', {**split(other, prefix='C_diffuse.'), **split(rgb, prefix='RGBA.')})
    write_exr('c.exr', {**split(other, prefix='Alb.'), **split(rgb, prefix='C.')})
    write_exr('small-letters.exr', {**split(rgb, 'rgb'), **split(other, prefix='albedo.')})
    write_exr('words.exr', {**split(rgb, ('red', 'green', 'blue')), 'depth.Z': other[..., 0].copy()})
    write_exr('unnamed.exr', {**split(rgb, prefix='albedo.'), **vector})
    write_exr('alone.exr', {**split(rgb, prefix='albedo.'), 'Z': other[..., 0].copy()})
    part = lambda name, channels: OpenEXR.Part(header(), channels, name)
    OpenEXR.File([part('albedo', split(other)), part('beauty', split(rgb))]).write('parts.exr')
    OpenEXR.File([part('left', split(rgb)), part('right', split(other))]).write('views.exr')


def pfms():
    """Line ends of Windows, bytes behind the end, four channels."""
    rgb = pixels()
    write_pfm('crlf.pfm', rgb, b'PF\r\n%d %d\r\n-1.0\r\n')
    write_pfm('longer.pfm', rgb, tail=b'\n')
    write_pfm('pf4.pfm', np.concatenate([rgb, np.full(rgb.shape[:2] + (1,), .5)], -1), b'PF4\n%d %d\n-1.0\n')
    first = np.frombuffer(b'\n<=>', '<f4')[0]  # the value's first byte is the LF that could end a line
    tricky = rgb.copy()
    tricky[-1, 0, 0] = first
    write_pfm('cr.pfm', tricky, b'PF\n%d %d\n-1.0\r')
    write_pfm('cr.ref.pfm', tricky)


def encode(image, kind, **more):
    """Returns a picture as bytes, by Pillow."""
    out = io.BytesIO()
    image.save(out, kind, **more)
    return out.getvalue()


def chunk(kind, data):
    """Returns a chunk of a PNG."""
    return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))


def linear(codes):
    """Returns what codes of 8 bits mean, by the curve of sRGB."""
    v = np.asarray(codes) / 255
    return np.where(v <= .04045, v / 12.92, ((v + .055) / 1.055)**2.4)


def screens():
    """Pictures of a screen: cut, printed, of other formats."""
    blocks = np.kron(np.random.default_rng(5).integers(20, 235, (2, 2, 3)), np.ones((16, 16, 1))).astype('u1')
    image = Image.fromarray(blocks)
    jpeg, png = encode(image, 'jpeg', quality=95, subsampling=0), encode(image, 'png')
    write('no-end.jpg', jpeg[:-2])
    write('no-last-bytes.jpg', jpeg[:-6])
    write('half.jpg', jpeg[:-(len(jpeg) - jpeg.rindex(b'\xff\xda')) * 2 // 3])
    write('no-end.png', png[:-12])
    write('half.png', png[:len(png) * 2 // 3])
    at = png.index(b'IDAT') + 20
    write('flipped.png', png[:at] + bytes([png[at] ^ 255]) + png[at + 1:])  # whole, but for its checksum
    write('empty.png', b'')
    inks = image.convert('CMYK')  # Pillow writes Adobe's JPEG, which holds 255 - ink
    write('cmyk.jpg', encode(inks, 'jpeg', quality=100, subsampling=0))
    cmyk = encode(Image.eval(inks, lambda v: 255 - v), 'jpeg', quality=100, subsampling=0)
    at = cmyk.index(b'\xff\xee')  # without Adobe's mark the same numbers are inks
    write('cmyk-plain.jpg', cmyk[:at] + cmyk[at + 2 + struct.unpack('>H', cmyk[at + 2:at + 4])[0]:])
    write_pfm('cmyk.ref.pfm', linear(blocks))
    for kind in 'gif', 'webp', 'tiff', 'avif':
        write('other.' + kind, encode(image, kind))
    write('other.jp2', encode(image, 'jpeg2000'))
    write('lfs.png', b'version https://git-lfs.github.com/spec/v1\noid sha256:' + b'1' * 64 + b'\nsize 65537\n')
    grey = np.arange(40, 40 + WIDTH * HEIGHT, dtype='u1').reshape(HEIGHT, WIDTH)
    tga = struct.pack('<BBBHHBHHHHBB', 0, 0, 3, 0, 0, 0, 0, 0, WIDTH, HEIGHT, 16, 0x28)
    write('grey-alpha.tga', tga + np.stack([grey, 255 - grey], -1).tobytes())
    write_pfm('grey-alpha.ref.pfm', np.repeat(linear(grey)[..., None], 3, -1))


SCENE = '''LookAt 0 0 5  0 0 0  0 1 0
Camera "orthographic" "float screenwindow" [-5 5 -5 5]
Film "rgb" "integer xresolution" 20 "integer yresolution" 20
Sampler "independent" "integer pixelsamples" 1
Integrator "unoccluded" "integer candidates" 16
WorldBegin
LightSource "infinite" "rgb L" [1 1 1] "bool visible" false
Texture "t" "spectrum" "imagemap" "string filename" "{}"
Material "diffuse" "texture reflectance" "t"
Shape "trianglemesh" "point3 P" [-2 -2 0  2 -2 0  2 2 0  -2 2 0] "point2 uv" [0 0  1 0  1 1  0 1]
  "integer indices" [0 1 2  0 2 3]
'''

MAP = '''LookAt 0 0 0  {} 0 0 1
Camera "perspective" "float fov" 60
Film "rgb" "integer xresolution" 12 "integer yresolution" 12
Sampler "independent" "integer pixelsamples" 1
Integrator "unoccluded" "integer candidates" 1
WorldBegin
LightSource "infinite" "string mapname" "{}"{}
'''


def scenes():
    """A square with a texture, and nothing but a map."""
    for name in ('lfs.png', 'flipped.png', 'half.png', 'half.jpg', 'no-end.jpg', 'no-end.png', 'cmyk.jpg', 'other.gif',
                 'other.webp', 'other.tiff', 'other.avif', 'other.jp2', 'grey-alpha.tga', 'empty.png',
                 'inside-dark.exr'):
        with open(name.replace('.', '-') + '.txt', 'w', encoding='utf-8') as f:
            f.write(SCENE.format(name))
    write('lfs.mtl', b'newmtl a\nKd .4 .4 .4\nmap_Kd lfs.png\n')
    write('lfs.obj', b'mtllib lfs.mtl\nusemtl a\nv -2 -2 0\nv 2 -2 0\nv 2 2 0\nv -2 2 0\nf 1 2 3 4\n')
    with open('lfs-mtl.txt', 'w', encoding='utf-8') as f:
        f.write(SCENE[:SCENE.index('Texture')] + 'Shape "objmesh" "string filename" "lfs.obj" "bool materials" true\n')
    with open('lfs-normals.txt', 'w', encoding='utf-8') as f:
        f.write(SCENE.format('no-end.png').replace('"t"\n', '"t" "string normalmap" "lfs.png"\n'))
    with open('map-cube.txt', 'w', encoding='utf-8') as f:
        f.write(MAP.format('-1 .2 .3', 'cube.exr', ''))
    with open('map-cube-as.txt', 'w', encoding='utf-8') as f:
        f.write(MAP.format('-1 .2 .3', 'latlong-fine.pfm', ''))
    with open('map-inside.txt', 'w', encoding='utf-8') as f:
        f.write(MAP.format('-1 0 0', 'inside.exr', ''))


if __name__ == '__main__':
    compressions()
    primaries()
    maps()
    windows()
    layers()
    pfms()
    screens()
    scenes()
