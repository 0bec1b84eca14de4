# SPDX-License-Identifier: BSD-2-Clause
"""python -m bis: the program `bis`, the one beside this file, else the installed one."""
from __future__ import annotations

import os
import shutil
import sys


def main() -> None:
    """Become the program, so that its exit status is ours. Its instruments find this Python."""
    beside = os.path.join(os.path.dirname(os.path.abspath(__file__)), "program", "bis")
    program = beside if os.path.exists(beside) else shutil.which("bis")
    if not program:
        sys.exit("python -m bis: the program `bis` is not installed: run `make install`, or "
                 "install the wheel of bis")
    os.environ.setdefault("BIS_PYTHON", sys.executable)
    os.execv(program, ["bis"] + sys.argv[1:])


main()
