/* SPDX-License-Identifier: MIT
 *
 * Numbers with units, and functions: "2.5 cm^2/s", "1/24 s", "0.5*(1 + x) cm^2/s". See scene_value.h.
 *
 * Where a number ends and its unit begins: the whole text is tried as an expression first; if it is none, the unit
 * starts after the first blank (or right after the digits) that has an expression before it and a letter behind it.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/real.h"
#include "base/units.h"
#include "io/scene_value.h"

/* --- expressions and units -------------------------------------------------------------------- */

/* A text taken apart. The expression is NULL when it is none. */
typedef struct cf_quantity {
  cf_expr *expr;
  const char *unit;  /* NULL: none was written */
  char number[1024]; /* the text of the expression, without the unit */
} cf_quantity;

/* A letter, a percent sign, or one of the signs that stand before or for a unit. */
static bool starts_unit(const char *text) {
  static const char *const signs[] = {"%", "\u00B5", "\u03BC", "\u00B0", "\u03A9", "\u2126", "\u00C5"};
  if ((*text >= 'a' && *text <= 'z') || (*text >= 'A' && *text <= 'Z')) return true;
  for (size_t i = 0; i < sizeof signs / sizeof signs[0]; ++i)
    if (strncmp(text, signs[i], strlen(signs[i])) == 0) return true;
  return false;
}

/* Length of the plain number that a text starts with. */
static size_t plain_number(const char *text) {
  const size_t sign = *text == '-' || *text == '+' ? 1 : 0;
  size_t n = sign + strspn(text + sign, "0123456789.");
  const size_t power = n + (text[n] == 'e' || text[n] == 'E' ? 1 : 0);
  const size_t power_sign = power > n && (text[power] == '-' || text[power] == '+') ? 1 : 0;
  const size_t digits = power > n ? strspn(text + power + power_sign, "0123456789") : 0;
  return digits > 0 ? power + power_sign + digits : n;
}

/* Whether a unit may begin at `at`: after a blank, or right behind a plain number. */
static bool may_split(const char *text, const size_t at) {
  if (at == 0 || !starts_unit(text + at)) return false;
  return text[at - 1] == ' ' || plain_number(text) == at;
}

static cf_status split_unit(const cf_reader *reader, const char *text, const cf_expr_variables variables,
                            cf_quantity *quantity) {
  for (size_t at = 1; text[at] != '\0' && at < sizeof quantity->number; ++at) {
    if (!may_split(text, at)) continue;
    snprintf(quantity->number, sizeof quantity->number, "%.*s", (int)at, text);
    const cf_status status =
        cf_expr_create(&quantity->expr, quantity->number, &reader->constants, variables, NULL);
    if (status == CF_NO_MEMORY) return status;
    if (status == CF_OK) {
      quantity->unit = text + at;
      return CF_OK;
    }
  }
  return CF_BAD_ARGUMENT;
}

/* Puts the place of an error in the text of a node into the file. */
static cf_node node_part(const cf_node *node, const cf_expr_place place) {
  cf_node part = *node;
  const size_t inside = node->quoted ? 1 : 0;
  if (node->place.length != strlen(node->text) + 2 * inside)
    return part; /* folded, or with escapes: no telling */
  part.place.at += inside + (size_t)place.at;
  part.place.length = (size_t)CF_MAX(place.length, 1);
  return part;
}

static cf_status take_apart(const cf_reader *reader, const cf_node *node, const cf_expr_variables variables,
                            cf_quantity *quantity) {
  cf_expr_place place;
  char sentence[300];
  *quantity = (cf_quantity){.expr = NULL};
  cf_status status = cf_expr_create(&quantity->expr, node->text, &reader->constants, variables, &place);
  if (status != CF_BAD_ARGUMENT) return status;
  snprintf(sentence, sizeof sentence, "%s", cf_status_sentence());
  status = split_unit(reader, node->text, variables, quantity);
  if (status != CF_BAD_ARGUMENT) return status;
  const cf_node part = node_part(node, place);
  return cf_reader_fail(reader, &part, "%s: %s", reader->path, sentence);
}

static cf_status unit_change(const cf_reader *reader, const cf_node *node, const char *given,
                             const char *wanted, cf_unit_change *change) {
  *change = (cf_unit_change){1.0, 0.0};
  if (given == NULL) return CF_OK;
  const cf_status status = cf_units_change(given, wanted, change);
  if (status != CF_BAD_ARGUMENT) return status;
  return cf_reader_fail(reader, node, "%s %s", reader->path, cf_status_sentence());
}

static cf_status check_finite(const cf_reader *reader, const cf_node *node, const double value) {
  if (isfinite(value)) return CF_OK;
  return cf_reader_fail(reader, node, "%s = %.80s: is not a finite number", reader->path, node->text);
}

cf_status cf_value_quantity(cf_reader *reader, const cf_node *node, const char *unit, double *value) {
  cf_quantity quantity;
  cf_unit_change change;
  CF_TRY(take_apart(reader, node, CF_EXPR_NO_VARIABLES, &quantity));
  const double number = cf_expr_fn(quantity.expr).value;
  cf_expr_destroy(quantity.expr);
  CF_TRY(unit_change(reader, node, quantity.unit, unit, &change));
  *value = number * change.scale + change.offset;
  return check_finite(reader, node, *value);
}

cf_status cf_value_in_range(const cf_reader *reader, const cf_param *param, const cf_node *node,
                            const double value) {
  char sentence[80];
  const cf_param_range range = cf_param_range_of(param);
  if (cf_param_range_has(&range, value)) return CF_OK;
  cf_param_range_sentence(&range, sentence, sizeof sentence);
  return cf_reader_fail(reader, node, "%s = %.80s: must be %s", reader->path, node->text, sentence);
}

/* --- functions -------------------------------------------------------------------------------- */

/* An expression with variables and a unit: the change of unit goes into the expression. */
static cf_status scale_expression(const cf_reader *reader, const cf_expr_variables variables,
                                  const cf_unit_change *change, cf_quantity *quantity) {
  char text[1200];
  cf_expr *scaled;
  snprintf(text, sizeof text, "(%s)*%.17g+%.17g", quantity->number, change->scale, change->offset);
  const cf_status status = cf_expr_create(&scaled, text, &reader->constants, variables, NULL);
  cf_expr_destroy(quantity->expr);
  quantity->expr = status == CF_OK ? scaled : NULL;
  return status;
}

static cf_status finish_function(cf_reader *reader, const cf_param *param, const cf_node *node,
                                 const cf_expr_variables variables, cf_quantity *quantity, cf_fn *fn) {
  cf_unit_change change;
  cf_fn made = cf_expr_fn(quantity->expr);
  CF_TRY(unit_change(reader, node, quantity->unit, param->unit, &change));
  if (cf_fn_is_constant(&made)) {
    *fn = cf_fn_constant(made.value * change.scale + change.offset);
    CF_TRY(check_finite(reader, node, fn->value));
    return cf_value_in_range(reader, param, node, fn->value);
  }
  if (quantity->unit != NULL) CF_TRY(scale_expression(reader, variables, &change, quantity));
  *fn = cf_expr_fn(quantity->expr);
  cf_expr *kept = quantity->expr;
  quantity->expr = NULL;
  return cf_config_keep(reader->config, kept);
}

cf_status cf_value_function(cf_reader *reader, const cf_param *param, const cf_node *node,
                            const cf_expr_variables variables, cf_function *function) {
  cf_quantity quantity;
  CF_TRY(cf_value_expect_scalar(reader, param, node));
  CF_TRY(take_apart(reader, node, variables, &quantity));
  const cf_status status = finish_function(reader, param, node, variables, &quantity, &function->fn);
  cf_expr_destroy(quantity.expr);
  CF_TRY(status);
  return cf_config_copy(reader->config, &function->text, node->text, strlen(node->text));
}

cf_status cf_value_functions(cf_reader *reader, const cf_param *param, const cf_node *node,
                             const cf_expr_variables variables, cf_param_functions *functions) {
  if (node->kind != CF_NODE_LIST) {
    functions->count = 1;
    return cf_value_function(reader, param, node, variables, &functions->axis[0]);
  }
  if (node->count < 1 || node->count > 3)
    return cf_reader_fail(reader, node, "%s has %d %s: must be one an axis", reader->path, node->count,
                          node->count == 1 ? "entry" : "entries");
  const cf_node *entry = node->first;
  for (int a = 0; a < node->count; ++a, entry = entry->next)
    CF_TRY(cf_value_function(reader, param, entry, variables, &functions->axis[a]));
  functions->count = node->count;
  return CF_OK;
}
