/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "base/locale.h"

#include <locale.h>

void *cf_locale_plain(void) {
  const locale_t plain =
      newlocale(LC_ALL_MASK, "C", (locale_t)0); /* of the system's own, nothing is allocated */
  return uselocale(plain);
}

void cf_locale_back(void *before) { uselocale(before); }
