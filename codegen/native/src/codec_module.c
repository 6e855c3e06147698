/* The codec as Python sees it: functions of the extension module, and those of each class. */
#include "codec_numbers.h"
#include "codec_wire.h"

enum { CODEC_ABI = 2 }; /* of the functions here and of the text of tables; ifgen_runtime/codec/choice.py has the same */
enum { LOCAL_SIZE = 1024 };

/* From ifgen_runtime: the functions for what has no codec in C, and for objects of classes derived from one that has. */
static PyObject *serialize_other, *deserialize_other, *encode_derived;

/* How often C did the work, and how often it left it to Python: for tests and ifgen doctor. */
static unsigned long long times_written, times_read, times_left;

static size_t large_in_parcels = CODEC_LARGE;

static PyObject *bytes_of(const codec_buffer *written) {
  PyObject *bytes = PyBytes_FromStringAndSize(NULL, (Py_ssize_t)codec_buffer_size(written));
  if (bytes) codec_buffer_copy(written, 0, (uint8_t *)PyBytes_AsString(bytes));
  return bytes;
}

/* The bytes of a message, or a parcel of one with large arrays where that will do. */
static PyObject *serialize_with(codec *it, PyObject *message, bool as_parcel) {
  uint8_t local[LOCAL_SIZE];
  codec_buffer buffer = {.data = local, .capacity = sizeof local, .borrowed = true, .large = as_parcel ? large_in_parcels : CODEC_LARGE};
  PyObject *bytes = NULL;
  codec_outcome outcome = codec_write(it, message, &buffer);
  if (outcome == CODEC_DONE && as_parcel && buffer.piece_count) bytes = parcel_make(it, &buffer);
  if (outcome == CODEC_DONE && !bytes && !PyErr_Occurred()) bytes = bytes_of(&buffer);
  codec_buffer_release(&buffer);
  if (outcome == CODEC_UNUSUAL) {
    times_left++;
    return PyObject_CallFunctionObjArgs(it->encode, message, NULL);
  }
  times_written++;
  return bytes;
}

/* `otherwise` is the function in Python that does the same. */
static PyObject *deserialize_with(codec *it, PyObject *data, bool is_viewed, PyObject *otherwise) {
  PyObject *message;
  if (is_parcel(data)) {
    codec_outcome outcome = is_viewed ? CODEC_UNUSUAL : parcel_read(it, data, &message);
    if (outcome != CODEC_UNUSUAL) return outcome == CODEC_DONE ? times_read++, message : NULL;
    PyObject *bytes = parcel_bytes(data);
    message = bytes ? deserialize_with(it, bytes, is_viewed, otherwise) : NULL;
    Py_XDECREF(bytes);
    return message;
  }
  if (Py_IS_TYPE(data, &PyBytes_Type)) {
    const uint8_t *start = (const uint8_t *)PyBytes_AsString(data);
    switch (codec_read(it, start, (size_t)PyBytes_Size(data), is_viewed ? data : NULL, &message)) {
      case CODEC_DONE: times_read++; return message;
      case CODEC_ERROR: return NULL;
      default: times_left++;
    }
  }
  return PyObject_CallFunctionObjArgs(otherwise, data, NULL);
}

/* message.__serialize__(): a method of each class that has a codec, and so of classes derived from it. */
static PyObject *method_serialize(PyObject *message, PyObject *nothing) {
  (void)nothing;
  codec *it = codec_of(Py_TYPE(message));
  return it ? serialize_with(it, message, false) : PyObject_CallFunctionObjArgs(encode_derived, message, NULL);
}

/* The same, as a parcel where one will do. */
static PyObject *method_pack(PyObject *message, PyObject *nothing) {
  (void)nothing;
  codec *it = codec_of(Py_TYPE(message));
  return it ? serialize_with(it, message, true) : PyObject_CallFunctionObjArgs(encode_derived, message, NULL);
}

/* cls.__deserialize__(data): a function of each class. */
static PyObject *function_deserialize(PyObject *cls, PyObject *data) {
  codec *it = codec_of((PyTypeObject *)cls);
  return deserialize_with(it, data, false, it->decode);
}

/* The function that `codec_viewer` returns. `pair` is the class, and the function in Python. */
static PyObject *function_view(PyObject *pair, PyObject *data) {
  codec *it = codec_of((PyTypeObject *)PyTuple_GetItem(pair, 0));
  return deserialize_with(it, data, true, PyTuple_GetItem(pair, 1));
}

static PyMethodDef serialize_method = {"__serialize__", method_serialize, METH_NOARGS, "The CDR form of the message."};
static PyMethodDef pack_method = {"__serialize__", method_pack, METH_NOARGS, "The message for one reader in this process."};
static PyMethodDef view_function = {"view", function_view, METH_O, "The message in these bytes, with views of them."};
static PyMethodDef deserialize_function = {"__deserialize__", function_deserialize, METH_O, "The message in these bytes."};

/* Call a function of Python with what a function of C was given. */
static PyObject *call_other(PyObject *function, PyObject *const *arguments, Py_ssize_t count, PyObject *names) {
  PyObject *positional = PyTuple_New(count), *named = positional ? PyDict_New() : NULL;
  for (Py_ssize_t i = 0; named && i < count; i++) {
    Py_INCREF(arguments[i]);
    PyTuple_SetItem(positional, i, arguments[i]);
  }
  PyObject *result = NULL;
  bool sound = named != NULL;
  for (Py_ssize_t i = 0; sound && names && i < PyTuple_Size(names); i++)
    sound = !PyDict_SetItem(named, PyTuple_GetItem(names, i), arguments[count + i]);
  if (sound) result = PyObject_Call(function, positional, named);
  Py_XDECREF(positional);
  Py_XDECREF(named);
  return result;
}

static PyObject *native_serialize(PyObject *module, PyObject *const *arguments, Py_ssize_t count, PyObject *names) {
  (void)module;
  codec *it = count == 1 && !names ? codec_of(Py_TYPE(arguments[0])) : NULL;
  return it ? serialize_with(it, arguments[0], false) : call_other(serialize_other, arguments, count, names);
}

static PyObject *native_deserialize(PyObject *module, PyObject *const *arguments, Py_ssize_t count, PyObject *names) {
  (void)module;
  codec *it = count == 2 && !names && Py_IS_TYPE(arguments[0], &PyBytes_Type) ? codec_of((PyTypeObject *)arguments[1]) : NULL;
  return it ? deserialize_with(it, arguments[0], false, it->decode) : call_other(deserialize_other, arguments, count, names);
}

static void replace(PyObject **kept, PyObject *value) {
  PyObject *old = *kept;
  Py_INCREF(value);
  *kept = value;
  Py_XDECREF(old);
}

/* False, too, where memory is short. */
static bool is_known_float(void) {
  const double number = -0.1;
  PyObject *object = PyFloat_FromDouble(number);
  const bool is = object && !memcmp((char *)object + FLOAT_PLACE, &number, sizeof number);
  Py_XDECREF(object);
  PyErr_Clear();
  return is;
}

/* Why the codec cannot run here, or None. */
static PyObject *native_open(PyObject *module, PyObject *arguments) {
  (void)module;
  int abi;
  PyObject *serialize, *deserialize, *derived;
  if (!PyArg_ParseTuple(arguments, "iOOO:codec_open", &abi, &serialize, &deserialize, &derived)) return NULL;
  if (abi != CODEC_ABI)
    return PyUnicode_FromFormat("ifgen_native has version %d of the codec and ifgen_runtime needs version %d: install the same release of ifgen-ros-native and ifgen-ros-runtime", CODEC_ABI, abi);
  if (__BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__) return PyUnicode_FromString("this machine is big endian");
  if (PyInterpreterState_GetID(PyInterpreterState_Get())) return PyUnicode_FromString("this is a sub-interpreter");
  if (!is_known_float()) return PyUnicode_FromString("the floats of this interpreter are not laid out as CPython's");
  if (!parcel_open_type()) return NULL;
  replace(&serialize_other, serialize);
  replace(&deserialize_other, deserialize);
  replace(&encode_derived, derived);
  Py_RETURN_NONE;
}

static PyObject *native_attach(PyObject *module, PyObject *arguments) {
  (void)module;
  PyObject *cls, *encode, *decode, *rows, *classes;
  Py_ssize_t size;
  if (!PyArg_ParseTuple(arguments, "O!OOUO!:codec_attach", &PyType_Type, &cls, &encode, &decode, &rows, &PyTuple_Type, &classes))
    return NULL;
  const char *text = PyUnicode_AsUTF8AndSize(rows, &size);
  if (!text || !codec_attach((PyTypeObject *)cls, encode, decode, text, size, classes)) return NULL;
  PyObject *method = PyDescr_NewMethod((PyTypeObject *)cls, &serialize_method);
  PyObject *function = method ? PyCFunction_NewEx(&deserialize_function, cls, NULL) : NULL;
  if (!function) return Py_XDECREF(method), NULL;
  return Py_BuildValue("NN", method, function);
}

static PyObject *native_viewer(PyObject *module, PyObject *arguments) {
  (void)module;
  PyObject *cls, *views, *otherwise;
  if (!PyArg_ParseTuple(arguments, "O!O!O:codec_viewer", &PyType_Type, &cls, &PyType_Type, &views, &otherwise)) return NULL;
  if (!codec_of((PyTypeObject *)cls)) {
    Py_INCREF(otherwise);
    return otherwise;
  }
  codec_view_class(views);
  PyObject *pair = PyTuple_Pack(2, cls, otherwise);
  PyObject *function = pair ? PyCFunction_NewEx(&view_function, pair, NULL) : NULL;
  Py_XDECREF(pair);
  return function;
}

static PyObject *native_packer(PyObject *module, PyObject *cls) {
  (void)module;
  if (!PyType_Check(cls) || !codec_of((PyTypeObject *)cls)) return PyErr_Format(PyExc_TypeError, "%R has no codec in C", cls);
  return PyDescr_NewMethod((PyTypeObject *)cls, &pack_method);
}

static PyObject *native_large_in_parcels(PyObject *module, PyObject *size) {
  (void)module;
  const size_t before = large_in_parcels, next = PyLong_AsSize_t(size);
  if (PyErr_Occurred()) return NULL;
  large_in_parcels = next;
  return PyLong_FromSize_t(before);
}

static PyObject *native_array(PyObject *module, PyObject *const *arguments, Py_ssize_t count) {
  (void)module;
  if (count != 2 || !PyUnicode_Check(arguments[0]) || PyUnicode_GetLength(arguments[0]) != 1)
    return PyErr_Format(PyExc_TypeError, "codec_array() takes a type code and values");
  return sequence_of_items(arguments[0], arguments[1]);
}

static PyObject *native_counts(PyObject *module, PyObject *nothing) {
  (void)module;
  (void)nothing;
  return Py_BuildValue("KKK", times_written, times_read, times_left);
}

#define FAST(FUNCTION) (PyCFunction)(void (*)(void))FUNCTION, METH_FASTCALL | METH_KEYWORDS

PyMethodDef codec_methods[] = {
    {"serialize", FAST(native_serialize), "serialize($module, message)\n--\n\nSee ifgen_runtime.codec."},
    {"deserialize", FAST(native_deserialize), "deserialize($module, data, cls)\n--\n\nSee ifgen_runtime.codec."},
    {"codec_open", native_open, METH_VARARGS, "Say why the codec cannot run in this interpreter, or None; take what handles other objects."},
    {"codec_attach", native_attach, METH_VARARGS, "Give a class its codec; its __serialize__ and __deserialize__."},
    {"codec_viewer", native_viewer, METH_VARARGS, "The function that reads messages of a class with views; of a class without a codec, the given one."},
    {"codec_methods", native_codec_methods, METH_O, "The __eq__, __deepcopy__ and __copy__ of a class that has a codec."},
    {"codec_packer", native_packer, METH_O, "Like the __serialize__ of a class that has a codec, but messages with large arrays become parcels: bytes() makes their bytes, and __deserialize__ takes them, once."},
    {"codec_large_in_parcels", native_large_in_parcels, METH_O, "For tests: set from how many bytes on an array is large, and return what it was."},
    {"codec_array", (PyCFunction)(void (*)(void))native_array, METH_FASTCALL, "array.array(typecode, values), in less time."},
    {"codec_counts", native_counts, METH_NOARGS, "How many messages C has written and read, and how many it left to Python."},
    {NULL, NULL, 0, NULL},
};
