/* SPDX-License-Identifier: BSD-2-Clause */
/* version: the one place where the version of bis is written. */
#pragma once

#define BIS_VERSION "0.1.0"
