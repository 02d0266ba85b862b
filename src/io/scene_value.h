/* SPDX-License-Identifier: MIT
 *
 * Single values of a scene: from a node of the tree to the member of a struct. Inside io only.
 *
 * A number is an expression of constants, with a unit after it if the row has one: 2.5 cm^2/s, 1/24, 2*H. A
 * function is an expression, or that with a unit. What is checked here: kind of node, unit, finite, range.
 */
#ifndef CF_IO_SCENE_VALUE_H
#define CF_IO_SCENE_VALUE_H

#include "base/param.h"
#include "base/status.h"
#include "io/scene_tree.h"

/* What goes with reading: where in the tree of keys it is, and the constants known so far. */
typedef struct cf_reader {
  cf_config *config;
  cf_expr_constants constants;
  char path[256]; /* "fields.phi.initial" */
  size_t length;
} cf_reader;

/* Goes one key deeper; the length before is what cf_reader_leave wants. */
size_t cf_reader_enter(cf_reader *reader, const char *key);
void cf_reader_leave(cf_reader *reader, size_t length);

/* CF_BAD_SCENE at a node, about the key that is being read. */
cf_status cf_reader_fail(const cf_reader *reader, const cf_node *node, const char *format, ...)
    CF_PRINTF(3, 4);

/* One value for every type of row but records; `member` is of the type that goes with the row. */
cf_status cf_value_read(cf_reader *reader, const cf_param *param, const cf_node *node, void *member);

/* The parts of it that walls use too. */
cf_status cf_value_function(cf_reader *reader, const cf_param *param, const cf_node *node,
                            cf_expr_variables variables, cf_function *function);
cf_status cf_value_quantity(cf_reader *reader, const cf_node *node, const char *unit, double *value);
cf_status cf_value_functions(cf_reader *reader, const cf_param *param, const cf_node *node,
                             cf_expr_variables variables, cf_param_functions *functions);
cf_status cf_value_in_range(const cf_reader *reader, const cf_param *param, const cf_node *node,
                            double value);
cf_status cf_value_expect_scalar(const cf_reader *reader, const cf_param *param, const cf_node *node);
cf_status cf_value_walls(cf_reader *reader, const cf_param *param, const cf_node *node,
                         cf_param_walls *walls);
cf_status cf_value_constants(cf_reader *reader, const cf_param *param, const cf_node *node,
                             cf_param_constants *constants);
cf_status cf_value_interval(cf_reader *reader, const cf_param *param, const cf_node *node,
                            cf_interval *interval);

/* "is not one of a, b, c", and which may have been meant. */
cf_status cf_value_fail_word(const cf_reader *reader, const cf_node *node, const char *words,
                             const char *word);

#endif
