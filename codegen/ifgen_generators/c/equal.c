#include "ifgen/cdr.h"

#include <string.h>

/* A loop over the rows of both messages. A file of its own: a program that compares nothing leaves it out. */

static bool floats(const uint8_t *one, const uint8_t *other, size_t size, size_t width)
{
  size_t i;
  for (i = 0; i < size; i += width) {
    double a;
    double b;
    if (width == sizeof(float)) {
      float narrow;
      memcpy(&narrow, one + i, sizeof narrow);
      a = (double)narrow;
      memcpy(&narrow, other + i, sizeof narrow);
      b = (double)narrow;
    } else {
      memcpy(&a, one + i, sizeof a);
      memcpy(&b, other + i, sizeof b);
    }
    if (!(a <= b && a >= b)) { /* a warning forbids `==` */
      return false;
    }
  }
  return true;
}

static bool strings(const uint8_t *one, const uint8_t *other, size_t room)
{
  size_t i;
  for (i = 0; i < room && one[i] == other[i]; ++i) {
    if (one[i] == 0) {
      return true;
    }
  }
  return i == room;
}

static bool wstrings(const uint8_t *one, const uint8_t *other, size_t room)
{
  uint32_t units;
  memcpy(&units, one, sizeof units);
  return units <= (room - sizeof units) / sizeof(uint16_t)
    && memcmp(one, other, sizeof units + units * sizeof(uint16_t)) == 0;
}

/* One field that is neither COUNT nor REPEAT. */
static bool field(const ifgen_cdr_row *row, const uint8_t *one, const uint8_t *other, uint32_t elements)
{
  uint32_t i;
  bool is_equal = true;
  for (i = 0; i < elements && is_equal && row->kind != IFGEN_CDR_BLANK; ++i) {
    const size_t at = (size_t)i * row->stride;
    switch (row->kind) {
      case IFGEN_CDR_STRINGS:
        is_equal = strings(one + at, other + at, row->stride);
        break;
      case IFGEN_CDR_WSTRINGS:
        is_equal = wstrings(one + at, other + at, row->stride);
        break;
      default:
        is_equal = row->kind == IFGEN_CDR_NUMBERS && row->extra != 0
          ? floats(one + at, other + at, row->stride, row->width)
          : memcmp(one + at, other + at, row->stride) == 0;
        break;
    }
  }
  return is_equal;
}

bool ifgen_cdr_equal(const ifgen_cdr_row *rows, const void *message, const void *other_message)
{
  struct {
    const ifgen_cdr_row *repeat;
    const uint8_t *one;
    const uint8_t *other;
    uint32_t left;
  } loops[IFGEN_CDR_DEPTH];
  const uint8_t *one = message;
  const uint8_t *other = other_message;
  const ifgen_cdr_row *row = rows;
  uint32_t counted = 0;
  uint8_t depth = 0;
  for (;; ++row) {
    const uint8_t *a = one + row->offset;
    const uint8_t *b = other + row->offset;
    const uint32_t elements = row->count != 0 ? row->count : counted;
    if (row->kind == IFGEN_CDR_END) {
      if (depth == 0) {
        return true;
      }
      if (--loops[depth - 1u].left != 0) {
        row = loops[depth - 1u].repeat;
        one += row->stride;
        other += row->stride;
      } else {
        --depth;
        one = loops[depth].one;
        other = loops[depth].other;
      }
    } else if (row->kind == IFGEN_CDR_COUNT) {
      memcpy(&counted, a, sizeof counted);
      if (counted > row->count || memcmp(a, b, sizeof counted) != 0) {
        return false;
      }
    } else if (row->kind != IFGEN_CDR_REPEAT) {
      if (!field(row, a, b, elements)) {
        return false;
      }
    } else if (elements == 0) {
      row += row->extra;
    } else {
      loops[depth].repeat = row;
      loops[depth].one = one;
      loops[depth].other = other;
      loops[depth++].left = elements;
      one = a;
      other = b;
    }
  }
}
