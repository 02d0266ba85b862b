/* SPDX-License-Identifier: MIT
 *
 * The keys of `flow:` beyond their table, and what `check` says of them.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model/flow_part.h"
#include "model/scene_check.h"

enum { KEY_MAX = 160 };

void cf_flow_gravity(const cf_scene *scene, double g[3]) {
  const cf_param_numbers *given = &scene->flow.gravity;
  for (int a = 0; a < 3; ++a) g[a] = a < given->count ? given->value[a] : 0;
  if (!scene->flow.given.gravity) g[1] = -9.81;
}

/* --- walls and inlets ------------------------------------------------------------------------------------- */

static cf_status check_side(const cf_scene *scene, const char *key, const char *name, int *axis, int *side) {
  if (!cf_flow_side(name, axis, side))
    return cf_scene_fail_at(scene, key, "%s: \"%.40s\" is no wall; they are x-, x+, y-, y+, z-, z+", key,
                            name);
  if (*axis >= scene->dim)
    return cf_scene_fail_at(scene, key, "%s: %s, but the scene has two axes, x and y", key, name);
  if (scene->domain.walls.walls.kind[*axis][0] == CF_WALL_PERIODIC)
    return cf_scene_fail_at(scene, key, "%s: %s is periodic in domain.walls: there is no wall", key, name);
  return CF_OK;
}

static cf_status resolve_wall(cf_scene *scene, const int number) {
  cf_scene_flow_wall *w = &scene->flow.walls.item[number];
  char key[KEY_MAX];
  int axis, side;
  snprintf(key, sizeof key, "flow.walls.%d.side", number);
  CF_TRY(check_side(scene, key, w->side, &axis, &side));
  for (int i = 0; i < number; ++i)
    if (strcmp(scene->flow.walls.item[i].side, w->side) == 0)
      return cf_scene_fail_at(scene, key, "%s: %s is in the list twice", key, w->side);
  if (!w->given.velocity) return CF_OK;
  snprintf(key, sizeof key, "flow.walls.%d.velocity", number);
  if (w->given.kind && w->kind == CF_SCENE_FLOW_WALL_OPEN)
    return cf_scene_fail_at(scene, key, "%s: an open wall has pressure 0, and so no velocity of its own",
                            key);
  return cf_scene_check_axes(scene, &w->velocity, true, scene->dim, key);
}

static bool is_closed(const cf_scene *scene, const char *name, const int axis, const int side) {
  for (int i = 0; i < scene->flow.walls.count; ++i) {
    const cf_scene_flow_wall *w = &scene->flow.walls.item[i];
    if (strcmp(w->side, name) == 0 && (w->given.kind || w->given.velocity))
      return !w->given.kind || w->kind == CF_SCENE_FLOW_WALL_CLOSED;
  }
  return scene->domain.walls.walls.kind[axis][side] != CF_WALL_OPEN;
}

static cf_status check_inlet(const cf_scene *scene, const int number) {
  const cf_scene_flow_inlet *inlet = &scene->flow.inlets.item[number];
  char key[KEY_MAX];
  int axis, side;
  snprintf(key, sizeof key, "flow.inlets.%d.wall", number);
  CF_TRY(check_side(scene, key, inlet->wall, &axis, &side));
  if (!is_closed(scene, inlet->wall, axis, side))
    return cf_scene_fail_at(
        scene, key,
        "%s: an inlet is a hole in a closed wall, and %s is open; put {side: %s, kind: closed} in flow.walls",
        key, inlet->wall, inlet->wall);
  snprintf(key, sizeof key, "flow.inlets.%d", number);
  const bool box = inlet->shape == CF_SCENE_INLET_BOX, sphere = inlet->shape == CF_SCENE_INLET_SPHERE;
  if ((box || sphere) && !inlet->given.center) return cf_scene_fail_at(scene, key, "%s needs center", key);
  if (box != inlet->given.half)
    return cf_scene_fail_at(scene, key, "%s: half goes with shape: box, and that with half", key);
  if (sphere != inlet->given.radius)
    return cf_scene_fail_at(scene, key, "%s: radius goes with shape: sphere, and that with radius", key);
  if ((inlet->given.center && inlet->center.count != scene->dim) ||
      (inlet->given.half && inlet->half.count != scene->dim))
    return cf_scene_fail_at(scene, key, "%s: center and half have %d entries, one an axis", key, scene->dim);
  return CF_OK;
}

/* --- all -------------------------------------------------------------------------------------------------- */

static cf_status check_buoyancy(const cf_scene *scene) {
  const cf_param_constants *b = &scene->flow.buoyancy;
  char key[KEY_MAX];
  for (int i = 0; i < b->count; ++i) {
    snprintf(key, sizeof key, "flow.buoyancy.%.60s", b->name[i]);
    if (cf_scene_field_index(scene, b->name[i]) < 0 || cf_scene_name_is_flux(b->name[i]))
      return cf_scene_fail_at(scene, "flow.buoyancy", "%s: there is no scalar %.60s in `fields`", key,
                              b->name[i]);
    if (!isfinite(b->value[i]))
      return cf_scene_fail_at(scene, "flow.buoyancy", "%s must be a finite number", key);
  }
  return CF_OK;
}

static cf_status check_velocity(const cf_scene *scene) {
  for (int a = 0; a < scene->dim; ++a)
    if (scene->velocity.axis[a].fn.in_time)
      return cf_scene_fail_at(scene, "velocity",
                              "velocity is the flow at time 0 in `model: flow`: it cannot depend on t");
  return CF_OK;
}

cf_status cf_flow_resolve(cf_scene *scene) {
  cf_scene_flow *f = &scene->flow;
  if (f->given.gravity && f->gravity.count != scene->dim)
    return cf_scene_fail_at(scene, "flow.gravity", "flow.gravity has %d entries, domain.size has %d",
                            f->gravity.count, scene->dim);
  if (f->given.force) CF_TRY(cf_scene_check_axes(scene, &f->force, true, scene->dim, "flow.force"));
  for (int i = 0; i < f->walls.count; ++i) CF_TRY(resolve_wall(scene, i));
  for (int i = 0; i < f->inlets.count; ++i) CF_TRY(check_inlet(scene, i));
  CF_TRY(check_velocity(scene));
  CF_TRY(cf_drifters_resolve(scene));
  return check_buoyancy(scene);
}

cf_status cf_flow_check(const cf_scene *scene, const double dt, const cf_page *page) {
  char text[160];
  double g[3];
  (void)dt;
  cf_flow_gravity(scene, g);
  if (scene->flow.buoyancy.count > 0) {
    snprintf(text, sizeof text, "%.4g, %.4g, %.4g m/s^2", g[0], g[1], g[2]);
    page->row(page->context, "gravity", text);
  }
  for (int i = 0; i < scene->flow.buoyancy.count; ++i) {
    snprintf(text, sizeof text, "%.40s: one unit of it is accelerated by %.4g m/s^2, %s",
             scene->flow.buoyancy.name[i],
             fabs(scene->flow.buoyancy.value[i]) * sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]),
             scene->flow.buoyancy.value[i] < 0 ? "with gravity (it sinks)" : "against gravity (it rises)");
    page->row(page->context, "buoyancy", text);
  }
  if (scene->flow.viscosity > 0) {
    const double size = scene->domain.size.value[0];
    snprintf(text, sizeof text, "%.4g m^2/s; Reynolds number 1 at %.3g m/s over the box's %.3g m",
             scene->flow.viscosity, scene->flow.viscosity / size, size);
    page->row(page->context, "viscosity", text);
  }
  cf_drifters_check(scene, page);
  return CF_OK;
}

bool cf_flow_shows(const cf_scene *scene, const char *name) {
  static const char *const shown[] = {"velocity", "pressure", "vorticity", "speed", NULL};
  for (int i = 0; shown[i] != NULL; ++i)
    if (strcmp(name, shown[i]) == 0) return true;
  if (strcmp(name, "H_c") == 0 || cf_drifters_shows(scene, name)) return true;
  return strncmp(name, "H_c_", 4) == 0 && cf_scene_field_index(scene, name + 4) >= 0;
}

double cf_flow_memory(const cf_scene *scene) {
  const double dim = scene->dim, coarse = dim == 3 ? 8.0 / 7 : 4.0 / 3;
  double fields = 3 * dim + 1;                /* velocity three times, pressure */
  fields += 2 * coarse * 4 / sizeof(cf_real); /* the projection's levels in single precision */
  if (scene->points.count > 0) fields += 2;   /* its right side and change, else the velocity's */
  if (scene->obstacles.count > 0) fields += 4 + 2 * coarse;
  if (scene->flow.given.force) fields += dim;
  if (scene->flow.confinement > 0) fields += dim + 1;
  if (scene->flow.viscosity > 0) fields += 2 + dim * (8 + 8 * coarse);
  return cf_scalars_bytes(scene, fields + cf_scalars_memory(scene)) + cf_drifters_memory(scene);
}
