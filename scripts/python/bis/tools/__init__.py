# SPDX-License-Identifier: BSD-2-Clause
"""The instruments, programs that look at what the library computes: `bis.tools.trade` and more."""
