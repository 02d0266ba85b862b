/* SPDX-License-Identifier: MIT */
#include "solve/stages.h"

#include <string.h>

#include "grid/sweep.h"

/* --- one half of a row --------------------------------------------------------------------------------- */

/* Its e and r; the other half from the low neighbour of the first cell on (the high neighbour of every cell is the
 * low one of the next); tables and couplings. Kernels are small functions of this, so that registers suffice. */
typedef struct half {
  float *e, *r;
  float *side;
  const float *lo, *hi, *inverse, *diagonal;
  ptrdiff_t y, z;
  float lo_y, hi_y, lo_z, hi_z, alpha, coupling;
  int parity;
} half;

static half half_of(const cf_split *s, const int j, const int k, const int colour) {
  const int parity = (j + k + colour) & 1, kind = cf_split_kind(s, j, k);
  const ptrdiff_t at = j * s->row + k * s->plane, off = parity ? s->odd : 0;
  float *row = s->e + at;
  return (half){.e = row + off,
                .r = s->r + at + off,
                .side = parity ? row : row + s->odd - 1,
                .lo = s->lo[0] + off,
                .hi = s->hi[0] + off,
                .inverse = s->inverse[kind] + off,
                .diagonal = s->diagonal[kind] + off,
                .y = s->row,
                .z = s->plane,
                .lo_y = s->lo[1][j],
                .hi_y = s->hi[1][j],
                .lo_z = s->dim == 3 ? s->lo[2][k] : 0,
                .hi_z = s->dim == 3 ? s->hi[2][k] : 0,
                .alpha = s->alpha,
                .coupling = s->coupling,
                .parity = parity};
}

/* A piece of a half has whole vectors, which the compiler cannot know. */
#define FOR_PIECE(m, from, to)                                                                   \
  const int end_ = (from) + (int)(((unsigned)(to) - (unsigned)(from)) & ~(CF_SPLIT_LANES - 1u)); \
  CF_ROW_LOOP                                                                                    \
  for (int m = (from); m < end_; ++m)

/* sum of couplings times neighbours. `even`: they are all the same, and what lies beyond a wall is 0. */
CF_KERNEL float around(const int dim, const int even, const half *h, const int m) {
  const float *e = h->e + m, *side = h->side + m;
  if (even) {
    const float plane = (side[0] + side[1]) + (e[-h->y] + e[h->y]);
    return h->coupling * (dim == 3 ? plane + (e[-h->z] + e[h->z]) : plane);
  }
  float sum = (h->lo[m] * side[0] + h->hi[m] * side[1]) + (h->lo_y * e[-h->y] + h->hi_y * e[h->y]);
  if (dim == 3) sum += h->lo_z * e[-h->z] + h->hi_z * e[h->z];
  return sum;
}

/* --- half sweeps --------------------------------------------------------------------------------------- */

CF_CLONES static void first_row(const half *of, const int from, const int to, const float omega) {
  const half h = *of;
  FOR_PIECE(m, from, to) h.e[m] = omega * h.inverse[m] * h.r[m];
}

/* fresh: the half's own old e counts as 0. */
CF_KERNEL void relax(const int dim, const int even, const int fresh, const half *of, const int from,
                     const int to, const float omega) {
  const half h = *of;
  const float keep = 1 - omega;
  FOR_PIECE(m, from, to) {
    const float e = omega * h.inverse[m] * (h.r[m] + around(dim, even, &h, m));
    h.e[m] = fresh ? e : keep * h.e[m] + e;
  }
}

typedef void row_kernel(const half *h, int from, int to, float omega);

#define RELAX(name, dim, even, fresh)                                                          \
  CF_CLONES static void name(const half *h, const int from, const int to, const float omega) { \
    relax(dim, even, fresh, h, from, to, omega);                                               \
  }
RELAX(relax_2d_uneven, 2, 0, 0)
RELAX(relax_2d_even, 2, 1, 0)
RELAX(relax_3d_uneven, 3, 0, 0)
RELAX(relax_3d_even, 3, 1, 0)
RELAX(second_2d_uneven, 2, 0, 1)
RELAX(second_2d_even, 2, 1, 1)
RELAX(second_3d_uneven, 3, 0, 1)
RELAX(second_3d_even, 3, 1, 1)

static row_kernel *const relax_by_form[2][2] = {{relax_2d_uneven, relax_2d_even},
                                                {relax_3d_uneven, relax_3d_even}};
static row_kernel *const second_by_form[2][2] = {{second_2d_uneven, second_2d_even},
                                                 {second_3d_uneven, second_3d_even}};

/* --- the residual, on the finest level ------------------------------------------------------------------ */

/* What an axis adds to A' e where its couplings differ: the smaller one times the second difference, and the rest. */
CF_KERNEL float skewed(const float lo, const float hi, const float below, const float here,
                       const float above) {
  const float least = lo < hi ? lo : hi;
  return least * ((here - below) - (above - here)) +
         ((lo - least) * (here - below) - (hi - least) * (above - here));
}

/* A' e from second differences, which are exact in single precision where e is smooth. In x there are images of
 * the cells at walls behind them; `inner`: no wall in the other axes. */
CF_KERNEL float applied(const int dim, const int inner, const half *h, const int m) {
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

static bool is_inner(const int dim, const half *h) {
  return h->lo_y == h->coupling && h->hi_y == h->coupling &&
         (dim == 2 || (h->lo_z == h->coupling && h->hi_z == h->coupling));
}

/* A half sweep that leaves the residual behind: what the change of e, as stored, leaves of it. */
CF_KERNEL void last(const int dim, const int inner, const half *of, const int from, const int to,
                    const float omega) {
  const half h = *of;
  FOR_PIECE(m, from, to) {
    const float residual = h.r[m] - applied(dim, inner, &h, m);
    const float old = h.e[m], fresh = old + omega * h.inverse[m] * residual;
    h.r[m] = residual - h.diagonal[m] * (fresh - old);
    h.e[m] = fresh;
  }
}

/* r -= A' e; with omega > 0 then a first half sweep on it. */
CF_KERNEL void residual(const int dim, const int inner, const int restart, const half *of, const int from,
                        const int to, const float omega) {
  const half h = *of;
  FOR_PIECE(m, from, to) {
    const float r = h.r[m] - applied(dim, inner, &h, m);
    h.r[m] = r;
    if (restart) h.e[m] = omega * h.inverse[m] * r;
  }
}

#define LAST(name, dim, inner)                                                                 \
  CF_CLONES static void name(const half *h, const int from, const int to, const float omega) { \
    last(dim, inner, h, from, to, omega);                                                      \
  }
#define RESIDUAL(name, dim, inner, restart)                                                    \
  CF_CLONES static void name(const half *h, const int from, const int to, const float omega) { \
    residual(dim, inner, restart, h, from, to, omega);                                         \
  }
LAST(last_2d_wall, 2, 0)
LAST(last_2d_inner, 2, 1)
LAST(last_3d_wall, 3, 0)
LAST(last_3d_inner, 3, 1)
RESIDUAL(residual_2d, 2, 0, 0)
RESIDUAL(residual_3d, 3, 0, 0)
RESIDUAL(restart_2d_wall, 2, 0, 1)
RESIDUAL(restart_2d_inner, 2, 1, 1)
RESIDUAL(restart_3d_wall, 3, 0, 1)
RESIDUAL(restart_3d_inner, 3, 1, 1)

static row_kernel *const last_by_form[2][2] = {{last_2d_wall, last_2d_inner}, {last_3d_wall, last_3d_inner}};
static row_kernel *const restart_by_form[2][2] = {{restart_2d_wall, restart_2d_inner},
                                                  {restart_3d_wall, restart_3d_inner}};

/* Images behind the walls in x of those cells of a half that meet them: factor times s->image times e. They are set
 * (1) a stage before a residual is taken on this half and cleared (0) where neighbours are summed again. */
static void set_images(const cf_split *s, const cf_strip *t, const int j, const int colour,
                       const float factor) {
  const half h = half_of(s, j, t->k, colour);
  if (s->image[0] != 0 && t->from == 0 && h.parity == 0) h.side[0] = factor * s->image[0] * h.e[0];
  if (s->image[1] != 0 && t->to == s->width && h.parity == ((s->n[0] - 1) & 1)) {
    const int last_one = s->half[h.parity] - 1;
    h.side[last_one + 1] = factor * s->image[1] * h.e[last_one];
  }
}

/* The first element of the padding has heard of the last cell. */
static void clear_pad(const cf_split *s, const cf_strip *t, const half *h) {
  if (t->to == s->width && s->half[h->parity] < s->width) h->r[s->half[h->parity]] = 0;
}

/* --- taking the correction ------------------------------------------------------------------------------ */

/* Cells of the strip in their natural order: from 2 from on, as many as there are. */
static int natural_count(const cf_split *s, const cf_strip *t) {
  return CF_MIN(2 * t->to, s->n[0]) - 2 * t->from;
}

CF_CLONES static void add_row(const int n, const double gain, const float *even, const float *odd,
                              cf_real *x) {
  CF_ROW_LOOP
  for (int m = 0; m < n / 2; ++m) {
    x[2 * m] = (cf_real)((double)x[2 * m] + gain * (double)even[m]);
    x[2 * m + 1] = (cf_real)((double)x[2 * m + 1] + gain * (double)odd[m]);
  }
  if (n % 2 == 1) x[n - 1] = (cf_real)((double)x[n - 1] + gain * (double)even[n / 2]);
}

/* The sum of squares along a piece of both halves: in single precision 16 lanes apart; beyond it in double. */
CF_CLONES static double squares(const int n, const float *even, const float *odd) {
  float lane[CF_SPLIT_LANES] = {0};
  for (int m = 0; m < n; m += CF_SPLIT_LANES)
    for (int l = 0; l < CF_SPLIT_LANES; ++l) lane[l] += even[m + l] * even[m + l] + odd[m + l] * odd[m + l];
  double wide[CF_SUM_LANES];
  for (int l = 0; l < CF_SUM_LANES; ++l) wide[l] = (double)lane[l] + (double)lane[l + CF_SUM_LANES];
  return cf_sum_lanes(wide);
}

static ptrdiff_t place_of_sum(const cf_strip *t, const int j) { return t->sum + (j - t->j) * t->sum_step; }

/* x += gain e; red: r -= A' e, then the first half sweep on it. */
static void update_row(const cf_pass *p, const cf_strip *t, const int j, const float omega) {
  const cf_split *s = p->at;
  const half red = half_of(s, j, t->k, 0);
  const ptrdiff_t at = j * s->row + t->k * s->plane + t->from;
  add_row(natural_count(s, t), p->gain, s->e + at, s->e + at + s->odd,
          p->x + cf_box_at(&s->plain->box, 2 * t->from, j, t->k));
  if (s->odd_seam) {
    first_row(&red, t->from, t->to, omega);
  } else {
    set_images(s, t, j, 1, 0);
    restart_by_form[s->dim - 2][is_inner(s->dim, &red)](&red, t->from, t->to, omega);
    clear_pad(s, t, &red);
  }
  p->rows[place_of_sum(t, j)] = squares(t->to - t->from, s->r + at, s->r + at + s->odd);
}

static void last_row(const cf_split *s, const cf_strip *t, const int j, const float omega) {
  const half black = half_of(s, j, t->k, 1);
  last_by_form[s->dim - 2][is_inner(s->dim, &black)](&black, t->from, t->to, omega);
  clear_pad(s, t, &black);
  set_images(s, t, j, 0, 1);
}

/* Where neighbours share a colour: for all cells, from e as it is. */
static void residual_row(const cf_split *s, const cf_strip *t, const int j) {
  for (int colour = 0; colour < 2; ++colour) {
    const half h = half_of(s, j, t->k, colour);
    set_images(s, t, j, colour, 1);
    (s->dim == 3 ? residual_3d : residual_2d)(&h, t->from, t->to, 0);
    set_images(s, t, j, colour, 0);
    clear_pad(s, t, &h);
  }
}

/* --- forming the residual of the solution ---------------------------------------------------------------- */

CF_CLONES static double square_sum(const int n, const cf_real *f) {
  double lane[CF_SUM_LANES] = {0};
  int i = 0;
  for (; i + CF_SUM_LANES <= n; i += CF_SUM_LANES)
    for (int l = 0; l < CF_SUM_LANES; ++l) lane[l] += (double)f[i + l] * (double)f[i + l];
  for (int l = 0; i < n; ++i, ++l) lane[l] += (double)f[i] * (double)f[i];
  return cf_sum_lanes(lane);
}

CF_CLONES static double square_sum_of_doubles(const int n, const double *f) {
  double lane[CF_SUM_LANES] = {0};
  for (int i = 0; i < n; i += CF_SUM_LANES)
    for (int l = 0; l < CF_SUM_LANES; ++l) lane[l] += f[i + l] * f[i + l];
  return cf_sum_lanes(lane);
}

typedef struct forming {
  const cf_real *x, *b;
  const double *lo, *hi; /* along x, without beta */
  ptrdiff_t y, z;
  double alpha, beta, lo_y, hi_y, lo_z, hi_z, shift;
  double *residual;
} forming;

CF_KERNEL void form(const int dim, const int n, const forming *of) {
  const forming f = *of;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const double c = (double)f.x[i];
    double sum = f.beta * (f.lo[i] * (c - (double)f.x[i - 1]) - f.hi[i] * ((double)f.x[i + 1] - c));
    sum += f.lo_y * (c - (double)f.x[i - f.y]) - f.hi_y * ((double)f.x[i + f.y] - c);
    if (dim == 3) sum += f.lo_z * (c - (double)f.x[i - f.z]) - f.hi_z * ((double)f.x[i + f.z] - c);
    f.residual[i] = (double)f.b[i] - f.shift - (f.alpha * c + sum);
  }
}
CF_CLONES static void form_2d(const int n, const forming *f) { form(2, n, f); }
CF_CLONES static void form_3d(const int n, const forming *f) { form(3, n, f); }

CF_CLONES static void split_scaled_row(const int pairs, const double factor, const double *line, float *even,
                                       float *odd) {
  CF_ROW_LOOP
  for (int m = 0; m < pairs; ++m) {
    even[m] = (float)(factor * line[2 * m]);
    odd[m] = (float)(factor * line[2 * m + 1]);
  }
}

/* The sums: squares of b - A x, of b and of x. */
static void form_row(const cf_pass *p, const cf_strip *t, const int j) {
  const cf_split *s = p->at;
  const cf_level *l = s->plain;
  const int i0 = 2 * t->from, n = natural_count(s, t), whole = 2 * (t->to - t->from);
  const ptrdiff_t at = cf_box_at(&l->box, i0, j, t->k), to = j * s->row + t->k * s->plane + t->from;
  forming f = {.x = p->x + at,
               .b = p->b + at,
               .lo = l->axis[0].lo1 + i0,
               .hi = l->axis[0].hi1 + i0,
               .y = l->box.stride[1],
               .z = l->box.stride[2],
               .alpha = p->alpha,
               .beta = p->beta,
               .lo_y = p->beta * l->axis[1].lo1[j],
               .hi_y = p->beta * l->axis[1].hi1[j],
               .shift = p->shift,
               .residual = t->scratch};
  if (s->dim == 3) {
    f.lo_z = p->beta * l->axis[2].lo1[t->k];
    f.hi_z = p->beta * l->axis[2].hi1[t->k];
  }
  (s->dim == 3 ? form_3d : form_2d)(n, &f);
  for (int i = n; i < whole; ++i) f.residual[i] = 0;
  double *sums = p->rows + place_of_sum(t, j);
  sums[0] = square_sum_of_doubles(whole, f.residual);
  sums[p->sums] = square_sum(n, f.b);
  sums[2 * p->sums] = square_sum(n, f.x);
  split_scaled_row(whole / 2, 1 / p->scale, f.residual, s->r + to, s->r + to + s->odd);
}

/* --- to the coarse level --------------------------------------------------------------------------------- */

/* What a fine row leaves to its coarse row: sum[m] += weight (share of even cell m times its residual, and the
 * same of odd cell m). form 0: uneven, 1: even couplings, 2: stencils for both colours. */
typedef struct gathering {
  const cf_split *s;
  float weight;
  float *sum;
} gathering;

CF_KERNEL void gather_row(const int dim, const int form, const gathering *g, const half *of_red,
                          const half *of_black, const int from, const int to) {
  const half red = *of_red, black = *of_black;
  const float *share_red = g->s->share + (red.parity ? g->s->odd : 0);
  const float *share_black = g->s->share + (red.parity ? 0 : g->s->odd);
  const float left_red = 1 - g->s->omega[0], left_black = (1 - g->s->omega[1]) / g->s->omega[1];
  const float weight = g->weight;
  float *sum = g->sum;
  FOR_PIECE(m, from, to) {
    float from_red, from_black;
    if (form == 2) {
      from_red = red.r[m] - (red.diagonal[m] * red.e[m] - around(dim, 0, &red, m));
      from_black = black.r[m] - (black.diagonal[m] * black.e[m] - around(dim, 0, &black, m));
    } else {
      from_red = left_red * red.r[m] + around(dim, form, &red, m);
      from_black = left_black * (black.diagonal[m] * black.e[m]);
    }
    sum[m] += weight * (share_red[m] * from_red + share_black[m] * from_black);
  }
}

#define GATHER(name, dim, form)                                                                      \
  CF_CLONES static void name(const gathering *g, const half *red, const half *black, const int from, \
                             const int to) {                                                         \
    gather_row(dim, form, g, red, black, from, to);                                                  \
  }
GATHER(gather_2d_uneven, 2, 0)
GATHER(gather_2d_even, 2, 1)
GATHER(gather_2d_both, 2, 2)
GATHER(gather_3d_uneven, 3, 0)
GATHER(gather_3d_even, 3, 1)
GATHER(gather_3d_both, 3, 2)

static void gather(const gathering *g, const cf_strip *t) {
  static void (*const by_form[2][3])(const gathering *, const half *, const half *, int, int) = {
      {gather_2d_uneven, gather_2d_even, gather_2d_both}, {gather_3d_uneven, gather_3d_even, gather_3d_both}};
  const half red = half_of(g->s, t->j, t->k, 0), black = half_of(g->s, t->j, t->k, 1);
  by_form[g->s->dim - 2][g->s->odd_seam ? 2 : g->s->even_couplings](g, &red, &black, t->from, t->to);
}

/* Sums of fine pairs, in natural order, become the halves of a coarse row. */
CF_CLONES static void split_row(const int pairs, const float *line, float *even, float *odd) {
  CF_ROW_LOOP
  for (int q = 0; q < pairs; ++q) {
    even[q] = line[2 * q];
    odd[q] = line[2 * q + 1];
  }
}

/* The first child of the parent of i along an axis; -1 if i is not its last child. */
static int first_child(const cf_split *s, const int a, const int i) {
  const int *parent = s->plain->pairing[a].parent;
  if (i + 1 < s->n[a] && parent[i + 1] == parent[i]) return -1;
  int low = i;
  while (low > 0 && parent[low - 1] == parent[i]) --low;
  return low;
}

/* What the coarse level starts from: its first half sweep, or 0 where that would not do. */
static void start_coarse(const cf_split *c, const cf_strip *t) {
  if (!c->odd_seam) {
    const half red = half_of(c, t->j, t->k, 0);
    first_row(&red, t->from, t->to, c->omega[0]);
    return;
  }
  float *row = c->e + t->j * c->row + t->k * c->plane;
  memset(row + t->from, 0, (size_t)(t->to - t->from) * sizeof(float));
  memset(row + c->odd + t->from, 0, (size_t)(t->to - t->from) * sizeof(float));
}

/* The coarse row whose last child is row t->j of plane t->k: all its fine rows are ready. */
static void restrict_row(const cf_pass *p, const cf_strip *t, const int j0, const int k0) {
  const cf_split *s = p->at, *c = p->coarse;
  const cf_pairing *y = &s->plain->pairing[1], *z = &s->plain->pairing[2];
  const bool ends = t->to == s->width;
  gathering g = {.s = s, .sum = t->scratch};
  memset(g.sum + t->from, 0, (size_t)(t->to - t->from + 2 * CF_SPLIT_LANES) * sizeof(float));
  for (int k = k0; k <= t->k; ++k)
    for (int j = j0; j <= t->j; ++j) {
      cf_strip child = *t;
      child.j = j;
      child.k = k;
      g.weight = (float)(y->share[j] * (s->dim == 3 ? z->share[k] : 1));
      gather(&g, &child);
    }
  /* The last cell of a triple stands alone at the end. */
  if (ends && s->n[0] > 2 * c->n[0]) g.sum[c->n[0] - 1] += g.sum[c->n[0]], g.sum[c->n[0]] = 0;
  cf_strip coarse = {.j = y->parent[t->j], .k = s->dim == 3 ? z->parent[t->k] : 0, .from = t->from / 2};
  coarse.end = coarse.j + 1;
  coarse.to = ends ? c->width : t->to / 2;
  float *r = c->r + coarse.j * c->row + coarse.k * c->plane + coarse.from;
  split_row(coarse.to - coarse.from, g.sum + t->from, r, r + c->odd);
  start_coarse(c, &coarse);
}

static void restrict_rows(const cf_pass *p, const cf_strip *t) {
  const int k0 = p->at->dim == 3 ? first_child(p->at, 2, t->k) : 0;
  if (k0 < 0) return;
  for (int j = t->j; j < t->end; ++j) {
    const int j0 = first_child(p->at, 1, j);
    if (j0 < 0) continue;
    cf_strip last = *t;
    last.j = j;
    last.end = j + 1;
    restrict_row(p, &last, j0, k0);
  }
}

/* --- from the coarse level ------------------------------------------------------------------------------- */

/* A coarse row mixed of up to four, in natural order from cell 2 q0 on. */
typedef struct mixture {
  const float *row[4];
  float weight[4];
  int pairs;
  ptrdiff_t odd;
  float *line;
} mixture;

CF_CLONES static void mix_row(const mixture *x) {
  const float a = x->weight[0], b = x->weight[1], c = x->weight[2], d = x->weight[3];
  const float *p = x->row[0], *q = x->row[1], *r = x->row[2], *s = x->row[3];
  const ptrdiff_t odd = x->odd;
  float *line = x->line;
  const int pairs = x->pairs;
  CF_ROW_LOOP
  for (int i = 0; i < pairs; ++i) {
    line[2 * i] = (a * p[i] + b * q[i]) + (c * r[i] + d * s[i]);
    line[2 * i + 1] = (a * p[odd + i] + b * q[odd + i]) + (c * r[odd + i] + d * s[odd + i]);
  }
}

/* In y and z first (its up to four coarse rows: parent and other along either axis), then along x. */
CF_CLONES static void spread_row(const int n, const float *line, const float *own, const float *away,
                                 const ptrdiff_t odd, float *e) {
  CF_ROW_LOOP
  for (int m = 0; m < n; ++m) {
    e[m] += own[m] * line[m] + away[m] * line[m - 1];
    e[odd + m] += own[odd + m] * line[m] + away[odd + m] * line[m + 1];
  }
}

static void prolong_row(const cf_pass *p, const cf_strip *t, const int j) {
  const cf_split *s = p->at, *c = p->coarse;
  const cf_pairing *y = &s->plain->pairing[1], *z = &s->plain->pairing[2];
  const int q0 = t->from / 2 - 1;
  mixture x = {.pairs = (t->to - t->from) / 2 + 2, .odd = c->odd, .line = t->scratch};
  for (int v = 0; v < 4; ++v) {
    const int jj = v & 1, kk = v >> 1, flat = s->dim == 2;
    const int row = jj == 0 ? y->parent[j] : y->other[j], plane = flat      ? 0
                                                                  : kk == 0 ? z->parent[t->k]
                                                                            : z->other[t->k];
    x.row[v] = c->e + row * c->row + plane * c->plane + q0;
    x.weight[v] = (float)(y->weight[jj][j] * (flat ? (cf_real)(kk == 0) : z->weight[kk][t->k]));
  }
  mix_row(&x);
  spread_row(t->to - t->from, x.line + (t->from - 2 * q0), s->own + t->from, s->away + t->from, s->odd,
             s->e + j * s->row + t->k * s->plane + t->from);
}

/* --- all of them ------------------------------------------------------------------------------------------ */

static void clear_rows(const cf_split *s, const cf_strip *t) {
  for (int j = t->j; j < t->end; ++j)
    for (int parity = 0; parity < 2; ++parity)
      memset(s->e + j * s->row + t->k * s->plane + parity * s->odd + t->from, 0,
             (size_t)(t->to - t->from) * sizeof(float));
}

static void relax_rows(row_kernel *kernel, const cf_split *s, const cf_strip *t, const int colour,
                       const float omega) {
  for (int j = t->j; j < t->end; ++j) {
    const half h = half_of(s, j, t->k, colour);
    kernel(&h, t->from, t->to, omega);
  }
}

void cf_stage_run(const cf_pass *p, const int number, const cf_strip *t) {
  const cf_split *s = p->at;
  const float own = p->omega[number];
  const int form = s->even_couplings, d = s->dim - 2;
#define OMEGA(v) (own > 0 ? own : s->omega[v])
  switch (p->stage[number]) {
    case CF_STAGE_FORM:
      for (int j = t->j; j < t->end; ++j) form_row(p, t, j);
      relax_rows(first_row, s, t, 0, OMEGA(0));
      break;
    case CF_STAGE_FIRST:
      relax_rows(first_row, s, t, 0, OMEGA(0));
      break;
    case CF_STAGE_SECOND:
      for (int j = t->j; j < t->end; ++j) set_images(s, t, j, 0, 0);
      relax_rows(second_by_form[d][form], s, t, 1, OMEGA(1));
      break;
    case CF_STAGE_RED:
      relax_rows(relax_by_form[d][form], s, t, 0, OMEGA(2));
      break;
    case CF_STAGE_BLACK:
      relax_rows(relax_by_form[d][form], s, t, 1, OMEGA(3));
      break;
    case CF_STAGE_LAST:
      for (int j = t->j; j < t->end; ++j) last_row(s, t, j, OMEGA(3));
      break;
    case CF_STAGE_UPDATE:
      for (int j = t->j; j < t->end; ++j) update_row(p, t, j, OMEGA(0));
      break;
    case CF_STAGE_RESTRICT:
      restrict_rows(p, t);
      break;
    case CF_STAGE_PROLONG:
      for (int j = t->j; j < t->end; ++j) prolong_row(p, t, j);
      break;
    case CF_STAGE_CLEAR:
      clear_rows(s, t);
      break;
    case CF_STAGE_RESIDUAL:
      for (int j = t->j; j < t->end; ++j) residual_row(s, t, j);
      break;
    case CF_STAGES:
      break;
  }
#undef OMEGA
  if (number + 1 < p->count && p->stage[number + 1] == CF_STAGE_LAST)
    for (int j = t->j; j < t->end; ++j) set_images(s, t, j, 1, 1);
}

size_t cf_stage_scratch(const cf_split *s) {
  return (size_t)(2 * s->width + 4 * CF_SPLIT_LANES) * (3 * sizeof(double) + sizeof(float));
}

bool cf_stage_reads_around(const cf_stage stage) {
  return stage == CF_STAGE_SECOND || stage == CF_STAGE_RED || stage == CF_STAGE_BLACK ||
         stage == CF_STAGE_LAST || stage == CF_STAGE_RESTRICT || stage == CF_STAGE_RESIDUAL ||
         stage == CF_STAGE_UPDATE;
}
