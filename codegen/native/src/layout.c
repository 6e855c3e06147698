#include "layout.h"

#include <string.h>

typedef struct {
  const uint32_t *program;
  const uint8_t *body; /* alignment counts from here: after the encapsulation header */
  size_t position, end;
  bool swapped;
} cursor;

static size_t words_of(uint32_t opcode) {
  switch (opcode) {
    case LAYOUT_FIXED: return 3;
    case LAYOUT_STRING: return 1;
    case LAYOUT_WSTRING: return 1;
    case LAYOUT_SEQUENCE: return 2;
    case LAYOUT_REPEAT: return 3;
    case LAYOUT_PART: return 3;
    case LAYOUT_CALL: return 2;
    default: return 0;
  }
}

static bool is_size(uint32_t size) { return size == 1 || size == 2 || size == 4 || size == 8; }

/* The part that begins at a word of the program, among those that end before `end`; NULL if none does. */
static const uint32_t *part_at(const uint32_t *program, size_t end, uint32_t start) {
  size_t at = 0;
  while (at < start && at < end) at += 3 + (size_t)program[at + 2];
  return at == start && at < end ? program + at : NULL;
}

/* Whether the words are steps that go no deeper than `depth`. The program's parts up to `parts_end` are known to be right. */
static bool are_steps(const uint32_t *words, size_t count, uint32_t depth, const uint32_t *program, size_t parts_end) {
  while (count) {
    size_t step = words_of(words[0]);
    if (!step || step > count || words[0] == LAYOUT_PART) return false;
    if ((words[0] == LAYOUT_FIXED || words[0] == LAYOUT_SEQUENCE) && !is_size(words[1])) return false;
    if (words[0] == LAYOUT_REPEAT) {
      size_t body = words[2];
      if (!depth || !body || body > count - step || !are_steps(words + step, body, depth - 1, program, parts_end)) return false;
      step += body;
    }
    if (words[0] == LAYOUT_CALL) {
      const uint32_t *part = part_at(program, parts_end, words[1]);
      if (!part || part[1] >= depth) return false;
    }
    words += step;
    count -= step;
  }
  return true;
}

bool layout_is_program(const uint32_t *words, size_t count) {
  size_t at = 0;
  while (at < count && words[at] == LAYOUT_PART) {
    if (count - at < 3) return false;
    size_t body = words[at + 2];
    if (!body || body > count - at - 3 || words[at + 1] > LAYOUT_MAX_DEPTH) return false;
    if (!are_steps(words + at + 3, body, words[at + 1], words, at)) return false;
    at += 3 + body;
  }
  return are_steps(words + at, count - at, LAYOUT_MAX_DEPTH, words, at);
}

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

static bool skip_wstring(cursor *at) {
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

static bool walk(cursor *at, const uint32_t *words, const uint32_t *end) {
  while (words < end) {
    size_t step = words_of(words[0]);
    uint32_t count;
    switch (words[0]) {
      case LAYOUT_FIXED:
        if (!skip(at, words[1], words[2])) return false;
        break;
      case LAYOUT_STRING:
        if (!read_u32(at, &count) || !skip(at, 1, count)) return false;
        break;
      case LAYOUT_WSTRING:
        if (!skip_wstring(at)) return false;
        break;
      case LAYOUT_SEQUENCE:
        if (!read_u32(at, &count) || !skip(at, words[1], count)) return false;
        break;
      case LAYOUT_REPEAT:
        count = words[1];
        /* Every element takes at least a byte, which caps what a forged count can cost. */
        if (count == LAYOUT_COUNTED && (!read_u32(at, &count) || count > at->end - at->position)) return false;
        for (const uint32_t *body = words + step; count; count--)
          if (!walk(at, body, body + words[2])) return false;
        step += words[2];
        break;
      case LAYOUT_PART:
        step += words[2];
        break;
      case LAYOUT_CALL: {
        const uint32_t *part = at->program + words[1];
        if (!walk(at, part + 3, part + 3 + part[2])) return false;
        break;
      }
      default: return false;
    }
    words += step;
  }
  return true;
}

bool layout_accepts(const uint32_t *program, size_t count, const uint8_t *payload, size_t size) {
  /* Plain CDR, 00 00 big endian and 00 01 little endian: what the generated decoders read. */
  if (size < 4 || payload[0] != 0 || payload[1] > 1) return false;
  cursor at = {program, payload + 4, 0, size - 4, payload[1] == 0};
  return walk(&at, program, program + count);
}
