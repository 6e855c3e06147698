#include "ifgen/cdr.h"

#include <string.h>

#define HEADER_SIZE 4u

typedef char double_has_8_bytes[sizeof(double) == 8 ? 1 : -1];
typedef char bool_has_1_byte[sizeof(bool) == 1 ? 1 : -1];

typedef enum { MEASURE, WRITE, READ } mode;

typedef struct {
  mode what;
  bool swap;
  uint8_t *body; /* READ only reads it, and MEASURE has none */
  size_t size;
  size_t position;
} stream;

static bool is_big_endian(void)
{
  const uint16_t one = 1;
  uint8_t first;
  memcpy(&first, &one, 1);
  return first == 0;
}

/* The next `size` bytes of the payload, after alignment; false if it has too few. */
static bool take(stream *s, size_t size, size_t alignment, uint8_t **bytes)
{
  const size_t padding = (alignment - s->position) & (alignment - 1u);
  size_t i;
  if (padding > s->size - s->position || size > s->size - s->position - padding) {
    return false;
  }
  *bytes = NULL;
  if (s->what != MEASURE) {
    *bytes = s->body + s->position + padding;
    for (i = 1; s->what == WRITE && i <= padding; ++i) {
      *(*bytes - i) = 0;
    }
  }
  s->position += padding + size;
  return true;
}

/* Move numbers between memory and the payload. Their alignment in the payload is not that of the processor. */
static bool numbers(stream *s, uint8_t *memory, size_t size, size_t width)
{
  uint8_t *bytes;
  uint8_t *to;
  const uint8_t *from;
  size_t i;
  if (!take(s, size, width, &bytes)) {
    return false;
  }
  if (s->what == MEASURE) {
    return true;
  }
  to = s->what == READ ? memory : bytes;
  from = s->what == READ ? bytes : memory;
  if (!s->swap) {
    memcpy(to, from, size);
    return true;
  }
  for (i = 0; i < size; ++i) {
    to[i] = from[i ^ (width - 1u)];
  }
  return true;
}

static bool count(stream *s, uint32_t *value)
{
  return numbers(s, (uint8_t *)value, sizeof *value, sizeof *value);
}

static bool bools(stream *s, uint8_t *memory, size_t size)
{
  size_t i;
  if (!numbers(s, memory, size, 1)) {
    return false;
  }
  for (i = 0; s->what == READ && i < size; ++i) {
    const bool value = memory[i] != 0;
    memcpy(memory + i, &value, 1);
  }
  return true;
}

static ifgen_cdr_problem string(stream *s, char *text, size_t capacity, size_t bound)
{
  uint8_t *bytes;
  const char *end;
  uint32_t length = 0;
  size_t i;
  if (s->what != READ) {
    end = memchr(text, 0, capacity);
    if (end == NULL) {
      return IFGEN_CDR_CHARACTER;
    }
    length = (uint32_t)(end - text) + 1u;
  }
  if (!count(s, &length) || !take(s, length, 1, &bytes)) {
    return IFGEN_CDR_SHORT;
  }
  if (s->what == READ) {
    end = length == 0 ? NULL : memchr(bytes, 0, length);
    if (end != NULL) {
      length = (uint32_t)(end - (const char *)bytes);
    }
    if (length >= capacity) {
      return IFGEN_CDR_BOUND;
    }
    memcpy(text, bytes, length);
    text[length] = 0;
  } else if (s->what == WRITE) {
    memcpy(bytes, text, length);
  }
  if (bound != 0) {
    for (i = 0; text[i] != 0; ++i) {
      if (((unsigned char)text[i] & 0xC0u) != 0x80u && bound-- == 0) {
        return IFGEN_CDR_BOUND;
      }
    }
  }
  return IFGEN_CDR_OK;
}

static ifgen_cdr_problem wstring(stream *s, uint8_t *memory, size_t capacity, size_t bound)
{
  uint32_t length = 0;
  uint32_t i;
  const bool is_bounded = bound != 0;
  memcpy(&length, memory, sizeof length);
  if (!count(s, &length)) {
    return IFGEN_CDR_SHORT;
  }
  if (length > capacity) {
    return IFGEN_CDR_BOUND;
  }
  for (i = 0; i < length; ++i) {
    uint8_t *at = memory + sizeof length + i * sizeof(uint16_t);
    uint16_t unit;
    uint32_t wide;
    memcpy(&unit, at, sizeof unit);
    wide = unit;
    if (!count(s, &wide)) {
      return IFGEN_CDR_SHORT;
    }
    if (wide > 0xFFFFu) {
      return IFGEN_CDR_CHARACTER;
    }
    if (is_bounded && (wide & 0xFC00u) != 0xDC00u && bound-- == 0) {
      return IFGEN_CDR_BOUND;
    }
    unit = (uint16_t)wide;
    if (s->what == READ) {
      memcpy(at, &unit, sizeof unit);
    }
  }
  if (s->what == READ) {
    memcpy(memory, &length, sizeof length);
  }
  return IFGEN_CDR_OK;
}

/* One field that is no REPEAT. `index` counts the elements of strings, for the failure. */
static ifgen_cdr_problem field(
  stream *s, const ifgen_cdr_row *row, uint8_t *memory, uint32_t elements, uint32_t *index)
{
  ifgen_cdr_problem problem = IFGEN_CDR_OK;
  uint8_t *bytes;
  switch (row->kind) {
    case IFGEN_CDR_NUMBERS:
      if (elements != 0 && !numbers(s, memory, (size_t)elements * row->stride, row->width)) {
        return IFGEN_CDR_SHORT;
      }
      break;
    case IFGEN_CDR_BOOLS:
      return bools(s, memory, elements) ? IFGEN_CDR_OK : IFGEN_CDR_SHORT;
    case IFGEN_CDR_BLANK:
      if (!take(s, 1, 1, &bytes)) {
        return IFGEN_CDR_SHORT;
      }
      if (s->what == WRITE) {
        *bytes = 0;
      }
      break;
    default:
      for (*index = 0; *index < elements && problem == IFGEN_CDR_OK; ++*index) {
        uint8_t *element = memory + (size_t)*index * row->stride;
        problem = row->kind == IFGEN_CDR_STRINGS
          ? string(s, (char *)element, row->stride, row->extra)
          : wstring(s, element, (row->stride - sizeof(uint32_t)) / sizeof(uint16_t), row->extra);
      }
      if (problem != IFGEN_CDR_OK) {
        --*index;
      }
      break;
  }
  return problem;
}

static bool walk(stream *s, const ifgen_cdr_row *rows, uint8_t *message, ifgen_cdr_failure *failure)
{
  struct { const ifgen_cdr_row *body; uint8_t *outer; uint32_t elements; } loops[IFGEN_CDR_DEPTH];
  ifgen_cdr_failure local;
  const ifgen_cdr_row *row = rows;
  ifgen_cdr_problem problem = IFGEN_CDR_OK;
  uint32_t counted = 0;
  uint8_t depth = 0;
  if (failure == NULL) {
    failure = &local;
  }
  for (;; ++row) {
    uint8_t *memory = message + row->offset;
    const uint32_t elements = row->count != 0 ? row->count : counted;
    if (row->kind == IFGEN_CDR_END) {
      if (depth == 0) {
        break;
      }
      if (++failure->index[depth - 1u] < loops[depth - 1u].elements) {
        row = loops[depth - 1u].body - 1;
        message += row->stride;
      } else {
        message = loops[--depth].outer;
      }
    } else if (row->kind == IFGEN_CDR_COUNT) {
      memcpy(&counted, memory, sizeof counted);
      if (!count(s, &counted)) {
        problem = IFGEN_CDR_SHORT;
      } else if (counted > row->count) {
        problem = IFGEN_CDR_BOUND;
      } else if (s->what == READ) {
        memcpy(memory, &counted, sizeof counted);
      }
    } else if (row->kind == IFGEN_CDR_REPEAT) {
      if (elements == 0) {
        row += row->extra;
      } else {
        loops[depth].body = row + 1;
        loops[depth].outer = message;
        loops[depth].elements = elements;
        failure->index[depth++] = 0;
        message = memory;
      }
    } else {
      problem = field(s, row, memory, elements, &failure->index[depth]);
    }
    if (problem != IFGEN_CDR_OK) {
      break;
    }
  }
  failure->problem = problem;
  failure->row = (uint16_t)(row - rows);
  failure->depth = depth;
  return problem == IFGEN_CDR_OK;
}

static bool refuse(ifgen_cdr_failure *failure, ifgen_cdr_problem problem)
{
  if (failure != NULL) {
    memset(failure, 0, sizeof *failure);
    failure->problem = problem;
  }
  return false;
}

static size_t put(stream *s, const ifgen_cdr_row *rows, const void *message, ifgen_cdr_failure *failure)
{
  s->swap = is_big_endian();
  /* The walk only writes to the message when it reads a payload. */
  return walk(s, rows, (uint8_t *)(uintptr_t)message, failure) ? HEADER_SIZE + s->position : 0;
}

size_t ifgen_cdr_encode(
  const ifgen_cdr_row *rows, const void *message, uint8_t *bytes, size_t room, ifgen_cdr_failure *failure)
{
  static const uint8_t header[HEADER_SIZE] = {0, 1, 0, 0};
  stream s = {WRITE, false, bytes, 0, 0};
  if (room < HEADER_SIZE) {
    return refuse(failure, IFGEN_CDR_SHORT);
  }
  memcpy(bytes, header, HEADER_SIZE);
  s.body = bytes + HEADER_SIZE;
  s.size = room - HEADER_SIZE;
  return put(&s, rows, message, failure);
}

size_t ifgen_cdr_encoded_size(const ifgen_cdr_row *rows, const void *message, ifgen_cdr_failure *failure)
{
  stream s = {MEASURE, false, NULL, (size_t)-1, 0};
  return put(&s, rows, message, failure);
}

bool ifgen_cdr_decode(
  const ifgen_cdr_row *rows, void *message, const uint8_t *bytes, size_t size, ifgen_cdr_failure *failure)
{
  stream s = {READ, false, NULL, 0, 0};
  if (size < HEADER_SIZE || bytes[0] != 0 || bytes[1] > 1) {
    return refuse(failure, size < HEADER_SIZE ? IFGEN_CDR_SHORT : IFGEN_CDR_HEADER);
  }
  s.swap = (bytes[1] == 0) != is_big_endian();
  s.body = (uint8_t *)(uintptr_t)bytes + HEADER_SIZE;
  s.size = size - HEADER_SIZE;
  return walk(&s, rows, message, failure);
}

void ifgen_cdr_path(const char *const *fields, const ifgen_cdr_failure *failure, char *text, size_t room)
{
  const char *from;
  unsigned index = 0;
  size_t used = 0;
  if (room == 0) {
    return;
  }
  for (from = fields[failure->row]; *from != 0 && used + 1u < room; ++from) {
    text[used++] = *from;
    if (*from == '[') {
      char digits[10];
      size_t i = 0;
      uint32_t value = failure->index[index++];
      do {
        digits[i++] = (char)('0' + value % 10u);
        value /= 10u;
      } while (value != 0);
      while (i > 0 && used + 1u < room) {
        text[used++] = digits[--i];
      }
    }
  }
  text[used] = 0;
}
