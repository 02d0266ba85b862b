/* SPDX-License-Identifier: MIT
 *
 * The keys of `points:` checked, told by `check`, and counted before any is made.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model/drifters.h"
#include "model/flow_part.h"
#include "model/scene_check.h"

/* A point's id, position, velocity, times, and what the set needs to put them into another order. */
#define POINT_BYTES(dim) (2 * 8 + 4 * 4 + (2 * (dim) + 3) * (double)sizeof(cf_real))

static cf_status fail(const cf_scene *scene, const int number, const char *name, const char *sentence) {
  char key[48];
  snprintf(key, sizeof key, "points.%d%s%s", number, name[0] != '\0' ? "." : "", name);
  return cf_scene_fail_at(scene, key, "%s %s", key, sentence);
}

static cf_status check_shape(const cf_scene *scene, const int i) {
  const cf_scene_points *p = &scene->points.item[i];
  const bool box = p->shape == CF_POINTS_BOX, sphere = p->shape == CF_POINTS_SPHERE;
  if ((box || sphere) && !p->given.center) return fail(scene, i, "", "needs center");
  if (box && !p->given.half) return fail(scene, i, "", "needs half, half of the sides of the box");
  if (sphere && !p->given.radius) return fail(scene, i, "", "needs radius");
  if (!box && p->given.half) return fail(scene, i, "half", "goes with shape: box only");
  if (!sphere && p->given.radius) return fail(scene, i, "radius", "goes with shape: sphere only");
  if (!box && !sphere && p->given.center)
    return fail(scene, i, "center", "does not go with shape: everywhere");
  if (p->given.center && p->center.count != scene->dim)
    return fail(scene, i, "center", "has not one entry an axis");
  if (p->given.half && p->half.count != scene->dim)
    return fail(scene, i, "half", "has not one entry an axis");
  return CF_OK;
}

static cf_status check_wall(const cf_scene *scene, const int i) {
  const cf_scene_points *p = &scene->points.item[i];
  int axis, side;
  if (!cf_flow_side(p->wall, &axis, &side) || axis >= scene->dim)
    return fail(scene, i, "wall",
                scene->dim == 2 ? "is no wall: they are x-, x+, y-, y+"
                                : "is no wall: they are x-, x+, y-, y+, z-, z+");
  if (scene->domain.walls.walls.kind[axis][0] == CF_WALL_PERIODIC)
    return fail(scene, i, "wall", "is periodic in domain.walls: there is no wall");
  if (!p->given.per_cell) return fail(scene, i, "wall", "needs per_cell: points in a cell of what comes in");
  return CF_OK;
}

static cf_status check_one(const cf_scene *scene, const int i) {
  const cf_scene_points *p = &scene->points.item[i];
  const int ways = (p->given.count ? 1 : 0) + (p->given.per_cell ? 1 : 0) + (p->given.rate ? 1 : 0);
  if (ways == 0) return fail(scene, i, "", "says not how many: it needs count, per_cell or rate");
  if (ways > 1) return fail(scene, i, "", "says how many twice: count, per_cell or rate");
  if (p->given.wall) CF_TRY(check_wall(scene, i));
  if (p->given.to && !p->given.rate && !p->given.wall)
    return fail(scene, i, "to", "goes with rate or wall only");
  if (p->given.to && !(p->to > p->from)) return fail(scene, i, "to", "must be after `from`");
  return check_shape(scene, i);
}

cf_status cf_drifters_resolve(const cf_scene *scene) {
  for (int i = 0; i < scene->points.count; ++i) CF_TRY(check_one(scene, i));
  if (scene->points.count > 0 && cf_scene_field_index(scene, "points") >= 0)
    return cf_scene_fail_at(
        scene, "fields.points",
        "fields.points: what `points` seeds has this name; call the scalar something else");
  return CF_OK;
}

bool cf_drifters_shows(const cf_scene *scene, const char *name) {
  static const char *const own[] = {"points",        "points.position", "points.born",
                                    "points.source", "points.velocity", "points.id"};
  for (size_t i = 0; scene->points.count > 0 && i < sizeof own / sizeof *own; ++i)
    if (strcmp(name, own[i]) == 0) return i != 3 || scene->points.count > 1;
  return false;
}

/* --- how many --------------------------------------------------------------------------------------------- */

/* Cells that the shape covers, of the whole box or of a wall. */
static double cells_of(const cf_scene *scene, const cf_scene_points *p, const int across) {
  double cells = 1;
  for (int a = 0; a < scene->dim; ++a) {
    if (a == across) continue;
    const double reach = p->shape == CF_POINTS_BOX      ? p->half.value[a]
                         : p->shape == CF_POINTS_SPHERE ? p->radius
                                                        : scene->domain.size.value[a] / 2;
    cells *= CF_MIN(2 * reach, scene->domain.size.value[a]) / scene->spacing;
  }
  return p->shape == CF_POINTS_SPHERE ? cells * (scene->dim - (across >= 0) == 3 ? 0.5236 : 0.7854) : cells;
}

/* Where the expression stands for a constant, or what the inlets of the wall say, m/s. */
static double speed_into(const cf_scene *scene, const int axis, const int side) {
  double most = 0;
  for (int i = 0; i < scene->flow.inlets.count; ++i) {
    int a, s;
    const cf_scene_flow_inlet *inlet = &scene->flow.inlets.item[i];
    if (!cf_flow_side(inlet->wall, &a, &s) || a != axis || s != side) continue;
    const double *c = inlet->center.value;
    most = CF_MAX(most, cf_fn_at(&inlet->speed.fn, c[0], c[1], inlet->center.count > 2 ? c[2] : 0, 0));
  }
  const double u = cf_fn_at(&scene->velocity.axis[axis].fn, 0, 0, 0, 0) * (side == 0 ? 1 : -1);
  return CF_MAX(most, isfinite(u) ? u : 0);
}

static double expected(const cf_scene *scene, const cf_scene_points *p) {
  const double to = CF_MIN(p->given.to ? p->to : scene->time.end, scene->time.end);
  int axis, side;
  if (p->given.count) return (double)p->count;
  if (p->given.rate) return p->rate * CF_MAX(0, to - p->from);
  if (!p->given.wall) return (double)p->per_cell * cells_of(scene, p, -1);
  if (!cf_flow_side(p->wall, &axis, &side)) return 0;
  return (double)p->per_cell * cells_of(scene, p, axis) * speed_into(scene, axis, side) / scene->spacing *
         CF_MAX(0, to - p->from);
}

static double expected_all(const cf_scene *scene) {
  double all = 0;
  for (int i = 0; i < scene->points.count; ++i) all += expected(scene, &scene->points.item[i]);
  return all;
}

void cf_drifters_check(const cf_scene *scene, const cf_page *page) {
  char text[120];
  if (scene->points.count == 0) return;
  const double all = expected_all(scene);
  snprintf(text, sizeof text, "about %.3g, carried by the flow; %.3g GB", all,
           all * POINT_BYTES(scene->dim) / 1e9);
  page->row(page->context, "points", text);
  if (all > (double)INT32_MAX)
    page->warn(page->context, "points: more than 2147483647 in one run are too many: take fewer a cell");
}

double cf_drifters_memory(const cf_scene *scene) { return expected_all(scene) * POINT_BYTES(scene->dim); }
