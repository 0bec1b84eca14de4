# SPDX-License-Identifier: BSD-2-Clause
"""The instruments: programs that look at what the library computes. `bis trade` is `bis.tools.trade`."""
