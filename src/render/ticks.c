/* SPDX-License-Identifier: MIT */
#include "render/ticks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/real.h"

#define MINUS "\xe2\x88\x92"
#define TIMES "\xc3\x97"

/* The step of 1, 2 or 5 times a power of ten that gives at most this many. */
static double round_step(const double span, const double wanted) {
  const double rough = span / CF_MAX(wanted, 1), power = pow(10, floor(log10(rough)));
  const double times = rough / power;
  return power * (times <= 1 ? 1 : times <= 2 ? 2 : times <= 5 ? 5 : 10);
}

static void write_label(char *label, const size_t size, const double value, const int decimals) {
  char digits[20];
  snprintf(digits, sizeof digits, "%.*f", decimals, fabs(value));
  const int is_zero = strspn(digits, "0.") == strlen(digits);
  snprintf(label, size, "%s%s", value < 0 && !is_zero ? MINUS : "", digits);
}

cf_ticks cf_ticks_between(const double low, const double high, const double wanted) {
  cf_ticks t = {.count = 0};
  if (!(low < high) || !isfinite(low) || !isfinite(high)) return t;
  const double step = round_step(high - low, CF_MIN(wanted, CF_TICKS_MAX - 2));
  const double largest = CF_MAX(fabs(low), fabs(high));
  int power = (int)floor(log10(largest) + 1e-9);
  if (power < 5 && power > -4) power = 0;
  if (power != 0) snprintf(t.factor, sizeof t.factor, TIMES "10^%d", power);
  const double unit = pow(10, power);
  const int decimals = CF_MIN(CF_MAX((int)ceil(-log10(step / unit) - 1e-9), 0), 12);
  for (double n = ceil(low / step - 1e-6); n * step <= high + 1e-6 * step && t.count < CF_TICKS_MAX; ++n) {
    t.at[t.count] = n * step;
    write_label(t.label[t.count], sizeof t.label[0], n * step / unit, decimals);
    ++t.count;
  }
  return t;
}
