/* Messages: what rclpy converts, what DDS carries. */
#include "message.h"

#include <stdlib.h>

/* ---- called by rclpy, with the GIL and no DDS lock -------------------------------------------------------- */

void *message_create(const message_type *type) {
  /* A payload that Fast CDR refuses leaves an error behind, and rcutils writes twelve lines to stderr when the next one
   * replaces it. */
  clear_error();
  message *self = malloc(sizeof *self); /* calloc is slower for so little */
  if (!self) return NULL;
  *self = (message){.type = type};
  large_prepare(&self->large, type);
  return self;
}

/* Usually with the GIL; a service event is destroyed by rcl without saying. */
void message_destroy(void *that) {
  message *self = that;
  if (!self) return;
  /* Where the interpreter is gone already, its objects are gone with it. */
  const bool needs_gil = self->object || self->large.count || sending_needs_gil(self);
  if (!needs_gil) sending_release(self);
  else if (Py_IsInitialized()) {
    PyGILState_STATE state = PyGILState_Ensure();
    Py_XDECREF(self->object);
    sending_release(self);
    large_release(&self->large);
    PyGILState_Release(state);
  }
  block_release(&self->received);
  free(self);
}

bool message_from_python(PyObject *object, void *that) {
  message *self = that;
  if (!sending_encode(self, object)) return false;
  if (self->type->is_in_events) {
    Py_INCREF(object);
    Py_XDECREF(self->object);
    self->object = object;
  }
  return true;
}

/* NULL with a Python error. */
static PyObject *decoded(const message *self) {
  PyObject *object;
  if (self->type->codec)
    switch (codec_read(self->type->codec, (const uint8_t *)self->received.data, self->received.size, NULL, &object)) {
      case CODEC_DONE: return object;
      case CODEC_ERROR: return NULL;
      default: break;
    }
  PyObject *payload = PyBytes_FromStringAndSize(self->received.data, (Py_ssize_t)self->received.size);
  object = payload ? PyObject_CallFunctionObjArgs(self->type->decode, payload, NULL) : NULL;
  Py_XDECREF(payload);
  return object;
}

PyObject *message_to_python(void *that) {
  message *self = that;
  if (self->received.size) {
    PyObject *object = decoded(self);
    if (object && !large_finish(&self->large, self->type, object)) Py_CLEAR(object);
    return object;
  }
  if (!self->object) {
    PyErr_Format(PyExc_RuntimeError, "ifgen_native: a %s was read before it was received", self->type->callbacks.name);
    return NULL;
  }
  Py_INCREF(self->object);
  return self->object;
}

/* ---- called by DDS, under its locks: no Python ------------------------------------------------------------ */

static bool serialize(const void *that, void *cdr) {
  const message *self = that;
  if (!self->encoded && !self->written.data) return false;
  /* The encapsulation has just been written, so alignment counts from here: the body fits as it is. */
  char *destination = fastcdr_position(cdr);
  if (!fastcdr_jump(cdr, sending_size(self))) return false;
  sending_copy(self, destination);
  return true;
}

/* Some writers fill the payload up to a multiple of four. */
static bool is_padding(size_t rest, size_t size) { return rest < 4 && size % 4 == 0; }

static bool deserialize(void *cdr, void *that) {
  message *self = that;
  const char *payload;
  size_t size;
  fastcdr_payload(cdr, &payload, &size);
  size_t rest;
  trouble_count *troubles = self->type->troubles;
  if (!layout_accepts(&self->type->layout, (const uint8_t *)payload, size, &self->large.longest, &rest)) {
    /* A sample that cannot be read is dropped here: an error out of convert_to_py would end the node's spin. */
    troubles->dropped++;
    return false;
  }
  if (rest && !is_padding(rest, size)) {
    troubles->rest = (unsigned)rest;
    troubles->with_rest++;
  }
  return large_receive(&self->large, &self->received, payload, size);
}

static uint32_t serialized_size(const void *that) { return (uint32_t)sending_size(that); }

/* Unbounded, so that no middleware takes the type for plain memory. */
static size_t max_serialized_size(char *bounds) {
  *bounds = 0;
  return 252;
}

const message_callbacks message_functions = {
    .serialize = serialize,
    .deserialize = deserialize,
    .serialized_size = serialized_size,
    .max_serialized_size = max_serialized_size,
};
