# SPDX-License-Identifier: BSD-2-Clause
"""python -m bis.tools NAME: an instrument, as `bis NAME` runs it."""
from __future__ import annotations

import importlib
import os
import sys

INSTRUMENTS = ("trade", "pixel", "envmap", "judge", "irradiance", "tev")


def main() -> None:
    """Run the instrument that the first argument names, and exit with its state."""
    # numpy's own threads would only be started here, never used: the library has its own.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    name = sys.argv[1] if len(sys.argv) > 1 else ""
    if name not in INSTRUMENTS:
        sys.exit("python -m bis.tools: give one of %s" % ", ".join(INSTRUMENTS))
    try:
        instrument = importlib.import_module("bis.tools." + name)
        status = instrument.main(sys.argv[2:])
    except ImportError as e:  # no numpy, or no library, or one of another build
        sys.stderr.write("bis: error: %s\n" % e)
        status = 2
    sys.exit(status)


if __name__ == "__main__":
    main()
