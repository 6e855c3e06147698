/* `copy.copy` and `copy.deepcopy` of messages. They mean what the generated `__deepcopy__` means: whatever was copied is in
 * the memo, so that what is there twice is copied once. Values that are not of the type that a field should hold are
 * copied by Python (ifgen_runtime.copying). That runs code of users, which may find a copy with slots that are still
 * empty, as it may with the generated function: each slot is filled by one assignment, and messages are held meanwhile. */
#include "codec_registers.h"

/* The functions of ifgen_runtime.copying. */
static PyObject *copied_odd, *copied_odd_list, *copied_array;

typedef struct {
  PyObject *memo;
  bool is_known; /* the memo began empty and no other code has seen it: nothing is in it but what we have put there */
} copying;

/* ---- the memo ---- */

/* Whether nobody but its slot or list refers to an object: then it cannot be met again, and the memo needs no entry. */
static bool is_alone(const copying *c, PyObject *object) { return c->is_known && Py_REFCNT(object) == 1; }

/* The copy in the memo: a new reference. NULL without an error if there is none. */
static PyObject *remembered(const copying *c, PyObject *object) {
  PyObject *key = PyLong_FromVoidPtr(object);
  PyObject *copy = key ? PyDict_GetItemWithError(c->memo, key) : NULL; /* its keys are integers */
  Py_XDECREF(key);
  if (copy == Py_None) copy = NULL; /* as memo.get() says that there is none */
  Py_XINCREF(copy);
  return copy;
}

static bool remember(const copying *c, PyObject *object, PyObject *copy) {
  PyObject *key = PyLong_FromVoidPtr(object);
  bool kept = key && !PyDict_SetItem(c->memo, key, copy);
  Py_XDECREF(key);
  return kept;
}

/* Copy by a function of ifgen_runtime.copying. */
static PyObject *copy_by(PyObject *function, copying *c, PyObject *value, const void *cls) {
  c->is_known = false;
  return PyObject_CallFunctionObjArgs(function, value, cls ? (PyObject *)cls : c->memo, cls ? c->memo : NULL, NULL);
}

/* ---- values ---- */

static const void *class_of(number_type type) {
  switch (type) {
    case NUMBER_BOOLEAN: return &PyBool_Type;
    case NUMBER_OCTET: return &PyBytes_Type;
    case NUMBER_CHAR: return &PyUnicode_Type;
    case NUMBER_FLOAT32: case NUMBER_FLOAT64: return &PyFloat_Type;
    default: return &PyLong_Type;
  }
}

static PyObject *copy_value(copying *c, PyObject *value, const void *cls) {
  if (Py_TYPE(value) != cls) return copy_by(copied_odd, c, value, cls);
  Py_INCREF(value);
  return value;
}

/* The elements of a list, if all are of a class whose objects cannot change: shared. NULL without an error if not. */
static PyObject *share_elements(PyObject *list, const void *cls) {
  if (!PyList_CheckExact(list)) return NULL;
  Py_ssize_t size = PyList_Size(list);
  for (Py_ssize_t i = 0; i < size; i++)
    if (Py_TYPE(PyList_GetItem(list, i)) != cls) return NULL;
  return PyList_GetSlice(list, 0, size);
}

/* A list of what cannot change (`cls`), or an array of numbers (NULL). `alone` says that only its slot refers to it. */
static PyObject *copy_plain(const row *r, copying *c, PyObject *value, const void *cls, bool alone) {
  PyObject *copy = alone ? NULL : remembered(c, value);
  if (copy || PyErr_Occurred()) return copy;
  copy = cls ? share_elements(value, cls) : r->kind == ROW_ARRAY ? array_copy(value, r->number) : sequence_copy(value);
  if (PyErr_Occurred()) return NULL;
  if (!copy) return cls ? copy_by(copied_odd_list, c, value, cls) : copy_by(copied_array, c, value, NULL);
  if (!alone && !remember(c, value, copy)) Py_CLEAR(copy);
  return copy;
}

/* ---- messages ---- */

static bool copy_rows(const row *rows, uint32_t count, copying *, registers *);
static bool copy_message(const codec *, copying *, PyObject *message, PyObject *copy);

static PyObject *new_message(const void *cls) { return PyType_GenericAlloc((PyTypeObject *)cls, 0); }

/* Begin the copy of a message of the row's class: its copy, a new reference. If it was copied before, `*is_complete`. */
static PyObject *begin(const row *r, copying *c, PyObject *message, bool alone, bool *is_complete) {
  *is_complete = false;
  if (alone) return new_message(r->cls);
  PyObject *copy = remembered(c, message);
  *is_complete = copy != NULL;
  if (copy || PyErr_Occurred()) return copy;
  copy = new_message(r->cls);
  if (copy && remember(c, message, copy)) return copy;
  Py_XDECREF(copy);
  return NULL;
}

/* A message in a slot. The rows that follow fill its copy in. */
static PyObject *enter(const row *r, copying *c, PyObject *value, bool alone, registers *held) {
  bool is_complete = true;
  PyObject *copy = Py_TYPE(value) == r->cls ? begin(r, c, value, alone, &is_complete) : copy_by(copied_odd, c, value, r->cls);
  if (!copy || is_complete) registers_set(held, r->target, NULL, NULL);
  else registers_set(held, r->target, value, copy);
  return copy;
}

/* An element of a list of messages: like one in a slot, and then its rows. */
static PyObject *copy_element(const row *r, copying *c, PyObject *value, bool alone, registers *held) {
  PyObject *copy = enter(r, c, value, alone, held);
  if (copy && registers_left(held, r->target) && !copy_rows(r + 1, r->rows, c, held)) {
    Py_DECREF(copy);
    return NULL;
  }
  return copy;
}

/* The copies of the elements of a list, which code of users may change meanwhile. */
static PyObject *copy_elements(const row *r, copying *c, PyObject *list, registers *held) {
  PyObject *copies = PyList_New(0);
  for (Py_ssize_t i = 0; copies && i < PyList_Size(list); i++) {
    PyObject *value = PyList_GetItem(list, i);
    bool alone = is_alone(c, value);
    Py_INCREF(value);
    PyObject *copy = copy_element(r, c, value, alone, held);
    Py_DECREF(value);
    if (!copy || PyList_Append(copies, copy) < 0) Py_CLEAR(copies);
    Py_XDECREF(copy);
  }
  return copies;
}

static PyObject *copy_list(const row *r, copying *c, PyObject *list, bool alone, registers *held) {
  if (!PyList_CheckExact(list)) return copy_by(copied_odd_list, c, list, r->cls);
  if (alone) return copy_elements(r, c, list, held);
  PyObject *copy = remembered(c, list);
  if (copy || PyErr_Occurred()) return copy;
  copy = PyList_New(0);
  PyObject *copies = copy && remember(c, list, copy) ? copy_elements(r, c, list, held) : NULL;
  Py_ssize_t size = copies ? PyList_Size(copy) : 0; /* not 0 if somebody has found it in the memo */
  if (!copies || PyList_SetSlice(copy, size, size, copies) < 0) Py_CLEAR(copy);
  Py_XDECREF(copies);
  return copy;
}

static PyObject *copy_slot(const row *r, copying *c, PyObject *value, bool alone, registers *held) {
  switch (r->kind) {
    case ROW_ENTER: return enter(r, c, value, alone, held);
    case ROW_REPEAT: return copy_list(r, c, value, alone, held);
    case ROW_VALUE: return copy_value(c, value, class_of(r->number));
    case ROW_TEXT: case ROW_WTEXT: return copy_value(c, value, &PyUnicode_Type);
    case ROW_ARRAY: return copy_plain(r, c, value, NULL, alone);
    case ROW_VALUES: return copy_plain(r, c, value, r->number >= NUMBER_INT8 ? NULL : class_of(r->number), alone);
    default: return copy_plain(r, c, value, &PyUnicode_Type, alone);
  }
}

static void fill(PyObject **slot, PyObject *value) {
  PyObject *old = *slot; /* NULL, unless somebody has found the copy in the memo */
  *slot = value;
  Py_XDECREF(old);
}

/* Run rows. False with a Python error. */
static bool copy_rows(const row *rows, uint32_t count, copying *c, registers *held) {
  for (const row *r = rows; r < rows + count; r += r->kind == ROW_REPEAT ? r->rows + 1 : 1) {
    if (r->kind == ROW_RUN || r->kind == ROW_BLANK) continue;
    if (!registers_left(held, r->message)) {
      if (r->kind == ROW_ENTER) registers_set(held, r->target, NULL, NULL);
      continue;
    }
    PyObject *message = registers_left(held, r->message), *into = registers_right(held, r->message);
    if (r->kind == ROW_CALL) {
      if (!copy_message(r->called, c, message, into)) return false;
      continue;
    }
    PyObject *found = *slot_of(message, r);
    bool alone = found && is_alone(c, found);
    PyObject *value = slot_value(message, r), *copy = value ? copy_slot(r, c, value, alone, held) : NULL;
    Py_XDECREF(value);
    if (!copy) return false;
    fill(slot_of(into, r), copy);
  }
  return true;
}

static bool copy_message(const codec *it, copying *c, PyObject *message, PyObject *copy) {
  registers held;
  if (!registers_start(&held, &it->table)) return false;
  registers_set(&held, 0, message, copy);
  bool copied = copy_rows(it->table.rows, it->table.row_count, c, &held);
  registers_end(&held);
  return copied;
}

PyObject *codec_deepcopy(const codec *it, PyObject *message, PyObject *memo) {
  arrays_try_again();
  copying c = {memo, PyDict_Size(memo) == 0};
  PyObject *copy = c.is_known ? NULL : remembered(&c, message);
  if (copy || PyErr_Occurred()) return copy;
  copy = new_message(it->cls);
  if (copy && remember(&c, message, copy) && copy_message(it, &c, message, copy)) return copy;
  Py_XDECREF(copy);
  return NULL;
}

PyObject *codec_copy(const codec *it, PyObject *message) {
  PyObject *copy = new_message(it->cls);
  for (const row *r = it->table.rows; copy && r < it->table.rows + it->table.row_count; r++) {
    if (r->message || !r->offset) continue;
    PyObject *value = *slot_of(message, r);
    Py_XINCREF(value);
    *slot_of(copy, r) = value;
  }
  return copy;
}

bool codec_copy_open(PyObject *copying) {
  copied_odd = PyObject_GetAttrString(copying, "copied_odd");
  copied_odd_list = copied_odd ? PyObject_GetAttrString(copying, "copied_odd_list") : NULL;
  copied_array = copied_odd_list ? PyObject_GetAttrString(copying, "copied_array") : NULL;
  return copied_array;
}
