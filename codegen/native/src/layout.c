#include "layout.h"

#include <stdlib.h>
#include <string.h>

enum { ENCAPSULATION = 4 };

typedef struct {
  const layout *layout;
  const uint8_t *body; /* alignment counts from here: after the encapsulation header */
  size_t position, end;
  bool swapped;
  const row *rows; /* of the message itself */
  layout_sequence *longest; /* NULL inside repetitions and calls */
} cursor;

/* ---- making -------------------------------------------------------------------------------------------------- */

/* The part that a call means becomes its type. False where there is none before this one. */
static bool resolve(const layout *self, table *added, const uint32_t *calls) {
  for (row *r = added->rows; r < added->rows + added->row_count; r++) {
    if (r->kind != ROW_CALL) continue;
    if (calls[r->type] >= self->count) return false;
    r->type = (uint16_t)calls[r->type];
  }
  return true;
}

/* How deep repetitions and calls go in these rows. */
static uint32_t depth_of(const layout *self, const row *r, const row *end) {
  uint32_t deepest = 0;
  for (; r < end; r++) {
    uint32_t depth = 0;
    if (r->kind == ROW_REPEAT) depth = 1 + depth_of(self, r + 1, r + 1 + r->rows);
    if (r->kind == ROW_CALL) depth = 1 + self->parts[r->type].depth;
    if (depth > deepest) deepest = depth;
    if (r->kind == ROW_REPEAT) r += r->rows;
  }
  return deepest;
}

bool layout_add(layout *self, const char *text, size_t size, const uint32_t *calls, size_t types) {
  layout_part added = {0};
  size_t problem;
  if (self->count > UINT16_MAX || !table_parse(text, size, types, &added.table, &problem)) return false;
  layout_part *parts = NULL;
  if (resolve(self, &added.table, calls)) {
    added.depth = depth_of(self, added.table.rows, added.table.rows + added.table.row_count);
    if (added.depth <= LAYOUT_MAX_DEPTH) parts = realloc(self->parts, (self->count + 1) * sizeof *parts);
  }
  if (!parts) {
    free(added.table.rows);
    return false;
  }
  parts[self->count++] = added;
  self->parts = parts;
  return true;
}

void layout_free(layout *self) {
  for (size_t i = 0; i < self->count; i++) free(self->parts[i].table.rows);
  free(self->parts);
  *self = (layout){0};
}

/* ---- walking ------------------------------------------------------------------------------------------------- */

static bool read_u32(cursor *at, uint32_t *value) {
  size_t position = (at->position + 3) & ~(size_t)3;
  if (position > at->end || at->end - position < 4) return false;
  memcpy(value, at->body + position, 4);
  if (at->swapped) *value = __builtin_bswap32(*value);
  at->position = position + 4;
  return true;
}

/* Nothing is aligned where nothing follows: an empty sequence of doubles ends with its count. */
static bool skip(cursor *at, size_t size, size_t count) {
  if (!count) return true;
  size_t position = (at->position + size - 1) & ~(size - 1);
  if (position > at->end || count > (at->end - position) / size) return false;
  at->position = position + size * count;
  return true;
}

static bool skip_text(cursor *at) {
  uint32_t size;
  return read_u32(at, &size) && skip(at, 1, size);
}

static bool skip_wide_text(cursor *at) {
  uint32_t count, unit;
  if (!read_u32(at, &count)) return false;
  if (count > (at->end - at->position) / 4) return false;
  bool high = false; /* the unit before was the first half of a surrogate pair */
  for (; count; count--) {
    if (!read_u32(at, &unit) || unit > 0xffff) return false;
    bool low = unit >= 0xdc00 && unit <= 0xdfff;
    if (low != high) return false;
    high = unit >= 0xd800 && unit <= 0xdbff;
  }
  return !high;
}

static bool skip_values(cursor *at, const row *r) {
  uint32_t count = r->size;
  const size_t value_size = number_sizes[r->number];
  if (!count && !read_u32(at, &count)) return false;
  const size_t after_count = at->position;
  if (!skip(at, value_size, count)) return false;
  const size_t size = count * value_size;
  if (at->longest && r->number >= NUMBER_INT8 && !r->size && !at->swapped && size > at->longest->size)
    *at->longest = (layout_sequence){.row = (uint32_t)(r - at->rows), .count_at = ENCAPSULATION + after_count - sizeof count,
                                     .values_at = ENCAPSULATION + at->position - size, .value_size = value_size, .size = size};
  return true;
}

static bool walk(cursor *at, const row *r, const row *end);

/* A string, a message of a sequence, or a message that was called. */
static bool skip_element(cursor *at, const row *r) {
  switch (r->kind) {
    case ROW_TEXTS: return skip_text(at);
    case ROW_WTEXTS: return skip_wide_text(at);
    case ROW_REPEAT: return walk(at, r + 1, r + 1 + r->rows);
    default: {
      const table *called = &at->layout->parts[r->type].table;
      return walk(at, called->rows, called->rows + called->row_count);
    }
  }
}

static bool skip_elements(cursor *at, const row *r, uint32_t count) {
  layout_sequence *longest = at->longest;
  at->longest = NULL;
  while (count && skip_element(at, r)) count--;
  at->longest = longest;
  return !count;
}

static bool walk(cursor *at, const row *r, const row *end) {
  for (; r < end; r++) {
    bool skipped = true;
    uint32_t count = r->size;
    switch ((row_kind)r->kind) {
      case ROW_RUN: case ROW_ENTER: break; /* the items of a run are rows, too */
      case ROW_VALUE: skipped = skip(at, number_sizes[r->number], 1); break;
      case ROW_ARRAY: skipped = skip(at, number_sizes[r->number], count); break;
      case ROW_BLANK: skipped = skip(at, 1, 1); break;
      case ROW_TEXT: skipped = skip_text(at); break;
      case ROW_WTEXT: skipped = skip_wide_text(at); break;
      case ROW_VALUES: skipped = skip_values(at, r); break;
      case ROW_TEXTS: case ROW_WTEXTS: case ROW_REPEAT:
        /* Every element takes at least a byte, which caps what a forged count can cost. */
        if (!count && (!read_u32(at, &count) || count > at->end - at->position)) return false;
        skipped = skip_elements(at, r, count);
        if (r->kind == ROW_REPEAT) r += r->rows;
        break;
      case ROW_CALL: skipped = skip_elements(at, r, 1); break;
    }
    if (!skipped) return false;
  }
  return true;
}

bool layout_accepts(const layout *self, const uint8_t *payload, size_t size, layout_sequence *longest, size_t *rest) {
  if (longest) *longest = (layout_sequence){0};
  /* Plain CDR, 00 00 big endian and 00 01 little endian: what the generated decoders read. */
  if (size < ENCAPSULATION || payload[0] != 0 || payload[1] > 1 || !self->count) return false;
  const table *message = &self->parts[self->count - 1].table;
  cursor at = {.layout = self, .body = payload + ENCAPSULATION, .end = size - ENCAPSULATION, .swapped = payload[1] == 0,
               .rows = message->rows, .longest = longest};
  if (!walk(&at, message->rows, message->rows + message->row_count)) return false;
  if (rest) *rest = at.end - at.position;
  return true;
}
