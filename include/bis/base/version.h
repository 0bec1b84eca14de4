/* version: the one place where the version of bis is written. */
#ifndef BIS_VERSION_H
#define BIS_VERSION_H

#define BIS_VERSION "0.1.0"

#endif
