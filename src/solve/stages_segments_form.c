/* SPDX-License-Identifier: MIT
 *
 * FORM on segments: r = (b - A x) / scale in double, face by face on edge segments, eight cells at a time.
 */
#include "solve/stages_pieces.h"

CF_KERNEL void form_eight_at_edge(const int dim, const cf_forming *f, const double coupling, const int i,
                                  const unsigned char *faces, const unsigned char *held) {
  const cf_real *x = f->x + i;
  const cf_eight_bits open = CF_EIGHT_OF_BYTES(faces + i);
  const cf_eight c = CF_EIGHT_OF(x),
                 known = __builtin_convertvector(CF_EIGHT_OF_BYTES(held + i) & CF_HELD_MASK, cf_eight);
  cf_eight sum =
      CF_EIGHT_WHERE(open, 1, c - CF_EIGHT_OF(x - 1)) - CF_EIGHT_WHERE(open, 2, CF_EIGHT_OF(x + 1) - c);
  sum +=
      CF_EIGHT_WHERE(open, 4, c - CF_EIGHT_OF(x - f->y)) - CF_EIGHT_WHERE(open, 8, CF_EIGHT_OF(x + f->y) - c);
  if (dim == 3)
    sum += CF_EIGHT_WHERE(open, 16, c - CF_EIGHT_OF(x - f->z)) -
           CF_EIGHT_WHERE(open, 32, CF_EIGHT_OF(x + f->z) - c);
  const cf_eight Ax = f->alpha * c + coupling * (sum + known * c);
  *(cf_eight_doubles *)(f->residual + i) = CF_EIGHT_WHERE(open, CF_FACES_INSIDE, CF_EIGHT_OF(f->b + i) - Ax);
}

CF_KERNEL double form_one_at_edge(const int dim, const cf_forming *f, const double coupling, const int i,
                                  const int open, const int held) {
  const cf_real *x = f->x + i;
  const double c = (double)x[0];
  double sum = (open & 1 ? c - (double)x[-1] : 0) - (open & 2 ? (double)x[1] - c : 0);
  sum += (open & 4 ? c - (double)x[-f->y] : 0) - (open & 8 ? (double)x[f->y] - c : 0);
  if (dim == 3) sum += (open & 16 ? c - (double)x[-f->z] : 0) - (open & 32 ? (double)x[f->z] - c : 0);
  return open & CF_FACES_INSIDE
             ? (double)f->b[i] - (f->alpha * c + coupling * (sum + (double)(held & CF_HELD_MASK) * c))
             : 0;
}

CF_KERNEL void form_edge(const int dim, const int n, const cf_forming *f, const double coupling,
                         const unsigned char *faces, const unsigned char *held) {
  int i = 0;
  for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES) form_eight_at_edge(dim, f, coupling, i, faces, held);
  for (; i < n; ++i) f->residual[i] = form_one_at_edge(dim, f, coupling, i, faces[i], held[i]);
}

CF_KERNEL void form(const int dim, const cf_pass *p, const cf_strip *t) {
  const cf_split *s = p->at;
  const cf_segments *g = s->segments;
  const double coupling = p->beta * s->plain->axis[0].lo1[1];
  const ptrdiff_t room = 2 * s->width + CF_SPLIT_LANES;
  double *residual = t->scratch, *line = residual + room;
  unsigned char *bytes = (unsigned char *)(line + room), *held = bytes + room;
  cf_piece q;
  CF_FOR_ROWS(j, t) {
    double rr = 0, b = 0, bb = 0, x = 0, xx = 0;
    int any = 0;
    CF_FOR_PIECES(s, t, j, q) {
      const int n = cf_natural_count(s, &q.strip), pairs = q.strip.to - q.strip.from;
      const ptrdiff_t to = j * s->row + t->k * s->plane + q.strip.from;
      const cf_forming f = cf_forming_of(dim, p, &q.strip, j);
      const unsigned char *open = cf_piece_faces(g, &q, bytes);
      if (q.edge) {
        cf_weave(pairs, g->held + cf_segment_entry(q.segment, 0, q.strip.from),
                 g->held + cf_segment_entry(q.segment, 1, q.strip.from), held);
        form_edge(dim, n, &f, coupling, open, held);
      } else {
        cf_form_row(dim, n, &f);
      }
      for (int i = n; i < 2 * pairs; ++i) residual[i] = 0;
      rr += cf_square_sum(2 * pairs, residual);
      cf_add_inside(n, f.b, open, &b, &bb);
      cf_add_inside(n, f.x, open, &x, &xx);
      cf_split_scaled(pairs, 1 / p->scale, residual, s->r + to, s->r + to + s->odd);
      any = 1;
    }
    if (!any) continue;
    double *sums = cf_piece_sums(p, t, j);
    sums[CF_SUM_RESIDUAL * p->sums] = rr;
    sums[CF_SUM_B * p->sums] = b;
    sums[CF_SUM_B2 * p->sums] = bb;
    sums[CF_SUM_X * p->sums] = x;
    sums[CF_SUM_X2 * p->sums] = xx;
  }
}

CF_CLONES static void form_2d(const cf_pass *p, const cf_strip *t) { form(2, p, t); }
CF_CLONES static void form_3d(const cf_pass *p, const cf_strip *t) { form(3, p, t); }

void cf_stage_form_on_segments(const cf_pass *p, const cf_strip *t) {
  (p->at->dim == 3 ? form_3d : form_2d)(p, t);
}
