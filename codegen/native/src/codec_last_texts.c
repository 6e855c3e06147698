/* Sequences of strings are often the same in each message of a type, such as the names of joints. So each row keeps the
 * last ones that it read or wrote, with their bytes. To compare the bytes is ten times as fast as to make strings, and to
 * compare the objects is ten times as fast as to copy their texts one by one. */
#include "codec_wire.h"

#include <stdlib.h>

enum {
  MOST_BYTES = 4096,
  EVERY = 8, /* after how many sequences that were different the next one is kept */
};

struct last_texts {
  PyObject *texts; /* a list that nobody else sees */
  uint32_t count, misses;
  uint8_t *bytes; /* MOST_BYTES of memory */
  size_t size;
};

last_texts *last_texts_make(void) { return calloc(1, sizeof(last_texts)); }

bool last_texts_read(last_texts *last, payload *from, uint32_t count, PyObject **texts) {
  if (!last->texts || last->count != count || last->size > from->end - from->at) return false;
  /* Both begin after a count, so they are aligned alike. */
  if (memcmp(last->bytes, from->data + from->at, last->size)) return false;
  *texts = PyList_GetSlice(last->texts, 0, count);
  if (!*texts) return PyErr_Clear(), false;
  from->at += last->size;
  return true;
}

bool last_texts_write(const last_texts *last, codec_buffer *buffer, PyObject *texts) {
  if (!last->texts || (size_t)PyList_Size(texts) != last->count || buffer->capacity - buffer->used < last->size) return false;
  for (Py_ssize_t i = 0; i < (Py_ssize_t)last->count; i++)
    if (PyList_GetItem(texts, i) != PyList_GetItem(last->texts, i)) return false;
  memcpy(buffer->data + buffer->used, last->bytes, last->size);
  buffer->used += last->size;
  return true;
}

void last_texts_keep(last_texts *last, const uint8_t *bytes, size_t size, PyObject *texts) {
  if (size > MOST_BYTES || last->misses++ % EVERY) return;
  if (!last->bytes && !(last->bytes = malloc(MOST_BYTES))) return;
  PyObject *kept = PyList_GetSlice(texts, 0, PyList_Size(texts)), *old = last->texts;
  if (!kept) {
    PyErr_Clear();
    return;
  }
  last->texts = kept;
  last->count = (uint32_t)PyList_Size(kept);
  last->size = size;
  memcpy(last->bytes, bytes, size);
  Py_XDECREF(old);
}
