/* A message that goes to one reader in this process. Its bytes lack the large arrays, which are copied when the message is
 * sent. The reader's message gets these copies. So an image is copied once on its way, and bytes that hold all of it
 * are only made for whoever asks for them. */
#include "codec_wire.h"

#include <stdlib.h>

typedef struct {
  PyObject_HEAD
  codec *it;            /* NULL after the arrays were handed over */
  codec_buffer written; /* its pieces own their arrays */
} parcel;

static PyTypeObject *parcel_type;

static void release(parcel *self) {
  for (int i = 0; i < self->written.piece_count; i++) Py_DECREF(self->written.pieces[i].owner);
  codec_buffer_release(&self->written);
  self->it = NULL;
}

static void dealloc(PyObject *object) {
  PyTypeObject *type = Py_TYPE(object);
  release((parcel *)(void *)object);
  PyObject_Free(object);
  Py_DECREF((PyObject *)type);
}

/* Its own copy of an array takes the place of the sender's. False with a Python error. */
static bool own(codec_piece *piece) {
  Py_buffer view;
  PyObject *copied = sequence_copy(piece->owner);
  if (!copied || PyObject_GetBuffer(copied, &view, PyBUF_SIMPLE)) return Py_XDECREF(copied), false;
  piece->owner = copied;
  piece->data = view.buf; /* stays there, since nobody else has the array */
  PyBuffer_Release(&view);
  return true;
}

PyObject *parcel_make(codec *it, const codec_buffer *written) {
  for (int i = 0; i < written->piece_count; i++)
    if (!is_sequence(written->pieces[i].owner)) return NULL;
  if (!written->piece_count) return NULL;
  parcel *self = PyObject_New(parcel, parcel_type);
  if (!self) return NULL;
  self->it = it;
  self->written = *written;
  self->written.borrowed = false;
  self->written.piece_count = 0;
  self->written.data = malloc(written->used);
  if (!self->written.data) PyErr_NoMemory();
  else memcpy(self->written.data, written->data, written->used);
  while (self->written.data && self->written.piece_count < written->piece_count && own(&self->written.pieces[self->written.piece_count]))
    self->written.piece_count++;
  if (self->written.piece_count == written->piece_count) return (PyObject *)self;
  Py_DECREF((PyObject *)self);
  return NULL;
}

static bool is_whole(const parcel *self) {
  if (!self->it) PyErr_SetString(PyExc_RuntimeError, "ifgen_native: the arrays of this parcel were handed over");
  return self->it;
}

PyObject *parcel_bytes(PyObject *object) {
  const parcel *self = (parcel *)(void *)object;
  PyObject *bytes = is_whole(self) ? PyBytes_FromStringAndSize(NULL, (Py_ssize_t)codec_buffer_size(&self->written)) : NULL;
  if (bytes) codec_buffer_copy(&self->written, 0, (uint8_t *)PyBytes_AsString(bytes));
  return bytes;
}

codec_outcome parcel_read(codec *it, PyObject *object, PyObject **message) {
  parcel *self = (parcel *)(void *)object;
  if (!is_whole(self)) return CODEC_ERROR;
  if (self->it != it) return CODEC_UNUSUAL;
  const codec_outcome outcome = codec_read_pieces(it, &self->written, message);
  if (outcome == CODEC_DONE) release(self);
  return outcome;
}

bool is_parcel(PyObject *object) { return Py_TYPE(object) == parcel_type; }

static PyObject *method_bytes(PyObject *self, PyObject *nothing) {
  (void)nothing;
  return parcel_bytes(self);
}

bool parcel_open_type(void) {
  static PyMethodDef methods[] = {{"__bytes__", method_bytes, METH_NOARGS, "The CDR form of the message."}, {NULL, NULL, 0, NULL}};
  static PyType_Slot slots[] = {{Py_tp_dealloc, (void *)dealloc}, {Py_tp_methods, methods}, {0, NULL}};
  static PyType_Spec spec = {.name = "ifgen_native._native.Parcel", .basicsize = sizeof(parcel),
                             .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION | Py_TPFLAGS_IMMUTABLETYPE, .slots = slots};
  if (!parcel_type) parcel_type = (PyTypeObject *)PyType_FromSpec(&spec);
  return parcel_type;
}
