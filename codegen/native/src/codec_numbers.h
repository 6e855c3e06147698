/* Single numbers, inlined into what runs the rows. Only objects of exactly the type that the field documents: a subclass may
 * have functions of its own. */
#ifndef IFGEN_NATIVE_CODEC_NUMBERS_H
#define IFGEN_NATIVE_CODEC_NUMBERS_H

#include "codec.h"

#include <math.h>
#include <string.h>

/* Where a float has its number: after what all objects have. codec_open makes sure. The limited API has it behind a call
 * that takes longer than all else here. */
enum { FLOAT_PLACE = sizeof(PyObject) };

/* The integer in an int that is in this range. */
static inline bool integer_in(PyObject *value, long long least, long long most, long long *integer) {
  int overflow;
  if (!Py_IS_TYPE(value, &PyLong_Type)) return false;
  *integer = PyLong_AsLongLongAndOverflow(value, &overflow);
  return !overflow && *integer >= least && *integer <= most;
}

static inline bool integer_write(uint8_t *to, PyObject *value, long long least, long long most, size_t size) {
  long long integer;
  if (!integer_in(value, least, most, &integer)) return false;
  memcpy(to, &integer, size); /* little endian */
  return true;
}

static inline bool unsigned_write(uint8_t *to, PyObject *value) {
  if (!Py_IS_TYPE(value, &PyLong_Type)) return false;
  const unsigned long long integer = PyLong_AsUnsignedLongLong(value);
  if (integer == (unsigned long long)-1 && PyErr_Occurred()) return PyErr_Clear(), false;
  memcpy(to, &integer, 8);
  return true;
}

static inline bool float32_write(uint8_t *to, PyObject *value) {
  if (!Py_IS_TYPE(value, &PyFloat_Type)) return false;
  double wide;
  memcpy(&wide, (char *)value + FLOAT_PLACE, sizeof wide);
  const float narrow = (float)wide;
  if (isinf(narrow) && !isinf(wide)) return false;
  memcpy(to, &narrow, 4);
  return true;
}

static inline bool character_write(uint8_t *to, PyObject *value) {
  if (!Py_IS_TYPE(value, &PyUnicode_Type) || PyUnicode_GetLength(value) != 1) return false;
  const Py_UCS4 character = PyUnicode_ReadChar(value, 0);
  *to = (uint8_t)character;
  return character <= 0xff;
}

/* False where a value is not what the type asks for. */
static inline bool number_write(uint8_t *to, number_type type, PyObject *value) {
  switch (type) {
    case NUMBER_BOOLEAN:
      *to = value == Py_True;
      return value == Py_True || value == Py_False;
    case NUMBER_OCTET:
      if (!Py_IS_TYPE(value, &PyBytes_Type) || PyBytes_Size(value) != 1) return false;
      *to = (uint8_t)*PyBytes_AsString(value);
      return true;
    case NUMBER_CHAR: return character_write(to, value);
    case NUMBER_INT8: return integer_write(to, value, INT8_MIN, INT8_MAX, 1);
    case NUMBER_UINT8: return integer_write(to, value, 0, UINT8_MAX, 1);
    case NUMBER_INT16: return integer_write(to, value, INT16_MIN, INT16_MAX, 2);
    case NUMBER_UINT16: return integer_write(to, value, 0, UINT16_MAX, 2);
    case NUMBER_INT32: return integer_write(to, value, INT32_MIN, INT32_MAX, 4);
    case NUMBER_UINT32: return integer_write(to, value, 0, UINT32_MAX, 4);
    case NUMBER_INT64: return integer_write(to, value, INT64_MIN, INT64_MAX, 8);
    case NUMBER_UINT64: return unsigned_write(to, value);
    case NUMBER_FLOAT32: return float32_write(to, value);
    case NUMBER_FLOAT64:
      if (!Py_IS_TYPE(value, &PyFloat_Type)) return false;
      memcpy(to, (char *)value + FLOAT_PLACE, 8);
      return true;
    default: return false;
  }
}

#define READ_AS(TYPE, MAKE) \
  { \
    TYPE number; \
    memcpy(&number, from, sizeof number); \
    return MAKE(number); \
  }

static inline PyObject *number_read(const uint8_t *from, number_type type) {
  switch (type) {
    case NUMBER_BOOLEAN: return PyBool_FromLong(*from);
    case NUMBER_OCTET: return PyBytes_FromStringAndSize((const char *)from, 1);
    case NUMBER_CHAR: return PyUnicode_FromOrdinal(*from);
    case NUMBER_INT8: READ_AS(int8_t, PyLong_FromLong)
    case NUMBER_UINT8: READ_AS(uint8_t, PyLong_FromLong)
    case NUMBER_INT16: READ_AS(int16_t, PyLong_FromLong)
    case NUMBER_UINT16: READ_AS(uint16_t, PyLong_FromLong)
    case NUMBER_INT32: READ_AS(int32_t, PyLong_FromLong)
    case NUMBER_UINT32: READ_AS(uint32_t, PyLong_FromUnsignedLong)
    case NUMBER_INT64: READ_AS(int64_t, PyLong_FromLongLong)
    case NUMBER_UINT64: READ_AS(uint64_t, PyLong_FromUnsignedLongLong)
    case NUMBER_FLOAT32: READ_AS(float, PyFloat_FromDouble)
    case NUMBER_FLOAT64: READ_AS(double, PyFloat_FromDouble)
    default: return PyErr_NoMemory(); /* no table has such a row */
  }
}

#undef READ_AS
#endif
