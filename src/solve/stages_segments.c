/* SPDX-License-Identifier: MIT
 *
 * The stages on a level that has segments (segments.h): each for all segments of its rows that lie within the strip. The
 * next coarser level is one of couplings (coupled.h), whose transfers these are: the residual summed over the children of
 * a coarse cell, and
 *
 *     e += e_c + sum over axes of w_a (e_{c+a} - e_c)
 *
 * with w_a from a table on edge segments; on plain ones, around which all coarse cells are inside, it is linear along each axis in
 * turn, (3 e_c + e_{c+a})/4, as in the whole box: smooth corrections leave a twentieth of what the sum above leaves there.
 */
#include <stdint.h>
#include <string.h>

#include "solve/coupled.h"
#include "solve/stages_edge.h"
#include "solve/stages_pieces.h"

CF_KERNEL cf_half half_of(const int dim, const cf_split *s, const cf_piece *q, const int colour) {
  cf_half h = cf_half_of(dim, s, q->strip.j, q->strip.k, colour);
  if (q->edge) {
    const ptrdiff_t entry = cf_segment_entry(q->segment, h.parity, 0);
    h.inverse = s->segments->inverse + entry;
    h.faces = s->segments->faces + entry;
    h.held = s->segments->held + entry;
  }
  return h;
}

/* Images are for plain segments: on the others a face knows whether it is one. */
CF_KERNEL void set_images(const cf_split *s, const cf_piece *q, const cf_half *h, const float factor) {
  if (!q->edge) cf_half_set_images(s, &q->strip, h, factor);
}

/* --- half sweeps -------------------------------------------------------------------------------------- */

CF_KERNEL void first(const int dim, const cf_split *s, const cf_strip *t, const float omega) {
  cf_piece q;
  CF_FOR_ROWS(j, t)
  CF_FOR_PIECES(s, t, j, q) {
    const cf_half red = half_of(dim, s, &q, 0);
    cf_first_half(s, &red, &q.strip, omega);
  }
}

/* FRESH: the half counts as 0, and so do the images of the other half's cells behind the walls. EDGES: on edge segments alone. */
enum { ALL, FRESH, EDGES };

CF_KERNEL void relax(const int dim, const int way, const cf_split *s, const cf_strip *t, const int colour,
                     const float omega) {
  const float keep = 1 - omega;
  cf_piece q;
  CF_FOR_ROWS(j, t)
  CF_FOR_PIECES(s, t, j, q) {
    if (way == EDGES && !q.edge) continue;
    const cf_half h = half_of(dim, s, &q, colour);
    if (way == FRESH) {
      const cf_half other = half_of(dim, s, &q, 1 - colour);
      set_images(s, &q, &other, 0);
    }
    CF_FOR_PIECE(m, &q.strip) {
      const float e = omega * h.inverse[m] * (h.r[m] + cf_around(dim, 1, &h, m));
      h.e[m] = way == FRESH ? e : keep * h.e[m] + e;
    }
  }
}

/* --- residual and solution ---------------------------------------------------------------------------- */

CF_KERNEL void last(const int dim, const cf_pass *p, const cf_strip *t, const float omega) {
  const cf_split *s = p->at;
  const float step = (float)p->step;
  float *before = t->scratch;
  cf_piece q;
  CF_FOR_ROWS(j, t) {
    double products = 0;
    int any = 0;
    CF_FOR_PIECES(s, t, j, q) {
      const cf_half red = half_of(dim, s, &q, 0), black = half_of(dim, s, &q, 1);
      const int from = q.strip.from, n = q.strip.to - from;
      any = 1;
      if (q.edge) {
        products += cf_last_edge(dim, &black, &q.strip, omega, step);
        cf_clear_pad(s, &q.strip, &black);
        continue;
      }
      memcpy(before, black.r + from, (size_t)n * sizeof *before);
      cf_half_set_images(s, &q.strip, &black, 1);
      if (cf_half_is_inner(dim, &black))
        cf_last_half(dim, 1, &black, &q.strip, omega, step);
      else
        cf_last_half(dim, 0, &black, &q.strip, omega, step);
      cf_clear_pad(s, &q.strip, &black);
      cf_half_set_images(s, &q.strip, &red, 1);
      products += cf_products(n, before, black.r + from);
    }
    if (any) cf_piece_sums(p, t, j)[CF_SUM_BLACK * p->sums] = products;
  }
}

/* x += gain e on the cells of the piece from its first to its last inside. */
CF_KERNEL void add(const cf_pass *p, const cf_piece *q, const float *even, const float *odd, float *line) {
  const int from = 2 * q->strip.from, low = CF_MAX(from, q->segment->low);
  const int high = CF_MIN(2 * q->strip.to, q->segment->high);
  const double gain = p->gain;
  cf_real *x = p->x + cf_box_at(&p->at->plain->box, low, q->strip.j, q->strip.k);
  if (low == from && high - low == cf_natural_count(p->at, &q->strip)) {
    cf_add_woven(high - low, gain, 0, even, odd, x);
    return;
  }
  CF_ROW_LOOP
  for (int m = 0; m < q->strip.to - q->strip.from; ++m) {
    line[2 * m] = even[m];
    line[2 * m + 1] = odd[m];
  }
  CF_ROW_LOOP
  for (int i = 0; i < high - low; ++i) x[i] = (cf_real)((double)x[i] + gain * (double)line[low - from + i]);
}

/* x += lift where a cell is inside, and the sums of what comes of it. */
CF_KERNEL void lift(const cf_pass *p, const cf_piece *q, const ptrdiff_t room, double *line, double *sum,
                    double *squares) {
  const unsigned char *faces = cf_piece_faces(p->at->segments, q, (unsigned char *)(line + room));
  const int n = cf_natural_count(p->at, &q->strip);
  const double by = p->lift;
  cf_real *x = p->x + cf_box_at(&p->at->plain->box, 2 * q->strip.from, q->strip.j, q->strip.k);
  if (by != 0) {
    CF_ROW_LOOP
    for (int i = 0; i < n; ++i)
      x[i] = faces == NULL || faces[i] & CF_FACES_INSIDE ? (cf_real)((double)x[i] + by) : x[i];
  }
  if (p->sums_of_x) cf_add_inside(n, x, faces, sum, squares);
}

CF_KERNEL void update(const int dim, const cf_pass *p, const cf_strip *t, const float omega) {
  const cf_split *s = p->at;
  const float step = (float)p->step;
  float *before = t->scratch;
  cf_piece q;
  CF_FOR_ROWS(j, t) {
    double squares = 0, products = 0, x = 0, xx = 0;
    int any = 0;
    CF_FOR_PIECES(s, t, j, q) {
      const cf_half red = half_of(dim, s, &q, 0), black = half_of(dim, s, &q, 1);
      const ptrdiff_t at = j * s->row + t->k * s->plane + q.strip.from;
      if (t->next_k >= 0) cf_fetch_x(p, &q.strip, j);
      add(p, &q, s->e + at, s->e + at + s->odd, t->scratch);
      if (p->sums_of_x || p->lift != 0) lift(p, &q, 2 * s->width + CF_SPLIT_LANES, t->scratch, &x, &xx);
      const int from = q.strip.from, n = q.strip.to - from;
      if (q.edge) {
        products += cf_restart_edge(dim, &red, &q.strip, omega, step);
      } else {
        memcpy(before, red.r + from, (size_t)n * sizeof *before);
        cf_half_set_images(s, &q.strip, &black, 0);
        if (cf_half_is_inner(dim, &red))
          cf_restart_half(dim, 1, &red, &q.strip, omega, step);
        else
          cf_restart_half(dim, 0, &red, &q.strip, omega, step);
        products += cf_products(n, before, red.r + from);
      }
      cf_clear_pad(s, &q.strip, &red);
      squares += cf_squares(n, s->r + at, s->r + at + s->odd);
      any = 1;
    }
    if (!any) continue;
    double *sums = cf_piece_sums(p, t, j);
    sums[CF_SUM_RESIDUAL * p->sums] = squares;
    sums[CF_SUM_RED * p->sums] = products;
    if (!p->sums_of_x) continue;
    sums[CF_SUM_X * p->sums] = x;
    sums[CF_SUM_X2 * p->sums] = xx;
  }
}

/* --- to the coarse level ------------------------------------------------------------------------------ */

/* What a piece of a fine row leaves to its coarse cells: of its red ones, since the black half sweep before, with omega = 1, has
 * left nothing on the others. */
CF_KERNEL void gather(const int dim, const int edge, const cf_split *s, const cf_piece *q, float *coarse) {
  const cf_half red = half_of(dim, s, q, 0);
  const int end = CF_MIN(q->strip.to, s->half[red.parity]);
  if (edge) {
    cf_gather_edge(dim, &red, q->strip.from, end, coarse);
    return;
  }
  CF_ROW_LOOP
  for (int m = q->strip.from; m < end; ++m)
    coarse[m] += (red.r[m] - red.diagonal[m] * red.e[m]) + cf_around(dim, 1, &red, m);
}

/* The coarse row whose last child is row j of plane t->k. */
CF_KERNEL void restrict_row(const int dim, const cf_pass *p, const cf_strip *t, const int j) {
  const cf_split *s = p->at;
  const cf_box *c = &p->below->box;
  float *coarse = p->below->r + cf_box_at(c, 0, j / 2, dim == 3 ? t->k / 2 : 0);
  cf_piece q;
  for (int gathering = 0; gathering < 2; ++gathering)
    for (int k = t->k - (dim == 3 ? t->k % 2 : 0); k <= t->k; ++k)
      for (int jj = j - j % 2; jj <= j; ++jj) {
        cf_strip there = *t;
        there.k = k;
        CF_FOR_PIECES(s, &there, jj, q) {
          if (gathering && q.edge)
            gather(dim, 1, s, &q, coarse);
          else if (gathering)
            gather(dim, 0, s, &q, coarse);
          else
            memset(coarse + q.strip.from, 0,
                   (size_t)(CF_MIN(q.strip.to, c->n[0]) - q.strip.from) * sizeof(float));
        }
      }
}

CF_KERNEL void restrict_rows(const int dim, const cf_pass *p, const cf_strip *t) {
  const int *n = p->at->n;
  if (dim == 3 && t->k % 2 == 0 && t->k + 1 < n[2]) return;
  CF_FOR_ROWS(j, t)
  if (j % 2 == 1 || j + 1 == n[1]) restrict_row(dim, p, t, j);
}

/* --- from the coarse level ---------------------------------------------------------------------------- */

/* A coarse row and its neighbours along y, z and both on the side of the fine row; how much of those along an axis. */
typedef struct mixture {
  const float *own, *y, *z, *yz;
  float of_y, of_z;
} mixture;

/* The neighbour of coarse row `place` along an axis, seen from fine row j: as a step, 0 beyond a wall. */
CF_KERNEL ptrdiff_t step_to(const cf_split *s, const cf_box *c, const int a, const int j) {
  const int step = j % 2 == 0 ? -1 : 1, to = j / 2 + step;
  if ((to < 0 || to >= c->n[a]) && !s->plain->axis[a].periodic) return 0;
  return step * c->stride[a];
}

CF_KERNEL mixture mixture_of(const int dim, const cf_pass *p, const int j, const int k) {
  const cf_box *c = &p->below->box;
  const float *own = p->below->e + cf_box_at(c, 0, j / 2, dim == 3 ? k / 2 : 0);
  const ptrdiff_t y = step_to(p->at, c, 1, j), z = dim == 3 ? step_to(p->at, c, 2, k) : 0;
  return (mixture){own, own + y, own + z, own + y + z, y != 0 ? 0.25f : 0, z != 0 ? 0.25f : 0};
}

/* Mixed along y and z: coarse cells [from, end). */
CF_KERNEL void mix(const int dim, const mixture *of, const int from, const int end, float *line) {
  const mixture x = *of;
  const float y = x.of_y, z = x.of_z, own = (1 - y) * (1 - z), other = (1 - y) * z;
  CF_ROW_LOOP
  for (int m = from; m < end; ++m) {
    const float below = own * x.own[m] + y * (1 - z) * x.y[m];
    line[m] = dim == 3 ? below + (other * x.z[m] + y * z * x.yz[m]) : below;
  }
}

/* e of even (side -1) or odd cells (1) from `from` to `end`; at a wall there is no neighbour to mix with along x. */
CF_KERNEL void spread(const cf_split *s, const float *line, const int side, int from, int end, float *e) {
  const int last = s->half[0] - 1, wall = side < 0 ? 0 : last, periodic = s->plain->axis[0].periodic;
  end = CF_MIN(end, s->half[side > 0]);
  if (!periodic && wall >= from && wall < end) {
    e[wall] += line[wall];
    if (side < 0)
      ++from;
    else
      --end;
  }
  CF_ROW_LOOP
  for (int m = from; m < end; ++m) e[m] += 0.75f * line[m] + 0.25f * line[m + side];
}

CF_KERNEL void spread_edge(const int dim, const cf_segments *g, const cf_piece *q, const mixture *x,
                           const int parity, const int end, float *e) {
  const ptrdiff_t entry = cf_segment_entry(q->segment, parity, 0);
  const cf_spread_from from = {x->own,
                               x->y,
                               x->z,
                               g->faces + entry,
                               {g->weight[0] + entry, g->weight[1] + entry, g->weight[2] + entry}};
  cf_spread_edge(dim, &from, parity ? 1 : -1, q->strip.from, end, e);
}

CF_KERNEL void fetch(const void *from, const ptrdiff_t bytes) {
  for (ptrdiff_t v = 0; v < bytes; v += CF_ALIGN) __builtin_prefetch((const char *)from + v);
}

/* Asks for the tables of the row that the strip's successor has for row j: they are read once a pass. */
CF_KERNEL void fetch_tables(const int dim, const cf_split *s, const cf_strip *t, const int j) {
  const cf_segments *g = s->segments;
  const ptrdiff_t row = cf_segments_row(s, t->next_j + j - t->j, t->next_k);
  for (ptrdiff_t v = g->first[row]; v < g->first[row + 1]; ++v) {
    const cf_segment *q = &g->segment[v];
    const ptrdiff_t n = 2 * (q->to - q->from), at = q->table;
    if (at < 0) continue;
    fetch(g->inverse + at, n * (ptrdiff_t)sizeof(float));
    fetch(g->faces + at, n);
    fetch(g->held + at, n);
    for (int a = 0; a < dim; ++a) fetch(g->weight[a] + at, n);
  }
}

CF_KERNEL void prolong_rows(const int dim, const cf_pass *p, const cf_strip *t) {
  const cf_split *s = p->at;
  float *line = t->scratch;
  cf_piece q;
  CF_FOR_ROWS(j, t) {
    const mixture x = mixture_of(dim, p, j, t->k);
    if (t->next_k >= 0) fetch_tables(dim, s, t, j);
    CF_FOR_PIECES(s, t, j, q) {
      if (t->next_k >= 0) {
        cf_fetch_halves(s, &q.strip, s->e + cf_next_row(s, t, j));
        cf_fetch_halves(s, &q.strip, s->r + cf_next_row(s, t, j));
      }
      float *e = s->e + j * s->row + t->k * s->plane;
      const int from = q.strip.from, end = CF_MIN(q.strip.to, p->below->box.n[0]);
      if (!q.edge) mix(dim, &x, from - 1, end + 1, line - (from - 1));
      for (int parity = 0; parity < 2; ++parity) {
        if (q.edge)
          spread_edge(dim, s->segments, &q, &x, parity, CF_MIN(q.strip.to, s->half[parity]),
                      e + parity * s->odd);
        else
          spread(s, line - (from - 1), parity ? 1 : -1, from, end, e + parity * s->odd);
      }
    }
  }
}

/* --- which one ---------------------------------------------------------------------------------------- */

#define BOTH(name, parameters, ...)                                    \
  CF_CLONES static void name##_2d parameters { name(2, __VA_ARGS__); } \
  CF_CLONES static void name##_3d parameters { name(3, __VA_ARGS__); }
BOTH(first, (const cf_split *s, const cf_strip *t, const float omega), s, t, omega)
BOTH(last, (const cf_pass *p, const cf_strip *t, const float omega), p, t, omega)
BOTH(update, (const cf_pass *p, const cf_strip *t, const float omega), p, t, omega)
BOTH(restrict_rows, (const cf_pass *p, const cf_strip *t), p, t)
BOTH(prolong_rows, (const cf_pass *p, const cf_strip *t), p, t)

#define RELAX(name, dim, way)                                                                             \
  CF_CLONES static void name(const cf_split *s, const cf_strip *t, const int colour, const float omega) { \
    relax(dim, way, s, t, colour, omega);                                                                 \
  }
RELAX(relax_2d, 2, ALL)
RELAX(relax_3d, 3, ALL)
RELAX(second_2d, 2, FRESH)
RELAX(second_3d, 3, FRESH)
RELAX(edges_2d, 2, EDGES)
RELAX(edges_3d, 3, EDGES)

void cf_stage_on_segments(const cf_pass *p, const int number, const cf_strip *t, const float omega) {
  const cf_split *s = p->at;
  const bool deep = s->dim == 3;
  switch (p->stage[number]) {
    case CF_PASS_FORM:
      cf_stage_form_on_segments(p, t);
      (deep ? first_3d : first_2d)(s, t, omega);
      break;
    case CF_PASS_FIRST:
      (deep ? first_3d : first_2d)(s, t, omega);
      break;
    case CF_PASS_SECOND:
      (deep ? second_3d : second_2d)(s, t, 1, omega);
      break;
    case CF_PASS_RED:
      (deep ? relax_3d : relax_2d)(s, t, 0, omega);
      break;
    case CF_PASS_BLACK:
      (deep ? relax_3d : relax_2d)(s, t, 1, omega);
      break;
    case CF_PASS_RED_EDGES:
      (deep ? edges_3d : edges_2d)(s, t, 0, omega);
      break;
    case CF_PASS_BLACK_EDGES:
      (deep ? edges_3d : edges_2d)(s, t, 1, omega);
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
