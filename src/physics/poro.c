/* SPDX-License-Identifier: MIT
 *
 * One step: from the nodes of blocks to fields on the lattice, what each cell is, what each face conducts, the stages,
 * and back to the nodes.
 */
#include "physics/poro.h"

#include <limits.h>
#include <math.h>

#include "base/mem.h"
#include "physics/poro_part.h"

static const double SDIRK_GAMMA = 0.29289321881345254; /* 1 - 1/sqrt 2 */

/* --- the object -------------------------------------------------------------------------------------------- */

/* All of them; the last ones are made where there is a mixture. */
#define FIELDS      12
#define FACES       3
#define MIXED_CELLS 2
#define MIXED_FACES 2
static void list_fields(cf_poro *w, cf_cell *list[FIELDS]) {
  cf_cell *all[FIELDS] = {&w->C,     &w->m,     &w->A,  &w->fill, &w->S, &w->b,
                          &w->alpha, &w->value, &w->m0, &w->A0,   &w->k, &w->k_now};
  for (int i = 0; i < FIELDS; ++i) list[i] = all[i];
}
static void list_faces(cf_poro *w, cf_face *list[FACES]) {
  cf_face *all[FACES] = {&w->beta, &w->kappa, &w->kappa_now};
  for (int i = 0; i < FACES; ++i) list[i] = all[i];
}

static cf_status fill_in(cf_poro *w) {
  const cf_walls walls = {0};
  cf_cell *list[FIELDS];
  cf_face *faces[FACES];
  const bool mixed = w->p.mixture != NULL;
  CF_TRY(cf_tiles_create(&w->tiles, &w->grid->box, NULL));
  list_fields(w, list);
  list_faces(w, faces);
  for (int i = 0; i < (mixed ? FIELDS : FIELDS - MIXED_CELLS); ++i)
    CF_TRY(cf_tiles_cell_create(w->tiles, list[i]));
  for (int i = 0; i < (mixed ? FACES : FACES - MIXED_FACES); ++i)
    CF_TRY(cf_tiles_face_create(w->tiles, faces[i]));
  CF_TRY(cf_pages_reserve((void **)&w->kind, (size_t)w->grid->box.size, false));
  CF_TRY(cf_pages_reserve((void **)&w->wet, (size_t)w->grid->box.size, false));
  CF_TRY(CF_NEW(&w->rows, cf_box_rows(&w->grid->box)));
  CF_TRY(cf_region_create_on(&w->region, w->grid, w->tiles));
  return cf_helmholtz_create(&w->solver, w->grid, &walls, 0);
}

cf_status cf_poro_create(cf_poro **w, const cf_grid *lattice, const cf_poro_params *p) {
  *w = NULL;
  if (!(p->k >= 0 && isfinite(p->k))) return cf_fail(CF_BAD_ARGUMENT, "k = %g: must be >= 0", p->k);
  if (!(p->tau >= 0 && isfinite(p->tau))) return cf_fail(CF_BAD_ARGUMENT, "tau = %g s: must be >= 0", p->tau);
  if (!(p->f_t >= 0 && p->f_t <= 1))
    return cf_fail(CF_BAD_ARGUMENT, "f_t = %g: must be between 0 and 1", p->f_t);
  cf_poro *fresh;
  CF_TRY(CF_NEW(&fresh, 1));
  fresh->grid = lattice;
  fresh->p = *p;
  const cf_status s = fill_in(fresh);
  if (s != CF_OK) {
    cf_poro_destroy(fresh);
    return s;
  }
  *w = fresh;
  return CF_OK;
}

void cf_poro_destroy(cf_poro *w) {
  if (w == NULL) return;
  cf_cell *list[FIELDS];
  cf_face *faces[FACES];
  list_fields(w, list);
  list_faces(w, faces);
  for (int i = 0; i < FIELDS; ++i) cf_cell_destroy(list[i], &w->grid->box);
  for (int i = 0; i < FACES; ++i) cf_face_destroy(faces[i], &w->grid->box);
  cf_pages_release(w->kind, (size_t)w->grid->box.size);
  cf_pages_release(w->wet, (size_t)w->grid->box.size);
  cf_helmholtz_destroy(w->solver);
  cf_region_destroy(w->region);
  cf_tiles_destroy(w->tiles);
  cf_free(w->rows);
  cf_free(w);
}

double cf_poro_filter_rate(const double k, const double tau, const double f_t, const double h) {
  const double K2 = 16 / (h * h), b = 1 + f_t * tau * k * K2, under = b * b - 4 * tau * k * K2;
  if (under < 0) return b / (2 * tau);
  return 2 * k * K2 / (b + sqrt(under));
}

/* --- between nodes and fields ------------------------------------------------------------------------------ */

/* The tiles with nodes of block b that are part of a body: blocks have one more layer around the particles than these
 * reach. */
static void add_tiles(cf_poro *w, const cf_nodes *nodes, const int32_t b) {
  int low[3] = {INT_MAX, INT_MAX, INT_MAX}, high[3] = {0, 0, 0};
  for (int n = 0; n < CF_BLOCK_NODES; ++n) {
    int cell[3];
    if (!((double)nodes->at[(ptrdiff_t)b * CF_BLOCK_NODES + n][CF_NODE_FILL] > CF_PORO_LEAST_FILL)) continue;
    cf_nodes_cell(nodes, &nodes->block[b], n, cell);
    for (int a = 0; a < 3; ++a) {
      low[a] = CF_MIN(low[a], cell[a]);
      high[a] = CF_MAX(high[a], cell[a] + 1);
    }
  }
  if (low[0] < high[0]) cf_tiles_add_box(w->tiles, low, high);
}

/* The tiles of this step; fields become 0 where tiles are new or cells may have been left. */
static cf_status follow(cf_poro *w, const cf_nodes *nodes) {
  cf_cell *list[FIELDS];
  cf_face *faces[FACES];
  cf_tiles_drop_all(w->tiles);
  if (w->p.dense) cf_tiles_add_box(w->tiles, (int[3]){0, 0, 0}, w->grid->box.n);
  for (int32_t b = 0; b < nodes->count && !w->p.dense; ++b) add_tiles(w, nodes, b);
  CF_TRY(cf_tiles_update(w->tiles));
  list_fields(w, list);
  list_faces(w, faces);
  for (int i = 0; i < FIELDS; ++i)
    if (list[i]->at != NULL) cf_tiles_retire_cell(w->tiles, *list[i]);
  for (int i = 0; i < FACES; ++i)
    if (faces[i]->at[0] != NULL) cf_tiles_retire_face(w->tiles, *faces[i]);
  cf_tiles_retire_bytes(w->tiles, w->kind + w->grid->box.first, 1);
  cf_tiles_retire_bytes(w->tiles, w->wet + w->grid->box.first, 1);
  cf_region_retire(w->region);
  return CF_OK;
}

static void clear(const cf_poro *w) {
  const cf_tiles *t = w->tiles;
  CF_PARALLEL_TILES (t, w->grid->threads, r)
    CF_TILE_ROWS (t, r, j, k)
      CF_TILE_RUNS (t, r, run) {
        const ptrdiff_t p = cf_box_at(&w->grid->box, run->low, j, k);
        const size_t bytes = sizeof(cf_real) * (size_t)(run->high - run->low);
        memset(w->C.at + p, 0, bytes);
        memset(w->m.at + p, 0, bytes);
        memset(w->A.at + p, 0, bytes);
        memset(w->fill.at + p, 0, bytes);
      }
}

/* Element p of the lattice for node n of a block; false beyond the lattice. */
static bool lattice_at(const cf_poro *w, const cf_nodes *nodes, const cf_block *b, const int n,
                       ptrdiff_t *p) {
  int cell[3];
  cf_nodes_cell(nodes, b, n, cell);
  const cf_box *box = &w->grid->box;
  *p = cf_box_at(box, cell[0], cell[1], cell[2]);
  return cell[0] < box->n[0] && cell[1] < box->n[1] && cell[2] < box->n[2];
}

static void fetch(const cf_poro *w, const cf_nodes *nodes) {
  CF_PARALLEL_BLOCKS(nodes, w->grid->threads, b)
  for (int n = 0; n < CF_BLOCK_NODES; ++n) {
    ptrdiff_t p;
    const cf_lanes *node = &nodes->at[(ptrdiff_t)b * CF_BLOCK_NODES + n];
    if (!((*node)[CF_NODE_FILL] > (cf_real)CF_PORO_LEAST_FILL) ||
        !lattice_at(w, nodes, &nodes->block[b], n, &p))
      continue;
    w->C.at[p] = (*node)[CF_NODE_CAPACITY];
    w->m.at[p] = (*node)[CF_NODE_WATER];
    w->A.at[p] = (*node)[CF_NODE_MEMORY];
    w->fill.at[p] = (*node)[CF_NODE_FILL];
    if (w->p.mixture == NULL) continue;
    const cf_lanes *of = &w->p.mixture[(ptrdiff_t)b * CF_BLOCK_NODES + n];
    w->k.at[p] = (*of)[0] > 0 ? (*of)[1] / (*of)[0] : 0;
    w->k_now.at[p] = (*of)[0] > 0 ? (*of)[2] / (*of)[0] : 0;
  }
}

/* What the particles will gather; m0 and A0 are what the nodes had. */
static void give(const cf_poro *w, const cf_nodes *nodes) {
  CF_PARALLEL_BLOCKS(nodes, w->grid->threads, b)
  for (int n = 0; n < CF_BLOCK_NODES; ++n) {
    ptrdiff_t p;
    cf_lanes *node = &nodes->at[(ptrdiff_t)b * CF_BLOCK_NODES + n];
    const bool there =
        lattice_at(w, nodes, &nodes->block[b], n, &p) && w->kind[p + w->grid->box.first] != CF_PORO_NONE;
    const bool held = there && !cf_poro_is_free(w, p);
    (*node)[CF_NODE_WATER] = there ? (w->m.at[p] - w->m0.at[p]) / w->C.at[p] : 0;
    (*node)[CF_NODE_MEMORY] = there ? (w->A.at[p] - w->A0.at[p]) / w->C.at[p] : 0;
    (*node)[CF_NODE_FILL] = held ? 1 : 0;
    (*node)[CF_NODE_CAPACITY] = held ? w->value.at[p] : 0;
  }
}

/* --- stages ------------------------------------------------------------------------------------------------ */

/* What the held cells around free cell p bring, with k = 1: the sum of kappa, and of kappa times their values. */
typedef struct held_sum {
  double conductance, value;
} held_sum;

static held_sum held_around(const cf_poro *w, const ptrdiff_t p) {
  const cf_box *box = &w->grid->box;
  const unsigned char *kind = w->kind + box->first;
  held_sum sum = {0, 0};
  for (int a = 0; a < box->dim; ++a)
    for (int side = -1; side <= 1; side += 2) {
      const ptrdiff_t q = p + side * box->stride[a];
      if (kind[q] < CF_PORO_HELD_SURFACE) continue;
      const double kappa = cf_poro_to_held(w, p, q);
      sum.conductance += kappa, sum.value += kappa * (double)w->value.at[q];
    }
  return sum;
}

/* Whether a free cell may have held ones around it. */
static bool is_near(const cf_poro *w, const ptrdiff_t p) {
  return w->kind[p + w->grid->box.first] == CF_PORO_NEAR;
}

/* A cell's beta over the kappa that it would have with k = 1. */
static double beta_of(const cf_poro *w, const ptrdiff_t p) {
  return w->slow * cf_poro_k(w, p) + w->fast * cf_poro_k_now(w, p);
}

/* alpha, which no stage changes. */
static void make_alpha(const cf_poro *w) {
  FOR_CELLS(w, p) {
    const bool free = cf_poro_is_free(w, p);
    w->alpha.at[p] = free ? w->C.at[p] : (cf_real)1;
    if (free && is_near(w, p)) w->alpha.at[p] += (cf_real)(beta_of(w, p) * held_around(w, p).conductance);
  }
  END_CELLS
}

/* b and the guess of S. left: tau d/(tau + d). */
static void make_right_side(const cf_poro *w, const double left) {
  FOR_CELLS(w, p) {
    w->b.at[p] = 0;
    if (!cf_poro_is_free(w, p)) {
      w->S.at[p] = w->kind[p + w->grid->box.first] == CF_PORO_NONE ? 0 : w->value.at[p];
      continue;
    }
    double sum = (double)w->m.at[p] - left * (double)w->A.at[p];
    if (is_near(w, p)) sum += beta_of(w, p) * held_around(w, p).value;
    w->b.at[p] = (cf_real)sum;
    w->S.at[p] = w->m.at[p] / w->C.at[p];
  }
  END_CELLS
}

/* L S, and its part L_F S. */
typedef struct conducted {
  double all, now;
} conducted;

static double through_faces(const cf_poro *w, const cf_face kappa, const ptrdiff_t p) {
  const double S = (double)w->S.at[p];
  double L = 0;
  for (int a = 0; a < w->grid->box.dim; ++a) {
    const ptrdiff_t s = w->grid->box.stride[a];
    L += (double)kappa.at[a][p + s] * ((double)w->S.at[p + s] - S) +
         (double)kappa.at[a][p] * ((double)w->S.at[p - s] - S);
  }
  return L;
}

static conducted conducted_to(const cf_poro *w, const ptrdiff_t p) {
  conducted L;
  if (w->p.mixture == NULL) {
    L.all = w->scale > 0 ? through_faces(w, w->beta, p) / w->scale : 0;
    L.now = w->p.f_t * L.all;
  } else {
    L.all = through_faces(w, w->kappa, p);
    L.now = through_faces(w, w->kappa_now, p);
  }
  if (!is_near(w, p)) return L;
  const held_sum held = held_around(w, p);
  const double from_held = held.value - held.conductance * (double)w->S.at[p];
  L.all += cf_poro_k(w, p) * from_held;
  L.now += cf_poro_k_now(w, p) * from_held;
  return L;
}

static void finish_stage(const cf_poro *w, const double d) {
  const cf_box *box = &w->grid->box;
  const double tau = w->p.tau;
  FOR_CELLS(w, p) {
    if (w->kind[p + box->first] == CF_PORO_NONE) continue;
    if (!cf_poro_is_free(w, p)) {
      w->m.at[p] = w->C.at[p] * w->value.at[p];
      w->A.at[p] *= (cf_real)(tau / (tau + d));
      continue;
    }
    const conducted L = conducted_to(w, p);
    const double A = (tau * (double)w->A.at[p] - d * (L.all - L.now)) / (tau + d);
    w->m.at[p] = (cf_real)((double)w->m.at[p] - d * (A - L.now));
    w->A.at[p] = (cf_real)A;
  }
  END_CELLS
}

static cf_status stage(cf_poro *w, const double t, const double d, cf_solve_report *report) {
  const double tau = w->p.tau;
  cf_solve_report one;
  cf_poro_add_rates(w, t + d, d);
  make_right_side(w, tau > 0 ? tau * d / (tau + d) : 0);
  CF_TRY(cf_helmholtz_solve(w->solver, w->b, &w->p.solver, w->S, &one));
  finish_stage(w, d);
  report->iterations += one.iterations;
  report->levels = one.levels;
  report->residual = CF_MAX(report->residual, one.residual);
  report->converged = report->converged && one.converged;
  return CF_OK;
}

/* y* = -sqrt2 y + (1 + sqrt2) Y1. */
static void extrapolate(const cf_poro *w) {
  const cf_real a = (cf_real)-1.4142135623730951, b = (cf_real)2.4142135623730951;
  FOR_CELLS(w, p) {
    w->m.at[p] = a * w->m0.at[p] + b * w->m.at[p];
    w->A.at[p] = a * w->A0.at[p] + b * w->A.at[p];
  }
  END_CELLS
}

static void keep(const cf_poro *w) {
  FOR_CELLS(w, p) {
    w->m0.at[p] = w->m.at[p];
    w->A0.at[p] = w->A.at[p];
  }
  END_CELLS
}

static double gained_by_nodes(const cf_poro *w) {
  const cf_box *box = &w->grid->box;
  CF_PARALLEL_TILES (w->tiles, w->grid->threads, r)
    CF_TILE_ROWS (w->tiles, r, j, k) {
      double sum = 0;
      CF_TILE_RUNS (w->tiles, r, run)
        for (ptrdiff_t p = cf_box_at(box, run->low, j, k); p < cf_box_at(box, run->high, j, k); ++p)
          sum += (double)w->m.at[p] - (double)w->m0.at[p];
      w->rows[j + (ptrdiff_t)k * box->n[1]] = sum;
    }
  return cf_tiles_sum_rows(w->tiles, w->rows);
}

/* The length of the stages of a step, and what follows from it: beta = d^2/(tau + d) kappa + d tau/(tau + d) kappa_F. */
static cf_status set_stage(cf_poro *w, const double d) {
  const double tau = w->p.tau, h2 = w->grid->h * w->grid->h;
  w->slow = d * d / (tau + d);
  w->fast = d * tau / (tau + d);
  w->scale = d * (d + w->p.f_t * tau) / (tau + d) * h2;
  cf_poro_set_faces(w);
  make_alpha(w);
  return cf_helmholtz_set(
      w->solver, &(cf_coefficients){.alpha_at = &w->alpha, .beta_at = &w->beta, .region = w->region});
}

cf_status cf_poro_step(cf_poro *w, cf_nodes *nodes, const double t, const double dt, double *gained,
                       cf_solve_report *report) {
  const double d = w->p.two_stages ? SDIRK_GAMMA * dt : dt;
  *report = (cf_solve_report){.converged = true};
  CF_TRY(follow(w, nodes));
  clear(w);
  fetch(w, nodes);
  CF_TRY(cf_poro_find_cells(w, t + dt));
  keep(w);
  CF_TRY(set_stage(w, d));
  CF_TRY(stage(w, t, d, report));
  if (w->p.two_stages) {
    extrapolate(w);
    CF_TRY(stage(w, t + dt - d, d, report));
  }
  *gained = gained_by_nodes(w);
  cf_poro_note_given(w, t + dt, dt, *gained);
  give(w, nodes);
  return CF_OK;
}
