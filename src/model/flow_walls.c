/* SPDX-License-Identifier: MIT
 *
 * The walls of a flow as the scene gives them: kinds, velocities, and inlets, whose outline takes the fraction of each
 * face that it covers.
 */
#include <math.h>
#include <string.h>

#include "model/flow_part.h"

/* Points an axis that say how much of a face lies in an outline. */
#define POINTS 8

bool cf_flow_side(const char *name, int *axis, int *side) {
  const char *letter = strchr("xyz", name[0]);
  if (name[0] == '\0' || letter == NULL || strlen(name) != 2 || (name[1] != '-' && name[1] != '+'))
    return false;
  *axis = (int)(letter - "xyz");
  *side = name[1] == '+';
  return true;
}

static const cf_scene_flow_wall *wall_of(const cf_scene *scene, const int axis, const int side) {
  for (int i = 0; i < scene->flow.walls.count; ++i) {
    int a, s;
    if (cf_flow_side(scene->flow.walls.item[i].side, &a, &s) && a == axis && s == side)
      return &scene->flow.walls.item[i];
  }
  return NULL;
}

static cf_flow_wall kind_of(const cf_scene *scene, const int axis, const int side) {
  const cf_wall domain = scene->domain.walls.walls.kind[axis][side];
  const cf_scene_flow_wall *own = wall_of(scene, axis, side);
  if (domain == CF_WALL_PERIODIC) return CF_FLOW_PERIODIC;
  if (own != NULL && own->given.kind)
    return own->kind == CF_SCENE_FLOW_WALL_OPEN ? CF_FLOW_OPEN : CF_FLOW_CLOSED;
  if (own != NULL && own->given.velocity) return CF_FLOW_CLOSED;
  return domain == CF_WALL_OPEN ? CF_FLOW_OPEN : CF_FLOW_CLOSED;
}

/* --- places on a wall ------------------------------------------------------------------------------------- */

/* A volume of component c at a wall: its place, and which axes lie in the wall. */
typedef struct spot {
  int axis, side, component, other[2], count[2];
} spot;

static spot spot_of(const cf_flow_walls *w, const int axis, const int side, const int c) {
  spot s = {axis, side, c, {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}, {1, 1}};
  for (int o = 0; o < 2; ++o) s.count[o] = cf_flow_count(w, s.other[o], c);
  return s;
}

static void place_of(const cf_grid *g, const spot *s, const int i, const int j, double x[3]) {
  const int at[2] = {i, j};
  x[2] = 0;
  x[s->axis] = g->origin[s->axis] + (s->side == 0 ? 0 : g->box.n[s->axis]) * g->h;
  for (int o = 0; o < 2; ++o)
    if (s->other[o] < g->box.dim)
      x[s->other[o]] = cf_grid_place(g, s->other[o], at[o], s->other[o] == s->component);
}

static bool is_inside(const cf_scene_flow_inlet *inlet, const spot *s, const int dim, const double x[3]) {
  double square = 0;
  for (int o = 0; o < 2; ++o) {
    const int a = s->other[o];
    if (a >= dim) continue;
    const double away = x[a] - inlet->center.value[a];
    if (inlet->shape == CF_SCENE_INLET_BOX && fabs(away) > inlet->half.value[a]) return false;
    square += away * away;
  }
  return inlet->shape != CF_SCENE_INLET_SPHERE || square <= inlet->radius * inlet->radius;
}

static double fraction_of(const cf_scene_flow_inlet *inlet, const spot *s, const cf_grid *g,
                          const double x[3]) {
  if (inlet->shape == CF_SCENE_INLET_EVERYWHERE) return 1;
  int inside = 0, points = 0;
  for (int j = 0; j < (g->box.dim == 3 ? POINTS : 1); ++j)
    for (int i = 0; i < POINTS; ++i, ++points) {
      const int at[2] = {i, j};
      double y[3] = {x[0], x[1], x[2]};
      for (int o = 0; o < 2; ++o)
        if (s->other[o] < g->box.dim) y[s->other[o]] += ((at[o] + 0.5) / POINTS - 0.5) * g->h;
      inside += is_inside(inlet, s, g->box.dim, y);
    }
  return (double)inside / points;
}

/* --- velocities ------------------------------------------------------------------------------------------- */

static double value_at(const cf_flow *m, const spot *s, const int i, const int j, const double t) {
  const cf_scene *scene = m->scene;
  const cf_scene_flow_wall *own = wall_of(scene, s->axis, s->side);
  double x[3], value = 0;
  place_of(m->grid, s, i, j, x);
  if (own != NULL && own->given.velocity) {
    const cf_fn *f = &own->velocity.axis[s->component].fn;
    value = cf_fn_at(f, x[0], x[1], x[2], t);
  }
  for (int k = 0; k < scene->flow.inlets.count && s->component == s->axis; ++k) {
    const cf_scene_flow_inlet *inlet = &scene->flow.inlets.item[k];
    int axis, side;
    if (!cf_flow_side(inlet->wall, &axis, &side) || axis != s->axis || side != s->side) continue;
    const double share = fraction_of(inlet, s, m->grid, x);
    if (share > 0) value += (side == 0 ? share : -share) * cf_fn_at(&inlet->speed.fn, x[0], x[1], x[2], t);
  }
  return value;
}

static void fill(cf_flow *m, const spot *s, const double t) {
  double *values = m->walls.value[s->axis][s->side][s->component];
  bool passes = false;
  for (int j = 0; j < s->count[1]; ++j)
    for (int i = 0; i < s->count[0]; ++i) {
      const double value = value_at(m, s, i, j, t);
      values[i + (ptrdiff_t)s->count[0] * j] = value;
      passes = passes || value != 0;
    }
  if (s->component == s->axis) m->walls.lets_in[s->axis][s->side] = passes || m->walls_in_time;
}

/* Nothing can come into a closed box unless as much goes out. */
static cf_status check_balance(const cf_flow *m, const double t) {
  const int dim = m->grid->box.dim;
  double gross;
  const double net = cf_flow_walls_inflow(&m->walls, &gross);
  for (int a = 0; a < dim; ++a)
    for (int side = 0; side < 2; ++side)
      if (m->walls.kind[a][side] == CF_FLOW_OPEN) return CF_OK;
  if (fabs(net) <= 1e-9 * gross) return CF_OK;
  return cf_scene_fail_at(
      m->scene, m->scene->flow.inlets.count > 0 ? "flow.inlets" : "flow.walls",
      "%.4g m^%d/s of fluid %s through the walls at t = %g s and no wall is open: the fluid "
      "has nowhere to %s; give one `kind: open` in flow.walls, or an inlet of the opposite sign",
      fabs(net), dim, net > 0 ? "come in" : "go out", t, net > 0 ? "go" : "come from");
}

cf_status cf_flow_walls_at(cf_flow *m, const double t) {
  const int dim = m->grid->box.dim;
  for (int a = 0; a < dim; ++a)
    for (int side = 0; side < 2; ++side)
      for (int c = 0; c < dim && m->walls.kind[a][side] == CF_FLOW_CLOSED; ++c) {
        const spot s = spot_of(&m->walls, a, side, c);
        fill(m, &s, t);
      }
  return check_balance(m, t);
}

static bool in_time(const cf_scene *scene) {
  for (int i = 0; i < scene->flow.walls.count; ++i)
    for (int a = 0; a < scene->dim; ++a)
      if (scene->flow.walls.item[i].given.velocity && scene->flow.walls.item[i].velocity.axis[a].fn.in_time)
        return true;
  for (int i = 0; i < scene->flow.inlets.count; ++i)
    if (scene->flow.inlets.item[i].speed.fn.in_time) return true;
  return false;
}

cf_status cf_flow_walls_of_scene(cf_flow *m) {
  cf_flow_wall kind[3][2] = {{CF_FLOW_CLOSED}};
  for (int a = 0; a < m->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side) kind[a][side] = kind_of(m->scene, a, side);
  CF_TRY(cf_flow_walls_create(&m->walls, m->grid, kind));
  for (int a = 0; a < m->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const cf_scene_flow_wall *own = wall_of(m->scene, a, side);
      m->walls.sticks[a][side] = own != NULL && (own->given.velocity || own->slip == CF_SCENE_SLIP_OFF);
    }
  m->walls_in_time = in_time(m->scene);
  return cf_flow_walls_at(m, 0);
}
