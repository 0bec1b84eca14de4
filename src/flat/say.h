/* say: what the functions of flat share: messages into the caller's buffer. */
#pragma once

#include "bis/base/status.h"

/* bis_flat_end writes all messages to say[size], one a line, frees them, and returns the status. */
int bis_flat_end(bis_status status, bis_diag *diag, char *say, size_t size);
