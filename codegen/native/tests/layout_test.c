/* Feeds well-formed, truncated and random tables and payloads to layout.c and table.c; built with ASan and UBSan by
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
static void *exactly(const void *bytes, size_t size) {
  void *copy = malloc(size ? size : 1);
  memcpy(copy, bytes, size);
  return copy;
}

static bool add(layout *to, const char *text, const uint32_t *calls, size_t types) {
  char *copy = exactly(text, strlen(text));
  bool added = layout_add(to, copy, strlen(text), calls, types);
  free(copy);
  return added;
}

/* The longest sequence is where it says, whatever the payload. */
static bool accepts(const layout *self, const uint8_t *payload, size_t size, layout_sequence *longest) {
  uint8_t *copy = exactly(payload, size);
  layout_sequence found;
  size_t rest = 0;
  bool result = layout_accepts(self, copy, size, &found, &rest);
  assert(result == layout_accepts(self, copy, size, NULL, NULL));
  assert(!result || rest <= size - 4);
  /* A message ends where its rest begins. */
  assert(!result || (layout_accepts(self, copy, size - rest, NULL, NULL) && !(size - rest > 4 && layout_accepts(self, copy, size - rest - 1, NULL, NULL))));
  if (result && found.size) {
    uint32_t count;
    memcpy(&count, copy + found.count_at, 4);
    assert(found.size == count * found.value_size && found.values_at + found.size <= size);
    assert(layout_rows(self)[found.row].kind == ROW_VALUES);
  }
  if (longest) *longest = found;
  free(copy);
  return result;
}

/* Of a table without calls. */
static bool accepts_one(const char *text, const uint8_t *payload, size_t size, layout_sequence *longest) {
  layout one = {0};
  uint32_t none[8] = {0};
  assert(add(&one, text, none, 8));
  bool result = accepts(&one, payload, size, longest);
  layout_free(&one);
  return result;
}

static void test_fixed(void) {
  uint8_t payload[4 + 24] = {0, 1};
  assert(accepts_one("R2 B0._a Ad0._b.2", payload, sizeof payload, NULL));
  assert(!accepts_one("R2 B0._a Ad0._b.2", payload, sizeof payload - 1, NULL));
  assert(!accepts_one("R2 B0._a Ad0._b.2", payload, 3, NULL));
}

static void test_empty_sequence_takes_no_padding(void) {
  const uint8_t empty[] = {0, 1, 0, 0, 0, 0, 0, 0}, one[] = {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0};
  assert(accepts_one("Sd0._a.0.0", empty, sizeof empty, NULL));
  assert(!accepts_one("Sd0._a.0.0", one, sizeof one, NULL));
}

static void test_byte_order(void) {
  const uint8_t little[] = {0, 1, 0, 0, 2, 0, 0, 0, 'a', 0}, big[] = {0, 0, 0, 0, 0, 0, 0, 2, 'a', 0};
  assert(accepts_one("T0._a.0", little, sizeof little, NULL));
  assert(accepts_one("T0._a.0", big, sizeof big, NULL));
  assert(!accepts_one("T0._a.0", big, sizeof big - 1, NULL));
}

static void test_huge_counts(void) {
  const uint8_t payload[] = {0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0};
  assert(!accepts_one("L0._a.0.0.0", payload, sizeof payload, NULL));
  assert(!accepts_one("Sd0._a.0.0", payload, sizeof payload, NULL));
}

static void test_wide_strings(void) {
  uint8_t pair[] = {0, 1, 0, 0, 2, 0, 0, 0, 0x34, 0xd8, 0, 0, 0x1e, 0xdd, 0, 0};
  assert(accepts_one("W0._a.0", pair, sizeof pair, NULL));
  pair[4] = 1; /* the first half alone */
  assert(!accepts_one("W0._a.0", pair, sizeof pair, NULL));
  pair[10] = 1; /* beyond 16 bits */
  assert(!accepts_one("W0._a.0", pair, sizeof pair, NULL));
}

static void test_the_longest_sequence(void) {
  layout_sequence longest;
  uint8_t payload[] = {0, 1, 0, 0, 1, 2, 0, 0, 2, 0, 0, 0, 7, 7, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 9, 9, 9, 9, 9, 9, 9, 9};
  const char *text = "R1 B0._a Sh0._b.0.0 Sd0._c.0.0";
  payload[8] = 1;
  assert(accepts_one(text, payload, sizeof payload, &longest));
  assert(longest.row == 3 && longest.count_at == 16 && longest.values_at == 20 && longest.size == 8 && longest.value_size == 8);
  /* Not in a repetition, of fixed size, of what is a list in Python, or in the other byte order. */
  const uint8_t two[] = {0, 1, 0, 0, 2, 0, 0, 0, 7, 7};
  assert(accepts_one("SB0._a.0.0", two, sizeof two, &longest) && longest.size == 2);
  assert(accepts_one("F0._a.1.0.1.0.1 SB1._b.0.0", two, sizeof two, &longest) && !longest.size);
  assert(accepts_one("SB0._a.6.0", two, sizeof two, &longest) && !longest.size);
  assert(accepts_one("S?0._b.0.0", two, sizeof two, &longest) && !longest.size);
  const uint8_t big[] = {0, 0, 0, 0, 0, 0, 0, 1, 7};
  assert(accepts_one("SB0._a.0.0", big, sizeof big, &longest) && !longest.size);
}

static void test_calls_go_back_only(void) {
  layout self = {0};
  const uint32_t first = 0, second = 1;
  assert(!add(&self, "R1 E0._a.1.0 C1.0", &first, 1)); /* nothing */
  assert(add(&self, "R1 Ah0._a.2", NULL, 0));
  assert(!add(&self, "R1 E0._a.1.0 C1.0", &second, 1)); /* itself */
  assert(add(&self, "R2 E0._a.1.0 B0._b C1.0", &first, 1));
  uint8_t payload[4 + 6] = {0, 1};
  assert(accepts(&self, payload, sizeof payload, NULL) && !accepts(&self, payload, sizeof payload - 1, NULL));
  layout_free(&self);
}

/* Twenty levels of two calls each: 1 MB of a message that a few rows describe. */
static void test_a_short_layout_for_a_long_message(void) {
  layout self = {0};
  assert(add(&self, "R1 B0._a", NULL, 0));
  for (uint32_t level = 0; level < 20; level++) assert(add(&self, "R2 E0._a.1.0 E0._b.2.0 C1.0 C2.0", &level, 1));
  size_t size = 4 + (1u << 20), rest;
  uint8_t *payload = calloc(size, 1);
  assert(layout_accepts(&self, payload, size, NULL, &rest) && rest == 0 && !layout_accepts(&self, payload, size - 1, NULL, NULL));
  free(payload);
  layout_free(&self);
}

typedef struct {
  char text[20000];
  size_t size;
  unsigned messages;
} writer;

#define WRITE(w, ...) ((w)->size += (size_t)snprintf((w)->text + (w)->size, sizeof (w)->text - (w)->size, __VA_ARGS__))

static unsigned write_rows(writer *, unsigned message, unsigned parts, int nesting);

/* Returns the number of rows. */
static unsigned write_row(writer *w, unsigned message, unsigned parts, int nesting) {
  const char letter = number_letters[draw(NUMBER_COUNT)];
  const char *count = draw(3) ? "0.0" : draw(2) ? "3.0" : "0.2";
  switch (draw(nesting < 3 ? 8 : 6)) {
    case 0: WRITE(w, " R2 %c%u._a Z", letter, message); return 3;
    case 1: WRITE(w, " R1 Ad%u._a.%u", message, 1 + draw(9)); return 2;
    case 2: WRITE(w, " %c%u._a.0", draw(2) ? 'T' : 'W', message); return 1;
    case 3: WRITE(w, " S%c%u._a.%s", letter, message, count); return 1;
    case 4: WRITE(w, " %c%u._a.0.%s", draw(2) ? 'L' : 'K', message, count); return 1;
    case 5: {
      if (!parts) return 0;
      unsigned target = w->messages++, type = draw(parts);
      WRITE(w, " R1 E%u._a.%u.%u C%u.%u", message, target, type, target, type);
      return 3;
    }
    default: {
      unsigned target = w->messages++;
      writer body = {.messages = w->messages};
      unsigned rows = write_rows(&body, target, parts, nesting + 1);
      w->messages = body.messages;
      WRITE(w, " F%u._a.%u.0.%s.%u%s", message, target, count, rows, body.text);
      return 1 + rows;
    }
  }
}

static unsigned write_rows(writer *w, unsigned message, unsigned parts, int nesting) {
  unsigned rows = 0;
  for (unsigned steps = 1 + draw(3); steps || !rows; steps -= steps > 0) rows += write_row(w, message, parts, nesting);
  return rows;
}

int main(void) {
  test_fixed();
  test_empty_sequence_takes_no_padding();
  test_byte_order();
  test_huge_counts();
  test_wide_strings();
  test_the_longest_sequence();
  test_calls_go_back_only();
  test_a_short_layout_for_a_long_message();
  unsigned accepted = 0, refused = 0, mutated = 0;
  const uint32_t calls[] = {0, 1, 2, 3};
  for (int round = 0; round < 40000; round++) {
    layout self = {0};
    for (unsigned part = 0, parts = 1 + draw(4); part < parts; part++) {
      writer w = {.messages = 1};
      write_rows(&w, 0, part, 0);
      char *text = w.text + 1; /* after the first space */
      assert(add(&self, text, calls, 4));
      text[draw((uint32_t)w.size - 1)] = " .0123456789RETSFCdZ"[draw(20)];
      mutated += add(&self, text, calls, 4);
      if (self.count > part + 1) free(self.parts[--self.count].table.rows); /* calls mean what they meant */
      uint8_t payload[200] = {0, (uint8_t)draw(2)};
      size_t size = draw(sizeof payload + 1);
      /* Mostly zeros and small numbers: counts that can be met. */
      for (size_t i = 4; i < sizeof payload; i++) payload[i] = draw(6) ? 0 : (uint8_t)draw(draw(3) ? 4 : 256);
      if (accepts(&self, payload, size, NULL)) accepted++;
      else refused++;
    }
    layout_free(&self);
  }
  printf("accepted %u refused %u mutated tables parsed %u\n", accepted, refused, mutated);
  return accepted && refused && mutated ? 0 : 1;
}
