/* From the text of a table to its rows. What the interpreter relies on is checked here: a row names only messages that
 * were entered before and are still there, runs hold only what a run may hold, bodies end where they should. */
#include "table.h"

#include <stdlib.h>
#include <string.h>

const uint8_t number_sizes[NUMBER_COUNT] = {1, 1, 1, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
const char number_letters[NUMBER_COUNT + 1] = "?ocbBhHiIqQfd";

enum { MOST_ROWS = 1 << 16, MOST_BYTES = 1 << 30 };

/* What is known of the message with a number. One that was called or whose loop has ended is GONE. */
enum { UNKNOWN, ENTERED, USED, GONE };

typedef struct {
  const char *text, *at, *end;
  size_t types;
  row *rows;
  uint32_t count, capacity; /* of rows */
  uint8_t *states;          /* of messages; there are fewer than rows */
  uint32_t messages;
  unsigned depth;
} parser;

/* A decimal number without a sign. */
static bool parse_number(parser *p, uint32_t limit, uint32_t *value) {
  const char *start = p->at;
  uint64_t number = 0;
  for (; p->at < p->end && *p->at >= '0' && *p->at <= '9'; p->at++)
    if ((number = number * 10 + (uint64_t)(*p->at - '0')) > limit) return false;
  *value = (uint32_t)number;
  return p->at > start;
}

static bool parse_character(parser *p, char wanted) { return p->at < p->end && *p->at == wanted && p->at++; }

/* A dot and a number. */
static bool parse_argument(parser *p, uint32_t limit, uint32_t *value) {
  return parse_character(p, '.') && parse_number(p, limit, value);
}

static bool parse_message(parser *p, row *r) {
  uint32_t message;
  if (!parse_number(p, MOST_ROWS - 1, &message) || message >= p->messages) return false;
  if (p->states[message] != ENTERED && p->states[message] != USED) return false;
  r->message = (uint16_t)message;
  return true;
}

static bool parse_slot(parser *p, row *r) {
  if (!parse_message(p, r) || !parse_character(p, '.')) return false;
  p->states[r->message] = USED;
  const char *start = p->at;
  while (p->at < p->end && *p->at != '.' && *p->at != ' ') p->at++;
  r->name = (uint32_t)(start - p->text);
  r->name_size = (uint32_t)(p->at - start);
  return r->name_size > 0;
}

static bool parse_basic_type(parser *p, row *r) {
  const char *letter = p->at < p->end && *p->at ? strchr(number_letters, *p->at) : NULL;
  if (!letter) return false;
  r->number = (uint8_t)(letter - number_letters);
  p->at++;
  return true;
}

static bool parse_type(parser *p, row *r) {
  uint32_t type;
  if (!parse_argument(p, UINT16_MAX, &type) || type >= p->types) return false;
  r->type = (uint16_t)type;
  return true;
}

/* The number and the type of a message that was not seen before. Numbers come in order. */
static bool parse_target(parser *p, row *r) {
  uint32_t target;
  if (!parse_argument(p, MOST_ROWS - 1, &target) || target != p->messages || p->messages >= p->capacity) return false;
  r->target = (uint16_t)target;
  p->states[p->messages++] = ENTERED;
  return parse_type(p, r);
}

static bool parse_count(parser *p, row *r) {
  return parse_argument(p, MOST_BYTES, &r->size) && parse_argument(p, UINT32_MAX, &r->maximum) && !(r->size && r->maximum);
}

/* A called message must be fresh: rows of its own would fill slots that its table fills, too. */
static bool parse_called(parser *p, row *r) {
  if (!parse_message(p, r) || !r->message || p->states[r->message] == USED) return false;
  p->states[r->message] = GONE;
  r->target = r->message;
  return parse_type(p, r);
}

/* One row and its arguments, whatever comes before and after it. */
static bool parse_row(parser *p, row *r) {
  if (p->at == p->end) return false;
  char letter = *p->at++;
  switch (letter) {
    case 'R': r->kind = ROW_RUN; return parse_number(p, MOST_ROWS, &r->rows) && r->rows;
    case 'E': r->kind = ROW_ENTER; return parse_slot(p, r) && parse_target(p, r);
    case 'A':
      r->kind = ROW_ARRAY;
      return parse_basic_type(p, r) && r->number >= NUMBER_INT8 && parse_slot(p, r) && parse_argument(p, MOST_BYTES, &r->size) && r->size;
    case 'Z': r->kind = ROW_BLANK; return true;
    case 'T': case 'W':
      r->kind = letter == 'T' ? ROW_TEXT : ROW_WTEXT;
      return parse_slot(p, r) && parse_argument(p, UINT32_MAX, &r->bound);
    case 'S':
      r->kind = ROW_VALUES;
      return parse_basic_type(p, r) && parse_slot(p, r) && parse_count(p, r);
    case 'L': case 'K':
      r->kind = letter == 'L' ? ROW_TEXTS : ROW_WTEXTS;
      return parse_slot(p, r) && parse_argument(p, UINT32_MAX, &r->bound) && parse_count(p, r);
    case 'F':
      r->kind = ROW_REPEAT;
      return parse_slot(p, r) && parse_target(p, r) && parse_count(p, r) && parse_argument(p, MOST_ROWS, &r->rows) && r->rows;
    case 'C': r->kind = ROW_CALL; return parse_called(p, r);
    default:
      p->at--;
      r->kind = ROW_VALUE;
      return parse_basic_type(p, r) && parse_slot(p, r);
  }
}

static bool may_be_in_run(const row *r) {
  return r->kind == ROW_ENTER || r->kind == ROW_VALUE || r->kind == ROW_ARRAY || r->kind == ROW_BLANK;
}

/* The next row of the text, after the space between two. NULL where it is malformed. */
static row *next_row(parser *p) {
  if (p->count == p->capacity || (p->count && !parse_character(p, ' '))) return NULL;
  row *r = &p->rows[p->count++];
  *r = (row){0};
  return parse_row(p, r) && (p->at == p->end || *p->at == ' ') ? r : NULL;
}

static uint32_t item_size(const row *r) {
  if (r->kind == ROW_ENTER) return 0;
  return r->kind == ROW_BLANK ? 1 : number_sizes[r->number] * (r->kind == ROW_ARRAY ? r->size : 1);
}

/* The rows of a run. `least` grows by what they take without paddings. */
static bool parse_run(parser *p, row *run, uint64_t *least) {
  uint64_t most = 0;
  for (uint32_t i = 0; i < run->rows; i++) {
    row *r = next_row(p);
    if (!r || !may_be_in_run(r) || r->size > MOST_BYTES / 8) return false;
    *least += item_size(r);
    most += item_size(r) + 7;
    if (most > MOST_BYTES) return false;
  }
  run->most = (uint32_t)most;
  return true;
}

static bool parse_rows(parser *p, uint32_t stop, bool to_end, uint64_t *least);

/* The rows of a body. What is entered in it is gone after it. */
static bool parse_body(parser *p, row *repeat) {
  uint32_t first = repeat->target;
  uint64_t least = 0;
  if (++p->depth > TABLE_MAX_DEPTH || !parse_rows(p, p->count + repeat->rows, false, &least)) return false;
  p->depth--;
  memset(p->states + first, GONE, p->messages - first);
  repeat->least = least > MOST_BYTES ? MOST_BYTES : (uint32_t)least;
  return repeat->least > 0;
}

/* Rows up to the row `stop` or to the end of the text. */
static bool parse_rows(parser *p, uint32_t stop, bool to_end, uint64_t *least) {
  while (to_end ? p->at < p->end : p->count < stop) {
    row *r = next_row(p);
    if (!r || may_be_in_run(r)) return false;
    switch (r->kind) {
      case ROW_RUN:
        if (!parse_run(p, r, least)) return false;
        break;
      case ROW_REPEAT:
        if (!parse_body(p, r)) return false;
        *least += r->size ? (uint64_t)r->least * r->size : 4;
        break;
      case ROW_VALUES:
        r->least = number_sizes[r->number];
        *least += r->size ? (uint64_t)r->least * r->size : 4;
        break;
      case ROW_TEXTS: case ROW_WTEXTS:
        r->least = 4;
        *least += r->size ? 4 * (uint64_t)r->size : 4;
        break;
      case ROW_CALL: *least += 1; break;
      default: *least += 4; break;
    }
  }
  return to_end || p->count == stop;
}

bool table_parse(const char *text, size_t size, size_t types, table *parsed, size_t *problem) {
  *parsed = (table){0};
  *problem = 0;
  if (size > UINT32_MAX) return false;
  uint32_t capacity = 1;
  for (size_t i = 0; i < size; i++) capacity += text[i] == ' ';
  if (capacity > MOST_ROWS) return false;
  parser p = {.text = text, .at = text, .end = text + size, .types = types, .capacity = capacity, .messages = 1};
  p.rows = malloc(capacity * sizeof *p.rows);
  p.states = calloc((size_t)capacity + 1, 1);
  uint64_t least = 0;
  bool sound = p.rows && p.states && size;
  if (sound) {
    p.states[0] = USED; /* the message itself */
    sound = parse_rows(&p, 0, true, &least) && p.count == capacity;
  }
  *problem = (size_t)(p.at - p.text);
  free(p.states);
  if (!sound) {
    free(p.rows);
    return false;
  }
  *parsed = (table){p.rows, p.count, p.messages};
  return true;
}
