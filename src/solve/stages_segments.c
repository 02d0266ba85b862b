/* SPDX-License-Identifier: MIT
 *
 * The stages on a level that has segments (segments.h): each for all of them in its rows that lie within the strip. The
 * next coarser level is one of couplings (coupled.h), whose transfers these are: the residual summed over the children of
 * a coarse cell, and
 *
 *     e += e_c + sum over axes of w_a (e_{c+a} - e_c)
 *
 * with w_a from a table; where all coarse cells around are inside it is linear along each axis in turn, (3 e_c + e_{c+a})/4, as in
 * the whole box: smooth corrections leave a twentieth of what the sum above leaves there.
 */
#include <string.h>

#include "solve/coupled.h"
#include "solve/stages_vectors.h"

/* --- half sweeps -------------------------------------------------------------------------------------- */

/* FRESH: the half counts as 0. FIRST: so does the other one. */
enum { AGAIN, FRESH, FIRST };

CF_KERNEL void relax(const int dim, const int way, const cf_split *s, const cf_segment_list *list,
                     const cf_strip *t, const int colour, const float omega) {
  const cf_ground g = cf_ground_of(dim, s);
  const float keep = 1 - omega;
  CF_FOR_SEGMENTS (list, s, t, q) {
    const cf_sixteen_cells h = cf_cells_of(&g, q, colour);
    cf_sixteen sum = CF_SIXTEEN_OF(h.r), around;
    if (way != FIRST) {
      cf_sixteen_around(dim, &h, &around);
      sum += h.coupling * around;
    }
    const cf_sixteen e = omega * CF_SIXTEEN_OF(h.table->inverse + h.lane) * sum, old = CF_SIXTEEN_OF(h.e);
    CF_INTO_SIXTEEN(h.e, way == AGAIN ? keep * old + e : e);
  }
}

/* --- residual and solution ---------------------------------------------------------------------------- */

/* A black half sweep, and what the change of e, as stored, leaves of the residual where p->step of the correction is taken. */
CF_KERNEL void last(const int dim, const cf_pass *p, const cf_strip *t, const float omega) {
  const cf_split *s = p->at;
  const cf_ground g = cf_ground_of(dim, s);
  const float step = (float)p->step;
  CF_FOR_ROWS(j, t) {
    cf_sixteen products = {0};
    if (!cf_has_segments(s, t, j)) continue;
    CF_FOR_SEGMENTS_OF (&s->segments->all, s, t, j, t->k, q) {
      const cf_sixteen_cells h = cf_cells_of(&g, q, 1);
      cf_sixteen applied, diagonal;
      cf_sixteen_applied(dim, &h, &applied);
      cf_sixteen_diagonal(dim, &h, &diagonal);
      const cf_sixteen r = CF_SIXTEEN_OF(h.r), old = CF_SIXTEEN_OF(h.e), residual = r - applied;
      const cf_sixteen fresh = old + omega * CF_SIXTEEN_OF(h.table->inverse + h.lane) * residual;
      const cf_sixteen rest = residual - diagonal * (fresh - old);
      const cf_sixteen taken = step == 1 ? rest : r + step * (rest - r);
      products += r * taken;
      CF_INTO_SIXTEEN(h.r, taken);
      CF_INTO_SIXTEEN(h.e, fresh);
    }
    cf_segment_sums(p, t, j)[CF_SUM_BLACK * p->sums] = cf_sum_sixteen(&products);
  }
}

/* Eight cells of x += gain e. */
CF_KERNEL void add_eight(const double gain, const float *even, const float *odd, cf_real *x) {
  const cf_four_floats a = *(const cf_four_floats *)even, b = *(const cf_four_floats *)odd;
  const cf_eight_in_floats e = __builtin_shufflevector(a, b, 0, 4, 1, 5, 2, 6, 3, 7);
  CF_EIGHT_INTO(x, CF_EIGHT_OF(x) + gain * __builtin_convertvector(e, cf_eight));
}

/* x += gain e on the cells of a segment from the first inside to the last, in whole eights but at the end of a row: tiles have
 * no less, and e is 0 where no cell is inside. x: at its first cell, e and odd: at its halves. count: cells that the row has
 * from there on. */
CF_KERNEL void add(const double gain, const cf_segment_table *t, const int count, const float *e,
                   const float *odd, cf_real *x) {
  if (t->low < CF_SUM_LANES && t->high > CF_SEGMENT_CELLS - CF_SUM_LANES && count >= CF_SEGMENT_CELLS) {
    cf_add_woven(CF_SEGMENT_CELLS, gain, 0, e, odd, x);
    return;
  }
  int i = t->low / CF_SUM_LANES * CF_SUM_LANES;
  for (; i < t->high && i + CF_SUM_LANES <= count; i += CF_SUM_LANES)
    add_eight(gain, e + i / 2, odd + i / 2, x + i);
  for (; i < t->high; ++i) x[i] = (cf_real)((double)x[i] + gain * (double)(i % 2 == 0 ? e : odd)[i / 2]);
}

/* x += by where a cell of a segment is inside, and the sums of what comes of it, in lanes. */
CF_KERNEL void lift(const cf_segment_table *t, const double by, const int count, cf_real *x, cf_eight *sum,
                    cf_eight *squares) {
  unsigned char faces[CF_SEGMENT_CELLS];
  cf_weave(t->faces, faces);
  int i = t->low / CF_SUM_LANES * CF_SUM_LANES;
  for (; i < t->high && i + CF_SUM_LANES <= count; i += CF_SUM_LANES) {
    const cf_eight_bits open = CF_EIGHT_OF_BYTES(faces + i);
    const cf_eight all = CF_EIGHT_OF(x + i),
                   lifted = all + CF_EIGHT_WHERE(open, CF_FACES_INSIDE, (cf_eight){0} + by);
    CF_EIGHT_INTO(x + i, lifted);
    const cf_eight kept = CF_EIGHT_OF(x + i), v = CF_EIGHT_WHERE(open, CF_FACES_INSIDE, kept + 0);
    *sum += v;
    *squares += v * v;
  }
  for (; i < t->high; ++i) {
    if (!(faces[i] & CF_FACES_INSIDE)) continue;
    x[i] = (cf_real)((double)x[i] + by);
    (*sum)[i % CF_SUM_LANES] += (double)x[i];
    (*squares)[i % CF_SUM_LANES] += (double)x[i] * (double)x[i];
  }
}

/* A row of x and its e. */
CF_KERNEL void update_x(const cf_pass *p, const cf_strip *t, const int j, cf_eight *sum, cf_eight *squares) {
  const cf_split *s = p->at;
  const ptrdiff_t row = j * s->row + t->k * s->plane;
  const double gain = p->gain;
  cf_real *x = p->x + cf_box_at(&s->plain->box, 0, j, t->k);
  const bool lifts = p->sums_of_x || p->lift != 0;
  cf_ahead ahead = cf_ahead_of(s, t, j);
  CF_FOR_SEGMENTS_OF (&s->segments->all, s, t, j, t->k, q) {
    const cf_segment_table *table = &s->segments->table[q->table];
    const float *e = s->e + cf_segment_at(q);
    const ptrdiff_t i = 2 * (cf_segment_at(q) - row);
    cf_fetch_cells(&ahead, p->x);
    ++ahead.at;
    add(gain, table, s->n[0] - (int)i, e, e + s->odd, x + i);
    if (lifts) lift(table, p->lift, s->n[0] - (int)i, x + i, sum, squares);
  }
  for (; ahead.at < ahead.end; ++ahead.at) cf_fetch_cells(&ahead, p->x);
}

/* r -= step A' e on red cells, and the first half sweep of the next cycle; *squares: of r, of both colours. */
CF_KERNEL void restart(const int dim, const cf_pass *p, const cf_strip *t, const int j, const float omega,
                       double *squares, double *products) {
  const cf_split *s = p->at;
  const cf_ground g = cf_ground_of(dim, s);
  const float step = (float)p->step;
  cf_sixteen all = {0}, change = {0};
  CF_FOR_SEGMENTS_OF (&s->segments->all, s, t, j, t->k, q) {
    const cf_sixteen_cells h = cf_cells_of(&g, q, 0), black = cf_cells_of(&g, q, 1);
    cf_sixteen applied;
    cf_sixteen_applied(dim, &h, &applied);
    const cf_sixteen before = CF_SIXTEEN_OF(h.r), r = before - step * applied, other = CF_SIXTEEN_OF(black.r);
    change += before * r;
    all += r * r + other * other;
    CF_INTO_SIXTEEN(h.r, r);
    CF_INTO_SIXTEEN(h.e, omega * CF_SIXTEEN_OF(h.table->inverse + h.lane) * r);
  }
  *squares = cf_sum_sixteen(&all);
  *products = cf_sum_sixteen(&change);
}

CF_KERNEL void update(const int dim, const cf_pass *p, const cf_strip *t, const float omega) {
  CF_FOR_ROWS(j, t) {
    cf_eight x = {0}, xx = {0};
    if (!cf_has_segments(p->at, t, j)) continue;
    double *sums = cf_segment_sums(p, t, j);
    update_x(p, t, j, &x, &xx);
    restart(dim, p, t, j, omega, &sums[CF_SUM_RESIDUAL * p->sums], &sums[CF_SUM_RED * p->sums]);
    if (!p->sums_of_x) continue;
    sums[CF_SUM_X * p->sums] = cf_sum_eight(&x);
    sums[CF_SUM_X2 * p->sums] = cf_sum_eight(&xx);
  }
}

/* --- to the coarse level ------------------------------------------------------------------------------ */

/* What a fine row leaves to its coarse cells: of its red ones, since the black half sweep before, with omega = 1, has left nothing
 * on the others. */
CF_KERNEL void gather(const int dim, const cf_pass *p, const cf_strip *t, const int j, const int k,
                      float *coarse) {
  const cf_split *s = p->at;
  const cf_ground g = cf_ground_of(dim, s);
  const ptrdiff_t row = j * s->row + k * s->plane;
  CF_FOR_SEGMENTS_OF (&s->segments->all, s, t, j, k, q) {
    const cf_sixteen_cells red = cf_cells_of(&g, q, 0);
    const int m = (int)(cf_segment_at(q) - row);
    cf_sixteen around, diagonal;
    cf_sixteen_around(dim, &red, &around);
    cf_sixteen_diagonal(dim, &red, &diagonal);
    cf_sixteen rest = (CF_SIXTEEN_OF(red.r) - diagonal * CF_SIXTEEN_OF(red.e)) + red.coupling * around;
    if (!red.inner) cf_sixteen_transferred(red.table, red.lane, &rest);
    cf_add_sixteen(p->below->box.n[0] - m, (q->place & CF_PLACE_FIRST) != 0, &rest, coarse + m);
  }
}

/* Coarse rows whose last child is a row of the strip. */
CF_KERNEL void restrict_rows(const int dim, const cf_pass *p, const cf_strip *t) {
  const int *n = p->at->n;
  if (dim == 3 && t->k % 2 == 0 && t->k + 1 < n[2]) return;
  CF_FOR_ROWS(j, t) {
    if (j % 2 == 0 && j + 1 < n[1]) continue;
    float *coarse = p->below->r + cf_box_at(&p->below->box, 0, j / 2, dim == 3 ? t->k / 2 : 0);
    for (int k = dim == 3 ? t->k - t->k % 2 : 0; k <= t->k; ++k)
      for (int jj = j - j % 2; jj <= j; ++jj) gather(dim, p, t, jj, k, coarse);
  }
}

/* --- from the coarse level ---------------------------------------------------------------------------- */

/* The neighbour of coarse row `place` along an axis, seen from fine row j: as a step, 0 beyond a wall. */
CF_KERNEL ptrdiff_t step_to(const cf_split *s, const cf_box *c, const int a, const int j) {
  const int step = j % 2 == 0 ? -1 : 1, to = j / 2 + step;
  if ((to < 0 || to >= c->n[a]) && !s->plain->axis[a].periodic) return 0;
  return step * c->stride[a];
}

CF_KERNEL cf_mixture mixture_of(const int dim, const cf_pass *p, const int j, const int k) {
  const cf_box *c = &p->below->box;
  const float *own = p->below->e + cf_box_at(c, 0, j / 2, dim == 3 ? k / 2 : 0);
  const ptrdiff_t y = step_to(p->at, c, 1, j), z = dim == 3 ? step_to(p->at, c, 2, k) : 0;
  return (cf_mixture){own, own + y, own + z, own + y + z, y != 0 ? 0.25f : 0, z != 0 ? 0.25f : 0};
}

/* The coarse row that the successor of row j is the first to ask for; NULL: none. */
CF_KERNEL const float *coarse_ahead(const int dim, const cf_pass *p, const cf_strip *t, const int j) {
  const cf_box *c = &p->below->box;
  const int place = (t->next_k + 1) / 2;
  if (dim == 2 || t->next_k < 0 || place >= c->n[2]) return NULL;
  return p->below->e + cf_box_at(c, 0, (t->next_j + j - t->j) / 2, place);
}

CF_KERNEL void prolong_row(const int dim, const cf_pass *p, const cf_strip *t, const int j) {
  const cf_split *s = p->at;
  const cf_mixture x = mixture_of(dim, p, j, t->k);
  const ptrdiff_t row = j * s->row + t->k * s->plane, odd = s->odd;
  cf_ahead ahead = cf_ahead_of(s, t, j);
  const float *coarse = coarse_ahead(dim, p, t, j);
  float *e = s->e;
  CF_FOR_SEGMENTS_OF (&s->segments->all, s, t, j, t->k, q) {
    const cf_segment_table *table = &s->segments->table[q->table];
    const ptrdiff_t at = cf_segment_at(q);
    if (coarse != NULL && ahead.at < ahead.end)
      __builtin_prefetch(coarse + (cf_segment_at(ahead.at) - ahead.row));
    cf_fetch_segment(s, &ahead);
    ++ahead.at;
    cf_sixteen taken[2];
    if (q->table < CF_REGULAR_TABLES)
      cf_sixteen_linear(dim, &x, at - row, table, taken);
    else
      cf_sixteen_spread(dim, &x, at - row, table, taken);
    for (int half = 0; half < 2; ++half) {
      float *to = e + at + half * odd;
      cf_sixteen_transferred(table, half * CF_SEGMENT, &taken[half]);
      CF_INTO_SIXTEEN(to, CF_SIXTEEN_OF(to) + taken[half]);
    }
  }
  for (; ahead.at < ahead.end; ++ahead.at) cf_fetch_segment(s, &ahead);
}

CF_KERNEL void prolong_rows(const int dim, const cf_pass *p, const cf_strip *t) {
  CF_FOR_ROWS(j, t) prolong_row(dim, p, t, j);
}

/* --- which one ---------------------------------------------------------------------------------------- */

#define BOTH(name, parameters, ...)                                    \
  CF_CLONES static void name##_2d parameters { name(2, __VA_ARGS__); } \
  CF_CLONES static void name##_3d parameters { name(3, __VA_ARGS__); }
BOTH(last, (const cf_pass *p, const cf_strip *t, const float omega), p, t, omega)
BOTH(update, (const cf_pass *p, const cf_strip *t, const float omega), p, t, omega)
BOTH(restrict_rows, (const cf_pass *p, const cf_strip *t), p, t)
BOTH(prolong_rows, (const cf_pass *p, const cf_strip *t), p, t)

#define RELAX(name, dim, way)                                                                \
  CF_CLONES static void name(const cf_split *s, const cf_segment_list *l, const cf_strip *t, \
                             const int colour, const float omega) {                          \
    relax(dim, way, s, l, t, colour, omega);                                                 \
  }
RELAX(again_2d, 2, AGAIN)
RELAX(again_3d, 3, AGAIN)
RELAX(fresh_2d, 2, FRESH)
RELAX(fresh_3d, 3, FRESH)
RELAX(first_2d, 2, FIRST)
RELAX(first_3d, 3, FIRST)

void cf_stage_on_segments(const cf_pass *p, const int number, const cf_strip *t, const float omega) {
  const cf_split *s = p->at;
  const cf_segment_list *all = &s->segments->all, *edges = &s->segments->edges;
  const bool deep = s->dim == 3;
  switch (p->stage[number]) {
    case CF_PASS_FORM:
      cf_stage_form_on_segments(p, t);
      (deep ? first_3d : first_2d)(s, all, t, 0, omega);
      break;
    case CF_PASS_FIRST:
      (deep ? first_3d : first_2d)(s, all, t, 0, omega);
      break;
    case CF_PASS_SECOND:
      (deep ? fresh_3d : fresh_2d)(s, all, t, 1, omega);
      break;
    case CF_PASS_RED:
      (deep ? again_3d : again_2d)(s, all, t, 0, omega);
      break;
    case CF_PASS_BLACK:
      (deep ? again_3d : again_2d)(s, all, t, 1, omega);
      break;
    case CF_PASS_RED_EDGES:
      (deep ? again_3d : again_2d)(s, edges, t, 0, omega);
      break;
    case CF_PASS_BLACK_EDGES:
      (deep ? again_3d : again_2d)(s, edges, t, 1, omega);
      break;
    case CF_PASS_LAST:
      (deep ? last_3d : last_2d)(p, t, omega);
      break;
    case CF_PASS_UPDATE:
      (deep ? update_3d : update_2d)(p, t, omega);
      break;
    case CF_PASS_RESTRICT_RED:
      (deep ? restrict_rows_3d : restrict_rows_2d)(p, t);
      break;
    case CF_PASS_PROLONG:
      (deep ? prolong_rows_3d : prolong_rows_2d)(p, t);
      break;
    default: /* RESTRICT, CLEAR and RESIDUAL are for cycles and seams that segments do not have */
      break;
  }
}
