/* Pairs of messages that a table's rows speak of, by their numbers, while rows run that may call Python: those compared, or
 * one and its copy. They are held, since what is called may take them out of the message that they are in. Where a number
 * has no messages, its rows have nothing to do. */
#ifndef IFGEN_NATIVE_CODEC_REGISTERS_H
#define IFGEN_NATIVE_CODEC_REGISTERS_H

#include "codec_wire.h"

enum { REGISTERS_FEW = 48 };

typedef struct {
  PyObject **held;
  uint32_t count;
  PyObject *few[REGISTERS_FEW];
} registers;

/* False with a Python error. */
static inline bool registers_start(registers *r, const table *t) {
  r->count = 2 * t->message_count;
  r->held = r->few;
  if (r->count > REGISTERS_FEW && !(r->held = PyMem_Malloc(r->count * sizeof *r->held))) return PyErr_NoMemory(), false;
  for (uint32_t i = 0; i < r->count; i++) r->held[i] = NULL;
  return true;
}

static inline PyObject *registers_left(const registers *r, uint32_t number) { return r->held[2 * number]; }
static inline PyObject *registers_right(const registers *r, uint32_t number) { return r->held[2 * number + 1]; }

/* From now on, the number has these two messages, or NULL twice. */
static inline void registers_set(registers *r, uint32_t number, PyObject *left, PyObject *right) {
  PyObject *old_left = registers_left(r, number), *old_right = registers_right(r, number);
  Py_XINCREF(left);
  Py_XINCREF(right);
  r->held[2 * number] = left;
  r->held[2 * number + 1] = right;
  Py_XDECREF(old_left);
  Py_XDECREF(old_right);
}

static inline void registers_end(registers *r) {
  for (uint32_t i = 0; i < r->count; i++) Py_XDECREF(r->held[i]);
  if (r->held != r->few) PyMem_Free(r->held);
}

/* What a slot holds: a new reference, or NULL with the AttributeError of Python. */
static inline PyObject *slot_value(PyObject *message, const row *r) {
  PyObject *value = *slot_of(message, r);
  if (value) {
    Py_INCREF(value);
    return value;
  }
  return PyObject_GetAttr(message, r->slot);
}

#endif
