/* Strings: a u32 length with the NUL, UTF-8, a NUL. Wstrings: a u32 count, then UTF-16 code units, each as a u32. */
#include "codec_wire.h"

codec_outcome text_write(codec_buffer *buffer, PyObject *text, uint32_t bound) {
  if (!Py_IS_TYPE(text, &PyUnicode_Type)) return CODEC_UNUSUAL;
  Py_ssize_t size;
  const char *encoded = PyUnicode_AsUTF8AndSize(text, &size);
  if (!encoded) return codec_failed(); /* half of a surrogate pair */
  if (memchr(encoded, 0, (size_t)size) || size >= UINT32_MAX) return CODEC_UNUSUAL;
  if (bound && size > bound && PyUnicode_GetLength(text) > bound) return CODEC_UNUSUAL;
  const size_t length = (size_t)size + 1;
  if (!buffer_count(buffer, length, length)) return CODEC_ERROR;
  memcpy(buffer->data + buffer->used, encoded, length); /* with its NUL */
  buffer->used += length;
  return CODEC_DONE;
}

codec_outcome wtext_write(codec_buffer *buffer, PyObject *text, uint32_t bound) {
  if (!Py_IS_TYPE(text, &PyUnicode_Type)) return CODEC_UNUSUAL;
  const Py_ssize_t length = PyUnicode_GetLength(text);
  if ((bound && length > bound) || length >= UINT32_MAX / 8) return CODEC_UNUSUAL;
  if (!buffer_count(buffer, 0, 8 * (size_t)length)) return CODEC_ERROR;
  uint8_t *start = buffer->data + buffer->used, *at = start;
  for (Py_ssize_t i = 0; i < length; i++) {
    const Py_UCS4 character = PyUnicode_ReadChar(text, i);
    if (character >= 0xd800 && character < 0xe000) return CODEC_UNUSUAL;
    const bool is_pair = character > 0xffff;
    const uint32_t units[2] = {is_pair ? 0xd7c0 + (character >> 10) : character, 0xdc00 + (character & 0x3ff)};
    memcpy(at, units, sizeof units); /* there is room for pairs throughout */
    at += is_pair ? 8 : 4;
  }
  const uint32_t count = (uint32_t)((size_t)(at - start) / 4);
  memcpy(start - 4, &count, 4);
  buffer->used += (size_t)(at - start);
  return CODEC_DONE;
}

codec_outcome text_read(payload *from, uint32_t bound, PyObject **text) {
  uint32_t length;
  if (!payload_count(from, &length) || !length || length > from->end - from->at) return CODEC_UNUSUAL;
  const char *start = (const char *)from->data + from->at;
  from->at += length;
  /* The only NUL is the last byte. */
  if (memchr(start, 0, length) != start + length - 1) return CODEC_UNUSUAL;
  *text = PyUnicode_DecodeUTF8(start, (Py_ssize_t)length - 1, NULL);
  if (!*text) return codec_failed();
  if (!bound || length - 1 <= bound || PyUnicode_GetLength(*text) <= bound) return CODEC_DONE;
  Py_CLEAR(*text);
  return CODEC_UNUSUAL;
}

codec_outcome wtext_read(payload *from, uint32_t bound, PyObject **text) {
  uint32_t count;
  if (!payload_count(from, &count) || count > (from->end - from->at) / 4) return CODEC_UNUSUAL;
  const uint8_t *start = from->data + from->at;
  from->at += 4 * (size_t)count;
  uint8_t local[256], *units = 2 * (size_t)count <= sizeof local ? local : PyMem_Malloc(2 * (size_t)count);
  if (!units) return PyErr_NoMemory(), CODEC_ERROR;
  uint8_t beyond = 0;
  for (size_t i = 0; i < count; i++) {
    memcpy(units + 2 * i, start + 4 * i, 2);
    beyond |= start[4 * i + 2] | start[4 * i + 3];
  }
  int little_endian = -1; /* and so a leading U+FEFF is a character */
  *text = beyond ? NULL : PyUnicode_DecodeUTF16((const char *)units, 2 * (Py_ssize_t)count, "strict", &little_endian);
  if (units != local) PyMem_Free(units);
  if (beyond) return CODEC_UNUSUAL;
  if (!*text) return codec_failed();
  if (!bound || PyUnicode_GetLength(*text) <= bound) return CODEC_DONE;
  Py_CLEAR(*text);
  return CODEC_UNUSUAL;
}
