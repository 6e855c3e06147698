/* The testee of the conformance suite for C: docs/conformance.md of ifgen has the protocol. It runs where there is a C
 * library, so it may use the heap and recursion. */
#ifndef IFGEN_TESTEE_H_
#define IFGEN_TESTEE_H_

#include "ifgen/cdr.h"

typedef struct testee_field {
  const char *name;
  char kind; /* b: bool, i: signed, u: unsigned, f: float, s: string, w: wstring, m: message */
  uint8_t width;
  bool is_sequence;
  uint32_t offset; /* of the field, and of its first element */
  uint32_t data;
  uint32_t count; /* 0: one value */
  uint32_t stride;
  const struct testee_field *fields; /* end with a name NULL */
} testee_field;

typedef struct {
  const char *name;
  char kind; /* as of a field, or z: a string */
  uint8_t width;
  const void *value;
} testee_constant;

typedef struct {
  const char *name;
  const char *hash;
  size_t size;
  size_t max_size;
  const ifgen_cdr_row *rows;
  const char *const *paths;
  const testee_field *fields;
  void (*init)(void *message);
  const testee_constant *constants;
} testee_type;

int testee_main(const testee_type *const *packages, const char *language);

#endif /* IFGEN_TESTEE_H_ */
