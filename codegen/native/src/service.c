/* Services and actions: handles that point to the handles of their messages, and service introspection events. */
#include "message.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
  service_handle handle; /* first: see message_type */
  service_callbacks callbacks;
  const void *hash, *description, *sources;
} service_type;

typedef struct {
  action_handle handle; /* first: see message_type */
  const void *hash, *description, *sources;
} action_type;

static const service_handle *find(const service_handle *handle, const char *identifier) {
  return strcmp(identifier, fastrtps_identifier) ? NULL : handle;
}

static const void *service_hash(const service_handle *handle) { return ((const service_type *)handle)->hash; }
static const void *service_description(const service_handle *handle) { return ((const service_type *)handle)->description; }
static const void *service_sources(const service_handle *handle) { return ((const service_type *)handle)->sources; }
static const void *action_hash(const action_handle *handle) { return ((const action_type *)handle)->hash; }
static const void *action_description(const action_handle *handle) { return ((const action_type *)handle)->description; }
static const void *action_sources(const action_handle *handle) { return ((const action_type *)handle)->sources; }

/* A part as an object; None where the event goes without. New reference, NULL with a Python error. */
static PyObject *part(const message *that) {
  if (!that) Py_RETURN_NONE;
  if (that->object) {
    Py_INCREF(that->object);
    return that->object;
  }
  return message_to_python((void *)that);
}

/* rcl calls this while it sends or takes, holding no DDS lock. Without contents (METADATA) both parts are NULL. The parts'
 * bytes cannot be spliced into the event's (another alignment), so the event is encoded again from the objects. */
void *event_create(const message_type *event_type, const service_event_info *info, const message *request, const message *response) {
  message *event = message_create(event_type);
  if (!event) return NULL;
  PyGILState_STATE state = PyGILState_Ensure();
  PyObject *request_object = part(request), *response_object = part(response), *object = NULL;
  PyObject *gid = PyBytes_FromStringAndSize((const char *)info->client_gid, sizeof info->client_gid);
  if (request_object && response_object && gid)
    object = PyObject_CallFunction(event_type->make_event, "iiIOLOO", info->event_type, info->stamp_sec, info->stamp_nanosec, gid,
                                   (long long)info->sequence_number, request_object, response_object);
  bool made = object && message_from_python(object, event);
  Py_XDECREF(request_object);
  Py_XDECREF(response_object);
  Py_XDECREF(gid);
  Py_XDECREF(object);
  if (!made) {
    PyErr_WriteUnraisable(event_type->make_event);
    report_error("ifgen_native: a service event could not be encoded; the cause is on stderr");
  }
  PyGILState_Release(state);
  if (made) return event;
  message_destroy(event);
  return NULL;
}

static bool event_destroy(void *event, void *allocator) {
  (void)allocator;
  message_destroy(event);
  return true;
}

PyObject *native_service(PyObject *module, PyObject *arguments) {
  (void)module;
  const char *namespace_, *name;
  unsigned long long request, response, event, hash, description, sources;
  PyObject *make_event;
  if (!PyArg_ParseTuple(arguments, "ssKKKOKKK:service", &namespace_, &name, &request, &response, &event, &make_event, &hash,
                        &description, &sources))
    return NULL;
  message_type *request_type = pointer(request), *response_type = pointer(response), *event_type = pointer(event);
  service_type *type = calloc(1, sizeof *type);
  event_create_function create = type ? claim_service_slot(event_type) : NULL;
  if (!create) {
    free(type);
    return PyErr_Occurred() ? NULL : PyErr_NoMemory();
  }
  type->callbacks = (service_callbacks){strdup(namespace_), strdup(name), &request_type->handle, &response_type->handle};
  type->handle = (service_handle){
      .identifier = fastrtps_identifier,
      .data = &type->callbacks,
      .find = find,
      .request = &request_type->handle,
      .response = &response_type->handle,
      .event = &event_type->handle,
      .event_create = create,
      .event_destroy = event_destroy,
      .type_hash = service_hash,
      .type_description = service_description,
      .type_sources = service_sources,
  };
  type->hash = pointer(hash);
  type->description = pointer(description);
  type->sources = pointer(sources);
  request_type->is_in_events = response_type->is_in_events = true;
  Py_INCREF(make_event);
  event_type->make_event = make_event;
  return Py_BuildValue("KN", address(type), capsule(&type->handle));
}

PyObject *native_action(PyObject *module, PyObject *arguments) {
  (void)module;
  unsigned long long goal, result, cancel, feedback, status, hash, description, sources;
  if (!PyArg_ParseTuple(arguments, "KKKKKKKK:action", &goal, &result, &cancel, &feedback, &status, &hash, &description, &sources))
    return NULL;
  action_type *type = calloc(1, sizeof *type);
  if (!type) return PyErr_NoMemory();
  type->handle = (action_handle){pointer(goal),     pointer(result), pointer(cancel),    pointer(feedback),
                                 pointer(status),   action_hash,     action_description, action_sources};
  type->hash = pointer(hash);
  type->description = pointer(description);
  type->sources = pointer(sources);
  return capsule(&type->handle);
}
