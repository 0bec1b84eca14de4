#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""Print the table of tests/files/test_image_conformance.c: the checksum of every file's pixels as readers other than
ours see them.

    python3 tests/support/image_checksums.py ../shared/data/conformance/exr/*.exr ../shared/data/conformance/hdr/*.hdr

wants numpy, OpenEXR (3.5.3 was used) and opencv-python-headless (5.0.0). `make test` does not run this. The checksum is
the sum of (2 i + 1) * bits of float i, modulo 2^64, over R, G, B of all pixels from the top; every NaN counts as
0x7fc00000. Old run-length encoding, which OpenCV does not read, is decoded here. Luminance with chroma has no
independent reader: such files get the mean of Y instead, which is the mean luminance of R, G, B.
"""
import os
import sys

import cv2
import numpy as np
import OpenEXR


def old_rle(path):
    """Radiance's first encoding, in the plain -Y +X orientation."""
    data = open(path, "rb").read()
    header, rest = data.split(b"\n\n", 1)
    size, rest = rest.split(b"\n", 1)
    height, width = int(size.split()[1]), int(size.split()[3])
    pixels, shift = [], 0
    for i in range(0, len(rest) - 3, 4):
        p = rest[i:i + 4]
        if p[:3] == b"\1\1\1":
            pixels += [pixels[-1]] * (p[3] << shift)
            shift += 8
        else:
            pixels.append(p)
            shift = 0
    a = np.frombuffer(b"".join(pixels[:width * height]), np.uint8).reshape(height, width, 4).astype(np.float64)
    return np.where(a[..., 3:] == 0, 0, a[..., :3] * np.exp2(a[..., 3:] - 136)).astype(np.float32)


def read_hdr(path):
    image = cv2.imread(path, cv2.IMREAD_UNCHANGED)
    return old_rle(path) if image is None else image[:, :, ::-1]


def inside(pixels, header):
    """Returns what of the data window lies in the display window."""
    (data, _), (shown, last) = header["dataWindow"], header["displayWindow"]
    x0, y0 = np.maximum(shown - data, 0)
    x1, y1 = last - data + 1
    return pixels[y0:max(y0, y1), x0:max(x0, x1)]


def read_exr(path):
    """R, G, B of the first part that has them, or (None, mean of Y) for luminance with chroma."""
    for part in OpenEXR.File(path, separate_channels=True).parts:
        c = part.channels
        if all(k in c for k in "RGB"):
            return inside(np.stack([c[k].pixels.astype(np.float32) for k in "RGB"], -1), part.header), None
        if "RY" in c:
            return None, c["Y"].pixels.astype(np.float64).mean()
        if "Y" in c:
            return np.repeat(c["Y"].pixels.astype(np.float32)[..., None], 3, 2), None
    raise ValueError("no colour")


def checksum(image):
    bits = np.ascontiguousarray(image, "<f4").view("<u4").ravel().astype(np.uint64)
    bits[np.isnan(image).ravel()] = 0x7fc00000
    return int((bits * (2 * np.arange(bits.size, dtype=np.uint64) + 1)).sum(dtype=np.uint64))


for path in sys.argv[1:]:
    name = os.path.join(os.path.basename(os.path.dirname(path)), os.path.basename(path))
    try:
        image, mean = (read_hdr(path), None) if path.endswith(".hdr") else read_exr(path)
        if image is None:
            print(f'    {{.name = "{name}", .luminance = {mean:.9g}}},')
        else:
            h, w = image.shape[:2]
            print(f'    {{"{name}", {w}, {h}, {checksum(image):#x}, 0}},')
    except Exception as e:
        print(f'    {{.name = "{name}"}}, /* {str(e)[:70]} */')
