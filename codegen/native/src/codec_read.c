/* Run a table to read a message. Nobody else sees the message before it is whole: Python's garbage collector, which could
 * run somebody's code, is off in the meantime. */
#include "codec_numbers.h"
#include "codec_wire.h"

enum { FEW_MESSAGES = 32 };

static codec_outcome read_rows(payload *, const row *first, size_t count, PyObject **messages, unsigned depth);

/* Read the number of elements unless it is fixed. */
static bool read_count(payload *from, const row *r, uint32_t *count) {
  *count = r->size;
  return r->size || (payload_count(from, count) && !(r->maximum && *count > r->maximum));
}

/* It is checked against the bytes left before anything is made. */
static bool are_there(const payload *from, const row *r, uint32_t count) { return count <= (from->end - from->at) / r->least; }

/* A list of so many elements, each made by one of the ways below. */
static codec_outcome read_element(payload *from, const row *r, PyObject **messages, unsigned depth, PyObject **element) {
  switch (r->kind) {
    case ROW_VALUES: {
      const uint8_t *start = payload_take(from, 1, 1);
      *element = start ? number_read(start, r->number) : NULL;
      return *element ? CODEC_DONE : start ? codec_failed() : CODEC_UNUSUAL;
    }
    case ROW_TEXTS: return text_read(from, r->bound, element);
    case ROW_WTEXTS: return wtext_read(from, r->bound, element);
    default: {
      *element = messages[r->target] = PyType_GenericAlloc(r->cls, 0);
      if (!*element) return codec_failed();
      codec_outcome outcome = read_rows(from, r + 1, r->rows, messages, depth + 1);
      if (outcome != CODEC_DONE) Py_CLEAR(*element);
      return outcome;
    }
  }
}

static codec_outcome read_list(payload *from, const row *r, PyObject **messages, unsigned depth, PyObject **made) {
  uint32_t count;
  if (depth > TABLE_MAX_DEPTH || !read_count(from, r, &count) || !are_there(from, r, count)) return CODEC_UNUSUAL;
  const size_t start = from->at;
  if (r->last_read && count && last_texts_read(r->last_read, from, count, made)) return CODEC_DONE;
  PyObject *list = PyList_New((Py_ssize_t)count);
  if (!list) return codec_failed();
  for (uint32_t i = 0; i < count; i++) {
    PyObject *element;
    codec_outcome outcome = read_element(from, r, messages, depth, &element);
    if (outcome != CODEC_DONE) return Py_DECREF(list), outcome;
    PyList_SetItem(list, (Py_ssize_t)i, element);
  }
  if (r->last_read && count) last_texts_keep(r->last_read, from->data + start, from->at - start, list);
  *made = list;
  return CODEC_DONE;
}

/* Take the next piece if it belongs here. */
static bool read_piece(payload *from, size_t size, size_t alignment, PyObject **made) {
  const codec_piece *piece = from->pieces;
  const size_t padding = (HEADER_SIZE - from->at - from->lent) & (alignment - 1);
  if (!from->piece_count || piece->before != from->at + padding || piece->size != size) return false;
  from->at += padding;
  from->lent += size;
  from->pieces++;
  from->piece_count--;
  Py_INCREF(piece->owner);
  *made = piece->owner;
  return true;
}

static codec_outcome read_sequence(payload *from, const row *r, PyObject **made) {
  uint32_t count;
  if (!read_count(from, r, &count)) return CODEC_UNUSUAL;
  if (count && read_piece(from, (size_t)count * number_sizes[r->number], number_sizes[r->number], made)) return CODEC_DONE;
  return are_there(from, r, count) ? sequence_read(from, r->number, count, made) : CODEC_UNUSUAL;
}

static codec_outcome read_message(payload *from, const codec *it, PyObject *message, unsigned depth) {
  PyObject *few[FEW_MESSAGES], **messages = few;
  if (depth > TABLE_MAX_DEPTH) return CODEC_UNUSUAL;
  if (it->table.message_count > FEW_MESSAGES && !(messages = PyMem_Malloc(it->table.message_count * sizeof *messages)))
    return PyErr_NoMemory(), CODEC_ERROR;
  messages[0] = message;
  codec_outcome outcome = read_rows(from, it->table.rows, it->table.row_count, messages, depth);
  if (messages != few) PyMem_Free(messages);
  return outcome;
}

/* Each row makes one value, which fills an empty slot: a table has no two rows for one slot. */
static codec_outcome read_rows(payload *from, const row *first, size_t count, PyObject **messages, unsigned depth) {
  for (const row *r = first, *end = first + count; r < end; r++) {
    codec_outcome outcome = CODEC_DONE;
    PyObject *value = NULL;
    switch (r->kind) {
      case ROW_RUN: continue;
      case ROW_BLANK:
        if (!payload_take(from, 1, 1)) return CODEC_UNUSUAL;
        continue;
      case ROW_VALUE: {
        const uint8_t *start = payload_take(from, number_sizes[r->number], number_sizes[r->number]);
        if (!start) return CODEC_UNUSUAL;
        value = number_read(start, r->number);
        if (!value) return codec_failed();
        break;
      }
      case ROW_ENTER:
        value = messages[r->target] = PyType_GenericAlloc(r->cls, 0);
        if (!value) return codec_failed();
        break;
      case ROW_CALL:
        outcome = read_message(from, r->called, messages[r->target], depth + 1);
        if (outcome != CODEC_DONE) return outcome;
        continue;
      case ROW_ARRAY: outcome = array_read(from, r->number, r->size, &value); break;
      case ROW_TEXT: outcome = text_read(from, r->bound, &value); break;
      case ROW_WTEXT: outcome = wtext_read(from, r->bound, &value); break;
      case ROW_VALUES:
        outcome = r->number < NUMBER_INT8 ? read_list(from, r, messages, depth, &value) : read_sequence(from, r, &value);
        break;
      default: outcome = read_list(from, r, messages, depth, &value); break;
    }
    if (outcome != CODEC_DONE) return outcome;
    *slot_of(messages[r->message], r) = value;
    if (r->kind == ROW_REPEAT) r += r->rows;
  }
  return CODEC_DONE;
}

static codec_outcome read_whole(const codec *it, payload from, PyObject **message) {
  const int collects = PyGC_Disable();
  PyObject *made = PyType_GenericAlloc(it->cls, 0);
  codec_outcome outcome = made ? read_message(&from, it, made, 0) : codec_failed();
  if (outcome == CODEC_DONE && from.piece_count) outcome = CODEC_UNUSUAL;
  if (outcome == CODEC_DONE) *message = made;
  else Py_XDECREF(made);
  if (collects) PyGC_Enable();
  return outcome;
}

static codec_outcome read_payload(const codec *it, payload from, PyObject **message) {
  codec_outcome outcome = read_whole(it, from, message);
  return outcome == CODEC_UNUSUAL && arrays_try_again() ? read_whole(it, from, message) : outcome;
}

codec_outcome codec_read(codec *it, const uint8_t *data, size_t size, PyObject *viewed, PyObject **message) {
  if (size < HEADER_SIZE || data[0] != 0 || data[1] != 1) return CODEC_UNUSUAL;
  return read_payload(it, (payload){.data = data, .at = HEADER_SIZE, .end = size, .viewed = viewed}, message);
}

codec_outcome codec_read_pieces(codec *it, const codec_buffer *written, PyObject **message) {
  const payload from = {.data = written->data, .at = HEADER_SIZE, .end = written->used, .pieces = written->pieces,
                        .piece_count = written->piece_count};
  return read_payload(it, from, message);
}
