# SPDX-License-Identifier: BSD-2-Clause
"""No function of bis/flat/*.h ends the process where it is given a NULL: in turn each pointer of each function that the
headers declare. A function with a status says which one it was. Needs no numpy."""
import ctypes
import os
import re
import subprocess
import sys
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
MAP = os.path.join(ROOT, "data/maps/interior.hdr")
SCENE = b"""text=Film "rgb" "integer xresolution" 4 "integer yresolution" 3 LookAt 0 -4 0  0 0 0  0 0 1
Camera "perspective" WorldBegin LightSource "infinite" "string filename" "%s" Shape "sphere" """ % MAP.encode()
INPUT = 3
LIGHT_MAY_BE_NULL = {"bis_flat_render_with", "bis_flat_scene_open", "bis_flat_scene_render", "bis_flat_stage_of"}
MAY_BE_NULL = {"mapping", "stop", "watcher", "user", "say", "values", "coverage", "attributes"}


def functions():
    """Name, returned type and arguments, as (type, name), of each function of the headers."""
    found = []
    for header in ("flat", "image", "map", "scene", "stage", "taught"):
        with open(os.path.join(ROOT, "include/bis/flat", header + ".h")) as f:
            text = re.sub(r"/\*.*?\*/", "", f.read(), flags=re.DOTALL)
        for returned, name, arguments in re.findall(r"^([a-z][\w *]*?)(bis_flat_\w+)\(([^)]*)\);", text, re.MULTILINE):
            if returned.startswith("typedef") or arguments == "void":
                continue
            pairs = [re.match(r"(.*?)(\w+)(?:\[\d\])?$", " ".join(a.split())).groups() for a in arguments.split(",")]
            found.append((name, returned.strip(), [(kind.strip(), what) for kind, what in pairs]))
    return found


def is_pointer(kind, what):
    return "*" in kind or what in ("shape", "hash", "place") or kind == "const volatile sig_atomic_t"


class Opened:
    """One of each that can be opened, for functions that take it."""

    def __init__(self, library):
        self.say = ctypes.create_string_buffer(1000)
        self.kept = []
        up = (ctypes.c_double * 3)(0, 0, 1)
        pixels = (ctypes.c_float * 6)(1, 1, 1, 1, 1, 1)
        self.of = {"light": self.open(library.bis_flat_light_make, 2, 1, pixels, b"cdf", ctypes.c_double(0), None),
                   "bsdf": self.open(library.bis_flat_bsdf_open, b"phong", up, up, ctypes.c_double(9), up, up),
                   "picture": self.open(library.bis_flat_render, b"scene", self.texts(SCENE, b"spp=1"), None),
                   "stage": self.open(library.bis_flat_stage_open, b"scene", self.texts(SCENE)),
                   "scene": self.open(library.bis_flat_scene_open, b"scene", self.texts(SCENE), None),
                   "image": self.open(library.bis_flat_image_read, MAP.encode())}
        library.bis_flat_stage_at(self.of["stage"], 1, 1, up, self.say, 1000)

    def texts(self, *texts):
        self.kept.append((ctypes.c_char_p * (len(texts) + 1))(*texts))
        return self.kept[-1]

    def open(self, f, *arguments):
        handle = ctypes.c_void_p()
        if f(ctypes.byref(handle), *arguments, self.say, ctypes.c_size_t(1000)):
            raise RuntimeError(self.say.value)
        return handle

    def argument(self, kind, what):
        """What the function may take for one argument: arrays have room for whatever it stores there."""
        if kind == "const char *const *":
            return self.texts()
        if kind.endswith("**"):
            return ctypes.byref(ctypes.c_void_p())
        if what in self.of and "*" in kind and kind != "const char *":
            return self.of[what]
        if what == "watcher" or what == "user" or "volatile" in kind:
            return None
        if what == "say":
            return self.say
        if what == "size":
            return ctypes.c_size_t(1000)
        if is_pointer(kind, what):
            self.kept.append(ctypes.create_string_buffer(1 << 16))
            return self.kept[-1]
        return {"double": ctypes.c_double, "size_t": ctypes.c_size_t}.get(kind, ctypes.c_uint32)(1)


def call_all():
    """Print each call before it is made, because the last one printed is the one that ended the process."""
    library = ctypes.CDLL(os.environ["BIS_LIBRARY"])
    opened = Opened(library)
    for name, returned, arguments in functions():
        for k, (kind, what) in enumerate(arguments):
            if not is_pointer(kind, what):
                continue
            print(name, what, flush=True)
            values = [opened.argument(*a) for a in arguments]
            values[k] = None
            opened.say.value = b""
            status = getattr(library, name)(*values)
            may = what in MAY_BE_NULL or (what == "light" and name in LIGHT_MAY_BE_NULL)
            if returned == "int" and arguments[-1][1] == "size" and not may:
                said = opened.say.value.decode()
                if status != INPUT or not re.match(r"error: (%s|handle|value|w) is NULL: " % what, said):
                    print("it returned %d and said: %s" % (status, said))
                    return 1
            opened.kept.clear()
    return 0


class Null(unittest.TestCase):
    def test_no_function_of_the_headers_ends_the_process(self):
        known = functions()
        self.assertGreater(len(known), 55)
        r = subprocess.run([sys.executable, os.path.abspath(__file__), "call"], capture_output=True, text=True)
        calls = r.stdout.splitlines()
        self.assertEqual(r.returncode, 0, "%s: %s" % (calls[-1:], r.stderr))
        self.assertEqual(len(calls), sum(is_pointer(*a) for _, _, arguments in known for a in arguments))


if __name__ == "__main__":
    sys.exit(call_all()) if sys.argv[1:] == ["call"] else unittest.main()
