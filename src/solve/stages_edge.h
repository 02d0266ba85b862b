/* SPDX-License-Identifier: MIT
 *
 * What stages do to a piece of a half on an edge segment (segments.h), where every cell has faces of its own: sixteen cells at a
 * time (grid/lanes.h says why that is written out). A piece has whole vectors of them.
 */
#ifndef CF_SOLVE_STAGES_EDGE_H
#define CF_SOLVE_STAGES_EDGE_H

#include "solve/segments.h"
#include "solve/stages_apply.h"

#define CF_INTO_SIXTEEN(p, v) (*(cf_sixteen_floats *)(p) = (v))
#define CF_FLOATS_OF(ints)    __builtin_convertvector(ints, cf_sixteen)

/* The diagonal of sixteen cells from m on. */
#define CF_DIAGONAL_AT(h, m) \
  ((h)->alpha + CF_FLOATS_OF(CF_SIXTEEN_OF_BYTES((h)->held + (m)) >> CF_HELD_BITS) * (h)->coupling)

/* A' e of sixteen cells from m on, face by face: differences are exact in single precision where e is smooth. */
CF_KERNEL void cf_applied_at_edge(const int dim, const cf_half *h, const int m, cf_sixteen *out) {
  const float *e = h->e + m, *side = h->side + m;
  const cf_sixteen_ints faces = CF_SIXTEEN_OF_BYTES(h->faces + m);
  const cf_sixteen held = CF_FLOATS_OF(CF_SIXTEEN_OF_BYTES(h->held + m) & CF_HELD_MASK), c = CF_SIXTEEN_OF(e);
  cf_sixteen sum = CF_SIXTEEN_WHERE(faces, 1, c - CF_SIXTEEN_OF(side)) -
                   CF_SIXTEEN_WHERE(faces, 2, CF_SIXTEEN_OF(side + 1) - c);
  sum += CF_SIXTEEN_WHERE(faces, 4, c - CF_SIXTEEN_OF(e + h->y[0])) -
         CF_SIXTEEN_WHERE(faces, 8, CF_SIXTEEN_OF(e + h->y[1]) - c);
  if (dim == 3)
    sum += CF_SIXTEEN_WHERE(faces, 16, c - CF_SIXTEEN_OF(e + h->z[0])) -
           CF_SIXTEEN_WHERE(faces, 32, CF_SIXTEEN_OF(e + h->z[1]) - c);
  *out = h->alpha * c + h->coupling * (sum + held * c);
}

/* As cf_last_half; returns the sum of the products of r before and after. */
CF_KERNEL double cf_last_edge(const int dim, const cf_half *of, const cf_strip *t, const float omega,
                              const float step) {
  const cf_half h = *of;
  cf_sixteen products = {0};
  for (int m = t->from; m < t->to; m += CF_SPLIT_LANES) {
    cf_sixteen applied;
    cf_applied_at_edge(dim, &h, m, &applied);
    const cf_sixteen r = CF_SIXTEEN_OF(h.r + m), old = CF_SIXTEEN_OF(h.e + m), residual = r - applied;
    const cf_sixteen fresh = old + omega * CF_SIXTEEN_OF(h.inverse + m) * residual;
    const cf_sixteen rest = residual - CF_DIAGONAL_AT(&h, m) * (fresh - old);
    const cf_sixteen taken = step == 1 ? rest : r + step * (rest - r);
    products += r * taken;
    CF_INTO_SIXTEEN(h.r + m, taken);
    CF_INTO_SIXTEEN(h.e + m, fresh);
  }
  return cf_sum_sixteen(&products);
}

/* As cf_restart_half; returns the same. */
CF_KERNEL double cf_restart_edge(const int dim, const cf_half *of, const cf_strip *t, const float omega,
                                 const float step) {
  const cf_half h = *of;
  cf_sixteen products = {0};
  for (int m = t->from; m < t->to; m += CF_SPLIT_LANES) {
    cf_sixteen applied;
    cf_applied_at_edge(dim, &h, m, &applied);
    const cf_sixteen before = CF_SIXTEEN_OF(h.r + m), r = before - step * applied;
    products += before * r;
    CF_INTO_SIXTEEN(h.r + m, r);
    CF_INTO_SIXTEEN(h.e + m, omega * CF_SIXTEEN_OF(h.inverse + m) * r);
  }
  return cf_sum_sixteen(&products);
}

/* to += amount, of the first cells of sixteen at the end of a row. */
CF_KERNEL void cf_add_sixteen(const int count, const cf_sixteen *amount, float *to) {
  if (count >= CF_SPLIT_LANES) {
    CF_INTO_SIXTEEN(to, CF_SIXTEEN_OF(to) + *amount);
    return;
  }
  float line[CF_SPLIT_LANES];
  memcpy(line, amount, sizeof line);
  for (int i = 0; i < count; ++i) to[i] += line[i];
}

/* What red cells [from, end) leave to coarse ones, after a black half sweep that has left nothing on its own. */
CF_KERNEL void cf_gather_edge(const int dim, const cf_half *of, const int from, const int end,
                              float *coarse) {
  const cf_half h = *of;
  for (int m = from; m < end; m += CF_SPLIT_LANES) {
    const float *e = h.e + m, *side = h.side + m;
    cf_sixteen around = (CF_SIXTEEN_OF(side) + CF_SIXTEEN_OF(side + 1)) +
                        (CF_SIXTEEN_OF(e + h.y[0]) + CF_SIXTEEN_OF(e + h.y[1]));
    if (dim == 3) around += CF_SIXTEEN_OF(e + h.z[0]) + CF_SIXTEEN_OF(e + h.z[1]);
    const cf_sixteen rest =
        (CF_SIXTEEN_OF(h.r + m) - CF_DIAGONAL_AT(&h, m) * CF_SIXTEEN_OF(e)) + h.coupling * around;
    const cf_sixteen taken = CF_SIXTEEN_WHERE(CF_SIXTEEN_OF_BYTES(h.faces + m), CF_FACES_TRANSFER, rest);
    cf_add_sixteen(end - m, &taken, coarse + m);
  }
}

/* Rows of coarse cells: that of a fine cell, and those next to it along y and z; and weights of interpolation. */
typedef struct cf_spread_from {
  const float *own, *y, *z;
  const unsigned char *faces, *weight[3];
} cf_spread_from;

/* e += what cells [from, end) of a half take from the coarse level; side: where the coarse neighbour along x lies. */
CF_KERNEL void cf_spread_edge(const int dim, const cf_spread_from *of, const int side, const int from,
                              const int end, float *e) {
  const cf_spread_from w = *of;
  const float unit = 1.0f / 256;
  for (int m = from; m < end; m += CF_SPLIT_LANES) {
    const cf_sixteen own = CF_SIXTEEN_OF(w.own + m);
    cf_sixteen sum =
        own + unit * CF_FLOATS_OF(CF_SIXTEEN_OF_BYTES(w.weight[1] + m)) * (CF_SIXTEEN_OF(w.y + m) - own);
    if (dim == 3)
      sum += unit * CF_FLOATS_OF(CF_SIXTEEN_OF_BYTES(w.weight[2] + m)) * (CF_SIXTEEN_OF(w.z + m) - own);
    sum +=
        unit * CF_FLOATS_OF(CF_SIXTEEN_OF_BYTES(w.weight[0] + m)) * (CF_SIXTEEN_OF(w.own + m + side) - own);
    const cf_sixteen taken = CF_SIXTEEN_WHERE(CF_SIXTEEN_OF_BYTES(w.faces + m), CF_FACES_TRANSFER, sum);
    cf_add_sixteen(end - m, &taken, e + m);
  }
}

#endif
