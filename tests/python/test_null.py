# SPDX-License-Identifier: BSD-2-Clause
"""No function of bis/flat/*.h ends the process where it is given a NULL: in turn each pointer of each function, as
bis_flat_signatures tells them. One with a status says which argument it was, and has opened nothing; an array of no
items may be NULL, and so may what the signature says. Needs no numpy."""
import ctypes
import os
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
MAP = os.path.join(ROOT, "data/maps/interior.hdr")
SCENE = b"""text=Film "rgb" "integer xresolution" 5 "integer yresolution" 3 LookAt 0 -4 0  0 0 0  0 0 1
Camera "perspective" WorldBegin LightSource "infinite" "string filename" "%s" Shape "sphere" """ % MAP.encode()
INPUT = 3
NUMBERS = {"i": ctypes.c_int, "n": ctypes.c_size_t, "k": ctypes.c_uint32, "q": ctypes.c_uint64, "r": ctypes.c_double}
RETURNED = {"s": ctypes.c_int, "i": ctypes.c_int, "v": None, "r": ctypes.c_double, "z": ctypes.c_char_p,
            "n": ctypes.c_size_t}
TEXTS = {"kind": b"cdf", "model": b"phong", "proposal": b"em"}
UNDUE = 12345  # where nothing was opened


class Library:
    """The library, its signatures, and one of each that can be opened."""

    def __init__(self):
        self.c, self.kept = ctypes.CDLL(os.environ["BIS_LIBRARY"]), []
        self.c.bis_flat_signatures.restype = ctypes.c_char_p
        rows = [row.split() for row in self.c.bis_flat_signatures().decode().splitlines()]
        self.rows = [(name, returned.lstrip("~"), [re.match(r"(\w+):(.)(?:\[(\w+)\])?(\??)$", a).groups()
                                                   for a in arguments]) for name, returned, *arguments in rows]
        self.say = ctypes.create_string_buffer(1000)
        up, pixels = (ctypes.c_double * 3)(0, 0, 1), (ctypes.c_float * 6)(1, 1, 1, 1, 1, 1)
        self.of = {"light": self.open("light_make", 2, 1, pixels, b"cdf", ctypes.c_double(0), None),
                   "bsdf": self.open("bsdf_open", b"phong", up, up, ctypes.c_double(9), up, up),
                   "picture": self.open("render", b"scene", self.texts(SCENE, b"spp=1"), None),
                   "stage": self.open("stage_open", b"scene", self.texts(SCENE)),
                   "scene": self.open("scene_open", b"scene", self.texts(SCENE), None),
                   "image": self.open("image_read", MAP.encode())}
        found = (ctypes.c_double * 8)()
        self.c.bis_flat_stage_at(self.of["stage"], 2, 1, found, self.say, ctypes.c_size_t(1000))
        if not found[0]:
            raise RuntimeError("the pixel sees no surface")

    def texts(self, *texts):
        self.kept.append((ctypes.c_char_p * (len(texts) + 1))(*texts))
        return self.kept[-1]

    def open(self, name, *arguments):
        handle = ctypes.c_void_p()
        if self.c["bis_flat_" + name](ctypes.byref(handle), *arguments, self.say, ctypes.c_size_t(1000)):
            raise RuntimeError(self.say.value)
        return handle

    def value(self, what, kind):
        """What the function may take for one argument: arrays have room for whatever it stores there."""
        if kind in NUMBERS:
            return NUMBERS[kind](1)
        if kind in "zl":
            return self.texts() if kind == "l" else TEXTS.get(what, b"scene")
        if kind == "h":
            return self.of[what]
        if kind == "p":
            return None
        self.kept.append(ctypes.c_void_p(UNDUE) if kind in "OT" else ctypes.create_string_buffer(1 << 16))
        return ctypes.byref(self.kept[-1]) if kind in "OT" else self.kept[-1]

    def call(self, name, returned, values):
        """What it returned, and what it said if that is a status."""
        f = self.c[name]
        f.restype = RETURNED[returned]
        self.say.value = b""
        result = f(*values, *((self.say, ctypes.c_size_t(1000)) if returned == "s" else ()))
        return result, self.say.value.decode()

    def hide(self, name, returned, arguments, k):
        """Call it with argument k as NULL. What is wrong with what it does, or None."""
        what, kind, count, may = arguments[k]
        self.kept.clear()
        values = [self.value(*a[:2]) for a in arguments]
        values[k] = None
        result, said = self.call(name, returned, values)
        if returned != "s" or may or kind == "p":
            return None
        wrong = result != INPUT or said != "error: %s is NULL: give what was opened, or an array" % what
        opened = [h.value for h in self.kept if isinstance(h, ctypes.c_void_p) and h.value and kind not in "OT"]
        if not wrong and count:
            values[[a[0] for a in arguments].index(count)] = ctypes.c_size_t(0)
            said = self.call(name, returned, values)[1]
            wrong = " is NULL" in said
        return "it returned %d, opened %s and said: %s" % (result, opened, said) if wrong or opened else None


def call_all():
    """Print each call before it is made, because the last one printed is the one that ended the process."""
    library = Library()
    for name, returned, arguments in library.rows:
        for k, (what, kind, _, _) in enumerate(arguments):
            if kind in NUMBERS:
                continue
            print(name, what, flush=True)
            wrong = library.hide(name, returned, arguments, k)
            if wrong:
                print(wrong)
                return 1
    return 0


class Null(unittest.TestCase):
    def test_no_function_of_the_headers_ends_the_process(self):
        r = subprocess.run([sys.executable, os.path.abspath(__file__), "call"], capture_output=True, text=True)
        calls = r.stdout.splitlines()
        self.assertEqual(r.returncode, 0, "%s: %s" % (calls[-2:], r.stderr))
        declared = set()
        for header in os.listdir(os.path.join(ROOT, "include/bis/flat")):
            with open(os.path.join(ROOT, "include/bis/flat", header)) as f:
                text = re.sub(r"/\*.*?\*/", "", f.read(), flags=re.DOTALL)
            declared |= set(re.findall(r"^[a-z][^;]*?\b(bis_flat_\w+)\([^;]*[*\[]", text, re.MULTILINE))
        self.assertEqual(declared - {"bis_flat_watcher"}, {line.split()[0] for line in calls})
        self.assertGreater(len(calls), 250)

    def test_a_comment_that_does_not_say_what_an_array_holds_stops_make(self):
        prototype = "int bis_flat_a(size_t n, const double *u, char *say, size_t size);\n"
        wrong = "a: its comment does not say what u holds"
        for shape, said in (("u[n][4]", ""), ("u[3]", ""), ("*u", ""), ("u", wrong)):
            with tempfile.NamedTemporaryFile("w", suffix=".h") as header:
                header.write("/* bis_flat_a reads %s. */\n%s" % (shape, prototype))
                header.flush()
                face = os.path.join(ROOT, "src/flat/face.awk")
                r = subprocess.run(["awk", "-f", face, "-v", "to=c", header.name], capture_output=True, text=True)
            self.assertEqual(r.returncode, 1 if said else 0)
            self.assertIn(said, r.stderr)
            self.assertEqual('{"u", u, n}' in r.stdout, shape == "u[n][4]")


if __name__ == "__main__":
    sys.exit(call_all()) if sys.argv[1:] == ["call"] else unittest.main()
