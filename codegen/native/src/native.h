/* The declarations that the files of the extension share. One generic type support serves every message type: the C
 * "ROS message" that rmw passes around is our `message`, a type and its CDR bytes.
 *
 * The rule that everything here follows: DDS calls serialize, deserialize and the sizes while it holds a mutex,
 * so those never run Python and never ask for the GIL. Encoding happens when rclpy converts the object (GIL held,
 * no DDS lock), decoding when rclpy converts back; in between there are only bytes. */
#ifndef IFGEN_NATIVE_NATIVE_H
#define IFGEN_NATIVE_NATIVE_H

/* Formats with # are not used: built with the headers of CPython 3.13, they do not run on older ones. */
#define Py_LIMITED_API 0x030B0000
#include <Python.h>

#include <stdatomic.h>

#include "layout.h"
#include "rosidl.h"

/* Payloads of a type that its definition does not explain. */
typedef struct {
  atomic_uint dropped;   /* malformed */
  atomic_uint with_rest; /* longer than the message */
  atomic_uint rest;      /* bytes left over of the last of these */
} trouble_count;

/* A message type. The records of types live as long as the process: entities hold pointers into them. */
typedef struct message_type {
  message_handle handle; /* first, so that a handle's address is its record's */
  message_callbacks callbacks;
  const message_handle *introspection;
  const void *hash, *description, *sources;
  struct codec *codec; /* of the class; NULL where C has none */
  PyObject *encode;    /* object -> bytes, encapsulation included */
  PyObject *decode;    /* bytes, encapsulation included -> object */
  layout layout;
  char *text; /* of the layout's last table */
  PyObject *make_event; /* of a service's event message: the parts of an event -> object */
  bool is_in_events; /* a request or a response: what was sent is kept for service events */
  trouble_count *troubles;
} message_type;

/* fastcdr.c: what we need of libfastcdr, rcutils and rosidl. */
extern const char *fastrtps_identifier;
extern const char *introspection_identifier;
int fastcdr_bind(PyObject *symbols);
char *fastcdr_position(void *cdr);
bool fastcdr_jump(void *cdr, size_t size);
void fastcdr_payload(void *cdr, const char **data, size_t *size);
void report_error(const char *text);
void clear_error(void);

/* slots.c: functions of a type's own. NULL with a Python error where no slot is left. */
typedef void *(*create_function)(void);
typedef void *(*event_create_function)(const service_event_info *, void *allocator, const void *request, const void *response);
create_function claim_message_slot(const message_type *type);
event_create_function claim_service_slot(const message_type *event_type);

/* message_type.c */
bool layout_from_python(layout *, PyObject *tables);
PyObject *native_message(PyObject *module, PyObject *arguments);
PyObject *native_introspection(PyObject *module, PyObject *address);

/* service.c */
PyObject *native_service(PyObject *module, PyObject *arguments);
PyObject *native_action(PyObject *module, PyObject *arguments);

static inline void *pointer(unsigned long long address) { return (void *)(uintptr_t)address; }
static inline unsigned long long address(const void *pointer) { return (unsigned long long)(uintptr_t)pointer; }

/* rclpy reads unnamed capsules. */
static inline PyObject *capsule(const void *pointer) { return PyCapsule_New((void *)pointer, NULL, NULL); }

#endif
