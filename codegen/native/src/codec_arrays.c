/* Sequences of numbers: array.array. */
#include "codec_numbers.h"
#include "codec_wire.h"

static PyTypeObject *array_type;
static PyObject *single_elements[NUMBER_COUNT]; /* an array.array of one zero: times n, it is one of n elements */
static PyObject *frombytes;

bool numbers_write(codec_buffer *buffer, PyObject *owner, const void *numbers, number_type type, size_t count) {
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
    outcome = buffer_count(buffer, count, 0) && (!count || numbers_write(buffer, value, view.buf, type, count)) ? CODEC_DONE : CODEC_ERROR;
  }
  PyBuffer_Release(&view);
  return outcome;
}

codec_outcome sequence_read(payload *from, number_type type, size_t count, PyObject **made) {
  const size_t size = count * number_sizes[type];
  const uint8_t *start = payload_take(from, size, count ? number_sizes[type] : 1);
  if (!start) return CODEC_UNUSUAL;
  if (from->viewed) return view_read(from, type, count, start, made);
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
