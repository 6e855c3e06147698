/* Arrays of numbers: numpy's. It is asked for the first time when a message has an array, since importing it takes longer than
 * everything else. */
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
static PyObject *dtypes[NUMBER_COUNT];

/* Two functions of numpy's binary interface, by their places in its table. */
enum { API_TYPE = 2, API_NEW_FROM_DESCR = 94, API_SET_BASE_OBJECT = 282, ALIGNED = 0x100 };
static PyObject *(*new_from_descr)(PyTypeObject *, PyObject *descr, int nd, const Py_ssize_t *dimensions, const Py_ssize_t *strides,
                                   void *data, int flags, PyObject *like); /* takes the reference to the descr */
static int (*set_base_object)(PyObject *array, PyObject *base); /* takes the reference to the base */

/* An array with memory of its own, not filled. */
static PyObject *make(const Py_ssize_t *dimensions, int nd, number_type type) {
  Py_INCREF(dtypes[type]);
  return new_from_descr(numpy_type, dtypes[type], nd, dimensions, NULL, NULL, 0, NULL);
}

/* Whether array objects are laid out as declared: look at a 2 x 3 array and its transpose. */
static bool is_known_layout(void) {
  PyObject *whole = make((Py_ssize_t[]){2, 3}, 2, NUMBER_FLOAT64);
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

/* False with or without a Python error. */
static bool find_functions(void) {
  PyObject *module = PyImport_ImportModule("numpy._core._multiarray_umath"); /* since numpy 2 */
  if (!module) PyErr_Clear();
  if (!module) module = PyImport_ImportModule("numpy.core._multiarray_umath");
  PyObject *table = module ? PyObject_GetAttrString(module, "_ARRAY_API") : NULL;
  void **functions = table ? PyCapsule_GetPointer(table, NULL) : NULL;
  const bool found = functions && functions[API_TYPE] == numpy_type;
  if (found) {
    memcpy(&new_from_descr, &functions[API_NEW_FROM_DESCR], sizeof new_from_descr);
    memcpy(&set_base_object, &functions[API_SET_BASE_OBJECT], sizeof set_base_object);
  }
  Py_XDECREF(table);
  Py_XDECREF(module);
  return found;
}

static bool find_numpy(void) {
  PyObject *numpy = PyImport_ImportModule("numpy");
  numpy_type = numpy ? (PyTypeObject *)PyObject_GetAttrString(numpy, "ndarray") : NULL;
  bool sound = numpy_type && PyType_Check((PyObject *)numpy_type) && find_functions();
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

codec_outcome array_write(codec_buffer *buffer, PyObject *value, number_type type, size_t count) {
  size_t found;
  const numpy_array *array = as_numpy(value, type, &found);
  if (!array || found != count) return CODEC_UNUSUAL;
  return numbers_write(buffer, value, array->data, type, count) ? CODEC_DONE : CODEC_ERROR;
}

/* A numpy array of its own, not filled. */
static numpy_array *new_array(number_type type, size_t count) {
  const Py_ssize_t size = (Py_ssize_t)count;
  return (numpy_array *)(void *)make(&size, 1, type);
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

static PyObject *view_class;

void codec_view_class(PyObject *cls) {
  PyObject *old = view_class;
  Py_INCREF(cls);
  view_class = cls;
  Py_XDECREF(old);
}

/* numpy makes an object of the class, which has no constructor in Python. It keeps the payload alive. */
codec_outcome view_read(const payload *from, number_type type, size_t count, const uint8_t *start, PyObject **made) {
  const Py_ssize_t size = (Py_ssize_t)count;
  if (!knows_numpy()) return CODEC_UNUSUAL;
  Py_INCREF(dtypes[type]);
  *made = new_from_descr((PyTypeObject *)view_class, dtypes[type], 1, &size, NULL, (void *)(uintptr_t)start, C_CONTIGUOUS | ALIGNED, NULL);
  if (!*made) return codec_failed();
  Py_INCREF(from->viewed);
  if (!set_base_object(*made, from->viewed)) return CODEC_DONE;
  Py_CLEAR(*made);
  return codec_failed();
}
