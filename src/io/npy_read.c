/* SPDX-License-Identifier: MIT
 *
 * The head of a NPY file is text: a Python literal {'descr': '<f8', 'fortran_order': False, 'shape': (64, 32), } after
 * ten bytes (twelve from version 2 on) that end with its length.
 */
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "io/folder.h"
#include "io/npy.h"

#define MOST_BYTES ((size_t)1 << 34)
#define HEAD_MAX   4096

typedef struct head {
  int axes, n[3];
  size_t element, start; /* bytes of a value; where the values begin */
} head;

/* What stands after 'key': in the text. */
static const char *after(const char *text, const char *key) {
  const char *at = strstr(text, key);
  if (at == NULL) return "";
  at += strlen(key);
  return at + strspn(at, "': ");
}

/* The numbers of "(64, 32)", the last one first; false unless there are two or three. */
static bool read_shape(const char *text, head *h) {
  long n[3];
  if (*text++ != '(') return false;
  for (h->axes = 0; *text != ')' && h->axes < 3; ++h->axes) {
    char *end;
    n[h->axes] = strtol(text, &end, 10);
    if (end == text || n[h->axes] < 1 || n[h->axes] > INT_MAX) return false;
    text = end + strspn(end, ", ");
  }
  if (*text != ')' || h->axes < 2) return false;
  h->n[2] = 1;
  for (int a = 0; a < h->axes; ++a) h->n[a] = (int)n[h->axes - 1 - a];
  return true;
}

static cf_status read_head(const char *path, const char *bytes, const size_t size, head *h) {
  char text[HEAD_MAX + 1];
  if (size < 12 || memcmp(bytes, "\x93NUMPY", 6) != 0)
    return cf_fail(CF_BAD_FILE, "%s: is not a NPY file", path);
  const unsigned char *b = (const unsigned char *)bytes;
  const bool first = b[6] == 1;
  const size_t length =
      first ? b[8] + 256u * b[9] : b[8] + 256u * b[9] + 65536u * b[10] + 16777216u * (size_t)b[11];
  h->start = (first ? 10 : 12) + length;
  if (length > HEAD_MAX || h->start > size) return cf_fail(CF_BAD_FILE, "%s: is not a NPY file", path);
  memcpy(text, bytes + h->start - length, length);
  text[length] = '\0';
  const char *type = after(text, "'descr'");
  h->element = strncmp(type, "<f4", 3) == 0 ? 4 : strncmp(type, "<f8", 3) == 0 ? 8 : 0;
  if (h->element == 0)
    return cf_fail(CF_BAD_FILE, "%s: holds values '%.4s': must be '<f4' or '<f8' (float32, float64)", path,
                   type);
  if (strncmp(after(text, "'fortran_order'"), "False", 5) != 0)
    return cf_fail(CF_BAD_FILE, "%s: is in Fortran's order: numpy.ascontiguousarray makes it C's", path);
  if (!read_shape(after(text, "'shape'"), h))
    return cf_fail(CF_BAD_FILE, "%s: must have 2 or 3 axes, none of them empty", path);
  return CF_OK;
}

static cf_status take_values(const char *path, const char *from, const head *h, float *to) {
  const size_t count = (size_t)h->n[0] * (size_t)h->n[1] * (size_t)h->n[2];
  for (size_t i = 0; i < count; ++i) {
    double wide = 0;
    float narrow = 0;
    if (h->element == 8)
      memcpy(&wide, from + 8 * i, 8);
    else
      memcpy(&narrow, from + 4 * i, 4);
    to[i] = h->element == 8 ? (float)wide : narrow;
    if (!isfinite(to[i])) return cf_fail(CF_BAD_FILE, "%s: value %zu of %zu is not finite", path, i, count);
  }
  return CF_OK;
}

static cf_status read_all(const char *path, const char *bytes, const size_t size, int *axes, int n[3],
                          float **values) {
  head h = {0};
  CF_TRY(read_head(path, bytes, size, &h));
  const double wanted = (double)h.n[0] * h.n[1] * h.n[2] * (double)h.element;
  if ((double)(size - h.start) < wanted)
    return cf_fail(CF_BAD_FILE, "%s: is cut off: %zu bytes of values where %.0f were expected", path,
                   size - h.start, wanted);
  CF_TRY(CF_NEW(values, (size_t)h.n[0] * (size_t)h.n[1] * (size_t)h.n[2]));
  *axes = h.axes;
  for (int a = 0; a < 3; ++a) n[a] = h.n[a];
  const cf_status s = take_values(path, bytes + h.start, &h, *values);
  if (s == CF_OK) return CF_OK;
  cf_free(*values);
  *values = NULL;
  return s;
}

cf_status cf_npy_read(const char *path, int *axes, int n[3], float **values) {
  char *bytes;
  size_t size;
  *values = NULL;
  CF_TRY(cf_file_read(path, MOST_BYTES, &bytes, &size));
  const cf_status s = read_all(path, bytes, size, axes, n, values);
  cf_free(bytes);
  return s;
}
