/* Large sequences of received messages, such as the pixels of an image, without a second copy and without fresh memory.
 *
 * What DDS hands over has to be copied under its lock, where no Python object can be made. So an array of an earlier
 * message is there before, one that nobody but us refers to any more: DDS' bytes go straight into it, and only the
 * rest of the payload is decoded. */
#ifndef IFGEN_NATIVE_LARGE_H
#define IFGEN_NATIVE_LARGE_H

#define Py_LIMITED_API 0x030B0000
#include <Python.h>

#include "blocks.h"
#include "layout.h"

struct message_type;

/* An array.array that the next message may get. The message owns a reference to it, so no other message uses it. */
typedef struct {
  PyObject *array;
  PyObject *path; /* names of slots, from the message to where the array belongs */
  uint32_t row;   /* of that slot */
  char *memory;   /* of the array [size bytes] */
  size_t size;
} waiting_array;

enum { LARGE_WAITING = 4 };

typedef struct {
  waiting_array waiting[LARGE_WAITING];
  unsigned count;
  const waiting_array *filled; /* what the payload's longest sequence went into */
  layout_sequence longest;     /* of the payload */
} large_arrays;

/* Lets arrays wait for a message of this type. With the GIL. */
void large_prepare(large_arrays *, const struct message_type *);

/* Copies a payload into the block, and its longest sequence into a waiting array of the same size if there is one: a few
 * of its values stay in the payload, as many as keep the alignment of what follows. No Python. False without memory. */
bool large_receive(large_arrays *, block *, const char *payload, size_t size);

/* Puts the array that was filled into the decoded message, or remembers the message's own. With the GIL. False with a
 * Python error. */
bool large_finish(const large_arrays *, const struct message_type *, PyObject *message);

/* Lets go of the arrays. With the GIL. */
void large_release(large_arrays *);

#endif
