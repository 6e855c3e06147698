/* What is sent: encoded while rclpy converts the object, and copied into DDS' buffer once. Large arrays are not encoded at
 * all. They are pinned until rclpy destroys the message, and DDS' buffer is filled from them. rclpy keeps the GIL from the
 * conversion to the end of publish, so nobody can change them in between; if it ever does not, whoever resizes such an
 * array meanwhile gets a BufferError, and no memory is read that is gone. */
#include <stdlib.h>
#include <string.h>

#include "message.h"

enum { ENCAPSULATION = 4, ROOM = 64 };

/* Steals `encoded`; false with a Python error where it is not a whole message. */
static bool take_encoded(message *self, PyObject *encoded) {
  if (encoded && (!PyBytes_Check(encoded) || PyBytes_Size(encoded) < ENCAPSULATION)) {
    PyErr_Format(PyExc_TypeError, "ifgen_native: the encoder of %s returned no CDR bytes", self->type->callbacks.name);
    Py_CLEAR(encoded);
  }
  self->encoded = encoded;
  return encoded;
}

/* False with a Python error. */
static bool pin(message *self) {
  const int count = self->written.piece_count;
  if (!count) return true;
  if (!(self->pins = malloc((size_t)count * sizeof *self->pins))) return PyErr_NoMemory(), false;
  for (; self->pin_count < count; self->pin_count++)
    if (PyObject_GetBuffer(self->written.pieces[self->pin_count].owner, &self->pins[self->pin_count], PyBUF_SIMPLE)) return false;
  return true;
}

static codec_outcome encode_in_c(message *self, PyObject *object) {
  codec *it = self->type->codec;
  if (!it || !block_reserve(&self->memory, it->last_used + ROOM)) return CODEC_UNUSUAL;
  self->written = (codec_buffer){.data = (uint8_t *)self->memory.data, .capacity = self->memory.capacity, .borrowed = true, .large = CODEC_LARGE};
  codec_outcome outcome = codec_write(it, object, &self->written);
  return outcome == CODEC_DONE && !pin(self) ? CODEC_ERROR : outcome;
}

bool sending_encode(message *self, PyObject *object) {
  sending_release(self);
  switch (encode_in_c(self, object)) {
    case CODEC_DONE: return true;
    case CODEC_ERROR: return false;
    default: sending_release(self);
  }
  return take_encoded(self, PyObject_CallFunctionObjArgs(self->type->encode, object, NULL));
}

bool sending_needs_gil(const message *self) { return self->encoded || self->pin_count; }

void sending_release(message *self) {
  Py_CLEAR(self->encoded);
  while (self->pin_count) PyBuffer_Release(&self->pins[--self->pin_count]);
  free(self->pins);
  self->pins = NULL;
  codec_buffer_release(&self->written);
  block_release(&self->memory);
}

/* ---- called by DDS, under its locks: no Python. Bytes objects do not move or change, so reading one needs no GIL. ---- */

size_t sending_size(const message *self) {
  const size_t size = self->encoded ? (size_t)PyBytes_Size(self->encoded) : codec_buffer_size(&self->written);
  return size > ENCAPSULATION ? size - ENCAPSULATION : 0;
}

void sending_copy(const message *self, char *destination) {
  if (self->encoded) memcpy(destination, PyBytes_AsString(self->encoded) + ENCAPSULATION, sending_size(self));
  else codec_buffer_copy(&self->written, ENCAPSULATION, (uint8_t *)destination);
}
