/* `crc32` of the extension module. */
#ifndef IFGEN_NATIVE_CHECKSUM_H
#define IFGEN_NATIVE_CHECKSUM_H

#include "native.h"

/* Adds the function where the processor can; -1 with an exception. */
int checksum_add(PyObject *module);

#endif
