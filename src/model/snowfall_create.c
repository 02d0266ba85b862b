/* SPDX-License-Identifier: MIT
 *
 * Making a snowfall: flakes of the atlas in the air, and the columns that they land on.
 */
#define _GNU_SOURCE
#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/rng.h"
#include "model/snowfall_part.h"

#define PI  3.14159265358979323846
#define ICE 917.0 /* kg/m^3 */

/* What the counted numbers are for; the last count is the id of a flake. */
enum { STREAM_PLACE = 1, STREAM_KIND, STREAM_RADIUS, STREAM_TURN, STREAM_OFFSET, STREAM_SHED };

static double draw(const cf_snowfall *s, const uint64_t stream, const uint64_t which, const int64_t id) {
  return cf_random((uint64_t)s->keys->seed, stream, which, (uint64_t)id);
}

/* --- a flake ---------------------------------------------------------------------------------------------- */

void cf_snowfall_flake(const cf_snowfall *s, const int64_t id, const int kind, const double radius,
                       cf_flake *flake) {
  const cf_atlas_flake *a = &s->atlas->flakes.item[kind];
  const double scale = radius / a->radius, D = 2 * radius;
  const cf_atlas_shape *shape = &s->shape[kind];
  const double off = s->keys->imperfection * D * sqrt(draw(s, STREAM_OFFSET, 0, id));
  const double where = 2 * PI * draw(s, STREAM_OFFSET, 1, id);
  *flake =
      (cf_flake){.mass = a->mass * scale * scale * scale,
                 .diameter = D,
                 .area = a->area * scale * scale,
                 .offset = {D * shape->offset[0] + off * cos(where), D * shape->offset[1] + off * sin(where)},
                 .shed_phase = draw(s, STREAM_SHED, 0, id)};
  flake->inertia[1] = shape->inertia * flake->mass * D * D;
  flake->inertia[0] = flake->inertia[1] / 2; /* thin, and the same about any line in its plane */
  cf_flake_settle_speed(flake, &s->air);
}

/* From the law N(r) ~ exp(-slope r) between the two radii. */
static double draw_radius(const cf_snowfall *s, const int64_t id) {
  const double *r = s->keys->radius.value, u = draw(s, STREAM_RADIUS, 0, id), width = r[1] - r[0];
  const double fall = s->keys->slope * width;
  return fall < 1e-6 ? r[0] + u * width : r[0] - log1p(-u * -expm1(-fall)) / s->keys->slope;
}

/* Lying flat, turned anyhow about the vertical and tilted by up to `tilt`. */
static void draw_turn(const cf_snowfall *s, const int64_t id, const double tilt, double turn[4]) {
  const double yaw = PI * draw(s, STREAM_TURN, 0, id), lean = tilt / 2 * draw(s, STREAM_TURN, 1, id);
  const double about = 2 * PI * draw(s, STREAM_TURN, 2, id);
  const double a[4] = {cos(lean), sin(lean) * cos(about), sin(lean) * sin(about), 0};
  const double b[2] = {cos(yaw), sin(yaw)};
  turn[0] = a[0] * b[0];
  turn[1] = a[1] * b[0] + a[2] * b[1];
  turn[2] = a[2] * b[0] - a[1] * b[1];
  turn[3] = a[0] * b[1];
}

static void place_flake(cf_snowfall *s, const int64_t i, const bool at_top) {
  cf_particles *f = s->flakes;
  const int64_t id = f->id[i];
  double x[3], turn[4], wind[3];
  for (int a = 0; a < 3; ++a)
    x[a] = s->low[a] + (s->high[a] - s->low[a]) * draw(s, STREAM_PLACE, (uint64_t)a, id);
  const double top = cf_snowpack_top(&s->pack, x[0], x[1]);
  x[2] = at_top ? s->high[2] : top + (s->high[2] - top) * draw(s, STREAM_PLACE, 2, id);
  const int kind = (int)(draw(s, STREAM_KIND, 0, id) * s->atlas->flakes.count);
  const double radius = draw_radius(s, id);
  cf_flake flake;
  cf_snowfall_flake(s, id, kind, radius, &flake);
  draw_turn(s, id, 0.6, turn);
  cf_gust_at(&s->gust, x, 0, wind);
  for (int a = 0; a < 3; ++a) {
    f->attribute[CF_PARTICLE_POSITION].at[a][i] = (cf_real)x[a];
    f->attribute[CF_FLAKE_VELOCITY].at[a][i] = (cf_real)(wind[a] - (a == 2 ? flake.terminal_speed : 0));
  }
  for (int q = 0; q < 4; ++q) f->attribute[CF_FLAKE_ORIENTATION].at[q][i] = (cf_real)turn[q];
  f->attribute[CF_FLAKE_RADIUS].at[0][i] = (cf_real)radius;
  f->attribute[CF_FLAKE_KIND].at[0][i] = (cf_real)kind;
  s->ledger.entered += flake.mass;
}

cf_status cf_snowfall_add(cf_snowfall *s, const int64_t n, const bool at_top) {
  int64_t first;
  CF_TRY(cf_particles_append(s->flakes, n, &first));
  for (int64_t i = first; i < s->flakes->count; ++i) place_flake(s, i, at_top);
  return CF_OK;
}

double cf_snowfall_mass_in_air(const cf_snowfall *s) {
  double sum = 0;
  for (int64_t i = 0; i < s->flakes->count; ++i) {
    const cf_atlas_flake *a = &s->atlas->flakes.item[(int)s->flakes->attribute[CF_FLAKE_KIND].at[0][i]];
    const double scale = (double)s->flakes->attribute[CF_FLAKE_RADIUS].at[0][i] / a->radius;
    sum += a->mass * scale * scale * scale;
  }
  return sum;
}

/* --- the ground ------------------------------------------------------------------------------------------- */

void cf_snowfall_bind(cf_snowfall *s) {
  s->pack.base = s->ground->attribute[CF_GROUND_BASE].at[0];
  s->pack.depth = s->ground->attribute[CF_GROUND_DEPTH].at[0];
}

/* The highest point of the obstacles above (x, y), found from the top by steps and then by halving; the ground where
 * there is none. */
static double base_at(const cf_snowfall *s, const double x, const double y) {
  const double step = s->grid->h / 2;
  double at[3] = {x, y, s->high[2]};
  if (s->obstacles.count == 0) return s->low[2];
  while (at[2] > s->low[2] && cf_obstacles_distance(&s->obstacles, at) > 0) at[2] -= step;
  double above = at[2] + step;
  at[2] = CF_MAX(at[2], s->low[2]); /* it may rise from the ground by less than a step */
  if (cf_obstacles_distance(&s->obstacles, at) > 0) return s->low[2];
  for (int i = 0; i < 20; ++i) {
    const double half = (above + at[2]) / 2, place[3] = {x, y, half};
    if (cf_obstacles_distance(&s->obstacles, place) > 0)
      above = half;
    else
      at[2] = half;
  }
  return above;
}

static cf_status make_ground(cf_snowfall *s) {
  const cf_box *b = &s->grid->box;
  const int64_t columns = (int64_t)b->n[0] * b->n[1];
  CF_TRY(cf_particles_create(&s->ground, "ground", 3, columns));
  CF_TRY(cf_particles_attribute(s->ground, "base", "m", 1, CF_CARRIED, NULL));
  CF_TRY(cf_particles_attribute(s->ground, "depth", "m", 1, CF_CARRIED, NULL));
  CF_TRY(cf_particles_append(s->ground, columns, NULL));
  CF_TRY(CF_NEW(&s->change, columns));
  s->pack =
      (cf_snowpack){.n = {b->n[0], b->n[1]}, .h = s->grid->h, .steepest = tan(s->keys->repose * PI / 180)};
  for (int a = 0; a < 2; ++a) s->pack.place[a] = s->low[a] + s->grid->h / 2;
  s->pack.change = s->change;
  cf_snowfall_bind(s);
  for (int64_t c = 0; c < columns; ++c) {
    const double x = s->pack.place[0] + (double)(c % b->n[0]) * s->grid->h;
    const double y = s->pack.place[1] + (double)(c / b->n[0]) * s->grid->h;
    const double base = base_at(s, x, y);
    cf_real *const *at = s->ground->attribute[CF_PARTICLE_POSITION].at;
    at[0][c] = (cf_real)x, at[1][c] = (cf_real)y, at[2][c] = s->pack.base[c] = (cf_real)base;
  }
  return CF_OK;
}

/* --- all -------------------------------------------------------------------------------------------------- */

static cf_status make_sets(cf_snowfall *s) {
  const int64_t n = s->keys->flakes;
  CF_TRY(cf_particles_create(&s->flakes, "flakes", 3, n + n / 4));
  CF_TRY(cf_particles_attribute(s->flakes, "velocity", "m/s", 3, CF_CARRIED, NULL));
  CF_TRY(cf_particles_attribute(s->flakes, "orientation", "", 4, CF_CARRIED, NULL));
  CF_TRY(cf_particles_attribute(s->flakes, "spin", "rad/s", 3, CF_CARRIED, NULL));
  CF_TRY(cf_particles_attribute(s->flakes, "radius", "m", 1, CF_CARRIED, NULL));
  CF_TRY(cf_particles_attribute(s->flakes, "kind", "", 1, CF_CARRIED, NULL));
  CF_TRY(cf_particles_create(&s->settled, "settled", 3, n));
  CF_TRY(cf_particles_attribute(s->settled, "orientation", "", 4, CF_CARRIED, NULL));
  CF_TRY(cf_particles_attribute(s->settled, "radius", "m", 1, CF_CARRIED, NULL));
  return cf_particles_attribute(s->settled, "kind", "", 1, CF_CARRIED, NULL);
}

static cf_status register_all(cf_snowfall *s, cf_registry *r) {
  CF_TRY(cf_registry_add_particles(r, s->flakes));
  CF_TRY(cf_registry_add_particles(r, s->settled));
  CF_TRY(cf_registry_add_particles(r, s->ground));
  CF_TRY(cf_registry_add_numbers(r, "ledger_snow", "kg", &s->ledger.entered, 2));
  return cf_registry_add_numbers(r, "landed", "", &s->landed, 1);
}

static cf_status read_atlas(cf_snowfall *s) {
  struct stat facts;
  const bool there = stat(s->keys->atlas, &facts) == 0 && access(s->keys->atlas, R_OK) == 0;
  if (!there || !S_ISREG(facts.st_mode))
    return cf_scene_fail_at(s->scene, "snowfall.atlas",
                            "snowfall.atlas: %s: %s (cattaneo atlas makes one of grown crystals)",
                            s->keys->atlas, there ? "is not a file" : strerror(errno));
  CF_TRY(cf_atlas_read(&s->atlas, s->keys->atlas));
  CF_TRY(CF_NEW(&s->shape, s->atlas->flakes.count));
  for (int i = 0; i < s->atlas->flakes.count; ++i) CF_TRY(cf_atlas_measure(s->atlas, i, &s->shape[i]));
  return CF_OK;
}

static cf_status make(cf_snowfall *s, cf_registry *r) {
  const cf_scene_snowfall *k = s->keys;
  for (int a = 0; a < 3; ++a) {
    s->low[a] = s->grid->origin[a];
    s->high[a] = s->low[a] + s->grid->h * s->grid->box.n[a];
  }
  s->air = (cf_air){k->gravity, k->air_density, k->viscosity, k->flutter};
  cf_gust_params gust = {.strength = k->gust_strength,
                         .length = k->given.gust_length ? k->gust_length : (s->high[2] - s->low[2]) / 3,
                         .ground = s->low[2],
                         .seed = (uint64_t)k->seed};
  for (int a = 0; a < 3; ++a) gust.wind[a] = k->wind.value[a];
  for (int a = 0; a < 2; ++a) gust.period[a] = s->high[a] - s->low[a];
  cf_gust_create(&s->gust, &gust);
  CF_TRY(read_atlas(s));
  CF_TRY(cf_obstacles_create(&s->obstacles, s->scene, s->grid));
  CF_TRY(make_ground(s));
  CF_TRY(make_sets(s));
  CF_TRY(register_all(s, r));
  return cf_snowfall_add(s, k->flakes, false);
}

void cf_snowfall_destroy(void *model) {
  cf_snowfall *s = model;
  if (s == NULL) return;
  cf_particles_destroy(s->flakes);
  cf_particles_destroy(s->settled);
  cf_particles_destroy(s->ground);
  cf_atlas_destroy(s->atlas);
  cf_obstacles_destroy(&s->obstacles);
  cf_free(s->shape);
  cf_free(s->change);
  cf_free(s);
}

cf_status cf_snowfall_create(void **model, const cf_scene *scene, cf_registry *registry) {
  cf_snowfall *s;
  CF_TRY(CF_NEW(&s, 1));
  s->scene = scene;
  s->keys = &scene->snowfall;
  s->grid = registry->grid;
  const cf_status status = make(s, registry);
  if (status == CF_OK)
    *model = s;
  else
    cf_snowfall_destroy(s);
  return status;
}

cf_status cf_snowfall_resolve(cf_scene *scene) {
  const cf_scene_snowfall *k = &scene->snowfall;
  if (scene->dim != 3)
    return cf_scene_fail_at(scene, "domain.size", "snow falls in three dimensions, here are two");
  if (!k->given.atlas)
    return cf_scene_fail_at(scene, "snowfall", "snowfall.atlas is missing: which flakes are to fall?");
  if (!(k->radius.value[0] <= k->radius.value[1]))
    return cf_scene_fail_at(scene, "snowfall.radius",
                            "snowfall.radius: the first must not be above the second");
  return CF_OK;
}

double cf_snowfall_memory(const cf_scene *scene) {
  const double columns = (double)scene->domain.cells.value[0] * (double)scene->domain.cells.value[1];
  const double cells = columns * (double)scene->domain.cells.value[2];
  /* in the air 15 numbers and scratch, and as many lying as may fall in the scene's time at a metre a second */
  const double height = scene->domain.size.value[2], falls = 1 + scene->time.end / height;
  return (double)scene->snowfall.flakes * (1.25 * 18 + 12 * falls) * sizeof(cf_real) +
         (8 * columns + cells) * sizeof(cf_real) + 64e6;
}
