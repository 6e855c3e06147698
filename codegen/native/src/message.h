/* The message that rmw passes around, from the Python object that is sent to the bytes that DDS takes, and back. */
#ifndef IFGEN_NATIVE_MESSAGE_H
#define IFGEN_NATIVE_MESSAGE_H

#include "blocks.h"
#include "codec.h"
#include "large.h"

/* The object that create() returns to rmw as "the ROS message". */
typedef struct {
  const message_type *type;
  PyObject *object;     /* what was sent, where service events may need it */
  PyObject *encoded;    /* what is sent: bytes that Python encoded, or NULL and `written` */
  codec_buffer written; /* what C encoded */
  block memory;         /* that it was written into, to begin with */
  Py_buffer *pins;      /* of the arrays that are its pieces: DDS copies from them */
  int pin_count;
  block received;       /* the payload, encapsulation included, but for what is in `large` */
  large_arrays large;
} message;

/* message.c */
extern const message_callbacks message_functions; /* without names */
void *message_create(const message_type *);
void message_destroy(void *);
bool message_from_python(PyObject *, void *);
PyObject *message_to_python(void *);

/* message_type.c */
bool layout_from_python(layout *, PyObject *tables);
PyObject *native_message(PyObject *module, PyObject *arguments);
PyObject *native_introspection(PyObject *module, PyObject *address);

/* sending.c: from the object to what DDS copies. With the GIL, but for the last two. */
bool sending_encode(message *, PyObject *object); /* false with a Python error */
bool sending_needs_gil(const message *);
void sending_release(message *);
size_t sending_size(const message *);                  /* of the body */
void sending_copy(const message *, char *destination); /* the body */

/* service.c */
void *event_create(const message_type *, const service_event_info *, const message *request, const message *response);

#endif
