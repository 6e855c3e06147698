/* Arrays and sequences of numbers: numpy arrays, array.array. numpy is asked for the first time when a message has an
 * array, since importing it takes longer than everything else. */
#include "codec_numbers.h"
#include "codec_wire.h"

/* The public part of numpy's array objects: a part of its binary interface, since code compiled with its headers contains
 * it. Checked below all the same. */
typedef struct {
  PyObject_HEAD
  char *data;
  int nd;
  Py_ssize_t *dimensions, *strides;
  PyObject *base;
  PyObject *descr;
  int flags;
} numpy_array;

enum { C_CONTIGUOUS = 1 };

static const char *const dtype_names[NUMBER_COUNT] = {
    [NUMBER_INT8] = "int8",     [NUMBER_UINT8] = "uint8",   [NUMBER_INT16] = "int16",     [NUMBER_UINT16] = "uint16",
    [NUMBER_INT32] = "int32",   [NUMBER_UINT32] = "uint32", [NUMBER_INT64] = "int64",     [NUMBER_UINT64] = "uint64",
    [NUMBER_FLOAT32] = "float32", [NUMBER_FLOAT64] = "float64"};

static enum { UNTRIED, WANTED, KNOWN, UNUSABLE } numpy_state;
static PyTypeObject *numpy_type;
static PyObject *numpy_empty, *dtypes[NUMBER_COUNT];

static PyTypeObject *array_type;
static PyObject *single_elements[NUMBER_COUNT]; /* an array.array of one zero: times n, it is one of n elements */
static PyObject *frombytes;

/* Whether array objects are laid out as declared: look at a 2 x 3 array and its transpose. */
static bool is_known_layout(void) {
  PyObject *whole = PyObject_CallFunction(numpy_empty, "(ii)O", 2, 3, dtypes[NUMBER_FLOAT64]);
  PyObject *turned = whole ? PyObject_GetAttrString(whole, "T") : NULL;
  PyObject *interface = whole ? PyObject_GetAttrString(whole, "__array_interface__") : NULL;
  PyObject *data = interface && PyDict_Check(interface) ? PyDict_GetItemString(interface, "data") : NULL; /* borrowed */
  PyObject *address = data ? PySequence_GetItem(data, 0) : NULL;
  bool known = false;
  if (turned && address && Py_TYPE(whole) == numpy_type) {
    const numpy_array *a = (numpy_array *)(void *)whole, *t = (numpy_array *)(void *)turned;
    known = a->descr == dtypes[NUMBER_FLOAT64] && t->descr == a->descr && a->data == PyLong_AsVoidPtr(address) &&
            t->data == a->data && a->nd == 2 && t->nd == 2 && t->base == whole && !a->base && a->dimensions[0] == 2 &&
            a->dimensions[1] == 3 && a->strides[0] == 24 && a->strides[1] == 8 && t->dimensions[0] == 3 &&
            (a->flags & C_CONTIGUOUS) && !(t->flags & C_CONTIGUOUS);
  }
  Py_XDECREF(whole);
  Py_XDECREF(turned);
  Py_XDECREF(interface);
  Py_XDECREF(address);
  return known;
}

static bool find_numpy(void) {
  PyObject *numpy = PyImport_ImportModule("numpy");
  numpy_type = numpy ? (PyTypeObject *)PyObject_GetAttrString(numpy, "ndarray") : NULL;
  numpy_empty = numpy_type ? PyObject_GetAttrString(numpy, "empty") : NULL;
  bool sound = numpy_empty && PyType_Check((PyObject *)numpy_type);
  for (int type = NUMBER_INT8; sound && type < NUMBER_COUNT; type++)
    sound = (dtypes[type] = PyObject_CallMethod(numpy, "dtype", "s", dtype_names[type])) != NULL;
  sound = sound && is_known_layout();
  Py_XDECREF(numpy);
  PyErr_Clear(); /* the generated functions say what is wrong with numpy */
  return sound;
}

bool arrays_try_again(void) {
  if (numpy_state != WANTED) return false;
  numpy_state = find_numpy() ? KNOWN : UNUSABLE;
  return numpy_state == KNOWN;
}

static bool knows_numpy(void) {
  if (numpy_state == UNTRIED) numpy_state = WANTED;
  return numpy_state == KNOWN;
}

/* The elements of a numpy array of exactly this type, in order; NULL where it is something else. */
static const numpy_array *as_numpy(PyObject *value, number_type type, size_t *count) {
  const numpy_array *array = (numpy_array *)(void *)value;
  if (!knows_numpy() || Py_TYPE(value) != numpy_type || array->descr != dtypes[type] || !(array->flags & C_CONTIGUOUS)) return NULL;
  *count = 1;
  for (int i = 0; i < array->nd; i++) *count *= (size_t)array->dimensions[i];
  return array;
}

/* Large ones are not copied yet, but noted. */
static bool write_numbers(codec_buffer *buffer, PyObject *owner, const void *numbers, number_type type, size_t count) {
  const size_t size = count * number_sizes[type];
  const bool is_noted = size > buffer->large && buffer->piece_count < CODEC_PIECES;
  if (!buffer_reserve(buffer, is_noted ? 7 : 7 + size)) return false;
  buffer_align(buffer, number_sizes[type]);
  if (is_noted) {
    const int piece = buffer->piece_count++;
    buffer->pieces[piece].owner = owner;
    buffer->pieces[piece].data = numbers;
    buffer->pieces[piece].size = size;
    buffer->pieces[piece].before = buffer->used;
    buffer->lent += size;
  } else {
    memcpy(buffer->data + buffer->used, numbers, size);
    buffer->used += size;
  }
  return true;
}

codec_outcome array_write(codec_buffer *buffer, PyObject *value, number_type type, size_t count) {
  size_t found;
  const numpy_array *array = as_numpy(value, type, &found);
  if (!array || found != count) return CODEC_UNUSUAL;
  return write_numbers(buffer, value, array->data, type, count) ? CODEC_DONE : CODEC_ERROR;
}

/* A numpy array of its own, not filled. */
static numpy_array *new_array(number_type type, size_t count) {
  PyObject *number = PyLong_FromSize_t(count);
  PyObject *made = number ? PyObject_CallFunctionObjArgs(numpy_empty, number, dtypes[type], NULL) : NULL;
  Py_XDECREF(number);
  return (numpy_array *)(void *)made;
}

PyObject *array_copy(PyObject *value, number_type type) {
  size_t count;
  const numpy_array *array = as_numpy(value, type, &count);
  if (!array || array->nd != 1) return NULL;
  numpy_array *made = new_array(type, count);
  if (made) memcpy(made->data, array->data, count * number_sizes[type]);
  return (PyObject *)made;
}

codec_outcome array_read(payload *from, number_type type, size_t count, PyObject **made) {
  const size_t size = count * number_sizes[type];
  const uint8_t *start = payload_take(from, size, number_sizes[type]);
  if (!start || !knows_numpy()) return CODEC_UNUSUAL;
  numpy_array *array = new_array(type, count);
  if (!array) return codec_failed();
  memcpy(array->data, start, size);
  *made = (PyObject *)array;
  return CODEC_DONE;
}

/* array.array is C and built in or a part of the standard library: nothing of a user's runs. */
static bool know_array(number_type type) {
  if (single_elements[type]) return true;
  PyObject *module = array_type ? NULL : PyImport_ImportModule("array");
  if (module) array_type = (PyTypeObject *)PyObject_GetAttrString(module, "array");
  Py_XDECREF(module);
  if (array_type && !frombytes) frombytes = PyUnicode_InternFromString("frombytes");
  if (array_type && frombytes) single_elements[type] = PyObject_CallFunction((PyObject *)array_type, "C[i]", number_letters[type], 0);
  return single_elements[type];
}

bool is_sequence(PyObject *value) {
  if (!know_array(NUMBER_UINT8)) return PyErr_Clear(), false;
  return Py_TYPE(value) == array_type;
}

PyObject *sequence_copy(PyObject *value) {
  return is_sequence(value) ? PySequence_GetSlice(value, 0, PY_SSIZE_T_MAX) : NULL;
}

/* Write the items of a list or a tuple to memory. Returns how many come before the first that is not exactly a float or an
 * int that fits. Inlined for each type that is worth it. */
static inline Py_ssize_t write_items(uint8_t *to, number_type type, PyObject *values, Py_ssize_t count) {
  const bool is_list = Py_IS_TYPE(values, &PyList_Type);
  Py_ssize_t i = 0;
  for (; i < count; i++, to += number_sizes[type])
    if (!number_write(to, type, is_list ? PyList_GetItem(values, i) : PyTuple_GetItem(values, i))) break;
  return i;
}

static bool fill_with_items(PyObject *array, number_type type, PyObject *values, Py_ssize_t count) {
  Py_buffer view;
  if (PyObject_GetBuffer(array, &view, PyBUF_WRITABLE)) return PyErr_Clear(), false;
  const Py_ssize_t written = type == NUMBER_FLOAT64 ? write_items(view.buf, NUMBER_FLOAT64, values, count)
                                                    : write_items(view.buf, type, values, count);
  PyBuffer_Release(&view);
  return written == count;
}

PyObject *sequence_of_items(PyObject *typecode, PyObject *values) {
  const char *letter = strchr(number_letters + NUMBER_INT8, (int)PyUnicode_ReadChar(typecode, 0));
  const number_type type = letter && *letter ? (number_type)(letter - number_letters) : NUMBER_INT8;
  if (!know_array(type)) return NULL;
  if (letter && *letter && (Py_IS_TYPE(values, &PyList_Type) || Py_IS_TYPE(values, &PyTuple_Type))) {
    const Py_ssize_t count = PySequence_Size(values);
    PyObject *made = PySequence_Repeat(single_elements[type], count);
    if (!made || fill_with_items(made, type, values, count)) return made;
    Py_DECREF(made);
  }
  return PyObject_CallFunctionObjArgs((PyObject *)array_type, typecode, values, NULL);
}

static bool fits(const row *r, size_t count) {
  return r->size ? count == r->size : count <= (r->maximum ? r->maximum : UINT32_MAX);
}

codec_outcome sequence_write(codec_buffer *buffer, PyObject *value, const row *r) {
  const number_type type = r->number;
  if (!know_array(type)) return codec_failed();
  Py_buffer view;
  if (Py_TYPE(value) != array_type) return CODEC_UNUSUAL;
  if (PyObject_GetBuffer(value, &view, PyBUF_FORMAT)) return codec_failed();
  const size_t count = (size_t)view.len / number_sizes[type];
  codec_outcome outcome = CODEC_UNUSUAL;
  if (view.format[0] == number_letters[type] && view.itemsize == number_sizes[type] && fits(r, count)) {
    outcome = buffer_count(buffer, count, 0) && (!count || write_numbers(buffer, value, view.buf, type, count)) ? CODEC_DONE : CODEC_ERROR;
  }
  PyBuffer_Release(&view);
  return outcome;
}

static PyObject *view_class;

void codec_view_class(PyObject *cls) {
  PyObject *old = view_class;
  Py_INCREF(cls);
  view_class = cls;
  Py_XDECREF(old);
}

/* numpy makes an object of the class, which has no constructor in Python. It keeps the payload alive. */
static codec_outcome view(const payload *from, number_type type, size_t count, const uint8_t *start, PyObject **made) {
  if (!knows_numpy()) return CODEC_UNUSUAL;
  *made = PyObject_CallFunction(view_class, "nOOn", (Py_ssize_t)count, dtypes[type], from->viewed, (Py_ssize_t)(start - from->data));
  return *made ? CODEC_DONE : codec_failed();
}

codec_outcome sequence_read(payload *from, number_type type, size_t count, PyObject **made) {
  const size_t size = count * number_sizes[type];
  const uint8_t *start = payload_take(from, size, count ? number_sizes[type] : 1);
  if (!start) return CODEC_UNUSUAL;
  if (from->viewed) return view(from, type, count, start, made);
  if (!know_array(type)) return codec_failed();
  const bool is_large = size > CODEC_LARGE;
  *made = PySequence_Repeat(single_elements[type], is_large ? 0 : (Py_ssize_t)count);
  if (!*made) return codec_failed();
  if (is_large) {
    PyObject *view = PyMemoryView_FromMemory((char *)(uintptr_t)start, (Py_ssize_t)size, PyBUF_READ);
    PyObject *nothing = view ? PyObject_CallMethodObjArgs(*made, frombytes, view, NULL) : NULL;
    Py_XDECREF(view);
    if (nothing) return Py_DECREF(nothing), CODEC_DONE;
  } else {
    Py_buffer view;
    if (!PyObject_GetBuffer(*made, &view, PyBUF_WRITABLE)) {
      memcpy(view.buf, start, size);
      PyBuffer_Release(&view);
      return CODEC_DONE;
    }
  }
  Py_CLEAR(*made);
  return codec_failed();
}
