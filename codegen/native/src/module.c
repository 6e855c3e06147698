/* The extension module: what `ifgen_runtime.real_rclpy` calls. Addresses go in and out as integers, since the
 * tables behind them (hashes, descriptions, members) are ctypes structures that the caller keeps alive for good. */
#include "checksum.h"
#include "message.h"


static PyObject *native_bind(PyObject *module, PyObject *symbols) {
  (void)module;
  if (!PyDict_Check(symbols)) return PyErr_Format(PyExc_TypeError, "bind() takes a dict of symbol addresses");
  if (fastcdr_bind(symbols) < 0) return NULL;
  Py_RETURN_NONE;
}

static PyObject *native_accepts(PyObject *module, PyObject *arguments) {
  (void)module;
  PyObject *tables, *payload;
  if (!PyArg_ParseTuple(arguments, "OS:accepts", &tables, &payload)) return NULL;
  layout layout = {0};
  if (!layout_from_python(&layout, tables)) return NULL;
  bool accepted = layout_accepts(&layout, (const uint8_t *)PyBytes_AsString(payload), (size_t)PyBytes_Size(payload), NULL, NULL);
  layout_free(&layout);
  return PyBool_FromLong(accepted);
}

static PyObject *native_troubles(PyObject *module, PyObject *message_type_address) {
  (void)module;
  const message_type *type = PyLong_AsVoidPtr(message_type_address);
  if (!type) return PyErr_Occurred() ? NULL : PyErr_Format(PyExc_ValueError, "the address of a message type is 0");
  const trouble_count *troubles = type->troubles;
  return Py_BuildValue("III", troubles->dropped, troubles->with_rest, troubles->rest);
}

static PyMethodDef methods[] = {
    {"bind", native_bind, METH_O, "Take the addresses of libfastcdr's and rosidl's symbols and probe what is private."},
    {"introspection", native_introspection, METH_O, "Make an introspection handle for a member table."},
    {"message", native_message, METH_VARARGS, "Make the type support of a message and its five capsules."},
    {"service", native_service, METH_VARARGS, "Make the type support of a service from those of its messages."},
    {"action", native_action, METH_VARARGS, "Make the type support of an action from those of its parts."},
    {"troubles", native_troubles, METH_O,
     "How many payloads of a type were dropped, how many had bytes left over, and how many the last of these had."},
    {"accepts", native_accepts, METH_VARARGS, "Whether a payload is well-formed for the tables of a layout."},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    .m_base = PyModuleDef_HEAD_INIT,
    .m_name = "ifgen_native._native",
    .m_doc = "Type support for real rclpy and a codec, one for all message types.",
    .m_size = -1,
    .m_methods = methods,
};

enum { TYPE_SUPPORT_VERSION = 3 }; /* of the functions above; ifgen_runtime/real_rclpy/binding.py has the same */

PyMODINIT_FUNC PyInit__native(void) {
  PyObject *module = PyModule_Create(&definition);
  if (module && (PyModule_AddFunctions(module, codec_methods) || checksum_add(module) ||
                 PyModule_AddIntConstant(module, "TYPE_SUPPORT_VERSION", TYPE_SUPPORT_VERSION)))
    Py_CLEAR(module);
  return module;
}
