/* SPDX-License-Identifier: MIT
 *
 * Two kinds of memory. Small zeroed blocks for handles and tables (freed with cf_free), and pages for fields:
 * address space reserved at once, memory committed by the kernel when a page is first touched and
 * zero until then, so a large grid with a small active part costs what is touched.
 *
 * Tests make the n-th allocation fail (cf_mem_fail_at) and walk n upwards until a call succeeds.
 */
#ifndef CF_BASE_MEM_H
#define CF_BASE_MEM_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

/* `count` zeroed elements of `size` bytes, aligned for any vector width; CF_NO_MEMORY if there are none. */
cf_status cf_new_array(void **block, size_t count, size_t size);

/* CF_NEW(&pointer, count): typed form. */
#define CF_NEW(pointer, count) cf_new_array((void **)(pointer), (size_t)(count), sizeof **(pointer))

/* A zero-terminated copy of `length` bytes of text. */
cf_status cf_new_text(char **copy, const char *text, size_t length);

/* Reserves zeroed pages. `dense` asks the kernel for huge pages, otherwise they are forbidden. */
cf_status cf_pages_reserve(void **pages, size_t bytes, bool dense);
void cf_pages_release(void *pages, size_t bytes); /* NULL is fine */

/* CF_NO_MEMORY unless `bytes` of address space could be had now. For calls of libraries that do not survive a failed
 * malloc: leave them room. */
cf_status cf_mem_room(size_t bytes);

/* The n-th allocation from now on fails (n = 1 is the next); 0 switches this off. */
void cf_mem_fail_at(long n);

#endif
