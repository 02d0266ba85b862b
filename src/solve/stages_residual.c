/* SPDX-License-Identifier: MIT
 *
 * The end of a cycle on the finest level: the half sweep that leaves the residual behind, and taking the correction.
 *
 * Images: along x differences are taken with one coupling everywhere, which is right at a wall if behind it stands
 * what makes it so (e itself behind an insulated one, -e behind a held one).
 */
#include "solve/stages_apply.h"

/* --- the last half sweep ------------------------------------------------------------------------------ */

CF_KERNEL void last_rows(const int dim, const cf_split *s, const cf_strip *t, const float omega) {
  CF_FOR_ROWS(j, t) {
    const cf_half red = cf_half_of(dim, s, j, t->k, 0), black = cf_half_of(dim, s, j, t->k, 1);
    cf_half_set_images(s, t, &black, 1);
    if (cf_half_is_inner(dim, &black))
      cf_last_half(dim, 1, &black, t, omega);
    else
      cf_last_half(dim, 0, &black, t, omega);
    cf_clear_pad(s, t, &black);
    cf_half_join(s, t, &black);
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

CF_KERNEL void update_rows(const int dim, const cf_pass *p, const cf_strip *t, const float omega) {
  const cf_split *s = p->at;
  const int n = cf_natural_count(s, t);
  CF_FOR_ROWS(j, t) {
    const cf_half red = cf_half_of(dim, s, j, t->k, 0), black = cf_half_of(dim, s, j, t->k, 1);
    const ptrdiff_t at = j * s->row + t->k * s->plane + t->from;
    if (t->next_k >= 0) cf_fetch_x(p, t, j);
    cf_real *x = p->x + cf_box_at(&s->plain->box, 2 * t->from, j, t->k);
    cf_add_woven(n, p->gain, p->lift, s->e + at, s->e + at + s->odd, x);
    if (s->odd_seam) {
      cf_first_half(s, &red, t, omega);
    } else {
      cf_half_set_images(s, t, &black, 0);
      if (cf_half_is_inner(dim, &red))
        cf_restart_half(dim, 1, &red, t, omega);
      else
        cf_restart_half(dim, 0, &red, t, omega);
      cf_clear_pad(s, t, &red);
      cf_half_join(s, t, &red);
    }
    double *sums = cf_sums_of(p, t, j);
    sums[CF_SUM_RESIDUAL * p->sums] = cf_squares(t->to - t->from, s->r + at, s->r + at + s->odd);
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
    CF_FOR_PIECE(m, t) h.r[m] -= cf_applied(dim, 0, &h, m);
    cf_half_set_images(s, t, &h, 0);
    cf_clear_pad(s, t, &h);
  }
}
CF_CLONES static void residual_rows_2d(const cf_split *s, const cf_strip *t) { residual_rows(2, s, t); }
CF_CLONES static void residual_rows_3d(const cf_split *s, const cf_strip *t) { residual_rows(3, s, t); }

void cf_stage_residual(const cf_split *s, const cf_strip *t) {
  (s->dim == 3 ? residual_rows_3d : residual_rows_2d)(s, t);
}
