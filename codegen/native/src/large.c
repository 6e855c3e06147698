#include "large.h"

#include <string.h>
#include <time.h>

#include "native.h"

enum {
  LARGE = 32 << 10, /* bytes: below, a copy costs no more than what avoids it */
  SHELF = 8,
  MOST_SHELVED = 64 << 20, /* bytes in all */
};
static const long long IDLE = 10000000000; /* [ns]; an array that nobody used for so long is freed when the next message comes */

/* Arrays that decoded messages got. Where the reference here is the only one left, the message is gone, and the array
 * may serve again. All of it needs the GIL. */
static struct {
  const message_type *type;
  uint32_t row;
  PyObject *array, *path;
  size_t size; /* when it was shelved; its user may have changed it since */
  long long used; /* when it last waited [ns] */
} shelf[SHELF];
static int shelved;

static long long nanoseconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1000000000LL + now.tv_nsec;
}

static void unshelve(int i) {
  PyObject *array = shelf[i].array, *path = shelf[i].path;
  shelf[i] = shelf[--shelved];
  Py_DECREF(array);
  Py_DECREF(path);
}

static void unshelve_idle(long long now) {
  for (int i = shelved - 1; i >= 0; i--)
    if (now - shelf[i].used > IDLE) unshelve(i);
}

/* Adds an array, in place of those that were used longest ago where there is too much. */
static void shelve(const message_type *type, uint32_t row, PyObject *array, PyObject *path, size_t size) {
  if (size > MOST_SHELVED) return;
  for (;;) {
    size_t total = size;
    int oldest = 0;
    for (int i = 0; i < shelved; i++) {
      total += shelf[i].size;
      if (shelf[i].used < shelf[oldest].used) oldest = i;
    }
    if (total <= MOST_SHELVED && shelved < SHELF) break;
    unshelve(oldest);
  }
  Py_INCREF(array);
  Py_INCREF(path);
  shelf[shelved].type = type;
  shelf[shelved].row = row;
  shelf[shelved].array = array;
  shelf[shelved].path = path;
  shelf[shelved].size = size;
  shelf[shelved].used = nanoseconds();
  shelved++;
}

void large_prepare(large_arrays *self, const message_type *type) {
  if (!shelved) return;
  const long long now = nanoseconds();
  unshelve_idle(now);
  for (int i = 0; i < shelved && self->count < LARGE_WAITING; i++) {
    if (shelf[i].type != type || Py_REFCNT(shelf[i].array) != 1) continue;
    Py_buffer view;
    if (PyObject_GetBuffer(shelf[i].array, &view, PyBUF_WRITABLE) < 0) {
      PyErr_Clear();
      continue;
    }
    self->waiting[self->count++] = (waiting_array){shelf[i].array, shelf[i].path, shelf[i].row, view.buf, (size_t)view.len};
    Py_INCREF(shelf[i].array);
    Py_INCREF(shelf[i].path);
    PyBuffer_Release(&view);
    shelf[i].used = now;
  }
}

static const waiting_array *find(const large_arrays *self) {
  for (unsigned i = 0; i < self->count; i++)
    if (self->waiting[i].row == self->longest.row && self->waiting[i].size == self->longest.size) return &self->waiting[i];
  return NULL;
}

static bool append(block *to, const char *bytes, size_t size) {
  if (!block_reserve(to, to->size + size)) return false;
  memcpy(to->data + to->size, bytes, size);
  to->size += size;
  return true;
}

bool large_receive(large_arrays *self, block *to, const char *payload, size_t size) {
  const layout_sequence *longest = &self->longest;
  self->filled = longest->size >= LARGE ? find(self) : NULL;
  to->size = 0;
  if (!self->filled) return append(to, payload, size);
  /* At least one, since nothing is aligned where nothing follows; then eight bytes more or less change no alignment. */
  const uint32_t each_8 = (uint32_t)(8 / longest->value_size), count = (uint32_t)(longest->size / longest->value_size);
  const uint32_t kept = (count - 1) % each_8 + 1;
  const size_t end = longest->values_at + longest->size, kept_size = kept * longest->value_size;
  if (!block_reserve(to, size - longest->size + kept_size)) return false;
  append(to, payload, longest->values_at + kept_size);
  append(to, payload + end, size - end);
  memcpy(to->data + longest->count_at, &kept, sizeof kept);
  memcpy(self->filled->memory, payload + longest->values_at, longest->size);
  return true;
}

/* The names of the slots from the message to a row of its table. NULL with a Python error. */
static PyObject *path_of(const message_type *type, const row *r) {
  const row *rows = layout_rows(&type->layout);
  PyObject *path = PyList_New(0);
  for (const row *enter = r; path; r = enter) {
    PyObject *name = PyUnicode_FromStringAndSize(type->text + r->name, (Py_ssize_t)r->name_size);
    if (!name || PyList_Insert(path, 0, name) < 0) Py_CLEAR(path);
    Py_XDECREF(name);
    if (!r->message) break;
    for (enter = rows; enter->kind != ROW_ENTER || enter->target != r->message;) enter++;
  }
  PyObject *tuple = path ? PyList_AsTuple(path) : NULL;
  Py_XDECREF(path);
  return tuple;
}

/* The object that has the last slot of a path. New reference, NULL with a Python error. */
static PyObject *owner_of(PyObject *path, PyObject *message) {
  Py_INCREF(message);
  for (Py_ssize_t i = 0; message && i + 1 < PyTuple_Size(path); i++) {
    PyObject *inner = PyObject_GetAttr(message, PyTuple_GetItem(path, i));
    Py_DECREF(message);
    message = inner;
  }
  return message;
}

static PyObject *last_of(PyObject *path) { return PyTuple_GetItem(path, PyTuple_Size(path) - 1); }

/* Where a message has an array of the longest sequence, it is there for the next one. */
static bool remember(const large_arrays *self, const message_type *type, PyObject *message) {
  PyObject *path = path_of(type, layout_rows(&type->layout) + self->longest.row);
  PyObject *owner = path ? owner_of(path, message) : NULL;
  PyObject *array = owner ? PyObject_GetAttr(owner, last_of(path)) : NULL;
  Py_buffer view;
  if (array && PyObject_GetBuffer(array, &view, PyBUF_WRITABLE) == 0) {
    if ((size_t)view.len == self->longest.size) shelve(type, self->longest.row, array, path, self->longest.size);
    PyBuffer_Release(&view);
  }
  Py_XDECREF(array);
  Py_XDECREF(owner);
  Py_XDECREF(path);
  return !PyErr_Occurred();
}

bool large_finish(const large_arrays *self, const message_type *type, PyObject *message) {
  if (!self->filled) return self->longest.size < LARGE || remember(self, type, message);
  PyObject *owner = owner_of(self->filled->path, message);
  bool put = owner && PyObject_SetAttr(owner, last_of(self->filled->path), self->filled->array) == 0;
  Py_XDECREF(owner);
  return put;
}

void large_release(large_arrays *self) {
  for (unsigned i = 0; i < self->count; i++) {
    Py_DECREF(self->waiting[i].array);
    Py_DECREF(self->waiting[i].path);
  }
  self->count = 0;
  self->filled = NULL;
}
