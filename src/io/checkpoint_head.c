/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "io/checkpoint_head.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"
#include "io/checkpoint.h"
#include "io/checksum.h"

#define LINE_ROOM   224 /* a line about an array */
#define FIXED_ROOM  256 /* the other lines */
#define HEAD_LEAST  512
#define HEAD_MOST   ((size_t)1 << 24)
#define BUFFER_SIZE ((size_t)1 << 16)

cf_status cf_head_create(cf_head *head, const int arrays) {
  *head = (cf_head){.size = HEAD_LEAST, .room = arrays};
  while (head->size < FIXED_ROOM + (size_t)arrays * LINE_ROOM) head->size *= 2;
  if (head->size > HEAD_MOST) return cf_fail(CF_BAD_ARGUMENT, "%d arrays in a checkpoint: too many", arrays);
  return CF_NEW(&head->array, arrays);
}

void cf_head_destroy(cf_head *head) {
  cf_free(head->array);
  *head = (cf_head){0};
}

void cf_head_add(cf_head *head, const char *name, const cf_extent *extent) {
  if (head->count == head->room) return;
  cf_head_array *a = &head->array[head->count++];
  snprintf(a->name, sizeof a->name, "%s", name);
  a->extent = *extent;
}

/* --- reading bytes ---------------------------------------------------------------------------------------
 */

typedef struct source {
  int file;
  const char *name;
  uint64_t size;
  unsigned char *buffer; /* BUFFER_SIZE */
} source;

static cf_status read_bytes(const source *s, void *bytes, const size_t count, const uint64_t at) {
  for (size_t done = 0; done < count;) {
    const ssize_t some = pread(s->file, (char *)bytes + done, count - done, (off_t)(at + done));
    if (some < 0 && errno == EINTR) continue;
    if (some < 0) return cf_fail(CF_BAD_FILE, "%s: cannot be read: %s", s->name, strerror(errno));
    if (some == 0)
      return cf_fail(CF_BAD_FILE, "%s: ended at byte %" PRIu64 " while it was read", s->name, at + done);
    done += (size_t)some;
  }
  return CF_OK;
}

static cf_status checksum_of(const source *s, const uint64_t from, const uint64_t bytes, uint64_t *sum) {
  cf_checksum c;
  cf_checksum_start(&c);
  for (uint64_t done = 0; done < bytes;) {
    const size_t some = (size_t)CF_MIN(bytes - done, BUFFER_SIZE);
    CF_TRY(read_bytes(s, s->buffer, some, from + done));
    cf_checksum_add(&c, s->buffer, some);
    done += some;
  }
  *sum = cf_checksum_end(&c);
  return CF_OK;
}

static cf_status open_source(source *s, const char *path, const char *name, const int flags) {
  struct stat facts = {0};
  *s = (source){.file = open(path, flags | O_CLOEXEC | O_NONBLOCK), .name = name};
  if (s->file < 0) return cf_fail(CF_BAD_FILE, "%s: cannot be opened: %s", name, strerror(errno));
  cf_status status = CF_OK;
  if (fstat(s->file, &facts) != 0 || !S_ISREG(facts.st_mode))
    status = cf_fail(CF_BAD_FILE, "%s: is not a file", name);
  else
    status = CF_NEW(&s->buffer, BUFFER_SIZE);
  s->size = (uint64_t)facts.st_size;
  if (status != CF_OK) close(s->file);
  return status;
}

static void close_source(source *s) {
  close(s->file);
  cf_free(s->buffer);
}

/* --- writing ----------------------------------------------------------------------------------------------
 */

/* The lines, in a zeroed page of head->size bytes. */
static void print_page(const cf_head *head, const uint64_t bytes, const uint64_t sum, char *page) {
  char *at = page;
  at += sprintf(at, "cattaneo checkpoint %d %zu\nbytes %" PRIu64 "\nchecksum %016" PRIx64 "\n",
                CF_CHECKPOINT_FORMAT, head->size, bytes, sum);
  for (int i = 0; i < head->count; ++i) {
    const cf_head_array *a = &head->array[i];
    at += sprintf(at, "array %s %" PRIu64 " %" PRIu64 " %016" PRIx64 "\n", a->name, a->extent.offset,
                  a->extent.bytes, a->extent.checksum);
  }
  sprintf(at, "end %016" PRIx64 "\n", cf_checksum_of(page, (size_t)(at - page), 1));
}

static cf_status write_page(const source *s, const cf_head *head) {
  uint64_t sum;
  char *page;
  if (s->size < head->size)
    return cf_fail(CF_CANNOT_WRITE, "%s: was cut short while it was written", s->name);
  CF_TRY(checksum_of(s, head->size, s->size - head->size, &sum));
  CF_TRY(CF_NEW(&page, head->size));
  print_page(head, s->size, sum, page);
  const ssize_t written = pwrite(s->file, page, head->size, 0);
  cf_free(page);
  if (written == (ssize_t)head->size) return CF_OK;
  return cf_fail(CF_CANNOT_WRITE, "%s: cannot be written: %s", s->name,
                 strerror(written < 0 ? errno : ENOSPC));
}

cf_status cf_head_write(const cf_head *head, const char *path, const char *name) {
  source s;
  CF_TRY(open_source(&s, path, name, O_RDWR));
  const cf_status status = write_page(&s, head);
  close_source(&s);
  return status;
}

/* --- checking
 * ----------------------------------------------------------------------------------------------- */

static cf_status damaged(const source *s, const char *what) {
  return cf_fail(CF_BAD_FILE, "%s: is damaged: %s", s->name, what);
}

/* The page of a file, zero-terminated. */
static cf_status read_page(const source *s, char **page, size_t *size) {
  char first[HEAD_LEAST + 1] = {0};
  int format;
  *page = NULL;
  if (s->size == 0) return cf_fail(CF_BAD_FILE, "%s: is empty", s->name);
  CF_TRY(read_bytes(s, first, (size_t)CF_MIN(s->size, HEAD_LEAST), 0));
  const int got = sscanf(first, "cattaneo checkpoint %6d %9zu\n", &format, size);
  if (got < 1) return cf_fail(CF_BAD_FILE, "%s: is not a checkpoint of this program", s->name);
  if (format != CF_CHECKPOINT_FORMAT)
    return cf_fail(
        CF_BAD_FILE,
        "%s: has format %d, this program reads format %d: go on with the version of cattaneo that wrote it",
        s->name, format, CF_CHECKPOINT_FORMAT);
  if (got < 2 || *size < HEAD_LEAST || *size > HEAD_MOST || (*size & (*size - 1)) != 0)
    return damaged(s, "its first line");
  if (s->size < *size)
    return cf_fail(CF_BAD_FILE, "%s: is cut short: it has %" PRIu64 " bytes", s->name, s->size);
  CF_TRY(CF_NEW(page, *size + 1));
  const cf_status status = read_bytes(s, *page, *size, 0);
  if (status != CF_OK) cf_free(*page);
  return status;
}

/* Whether the page is as it was written: its own checksum, and zeros behind. */
static bool is_whole_page(const char *page, const size_t size) {
  const char *end = strstr(page, "\nend ");
  uint64_t sum;
  int used = 0;
  if (end == NULL || sscanf(end + 1, "end %16" SCNx64 "%n", &sum, &used) != 1 || used != 20) return false;
  if (sum != cf_checksum_of(page, (size_t)(end + 1 - page), 1) || end[21] != '\n') return false;
  for (size_t i = (size_t)(end + 22 - page); i < size; ++i)
    if (page[i] != 0) return false;
  return true;
}

/* Which arrays are damaged, in words. */
static cf_status find_damage(const source *s, const char *page) {
  char list[512] = "";
  for (const char *line = strstr(page, "\narray "); line != NULL; line = strstr(line + 1, "\narray ")) {
    cf_head_array a;
    uint64_t sum;
    if (sscanf(line, "\narray %127s %" SCNu64 " %" SCNu64 " %16" SCNx64, a.name, &a.extent.offset,
               &a.extent.bytes, &a.extent.checksum) != 4)
      break;
    if (a.extent.offset > s->size || a.extent.bytes > s->size - a.extent.offset) continue;
    CF_TRY(checksum_of(s, a.extent.offset, a.extent.bytes, &sum));
    const size_t length = strlen(list);
    if (sum != a.extent.checksum)
      snprintf(list + length, sizeof list - length, "%s%s (checksum %016" PRIx64 ", expected %016" PRIx64 ")",
               length > 0 ? ", " : "", a.name, sum, a.extent.checksum);
  }
  return damaged(s, list[0] != '\0' ? list : "its structure, not the values");
}

static cf_status check_rest(const source *s, const char *page, const size_t size) {
  uint64_t bytes, expected, sum;
  const char *line = strchr(page, '\n');
  if (!is_whole_page(page, size) || line == NULL ||
      sscanf(line, "\nbytes %" SCNu64 "\nchecksum %16" SCNx64, &bytes, &expected) != 2)
    return damaged(s, "the page of text at its start");
  if (bytes != s->size)
    return cf_fail(CF_BAD_FILE, "%s: is %s: expected %" PRIu64 " bytes, found %" PRIu64, s->name,
                   s->size < bytes ? "cut short" : "too long", bytes, s->size);
  CF_TRY(checksum_of(s, size, s->size - size, &sum));
  return sum == expected ? CF_OK : find_damage(s, page);
}

cf_status cf_head_check(const char *path) {
  source s;
  char *page = NULL;
  size_t size = 0;
  CF_TRY(open_source(&s, path, path, O_RDONLY));
  cf_status status = read_page(&s, &page, &size);
  if (status == CF_OK) {
    status = check_rest(&s, page, size);
    cf_free(page);
  }
  close_source(&s);
  return status;
}
