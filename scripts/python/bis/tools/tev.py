# SPDX-License-Identifier: BSD-2-Clause
"""bis tev: a render that tev shows while it goes on.

The render is `bis` itself, which writes its picture every second (`--write-every`). Each time the
file has changed it is sent to tev, by two messages of tev's protocol (its README and
include/tev/Ipc.h): 4 creates an image, 3 fills a channel of it. A viewer that is missing or goes
stops nothing.
"""
from __future__ import annotations

import os
import socket
import struct
import subprocess
import time
from types import SimpleNamespace
from typing import TYPE_CHECKING, Optional, Sequence

from .._errors import Error
from . import command

if TYPE_CHECKING:  # help works without numpy
    import numpy as np

TEV = "localhost:14158"
_SHOWN = (".exr", ".pfm", ".hdr")  # the pictures that `bis` writes and reads

COMMAND = command.Command(
    name="tev",
    usage="tev [--to HOST:PORT] [options of render] SCENE",
    summary="render a scene, and show its passes in the viewer tev while it is rendered",
    options=(
        command.Option("to", "HOST:PORT", "where tev listens (%s)" % TEV, default=TEV),
    ),
    min_operands=1, max_operands=1,
    notes="All other options are those of `bis render`. The first --outfile is shown, which\n"
          "must be an .exr, .pfm or .hdr; without one it is bis.exr.\n")


def _text(words: str) -> bytes:
    return words.encode("utf-8", "surrogateescape") + b"\0"


def _message(kind: int, body: bytes) -> bytes:
    """A message: its length with itself, its kind, "the focus stays where it is", and the rest."""
    return struct.pack("<IBB", len(body) + 6, kind, 0) + body


def messages(name: str, picture: np.ndarray) -> list[bytes]:
    """Return the messages of tev's protocol that show a picture (h, w, 3). An image of the same
    name is replaced."""
    import numpy as np
    height, width = picture.shape[:2]
    channels = b"".join(_text(c) for c in "RGB")
    out = [_message(4, _text(name) + struct.pack("<III", width, height, 3) + channels)]
    for k, channel in enumerate("RGB"):
        place = struct.pack("<IIII", 0, 0, width, height)
        pixels = np.ascontiguousarray(picture[:, :, k], "<f4").tobytes()
        out.append(_message(3, _text(name) + _text(channel) + place + pixels))
    return out


class _Viewer:
    """tev, as long as it answers."""

    def __init__(self, place: str) -> None:
        host, _, port = place.rpartition(":")
        if not (host and port.isdecimal() and 1 <= int(port) <= 65535):
            raise Error('error: --to is "%s", must be HOST:PORT with a port in [1, 65535], '
                        "as in %s" % (place, TEV))
        self.why: Optional[str] = None
        self.socket: Optional[socket.socket] = None
        try:
            self.socket = socket.create_connection((host.strip("[]"), int(port)), 3)
        except OSError as e:
            self.why = e.strerror or str(e)

    def show(self, path: str) -> None:
        """Send the picture at path."""
        from .._image import read_image
        if not self.socket:
            return
        try:
            pixels, _ = read_image(path)
            for message in messages(os.path.basename(path), pixels):
                self.socket.sendall(message)
        except OSError as e:
            self.why = e.strerror or str(e)
            self.socket = None


def _outfile(arguments: Sequence[str]) -> tuple[str, list[str]]:
    """The picture that is shown, and the arguments that make it."""
    for i, a in enumerate(arguments):
        if a.startswith("--outfile="):
            return a.partition("=")[2], list(arguments)
        if a == "--outfile" and i + 1 < len(arguments):
            return arguments[i + 1], list(arguments)
    return "bis.exr", list(arguments) + ["--outfile", "bis.exr"]


def _stamp(path: str) -> Optional[tuple[int, int]]:
    try:
        info = os.stat(path)
    except OSError:
        return None
    return info.st_mtime_ns, info.st_ino


def _take_place(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """What `--to` says, as arguments of this command, and all others."""
    own: list[str] = []
    rest: list[str] = []
    for i, a in enumerate(arguments):
        is_value = i > 0 and arguments[i - 1] == "--to"
        (own if a == "--to" or a.startswith("--to=") or is_value else rest).append(a)
    return own, rest


def main(arguments: Sequence[str]) -> int:
    """Render, and show. The exit state is that of the render."""
    own, rest = _take_place(arguments)
    if not rest or rest[0] in ("-h", "--help", "--help=man", "-V", "--version"):
        return command.run(COMMAND, arguments, lambda o, operands, say: command.USAGE)
    path, of_render = _outfile(rest)
    return command.run(COMMAND, own + ["scene"],
                       lambda o, operands, say: _render(o, path, of_render, say))


def _render(o: SimpleNamespace, path: str, arguments: list[str], say: command.Say) -> int:
    if os.path.splitext(path)[1].lower() not in _SHOWN:
        raise Error('error: output file "%s": the ending must be .exr, .pfm or .hdr, because tev '
                    "is shown the first one" % path)
    before = _stamp(path)
    viewer = _Viewer(o.to)
    program = os.environ.get("BIS_PROGRAM", "bis")
    command.catch_signals()  # the render, in the same terminal, gets them, too
    child = subprocess.Popen([program, "render", "--write-every", "1"] + arguments)
    while child.poll() is None:
        time.sleep(0.2)
        before = _show_new(viewer, path, before, say)
    _show_new(viewer, path, before, say)
    if viewer.why:
        say.warn('nothing more was shown by tev at "%s": %s' % (o.to, viewer.why))
    return child.returncode if child.returncode >= 0 else 128 - child.returncode


def _show_new(viewer: _Viewer, path: str, before: Optional[tuple[int, int]],
              say: command.Say) -> Optional[tuple[int, int]]:
    now = _stamp(path)
    if now is not None and now != before:
        try:
            viewer.show(path)
        except Error as e:
            viewer.why = str(e)
            viewer.socket = None
    return now
