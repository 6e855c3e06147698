/* Feeds well-formed, truncated and random programs and payloads to layout.c; built with ASan and UBSan by
 * tests/native/test_sanitizers.py, so a read outside a buffer ends the program. Prints what it counted. */
#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../src/layout.h"

static uint64_t state = 0x9e3779b97f4a7c15u;

static uint32_t draw(uint32_t below) { /* xorshift64*, the same on every run */
  state ^= state >> 12, state ^= state << 25, state ^= state >> 27;
  return (uint32_t)((state * 0x2545f4914f6cdd1du) >> 32) % below;
}

/* A copy of its own exact size, so that one byte too far is seen. */
static bool accepts(const uint32_t *words, size_t count, const uint8_t *payload, size_t size) {
  uint8_t *copy = malloc(size ? size : 1);
  memcpy(copy, payload, size);
  bool result = layout_accepts(words, count, copy, size);
  free(copy);
  return result;
}

static void test_fixed(void) {
  const uint32_t program[] = {LAYOUT_FIXED, 1, 1, LAYOUT_FIXED, 8, 2};
  uint8_t payload[4 + 24] = {0, 1};
  assert(accepts(program, 6, payload, sizeof payload));
  assert(!accepts(program, 6, payload, sizeof payload - 1));
  assert(!accepts(program, 6, payload, 3));
}

static void test_empty_sequence_takes_no_padding(void) {
  const uint32_t program[] = {LAYOUT_SEQUENCE, 8};
  const uint8_t empty[] = {0, 1, 0, 0, 0, 0, 0, 0}, one[] = {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0};
  assert(accepts(program, 2, empty, sizeof empty));
  assert(!accepts(program, 2, one, sizeof one));
}

static void test_byte_order(void) {
  const uint32_t program[] = {LAYOUT_STRING};
  const uint8_t little[] = {0, 1, 0, 0, 2, 0, 0, 0, 'a', 0}, big[] = {0, 0, 0, 0, 0, 0, 0, 2, 'a', 0};
  assert(accepts(program, 1, little, sizeof little));
  assert(accepts(program, 1, big, sizeof big));
  assert(!accepts(program, 1, big, sizeof big - 1));
}

static void test_huge_counts(void) {
  const uint32_t strings[] = {LAYOUT_REPEAT, LAYOUT_COUNTED, 1, LAYOUT_STRING}, doubles[] = {LAYOUT_SEQUENCE, 8};
  const uint8_t payload[] = {0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0};
  assert(!accepts(strings, 4, payload, sizeof payload));
  assert(!accepts(doubles, 2, payload, sizeof payload));
}

static void test_wide_strings(void) {
  const uint32_t program[] = {LAYOUT_WSTRING};
  uint8_t pair[] = {0, 1, 0, 0, 2, 0, 0, 0, 0x34, 0xd8, 0, 0, 0x1e, 0xdd, 0, 0};
  assert(accepts(program, 1, pair, sizeof pair));
  pair[4] = 1; /* the first half alone */
  assert(!accepts(program, 1, pair, sizeof pair));
  pair[10] = 1; /* beyond 16 bits */
  assert(!accepts(program, 1, pair, sizeof pair));
}

static void test_malformed_programs(void) {
  const uint32_t unknown[] = {9}, cut[] = {LAYOUT_FIXED, 4}, odd[] = {LAYOUT_SEQUENCE, 3};
  const uint32_t beyond[] = {LAYOUT_REPEAT, 2, 5, LAYOUT_STRING}, empty[] = {LAYOUT_REPEAT, 2, 0};
  assert(!layout_is_program(unknown, 1) && !layout_is_program(cut, 2) && !layout_is_program(odd, 2));
  assert(!layout_is_program(beyond, 4) && !layout_is_program(empty, 3));
  assert(layout_is_program(NULL, 0));
}

static void test_parts(void) {
  const uint32_t program[] = {LAYOUT_PART, 0, 3, LAYOUT_FIXED, 2, 2, LAYOUT_PART, 1, 2, LAYOUT_CALL, 0,
                              LAYOUT_FIXED, 1, 1, LAYOUT_CALL, 6, LAYOUT_REPEAT, 2, 2, LAYOUT_CALL, 0};
  uint8_t payload[4 + 14] = {0, 1};
  assert(layout_is_program(program, 21));
  assert(accepts(program, 21, payload, sizeof payload));
  assert(!accepts(program, 21, payload, sizeof payload - 1));
}

static void test_calls_of_nothing(void) {
  const uint32_t none[] = {LAYOUT_CALL, 0}, itself[] = {LAYOUT_PART, 1, 2, LAYOUT_CALL, 0};
  const uint32_t inside[] = {LAYOUT_PART, 0, 3, LAYOUT_FIXED, 2, 2, LAYOUT_CALL, 3};
  const uint32_t further_down[] = {LAYOUT_PART, 1, 2, LAYOUT_CALL, 5, LAYOUT_PART, 0, 1, LAYOUT_STRING};
  const uint32_t too_deep[] = {LAYOUT_PART, 0, 1, LAYOUT_STRING, LAYOUT_PART, 0, 2, LAYOUT_CALL, 0};
  const uint32_t much_too_deep[] = {LAYOUT_PART, LAYOUT_MAX_DEPTH + 1, 1, LAYOUT_STRING};
  const uint32_t late[] = {LAYOUT_STRING, LAYOUT_PART, 0, 1, LAYOUT_STRING}, cut[] = {LAYOUT_PART, 0, 2, LAYOUT_STRING};
  assert(!layout_is_program(none, 2) && !layout_is_program(itself, 5) && !layout_is_program(inside, 8));
  assert(!layout_is_program(further_down, 9) && !layout_is_program(too_deep, 9));
  assert(!layout_is_program(much_too_deep, 4) && !layout_is_program(late, 5) && !layout_is_program(cut, 4));
}

/* Twenty levels of two calls each: 1 MB of a message that a program of 100 words describes. */
static void test_a_short_program_for_a_long_message(void) {
  uint32_t words[200] = {LAYOUT_PART, 0, 3, LAYOUT_FIXED, 1, 1};
  size_t count = 6, before = 0;
  for (uint32_t level = 1; level <= 20; level++) {
    const uint32_t part[] = {LAYOUT_PART, level, 4, LAYOUT_CALL, (uint32_t)before, LAYOUT_CALL, (uint32_t)before};
    memcpy(words + count, part, sizeof part);
    before = count, count += 7;
  }
  words[count++] = LAYOUT_CALL, words[count++] = (uint32_t)before;
  assert(layout_is_program(words, count));
  size_t size = 4 + (1u << 20);
  uint8_t *payload = calloc(size, 1);
  assert(layout_accepts(words, count, payload, size) && !layout_accepts(words, count, payload, size - 1));
  free(payload);
}

static uint32_t starts[8], parts; /* of the program that is being written */

/* Steps, after parts that call each other where it is not nested. */
static size_t write_program(uint32_t *words, size_t room, int nesting) {
  size_t count = 0, steps = 1 + draw(4);
  if (!nesting) parts = 0;
  for (uint32_t wanted = nesting ? 0 : draw(4); parts < wanted;) {
    uint32_t head = (uint32_t)count;
    size_t body = write_program(words + head + 3, 24, 2);
    if (!body) break;
    /* No deeper than two repetitions and a call in each of the parts before. */
    words[head] = LAYOUT_PART, words[head + 1] = 4 * (parts + 1), words[head + 2] = (uint32_t)body;
    starts[parts++] = head, count += 3 + body;
  }
  while (steps-- && room - count > 16) {
    uint32_t size = 1u << draw(4);
    switch (draw(nesting < 3 ? 6 : 5)) {
      case 0: words[count++] = LAYOUT_FIXED, words[count++] = size, words[count++] = 1 + draw(9); break;
      case 1: words[count++] = LAYOUT_STRING; break;
      case 2: words[count++] = LAYOUT_WSTRING; break;
      case 3: words[count++] = LAYOUT_SEQUENCE, words[count++] = size; break;
      case 4:
        if (parts) words[count++] = LAYOUT_CALL, words[count++] = starts[draw(parts)];
        else words[count++] = LAYOUT_STRING;
        break;
      default: {
        size_t head = count;
        words[count++] = LAYOUT_REPEAT, words[count++] = draw(2) ? LAYOUT_COUNTED : 1 + draw(4), count++;
        size_t body = write_program(words + count, room - count, nesting + 1);
        if (!body) count = head;
        else words[head + 2] = (uint32_t)body, count += body;
      }
    }
  }
  return count;
}

int main(void) {
  test_fixed();
  test_empty_sequence_takes_no_padding();
  test_byte_order();
  test_huge_counts();
  test_wide_strings();
  test_malformed_programs();
  test_parts();
  test_calls_of_nothing();
  test_a_short_program_for_a_long_message();
  unsigned accepted = 0, refused = 0, programs = 0;
  for (int round = 0; round < 60000; round++) {
    uint32_t words[128];
    size_t count = write_program(words, 128, 0);
    assert(layout_is_program(words, count));
    uint8_t payload[200] = {0, (uint8_t)draw(2)};
    size_t size = draw(sizeof payload + 1);
    /* Mostly zeros and small numbers: counts that can be met. */
    for (size_t i = 4; i < sizeof payload; i++) payload[i] = draw(6) ? 0 : (uint8_t)draw(draw(3) ? 4 : 256);
    if (accepts(words, count, payload, size)) accepted++;
    else refused++;
    words[draw((uint32_t)count)] = draw(10);
    if (layout_is_program(words, count)) programs++, (void)accepts(words, count, payload, size);
  }
  printf("accepted %u refused %u mutated programs run %u\n", accepted, refused, programs);
  return accepted && refused && programs ? 0 : 1;
}
