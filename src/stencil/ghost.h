/* SPDX-License-Identifier: MIT
 *
 * What lies beyond a wall, for kernels that make their ghost values as they go: a rule for each side, and the
 * volume whose value stands for one outside.
 */
#ifndef CF_STENCIL_GHOST_H
#define CF_STENCIL_GHOST_H

typedef enum cf_ghost {
  CF_GHOST_WRAP,   /* the other side's volumes */
  CF_GHOST_MIRROR, /* cells reflected at the wall */
  CF_GHOST_ODD,    /* faces of the swept axis reflected at the wall face with the sign changed */
  CF_GHOST_COPY,   /* the nearest volume's value */
  CF_GHOST_INFLOW, /* `inflow` where the flow enters, the nearest volume's value where it leaves */
} cf_ghost;

/* The volume along the axis (0..count-1) that stands for volume `g` beyond a wall. */
static inline int cf_ghost_image(const cf_ghost rule, const int g, const int count) {
  int i = g < 0 ? 0 : count - 1;
  if (rule == CF_GHOST_WRAP) return ((g % count) + count) % count;
  if (rule == CF_GHOST_MIRROR) i = g < 0 ? -1 - g : 2 * count - 1 - g;
  if (rule == CF_GHOST_ODD) i = g < 0 ? -g : 2 * (count - 1) - g;
  return i < 0 ? 0 : i >= count ? count - 1 : i;
}

#endif
