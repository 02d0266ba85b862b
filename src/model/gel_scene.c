/* SPDX-License-Identifier: MIT
 *
 * The keys of `gel:` beyond their table, the lattice and the materials that follow from them, and what `check` says.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model/gel_part.h"

enum { KEY_MAX = 96 };

/* --- what follows from keys -------------------------------------------------------------------------------- */

cf_mpm_material cf_gel_material(const cf_scene *scene, const int body) {
  const cf_scene_gel_body *b = &scene->gel.bodies.item[body];
  const double E = b->young, nu = b->poisson, pores = b->porosity * b->fluid_density;
  return (cf_mpm_material){
      .law = b->law == CF_GEL_LAW_NEO_HOOKEAN ? CF_MPM_NEO_HOOKEAN : CF_MPM_COROTATED,
      .mu = E / (2 * (1 + nu)),
      .lambda = E * nu / ((1 + nu) * (1 - 2 * nu)),
      .hardening = b->hardening,
      .stretch = b->given.stretch ? b->stretch : (double)INFINITY,
      .compression = b->given.compression ? b->compression : (double)INFINITY,
      .swelling = b->swelling,
      .density = (1 - b->porosity) * b->solid_density + b->inertia_saturation * pores,
      .water = pores,
      .k = b->given.k ? b->k : scene->diffusion.k.fn.value,
      .f_t = b->given.f_t ? b->f_t : scene->diffusion.f_t,
  };
}

cf_status cf_gel_lattice(const cf_scene *scene, cf_grid *lattice, int offset[3]) {
  int n[3] = {1, 1, 1};
  double origin[3] = {0, 0, 0};
  for (int a = 0; a < scene->dim; ++a) {
    const int cells = (int)scene->domain.cells.value[a];
    const int all = scene->gel.walls == CF_GEL_WALL_NONE ? CF_GEL_UNBOUNDED(scene->dim) : 0;
    offset[a] = CF_MAX(CF_GEL_MARGIN, (all - cells) / 2 / CF_GEL_MARGIN * CF_GEL_MARGIN);
    n[a] = cells + 2 * offset[a];
    origin[a] =
        (a < scene->domain.origin.count ? scene->domain.origin.value[a] : 0) - offset[a] * scene->spacing;
  }
  return cf_grid_init(lattice, scene->dim, n, scene->spacing, origin);
}

/* --- checks ------------------------------------------------------------------------------------------------ */

static cf_status check_count(const cf_scene *scene, const char *list, const int i, const char *name,
                             const cf_param_numbers *v, const int wanted) {
  char key[KEY_MAX];
  if (v->count == 0 || v->count == wanted) return CF_OK;
  if (i < 0)
    snprintf(key, sizeof key, "gel.%s", name);
  else
    snprintf(key, sizeof key, "gel.%s.%d.%s", list, i, name);
  return cf_scene_fail_at(scene, key, "%s has %d entries, expected %d", key, v->count, wanted);
}

static cf_status need(const cf_scene *scene, const char *list, const int i, const bool given,
                      const char *name, const char *shape) {
  char key[KEY_MAX];
  if (given) return CF_OK;
  snprintf(key, sizeof key, "gel.%s.%d", list, i);
  return cf_scene_fail_at(scene, key, "%s: shape %s needs %s", key, shape, name);
}

static cf_status check_body(const cf_scene *scene, const int i) {
  static const char *const words[] = {"box", "ball", "slab", "image", "mesh"};
  const cf_scene_gel_body *b = &scene->gel.bodies.item[i];
  const int dim = scene->dim;
  const char *shape = words[b->shape];
  const bool mesh = b->shape == CF_GEL_BODY_MESH, image = b->shape == CF_GEL_BODY_IMAGE;
  const bool slab = b->shape == CF_GEL_BODY_SLAB, ball = b->shape == CF_GEL_BODY_BALL;
  if (mesh && dim == 2) {
    return cf_scene_fail_at(scene, "gel.bodies",
                            "gel.bodies.%d: a surface bounds a body in 3D, here are two axes", i);
  }
  if (!mesh) CF_TRY(need(scene, "bodies", i, b->given.center, "center", shape));
  if (!mesh && !ball) CF_TRY(need(scene, "bodies", i, b->given.half, "half", shape));
  if (ball) CF_TRY(need(scene, "bodies", i, b->given.radius, "radius", shape));
  if (slab || (image && dim == 3)) CF_TRY(need(scene, "bodies", i, b->given.thickness, "thickness", shape));
  if (mesh || image) CF_TRY(need(scene, "bodies", i, b->given.file, "file", shape));
  CF_TRY(check_count(scene, "bodies", i, "center", &b->center, dim));
  CF_TRY(check_count(scene, "bodies", i, "half", &b->half, slab ? dim - 1 : image ? 2 : dim));
  return check_count(scene, "bodies", i, "velocity", &b->velocity, dim);
}

static cf_status check_water(const cf_scene *scene, const int i) {
  static const char *const words[] = {"box", "ball", "plane", "everywhere"};
  const cf_scene_gel_water *w = &scene->gel.water.item[i];
  const char *shape = words[w->shape];
  if (w->shape != CF_GEL_PLACE_EVERYWHERE) CF_TRY(need(scene, "water", i, w->given.center, "center", shape));
  if (w->shape == CF_GEL_PLACE_BOX) CF_TRY(need(scene, "water", i, w->given.half, "half", shape));
  if (w->shape == CF_GEL_PLACE_BALL) CF_TRY(need(scene, "water", i, w->given.radius, "radius", shape));
  CF_TRY(check_count(scene, "water", i, "center", &w->center, scene->dim));
  CF_TRY(check_count(scene, "water", i, "normal", &w->normal, scene->dim));
  return check_count(scene, "water", i, "half", &w->half, scene->dim);
}

cf_status cf_gel_resolve(cf_scene *scene) {
  const cf_scene_gel *k = &scene->gel;
  if (k->bodies.count == 0) return cf_scene_fail_at(scene, "gel", "gel.bodies is missing: what is to swell?");
  for (int i = 0; i < k->bodies.count; ++i) CF_TRY(check_body(scene, i));
  for (int i = 0; i < k->water.count; ++i) CF_TRY(check_water(scene, i));
  CF_TRY(check_count(scene, "", -1, "gravity", &k->gravity, scene->dim));
  if (scene->obstacles.count + 2 * scene->dim > CF_MPM_OBSTACLES_MAX)
    return cf_scene_fail_at(scene, "obstacles", "obstacles: %d are too many, at most %d",
                            scene->obstacles.count, CF_MPM_OBSTACLES_MAX - 2 * scene->dim);
  if (k->water.count > CF_PORO_SOURCES_MAX)
    return cf_scene_fail_at(scene, "gel.water", "gel.water: %d are too many, at most %d", k->water.count,
                            CF_PORO_SOURCES_MAX);
  if (!cf_fn_is_constant(&scene->diffusion.k.fn))
    return cf_scene_fail_at(scene, "diffusion.k", "diffusion.k must be one number in model gel");
  return CF_OK;
}

/* --- what it takes ----------------------------------------------------------------------------------------- */

/* Where particles may be split there is room for as many times of them. */
#define ROOM_TO_SPLIT 4

double cf_gel_room(const cf_scene *scene) {
  const double count = CF_MAX(16, cf_gel_count(scene));
  return scene->gel.split > 0 ? CF_MAX(count, CF_MIN(ROOM_TO_SPLIT * count, INT32_MAX)) : count;
}

/* Of a cell with particles or near them: of the lattice's nodes, and of the solver with its window (solve/window.h); of cells
 * around that what is shown may touch, in pages. */
#define CELL_BYTES   1000.0
#define AROUND       16
#define SHOWN_FIELDS 8

double cf_gel_memory(const cf_scene *scene) {
  const int dim = scene->dim;
  const double numbers = 4 * dim + 3 * dim * dim + 11;
  /* a cell for `particles` to the power dim of them, and as many again around the surface */
  const double cells = 3 * cf_gel_count(scene) / pow((double)scene->gel.particles, dim);
  double box = 1;
  for (int a = 0; a < dim; ++a) box *= (double)scene->domain.cells.value[a];
  return cf_gel_room(scene) * (numbers * sizeof(cf_real) + 24) + cells * CELL_BYTES +
         SHOWN_FIELDS * CF_MIN(box, AROUND * cells) * sizeof(cf_real) + 64e6;
}

/* The stretch s at which a free body with S = 1 is at rest, 2 mu (s - 1) s + lambda (s^d - 1) s^d = chi (fixed corotated; a
 * little less for neo-Hookean): the left side grows with s. */
static double swollen(const cf_mpm_material *m, const int dim) {
  double low = 1, high = 2;
  const double d = dim;
  while (high < 1e6 &&
         2 * m->mu * (high - 1) * high + m->lambda * (pow(high, d) - 1) * pow(high, d) < m->swelling)
    low = high, high *= 2;
  for (int i = 0; i < 60; ++i) {
    const double s = (low + high) / 2;
    if (2 * m->mu * (s - 1) * s + m->lambda * (pow(s, d) - 1) * pow(s, d) < m->swelling)
      low = s;
    else
      high = s;
  }
  return low;
}

cf_status cf_gel_check(const cf_scene *scene, const double dt, const cf_page *page) {
  char text[160];
  double fastest = 0, longest = 1;
  for (int i = 0; i < scene->gel.bodies.count; ++i) {
    const cf_mpm_material m = cf_gel_material(scene, i);
    fastest = CF_MAX(fastest, sqrt((m.lambda + 2 * m.mu + m.swelling) / m.density));
    longest = CF_MAX(longest, swollen(&m, scene->dim));
  }
  snprintf(text, sizeof text, "about %.3g", cf_gel_count(scene));
  page->row(page->context, "particles", text);
  snprintf(text, sizeof text, "%.4g m/s in a body full of water", fastest);
  page->row(page->context, "speed of sound", text);
  snprintf(text, sizeof text, "%.3g %% a side when full and free", 100 * (longest - 1));
  page->row(page->context, "swells by", text);
  const double limit = 0.5 * scene->spacing / fastest;
  snprintf(text, sizeof text, "%.4g s", limit);
  page->row(page->context, "explicit limit", text);
  if (scene->gel.implicitness < 0.5 && !isnan(scene->time.dt) && dt > 1.1 * limit) {
    snprintf(text, sizeof text,
             "dt = %g s is above the explicit limit %.3g s: take dt: auto or gel.implicitness: 1", dt, limit);
    page->warn(page->context, text);
  }
  return CF_OK;
}
