/* rclpy creates a message by calling `void *create(void)`, and rcl a service event by a function that is told nothing of
 * its service: no argument says which type. So there is one such function for each of so many slots, and a type claims a
 * slot. (libffi closures would need writable and executable memory.) */
#include "message.h"

enum { MESSAGE_SLOTS = 4096, SERVICE_SLOTS = 1024 };

static const message_type *message_types[MESSAGE_SLOTS];
static const message_type *event_types[SERVICE_SLOTS];
static int claimed_messages, claimed_services;

#define EACH_16(M, P) \
  M(P##0) M(P##1) M(P##2) M(P##3) M(P##4) M(P##5) M(P##6) M(P##7) \
  M(P##8) M(P##9) M(P##a) M(P##b) M(P##c) M(P##d) M(P##e) M(P##f)
#define EACH_256(M, P) \
  EACH_16(M, P##0) EACH_16(M, P##1) EACH_16(M, P##2) EACH_16(M, P##3) EACH_16(M, P##4) EACH_16(M, P##5) \
  EACH_16(M, P##6) EACH_16(M, P##7) EACH_16(M, P##8) EACH_16(M, P##9) EACH_16(M, P##a) EACH_16(M, P##b) \
  EACH_16(M, P##c) EACH_16(M, P##d) EACH_16(M, P##e) EACH_16(M, P##f)
#define EACH_1024(M) EACH_256(M, 0) EACH_256(M, 1) EACH_256(M, 2) EACH_256(M, 3)
#define EACH_4096(M) \
  EACH_1024(M) EACH_256(M, 4) EACH_256(M, 5) EACH_256(M, 6) EACH_256(M, 7) EACH_256(M, 8) EACH_256(M, 9) \
  EACH_256(M, a) EACH_256(M, b) EACH_256(M, c) EACH_256(M, d) EACH_256(M, e) EACH_256(M, f)

#define DEFINE_CREATE(N) \
  static void *create_##N(void) { return message_create(message_types[0x##N]); }
#define DEFINE_EVENT(N) \
  static void *event_##N(const service_event_info *info, void *allocator, const void *request, const void *response) { \
    (void)allocator; \
    return event_create(event_types[0x##N], info, request, response); \
  }
#define LIST_CREATE(N) create_##N,
#define LIST_EVENT(N) event_##N,

EACH_4096(DEFINE_CREATE)
EACH_1024(DEFINE_EVENT)

static const create_function create_functions[MESSAGE_SLOTS] = {EACH_4096(LIST_CREATE)};
static const event_create_function event_create_functions[SERVICE_SLOTS] = {EACH_1024(LIST_EVENT)};

create_function claim_message_slot(const message_type *type) {
  if (claimed_messages == MESSAGE_SLOTS) {
    PyErr_Format(PyExc_RuntimeError, "this process uses more than %d message types, which is all that ifgen_native has room for; run some of its nodes in another process", MESSAGE_SLOTS);
    return NULL;
  }
  message_types[claimed_messages] = type;
  return create_functions[claimed_messages++];
}

event_create_function claim_service_slot(const message_type *event_type) {
  if (claimed_services == SERVICE_SLOTS) {
    PyErr_Format(PyExc_RuntimeError, "this process uses more than %d services, which is all that ifgen_native has room for; run some of its nodes in another process", SERVICE_SLOTS);
    return NULL;
  }
  event_types[claimed_services] = event_type;
  return event_create_functions[claimed_services++];
}
