/* Is this payload a well-formed message of its type? Asked under a DDS lock, so: no Python, no allocation. */
#ifndef IFGEN_NATIVE_LAYOUT_H
#define IFGEN_NATIVE_LAYOUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A layout program says in 32-bit words what a message's body is made of. Small nested messages are flattened into it;
 * of large ones there is one part for each type, in front of all that goes through it, so that a program grows as the
 * definitions do and not as what they come to. Bounds are not in it: compiled type supports accept what is over its bound, and so do ours.
 * `ifgen_runtime.type_support.layout` writes programs. */
enum {
  LAYOUT_FIXED = 1,    /* size count        `count` values of `size` bytes, aligned to `size` */
  LAYOUT_STRING = 2,   /*                   u32 length with its NUL, then as many bytes */
  LAYOUT_WSTRING = 3,  /*                   u32 count of UTF-16 code units, then each unit as a u32 */
  LAYOUT_SEQUENCE = 4, /* size              u32 count, then fixed values of `size` bytes */
  LAYOUT_REPEAT = 5,   /* count words ...   the next `words` words `count` times; as many times as a u32 in the
                                            payload says where `count` is LAYOUT_COUNTED */
  LAYOUT_PART = 6,     /* depth words ...   the next `words` words where LAYOUT_CALL asks for them; at the start of a program
                                            only. They go no deeper than `depth` repetitions and calls in each other */
  LAYOUT_CALL = 7,     /* start             the part that begins at this word of the program, which is one further up */
};
#define LAYOUT_COUNTED 0xffffffffu
#define LAYOUT_MAX_DEPTH 1024 /* of repetitions and calls in each other: a stack of 100 kB, and more than Python can read */

/* Whether the words form a program that `layout_accepts` can run without leaving it. */
bool layout_is_program(const uint32_t *words, size_t count);

/* Whether a payload, its 4-byte encapsulation header included, holds a whole message. Trailing bytes are fine. */
bool layout_accepts(const uint32_t *program, size_t count, const uint8_t *payload, size_t size);

#endif
