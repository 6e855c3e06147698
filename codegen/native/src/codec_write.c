/* Run a table to write a message. Nothing here can change an object, so what is borrowed stays. */
#include "codec_numbers.h"
#include "codec_wire.h"

enum { FEW_MESSAGES = 32 };

static bool fits(const row *r, size_t count) {
  return r->size ? count == r->size : count <= (r->maximum ? r->maximum : UINT32_MAX);
}

/* The number of elements in a list, and on the wire unless it is fixed. */
static codec_outcome write_list_count(codec_buffer *buffer, PyObject *value, const row *r, size_t *count) {
  if (!Py_IS_TYPE(value, &PyList_Type)) return CODEC_UNUSUAL;
  *count = (size_t)PyList_Size(value);
  if (!fits(r, *count)) return CODEC_UNUSUAL;
  return r->size || buffer_count(buffer, *count, 0) ? CODEC_DONE : CODEC_ERROR;
}

/* Booleans, octets or characters, of one byte each. */
static codec_outcome write_list(codec_buffer *buffer, PyObject *value, const row *r) {
  size_t count;
  codec_outcome outcome = write_list_count(buffer, value, r, &count);
  if (outcome != CODEC_DONE) return outcome;
  if (!buffer_reserve(buffer, count)) return CODEC_ERROR;
  for (size_t i = 0; i < count; i++)
    if (!number_write(buffer->data + buffer->used++, r->number, PyList_GetItem(value, (Py_ssize_t)i))) return CODEC_UNUSUAL;
  return CODEC_DONE;
}

static codec_outcome write_texts(codec_buffer *buffer, PyObject *value, const row *r) {
  size_t count;
  codec_outcome outcome = write_list_count(buffer, value, r, &count);
  const bool is_kept = outcome == CODEC_DONE && r->last_written && count;
  if (is_kept && last_texts_write(r->last_written, buffer, value)) return CODEC_DONE;
  const size_t start = buffer->used;
  for (size_t i = 0; outcome == CODEC_DONE && i < count; i++) {
    PyObject *text = PyList_GetItem(value, (Py_ssize_t)i);
    outcome = r->kind == ROW_TEXTS ? text_write(buffer, text, r->bound) : wtext_write(buffer, text, r->bound);
  }
  if (is_kept && outcome == CODEC_DONE) last_texts_keep(r->last_written, buffer->data + start, buffer->used - start, value);
  return outcome;
}

static codec_outcome write_rows(codec_buffer *, const row *first, size_t count, PyObject **messages, unsigned depth);

static codec_outcome write_elements(codec_buffer *buffer, PyObject *value, const row *r, PyObject **messages, unsigned depth) {
  size_t count;
  codec_outcome outcome = write_list_count(buffer, value, r, &count);
  if (depth > TABLE_MAX_DEPTH) return CODEC_UNUSUAL;
  for (size_t i = 0; outcome == CODEC_DONE && i < count; i++) {
    PyObject *element = messages[r->target] = PyList_GetItem(value, (Py_ssize_t)i);
    if (Py_TYPE(element) != r->cls) return CODEC_UNUSUAL;
    outcome = write_rows(buffer, r + 1, r->rows, messages, depth + 1);
  }
  return outcome;
}

static codec_outcome write_message(codec_buffer *buffer, const codec *it, PyObject *message, unsigned depth) {
  PyObject *few[FEW_MESSAGES], **messages = few;
  if (depth > TABLE_MAX_DEPTH) return CODEC_UNUSUAL;
  if (it->table.message_count > FEW_MESSAGES && !(messages = PyMem_Malloc(it->table.message_count * sizeof *messages)))
    return PyErr_NoMemory(), CODEC_ERROR;
  messages[0] = message;
  codec_outcome outcome = write_rows(buffer, it->table.rows, it->table.row_count, messages, depth);
  if (messages != few) PyMem_Free(messages);
  return outcome;
}

static codec_outcome write_rows(codec_buffer *buffer, const row *first, size_t count, PyObject **messages, unsigned depth) {
  for (const row *r = first, *end = first + count; r < end; r++) {
    codec_outcome outcome = CODEC_DONE;
    if (r->kind == ROW_RUN) {
      if (!buffer_reserve(buffer, r->most)) return CODEC_ERROR;
      continue;
    }
    if (r->kind == ROW_BLANK) {
      buffer->data[buffer->used++] = 0;
      continue;
    }
    if (r->kind == ROW_CALL) {
      outcome = write_message(buffer, r->called, messages[r->target], depth + 1);
      if (outcome != CODEC_DONE) return outcome;
      continue;
    }
    PyObject *value = *slot_of(messages[r->message], r);
    if (!value) return CODEC_UNUSUAL;
    switch (r->kind) {
      case ROW_ENTER:
        if (Py_TYPE(value) != r->cls) return CODEC_UNUSUAL;
        messages[r->target] = value;
        continue;
      case ROW_VALUE:
        buffer_align(buffer, number_sizes[r->number]);
        if (!number_write(buffer->data + buffer->used, r->number, value)) return CODEC_UNUSUAL;
        buffer->used += number_sizes[r->number];
        continue;
      case ROW_ARRAY: outcome = array_write(buffer, value, r->number, r->size); break;
      case ROW_TEXT: outcome = text_write(buffer, value, r->bound); break;
      case ROW_WTEXT: outcome = wtext_write(buffer, value, r->bound); break;
      case ROW_VALUES: outcome = r->number < NUMBER_INT8 ? write_list(buffer, value, r) : sequence_write(buffer, value, r); break;
      case ROW_TEXTS: case ROW_WTEXTS: outcome = write_texts(buffer, value, r); break;
      case ROW_REPEAT:
        outcome = write_elements(buffer, value, r, messages, depth);
        r += r->rows;
        break;
    }
    if (outcome != CODEC_DONE) return outcome;
  }
  return CODEC_DONE;
}

static codec_outcome write_whole(codec *it, PyObject *message, codec_buffer *buffer) {
  static const uint8_t header[HEADER_SIZE] = {0, 1, 0, 0};
  buffer->used = buffer->lent = 0;
  buffer->piece_count = 0;
  if (!buffer_reserve(buffer, it->last_used + HEADER_SIZE)) return CODEC_ERROR;
  memcpy(buffer->data, header, HEADER_SIZE);
  buffer->used = HEADER_SIZE;
  codec_outcome outcome = write_message(buffer, it, message, 0);
  it->last_used = outcome == CODEC_DONE ? buffer->used : 0;
  return outcome;
}

codec_outcome codec_write(codec *it, PyObject *message, codec_buffer *buffer) {
  if (Py_TYPE(message) != it->cls) return CODEC_UNUSUAL;
  codec_outcome outcome = write_whole(it, message, buffer);
  return outcome == CODEC_UNUSUAL && arrays_try_again() ? write_whole(it, message, buffer) : outcome;
}
