/* The codec in C: messages of generated classes to CDR (XCDR1, little endian, 4-byte header) and back, by the tables of
 * their classes. It handles what correct programs send, and leaves everything else to the functions in Python, which say
 * what is wrong. No function here runs code of a user. Hold the GIL. */
#ifndef IFGEN_NATIVE_CODEC_H
#define IFGEN_NATIVE_CODEC_H

#include "native.h"
#include "table.h"

/* What became of a message. */
typedef enum {
  CODEC_DONE,
  CODEC_UNUSUAL, /* no Python error is set: take the Python way */
  CODEC_ERROR,   /* a Python error is set: memory is short */
} codec_outcome;

/* A class with its table. Codecs live as long as the process, and so do their classes. */
typedef struct codec {
  PyTypeObject *cls;
  PyObject *encode, *decode; /* the generated functions in Python: message -> bytes, bytes -> message */
  table table;
  size_t last_used; /* memory for the message written last: a first guess for the next */
} codec;

/* codec_attach.c */

/* The codec of a class; NULL where C has none, and no error is set. Of exactly this class: a class derived from one has
 * none. */
codec *codec_of(PyTypeObject *cls);

/* Give a class a codec; `classes` is the tuple of those that the table refers to. NULL with a Python error where table or classes are not what
 * they should be. The classes that it calls must have theirs. */
codec *codec_attach(PyTypeObject *cls, PyObject *encode, PyObject *decode, const char *text, Py_ssize_t size, PyObject *classes);

/* What a message comes to on the wire: memory that grows, and places in it where large arrays follow, which are copied once, in
 * the end. Until then no object may change, so keep the GIL and call nothing of Python's in between. */
enum { CODEC_PIECES = 8, CODEC_LARGE = 4096 /* bytes: more are worth a call to save a copy */ };
typedef struct {
  PyObject *owner; /* of the data; borrowed */
  const void *data;
  size_t size;
  size_t before; /* how much of the memory comes first */
} codec_piece;
typedef struct {
  uint8_t *data;
  size_t used, capacity;
  bool borrowed; /* the data still is the caller's */
  size_t large;  /* arrays of more bytes become pieces */
  size_t lent;   /* the size of all pieces */
  int piece_count;
  codec_piece pieces[CODEC_PIECES];
} codec_buffer;

/* codec_write.c */

/* Write a message, header included. The buffer may begin with memory of the caller's (`data`, `capacity`, `borrowed`), or
 * with nothing; `large` is set. Release it whatever the outcome. */
codec_outcome codec_write(codec *, PyObject *message, codec_buffer *);

/* codec_buffer.c */
static inline size_t codec_buffer_size(const codec_buffer *buffer) { return buffer->used + buffer->lent; }
void codec_buffer_copy(const codec_buffer *, size_t start, uint8_t *to); /* from a byte before all pieces to the end */
void codec_buffer_release(codec_buffer *);
bool codec_buffer_grow(codec_buffer *, size_t more); /* to room for so many bytes more; false with a Python error */

/* codec_read.c */

/* Read a message from a payload, header included: a new reference with CODEC_DONE. The message has its own memory, but
 * where `viewed` is the object of bytes that holds the payload, sequences of numbers are views of it. */
codec_outcome codec_read(codec *, const uint8_t *payload, size_t size, PyObject *viewed, PyObject **message);
void codec_view_class(PyObject *cls); /* ifgen_runtime.views.SequenceView */

/* The same from what was written, where its pieces belong to array.arrays. The message gets these. */
codec_outcome codec_read_pieces(codec *, const codec_buffer *written, PyObject **message);

/* codec_parcel.c: messages that go to one reader in this process. Their large arrays are copied when the parcel is made, and
 * the message that is made of it gets these copies. */
bool parcel_open_type(void);                                    /* false with a Python error */
bool is_parcel(PyObject *);
PyObject *parcel_make(codec *, const codec_buffer *written);    /* NULL without an error where no array is large */
PyObject *parcel_bytes(PyObject *parcel);                       /* all of it */
codec_outcome parcel_read(codec *, PyObject *parcel, PyObject **message);

/* codec_equal.c and codec_copy.c: what `==`, `copy.deepcopy` and `copy.copy` do with a message of exactly this class; a new
 * reference, or NULL with whatever error the generated method would raise. They may run code of users. */
PyObject *codec_equal(const codec *, PyObject *message, PyObject *other);
PyObject *codec_deepcopy(const codec *, PyObject *message, PyObject *memo);
PyObject *codec_copy(const codec *, PyObject *message);
bool codec_equal_open(PyObject *copying);
bool codec_copy_open(PyObject *copying); /* takes functions of ifgen_runtime.copying; false with a Python error */

/* codec_methods.c: these as methods of a class that has a codec; NULL with a Python error. */
PyObject *native_codec_methods(PyObject *module, PyObject *cls);

/* codec_module.c: functions of the extension module. */
extern PyMethodDef codec_methods[];

#endif
