#define _POSIX_C_SOURCE 200809L
#include "testee.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { LINE = 1 << 22, WORDS = 1 << 16 };

static char line[LINE];
static char *words[WORDS];
static size_t word_count;
static size_t next_word;

static uint64_t load_number(const uint8_t *from, size_t width)
{
  uint8_t u8;
  uint16_t u16;
  uint32_t u32;
  uint64_t u64;
  switch (width) {
    case 1: memcpy(&u8, from, 1); return u8;
    case 2: memcpy(&u16, from, 2); return u16;
    case 4: memcpy(&u32, from, 4); return u32;
    default: memcpy(&u64, from, 8); return u64;
  }
}

static void store_number(uint8_t *to, size_t width, uint64_t value)
{
  const uint8_t u8 = (uint8_t)value;
  const uint16_t u16 = (uint16_t)value;
  const uint32_t u32 = (uint32_t)value;
  switch (width) {
    case 1: memcpy(to, &u8, 1); break;
    case 2: memcpy(to, &u16, 2); break;
    case 4: memcpy(to, &u32, 4); break;
    default: memcpy(to, &value, 8); break;
  }
}

static void print_value(char kind, size_t width, const uint8_t *from)
{
  uint64_t value;
  uint32_t i;
  if (kind == 's') {
    for (; *from != 0; ++from) {
      printf("%02x", (unsigned)*from);
    }
  } else if (kind == 'w') {
    for (i = 0; i < (uint32_t)load_number(from, 4); ++i) {
      printf("%04x", (unsigned)load_number(from + 4 + 2 * i, 2));
    }
  } else {
    value = load_number(from, width);
    if (kind == 'f') {
      printf("%0*llx", (int)(2 * width), (unsigned long long)value);
    } else if (kind == 'i' && width < 8 && value >> (8 * width - 1) != 0) {
      printf("-%llu", (1ull << (8 * width)) - (unsigned long long)value);
    } else if (kind == 'i' && width == 8) {
      printf("%lld", (long long)value);
    } else {
      printf("%llu", (unsigned long long)value);
    }
  }
}

static bool read_value(const testee_field *field, uint8_t *to, const char *text)
{
  const size_t length = strlen(text);
  size_t i;
  char digits[5] = {0};
  if (field->kind == 's') {
    if (length / 2 >= field->stride) {
      return false;
    }
    for (i = 0; i < length / 2; ++i) {
      memcpy(digits, text + 2 * i, 2);
      to[i] = (uint8_t)strtoul(digits, NULL, 16);
    }
    to[i] = 0;
  } else if (field->kind == 'w') {
    if (length / 4 > (field->stride - 4) / 2) {
      return false;
    }
    store_number(to, 4, length / 4);
    for (i = 0; i < length / 4; ++i) {
      memcpy(digits, text + 4 * i, 4);
      store_number(to + 4 + 2 * i, 2, strtoul(digits, NULL, 16));
    }
  } else if (field->kind == 'i') {
    store_number(to, field->width, (uint64_t)strtoll(text, NULL, 10));
  } else {
    store_number(to, field->width, strtoull(text, NULL, field->kind == 'f' ? 16 : 10));
  }
  return true;
}

/* Print or read the fields of a message. The text of a path is that of its outer message with a name after it. */
static bool walk(const testee_field *field, uint8_t *message, const char *outer, bool is_load)
{
  static bool is_first;
  char path[512];
  if (outer[0] == 0) {
    is_first = true;
  }
  for (; field->name != NULL; ++field) {
    uint32_t count = field->count == 0 ? 1 : field->count;
    uint32_t i;
    if (field->is_sequence) {
      if (is_load) {
        const char *text = next_word < word_count ? strchr(words[next_word++], '=') : NULL;
        const unsigned long long asked = text == NULL ? ~0ull : strtoull(text + 1, NULL, 10);
        if (asked > field->count) {
          return false;
        }
        count = (uint32_t)asked;
        memcpy(message + field->offset, &count, sizeof count);
      } else {
        memcpy(&count, message + field->offset, sizeof count);
        printf("%s%s%s#=%u", is_first ? "" : " ", outer, field->name, (unsigned)count);
        is_first = false;
      }
    }
    for (i = 0; i < count; ++i) {
      uint8_t *at = message + field->data + (size_t)i * field->stride;
      const bool is_many = field->is_sequence || field->count != 0;
      const int used = is_many ? snprintf(path, sizeof path, "%s%s[%u]", outer, field->name, (unsigned)i)
        : snprintf(path, sizeof path, "%s%s", outer, field->name);
      if (field->kind == 'm') {
        snprintf(path + used, sizeof path - (size_t)used, ".");
        if (!walk(field->fields, at, path, is_load)) {
          return false;
        }
      } else if (is_load) {
        char *text = next_word < word_count ? strchr(words[next_word++], '=') : NULL;
        if (text == NULL || !read_value(field, at, text + 1)) {
          return false;
        }
      } else {
        printf("%s%s=", is_first ? "" : " ", path);
        print_value(field->kind, field->width, at);
        is_first = false;
      }
    }
  }
  return true;
}

static void print_payload(const uint8_t *bytes, size_t size)
{
  size_t i;
  for (i = 0; i < size; ++i) {
    printf("%02x", (unsigned)bytes[i]);
  }
}

static void print_failure(const testee_type *type, const ifgen_cdr_failure *failure, const char *id)
{
  static const char *const problems[] = {"", "too short", "over its bound", "no character", "no header of plain CDR"};
  char path[256] = "";
  if (failure->problem != IFGEN_CDR_HEADER) {
    ifgen_cdr_path(type->paths, failure, path, sizeof path);
  }
  printf("refused %s %s: %s", id, path, problems[failure->problem]);
}

static void print_encoded(const testee_type *type, const void *message, const char *id)
{
  ifgen_cdr_failure failure;
  /* The payload has its own allocation of the exact size, so that a sanitizer sees a byte too much. */
  const size_t wanted = ifgen_cdr_encoded_size(type->rows, message, &failure);
  uint8_t *bytes = malloc(wanted + 1);
  const size_t size = wanted == 0 ? 0 : ifgen_cdr_encode(type->rows, message, bytes, wanted, &failure);
  if (size == 0) {
    print_failure(type, &failure, id);
  } else if (size > type->max_size) {
    printf("fail %s %zu bytes, and the maximum is %zu", id, size, type->max_size);
  } else {
    printf("ok %s ", id);
    print_payload(bytes, size);
  }
  free(bytes);
}

static uint8_t *payload_of(const char *digits, size_t *size)
{
  const size_t length = strcmp(digits, "-") == 0 ? 0 : strlen(digits) / 2;
  uint8_t *bytes = malloc(length == 0 ? 1 : length);
  char pair[3] = {0};
  size_t i;
  for (i = 0; i < length; ++i) {
    memcpy(pair, digits + 2 * i, 2);
    bytes[i] = (uint8_t)strtoul(pair, NULL, 16);
  }
  *size = length;
  return bytes;
}

static double now(void)
{
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (double)time.tv_sec * 1e9 + (double)time.tv_nsec;
}

static void bench(const testee_type *type, void *message, const uint8_t *bytes, size_t size)
{
  const unsigned long count = strtoul(words[4], NULL, 10);
  uint8_t *room = malloc(type->max_size);
  const double start = now();
  double middle;
  unsigned long i;
  for (i = 0; i < count; ++i) {
    (void)ifgen_cdr_encode(type->rows, message, room, type->max_size, NULL);
  }
  middle = now();
  for (i = 0; i < count; ++i) {
    (void)ifgen_cdr_decode(type->rows, message, bytes, size, NULL);
  }
  printf("%.1f %.1f", (middle - start) / (double)count, (now() - middle) / (double)count);
  free(room);
}

static void print_constant(const testee_type *type, const char *id)
{
  const testee_constant *constant = type->constants;
  for (; constant->name != NULL && strcmp(constant->name, words[3]) != 0; ++constant) {
  }
  if (constant->name == NULL) {
    printf("fail %s no such constant", id);
    return;
  }
  printf("ok %s ", id);
  if (constant->kind == 'z') {
    print_value('s', 0, *(const uint8_t *const *)constant->value);
  } else if (constant->kind == 'w') {
    const uint16_t *unit;
    for (unit = constant->value; *unit != 0; ++unit) {
      printf("%04x", (unsigned)*unit);
    }
  } else {
    print_value(constant->kind, constant->width, constant->value);
  }
}

static void print_equal(const testee_type *type, const char *id, const void *message)
{
  ifgen_cdr_failure failure;
  size_t size;
  uint8_t *bytes = payload_of(words[4], &size);
  void *other = malloc(type->size);
  type->init(other);
  if (!ifgen_cdr_decode(type->rows, other, bytes, size, &failure)) {
    print_failure(type, &failure, id);
  } else {
    printf("ok %s %d", id, ifgen_cdr_equal(type->rows, message, other));
  }
  free(other);
  free(bytes);
}

static void with_payload(const testee_type *type, const char *operation, const char *id, void *message)
{
  ifgen_cdr_failure failure;
  size_t size;
  uint8_t *bytes = payload_of(words[3], &size);
  if (!ifgen_cdr_decode(type->rows, message, bytes, size, &failure)) {
    print_failure(type, &failure, id);
  } else if (strcmp(operation, "recode") == 0) {
    print_encoded(type, message, id);
  } else if (strcmp(operation, "size") == 0) {
    printf("ok %s %zu", id, ifgen_cdr_encoded_size(type->rows, message, NULL));
  } else if (strcmp(operation, "dump") == 0) {
    printf("ok %s ", id);
    walk(type->fields, message, "", false);
  } else if (strcmp(operation, "equal") == 0 && word_count > 4) {
    print_equal(type, id, message);
  } else if (strcmp(operation, "bench") == 0 && word_count > 4) {
    printf("ok %s ", id);
    bench(type, message, bytes, size);
  } else {
    printf("skip %s %s", id, operation);
  }
  free(bytes);
}

static void answer(const testee_type *type, const char *operation, const char *id)
{
  void *message = type->size == 0 ? NULL : malloc(type->size);
  if (strcmp(operation, "hash") == 0) {
    printf("ok %s %s", id, type->hash);
  } else if (message == NULL) {
    printf("skip %s %s", id, operation);
  } else if (strcmp(operation, "constant") == 0) {
    print_constant(type, id);
  } else {
    type->init(message);
    if (strcmp(operation, "default") == 0) {
      print_encoded(type, message, id);
    } else if (strcmp(operation, "load") == 0) {
      next_word = 3;
      if (walk(type->fields, message, "", true)) {
        print_encoded(type, message, id);
      } else {
        printf("refused %s the text does not fit", id);
      }
    } else {
      with_payload(type, operation, id, message);
    }
  }
  free(message);
}

int testee_main(const testee_type *const *packages, const char *language)
{
  while (fgets(line, LINE, stdin) != NULL) {
    const testee_type *const *package = packages;
    const testee_type *type = NULL;
    char *word = strtok(line, " \n");
    for (word_count = 0; word != NULL && word_count < WORDS; word = strtok(NULL, " \n")) {
      words[word_count++] = word;
    }
    if (word_count < 3) {
      continue;
    }
    if (strcmp(words[0], "hello") == 0) {
      printf("ok %s protocol=1 language=%s library=ifgen", words[1], language);
    } else {
      for (; type == NULL && *package != NULL; ++package) {
        const testee_type *candidate = *package;
        for (; candidate->name != NULL && strcmp(candidate->name, words[2]) != 0; ++candidate) {
        }
        type = candidate->name == NULL ? NULL : candidate;
      }
      if (type == NULL) {
        printf("skip %s unknown-type", words[1]);
      } else {
        answer(type, words[0], words[1]);
      }
    }
    printf("\n");
    fflush(stdout);
  }
  return 0;
}
