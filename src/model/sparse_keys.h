/* SPDX-License-Identifier: MIT
 *
 * The keys of `sparse:` in a scene.
 */
#ifndef CF_MODEL_SPARSE_KEYS_H
#define CF_MODEL_SPARSE_KEYS_H

#include "base/param.h"

#define CF_SPARSE_WORDS(W) W(OFF, off) W(ON, on)
enum { CF_SPARSE_OFF, CF_SPARSE_ON };

#define CF_SPARSE_TABLE(P, R)                                                                           \
  P(follow, word, "off", "", CF_WORDS(CF_SPARSE_WORDS),                                                 \
    "on: scalars are computed only in a part of the box that follows them, and are 0 elsewhere: an "    \
    "empty sky costs nothing")                                                                          \
  P(threshold, number, "1e-8", "", "[0, 1)",                                                            \
    "Where all scalars are below this share of their largest values nothing is computed; what is cut "  \
    "off there is counted as having left")                                                              \
  P(margin, integer, "8", "", "[0, 4096]",                                                              \
    "Cells around what is above the threshold that are computed too, at least; more where things move " \
    "farther in a step")

typedef struct cf_scene_sparse {
  CF_PARAM_MEMBERS(CF_SPARSE_TABLE)
} cf_scene_sparse;

#endif
