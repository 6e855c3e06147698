/* libfastcdr without its headers. Two entry points are public. The address and size of what was received are
 * private members; they are found by looking for known values in objects of our own. */
#include "native.h"

const char *fastrtps_identifier;
const char *introspection_identifier;

static bool (*jump_function)(void *cdr, size_t size);
static char *(*position_function)(void *cdr);
static void (*set_error)(const char *text, const char *file, size_t line);
static bool (*is_error_set)(void);
static void (*reset_error)(void);
static size_t buffer_member; /* of Cdr: its FastBuffer *                          [bytes from the object's start] */
static size_t data_member, size_member; /* of FastBuffer: where the bytes are, how many */

/* Not LITTLE_ENDIAN: that is a macro of <endian.h>, which Python.h includes since CPython 3.13. */
enum { CDR_LITTLE_ENDIAN = 1, XCDRV1 = 1, PROBED_SIZE = 24680 };

/* The only place in an object at which `wanted` stands, in bytes; -1 where it stands nowhere or more than once. */
static long find_once(const uintptr_t *words, size_t count, uintptr_t wanted) {
  long found = -1;
  for (size_t i = 0; i < count; i++) {
    if (words[i] != wanted) continue;
    if (found >= 0) return -1;
    found = (long)(i * sizeof *words);
  }
  return found;
}

static const char *probe(void (*make_buffer)(void *, char *, size_t), void (*make_cdr)(void *, void *, int, int)) {
  /* Far more room than the objects take (Fast-CDR 2.2: 40 and 120 bytes); zeroed, so what is not set is not found. */
  uintptr_t buffer[64] = {0}, cdr[256] = {0};
  static char data[PROBED_SIZE];
  make_buffer(buffer, data, sizeof data);
  make_cdr(cdr, buffer, CDR_LITTLE_ENDIAN, XCDRV1);
  long in_cdr = find_once(cdr, 256, (uintptr_t)buffer);
  long in_buffer = find_once(buffer, 64, (uintptr_t)data);
  long size = find_once(buffer, 64, sizeof data);
  if (in_cdr < 0 || in_buffer < 0 || size < 0) return "the members of Cdr and FastBuffer are not where one value each tells them";
  if (position_function(cdr) != data) return "get_current_position does not start at the buffer";
  if (!jump_function(cdr, 100) || position_function(cdr) != data + 100) return "jump does not move by the bytes asked for";
  if (jump_function(cdr, (size_t)1 << 40)) return "jump leaves the buffer";
  buffer_member = (size_t)in_cdr;
  data_member = (size_t)in_buffer;
  size_member = (size_t)size;
  return NULL;
}

static void *symbol(PyObject *symbols, const char *name) {
  PyObject *value = PyDict_GetItemString(symbols, name); /* borrowed */
  void *result = value ? PyLong_AsVoidPtr(value) : NULL;
  if (!result && !PyErr_Occurred()) PyErr_Format(PyExc_KeyError, "symbol %s", name);
  return result;
}

int fastcdr_bind(PyObject *symbols) {
  void *make_buffer = symbol(symbols, "fast_buffer"), *make_cdr = symbol(symbols, "cdr");
  void *jump = symbol(symbols, "jump"), *position = symbol(symbols, "position"), *error = symbol(symbols, "set_error");
  void *is_set = symbol(symbols, "is_error_set"), *reset = symbol(symbols, "reset_error");
  void *fastrtps = symbol(symbols, "fastrtps_identifier"), *introspection = symbol(symbols, "introspection_identifier");
  if (PyErr_Occurred()) return -1;
  jump_function = (bool (*)(void *, size_t))jump;
  position_function = (char *(*)(void *))position;
  set_error = (void (*)(const char *, const char *, size_t))error;
  is_error_set = (bool (*)(void))is_set;
  reset_error = (void (*)(void))reset;
  fastrtps_identifier = fastrtps;
  introspection_identifier = introspection;
  const char *unlike = probe((void (*)(void *, char *, size_t))make_buffer, (void (*)(void *, void *, int, int))make_cdr);
  if (unlike) {
    PyErr_SetString(PyExc_ImportError, unlike);
    return -1;
  }
  return 0;
}

bool fastcdr_jump(void *cdr, size_t size) { return jump_function(cdr, size); }

char *fastcdr_position(void *cdr) { return position_function(cdr); }

void fastcdr_payload(void *cdr, const char **data, size_t *size) {
  const char *buffer = *(const char **)((const char *)cdr + buffer_member);
  *data = *(const char *const *)(buffer + data_member);
  *size = *(const size_t *)(buffer + size_member);
}

void report_error(const char *text) { set_error(text, "ifgen_native", 0); }

void clear_error(void) {
  if (is_error_set()) reset_error();
}
