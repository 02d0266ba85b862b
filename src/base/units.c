/* SPDX-License-Identifier: MIT
 *
 * Units by udunits2; see units.h. What the library gets wrong and is put right here: it takes reciprocals for
 * convertible (so dimensions are compared by dividing), it reads "" as 1, it reads m^0.5 as something else
 * (so powers with a point are refused), it multiplies by a number behind a unit (refused as well), its error output goes to the terminal (so it is switched off), and so does a
 * line break in a unit, on the standard output (so there may be none).
 */
#include "base/units.h"

#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <udunits2.h>

enum { UNIT_MAX = 128 };

/* The library keeps its status in a global and its parser is not reentrant: one call at a time. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static ut_system *database;

static cf_status open_database(void) {
  if (database != NULL) return CF_OK;
  ut_set_error_message_handler(ut_ignore);
  database = ut_read_xml(NULL);
  if (database == NULL)
    return cf_fail(CF_FAILED,
                   "the database of units (udunits2) could not be read: is libudunits2-data installed?");
  return CF_OK;
}

/* A dot among the digits of a power: the library would read m^0.5 without complaint as a product. */
static bool has_broken_power(const char *text) {
  for (const char *power = strpbrk(text, "^*"); power != NULL; power = strpbrk(power + 1, "^*")) {
    const size_t digits = strspn(power + 1, "*+-0123456789");
    if (digits > 0 && power[1 + digits] == '.') return true;
    if (power[1] == '.') return true;
  }
  return false;
}

/* A number behind the start: for the library "% 3" is 0.03, but who writes 5 % 3 means something else. */
static bool has_number_inside(const char *text) {
  for (const char *blank = strpbrk(text, " \t"); blank != NULL; blank = strpbrk(blank + 1, " \t"))
    if (blank > text && strchr("0123456789", blank[1]) != NULL && blank[1] != '\0') return true;
  return false;
}

static bool is_blank(const char *text) { return text[strspn(text, " \t")] == '\0'; }

static ut_unit *parse(const char *text) {
  char trimmed[UNIT_MAX];
  if (strlen(text) >= UNIT_MAX || strchr(text, '\n') != NULL || has_broken_power(text) ||
      has_number_inside(text))
    return NULL;
  if (is_blank(text)) return ut_get_dimensionless_unit_one(database);
  const char *start = text + strspn(text, " \t");
  size_t count = strlen(start);
  while (strchr(" \t", start[count - 1]) != NULL) --count; /* blanks around a unit change its meaning */
  memcpy(trimmed, start, count);
  trimmed[count] = '\0';
  return ut_parse(database, trimmed, UT_UTF8);
}

static bool same_dimension(const ut_unit *given, const ut_unit *wanted) {
  ut_unit *ratio = ut_divide(given, wanted);
  const bool same = ratio != NULL && ut_is_dimensionless(ratio) != 0;
  ut_free(ratio);
  return same;
}

static cf_status compare(ut_unit *from, ut_unit *to, const char *given, const char *wanted,
                         cf_unit_change *change) {
  const char *expected = is_blank(wanted) ? "a plain number" : wanted;
  if (from == NULL) return cf_fail(CF_BAD_ARGUMENT, "has unit %.60s: there is no such unit", given);
  if (to == NULL) return cf_fail(CF_FAILED, "wants unit %s: there is no such unit", wanted);
  if (!same_dimension(from, to))
    return cf_fail(CF_BAD_ARGUMENT, "has unit %.60s, expected %s", given, expected);
  cv_converter *converter = ut_get_converter(from, to);
  if (converter == NULL) return cf_fail(CF_BAD_ARGUMENT, "has unit %.60s, expected %s", given, expected);
  const double zero = cv_convert_double(converter, 0.0), one = cv_convert_double(converter, 1.0);
  const double two = cv_convert_double(converter, 2.0);
  cv_free(converter);
  const bool straight = isfinite(zero) && isfinite(one) && fabs(two - 2 * one + zero) <= 1e-12 * fabs(two);
  if (!straight)
    return cf_fail(CF_BAD_ARGUMENT, "has unit %.60s, which is not a multiple of %s", given, expected);
  *change = (cf_unit_change){.scale = one - zero, .offset = zero};
  return CF_OK;
}

/* What a unit is in units of the SI without a factor: "m2.s-1" for cm^2/s. */
static cf_status base_unit(ut_unit *unit, const char *given, char *base) {
  char text[UNIT_MAX];
  const int length = unit != NULL ? ut_format(unit, text, sizeof text, UT_ASCII | UT_DEFINITION) : -1;
  if (length < 0 || length >= (int)sizeof text || strpbrk(text, "(:") != NULL)
    return cf_fail(CF_BAD_ARGUMENT, "has unit %.60s: there is no such unit", given);
  char *start = text;
  strtod(text, &start);
  start += strspn(start, " ");
  start[strcspn(start, "@")] = '\0';
  memcpy(base, start, strlen(start) + 1);
  return CF_OK;
}

static cf_status find_change(const char *given, const char *wanted, cf_unit_change *change) {
  char base[UNIT_MAX] = "";
  CF_TRY(open_database());
  ut_unit *from = parse(given);
  if (wanted == NULL) {
    const cf_status status = base_unit(from, given, base);
    if (status != CF_OK) ut_free(from);
    CF_TRY(status);
    wanted = base;
  }
  ut_unit *to = parse(wanted);
  const cf_status status = compare(from, to, given, wanted, change);
  ut_free(from);
  ut_free(to);
  return status;
}

cf_status cf_units_change(const char *given, const char *wanted, cf_unit_change *change) {
  pthread_mutex_lock(&lock);
  const cf_status status = find_change(given, wanted, change);
  pthread_mutex_unlock(&lock);
  return status;
}
