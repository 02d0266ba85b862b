/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "base/mem.h"

#include <errno.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "base/real.h"

static atomic_long until_failure; /* 0: never; 1: the next allocation fails */

void cf_mem_fail_at(const long n) { atomic_store(&until_failure, n); }

static bool told_to_fail(void) {
  if (atomic_load_explicit(&until_failure, memory_order_relaxed) == 0) return false;
  return atomic_fetch_sub(&until_failure, 1) == 1;
}

cf_status cf_new_array(void **block, const size_t count, const size_t size) {
  *block = NULL;
  if (size != 0 && count > (SIZE_MAX - CF_ALIGN) / size)
    return cf_fail(CF_NO_MEMORY, "%zu elements of %zu bytes: more than can be addressed", count, size);
  const size_t bytes = (CF_MAX(count * size, 1) + CF_ALIGN - 1) / CF_ALIGN * CF_ALIGN;
  void *fresh = told_to_fail() ? NULL : aligned_alloc(CF_ALIGN, bytes);
  if (fresh == NULL)
    return cf_fail(
        CF_NO_MEMORY,
        "out of memory: %zu more bytes were not to be had: use fewer cells, or end what else takes memory",
        bytes);
  memset(fresh, 0, bytes);
  *block = fresh;
  return CF_OK;
}

cf_status cf_new_text(char **copy, const char *text, const size_t length) {
  CF_TRY(cf_new_array((void **)copy, length + 1, 1));
  memcpy(*copy, text, length);
  return CF_OK;
}

void cf_free(void *block) { free(block); }

cf_status cf_pages_reserve(void **pages, const size_t bytes, const bool dense) {
  *pages = NULL;
  void *fresh = MAP_FAILED;
  if (!told_to_fail())
    fresh = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (fresh == MAP_FAILED)
    return cf_fail(CF_NO_MEMORY,
                   "no address space for a field of %.3g MB (is there a limit? see `ulimit -v`): "
                   "use fewer cells or lift the limit",
                   (double)bytes / 1e6);
  madvise(fresh, bytes, dense ? MADV_HUGEPAGE : MADV_NOHUGEPAGE); /* advice: a refusal changes nothing */
  *pages = fresh;
  return CF_OK;
}

void cf_pages_release(void *pages, const size_t bytes) {
  if (pages != NULL) munmap(pages, bytes);
}

cf_status cf_mem_room(const size_t bytes) {
  void *room = MAP_FAILED;
  if (!told_to_fail())
    room = mmap(NULL, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED)
    return cf_fail(
        CF_NO_MEMORY,
        "less than %.3g MB of address space are left (is there a limit? see `ulimit -v`): use fewer cells or "
        "lift the limit",
        (double)bytes / 1e6);
  munmap(room, bytes);
  return CF_OK;
}
