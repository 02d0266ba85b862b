/* SPDX-License-Identifier: MIT
 *
 * Equations with fields for coefficients in which diffusion adds little to the diagonal: half sweeps of red-black
 * Gauss-Seidel alone, over-relaxed as Chebyshev's polynomials ask (Golub and Varga 1961), in the precision of the state and
 * with no levels behind them. The number of half sweeps follows from the largest share of diffusion in any diagonal.
 *
 *     x += omega (b - A x)/d      on the cells of one colour
 *
 * d is kept in single precision, which costs nothing: it decides how fast, not where to.
 *
 * All of them and the residual at the end go over the box in one pass: half sweep s is on plane K - s (in 2D: row) while
 * the first one is on plane K, so that what it reads is still in the cache. Threads take slabs of planes, first as far
 * as they need nothing of each other,
 *
 *     half sweep 0     |#########|#########|
 *     half sweep 1     |######## | ########|      then the wedges between them.
 *     half sweep 2     |#######  |  #######|
 *
 * A half sweep does not depend on the order of its cells, so the bits do not depend on the slabs. Across the seams
 * of periodic axes it goes half sweep by half sweep instead.
 *
 * Where x and b are 0 farther around than there are half sweeps x stays 0: of every row only the rest is visited, with
 * the same bits as all of it.
 */
#include <math.h>
#include <string.h>

#include "solve/colours.h"
#include "solve/varied.h"
#include "solve/varied_row.h"

/* Aims so much below the tolerance: a second pass costs more than a half sweep. */
#define MARGIN    0.25
#define MOST      32
#define LEAST     4
#define PASS_GAIN 1e-12
/* The stiffness up to which it goes without the theory. */
#define ODD_ENOUGH 0.5
/* A pass that leaves so much (in squares) has come to the end of what rounding lets it see. */
#define STALLED 0.25

/* --- rows --------------------------------------------------------------------------------------------- */

typedef struct weighing {
  double scale;
  float *inverse;
} weighing;

CF_KERNEL void weigh(const int dim, const int form, const int n, const cf_varied_row *of,
                     const weighing *to) {
  const cf_varied_row o = *of;
  float *inverse = to->inverse;
  const double scale = to->scale;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    cf_real sum = cf_alpha_at(form, &o, i);
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) sum += cf_low_at(form, &o, a, i) + cf_high_at(form, &o, a, i);
    inverse[i] = (float)(1 / (scale * (double)sum));
  }
}
CF_VARIED_ROWS(weigh, const weighing *)

typedef struct half {
  cf_real factor; /* omega, and what the diagonal is scaled by */
  int parity;     /* of the cells meant */
} half;

/* Cells that go together: changes are put down apart first, for a vector that is loaded across one just stored waits for
 * the store. */
#define APART 256

CF_KERNEL void relax_piece(const int dim, const int form, const int n, const cf_varied_row *of,
                           const int from, const half *h) {
  const cf_varied_row o = *of;
  const cf_real factor = h->factor;
  const int parity = (h->parity ^ from) & 1;
  cf_real fresh[APART];
  CF_ROW_LOOP
  for (int m = 0; m < n; ++m) {
    CF_THROWN_AWAY(((m ^ parity) & 1) != 0);
    const int i = from + m;
    const cf_real x = o.x[i];
    cf_real sum = cf_alpha_at(form, &o, i) * x;
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) {
      const ptrdiff_t s = o.stride[a];
      sum += cf_low_at(form, &o, a, i) * (x - o.x[i - s]) - cf_high_at(form, &o, a, i) * (o.x[i + s] - x);
    }
    fresh[m] = x + factor * (cf_real)o.inverse[i] * (o.b[i] - sum);
  }
  cf_real *x = o.x + from;
  CF_ROW_LOOP
  for (int m = 0; m < n; ++m)
    if (((m ^ parity) & 1) == 0) x[m] = fresh[m];
}

CF_KERNEL void relax(const int dim, const int form, const int n, const cf_varied_row *o, const half *h) {
  for (int from = 0; from < n; from += APART) relax_piece(dim, form, CF_MIN(APART, n - from), o, from, h);
}
CF_VARIED_ROWS(relax, const half *)

/* --- the diagonal ------------------------------------------------------------------------------------- */

/* A periodic axis with an odd number of cells: neighbours across the seam share a colour. */
static bool has_odd_seam(const cf_coupled *l) {
  for (int a = 0; a < l->dim; ++a)
    if (l->periodic[a] && l->box.n[a] % 2 == 1) return true;
  return false;
}

bool cf_varied_set_sweeps(cf_varied *v, const double alpha, const double stiffness) {
  const cf_coupled *l = &v->level[0];
  const double most = has_odd_seam(l) ? ODD_ENOUGH : CF_SWEEPS_ENOUGH;
  if (v->region != NULL || !(stiffness <= most) || !(alpha * v->scale > 1e-30)) return false;
  v->jacobi = stiffness / (1 + stiffness);
  CF_PARALLEL_COUPLED (l, r)
    CF_TILE_ROWS (l, r, j, k) {
      const ptrdiff_t p = cf_box_at(&l->box, 0, j, k);
      const cf_varied_row o = cf_varied_row_of(v, l->run, j, k, v->r);
      const weighing to = {v->scale, l->inverse + p};
      weigh_row(l->dim, cf_varied_form_of(v), l->box.n[0], &o, &to);
    }
  return true;
}

/* --- a pass ------------------------------------------------------------------------------------------- */

typedef struct pass {
  const cf_varied *v;
  cf_cell x, b;
  int count; /* of half sweeps; what comes after them is the residual */
  double omega[MOST];
} pass;

static void plan(pass *p, const bool odd_seam, const double gain) {
  const double J2 = p->v->jacobi * p->v->jacobi;
  const double per_sweep = odd_seam ? sqrt(p->v->jacobi) : p->v->jacobi / (1 + sqrt(1 - J2));
  const int count = (int)ceil(log(gain / 2) / log(fmax(per_sweep, 1e-12)));
  p->count = CF_MIN(CF_MAX((count + 1) / 2 * 2, LEAST), MOST);
  p->omega[0] = 1;
  for (int s = 1; s < p->count; ++s) /* where neighbours share a colour there is no such theory */
    p->omega[s] = odd_seam ? 1 : s == 1 ? 1 / (1 - J2 / 2) : 1 / (1 - J2 * p->omega[s - 1] / 4);
}

/* --- where there is something --------------------------------------------------------------------------- */

/* Whether so many cells of x and b have nothing but 0; what is not a number is something. */
CF_KERNEL bool are_empty(const int n, const cf_real *x, const cf_real *b) {
  int some = 0;
#pragma omp simd reduction(| : some)
  for (int i = 0; i < n; ++i) some |= (x[i] != 0) | (b[i] != 0);
  return some == 0;
}

/* In whole blocks. */
#define BLOCK 32

CF_CLONES static cf_run run_of_row(const int n, const cf_real *x, const cf_real *b) {
  int low = 0, high = n;
  for (int m; m = CF_MIN(BLOCK, high - low), m > 0 && are_empty(m, x + low, b + low);) low += m;
  for (int m; m = CF_MIN(BLOCK, high - low), m > 0 && are_empty(m, x + high - m, b + high - m);) high -= m;
  return (cf_run){low, high};
}

static cf_run joined(const cf_run a, const cf_run b) {
  if (a.low >= a.high) return b;
  if (b.low >= b.high) return a;
  return (cf_run){CF_MIN(a.low, b.low), CF_MAX(a.high, b.high)};
}

/* Every row becomes what it and `reach` rows on both sides along axis 1 or 2 have. */
static void widen(const cf_box *box, const int a, const int reach, const cf_run *from, cf_run *to) {
  const int rows = box->n[1], stride = a == 1 ? 1 : rows, n = box->n[a];
  for (ptrdiff_t r = 0; r < cf_box_rows(box); ++r) {
    const int at = (int)(a == 1 ? r % rows : r / rows);
    cf_run all = {0, 0};
    for (int i = CF_MAX(at - reach, 0) - at; i <= CF_MIN(at + reach, n - 1) - at; ++i)
      all = joined(all, from[r + (ptrdiff_t)i * stride]);
    to[r] = all;
  }
}

/* Runs that so many half sweeps and the residual concern: v->busy[0]. */
static void find_busy(const pass *p, const int threads, const bool seam) {
  const cf_varied *v = p->v;
  const cf_box *box = &v->level[0].box;
  const int n = box->n[0], lanes = CF_SUM_LANES, reach = (p->count + lanes) / lanes * lanes;
#pragma omp parallel for schedule(static) num_threads(threads)
  for (ptrdiff_t r = 0; r < cf_box_rows(box); ++r) {
    const ptrdiff_t at = cf_box_row(box, r);
    const cf_run run = seam ? (cf_run){0, n} : run_of_row(n, p->x.at + at, p->b.at + at);
    const int high = (run.high + reach + lanes - 1) / lanes * lanes;
    v->busy[0][r] = run.low < run.high ? (cf_run){CF_MAX(run.low - reach, 0) / lanes * lanes, CF_MIN(high, n)}
                                       : (cf_run){0, 0};
  }
  if (seam) return;
  widen(box, 1, p->count + 1, v->busy[0], v->busy[1]);
  if (box->dim == 3)
    widen(box, 2, p->count + 1, v->busy[1], v->busy[0]);
  else
    memcpy(v->busy[0], v->busy[1], (size_t)cf_box_rows(box) * sizeof(cf_run));
}

static void do_row(const pass *p, const int stage, const int j, const int k) {
  const cf_coupled *l = &p->v->level[0];
  const cf_run *run = &p->v->busy[0][j + (ptrdiff_t)l->box.n[1] * k];
  if (stage == p->count) {
    cf_varied_form_run(p->v, j, k, run, p->x, p->b);
    return;
  }
  if (run->low >= run->high) return;
  cf_varied_row o = cf_varied_row_of(p->v, run, j, k, p->x);
  o.b = p->b.at + cf_box_at(&l->box, run->low, j, k);
  const half h = {(cf_real)(p->omega[stage] * p->v->scale), (run->low + j + k + stage) & 1};
  relax_row(l->dim, cf_varied_form_of(p->v), run->high - run->low, &o, &h);
}

/* A plane of the box; in 2D a row. */
static void do_plane(const pass *p, const int stage, const int plane) {
  const cf_box *b = &p->v->level[0].box;
  if (b->dim == 2)
    do_row(p, stage, plane, 0);
  else
    for (int j = 0; j < b->n[1]; ++j) do_row(p, stage, j, plane);
}

/* What of planes [from, to) needs nothing of other slabs. */
static void do_slab(const pass *p, const int planes, const int from, const int to) {
  for (int step = from; step < to + p->count; ++step)
    for (int stage = 0; stage <= p->count; ++stage) {
      const int plane = step - stage;
      const int low = from == 0 ? 0 : from + stage, high = to == planes ? planes : to - stage;
      if (plane >= low && plane < high) do_plane(p, stage, plane);
    }
}

static void do_wedge(const pass *p, const int middle) {
  for (int stage = 1; stage <= p->count; ++stage)
    for (int plane = middle - stage; plane < middle + stage; ++plane) do_plane(p, stage, plane);
}

static void run_at_once(const pass *p, const int threads) {
  const cf_box *b = &p->v->level[0].box;
  const int planes = b->n[b->dim - 1];
  const int slabs = CF_MAX(1, CF_MIN(threads, planes / (2 * p->count + 2)));
#pragma omp parallel num_threads(slabs)
  {
#pragma omp for schedule(static)
    for (int s = 0; s < slabs; ++s)
      do_slab(p, planes, (int)((ptrdiff_t)planes * s / slabs), (int)((ptrdiff_t)planes * (s + 1) / slabs));
#pragma omp for schedule(static)
    for (int s = 1; s < slabs; ++s) do_wedge(p, (int)((ptrdiff_t)planes * s / slabs));
  }
}

static void run_in_turn(const pass *p, const int threads) {
  const cf_box *b = &p->v->level[0].box;
  for (int stage = 0; stage <= p->count; ++stage) {
    cf_varied_set_ghosts(p->v, p->x);
#pragma omp parallel for schedule(static) num_threads(threads)
    for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r) do_row(p, stage, (int)(r % b->n[1]), (int)(r / b->n[1]));
  }
}

cf_status cf_varied_sweep(cf_varied *v, const cf_cell b, const cf_solve_options *o, const cf_cell x,
                          cf_solve_report *report) {
  const cf_coupled *l = &v->level[0];
  const int threads = cf_coupled_threads(l);
  const bool seam = l->periodic[0] || l->periodic[1] || l->periodic[2], odd_seam = has_odd_seam(l);
  pass p = {.v = v, .x = x, .b = b};
  double before = INFINITY, gain = MARGIN * o->tolerance;
  cf_varied_set_ghosts(v, x);
  for (bool more = true; more;) {
    plan(&p, odd_seam, fmax(gain, PASS_GAIN));
    find_busy(&p, threads, seam);
    (seam ? run_in_turn : run_at_once)(&p, threads);
    cf_varied_sums s = cf_varied_add_up(v, 2);
    CF_TRY(cf_varied_judge(v, &s, o, report));
    if (!report->converged) { /* then how large x is counts as well */
      s = cf_varied_form(v, x, b);
      CF_TRY(cf_varied_judge(v, &s, o, report));
    }
    if (s.second == 0) cf_varied_clear(v, x);
    ++report->iterations;
    more = !report->converged && s.first <= STALLED * before && report->iterations < o->max_iterations;
    before = s.first;
    gain = MARGIN * o->tolerance * sqrt(s.second / s.first);
  }
  return CF_OK;
}
