/* SPDX-License-Identifier: MIT */
#include "solve/clusters.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "solve/matching.h"

/* So few unknowns are eliminated. */
#define FEW 160
/* A level of fewer is not shared among threads. */
#define SERIAL 4096
/* Unknowns whose products are summed together. */
#define PIECE 2048
/* One step of conjugate gradients is enough if it leaves so much (of the square). */
#define ENOUGH 0.0625
/* What is smooth is corrected by half of what it should be (clusters.h); larger corrections save an iteration or two in
 * fourteen. */
#define OVER_FINEST 1.6f
#define OVER        1.3f
/* Sweeps back on a last level that has too many unknowns to be eliminated, and no partners among them. */
#define LAST_SWEEPS 4
/* Couplings of a cell that differ by more are far from alike. */
#define ALIKE        30.0f
#define PIECE_OF_ROW 256

#define PARALLEL(q, u, n)                                                                   \
  CF_PRAGMA(omp parallel for schedule(static) num_threads((n) < SERIAL ? 1 : (q)->threads)) \
  for (int32_t u = 0; u < n; ++u)

/* --- making ------------------------------------------------------------------------------------------- */

/* Unknowns of the last level that hang together have the number of the first. */
static void find_parts(const cf_cluster_level *s, int32_t *part) {
  for (int32_t u = 0; u < s->n; ++u) part[u] = u;
  for (bool changed = true; changed;) {
    changed = false;
    for (int32_t u = 0; u < s->n; ++u)
      for (int32_t v = s->start[u]; v < s->start[u + 1]; ++v)
        if (part[s->to[v]] < part[u]) part[u] = part[s->to[v]], changed = true;
  }
  for (int32_t u = s->n - 1; u >= 0; --u)
    if (s->fixed[u] > 0 && part[u] >= 0) part[part[u]] = -1;
  for (int32_t u = 0; u < s->n; ++u)
    if (part[u] >= 0 && part[part[u]] < 0) part[u] = -1;
}

/* The factor L of the last level, L transposed L = A, packed in rows; its diagonal inverted, 0 where nothing is left: the
 * level of a part that nothing fixes. */
static cf_status factor(cf_clusters *q) {
  const cf_cluster_level *s = &q->level[q->levels - 1];
  CF_TRY(CF_NEW(&q->part, s->n));
  find_parts(s, q->part);
  CF_TRY(CF_NEW(&q->factor, (ptrdiff_t)s->n * s->n));
  for (int32_t i = 0; i < s->n; ++i) {
    q->factor[(ptrdiff_t)i * (s->n + 1)] = (double)s->fixed[i];
    for (int32_t v = s->start[i]; v < s->start[i + 1]; ++v) {
      const int32_t j = s->to[v];
      if (j > i) continue;
      q->factor[(ptrdiff_t)i * s->n + j] = -(double)s->c[v];
      q->factor[(ptrdiff_t)i * (s->n + 1)] += (double)s->c[v];
      q->factor[(ptrdiff_t)j * (s->n + 1)] += (double)s->c[v];
    }
  }
  for (int32_t i = 0; i < s->n; ++i) {
    double *row = q->factor + (ptrdiff_t)i * s->n;
    const double whole = row[i];
    for (int32_t j = 0; j <= i; ++j) {
      const double *other = q->factor + (ptrdiff_t)j * s->n;
      double sum = row[j];
      for (int32_t v = 0; v < j; ++v) sum -= row[v] * other[v];
      if (j < i)
        row[j] = sum * other[j];
      else
        row[i] = sum > 1e-13 * whole ? 1 / sqrt(sum) : 0;
    }
  }
  return CF_OK;
}

void cf_clusters_clear(cf_clusters *q) {
  for (int v = 0; v < q->levels; ++v) cf_matching_clear(&q->level[v]);
  cf_free(q->factor);
  cf_free(q->part);
  cf_free(q->sums);
  *q = (cf_clusters){0};
}

static cf_status make(cf_clusters *q, const cf_coupled *l) {
  const cf_cluster_level *of = NULL;
  while (q->levels < CF_CLUSTER_LEVELS_MAX && (of == NULL || of->n > FEW)) {
    cf_cluster_level *next = &q->level[q->levels++];
    CF_TRY(cf_matching_make(next, l, of, l->dim));
    if (next->n == 0) {
      --q->levels;
      break;
    }
    of = next;
  }
  if (q->levels == 0) return CF_OK;
  CF_TRY(CF_NEW(&q->sums, 3 * (q->level[0].n / PIECE + 1)));
  return q->level[q->levels - 1].n <= FEW ? factor(q) : CF_OK;
}

cf_status cf_clusters_make(cf_clusters *q, const cf_coupled *l, bool *made) {
  *made = false;
  cf_clusters_clear(q);
  if (l->box.size >= INT32_MAX / 8) return CF_OK;
  q->threads = l->threads;
  const cf_status s = make(q, l);
  if (s != CF_OK) cf_clusters_clear(q);
  *made = q->levels > 0;
  return s;
}

/* --- what a level is worked on with --------------------------------------------------------------------- */

/* What neighbours low, ..., high - 1 of a list send. */
static float gathered(const cf_cluster_level *s, const int32_t low, const int32_t high) {
  float sum = 0;
  for (int32_t v = low; v < high; ++v) sum += s->c[v] * s->e[s->to[v]];
  return sum;
}

/* Unknowns of a colour know nothing of each other, but for those of the last one. */
#define PARALLEL_COLOUR(q, s, colour, w)                                              \
  CF_PRAGMA(omp parallel for schedule(static) num_threads(threads_for(q, s, colour))) \
  for (int32_t w = (s)->colour[colour]; w < (s)->colour[(colour) + 1]; ++w)

static int threads_for(const cf_clusters *q, const cf_cluster_level *s, const int colour) {
  const bool few = s->colour[colour + 1] - s->colour[colour] < SERIAL;
  return few || colour == CF_CLUSTER_COLOURS_MAX - 1 ? 1 : q->threads;
}

/* From e = 0, whatever e holds; then rest = r - A e, for which those met later are to blame. */
static void sweep_forth(const cf_clusters *q, const cf_cluster_level *s) {
  for (int colour = 0; colour < s->colours; ++colour) PARALLEL_COLOUR(q, s, colour, w) {
      const int32_t u = s->order[w];
      s->e[u] = s->inverse[u] * (s->r[u] + gathered(s, s->start[u], s->later[u]));
    }
  PARALLEL(q, u, s->n) s->rest[u] = gathered(s, s->later[u], s->start[u + 1]);
}

static void sweep_back(const cf_clusters *q, const cf_cluster_level *s) {
  for (int colour = s->colours - 1; colour >= 0; --colour) PARALLEL_COLOUR(q, s, colour, w) {
      const int32_t u = s->order[w];
      s->e[u] = s->inverse[u] * (s->r[u] + gathered(s, s->start[u], s->start[u + 1]));
    }
}

/* (A f)_u */
static float apply_at(const cf_cluster_level *s, const float *f, const int32_t u) {
  float sum = s->fixed[u] * f[u];
  for (int32_t v = s->start[u]; v < s->start[u + 1]; ++v) sum += s->c[v] * (f[u] - f[s->to[v]]);
  return sum;
}

/* Two products of three fields, and the square of the first: a.b, a.c, a.a. */
typedef struct products {
  double ab, ac, aa;
} products;

static products multiply(const cf_clusters *q, const int32_t n, const float *a, const float *b,
                         const float *c) {
  const int32_t pieces = n / PIECE + 1;
  PARALLEL(q, v, pieces) {
    products p = {0, 0, 0};
    for (int32_t u = v * PIECE; u < CF_MIN(n, (v + 1) * PIECE); ++u) {
      const double of = (double)a[u];
      p.ab += of * (double)b[u];
      p.ac += of * (double)c[u];
      p.aa += of * of;
    }
    q->sums[v] = p.ab;
    q->sums[v + pieces] = p.ac;
    q->sums[v + 2 * pieces] = p.aa;
  }
  return (products){cf_sum_ordered(q->sums, pieces), cf_sum_ordered(q->sums + pieces, pieces),
                    cf_sum_ordered(q->sums + 2 * pieces, pieces)};
}

/* --- the cycle ---------------------------------------------------------------------------------------- */

static void restrict_to(const cf_clusters *q, const float *rest, const cf_cluster_level *s) {
  PARALLEL(q, u, s->n) {
    float sum = 0;
    for (int32_t v = s->first[u]; v < s->first[u + 1]; ++v) sum += rest[s->child[v]];
    s->r[u] = sum;
  }
}

static void spread_from(const cf_clusters *q, const cf_cluster_level *s, const float over, float *e) {
  PARALLEL(q, u, s->n)
  for (int32_t v = s->first[u]; v < s->first[u + 1]; ++v) e[s->child[v]] += over * s->e[u];
}

/* Parts whose level nothing fixes have the mean 0: a large one would be rounded, and couplings multiply that. */
static void level_out(const cf_clusters *q, double *y) {
  const int32_t n = q->level[q->levels - 1].n;
  double mean[FEW] = {0}, count[FEW] = {0};
  for (int32_t i = 0; i < n; ++i)
    if (q->part[i] >= 0) mean[q->part[i]] += y[i], ++count[q->part[i]];
  for (int32_t i = 0; i < n; ++i)
    if (q->part[i] >= 0) y[i] -= mean[q->part[i]] / count[q->part[i]];
}

static void solve_last(const cf_clusters *q) {
  const cf_cluster_level *s = &q->level[q->levels - 1];
  if (q->factor == NULL) {
    sweep_forth(q, s);
    for (int v = 0; v < LAST_SWEEPS; ++v) sweep_back(q, s);
    return;
  }
  double y[FEW];
  for (int32_t i = 0; i < s->n; ++i) {
    const double *row = q->factor + (ptrdiff_t)i * s->n;
    double sum = (double)s->r[i];
    for (int32_t j = 0; j < i; ++j) sum -= row[j] * y[j];
    y[i] = sum * row[i];
  }
  for (int32_t i = s->n - 1; i >= 0; --i) {
    const double *row = q->factor + (ptrdiff_t)i * s->n;
    y[i] *= row[i];
    for (int32_t j = 0; j < i; ++j) y[j] -= row[j] * y[i];
  }
  level_out(q, y);
  for (int32_t i = 0; i < s->n; ++i) s->e[i] = (float)y[i];
}

static void solve(const cf_clusters *q, int at);

/* e = one cycle on r. */
static void cycle(const cf_clusters *q, const int at) {
  const cf_cluster_level *s = &q->level[at];
  if (at == q->levels - 1) {
    solve_last(q);
    return;
  }
  sweep_forth(q, s);
  restrict_to(q, s->rest, s + 1);
  solve(q, at + 1);
  spread_from(q, s + 1, OVER, s->e);
  sweep_back(q, s);
}

/* e = what one or two steps of conjugate gradients make of r, which is changed. */
static void solve(const cf_clusters *q, const int at) {
  const cf_cluster_level *s = &q->level[at];
  cycle(q, at);
  if (at == q->levels - 1) return;
  PARALLEL(q, u, s->n) {
    s->u[u] = s->e[u];
    s->Au[u] = apply_at(s, s->e, u);
  }
  const products one = multiply(q, s->n, s->u, s->Au, s->r);
  if (!(one.ab > 0) || !isfinite(one.ac)) return;
  const double a = one.ac / one.ab;
  const products before = multiply(q, s->n, s->r, s->r, s->r);
  PARALLEL(q, u, s->n) s->r[u] -= (float)a * s->Au[u];
  const products after = multiply(q, s->n, s->r, s->r, s->r);
  if (after.aa <= ENOUGH * before.aa) {
    PARALLEL(q, u, s->n) s->e[u] = (float)a * s->u[u];
    return;
  }
  cycle(q, at);
  PARALLEL(q, u, s->n) s->rest[u] = apply_at(s, s->e, u);
  const products two = multiply(q, s->n, s->e, s->rest, s->r);
  const double shared = multiply(q, s->n, s->e, s->Au, s->Au).ab;
  const double left = two.ab - shared * shared / one.ab;
  const double b = left > 0 && isfinite(two.ac) ? two.ac / left : 0, c = a - b * shared / one.ab;
  PARALLEL(q, u, s->n) s->e[u] = (float)c * s->u[u] + (float)b * s->e[u];
}

void cf_clusters_correct(const cf_clusters *q, const cf_coupled *l) {
  restrict_to(q, l->rest, &q->level[0]);
  solve(q, 0);
  spread_from(q, &q->level[0], OVER_FINEST, l->e);
}

/* --- when --------------------------------------------------------------------------------------------- */

/* Whether some coupling of a cell is many times another one that is not 0. */
CF_CLONES static bool differ(const int n, const cf_coupled *l, const ptrdiff_t p) {
  float most[PIECE_OF_ROW], least[PIECE_OF_ROW];
  int any = 0;
  for (int i = 0; i < n; ++i) most[i] = 0, least[i] = INFINITY;
  for (int a = 0; a < l->dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const float *c = l->c[a] + p + side * l->box.stride[a];
      CF_ROW_LOOP
      for (int i = 0; i < n; ++i) {
        most[i] = c[i] > most[i] ? c[i] : most[i];
        least[i] = c[i] > 0 && c[i] < least[i] ? c[i] : least[i];
      }
    }
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) any |= most[i] > ALIKE * least[i];
  return any != 0;
}

bool cf_clusters_are_called_for(const cf_coupled *l) {
  int any = 0;
#pragma omp parallel for schedule(static) num_threads(cf_coupled_threads(l)) reduction(| : any)
  for (ptrdiff_t v = 0; v < l->rows; ++v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run)
        for (int from = run->low; from < run->high && !any; from += PIECE_OF_ROW)
          any |= differ(CF_MIN(PIECE_OF_ROW, run->high - from), l, cf_box_at(&l->box, from, j, k));
  return any != 0;
}
