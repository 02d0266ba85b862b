/* SPDX-License-Identifier: MIT */
#include "solve/coupled.h"

#include <string.h>

#include "base/mem.h"

/* Rows of cells that a thread takes at once where there are no tiles. */
#define GROUP 4

/* --- making ------------------------------------------------------------------------------------------- */

static cf_status field_create(const cf_coupled *l, void **at, const size_t element) {
  void *pages;
  CF_TRY(cf_pages_reserve(&pages, (size_t)l->box.size * element, l->tiles == NULL));
  *at = (char *)pages + (size_t)l->box.first * element;
  return CF_OK;
}

static void field_destroy(const cf_coupled *l, void *at, const size_t element) {
  if (at != NULL)
    cf_pages_release((char *)at - (size_t)l->box.first * element, (size_t)l->box.size * element);
}

/* Every float field of a level, for what is done to all of them. */
#define FLOATS 9
static void float_fields(cf_coupled *l, float **field[FLOATS]) {
  float **list[FLOATS] = {&l->e,    &l->r,    &l->rest, &l->inverse, &l->free,
                          &l->held, &l->c[0], &l->c[1], &l->c[2]};
  memcpy(field, list, sizeof list);
}

static cf_status all_rows(cf_coupled *l) {
  const int groups = (l->box.n[1] + GROUP - 1) / GROUP;
  CF_TRY(CF_NEW(&l->all_rows, (ptrdiff_t)groups * l->box.n[2]));
  for (int k = 0; k < l->box.n[2]; ++k)
    for (int g = 0; g < groups; ++g)
      l->all_rows[l->rows++] = (cf_tile_row){g * GROUP, k, CF_MIN((g + 1) * GROUP, l->box.n[1]), k + 1, 0, 1};
  l->all[0] = (cf_run){0, l->box.n[0]};
  l->row = l->all_rows;
  l->run = l->all;
  return CF_OK;
}

cf_status cf_coupled_create(cf_coupled *l, const cf_box *b, const bool periodic[3], const int threads,
                            const cf_tiles *tiles) {
  *l = (cf_coupled){.dim = b->dim, .threads = threads, .box = *b, .tiles = tiles};
  for (int a = 0; a < b->dim; ++a) l->periodic[a] = periodic[a] && b->n[a] > 1;
  float **field[FLOATS];
  float_fields(l, field);
  for (int f = 0; f < FLOATS - (b->dim == 2); ++f) CF_TRY(field_create(l, (void **)field[f], sizeof(float)));
  for (int a = 0; a < b->dim; ++a) CF_TRY(field_create(l, (void **)&l->weight[a], 1));
  return tiles == NULL ? all_rows(l) : CF_OK;
}

void cf_coupled_destroy(cf_coupled *l) {
  float **field[FLOATS];
  float_fields(l, field);
  for (int f = 0; f < FLOATS; ++f) field_destroy(l, *field[f], sizeof(float));
  for (int a = 0; a < 3; ++a) field_destroy(l, l->weight[a], 1);
  cf_free(l->all_rows);
  cf_free(l->odd_cell);
  cf_free(l->odd_parent);
  cf_free(l->odd_value);
  cf_free(l->odd_island);
  cf_free(l->band[0]);
  cf_free(l->band[1]);
  cf_tiles_destroy(l->own_tiles);
  *l = (cf_coupled){0};
}

void cf_coupled_follow_tiles(cf_coupled *l) {
  float **field[FLOATS];
  float_fields(l, field);
  for (int f = 0; f < FLOATS - (l->dim == 2); ++f)
    cf_tiles_follow_bytes(l->tiles, l->followed, *field[f], sizeof(float));
  for (int a = 0; a < l->dim; ++a) cf_tiles_follow_bytes(l->tiles, l->followed, l->weight[a], 1);
  l->followed = l->tiles->updates;
  l->row = l->tiles->row;
  l->run = l->tiles->run;
  l->rows = l->tiles->rows;
}

/* --- seams -------------------------------------------------------------------------------------------- */

/* A ghost that is right already is not written: its page may not be ours to touch. */
static void copy_ghost(float *to, const float from) {
  if (*to != from) *to = from;
}

static void wrap_axis(const cf_coupled *l, const int a, float *f) {
  const cf_box *b = &l->box;
  int n[3] = {b->n[0], b->n[1], b->n[2]};
  const ptrdiff_t last = (b->n[a] - 1) * b->stride[a], step = b->stride[a];
  n[a] = 1;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        float *at = f + cf_box_at(b, i, j, k);
        copy_ghost(at - step, at[last]);
        copy_ghost(at + last + step, at[0]);
      }
}

void cf_coupled_wrap(const cf_coupled *l, float *f) {
  for (int a = 0; a < l->dim; ++a)
    if (l->periodic[a]) wrap_axis(l, a, f);
}

/* --- half sweeps -------------------------------------------------------------------------------------- */

/* The level as the kernels of a row see it, and where the row is. */
typedef struct view {
  float *e, *rest;
  const float *r, *inverse, *free, *held, *c[3];
  ptrdiff_t stride[3];
  float omega;
} view;

typedef struct place {
  ptrdiff_t p;
  int parity; /* of the cells meant, counted from p */
} place;

static view view_of(const cf_coupled *l, const float omega) {
  return (view){.e = l->e,
                .rest = l->rest,
                .r = l->r,
                .inverse = l->inverse,
                .free = l->free,
                .held = l->held,
                .c = {l->c[0], l->c[1], l->c[2]},
                .stride = {l->box.stride[0], l->box.stride[1], l->box.stride[2]},
                .omega = omega};
}

CF_KERNEL void first_row(const int dim, const int n, const view *v, const place at) {
  (void)dim;
  float *e = v->e + at.p;
  const float *r = v->r + at.p, *inverse = v->inverse + at.p;
  const float omega = v->omega;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) e[i] = ((i ^ at.parity) & 1) == 0 ? omega * (inverse[i] * r[i]) : 0;
}

/* Neighbours have the other colour, so rows may run in any order and the loop in vectors; both colours are computed and
 * one is kept, so that what is read while another thread changes it does not count. form 1: a cell is over-relaxed by
 * what couplings have of its diagonal; one that a large alpha holds is simply solved. */
CF_KERNEL void half_row(const int dim, const int form, const int n, const view *v, const place at) {
  const view w = *v;
  float *e = w.e + at.p;
  const float *r = w.r + at.p, *inverse = w.inverse + at.p;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    float sum = r[i];
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) {
      const float *c = w.c[a] + at.p;
      sum += c[i] * e[i - w.stride[a]] + c[i + w.stride[a]] * e[i + w.stride[a]];
    }
    const float share = form ? 1 - w.free[at.p + i] * inverse[i] : 1;
    const float over = form ? (w.omega - 1) * share * share : w.omega - 1;
    const float fresh = inverse[i] > 0 ? (1 + over) * (inverse[i] * sum) - over * e[i] : 0;
    if (((i ^ at.parity) & 1) == 0) e[i] = fresh;
  }
}

CF_KERNEL void residual_row(const int dim, const int n, const view *v, const place at) {
  const view w = *v;
  const float *e = w.e + at.p, *r = w.r + at.p, *free = w.free + at.p, *held = w.held + at.p;
  float *rest = w.rest + at.p;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    float sum = (free[i] + held[i]) * e[i];
    CF_AXIS_LOOP
    for (int a = 0; a < dim; ++a) {
      const float *c = w.c[a] + at.p;
      sum += c[i] * (e[i] - e[i - w.stride[a]]) - c[i + w.stride[a]] * (e[i + w.stride[a]] - e[i]);
    }
    rest[i] = r[i] - sum;
  }
}

CF_CLONED(first_row, const view *, const place)
CF_CLONED_FORMS(half_row, const view *, const place)
CF_CLONED(residual_row, const view *, const place)

static void half_row_by_dim(const int dim, const int n, const view *v, const place at) {
  half_row_by_form(dim, 0, n, v, at);
}

static void gentle_row_by_dim(const int dim, const int n, const view *v, const place at) {
  half_row_by_form(dim, 1, n, v, at);
}

typedef void row_kernel(int dim, int n, const view *v, place at);

static void sweep(const cf_coupled *l, row_kernel *kernel, const float omega, const int colour) {
  const view w = view_of(l, omega);
  CF_PARALLEL_COUPLED (l, v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run)
        kernel(l->dim, run->high - run->low, &w,
               (place){cf_box_at(&l->box, run->low, j, k), (j + k + colour + run->low) & 1});
}

static float relaxed(const view *v, const int dim, const ptrdiff_t p) {
  float sum = v->r[p];
  for (int a = 0; a < dim; ++a) {
    const ptrdiff_t s = v->stride[a];
    sum += v->c[a][p] * v->e[p - s] + v->c[a][p + s] * v->e[p + s];
  }
  return v->inverse[p] * sum;
}

static void sweep_band(const cf_coupled *l, const int sweeps) {
  const view w = view_of(l, 1);
  for (int v = 0; v < 2 * sweeps; ++v) {
    const ptrdiff_t *cell = l->band[v % 2], cells = l->bands[v % 2];
    cf_coupled_wrap(l, l->e);
#pragma omp parallel for schedule(static) num_threads(cells < CF_SERIAL_CELLS ? 1 : l->threads)
    for (ptrdiff_t i = 0; i < cells; ++i) w.e[cell[i]] = relaxed(&w, l->dim, cell[i]);
  }
}

/* The last layer of an odd periodic axis and the first are neighbours of one colour, moved at once without seeing each
 * other; the last one moves once more, so that it comes after all others of its colour as Gauss-Seidel has it. */
static void sweep_seams(const cf_coupled *l, const int colour) {
  const view w = view_of(l, 1);
  for (int a = 0; a < l->dim; ++a) {
    if (!l->periodic[a] || l->box.n[a] % 2 == 0) continue;
    cf_coupled_wrap(l, l->e);
    int low[3] = {0, 0, 0}, at[3];
    low[a] = l->box.n[a] - 1;
    for (at[2] = low[2]; at[2] < (a == 2 ? low[2] + 1 : l->box.n[2]); ++at[2])
      for (at[1] = low[1]; at[1] < (a == 1 ? low[1] + 1 : l->box.n[1]); ++at[1])
        for (at[0] = low[0]; at[0] < l->box.n[0]; ++at[0]) {
          const ptrdiff_t p = cf_box_at(&l->box, at[0], at[1], at[2]);
          if (((at[0] + at[1] + at[2] + colour) & 1) == 0 && cf_coupled_has(l, p))
            w.e[p] = relaxed(&w, l->dim, p);
        }
  }
}

static void half_sweep(const cf_coupled *l, const float omega, const int colour) {
  cf_coupled_wrap(l, l->e);
  sweep(l, l->is_gentle ? gentle_row_by_dim : half_row_by_dim, omega, colour);
  sweep_seams(l, colour);
}

void cf_coupled_smooth_first(const cf_coupled *l, const float omega, const int band) {
  sweep(l, first_row_by_dim, omega, 0);
  sweep_seams(l, 0);
  half_sweep(l, omega, 1);
  if (l->bands[0] + l->bands[1] > 0) sweep_band(l, band);
}

void cf_coupled_smooth(const cf_coupled *l, const float omega, const int band, const int sweeps,
                       const int first) {
  if (l->bands[0] + l->bands[1] > 0) sweep_band(l, band);
  for (int v = 0; v < 2 * sweeps; ++v) half_sweep(l, omega, (v + first) % 2);
}

/* --- between levels ----------------------------------------------------------------------------------- */

/* Sums over the children of coarse cells in a row; what lies beyond the box is 0. */
CF_CLONES static void gather_pairs(const int n, const int rows, const float *const *fine, float *coarse) {
  for (int i = 0; i < n; ++i) coarse[i] = 0;
  for (int v = 0; v < rows; ++v) {
    const float *f = fine[v];
    CF_ROW_LOOP
    for (int i = 0; i < n; ++i) coarse[i] += f[2 * i] + f[2 * i + 1];
  }
}

CF_CLONES static void gather_single(const int n, const int rows, const float *const *fine, float *coarse) {
  for (int i = 0; i < n; ++i) coarse[i] = 0;
  for (int v = 0; v < rows; ++v) {
    const float *f = fine[v];
    CF_ROW_LOOP
    for (int i = 0; i < n; ++i) coarse[i] += f[i];
  }
}

void cf_coupled_restrict(const cf_coupled *l, const cf_coupled *coarse) {
  cf_coupled_wrap(l, l->e);
  sweep(l, residual_row_by_dim, 1, 0);
  for (ptrdiff_t v = 0; v < l->odds; ++v) {
    l->odd_value[v] = l->rest[l->odd_cell[v]];
    l->rest[l->odd_cell[v]] = 0;
  }
  const int x = l->coarsened[0], y = l->coarsened[1], z = l->coarsened[2];
  CF_PARALLEL_COUPLED (coarse, v)
    CF_TILE_ROWS (coarse, v, j, k)
      CF_TILE_RUNS (coarse, v, run) {
        const float *fine[4];
        int rows = 0;
        for (int kk = 0; kk <= z; ++kk)
          for (int jj = 0; jj <= y; ++jj)
            fine[rows++] = l->rest + cf_box_at(&l->box, run->low << x, (j << y) + jj, (k << z) + kk);
        float *out = coarse->r + cf_box_at(&coarse->box, run->low, j, k);
        (x ? gather_pairs : gather_single)(run->high - run->low, rows, fine, out);
      }
  for (ptrdiff_t v = 0; v < l->odds; ++v)
    if (l->odd_parent[v] != CF_NO_PARENT) coarse->r[l->odd_parent[v]] += l->odd_value[v];
}

/* The constant of an island: what its residual sums to over its free and held. Its cells follow each other in the list. */
static ptrdiff_t lift_island(const cf_coupled *l, const ptrdiff_t first) {
  double residual = 0, fixed = 0;
  ptrdiff_t end = first;
  for (; end < l->odds && l->odd_island[end] == l->odd_island[first]; ++end) {
    const ptrdiff_t p = l->odd_cell[end];
    residual += (double)l->odd_value[end];
    fixed += (double)l->free[p] + (double)l->held[p];
  }
  for (ptrdiff_t v = first; v < end; ++v)
    l->odd_value[v] = l->e[l->odd_cell[v]] + (fixed > 0 ? (float)(residual / fixed) : 0);
  return end;
}

/* What the cells with another parent will be: their e and their own correction. */
static void correct_odds(const cf_coupled *coarse, const cf_coupled *l) {
  for (ptrdiff_t v = 0; v < l->odds;) {
    if (l->odd_parent[v] == CF_NO_PARENT) {
      v = lift_island(l, v);
      continue;
    }
    l->odd_value[v] = l->e[l->odd_cell[v]] + coarse->e[l->odd_parent[v]];
    ++v;
  }
}

/* A row of coarse cells, and those of its neighbours in y and z on the side of the fine row. */
typedef struct spread {
  const float *own, *y, *z;
  const unsigned char *weight[3];
  float *e;
} spread;

CF_KERNEL float interpolated(const int dim, const spread *s, const int I, const int i, const int side) {
  const float own = s->own[I], unit = 1.0f / 256;
  float sum = (float)s->weight[1][i] * (s->y[I] - own);
  if (dim == 3) sum += (float)s->weight[2][i] * (s->z[I] - own);
  if (side != 0) sum += (float)s->weight[0][i] * (s->own[I + side] - own);
  return own + unit * sum;
}

CF_KERNEL void spread_pairs(const int dim, const int n, const spread *s, const int odd_end) {
  const spread w = *s;
  CF_ROW_LOOP
  for (int I = 0; I < n; ++I) {
    w.e[2 * I] += interpolated(dim, &w, I, 2 * I, -1);
    w.e[2 * I + 1] += interpolated(dim, &w, I, 2 * I + 1, 1);
  }
  if (odd_end) w.e[2 * n] += interpolated(dim, &w, n, 2 * n, -1);
}

CF_KERNEL void spread_single(const int dim, const int n, const spread *s, const int unused) {
  (void)unused;
  const spread w = *s;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) w.e[i] += interpolated(dim, &w, i, i, 0);
}

CF_CLONED(spread_pairs, const spread *, const int)
CF_CLONED(spread_single, const spread *, const int)

/* Cells that alpha holds take no correction: next to it a wrong one of theirs would be a large residual. */
CF_CLONES static void keep_held_row(const int n, const float *r, const float *inverse, const float *free,
                                    float *e) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) e[i] = free[i] * inverse[i] > 0.99f ? inverse[i] * r[i] : e[i];
}

/* The coarse neighbour of fine index i on its side: -1, 1, or 0 where the axis is not coarsened. */
static int side_of(const cf_coupled *l, const int a, const int i) {
  return !l->coarsened[a] ? 0 : i % 2 == 0 ? -1 : 1;
}

void cf_coupled_prolong(const cf_coupled *coarse, const cf_coupled *l) {
  const cf_box *c = &coarse->box;
  cf_coupled_wrap(coarse, coarse->e);
  correct_odds(coarse, l);
  CF_PARALLEL_COUPLED (l, v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run) {
        const int x = l->coarsened[0], n = run->high - run->low;
        const float *own =
            coarse->e + cf_box_at(c, run->low >> x, j >> l->coarsened[1], k >> l->coarsened[2]);
        const ptrdiff_t p = cf_box_at(&l->box, run->low, j, k);
        const spread s = {
            .own = own,
            .y = own + side_of(l, 1, j) * c->stride[1],
            .z = l->dim == 3 ? own + side_of(l, 2, k) * c->stride[2] : own,
            .weight = {l->weight[0] + p, l->weight[1] + p, l->dim == 3 ? l->weight[2] + p : NULL},
            .e = l->e + p};
        if (x)
          spread_pairs_by_dim(l->dim, n / 2, &s, n % 2);
        else
          spread_single_by_dim(l->dim, n, &s, 0);
        if (l->is_gentle) keep_held_row(n, l->r + p, l->inverse + p, l->free + p, l->e + p);
      }
  for (ptrdiff_t v = 0; v < l->odds; ++v) l->e[l->odd_cell[v]] = l->odd_value[v];
}

/* --- from couplings to what the sweeps need ----------------------------------------------------------- */

static void invert_row(const cf_coupled *l, const cf_run *run, const int j, const int k) {
  for (int i = run->low; i < run->high; ++i) {
    const ptrdiff_t p = cf_box_at(&l->box, i, j, k);
    float d = l->free[p] + l->held[p];
    for (int a = 0; a < l->dim; ++a) d += l->c[a][p] + l->c[a][p + l->box.stride[a]];
    l->inverse[p] = d > 0 ? 1 / d : 0;
  }
}

/* Whether a face of the cell is closed or held; the walls of the box are smooth and do not count. */
static bool is_at_edge(const cf_coupled *l, const int at[3], const ptrdiff_t p) {
  for (int a = 0; a < l->dim; ++a) {
    const ptrdiff_t s = l->box.stride[a];
    if ((at[a] > 0 || l->periodic[a]) && l->c[a][p] == 0) return true;
    if ((at[a] < l->box.n[a] - 1 || l->periodic[a]) && l->c[a][p + s] == 0) return true;
  }
  return false;
}

/* The cells at an edge and their neighbours. `rest` serves as the mark. */
static bool is_in_band(const cf_coupled *l, const ptrdiff_t p) {
  if (l->rest[p] > 0) return true;
  for (int a = 0; a < l->dim; ++a) {
    const ptrdiff_t s = l->box.stride[a];
    if ((l->c[a][p] > 0 && l->rest[p - s] > 0) || (l->c[a][p + s] > 0 && l->rest[p + s] > 0)) return true;
  }
  return false;
}

static cf_status grow(ptrdiff_t **list, ptrdiff_t *room, const ptrdiff_t count) {
  if (count < *room) return CF_OK;
  ptrdiff_t *more;
  CF_TRY(CF_NEW(&more, 2 * *room + 1024));
  if (*list != NULL) memcpy(more, *list, (size_t)count * sizeof *more);
  cf_free(*list);
  *list = more;
  *room = 2 * *room + 1024;
  return CF_OK;
}

static cf_status collect_band(cf_coupled *l) {
  l->bands[0] = l->bands[1] = 0;
  for (ptrdiff_t v = 0; v < l->rows; ++v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run)
        for (int i = run->low; i < run->high; ++i) {
          const ptrdiff_t p = cf_box_at(&l->box, i, j, k);
          if (!cf_coupled_has(l, p) || !is_in_band(l, p)) continue;
          const int colour = (i + j + k) & 1;
          CF_TRY(grow(&l->band[colour], &l->band_room[colour], l->bands[colour]));
          l->band[colour][l->bands[colour]++] = p;
        }
  return CF_OK;
}

cf_status cf_coupled_finish(cf_coupled *l) {
  for (int a = 0; a < l->dim; ++a)
    if (l->periodic[a]) wrap_axis(l, a, l->c[a]);
  int edges = 0, heavy = 0;
#pragma omp parallel for schedule(static) num_threads(cf_coupled_threads(l)) reduction(| : edges, heavy)
  for (ptrdiff_t v = 0; v < l->rows; ++v)
    CF_TILE_ROWS (l, v, j, k)
      CF_TILE_RUNS (l, v, run) {
        invert_row(l, run, j, k);
        for (int i = run->low; i < run->high; ++i) {
          const ptrdiff_t p = cf_box_at(&l->box, i, j, k);
          const bool edge = cf_coupled_has(l, p) && is_at_edge(l, (int[]){i, j, k}, p);
          l->rest[p] = edge ? 1 : 0;
          edges |= edge;
          heavy |= l->free[p] * l->inverse[p] > 0.3f;
        }
      }
  l->is_gentle = heavy;
  l->bands[0] = l->bands[1] = 0;
  if (!edges) return CF_OK;
  cf_coupled_wrap(l, l->rest);
  CF_TRY(collect_band(l));
  for (int a = 0; a < l->dim; ++a) /* what the wrap has left in ghosts */
    if (l->periodic[a]) {
      CF_PARALLEL_COUPLED (l, v)
        CF_TILE_ROWS (l, v, j, k)
          CF_TILE_RUNS (l, v, run)
            memset(l->rest + cf_box_at(&l->box, run->low, j, k), 0,
                   (size_t)(run->high - run->low) * sizeof(float));
      cf_coupled_wrap(l, l->rest);
      break;
    }
  return CF_OK;
}
