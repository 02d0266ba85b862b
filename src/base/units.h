/* SPDX-License-Identifier: MIT
 *
 * Units of measurement: what "2.5 cm^2/s" is in the unit a parameter is kept in. The database is that of
 * udunits2 and is loaded once, at the first use; it is read-only afterwards and guarded by a lock.
 *
 * Only scale factors: 20 degC is 293.15 K (an offset is honoured), logarithmic units are refused.
 */
#ifndef CF_BASE_UNITS_H
#define CF_BASE_UNITS_H

#include "base/status.h"

/* value_wanted = scale * value_given + offset. */
typedef struct cf_unit_change {
  double scale, offset;
} cf_unit_change;

/* How numbers in the unit `given` become numbers in the unit `wanted` ("" is a plain number,
 * NULL the unit of the SI that fits).
 * CF_BAD_ARGUMENT with a sentence made to follow the name of a key: "has unit m/s, expected m^2/s" or
 * "has unit cmm: there is no such unit". */
cf_status cf_units_change(const char *given, const char *wanted, cf_unit_change *change);

#endif
