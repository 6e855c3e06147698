#include "blocks.h"

#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Memory that waits for its next use. rclpy sends and takes under the GIL, so there is rarely more than one message that
 * is sent and one that is taken. Less is malloc's business, and more is too much to keep for nobody: what waits is at most
 * SPARES * MOST_KEPT bytes. */
enum { SPARES = 2, LEAST_KEPT = 1 << 10, MOST_KEPT = 8 << 20 };

/* In front of the bytes of each block. */
typedef struct {
  _Alignas(max_align_t) size_t capacity;
} head;

static _Atomic(head *) spares[SPARES];

static bool is_kept(size_t capacity) { return capacity >= LEAST_KEPT && capacity <= MOST_KEPT; }

/* NULL where there is no memory. */
static head *take(size_t capacity) {
  for (int i = 0; i < SPARES && is_kept(capacity); i++) {
    head *spare = atomic_exchange(&spares[i], NULL);
    if (spare && spare->capacity >= capacity) return spare;
    free(spare);
  }
  if (capacity > SIZE_MAX - sizeof(head)) return NULL;
  head *made = malloc(sizeof *made + capacity);
  if (made) made->capacity = capacity;
  return made;
}

static void give_back(char *data) {
  head *used = (head *)(void *)data - 1;
  for (int i = 0; i < SPARES && is_kept(used->capacity); i++) {
    head *none = NULL;
    if (atomic_compare_exchange_strong(&spares[i], &none, used)) return;
  }
  free(used);
}

bool block_reserve(block *self, size_t capacity) {
  if (capacity <= self->capacity) return true;
  head *larger = take(capacity);
  if (!larger) return false;
  char *data = (char *)(larger + 1);
  if (self->data) {
    memcpy(data, self->data, self->size);
    give_back(self->data);
  }
  self->data = data;
  self->capacity = larger->capacity;
  return true;
}

void block_release(block *self) {
  if (self->data) give_back(self->data);
  *self = (block){0};
}
