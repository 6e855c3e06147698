/* The parts of rosidl's and rmw_fastrtps' C interface (ROS 2 Jazzy, Kilted and Lyrical) that a type support is made of.
 *
 * Only layouts, written down from their documentation so that nothing of ROS is needed to compile. Sizes are
 * for LP64, the only data model that ROS 2 supports on Linux. */
#ifndef IFGEN_NATIVE_ROSIDL_H
#define IFGEN_NATIVE_ROSIDL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* rosidl_message_type_support_t */
typedef struct message_handle {
  const char *identifier;
  const void *data;
  const struct message_handle *(*find)(const struct message_handle *, const char *identifier);
  const void *(*type_hash)(const struct message_handle *);
  const void *(*type_description)(const struct message_handle *);
  const void *(*type_sources)(const struct message_handle *);
} message_handle;

/* message_type_support_callbacks_t (rosidl_typesupport_fastrtps_c). Jazzy's and Kilted's ends with the callbacks of keys.
 * Lyrical's goes on: a type with buffers on a device has a true flag and two functions more. Ours are 0 from there on, and so
 * are some words after them, for whoever reads further one day. */
typedef struct {
  const char *namespace_;
  const char *name;
  bool (*serialize)(const void *message, void *cdr);
  bool (*deserialize)(void *cdr, void *message);
  uint32_t (*serialized_size)(const void *message);
  size_t (*max_serialized_size)(char *bounds);
  const void *key_callbacks;
  bool has_buffers;
  void (*serialize_for_endpoint)(void);
  void (*deserialize_for_endpoint)(void);
  const void *later[6];
} message_callbacks;

/* service_introspection_info_t (rosidl_service_introspection_info_t) */
typedef struct {
  uint8_t event_type;
  int32_t stamp_sec;
  uint32_t stamp_nanosec;
  uint8_t client_gid[16];
  int64_t sequence_number;
} service_event_info;

/* rosidl_service_type_support_t */
typedef struct service_handle {
  const char *identifier;
  const void *data;
  const struct service_handle *(*find)(const struct service_handle *, const char *identifier);
  const message_handle *request;
  const message_handle *response;
  const message_handle *event;
  void *(*event_create)(const service_event_info *, void *allocator, const void *request, const void *response);
  bool (*event_destroy)(void *event, void *allocator);
  const void *(*type_hash)(const struct service_handle *);
  const void *(*type_description)(const struct service_handle *);
  const void *(*type_sources)(const struct service_handle *);
} service_handle;

/* service_type_support_callbacks_t (rosidl_typesupport_fastrtps_c) */
typedef struct {
  const char *namespace_;
  const char *name;
  const message_handle *request;
  const message_handle *response;
} service_callbacks;

/* rosidl_action_type_support_t */
typedef struct action_handle {
  const service_handle *goal_service;
  const service_handle *result_service;
  const service_handle *cancel_service;
  const message_handle *feedback_message;
  const message_handle *status_message;
  const void *(*type_hash)(const struct action_handle *);
  const void *(*type_description)(const struct action_handle *);
  const void *(*type_sources)(const struct action_handle *);
} action_handle;

_Static_assert(sizeof(message_handle) == 48, "rosidl_message_type_support_t on LP64");
_Static_assert(offsetof(message_callbacks, has_buffers) == 56, "message_type_support_callbacks_t of Jazzy on LP64");
_Static_assert(offsetof(message_callbacks, later) == 80, "message_type_support_callbacks_t of Lyrical on LP64");
_Static_assert(sizeof(service_handle) == 88, "rosidl_service_type_support_t on LP64");
_Static_assert(sizeof(action_handle) == 64, "rosidl_action_type_support_t on LP64");

#endif
