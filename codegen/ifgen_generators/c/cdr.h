/* The CDR codec of the generated messages: XCDR version 1, as ROS 2 sends it. C99, freestanding, no heap, no recursion.
 *
 * Each message is a table of rows, which one function walks to write, to read or to measure. A table costs less flash
 * than code for each message. Strings and sequences have room for their bound, which the options of the generator set.
 */
#ifndef IFGEN_CDR_H_
#define IFGEN_CDR_H_

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How deep arrays and sequences of messages are nested in the generated types, at least 1. */
#define IFGEN_CDR_DEPTH @depth@

enum {
  IFGEN_CDR_END,      /* of the message, or of the element of a REPEAT */
  IFGEN_CDR_NUMBERS,  /* `count` blocks of `stride` bytes, all of them numbers of `width` bytes */
  IFGEN_CDR_BOOLS,    /* `count` booleans */
  IFGEN_CDR_STRINGS,  /* `count` buffers of `stride` characters, which end with NUL */
  IFGEN_CDR_WSTRINGS, /* `count` structs of `stride` bytes: the number of UTF-16 units, then the units */
  IFGEN_CDR_COUNT,    /* the number of elements of the next row, at most `count` */
  IFGEN_CDR_REPEAT,   /* `count` elements of `stride` bytes. The next `extra` rows describe one of them */
  IFGEN_CDR_BLANK     /* the one byte of a message without fields */
};

typedef struct {
  uint8_t kind;
  uint8_t width;   /* bytes of a number on the wire */
  uint16_t extra;  /* REPEAT: rows; NUMBERS: whether they are floats; STRINGS and WSTRINGS: most characters, or 0 if the buffer is the only bound */
  uint32_t offset; /* of the field in its message or element */
  uint32_t count;  /* 0: the number that the COUNT before it has */
  uint32_t stride;
} ifgen_cdr_row;

typedef enum {
  IFGEN_CDR_OK,
  IFGEN_CDR_SHORT,     /* decoding: the payload ends before the message; encoding: the buffer has too little room */
  IFGEN_CDR_BOUND,     /* more elements or characters than the bound of the field */
  IFGEN_CDR_CHARACTER, /* a string without NUL in its buffer; a character of a wstring that is no unit of UTF-16 */
  IFGEN_CDR_HEADER     /* the payload does not begin with 0000 or 0001 */
} ifgen_cdr_problem;

/* What went wrong and where. `X_fields[failure.row]` is the field's path, with `[]` for each of the `depth` indices. */
typedef struct {
  ifgen_cdr_problem problem;
  uint16_t row;
  uint8_t depth;
  uint32_t index[IFGEN_CDR_DEPTH + 1];
} ifgen_cdr_failure;

/* Write a message with its header. Return the number of bytes, or 0 on failure. `failure` may be NULL. */
size_t ifgen_cdr_encode(
  const ifgen_cdr_row *rows, const void *message, uint8_t *bytes, size_t room, ifgen_cdr_failure *failure);

/* Read a payload of either byte order, and nothing outside it. Bytes after the message are ignored. Return whether it
 * succeeded; after a failure, the message holds the fields before the one at fault. `failure` may be NULL. */
bool ifgen_cdr_decode(
  const ifgen_cdr_row *rows, void *message, const uint8_t *bytes, size_t size, ifgen_cdr_failure *failure);

/* Return the number of bytes that encoding needs, or 0 for a message that cannot be encoded. */
size_t ifgen_cdr_encoded_size(const ifgen_cdr_row *rows, const void *message, ifgen_cdr_failure *failure);

/* Return whether two messages have equal fields: by IEEE 754, NaN is not equal to itself, and -0.0 is equal to 0.0.
 * It is in equal.c. */
bool ifgen_cdr_equal(const ifgen_cdr_row *rows, const void *message, const void *other);

/* Write the path of the failure to `text`, such as `transforms[3].header.frame_id`: at most `room` characters with the
 * NUL, the rest is cut off. `fields` is the X_fields of the message. */
void ifgen_cdr_path(const char *const *fields, const ifgen_cdr_failure *failure, char *text, size_t room);

#ifdef __cplusplus
}
#endif

#endif /* IFGEN_CDR_H_ */
