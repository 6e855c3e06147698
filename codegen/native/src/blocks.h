/* Memory for payloads that outlives one message: a fresh block of the size of an image costs a page fault for each
 * 4 kB, which is ten times what it takes to fill it. Needs neither the GIL nor a lock. */
#ifndef IFGEN_NATIVE_BLOCKS_H
#define IFGEN_NATIVE_BLOCKS_H

#include <stdbool.h>
#include <stddef.h>

/* Bytes that their owner fills, aligned for any number. A zeroed one is empty. */
typedef struct {
  char *data;
  size_t size;     /* in use */
  size_t capacity; /* of `data` */
} block;

/* Makes room for `capacity` bytes and keeps the first `size`. False, with the block as it was, where there is no memory. */
bool block_reserve(block *, size_t capacity);

/* Empties the block. Its memory may serve another. */
void block_release(block *);

#endif
