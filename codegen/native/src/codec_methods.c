/* `__eq__`, `__deepcopy__` and `__copy__` of classes that have a codec. Objects of derived classes, those with checks among
 * them, have the methods that were generated in Python, which know what else such objects have. */
#include "codec.h"

static PyObject *call_generated(const char *name, PyObject *message, PyObject *argument) {
  return PyObject_CallMethod((PyObject *)Py_TYPE(message), name, argument ? "OO" : "O", message, argument);
}

static PyObject *method_equal(PyObject *message, PyObject *other) {
  const codec *it = codec_of(Py_TYPE(message));
  return it ? codec_equal(it, message, other) : call_generated("__generated_eq__", message, other);
}

static PyObject *method_deepcopy(PyObject *message, PyObject *memo) {
  const codec *it = PyDict_CheckExact(memo) ? codec_of(Py_TYPE(message)) : NULL;
  return it ? codec_deepcopy(it, message, memo) : call_generated("__generated_deepcopy__", message, memo);
}

static PyObject *method_copy(PyObject *message, PyObject *nothing) {
  (void)nothing;
  const codec *it = codec_of(Py_TYPE(message));
  return it ? codec_copy(it, message) : call_generated("__generated_copy__", message, NULL);
}

static PyMethodDef equal_method = {"__eq__", method_equal, METH_O, "Whether the other message is equal."};
static PyMethodDef deepcopy_method = {"__deepcopy__", method_deepcopy, METH_O, "A copy that shares nothing with this message."};
static PyMethodDef copy_method = {"__copy__", method_copy, METH_NOARGS, "A copy that shares the values of the fields."};

PyObject *native_codec_methods(PyObject *module, PyObject *cls) {
  (void)module;
  static bool is_open;
  if (!PyType_Check(cls) || !codec_of((PyTypeObject *)cls)) return PyErr_Format(PyExc_TypeError, "%R has no codec in C", cls);
  if (!is_open) {
    PyObject *copying = PyImport_ImportModule("ifgen_runtime.copying");
    is_open = copying && codec_copy_open(copying) && codec_equal_open(copying);
    Py_XDECREF(copying);
    if (!is_open) return NULL;
  }
  PyTypeObject *type = (PyTypeObject *)cls;
  PyObject *equal = PyDescr_NewMethod(type, &equal_method);
  PyObject *deepcopy = equal ? PyDescr_NewMethod(type, &deepcopy_method) : NULL;
  PyObject *copy = deepcopy ? PyDescr_NewMethod(type, &copy_method) : NULL;
  if (copy) return Py_BuildValue("NNN", equal, deepcopy, copy);
  Py_XDECREF(equal);
  Py_XDECREF(deepcopy);
  return NULL;
}
