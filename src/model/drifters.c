/* SPDX-License-Identifier: MIT
 *
 * A life of points: state, moves, births in a region or through a wall. Three ways to begin:
 *
 *     count      number k of a sequence that fills the box evenly (multiples of the inverse powers of the root of
 *                g^(d+1) = g + 1, after M. Roberts), those taken that lie within the shape
 *     per_cell   the first so many of that sequence in every cell, shifted at random from cell to cell
 *     rate       at random, one whenever rate (t - from) passes a whole number
 *
 * and through a wall each face gets per_cell u_n dt/h points on average, at random places and times.
 */
#include "model/drifters.h"

#include <math.h>
#include <stdio.h>

#include "base/mem.h"
#include "base/rng.h"
#include "grid/wall.h"
#include "model/flow_part.h"
#include "model/scene_check.h"

/* Moves between two times that points are put in order. */
#define SORT_EVERY 8
/* A region is empty if so many places in a row were none. */
#define TRIES 1000000

/* Streams of random numbers, of each entry: 8 i + which. */
enum { STREAM_PLACE, STREAM_CHANCE = 3, STREAM_SHIFT, STREAM_WALL, STREAMS = 8 };

/* --- state ------------------------------------------------------------------------------------------------ */

cf_status cf_drifters_create(cf_drifters *d, const cf_scene *scene, const cf_grid *g) {
  d->scene = scene;
  d->grid = g;
  d->source = -1;
  if (scene->points.count == 0) return CF_OK;
  CF_TRY(CF_NEW(&d->given, scene->points.count));
  CF_TRY(cf_particles_create(&d->set, "points", g->box.dim, 1024));
  CF_TRY(cf_particles_attribute(d->set, "born", "s", 1, CF_CARRIED, &d->born));
  if (scene->points.count > 1)
    CF_TRY(cf_particles_attribute(d->set, "source", "", 1, CF_CARRIED, &d->source));
  return cf_particles_attribute(d->set, "velocity", "m/s", g->box.dim, CF_DERIVED, &d->velocity);
}

void cf_drifters_destroy(cf_drifters *d) {
  cf_particles_destroy(d->set);
  cf_free(d->given);
}

static cf_status add(cf_drifters *d, const int entry, const double born, const double x[3]) {
  int64_t i;
  CF_TRY(cf_particles_append(d->set, 1, &i));
  for (int a = 0; a < d->grid->box.dim; ++a) d->set->attribute[CF_PARTICLE_POSITION].at[a][i] = (cf_real)x[a];
  d->set->attribute[d->born].at[0][i] = (cf_real)born;
  if (d->source >= 0) d->set->attribute[d->source].at[0][i] = (cf_real)entry;
  return CF_OK;
}

/* --- places ----------------------------------------------------------------------------------------------- */

static const cf_scene_points *entry_of(const cf_drifters *d, const int entry) {
  return &d->scene->points.item[entry];
}

static double chance(const cf_drifters *d, const int entry, const int which, const int64_t step,
                     const int64_t number) {
  return cf_random((uint64_t)entry_of(d, entry)->seed, (uint64_t)(STREAMS * entry + which), (uint64_t)step,
                   (uint64_t)number);
}

/* Number k of the sequence along axis a, in [0, 1), shifted. */
static double evenly(const int dim, const int a, const int64_t k, const double shift) {
  static const double step[2][3] = {{0.75487766624669276, 0.56984029099805327, 0},
                                    {0.81917251339616444, 0.67104360670378921, 0.54970047790197027}};
  const double at = shift + (double)(k + 1) * step[dim - 2][a];
  return at - floor(at);
}

/* Whether x lies within the shape, but for the axis `across` (-1: none). */
static bool is_inside(const cf_scene_points *p, const int dim, const int across, const double x[3]) {
  double square = 0;
  for (int a = 0; a < dim && p->shape != CF_POINTS_EVERYWHERE; ++a) {
    if (a == across) continue;
    const double away = x[a] - p->center.value[a];
    if (p->shape == CF_POINTS_BOX && fabs(away) > p->half.value[a]) return false;
    square += away * away;
  }
  return p->shape != CF_POINTS_SPHERE || square <= p->radius * p->radius;
}

/* Whether a place gets its point: `luck` in [0, 1) is below what `where` says. */
static bool is_taken(const cf_drifters *d, const int entry, const int across, const double luck,
                     const double x[3]) {
  const cf_scene_points *p = entry_of(d, entry);
  if (!is_inside(p, d->grid->box.dim, across, x)) return false;
  return luck < cf_fn_at(&p->where.fn, x[0], x[1], x[2], 0);
}

/* The part of the box that the shape is in. */
static void bounds_of(const cf_drifters *d, const cf_scene_points *p, double low[3], double high[3]) {
  for (int a = 0; a < 3; ++a) {
    low[a] = d->grid->origin[a];
    high[a] = a < d->grid->box.dim ? low[a] + d->grid->box.n[a] * d->grid->h : low[a];
    if (p->shape == CF_POINTS_EVERYWHERE || a >= d->grid->box.dim) continue;
    const double reach = p->shape == CF_POINTS_BOX ? p->half.value[a] : p->radius;
    low[a] = CF_MAX(low[a], p->center.value[a] - reach);
    high[a] = CF_MIN(high[a], p->center.value[a] + reach);
  }
}

static cf_status fail_empty(const cf_drifters *d, const int entry) {
  char key[32];
  snprintf(key, sizeof key, "points.%d", entry);
  return cf_scene_fail_at(d->scene, key,
                          "%s: no place was found for a point: the shape lies outside the box, or `where` is "
                          "0 in it",
                          key);
}

/* --- births in a region ----------------------------------------------------------------------------------- */

static cf_status fill_count(cf_drifters *d, const int entry, const double born) {
  const cf_scene_points *p = entry_of(d, entry);
  const int dim = d->grid->box.dim;
  double low[3], high[3], shift[3], x[3] = {0, 0, 0};
  bounds_of(d, p, low, high);
  for (int a = 0; a < dim; ++a) {
    shift[a] = chance(d, entry, STREAM_SHIFT, 0, a);
    if (low[a] >= high[a]) return fail_empty(d, entry);
  }
  for (int64_t k = 0, made = 0, last = 0; made < p->count; ++k) {
    if (k - last > TRIES) return fail_empty(d, entry);
    for (int a = 0; a < dim; ++a) x[a] = low[a] + (high[a] - low[a]) * evenly(dim, a, k, shift[a]);
    if (!is_taken(d, entry, -1, chance(d, entry, STREAM_CHANCE, 0, k), x)) continue;
    CF_TRY(add(d, entry, born, x));
    last = k;
    ++made;
  }
  return CF_OK;
}

static cf_status fill_cell(cf_drifters *d, const int entry, const double born, const int at[3]) {
  const cf_scene_points *p = entry_of(d, entry);
  const int dim = d->grid->box.dim;
  const int64_t cell = cf_box_at(&d->grid->box, at[0], at[1], at[2]);
  for (int k = 0; k < p->per_cell; ++k) {
    double x[3] = {0, 0, 0};
    for (int a = 0; a < dim; ++a) {
      const double shift = chance(d, entry, STREAM_SHIFT, a, cell);
      x[a] = d->grid->origin[a] + (at[a] + evenly(dim, a, k, shift)) * d->grid->h;
    }
    if (is_taken(d, entry, -1, chance(d, entry, STREAM_CHANCE, k, cell), x)) CF_TRY(add(d, entry, born, x));
  }
  return CF_OK;
}

static cf_status fill_cells(cf_drifters *d, const int entry, const double born) {
  double low[3], high[3];
  int from[3], to[3];
  const int64_t before = d->set->count;
  bounds_of(d, entry_of(d, entry), low, high);
  for (int a = 0; a < 3; ++a) {
    const int n = d->grid->box.n[a];
    from[a] = (int)CF_MAX(0, CF_MIN(n, floor((low[a] - d->grid->origin[a]) / d->grid->h)));
    to[a] = a < d->grid->box.dim ? (int)CF_MIN(n, ceil((high[a] - d->grid->origin[a]) / d->grid->h)) : 1;
  }
  for (int k = from[2]; k < to[2]; ++k)
    for (int j = from[1]; j < to[1]; ++j)
      for (int i = from[0]; i < to[0]; ++i) CF_TRY(fill_cell(d, entry, born, (int[3]){i, j, k}));
  return d->set->count > before ? CF_OK : fail_empty(d, entry);
}

static double ended(const cf_drifters *d, const cf_scene_points *p) {
  return p->given.to ? p->to : d->scene->time.end;
}

/* Number k of a rate is due when rate (t - from) = k + 1; `given` says how many have come. */
static cf_status fill_rate(cf_drifters *d, const int entry, const double until) {
  const cf_scene_points *p = entry_of(d, entry);
  const double to = CF_MIN(until, ended(d, p));
  double low[3], high[3], x[3] = {0, 0, 0};
  bounds_of(d, p, low, high);
  const double due = floor(p->rate * (to - p->from) + 1e-9);
  for (int64_t k = (int64_t)d->given[entry]; (double)k < due; ++k) {
    bool taken = false;
    for (int64_t n = 0; n < TRIES && !taken; ++n) {
      for (int a = 0; a < d->grid->box.dim; ++a)
        x[a] = low[a] + (high[a] - low[a]) * chance(d, entry, STREAM_PLACE + a, n, k);
      taken = is_taken(d, entry, -1, chance(d, entry, STREAM_CHANCE, n, k), x);
    }
    if (!taken) return fail_empty(d, entry);
    CF_TRY(add(d, entry, CF_MIN(until, p->from + (double)(k + 1) / p->rate), x));
    d->given[entry] += 1;
  }
  return CF_OK;
}

/* --- births at a wall ------------------------------------------------------------------------------------- */

typedef struct inlet {
  int entry, axis, side, other[2];
  double t, dt;
} inlet;

/* What comes in through one face of the wall. */
static cf_status fill_face(cf_drifters *d, const inlet *w, const cf_drift *flow, const int at[3]) {
  const cf_scene_points *p = entry_of(d, w->entry);
  const cf_grid *g = d->grid;
  const ptrdiff_t face = cf_box_at(&g->box, at[0], at[1], at[2]);
  const double u = (double)flow->u[2].at[w->axis][face] * (w->side == 0 ? 1 : -1);
  const double wish = (double)p->per_cell * u * w->dt / g->h;
  if (!(wish > 0) || !(wish < 1e9)) return CF_OK;
  const int64_t count = (int64_t)floor(wish + chance(d, w->entry, STREAM_WALL, d->moves, 4 * face + 3));
  for (int64_t k = 0; k < count; ++k) {
    double x[3] = {0, 0, 0};
    x[w->axis] = g->origin[w->axis] + at[w->axis] * g->h;
    for (int o = 0; o < g->box.dim - 1; ++o) {
      const double share = evenly(g->box.dim, o, k, chance(d, w->entry, STREAM_WALL, d->moves, 4 * face + o));
      x[w->other[o]] = g->origin[w->other[o]] + (at[w->other[o]] + share) * g->h;
    }
    const double late =
        evenly(g->box.dim, g->box.dim - 1, k, chance(d, w->entry, STREAM_WALL, d->moves, 4 * face + 2));
    if (is_taken(d, w->entry, w->axis, chance(d, w->entry, STREAM_CHANCE, d->moves, face + k), x))
      CF_TRY(add(d, w->entry, w->t + late * w->dt, x));
  }
  return CF_OK;
}

static cf_status fill_wall(cf_drifters *d, const int entry, const cf_drift *flow, const double t,
                           const double dt) {
  const cf_scene_points *p = entry_of(d, entry);
  const double from = CF_MAX(t, p->from), to = CF_MIN(t + dt, ended(d, p));
  inlet w = {.entry = entry, .t = from, .dt = to - from};
  if (to <= from || !cf_flow_side(p->wall, &w.axis, &w.side)) return CF_OK;
  const int *n = d->grid->box.n;
  w.other[0] = w.axis == 0 ? 1 : 0, w.other[1] = w.axis == 2 ? 1 : 2;
  for (int j = 0; j < n[w.other[1]]; ++j)
    for (int i = 0; i < n[w.other[0]]; ++i) {
      int at[3] = {0, 0, 0};
      at[w.axis] = w.side == 0 ? 0 : n[w.axis];
      at[w.other[0]] = i, at[w.other[1]] = j;
      CF_TRY(fill_face(d, &w, flow, at));
    }
  return CF_OK;
}

/* --- a step ----------------------------------------------------------------------------------------------- */

/* At once: those whose time is after t (or at it, where the run begins) and not after `until`. */
static cf_status fill_at_once(cf_drifters *d, const double t, const double until, const bool begins) {
  for (int i = 0; i < d->scene->points.count; ++i) {
    const cf_scene_points *p = entry_of(d, i);
    if (p->given.wall || p->given.rate || p->from > until || (begins ? p->from > t : p->from <= t)) continue;
    CF_TRY(p->given.count ? fill_count(d, i, p->from) : fill_cells(d, i, p->from));
  }
  return CF_OK;
}

static cf_status be_born(cf_drifters *d, const cf_drift *flow, const double t, const double dt) {
  const int64_t first = d->set->count;
  CF_TRY(fill_at_once(d, t, t + dt, false));
  for (int i = 0; i < d->scene->points.count; ++i) {
    if (entry_of(d, i)->given.rate) CF_TRY(fill_rate(d, i, t + dt));
    if (entry_of(d, i)->given.wall) CF_TRY(fill_wall(d, i, flow, t, dt));
  }
  cf_drift_move_born(flow, t + dt, d->born, d->set, first);
  return CF_OK;
}

/* Newton's steps along the normal: interpolation may let a point in by a part of a cell. */
static void put_out(const cf_drifters *d, const int64_t i) {
  const cf_grid *g = d->grid;
  cf_real *const *at = d->set->attribute[CF_PARTICLE_POSITION].at;
  double x[3] = {0, 0, 0}, n[3];
  for (int a = 0; a < g->box.dim; ++a) {
    x[a] = (double)at[a][i];
    if (!(x[a] >= g->origin[a] && x[a] <= g->origin[a] + g->box.n[a] * g->h)) return;
  }
  double away = cf_obstacles_distance(d->solids, x);
  for (int pass = 0; pass < 4 && away < 0; ++pass) {
    cf_obstacles_normal(d->solids, x, 0.05 * g->h, n);
    for (int a = 0; a < g->box.dim; ++a) x[a] += n[a] * (1e-3 * g->h - away);
    away = cf_obstacles_distance(d->solids, x);
  }
  for (int a = 0; a < g->box.dim; ++a) {
    const double high = g->origin[a] + g->box.n[a] * g->h;
    at[a][i] = (cf_real)CF_MIN(high, CF_MAX(g->origin[a], x[a]));
  }
}

static void put_out_of_solids(const cf_drifters *d) {
  if (d->solids == NULL || d->solids->count == 0) return;
#pragma omp parallel for schedule(static) num_threads(d->grid->threads)
  for (int64_t i = 0; i < d->set->count; ++i) put_out(d, i);
}

static void remove_those_out(cf_drifters *d) {
  const int64_t before = d->set->count;
  cf_particles_remove(d->set, d->grid->threads);
  d->left += (double)(before - d->set->count);
}

cf_status cf_drifters_start(cf_drifters *d, cf_registry *r) {
  if (d->set == NULL) return CF_OK;
  CF_TRY(fill_at_once(d, 0, 0, true));
  cf_drift_sort(d->grid, d->set);
  CF_TRY(cf_registry_add_particles(r, d->set));
  CF_TRY(cf_registry_add_counter(r, "points_moves", &d->moves));
  CF_TRY(cf_registry_add_numbers(r, "points_time", "s", &d->time, 1));
  CF_TRY(cf_registry_add_numbers(r, "points_given", "", d->given, d->scene->points.count));
  return cf_registry_add_numbers(r, "points_left", "", &d->left, 1);
}

cf_status cf_drifters_step(cf_drifters *d, const cf_drift *flow, const double t, const double dt) {
  if (d->set == NULL) return CF_OK;
  cf_drift_move(flow, dt, d->set, 0);
  CF_TRY(be_born(d, flow, t, dt));
  put_out_of_solids(d);
  remove_those_out(d);
  d->time = t + dt;
  if (++d->moves % SORT_EVERY == 0) cf_drift_sort(d->grid, d->set);
  return CF_OK;
}

void cf_drifters_show(const cf_drifters *d, const cf_drift *flow) {
  if (d->set != NULL) cf_drift_velocity(flow, d->set, d->velocity);
}

int cf_drifters_metric_names(const cf_drifters *d, cf_metric *names) {
  if (d->set == NULL) return 0;
  snprintf(names[0].name, CF_NAME_MAX, "points");
  snprintf(names[1].name, CF_NAME_MAX, "points_left");
  return 2;
}

int cf_drifters_metrics(const cf_drifters *d, double *values) {
  if (d->set == NULL) return 0;
  values[0] = (double)d->set->count;
  values[1] = d->left;
  return 2;
}
