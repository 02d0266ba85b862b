/* SPDX-License-Identifier: MIT
 *
 * The fast path in a part of the box: alpha and beta are numbers, and cells have kinds.
 *
 * The finest level is split and worked on in one sweep a cycle as in the whole box (stages_segments.c). Below it are the
 * levels of couplings (varied.h), which know of plates, channels and pockets what split levels cannot. The iteration is the
 * stationary one; what it gains too little on is left to conjugate gradients.
 */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "solve/box_part.h"

/* Where more cells than this have another parent than the block they lie in, necks of a cell are everywhere: cycles alone
 * would gain too little, and conjugate gradients had better begin at once. */
#define ODD_SHARE 0.015

cf_status cf_box_solver_create_around(cf_box_solver **f, const cf_helmholtz *A, cf_varied *v) {
  *f = NULL;
  cf_box_solver *fresh;
  CF_TRY(CF_NEW(&fresh, 1));
  fresh->varied = v;
  fresh->levels = 1;
  cf_split *finest = &fresh->level[0];
  cf_status s = cf_split_create(finest, &A->level[0], v->tiles == NULL);
  finest->segments = &fresh->segments;
  if (s == CF_OK) s = cf_wave_create(&fresh->wave, finest);
  if (s != CF_OK) {
    cf_box_solver_destroy(fresh);
    return s;
  }
  *f = fresh;
  return CF_OK;
}

/* The weights of interpolation at edges, where all cells take part in the usual way at first. */
static void take_transfers(const cf_box_solver *f) {
  const cf_coupled *l = &f->varied->level[0];
  const cf_split *s = &f->level[0];
  const cf_segments *g = &f->segments;
#pragma omp parallel for schedule(static) num_threads(s->threads)
  for (int k = g->low[2]; k < g->high[2]; ++k)
    for (int j = g->low[1]; j < g->high[1]; ++j)
      CF_FOR_ROW_SEGMENTS (g, &g->edges, s, j, k, q) {
        cf_segment_table *t = &g->table[q->table];
        if (q->table < CF_REGULAR_TABLES) continue;
        const ptrdiff_t p = cf_box_at(&l->box, cf_segment_cell(s, q, j, k), j, k);
        for (int i = t->low; i < t->high; ++i) {
          const int lane = cf_lane_of(i);
          if (!(t->faces[lane] & CF_FACES_INSIDE)) continue;
          t->faces[lane] |= CF_FACES_TRANSFER;
          for (int a = 0; a < l->dim; ++a) t->weight[a][lane] = l->weight[a][p + i];
        }
      }
}

/* Where cell p of the box is on the split level. */
static ptrdiff_t split_place(const cf_split *s, ptrdiff_t p, int at[3]) {
  const cf_box *b = &s->plain->box;
  at[2] = b->dim == 3 ? (int)(p / b->stride[2]) : 0;
  p -= at[2] * b->stride[2];
  at[1] = (int)(p / b->stride[1]);
  at[0] = (int)(p - at[1] * b->stride[1]);
  return at[1] * s->row + at[2] * s->plane + cf_split_at(s, at[0]);
}

/* Their tables are their own: where cells have another parent than others of their block, something is closed. */
static void mark_odds(const cf_box_solver *f) {
  const cf_coupled *l = &f->varied->level[0];
  for (ptrdiff_t v = 0; v < l->odds; ++v) {
    int at[3];
    split_place(&f->level[0], l->odd_cell[v], at);
    cf_segments_table_at(&f->segments, &f->level[0], at)->faces[cf_lane_of(at[0])] &=
        (unsigned char)~CF_FACES_TRANSFER;
  }
}

static bool is_suitable(const cf_box_solver *f, const cf_helmholtz *A) {
  for (int a = 0; a < A->grid.box.dim; ++a)
    if (A->grid.box.n[a] < 2) return false;
  if (cf_level_is_solved_directly(&A->level[0]) || f->level[0].odd_seam) return false;
  if (!(f->scale > 1e-100) || !(f->scale < (sizeof(cf_real) == sizeof(float) ? 1e30 : 1e100))) return false;
  if (f->depth == 1) return true;
  const cf_coupled *l = &f->varied->level[0];
  return f->varied->depth > 1 && (double)l->odds <= ODD_SHARE * (double)f->varied->region->inside;
}

cf_status cf_box_solver_set_around(cf_box_solver *f, const cf_helmholtz *A, const double alpha,
                                   const double beta, bool *taken) {
  cf_split *s = &f->level[0];
  const double h = A->grid.h, stiffness = 2 * A->grid.box.dim * beta / (h * h) / alpha;
  f->depth = stiffness <= CF_BOX_SWEEPS_ENOUGH ? 1 : f->varied->depth;
  f->alpha = alpha;
  f->beta = beta;
  f->singular = f->varied->pockets.count == 1 && f->varied->pockets.single;
  f->scale = alpha + 2 * A->grid.box.dim * beta / (h * h);
  *taken = is_suitable(f, A);
  if (!*taken) return CF_OK;
  f->jacobi = stiffness / (1 + stiffness);
  f->thorough = f->depth > 1;
  const cf_setting on = cf_setting_for(A->grid.box.dim, stiffness);
  for (int v = 0; v < CF_BOX_HALF_SWEEPS; ++v) f->omega[v] = 1 + on.over[v];
  cf_split_set(s, alpha, beta, f->scale, (double[4]){1, 1, 1, 1});
  if (f->segments.rows > 0) cf_segments_clear(&f->segments, s);
  CF_TRY(cf_segments_find(&f->segments, s, f->varied->region));
  f->sums = f->segments.rows * cf_wave_pieces(s);
  cf_free(f->rows);
  f->rows = NULL;
  CF_TRY(CF_NEW(&f->rows, CF_PASS_SUMS * f->sums));
  if (f->depth == 1) return CF_OK;
  take_transfers(f);
  mark_odds(f);
  return CF_OK;
}

double cf_box_sample_around(const cf_box_solver *f, const cf_cell b, const cf_cell x) {
  const cf_split *s = &f->level[0];
  const cf_segments *g = &f->segments;
  const ptrdiff_t step = CF_MAX(g->rows / 61, 1);
  double largest = 0;
  for (int k = g->low[2]; k < g->high[2]; ++k)
    for (int j = g->low[1]; j < g->high[1]; ++j) {
      if (g->number[cf_segments_row(s, j, k)] % step != 0) continue;
      CF_FOR_ROW_SEGMENTS (g, &g->all, s, j, k, q) {
        const cf_segment_table *t = &g->table[q->table];
        const ptrdiff_t p = cf_box_at(&s->plain->box, cf_segment_cell(s, q, j, k), j, k);
        for (int i = t->low; i < t->high; ++i)
          if (t->faces[cf_lane_of(i)] & CF_FACES_INSIDE)
            largest =
                CF_MAX(largest, CF_MAX(fabs((double)b.at[p + i]), f->scale * fabs((double)x.at[p + i])));
      }
    }
  return largest;
}

/* --- cells with another parent ------------------------------------------------------------------------ */

/* What is left of a cell's equation. */
static float rest_of(const cf_box_solver *f, const ptrdiff_t p) {
  const cf_split *s = &f->level[0];
  int at[3];
  const ptrdiff_t here = split_place(s, p, at);
  const cf_segment_table *t = cf_segments_table_at(&f->segments, s, at);
  const int lane = cf_lane_of(at[0]), faces = t->faces[lane];
  const float c = s->e[here];
  float sum = (float)(t->held[lane] & CF_HELD_MASK) * c;
  for (int a = 0; a < s->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if (!(faces >> (2 * a + side) & 1)) continue;
      int other[3] = {at[0], at[1], at[2]};
      other[a] = (at[a] + (side ? 1 : s->n[a] - 1)) % s->n[a];
      sum += c - s->e[other[1] * s->row + other[2] * s->plane + cf_split_at(s, other[0])];
    }
  return s->r[here] - (s->alpha * c + s->coupling * sum);
}

void cf_box_gather_odds(const cf_box_solver *f) {
  const cf_coupled *l = &f->varied->level[0], *coarse = &f->varied->level[1];
  for (ptrdiff_t v = 0; v < l->odds; ++v) {
    l->odd_value[v] = rest_of(f, l->odd_cell[v]);
    if (l->odd_parent[v] != CF_NO_PARENT) coarse->r[l->odd_parent[v]] += l->odd_value[v];
  }
}

void cf_box_spread_odds(const cf_box_solver *f) {
  const cf_coupled *l = &f->varied->level[0], *coarse = &f->varied->level[1];
  int at[3];
  cf_coupled_lift_odds(coarse, l);
  for (ptrdiff_t v = 0; v < l->odds; ++v)
    f->level[0].e[split_place(&f->level[0], l->odd_cell[v], at)] += l->odd_value[v];
}
