/* SPDX-License-Identifier: MIT
 *
 * Obstacles placed on the grid at a time, and what scalars and the fluid meet there.
 */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "grid/sweep.h"
#include "grid/wall.h"
#include "model/obstacles_part.h"

#define PIECE 64 /* cells whose distances are asked for at once */

/* --- the object -------------------------------------------------------------------------------------------- */

/* What an obstacle is to a scalar: NULL a wall, else the value it is held at. */
static const cf_fn *find_held(const cf_scene_obstacle *k, const char *scalar) {
  for (int f = 0; f < k->fields.count; ++f) {
    const cf_scene_obstacle_field *own = &k->fields.item[f];
    if (strcmp(own->name, scalar) != 0) continue;
    if (own->given.kind && own->kind == CF_OBSTACLE_WALL) return NULL;
    return own->given.value ? &own->value.fn : &k->value.fn;
  }
  return k->kind == CF_OBSTACLE_HELD ? &k->value.fn : NULL;
}

static cf_status make_held(cf_obstacles *o) {
  const int fields = o->scene->fields.count;
  CF_TRY(CF_NEW(&o->held, (ptrdiff_t)fields * o->count));
  for (int f = 0; f < fields; ++f)
    for (int i = 0; i < o->count; ++i)
      o->held[(ptrdiff_t)f * o->count + i] = find_held(o->item[i].keys, o->scene->fields.item[f].name);
  return CF_OK;
}

static cf_status make_owner(const cf_obstacles *o, uint16_t **owner) {
  const cf_box *b = &o->grid->box;
  void *pages;
  CF_TRY(cf_pages_reserve(&pages, (size_t)b->size * sizeof **owner, false));
  *owner = (uint16_t *)pages + b->first;
  return CF_OK;
}

static void free_owner(const cf_obstacles *o, uint16_t *owner) {
  const cf_box *b = &o->grid->box;
  if (owner != NULL) cf_pages_release(owner - b->first, (size_t)b->size * sizeof *owner);
}

cf_status cf_obstacles_create(cf_obstacles *o, const cf_scene *scene, const cf_grid *g) {
  *o = (cf_obstacles){.scene = scene, .grid = g};
  if (scene->obstacles.count == 0) return CF_OK;
  CF_TRY(CF_NEW(&o->item, scene->obstacles.count));
  o->count = scene->obstacles.count;
  for (int i = 0; i < o->count; ++i) CF_TRY(cf_obstacle_make(o, i));
  CF_TRY(make_held(o));
  CF_TRY(make_owner(o, &o->owner));
  if (o->changes) CF_TRY(make_owner(o, &o->owner_still));
  return cf_obstacles_place(o, 0, 1e-6 * scene->time.end);
}

void cf_obstacles_destroy(cf_obstacles *o) {
  for (int i = 0; i < o->count; ++i) cf_samples_destroy(&o->item[i].samples);
  if (o->count > 0) free_owner(o, o->owner), free_owner(o, o->owner_still);
  cf_free(o->item);
  cf_free(o->held);
  *o = (cf_obstacles){0};
}

/* --- placing ----------------------------------------------------------------------------------------------- */

/* Marks the cells [low, high) of a row whose centres are inside obstacle i. */
static void mark_row(const cf_obstacles *o, const int i, const double t, const int low, const int high,
                     const int j, const int k, uint16_t *owner) {
  const cf_grid *g = o->grid;
  const cf_obstacle *one = &o->item[i];
  double x[PIECE], y[PIECE], z[PIECE], d[PIECE];
  for (int from = low; from < high; from += PIECE) {
    const int n = CF_MIN(PIECE, high - from);
    const ptrdiff_t p = cf_box_at(&g->box, from, j, k);
    for (int c = 0; c < n; ++c) {
      x[c] = cf_grid_place(g, 0, from + c, 0);
      y[c] = cf_grid_place(g, 1, j, 0);
      z[c] = g->box.dim == 3 ? cf_grid_place(g, 2, k, 0) : 0;
    }
    cf_shape_distance_row(&one->shape, one->posed ? &one->pose : NULL, t, n, x, y, z, d);
    for (int c = 0; c < n; ++c)
      if (d[c] <= 0) owner[p + c] = (uint16_t)(i + 1);
  }
}

static void mark(const cf_obstacles *o, const int i, const double t, uint16_t *owner) {
  const cf_obstacle *one = &o->item[i];
  int low[3], high[3];
  cf_shape_cells(&one->shape, one->posed ? &one->pose : NULL, o->grid, 0, low, high);
  const int ny = high[1] - low[1], rows = ny * (high[2] - low[2]);
#pragma omp parallel for schedule(static) num_threads(o->grid->threads)
  for (int r = 0; r < rows; ++r) mark_row(o, i, t, low[0], high[0], low[1] + r % ny, low[2] + r / ny, owner);
}

static void copy_owners(const cf_obstacles *o, const uint16_t *from, uint16_t *to) {
  const cf_box *b = &o->grid->box;
  CF_PARALLEL_ROWS (b, o->grid->threads, r) {
    const ptrdiff_t p = cf_box_row(b, r);
    memcpy(to + p, from + p, (size_t)b->n[0] * sizeof *to);
  }
}

static ptrdiff_t count_solid(const cf_obstacles *o) {
  const cf_box *b = &o->grid->box;
  ptrdiff_t solid = 0;
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    for (int i = 0; i < b->n[0]; ++i) solid += o->owner[cf_box_row(b, r) + i] != 0;
  return solid;
}

void cf_obstacles_pace(cf_obstacles *o, const double t, const double dt) {
  for (int i = 0; i < o->count; ++i)
    if (o->item[i].posed) o->item[i].pose = cf_motion_at(&o->item[i].motion, t, dt);
}

static void mark_still(const cf_obstacles *o, const double t) {
  for (int i = 0; i < o->count; ++i)
    if (!o->item[i].changes) mark(o, i, t, o->owner_still != NULL ? o->owner_still : o->owner);
}

cf_status cf_obstacles_place(cf_obstacles *o, const double t, const double dt) {
  if (o->count == 0 || (o->placed && !o->changes)) return CF_OK;
  cf_obstacles_pace(o, t, dt);
  if (!o->placed) mark_still(o, t);
  if (o->owner_still != NULL) copy_owners(o, o->owner_still, o->owner);
  for (int i = 0; i < o->count; ++i)
    if (o->item[i].changes) mark(o, i, t, o->owner);
  o->solid = count_solid(o);
  o->time = t;
  o->dt = dt;
  o->placed = true;
  return CF_OK;
}

cf_status cf_obstacles_register(cf_obstacles *o, cf_registry *r) {
  return o->changes ? cf_registry_add_numbers(r, "obstacles_placed", "s", &o->time, 2) : CF_OK;
}

cf_status cf_obstacles_restored(cf_obstacles *o) { return cf_obstacles_place(o, o->time, o->dt); }

/* --- what scalars meet ------------------------------------------------------------------------------------- */

static const cf_fn *held_at(const cf_obstacles *o, const int i, const int field) {
  return field < 0 ? NULL : o->held[(ptrdiff_t)field * o->count + i];
}

bool cf_obstacles_holds(const cf_obstacles *o, const int field) {
  for (int i = 0; i < o->count; ++i)
    if (held_at(o, i, field) != NULL) return true;
  return false;
}

bool cf_obstacles_value_in_time(const cf_obstacles *o, const int field) {
  for (int i = 0; i < o->count; ++i) {
    const cf_fn *value = held_at(o, i, field);
    if (value != NULL && value->in_time) return true;
  }
  return false;
}

void cf_obstacles_values(const cf_obstacles *o, const int field, const double t, const cf_cell value) {
  const cf_grid *g = o->grid;
  const cf_box *b = &g->box;
  if (!cf_obstacles_holds(o, field)) return;
  CF_PARALLEL_ROWS (b, g->threads, r)
    for (int i = 0; i < b->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(b, r) + i;
      const cf_fn *fn = o->owner[p] > 0 ? held_at(o, o->owner[p] - 1, field) : NULL;
      if (fn == NULL) continue;
      const int j = (int)(r % b->n[1]), k = (int)(r / b->n[1]);
      value.at[p] = (cf_real)cf_fn_at(fn, cf_grid_place(g, 0, i, 0), cf_grid_place(g, 1, j, 0),
                                      b->dim == 3 ? cf_grid_place(g, 2, k, 0) : 0, t);
    }
}

cf_status cf_obstacles_region(const cf_obstacles *o, const int field, cf_region *region) {
  const cf_box *b = &o->grid->box;
  if (o->count == 0) return CF_OK;
  CF_PARALLEL_ROWS (b, o->grid->threads, r)
    for (int i = 0; i < b->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(b, r) + i;
      const int owner = o->owner[p];
      region->kind[p] = (unsigned char)(owner == 0                             ? CF_CELL_INSIDE
                                        : held_at(o, owner - 1, field) != NULL ? CF_CELL_HELD
                                                                               : CF_CELL_WALL);
    }
  cf_obstacles_values(o, field, o->time, region->value);
  return cf_region_update(region);
}

/* Whether a neighbour of p is in an obstacle and p is not, or the reverse. */
static bool is_edge(const cf_obstacles *o, const ptrdiff_t p, const int at[3]) {
  const cf_box *b = &o->grid->box;
  const bool here = cf_obstacles_has(o, p);
  for (int a = 0; a < b->dim; ++a) {
    if (at[a] > 0 && cf_obstacles_has(o, p - b->stride[a]) != here) return true;
    if (at[a] < b->n[a] - 1 && cf_obstacles_has(o, p + b->stride[a]) != here) return true;
  }
  return false;
}

void cf_obstacles_show(const cf_obstacles *o, const cf_cell solid) {
  const cf_grid *g = o->grid;
  const cf_box *b = &g->box;
  CF_PARALLEL_ROWS (b, g->threads, r)
    for (int i = 0; i < b->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(b, r) + i;
      const int at[3] = {i, (int)(r % b->n[1]), (int)(r / b->n[1])};
      const bool here = cf_obstacles_has(o, p);
      solid.at[p] = here;
      if (!is_edge(o, p, at)) continue;
      double place[3] = {0, 0, 0};
      for (int a = 0; a < b->dim; ++a) place[a] = cf_grid_place(g, a, at[a], 0);
      const double share = CF_MIN(CF_MAX(0.5 - cf_obstacles_distance(o, place) / g->h, 0), 1);
      if ((share >= 0.5) == here) solid.at[p] = (cf_real)share;
    }
}

/* --- what moves -------------------------------------------------------------------------------------------- */

/* The velocity of obstacle i along an axis, at the low face of the cell (i, j, k) on it. */
static double speed_at(const cf_obstacles *o, const int which, const int axis, const int at[3]) {
  const cf_obstacle *one = &o->item[which];
  double place[3], v[3];
  if (!one->moves) return 0;
  for (int a = 0; a < 3; ++a)
    place[a] = a < o->grid->box.dim ? cf_grid_place(o->grid, a, at[a], a == axis) : 0;
  cf_pose_velocity(&one->pose, place, v);
  return v[axis];
}

void cf_obstacles_push(const cf_obstacles *o, const cf_face u) {
  const cf_box *b = &o->grid->box;
  if (o->count == 0) return;
  CF_PARALLEL_ROWS (b, o->grid->threads, r)
    for (int i = 0; i < b->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(b, r) + i;
      if (o->owner[p] == 0) continue;
      const int at[3] = {i, (int)(r % b->n[1]), (int)(r / b->n[1])};
      for (int a = 0; a < b->dim; ++a) {
        const bool last = at[a] == b->n[a] - 1;
        u.at[a][p] = (cf_real)speed_at(o, o->owner[p] - 1, a, at);
        if (!last && o->owner[p + b->stride[a]] != 0) continue;
        const int next[3] = {at[0] + (a == 0), at[1] + (a == 1), at[2] + (a == 2)};
        u.at[a][p + b->stride[a]] = (cf_real)speed_at(o, o->owner[p] - 1, a, next);
      }
    }
}

void cf_obstacles_join(const cf_obstacles *o, const int axis, const cf_face u) {
  const cf_box *b = &o->grid->box;
  const cf_wall_side w = cf_wall_side_of(b, axis, 0);
  for (int i_c = 0; i_c < w.n_c; ++i_c)
    for (int i_b = 0; i_b < w.n_b; ++i_b) {
      const ptrdiff_t first = cf_wall_cell(b, &w, i_b, i_c), end = first + b->n[axis] * b->stride[axis];
      if (cf_obstacles_has(o, end - b->stride[axis]) && !cf_obstacles_has(o, first))
        u.at[axis][first] = u.at[axis][end];
      else
        u.at[axis][end] = u.at[axis][first];
    }
}

/* What turns is as fast as its farthest corner of the box would be: an upper bound, and the same wherever cells are. */
double cf_obstacles_speed(const cf_obstacles *o) {
  const cf_grid *g = o->grid;
  double fastest = 0;
  for (int i = 0; i < o->count; ++i) {
    const cf_pose *pose = &o->item[i].pose;
    double speed = 0, spin = 0, reach = 0;
    if (!o->item[i].moves) continue;
    for (int a = 0; a < g->box.dim; ++a) {
      const double size = g->box.n[a] * g->h, at = pose->pivot[a] + pose->shift[a] - g->origin[a];
      const double far = CF_MAX(fabs(at), fabs(size - at));
      reach += far * far;
      speed += pose->velocity[a] * pose->velocity[a];
    }
    for (int a = 0; a < 3; ++a) spin += pose->spin[a] * pose->spin[a];
    fastest = CF_MAX(fastest, sqrt(speed) + sqrt(spin * reach));
  }
  return fastest;
}

/* --- distances --------------------------------------------------------------------------------------------- */

static double distance_to(const cf_obstacles *o, const int i, const double place[3]) {
  const cf_obstacle *one = &o->item[i];
  return cf_shape_distance(&one->shape, one->posed ? &one->pose : NULL, o->time, place);
}

double cf_obstacles_distance(const cf_obstacles *o, const double place[3]) {
  double least = INFINITY;
  for (int i = 0; i < o->count; ++i) least = CF_MIN(least, distance_to(o, i, place));
  return least;
}

void cf_obstacles_normal(const cf_obstacles *o, const double place[3], const double step, double normal[3]) {
  double least = INFINITY;
  int nearest = -1;
  normal[0] = normal[1] = normal[2] = 0;
  for (int i = 0; i < o->count; ++i) {
    const double d = distance_to(o, i, place);
    if (d < least) least = d, nearest = i;
  }
  if (nearest < 0) return;
  const cf_obstacle *one = &o->item[nearest];
  cf_shape_normal(&one->shape, one->posed ? &one->pose : NULL, o->time, place, step, normal);
}
