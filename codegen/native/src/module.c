/* The extension module: what `ifgen_runtime.type_support` calls. Addresses go in and out as integers, since the
 * tables behind them (hashes, descriptions, members) are ctypes structures that the caller keeps alive for good. */
#include "native.h"

#include "codec.h"
#include "layout.h"

static PyObject *native_bind(PyObject *module, PyObject *symbols) {
  (void)module;
  if (!PyDict_Check(symbols)) return PyErr_Format(PyExc_TypeError, "bind() takes a dict of symbol addresses");
  if (fastcdr_bind(symbols) < 0) return NULL;
  Py_RETURN_NONE;
}

static PyObject *native_accepts(PyObject *module, PyObject *arguments) {
  (void)module;
  const char *words, *payload;
  Py_ssize_t words_size, size;
  if (!PyArg_ParseTuple(arguments, "y#y#:accepts", &words, &words_size, &payload, &size)) return NULL;
  const uint32_t *program = (const uint32_t *)(const void *)words; /* bytes objects are aligned for it */
  size_t count = (size_t)words_size / sizeof *program;
  if (!layout_is_program(program, count)) return PyErr_Format(PyExc_ValueError, "the layout program is malformed");
  return PyBool_FromLong(layout_accepts(program, count, (const uint8_t *)payload, (size_t)size));
}

static PyMethodDef methods[] = {
    {"bind", native_bind, METH_O, "Take the addresses of libfastcdr's and rosidl's symbols and probe what is private."},
    {"introspection", native_introspection, METH_O, "Make an introspection handle for a member table."},
    {"message", native_message, METH_VARARGS, "Make the type support of a message and its five capsules."},
    {"service", native_service, METH_VARARGS, "Make the type support of a service from those of its messages."},
    {"action", native_action, METH_VARARGS, "Make the type support of an action from those of its parts."},
    {"accepts", native_accepts, METH_VARARGS, "Whether a payload is well-formed for a layout program."},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    .m_base = PyModuleDef_HEAD_INIT,
    .m_name = "ifgen_native._native",
    .m_doc = "Type support for real rclpy and a codec, one for all message types.",
    .m_size = -1,
    .m_methods = methods,
};

PyMODINIT_FUNC PyInit__native(void) {
  PyObject *module = PyModule_Create(&definition);
  if (module && PyModule_AddFunctions(module, codec_methods)) Py_CLEAR(module);
  return module;
}
