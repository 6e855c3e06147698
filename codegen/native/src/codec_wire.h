/* What the files of the codec share: the memory of a class, positions on the wire, texts and arrays of numbers. */
#ifndef IFGEN_NATIVE_CODEC_WIRE_H
#define IFGEN_NATIVE_CODEC_WIRE_H

#include "codec.h"

#include <string.h>

enum { HEADER_SIZE = 4 }; /* alignment counts from its end */

/* The slot of an object. What it holds is borrowed, or NULL. */
static inline PyObject **slot_of(PyObject *object, const row *r) { return (PyObject **)(void *)((char *)object + r->offset); }

/* The error that Python has set, as an outcome: only short memory stays one. */
static inline codec_outcome codec_failed(void) {
  if (PyErr_ExceptionMatches(PyExc_MemoryError)) return CODEC_ERROR;
  PyErr_Clear();
  return CODEC_UNUSUAL;
}

/* Pad with zeros. There is room for 8 bytes. */
static inline void buffer_align(codec_buffer *buffer, size_t alignment) {
  memset(buffer->data + buffer->used, 0, 8);
  buffer->used += (HEADER_SIZE - buffer->used - buffer->lent) & (alignment - 1);
}

/* Room for so many bytes more, and 8 for padding. */
static inline bool buffer_reserve(codec_buffer *buffer, size_t more) {
  return buffer->capacity - buffer->used >= more + 8 || codec_buffer_grow(buffer, more + 8);
}

/* A count or a length, with its padding and room for `more` bytes after it. */
static inline bool buffer_count(codec_buffer *buffer, size_t count, size_t more) {
  if (!buffer_reserve(buffer, 3 + 4 + more)) return false;
  const uint32_t value = (uint32_t)count;
  buffer_align(buffer, 4);
  memcpy(buffer->data + buffer->used, &value, 4);
  buffer->used += 4;
  return true;
}

/* What is read, header included, and how far; the object that sequences of numbers are views of, or NULL; pieces that are
 * not in the data, the next one first, and the size of those before it. */
typedef struct {
  const uint8_t *data;
  size_t at, end;
  PyObject *viewed;
  const codec_piece *pieces;
  int piece_count;
  size_t lent;
} payload;

/* Move on over so many bytes, and over the padding before them. NULL where they are not all there. */
static inline const uint8_t *payload_take(payload *from, size_t size, size_t alignment) {
  const size_t start = from->at + ((HEADER_SIZE - from->at - from->lent) & (alignment - 1));
  if (start > from->end || size > from->end - start) return NULL;
  from->at = start + size;
  return from->data + start;
}

static inline bool payload_count(payload *from, uint32_t *count) {
  const uint8_t *start = payload_take(from, 4, 4);
  if (start) memcpy(count, start, 4);
  return start;
}

/* codec_text.c */
codec_outcome text_write(codec_buffer *, PyObject *, uint32_t bound);
codec_outcome wtext_write(codec_buffer *, PyObject *, uint32_t bound);
codec_outcome text_read(payload *, uint32_t bound, PyObject **);
codec_outcome wtext_read(payload *, uint32_t bound, PyObject **);

/* codec_last_texts.c: the strings that a row read last, and those that it wrote last, for as long as the process lives. */
typedef struct last_texts last_texts;
last_texts *last_texts_make(void);
bool last_texts_read(last_texts *, payload *, uint32_t count, PyObject **texts); /* whether they are the same again */
bool last_texts_write(const last_texts *, codec_buffer *, PyObject *texts); /* the same, of a list; false without room, too */
void last_texts_keep(last_texts *, const uint8_t *bytes, size_t size, PyObject *texts);

/* codec_numpy.c: many numbers, which numpy holds. */
/* Whether a message was left because of an array before numpy was known, and it is now. Imports numpy, so nothing half-done
 * may be around. */
bool arrays_try_again(void);
codec_outcome array_write(codec_buffer *, PyObject *, number_type, size_t count);
codec_outcome array_read(payload *, number_type, size_t count, PyObject **);
PyObject *array_copy(PyObject *, number_type); /* as numpy makes it; NULL without an error unless it has one dimension */
codec_outcome view_read(const payload *, number_type, size_t count, const uint8_t *start, PyObject **);

/* codec_arrays.c: many numbers, which array.array holds. */
/* Large ones are not copied yet, but noted. False with a Python error. */
bool numbers_write(codec_buffer *, PyObject *owner, const void *numbers, number_type, size_t count);
codec_outcome sequence_write(codec_buffer *, PyObject *, const row *);
codec_outcome sequence_read(payload *, number_type, size_t count, PyObject **);
bool is_sequence(PyObject *); /* an array.array */
/* array.array(typecode, values); it takes a tenth of the time where the values are floats or ints in a list or a tuple. */
PyObject *sequence_of_items(PyObject *typecode, PyObject *values);
PyObject *sequence_copy(PyObject *); /* as it makes it itself; NULL without an error where it is something else */

#endif
