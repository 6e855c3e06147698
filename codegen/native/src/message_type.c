/* Message types: the handles and the records that rmw gets to see. */
#include "message.h"

#include <stdlib.h>
#include <string.h>

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

/* ---- called by ifgen_runtime.real_rclpy ----------------------------------------------------------------- */

bool layout_from_python(layout *made, PyObject *tables) {
  const Py_ssize_t count = PyTuple_Check(tables) ? PyTuple_Size(tables) : 0;
  bool sound = count > 0;
  for (Py_ssize_t i = 0; sound && i < count; i++) {
    PyObject *rows, *calls;
    Py_ssize_t size;
    const char *text = PyArg_ParseTuple(PyTuple_GetItem(tables, i), "US", &rows, &calls) ? PyUnicode_AsUTF8AndSize(rows, &size) : NULL;
    sound = text && layout_add(made, text, (size_t)size, (const uint32_t *)(const void *)PyBytes_AsString(calls),
                               (size_t)PyBytes_Size(calls) / sizeof(uint32_t));
  }
  if (sound) return true;
  layout_free(made);
  if (!PyErr_Occurred()) PyErr_SetString(PyExc_ValueError, "the tables of the layout are malformed");
  return false;
}

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

/* The text of the last table. NULL without memory. */
static char *last_text(PyObject *tables) {
  PyObject *last = PyTuple_GetItem(tables, PyTuple_Size(tables) - 1);
  const char *text = PyUnicode_AsUTF8AndSize(PyTuple_GetItem(last, 0), NULL);
  return text ? strdup(text) : NULL;
}

PyObject *native_message(PyObject *module, PyObject *arguments) {
  (void)module;
  const char *namespace_, *name;
  unsigned long long introspection, hash, description, sources;
  PyObject *cls, *encode, *decode, *tables;
  if (!PyArg_ParseTuple(arguments, "O!ssKKKKOOO:message", &PyType_Type, &cls, &namespace_, &name, &introspection, &hash, &description, &sources,
                        &encode, &decode, &tables))
    return NULL;
  layout layout = {0};
  if (!layout_from_python(&layout, tables)) return NULL;
  message_type *type = calloc(1, sizeof *type);
  char *text = last_text(tables);
  trouble_count *troubles = calloc(1, sizeof *troubles);
  create_function create = type && text && troubles ? claim_message_slot(type) : NULL;
  if (!create) {
    layout_free(&layout);
    free(type);
    free(text);
    free(troubles);
    return PyErr_Occurred() ? NULL : PyErr_NoMemory();
  }
  type->handle = (message_handle){fastrtps_identifier, &type->callbacks, find, type_hash, type_description, type_sources};
  type->callbacks = message_functions;
  type->callbacks.namespace_ = strdup(namespace_);
  type->callbacks.name = strdup(name);
  type->introspection = pointer(introspection);
  type->hash = pointer(hash);
  type->description = pointer(description);
  type->sources = pointer(sources);
  type->layout = layout;
  type->text = text;
  type->troubles = troubles;
  Py_INCREF(encode);
  Py_INCREF(decode);
  type->codec = codec_of((PyTypeObject *)cls);
  type->encode = encode;
  type->decode = decode;
  return Py_BuildValue("K(NNNNN)", address(type), capsule(&type->handle), capsule((void *)create),
                       capsule((void *)message_from_python), capsule((void *)message_to_python), capsule((void *)message_destroy));
}
