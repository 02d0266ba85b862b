/* SPDX-License-Identifier: MIT
 *
 * The end of a cycle on the finest level: the half sweep that leaves the residual behind, and taking the correction.
 *
 * Images: along x differences are taken with one coupling everywhere, which is right at a wall if behind it stands
 * what makes it so (e itself behind an insulated one, -e behind a held one).
 */
#include "solve/stages_part.h"

/* --- A' e --------------------------------------------------------------------------------------------- */

/* What an axis adds to A' e where its couplings differ: the smaller one times the second difference, and the rest. */
CF_KERNEL float skewed(const float lo, const float hi, const float below, const float here,
                       const float above) {
  const float least = lo < hi ? lo : hi;
  return least * ((here - below) - (above - here)) +
         ((lo - least) * (here - below) - (hi - least) * (above - here));
}

/* A' e from second differences, which are exact in single precision where e is smooth. `inner`: no wall in y and z. */
CF_KERNEL float applied(const int dim, const int inner, const cf_half *h, const int m) {
  const float *e = h->e + m, *side = h->side + m;
  const float c = e[0], x = (c - side[0]) - (side[1] - c);
  if (inner) {
    const float y = (c - e[-h->y]) - (e[h->y] - c);
    const float z = dim == 3 ? (c - e[-h->z]) - (e[h->z] - c) : 0;
    return h->alpha * c + h->coupling * (dim == 3 ? (x + y) + z : x + y);
  }
  float sum = h->coupling * x + skewed(h->lo_y, h->hi_y, e[-h->y], c, e[h->y]);
  if (dim == 3) sum += skewed(h->lo_z, h->hi_z, e[-h->z], c, e[h->z]);
  return h->alpha * c + sum;
}

CF_KERNEL int is_inner(const int dim, const cf_half *h) {
  return h->lo_y == h->coupling && h->hi_y == h->coupling &&
         (dim == 2 || (h->lo_z == h->coupling && h->hi_z == h->coupling));
}

/* The first element of the padding has heard of the last cell. */
CF_KERNEL void clear_pad(const cf_split *s, const cf_strip *t, const cf_half *h) {
  if (t->to == s->width && s->half[h->parity] < s->width) h->r[s->half[h->parity]] = 0;
}

/* --- the last half sweep ------------------------------------------------------------------------------ */

/* What the change of e, as stored, leaves of the residual. */
CF_KERNEL void last_half(const int dim, const int inner, const cf_half *of, const cf_strip *t,
                         const float omega) {
  const cf_half h = *of;
  CF_FOR_PIECE(m, t) {
    const float residual = h.r[m] - applied(dim, inner, &h, m);
    const float old = h.e[m], fresh = old + omega * h.inverse[m] * residual;
    h.r[m] = residual - h.diagonal[m] * (fresh - old);
    h.e[m] = fresh;
  }
}

CF_KERNEL void last_rows(const int dim, const cf_split *s, const cf_strip *t, const float omega) {
  CF_FOR_ROWS(j, t) {
    const cf_half red = cf_half_of(dim, s, j, t->k, 0), black = cf_half_of(dim, s, j, t->k, 1);
    cf_half_set_images(s, t, &black, 1);
    if (is_inner(dim, &black))
      last_half(dim, 1, &black, t, omega);
    else
      last_half(dim, 0, &black, t, omega);
    clear_pad(s, t, &black);
    cf_half_set_images(s, t, &red, 1);
  }
}
CF_CLONES static void last_rows_2d(const cf_split *s, const cf_strip *t, const float omega) {
  last_rows(2, s, t, omega);
}
CF_CLONES static void last_rows_3d(const cf_split *s, const cf_strip *t, const float omega) {
  last_rows(3, s, t, omega);
}

void cf_stage_last(const cf_split *s, const cf_strip *t, const float omega) {
  (s->dim == 3 ? last_rows_3d : last_rows_2d)(s, t, omega);
}

/* --- taking the correction ---------------------------------------------------------------------------- */

/* x += gain e + lift, by way of e in its natural order. */
CF_KERNEL void add(const int n, const double gain, const double lift, const float *even, const float *odd,
                   float *line, cf_real *x) {
  CF_ROW_LOOP
  for (int m = 0; m < (n + 1) / 2; ++m) {
    line[2 * m] = even[m];
    line[2 * m + 1] = odd[m];
  }
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) x[i] = (cf_real)((double)x[i] + (gain * (double)line[i] + lift));
}

/* The sum of squares along a piece of both halves: in single precision 16 lanes apart; beyond it in double. */
CF_KERNEL double squares(const int n, const float *even, const float *odd) {
  float lane[CF_SPLIT_LANES] = {0};
  for (int m = 0; m < n; m += CF_SPLIT_LANES)
    for (int l = 0; l < CF_SPLIT_LANES; ++l) lane[l] += even[m + l] * even[m + l] + odd[m + l] * odd[m + l];
  double wide[CF_SUM_LANES];
  for (int l = 0; l < CF_SUM_LANES; ++l) wide[l] = (double)lane[l] + (double)lane[l + CF_SUM_LANES];
  return cf_sum_lanes(wide);
}

/* r -= A' e, then a first half sweep on it. */
CF_KERNEL void restart_half(const int dim, const int inner, const cf_half *of, const cf_strip *t,
                            const float omega) {
  const cf_half h = *of;
  CF_FOR_PIECE(m, t) {
    const float r = h.r[m] - applied(dim, inner, &h, m);
    h.r[m] = r;
    h.e[m] = omega * h.inverse[m] * r;
  }
}

CF_KERNEL void fetch_x(const cf_pass *p, const cf_strip *t, const int j) {
  const cf_real *x = p->x + cf_box_at(&p->at->plain->box, 2 * t->from, t->next_j + j - t->j, t->next_k);
  for (int i = 0; i < 2 * (t->to - t->from); i += CF_LANES) __builtin_prefetch(x + i, 1);
}

CF_KERNEL void update_rows(const int dim, const cf_pass *p, const cf_strip *t, const float omega) {
  const cf_split *s = p->at;
  const int n = cf_natural_count(s, t);
  CF_FOR_ROWS(j, t) {
    const cf_half red = cf_half_of(dim, s, j, t->k, 0), black = cf_half_of(dim, s, j, t->k, 1);
    const ptrdiff_t at = j * s->row + t->k * s->plane + t->from;
    if (t->next_k >= 0) fetch_x(p, t, j);
    cf_real *x = p->x + cf_box_at(&s->plain->box, 2 * t->from, j, t->k);
    add(n, p->gain, p->lift, s->e + at, s->e + at + s->odd, t->scratch, x);
    if (s->odd_seam) {
      cf_first_half(&red, t, omega);
    } else {
      cf_half_set_images(s, t, &black, 0);
      if (is_inner(dim, &red))
        restart_half(dim, 1, &red, t, omega);
      else
        restart_half(dim, 0, &red, t, omega);
      clear_pad(s, t, &red);
    }
    double *sums = cf_sums_of(p, t, j);
    sums[CF_SUM_RESIDUAL * p->sums] = squares(t->to - t->from, s->r + at, s->r + at + s->odd);
    if (p->sums_of_x) cf_sum_row(n, x, &sums[CF_SUM_X * p->sums], &sums[CF_SUM_X2 * p->sums]);
  }
}
CF_CLONES static void update_rows_2d(const cf_pass *p, const cf_strip *t, const float omega) {
  update_rows(2, p, t, omega);
}
CF_CLONES static void update_rows_3d(const cf_pass *p, const cf_strip *t, const float omega) {
  update_rows(3, p, t, omega);
}

void cf_stage_update(const cf_pass *p, const cf_strip *t, const float omega) {
  (p->at->dim == 3 ? update_rows_3d : update_rows_2d)(p, t, omega);
}

/* --- where neighbours share a colour ------------------------------------------------------------------ */

/* For all cells, from e as it is. */
CF_KERNEL void residual_rows(const int dim, const cf_split *s, const cf_strip *t) {
  CF_FOR_ROWS(j, t)
  for (int colour = 0; colour < 2; ++colour) {
    const cf_half h = cf_half_of(dim, s, j, t->k, colour);
    cf_half_set_images(s, t, &h, 1);
    CF_FOR_PIECE(m, t) h.r[m] -= applied(dim, 0, &h, m);
    cf_half_set_images(s, t, &h, 0);
    clear_pad(s, t, &h);
  }
}
CF_CLONES static void residual_rows_2d(const cf_split *s, const cf_strip *t) { residual_rows(2, s, t); }
CF_CLONES static void residual_rows_3d(const cf_split *s, const cf_strip *t) { residual_rows(3, s, t); }

void cf_stage_residual(const cf_split *s, const cf_strip *t) {
  (s->dim == 3 ? residual_rows_3d : residual_rows_2d)(s, t);
}
