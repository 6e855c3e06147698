/* From a table to a codec: the classes that it refers to, and where their slots are. The limited API does not tell where a
 * slot is, so it is found: an object of the class gets a value into the slot, and the value's address is looked for. */
#include "codec_wire.h"

#include <stdlib.h>
#include <string.h>

/* All codecs by class: open addressing, never more than half full. */
static struct {
  codec **places;
  size_t mask; /* the number of places less one */
  size_t count;
} known;

static size_t first_place(const PyTypeObject *cls) {
  return (size_t)(((uint64_t)(uintptr_t)cls * UINT64_C(0x9e3779b97f4a7c15)) >> 32) & known.mask;
}

codec *codec_of(PyTypeObject *cls) {
  if (!known.places) return NULL;
  for (size_t place = first_place(cls);; place = (place + 1) & known.mask) {
    codec *found = known.places[place];
    if (!found || found->cls == cls) return found;
  }
}

static void place(codec *it) {
  size_t place = first_place(it->cls);
  while (known.places[place]) place = (place + 1) & known.mask;
  known.places[place] = it;
}

static bool keep(codec *it) {
  if (!known.places || 2 * (known.count + 1) > known.mask) {
    size_t size = known.places ? 2 * (known.mask + 1) : 256, old_size = known.places ? known.mask + 1 : 0;
    codec **old = known.places, **grown = calloc(size, sizeof *grown);
    if (!grown) return PyErr_NoMemory(), false;
    known.places = grown;
    known.mask = size - 1;
    for (size_t i = 0; i < old_size; i++)
      if (old[i]) place(old[i]);
    free(old);
  }
  known.count++;
  place(it);
  return true;
}

/* Objects that can be made by allocation alone, and the size of one. 0 with a Python error. */
static size_t size_of_objects(PyTypeObject *cls) {
  PyObject *basic = PyObject_GetAttrString((PyObject *)cls, "__basicsize__");
  PyObject *item = basic ? PyObject_GetAttrString((PyObject *)cls, "__itemsize__") : NULL;
  size_t size = item ? PyLong_AsSize_t(basic) : 0, item_size = item ? PyLong_AsSize_t(item) : 0;
  Py_XDECREF(basic);
  Py_XDECREF(item);
  if (PyErr_Occurred()) return 0;
  if (item_size || size < sizeof(PyObject) || !(PyType_GetFlags(cls) & Py_TPFLAGS_HEAPTYPE))
    return PyErr_Format(PyExc_TypeError, "%R is not a message class", cls), 0;
  return size;
}

/* Where the slot with this name is in objects of the class. 0 with a Python error. */
static size_t find_slot(PyTypeObject *cls, size_t size, PyObject *name) {
  PyObject *object = PyType_GenericAlloc(cls, 0), *mark = PyList_New(0);
  size_t found = 0, times = 0;
  /* The object's own functions are not asked, so nothing of a user runs. */
  if (object && mark && !PyObject_GenericSetAttr(object, name, mark)) {
    for (size_t at = sizeof(PyObject); at + sizeof(PyObject *) <= size; at += sizeof(PyObject *)) {
      if (*(PyObject **)(void *)((char *)object + at) != mark) continue;
      found = at;
      times++;
    }
    if (times != 1) PyErr_Format(PyExc_TypeError, "%R has no slot %R", cls, name);
  }
  Py_XDECREF(object);
  Py_XDECREF(mark);
  return times == 1 && !PyErr_Occurred() ? found : 0;
}

/* Whether the attribute is a slot's descriptor, and not a property, whose setter is code of a user's. */
static bool is_slot(PyTypeObject *cls, PyObject *name) {
  static PyTypeObject *member_descriptor;
  if (!member_descriptor) {
    PyObject *types = PyImport_ImportModule("types");
    member_descriptor = types ? (PyTypeObject *)PyObject_GetAttrString(types, "MemberDescriptorType") : NULL;
    Py_XDECREF(types);
    if (!member_descriptor) return false;
  }
  PyObject *attribute = PyObject_GetAttr((PyObject *)cls, name);
  bool is = attribute && Py_TYPE(attribute) == member_descriptor;
  if (attribute && !is) PyErr_Format(PyExc_TypeError, "%R of %R is not a slot", name, cls);
  Py_XDECREF(attribute);
  return is;
}

static int compare_keys(const void *left, const void *right) {
  const uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
  return (a > b) - (a < b);
}

/* Two rows for one slot would release what the first has put there. */
static bool no_slot_is_filled_twice(const table *t) {
  uint64_t *keys = malloc(t->row_count * sizeof *keys);
  if (!keys) return PyErr_NoMemory(), false;
  size_t count = 0;
  for (uint32_t i = 0; i < t->row_count; i++)
    if (t->rows[i].offset) keys[count++] = (uint64_t)t->rows[i].message << 32 | t->rows[i].offset;
  qsort(keys, count, sizeof *keys, compare_keys);
  bool once = true;
  for (size_t i = 1; i < count; i++) once = once && keys[i] != keys[i - 1];
  free(keys);
  if (!once) PyErr_SetString(PyExc_ValueError, "the table fills a slot twice");
  return once;
}

/* Fill in offsets and classes of the rows. */
static bool link_rows(codec *it, const char *text, PyObject *classes) {
  PyTypeObject **owners = calloc(it->table.message_count, sizeof *owners); /* the classes of the messages by number */
  if (!owners) return PyErr_NoMemory(), false;
  owners[0] = it->cls;
  bool linked = true;
  for (uint32_t i = 0; linked && i < it->table.row_count; i++) {
    row *r = &it->table.rows[i];
    if (r->kind == ROW_ENTER || r->kind == ROW_REPEAT || r->kind == ROW_CALL) r->cls = PyTuple_GetItem(classes, r->type);
    if (r->kind == ROW_ENTER || r->kind == ROW_REPEAT) {
      owners[r->target] = r->cls;
      linked = size_of_objects(r->cls) > 0;
    }
    if (r->kind == ROW_CALL) {
      codec *called = r->called = codec_of(r->cls);
      if (!called) PyErr_Format(PyExc_TypeError, "%R has no codec in C", r->cls);
      linked = called && owners[r->target] == r->cls;
      if (called && !linked) PyErr_SetString(PyExc_ValueError, "the table calls the codec of another class");
    }
    if (!linked || !r->name_size) continue;
    PyTypeObject *owner = owners[r->message];
    PyObject *name = PyUnicode_DecodeUTF8(text + r->name, (Py_ssize_t)r->name_size, NULL);
    size_t size = name && is_slot(owner, name) ? size_of_objects(owner) : 0;
    r->offset = size ? find_slot(owner, size, name) : 0;
    linked = r->offset > 0;
    r->slot = name;
  }
  free(owners);
  return linked && no_slot_is_filled_twice(&it->table);
}

codec *codec_attach(PyTypeObject *cls, PyObject *encode, PyObject *decode, const char *text, Py_ssize_t size, PyObject *classes) {
  codec *it = codec_of(cls);
  if (it) return it;
  const Py_ssize_t count = PyTuple_Size(classes);
  for (Py_ssize_t i = 0; i < count; i++)
    if (!PyType_Check(PyTuple_GetItem(classes, i))) return PyErr_Format(PyExc_TypeError, "%R are not all classes", classes), NULL;
  size_t problem;
  if (!(it = calloc(1, sizeof *it))) return PyErr_NoMemory(), NULL;
  it->cls = cls;
  if (!table_parse(text, (size_t)size, (size_t)count, &it->table, &problem)) {
    PyErr_Format(PyExc_ValueError, "the table of %R is malformed at character %zu", cls, problem);
  } else if (size_of_objects(cls) && link_rows(it, text, classes) && keep(it)) {
    Py_INCREF((PyObject *)cls);
    Py_INCREF(encode);
    Py_INCREF(decode);
    Py_INCREF(classes); /* the rows hold them */
    for (row *r = it->table.rows; r < it->table.rows + it->table.row_count; r++)
      if (r->kind == ROW_TEXTS && !r->size) { /* without a count before them, they would not always be aligned alike */
        r->last_read = last_texts_make(); /* or NULL without memory */
        r->last_written = last_texts_make();
      }
    it->encode = encode;
    it->decode = decode;
    return it;
  }
  free(it->table.rows);
  free(it);
  return NULL;
}
