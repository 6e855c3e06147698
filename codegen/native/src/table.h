/* The table of a message class: what happens to each of its fields on the wire, as rows that C runs. `ifgen generate`
 * writes tables (codec/table.py has the text of each row); nothing of a text is trusted. */
#ifndef IFGEN_NATIVE_TABLE_H
#define IFGEN_NATIVE_TABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TABLE_MAX_DEPTH = 200 }; /* repetitions and calls in each other: a stack of 100 kB */

typedef enum {
  NUMBER_BOOLEAN,
  NUMBER_OCTET,
  NUMBER_CHAR,
  NUMBER_INT8,
  NUMBER_UINT8,
  NUMBER_INT16,
  NUMBER_UINT16,
  NUMBER_INT32,
  NUMBER_UINT32,
  NUMBER_INT64,
  NUMBER_UINT64,
  NUMBER_FLOAT32,
  NUMBER_FLOAT64,
  NUMBER_COUNT,
} number_type;

extern const uint8_t number_sizes[NUMBER_COUNT];
extern const char number_letters[NUMBER_COUNT + 1]; /* from INT8 on those of array.array */

typedef enum {
  ROW_RUN,    /* the next rows are values, arrays, blanks and messages entered; they take at most `most` bytes */
  ROW_ENTER,  /* the slot holds the message `target`; nothing on the wire */
  ROW_VALUE,  /* a number */
  ROW_ARRAY,  /* `size` numbers: a numpy array */
  ROW_BLANK,  /* a zero byte */
  ROW_TEXT,   /* a string of at most `bound` characters */
  ROW_WTEXT,
  ROW_VALUES, /* numbers: an array.array, or a list of booleans, octets or characters */
  ROW_TEXTS,  /* a list of strings */
  ROW_WTEXTS,
  ROW_REPEAT, /* a list of messages: the next `rows` rows with each of them as the message `target` */
  ROW_CALL,   /* the table of the class, for the message `target` */
} row_kind;

typedef struct {
  uint8_t kind;
  uint8_t number;     /* the number_type of a value, of the elements of an array or a sequence */
  uint16_t message;   /* whose slot it is */
  uint16_t target;    /* the number that a message gets or has */
  uint16_t type;      /* its class: an index into those of the table */
  uint32_t size;      /* the number of elements; 0 where it is not fixed */
  uint32_t maximum;   /* of elements; 0 where there is none */
  uint32_t bound;     /* of characters; 0 where there is none */
  uint32_t rows;      /* of a run or of a body */
  uint32_t most;      /* bytes of a run with all paddings */
  uint32_t least;     /* bytes of an element without paddings, at least 1 */
  uint32_t name, name_size; /* of the slot: where it is in the text */
  size_t offset;      /* of the slot in the object; 0 until a class is attached */
  void *slot;         /* its name: a PyObject, kept for good */
  void *cls;          /* of the message entered, of the elements or of the message called: a PyTypeObject */
  void *called;       /* its codec */
  struct last_texts *last_read, *last_written; /* by a codec: of sequences of strings */
} row;

typedef struct {
  row *rows;
  uint32_t row_count;
  uint32_t message_count; /* the message itself included */
} table;

/* Parse a text for a table with so many classes. False where it is malformed or memory is short; the rows then are NULL
 * and `*problem` is where in the text it went wrong. */
bool table_parse(const char *text, size_t size, size_t types, table *parsed, size_t *problem);

#endif
