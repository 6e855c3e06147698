/* `==` of messages. Means what the generated `__eq__` means: fields in their order, until two differ. What is not of the
 * type that a field should hold is compared as Python does it; that runs code of users, so messages are held meanwhile. */
#include "codec_registers.h"

#include <string.h>

/* What became of a comparison. */
typedef enum { EQUAL, DIFFERENT, FAILED /* with a Python error */ } verdict;

static verdict negated(PyObject *differ) {
  int is = differ ? PyObject_IsTrue(differ) : -1;
  Py_XDECREF(differ);
  return is < 0 ? FAILED : is ? DIFFERENT : EQUAL;
}

/* `one != other` in Python. */
static verdict compare_any(PyObject *one, PyObject *other) { return negated(PyObject_RichCompare(one, other, Py_NE)); }

/* `memoryview(one) != memoryview(other)` in Python. */
static verdict compare_views(PyObject *one, PyObject *other) {
  PyObject *left = PyMemoryView_FromObject(one), *right = left ? PyMemoryView_FromObject(other) : NULL;
  verdict found = right ? compare_any(left, right) : FAILED;
  Py_XDECREF(left);
  Py_XDECREF(right);
  return found;
}

static bool same_floats(const float *one, const float *other, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (one[i] != other[i]) return false;
  return true;
}

static bool same_doubles(const double *one, const double *other, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (one[i] != other[i]) return false;
  return true;
}

/* Two buffers of one dimension, with elements of the same type: `*same`. False for others, which Python compares. */
static bool compare_buffers(const Py_buffer *one, const Py_buffer *other, bool *same) {
  const char format = one->format ? one->format[0] : 'B';
  if (one->ndim != 1 || other->ndim != 1 || !strchr("bBhHiIlLqQfd", format)) return false;
  if (one->format && (one->format[1] || !other->format || strcmp(one->format, other->format))) return false;
  if (!one->format && other->format) return false;
  const size_t count = (size_t)(one->len / one->itemsize);
  *same = one->len == other->len;
  if (!*same || !count) return true;
  if (format == 'f') *same = same_floats(one->buf, other->buf, count);
  else if (format == 'd') *same = same_doubles(one->buf, other->buf, count);
  else *same = memcmp(one->buf, other->buf, (size_t)one->len) == 0;
  return true;
}

/* Two arrays of numbers that are compared as memory: those of floats, where a NaN differs from itself, and numpy arrays. */
static verdict compare_arrays(PyObject *one, PyObject *other) {
  Py_buffer left, right;
  bool same = false, known = false;
  if (!PyObject_GetBuffer(one, &left, PyBUF_ND | PyBUF_FORMAT)) {
    if (!PyObject_GetBuffer(other, &right, PyBUF_ND | PyBUF_FORMAT)) {
      known = compare_buffers(&left, &right, &same);
      PyBuffer_Release(&right);
    }
    PyBuffer_Release(&left);
  }
  if (known) return same ? EQUAL : DIFFERENT;
  PyErr_Clear();
  return compare_views(one, other);
}

static PyObject *unequal; /* of ifgen_runtime.copying */

bool codec_equal_open(PyObject *copying) { return (unequal = PyObject_GetAttrString(copying, "unequal")); }

/* Two sequences of numbers. */
static verdict compare_sequences(const row *r, PyObject *one, PyObject *other) {
  bool are_floats = r->number == NUMBER_FLOAT32 || r->number == NUMBER_FLOAT64;
  if (are_floats || (is_sequence(one) && is_sequence(other))) return compare_arrays(one, other);
  return negated(PyObject_CallFunctionObjArgs(unequal, one, other, NULL));
}

/* Two values that are neither messages nor collections. A NaN differs from itself. */
static verdict compare_values(PyObject *one, PyObject *other) {
  if (PyFloat_CheckExact(one) && PyFloat_CheckExact(other)) return PyFloat_AsDouble(one) == PyFloat_AsDouble(other) ? EQUAL : DIFFERENT;
  if (one == other && (PyUnicode_CheckExact(one) || PyLong_CheckExact(one) || PyBool_Check(one) || PyBytes_CheckExact(one))) return EQUAL;
  return compare_any(one, other);
}

static verdict compare_rows(const row *rows, uint32_t count, registers *);
static verdict compare_messages(const codec *, PyObject *one, PyObject *other);

/* Two elements of lists of messages. Lists take an object for equal to itself. */
static verdict compare_elements(const row *r, PyObject *one, PyObject *other, registers *held) {
  if (one == other) return EQUAL;
  if (Py_TYPE(one) != r->cls || Py_TYPE(other) != r->cls) {
    int same = PyObject_RichCompareBool(one, other, Py_EQ);
    return same < 0 ? FAILED : same ? EQUAL : DIFFERENT;
  }
  registers_set(held, r->target, one, other);
  return compare_rows(r + 1, r->rows, held);
}

/* Two lists of messages. Code of users may change them while they are compared. */
static verdict compare_lists(const row *r, PyObject *one, PyObject *other, registers *held) {
  if (!PyList_CheckExact(one) || !PyList_CheckExact(other)) return compare_any(one, other);
  if (PyList_Size(one) != PyList_Size(other)) return DIFFERENT;
  for (Py_ssize_t i = 0; i < PyList_Size(one) && i < PyList_Size(other); i++) {
    PyObject *left = PyList_GetItem(one, i), *right = PyList_GetItem(other, i);
    Py_INCREF(left);
    Py_INCREF(right);
    verdict found = compare_elements(r, left, right, held);
    Py_DECREF(left);
    Py_DECREF(right);
    if (found != EQUAL) return found;
  }
  return PyList_Size(one) == PyList_Size(other) ? EQUAL : DIFFERENT;
}

/* Two messages in a slot: as the messages of a number, if both are of its class. */
static verdict enter(const row *r, PyObject *one, PyObject *other, registers *held) {
  bool known = Py_TYPE(one) == r->cls && Py_TYPE(other) == r->cls;
  if (!known) {
    registers_set(held, r->target, NULL, NULL);
    return compare_any(one, other);
  }
  registers_set(held, r->target, one, other);
  return EQUAL;
}

static verdict compare_slots(const row *r, PyObject *one, PyObject *other, registers *held) {
  switch (r->kind) {
    case ROW_ENTER: return enter(r, one, other, held);
    case ROW_REPEAT: return compare_lists(r, one, other, held);
    case ROW_VALUE: case ROW_TEXT: case ROW_WTEXT: return compare_values(one, other);
    case ROW_ARRAY: return compare_arrays(one, other);
    case ROW_VALUES: return r->number >= NUMBER_INT8 ? compare_sequences(r, one, other) : compare_any(one, other);
    default: return compare_any(one, other);
  }
}

/* Run rows. */
static verdict compare_rows(const row *rows, uint32_t count, registers *held) {
  verdict found = EQUAL;
  for (const row *r = rows; found == EQUAL && r < rows + count; r += r->kind == ROW_REPEAT ? r->rows + 1 : 1) {
    if (r->kind == ROW_RUN || r->kind == ROW_BLANK) continue;
    if (!registers_left(held, r->message)) {
      if (r->kind == ROW_ENTER) registers_set(held, r->target, NULL, NULL);
      continue;
    }
    PyObject *left = registers_left(held, r->message), *right = registers_right(held, r->message);
    if (r->kind == ROW_CALL) {
      found = compare_messages(r->called, left, right);
      continue;
    }
    PyObject *one = slot_value(left, r), *other = one ? slot_value(right, r) : NULL;
    found = other ? compare_slots(r, one, other, held) : FAILED;
    Py_XDECREF(one);
    Py_XDECREF(other);
  }
  return found;
}

static verdict compare_messages(const codec *it, PyObject *one, PyObject *other) {
  registers held;
  if (!registers_start(&held, &it->table)) return FAILED;
  registers_set(&held, 0, one, other);
  verdict found = compare_rows(it->table.rows, it->table.row_count, &held);
  registers_end(&held);
  return found;
}

PyObject *codec_equal(const codec *it, PyObject *message, PyObject *other) {
  if (Py_TYPE(other) != it->cls) Py_RETURN_FALSE;
  verdict found = compare_messages(it, message, other);
  return found == FAILED ? NULL : PyBool_FromLong(found == EQUAL);
}
