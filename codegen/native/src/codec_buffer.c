/* Memory for a message that is written. */
#include "codec.h"

#include <stdlib.h>
#include <string.h>

bool codec_buffer_grow(codec_buffer *buffer, size_t more) {
  size_t capacity = 2 * buffer->capacity;
  if (more > PY_SSIZE_T_MAX / 4 || buffer->used > PY_SSIZE_T_MAX / 4) return PyErr_NoMemory(), false;
  if (capacity < buffer->used + more) capacity = buffer->used + more;
  uint8_t *data = realloc(buffer->borrowed ? NULL : buffer->data, capacity);
  if (!data) return PyErr_NoMemory(), false;
  if (buffer->borrowed) memcpy(data, buffer->data, buffer->used);
  buffer->borrowed = false;
  buffer->data = data;
  buffer->capacity = capacity;
  return true;
}

void codec_buffer_copy(const codec_buffer *buffer, size_t start, uint8_t *to) {
  size_t copied = start;
  for (int i = 0; i < buffer->piece_count; i++) {
    const size_t before = buffer->pieces[i].before - copied;
    memcpy(to, buffer->data + copied, before);
    memcpy(to + before, buffer->pieces[i].data, buffer->pieces[i].size);
    to += before + buffer->pieces[i].size;
    copied += before;
  }
  memcpy(to, buffer->data + copied, buffer->used - copied);
}

void codec_buffer_release(codec_buffer *buffer) {
  if (!buffer->borrowed) free(buffer->data);
  *buffer = (codec_buffer){0};
}
