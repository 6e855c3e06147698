/* Is this payload a well-formed message of its type? Asked under a DDS lock, so: no Python, no allocation. */
#ifndef IFGEN_NATIVE_LAYOUT_H
#define IFGEN_NATIVE_LAYOUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "table.h"

enum { LAYOUT_MAX_DEPTH = 1024 }; /* repetitions and calls in each other: a stack of 150 kB, and more than Python can read */

typedef struct {
  table table; /* the `type` of a call is the index of the part that it calls */
  uint32_t depth;
} layout_part;

/* What the body of a message is made of: the rows of its codec, for whose slots and classes nobody asks here. Bounds
 * are not checked: compiled type supports accept what is over its bound, and so do ours. */
typedef struct {
  layout_part *parts; /* the last is the message itself; each calls only parts before it */
  size_t count;
} layout;

/* Add a part with the text of its table and, for each of its types, the index of the part that a call of it means. False
 * where the text is malformed, calls what is not before it, or goes too deep; the layout then is as before. */
bool layout_add(layout *, const char *text, size_t size, const uint32_t *calls, size_t types);

void layout_free(layout *);

/* The rows of the message itself. */
static inline const row *layout_rows(const layout *self) { return self->parts[self->count - 1].table.rows; }

/* A sequence of numbers in a payload. */
typedef struct {
  uint32_t row;     /* of the message's own table, outside all repetitions */
  size_t count_at;  /* where its count is [bytes from the start of the payload] */
  size_t values_at; /* where its values are */
  size_t value_size, size; /* of a value, of all [bytes] */
} layout_sequence;

/* Whether a payload, its 4-byte encapsulation header included, holds a whole message. Trailing bytes are fine: `rest`
 * becomes their number. `longest` may be NULL, as may `rest`. It becomes the longest sequence of numbers outside all
 * repetitions and calls; its size is 0 where there is none, and where the payload has the other byte order. */
bool layout_accepts(const layout *, const uint8_t *payload, size_t size, layout_sequence *longest, size_t *rest);

#endif
