# SPDX-License-Identifier: BSD-2-Clause
"""bis tev beside a viewer that this test is: what it is sent, read by tev's protocol, is the picture in the file."""
import os
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import unittest

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
sys.path.insert(0, os.path.join(ROOT, "scripts/python"))
import bis  # noqa: E402

PROGRAM = os.environ.get("BIS_PROGRAM", "build/release/bis")
SCENE = """
LookAt 0 -4 1  0 0 0  0 0 1
Camera "perspective" "float fov" 40
WorldBegin
LightSource "infinite" "rgb L" [1 2 3]
Material "matte"
Shape "sphere"
"""


def words(data, n):
    """n texts that end with a zero byte, and the rest."""
    parts = data.split(b"\0", n)
    return parts[:n], parts[n]


class Viewer(threading.Thread):
    """Listens, and keeps the images that were created and filled."""

    def __init__(self):
        super().__init__(daemon=True)
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.images = {}
        self.start()

    def run(self):
        connection, _ = self.listener.accept()
        data = b""
        while True:
            more = connection.recv(1 << 16)
            if not more:
                return
            data += more
            while len(data) >= 4 and len(data) >= struct.unpack("<I", data[:4])[0]:
                n = struct.unpack("<I", data[:4])[0]
                self.take(data[4], data[6:n])
                data = data[n:]

    def take(self, kind, body):
        if kind == 4:
            (name,), rest = words(body, 1)
            width, height, channels = struct.unpack("<III", rest[:12])
            names, _ = words(rest[12:], channels)
            self.images[name] = np.full((height, width, len(names)), np.nan, np.float32)
            return
        (name, channel), rest = words(body, 2)
        x, y, width, height = struct.unpack("<IIII", rest[:16])
        pixels = np.frombuffer(rest[16:], "<f4").reshape(height, width)
        self.images[name][y:y + height, x:x + width, b"RGB".index(channel)] = pixels


class Tev(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.scene = os.path.join(self.folder.name, "scene.txt")
        self.picture = os.path.join(self.folder.name, "picture.pfm")
        with open(self.scene, "w", encoding="ascii") as f:
            f.write(SCENE)

    def tearDown(self):
        self.folder.cleanup()

    def run_tev(self, *arguments):
        return subprocess.run([PROGRAM, "tev", *arguments], capture_output=True, text=True)

    def test_the_viewer_gets_the_picture_of_the_file(self):
        viewer = Viewer()
        place = "127.0.0.1:%d" % viewer.listener.getsockname()[1]
        done = self.run_tev("--to", place, "--quiet", "--spp", "2", "--resolution", "24x16",
                            "--outfile", self.picture, self.scene)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        viewer.join(10)
        (image,) = viewer.images.values()
        pixels, _ = bis.read_image(self.picture)
        self.assertEqual(image.shape, (16, 24, 3))
        np.testing.assert_array_equal(image, pixels)

    def test_a_missing_viewer_stops_nothing(self):
        done = self.run_tev("--to", "127.0.0.1:1", "--quiet", "--spp", "1", "--resolution", "8x8",
                            "--outfile", self.picture, self.scene)
        self.assertEqual(done.returncode, 0)
        self.assertIn('nothing more was shown by tev at "127.0.0.1:1": Connection refused', done.stderr)
        self.assertTrue(os.path.exists(self.picture))

    def test_a_place_without_host_or_port_is_refused(self):
        for place in ("viewer", "viewer:x", ":14158", "viewer:0", "viewer:65536"):
            done = self.run_tev("--to", place, "--quiet", "--spp", "1", "--outfile", self.picture, self.scene)
            self.assertEqual((done.returncode, os.path.exists(self.picture)), (2, False))
            self.assertIn('--to is "%s", must be HOST:PORT' % place, done.stderr)

    def test_a_picture_that_cannot_be_shown_is_refused_before_the_render(self):
        for name in ("picture.png", "picture.tif", "picture"):
            path = os.path.join(self.folder.name, name)
            done = self.run_tev("--to", "127.0.0.1:1", "--quiet", "--spp", "1", "--outfile", path, self.scene)
            self.assertEqual((done.returncode, os.path.exists(path)), (2, False))
            self.assertIn('output file "%s": the ending must be .exr, .pfm or .hdr' % path, done.stderr)

    def test_the_exit_state_is_that_of_the_render(self):
        done = self.run_tev("--to", "127.0.0.1:1", self.scene + ".none")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(self.run_tev().returncode, 2)
