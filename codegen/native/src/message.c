/* Messages: what rclpy converts, what DDS carries. */
#include "native.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "layout.h"

enum { ENCAPSULATION = 4 };

const char *fastrtps_identifier;
const char *introspection_identifier;

/* ---- called by rclpy, with the GIL and no DDS lock -------------------------------------------------------- */

void *message_create(const message_type *type) {
  /* A payload that Fast CDR refuses leaves an error behind, and rcutils writes twelve lines to stderr when the next one
   * replaces it. */
  clear_error();
  message *self = calloc(1, sizeof *self);
  if (self) self->type = type;
  return self;
}

/* Say on stderr how many payloads were dropped; not more than once a second, so that a peer cannot fill a log. */
static void tell_of_drops(const message_type *type) {
  drop_count *drops = type->drops;
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  long long told = drops->told;
  if (told == (long long)now.tv_sec || !atomic_compare_exchange_strong(&drops->told, &told, (long long)now.tv_sec)) return;
  unsigned count = atomic_exchange(&drops->untold, 0);
  const message_callbacks *named = &type->callbacks;
  fprintf(stderr, "ifgen_native: dropped %u malformed message%s of type %s::%s (does a publisher have another definition of it?)\n",
          count, count == 1 ? "" : "s", named->namespace_, named->name);
}

/* Usually with the GIL; a service event is destroyed by rcl without saying. */
void message_destroy(void *that) {
  message *self = that;
  if (!self) return;
  if (self->type->drops->untold) tell_of_drops(self->type);
  /* Where the interpreter is gone already, its objects are gone with it. */
  if ((self->object || self->encoded) && Py_IsInitialized()) {
    PyGILState_STATE state = PyGILState_Ensure();
    Py_XDECREF(self->object);
    Py_XDECREF(self->encoded);
    PyGILState_Release(state);
  }
  free(self->received);
  free(self);
}

/* Steals `encoded`; false with a Python error where it is not a whole message. */
static bool take_encoded(message *self, PyObject *encoded) {
  if (encoded && (!PyBytes_Check(encoded) || PyBytes_Size(encoded) < ENCAPSULATION)) {
    PyErr_Format(PyExc_TypeError, "ifgen_native: the encoder of %s returned no CDR bytes", self->type->callbacks.name);
    Py_CLEAR(encoded);
  }
  if (!encoded) return false;
  Py_XDECREF(self->encoded);
  self->encoded = encoded;
  return true;
}

bool message_from_python(PyObject *object, void *that) {
  message *self = that;
  if (!take_encoded(self, PyObject_CallFunctionObjArgs(self->type->encode, object, NULL))) return false;
  Py_INCREF(object);
  Py_XDECREF(self->object);
  self->object = object;
  return true;
}

PyObject *message_to_python(void *that) {
  message *self = that;
  if (self->received) {
    PyObject *payload = PyBytes_FromStringAndSize(self->received, (Py_ssize_t)self->received_size);
    if (!payload) return NULL;
    PyObject *object = PyObject_CallFunctionObjArgs(self->type->decode, payload, NULL);
    Py_DECREF(payload);
    return object;
  }
  if (!self->object) {
    PyErr_Format(PyExc_RuntimeError, "ifgen_native: a %s was read before it was written", self->type->callbacks.name);
    return NULL;
  }
  Py_INCREF(self->object);
  return self->object;
}

/* ---- called by DDS, under its locks: no Python ------------------------------------------------------------ */

/* The body of an encoded message. Bytes objects do not move or change, so reading one needs no GIL. */
static const char *body(const message *self, size_t *size) {
  if (!self->encoded) return NULL;
  *size = (size_t)PyBytes_Size(self->encoded) - ENCAPSULATION;
  return PyBytes_AsString(self->encoded) + ENCAPSULATION;
}

static bool serialize(const void *that, void *cdr) {
  size_t size;
  const char *bytes = body(that, &size);
  if (!bytes) return false;
  /* The encapsulation has just been written, so alignment counts from here: the body fits as it is. */
  char *destination = fastcdr_position(cdr);
  if (!fastcdr_jump(cdr, size)) return false;
  memcpy(destination, bytes, size);
  return true;
}

static bool deserialize(void *cdr, void *that) {
  message *self = that;
  const char *payload;
  size_t size;
  fastcdr_payload(cdr, &payload, &size);
  if (!layout_accepts(self->type->program, self->type->program_words, (const uint8_t *)payload, size)) {
    /* A sample that cannot be read is dropped here: an error out of convert_to_py would end the node's spin. */
    self->type->drops->untold++;
    return false;
  }
  char *copy = malloc(size);
  if (!copy) return false;
  memcpy(copy, payload, size);
  free(self->received);
  self->received = copy;
  self->received_size = size;
  return true;
}

static uint32_t serialized_size(const void *that) {
  size_t size = 0;
  body(that, &size);
  return (uint32_t)size;
}

/* Unbounded, so that no middleware takes the type for plain memory. */
static size_t max_serialized_size(char *bounds) {
  *bounds = 0;
  return 252;
}

static const message_handle *find(const message_handle *handle, const char *identifier) {
  const message_type *type = (const message_type *)handle;
  if (!strcmp(identifier, fastrtps_identifier)) return handle;
  if (!strcmp(identifier, introspection_identifier)) return type->introspection;
  return NULL;
}

static const message_handle *find_introspection(const message_handle *handle, const char *identifier) {
  return strcmp(identifier, introspection_identifier) ? NULL : handle;
}

static const void *type_hash(const message_handle *handle) { return ((const message_type *)handle)->hash; }
static const void *type_description(const message_handle *handle) { return ((const message_type *)handle)->description; }
static const void *type_sources(const message_handle *handle) { return ((const message_type *)handle)->sources; }

/* ---- called by ifgen_runtime.type_support ----------------------------------------------------------------- */

PyObject *native_introspection(PyObject *module, PyObject *members) {
  (void)module;
  const void *table = PyLong_AsVoidPtr(members);
  if (!table) return PyErr_Occurred() ? NULL : PyErr_Format(PyExc_ValueError, "the address of a member table is 0");
  message_handle *handle = calloc(1, sizeof *handle);
  if (!handle) return PyErr_NoMemory();
  handle->identifier = introspection_identifier;
  handle->data = table;
  handle->find = find_introspection;
  return PyLong_FromVoidPtr(handle);
}

PyObject *native_message(PyObject *module, PyObject *arguments) {
  (void)module;
  const char *namespace_, *name, *words;
  unsigned long long introspection, hash, description, sources;
  PyObject *encode, *decode;
  Py_ssize_t size;
  if (!PyArg_ParseTuple(arguments, "ssKKKKOOy#:message", &namespace_, &name, &introspection, &hash, &description, &sources,
                        &encode, &decode, &words, &size))
    return NULL;
  const size_t program_words = (size_t)size / sizeof(uint32_t);
  if (!layout_is_program((const uint32_t *)(const void *)words, program_words)) /* bytes objects are aligned for it */
    return PyErr_Format(PyExc_ValueError, "the layout program of %s is malformed", name);
  message_type *type = calloc(1, sizeof *type);
  uint32_t *program = malloc(size ? (size_t)size : 1);
  drop_count *drops = calloc(1, sizeof *drops);
  create_function create = type && program && drops ? claim_message_slot(type) : NULL;
  if (!create) {
    free(type);
    free(program);
    free(drops);
    return PyErr_Occurred() ? NULL : PyErr_NoMemory();
  }
  memcpy(program, words, (size_t)size);
  type->handle = (message_handle){fastrtps_identifier, &type->callbacks, find, type_hash, type_description, type_sources};
  type->callbacks = (message_callbacks){
      .namespace_ = strdup(namespace_),
      .name = strdup(name),
      .serialize = serialize,
      .deserialize = deserialize,
      .serialized_size = serialized_size,
      .max_serialized_size = max_serialized_size,
  };
  type->introspection = pointer(introspection);
  type->hash = pointer(hash);
  type->description = pointer(description);
  type->sources = pointer(sources);
  type->program = program;
  type->program_words = program_words;
  type->drops = drops;
  Py_INCREF(encode);
  Py_INCREF(decode);
  type->encode = encode;
  type->decode = decode;
  return Py_BuildValue("K(NNNNN)", address(type), capsule(&type->handle), capsule((void *)create),
                       capsule((void *)message_from_python), capsule((void *)message_to_python), capsule((void *)message_destroy));
}
