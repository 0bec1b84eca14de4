# SPDX-License-Identifier: BSD-2-Clause
"""native: what a figure of docs/live asked of the library in a browser, asked again of libbis.so.

    lib = native.Library("build/release/library/libbis.so.0.1.0", folder)   # files of calls are looked for in folder
    out, digest = lib.run(calls)                                            # as engine.run of docs/live/engine.js

The letters of a call's arguments are those of bis_flat_signatures (include/bis/flat/flat.h)."""
import ctypes as C
import os

ITEM = {"d": C.c_double, "f": C.c_float, "u": C.c_uint32, "b": C.c_uint8, "i": C.c_int}
SAY = 4096


class Library:
    """Library calls libbis.so by lists of calls."""

    def __init__(self, path, folder):
        self.lib, self.folder, self.table, self.opened = C.CDLL(path), folder, {}, {}
        self.lib.bis_flat_signatures.restype = C.c_char_p
        for line in self.lib.bis_flat_signatures().decode().splitlines():
            name, returns, *taken = line.split(" ")
            self.table[name] = returns, [one.split(":")[1][0] for one in taken]
        self.of_libm = [name for name in self.table if self.table[name][0][0] == "~"]

    def argument(self, letter, given, done, outs):
        if letter == "i":
            return C.c_int(int(given))
        if letter in "nkq":
            return C.c_size_t(int(given))
        if letter == "r":
            return C.c_double(given)
        if letter == "p":
            return None
        if letter == "z":
            return C.c_char_p(given.encode())
        if letter == "l":
            return (C.c_char_p * (len(given) + 1))(*[s.encode() for s in given], None)
        if letter == "h":
            return self.opened[given]
        if letter == "O":
            self.opened[given] = C.c_void_p()
            return C.byref(self.opened[given])
        kind = ITEM[letter.lower()]
        if letter.isupper():
            outs.append((kind * int(given))())
            return outs[-1]
        if isinstance(given, str):
            k, j = given[1:].split(".")
            return done[int(k)][int(j)]
        if isinstance(given, dict):     # a typed array, as JSON.stringify writes it
            given = list(given.values())
        return (kind * len(given))(*[int(v) for v in given] if letter in "ubi" else given)

    def run(self, list_of_calls):
        """run makes the calls and returns what they wrote, and the hash of it."""
        digest, done, here = (C.c_uint32 * 2)(0, 0), [], os.getcwd()
        os.chdir(self.folder)
        try:
            for name, *given in list_of_calls:
                returns, letters = self.table[name][0].lstrip("~"), self.table[name][1]
                rest, outs, say = iter(given), [], C.create_string_buffer(SAY)
                values = [self.argument(c, None if c == "p" else next(rest), done, outs) for c in letters]
                function = self.lib[name]
                function.restype = {"s": C.c_int, "i": C.c_int, "r": C.c_double, "v": None}[returns]
                result = function(*values, *((say, C.c_size_t(SAY)) if returns == "s" else ()))
                if returns == "s" and result:
                    raise RuntimeError(f"{name}: {say.value.decode()}")
                for o in [] if name in self.of_libm else outs:
                    self.lib.bis_flat_fnv(digest, C.c_size_t(C.sizeof(o)), o)
                done.append([result] if returns in "ri" else outs)
        finally:
            os.chdir(here)
        return done, f"{digest[1]:08x}{digest[0]:08x}"
