/* SPDX-License-Identifier: MIT
 *
 * Model `snowfall` (section 9.6 and Fig 1 of the paper): flakes of an atlas, grown by model `phase`, fall through a
 * gusty wind (physics/flake.h, physics/gust.h) and come to lie on the ground and on obstacles, where a layer grows
 * (physics/snowpack.h), which the paper did not have.
 *
 * The box is periodic sideways. The number in the air stays the same: for a flake that has landed, or has been blown
 * out through the top, another one, with an id of its own, comes in at the top. All that is random about a flake is a
 * function of the seed and its id.
 *
 * The flakes do not see each other, and the wind does not see them or the obstacles.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/rng.h"
#include "model/snowfall_part.h"

#define PI      3.14159265358979323846
#define LONGEST 0.02 /* s: a step at cfl 1 */
#define BURIED  3.0  /* diameters under the top, where nobody sees a flake any more */
#define CAUGHT  0.5  /* radii: so near to the side of an obstacle a flake sticks */

enum { IN_AIR, HAS_LANDED, HAS_LEFT };

/* --- in the air ------------------------------------------------------------------------------------------- */

static void load(const cf_particles *f, const int64_t i, cf_flake_state *state) {
  for (int a = 0; a < 3; ++a) {
    state->x[a] = (double)f->attribute[CF_PARTICLE_POSITION].at[a][i];
    state->v[a] = (double)f->attribute[CF_FLAKE_VELOCITY].at[a][i];
    state->spin[a] = (double)f->attribute[CF_FLAKE_SPIN].at[a][i];
  }
  for (int q = 0; q < 4; ++q) state->turn[q] = (double)f->attribute[CF_FLAKE_ORIENTATION].at[q][i];
}

static void store(cf_particles *f, const int64_t i, const cf_flake_state *state) {
  for (int a = 0; a < 3; ++a) {
    f->attribute[CF_PARTICLE_POSITION].at[a][i] = (cf_real)state->x[a];
    f->attribute[CF_FLAKE_VELOCITY].at[a][i] = (cf_real)state->v[a];
    f->attribute[CF_FLAKE_SPIN].at[a][i] = (cf_real)state->spin[a];
  }
  for (int q = 0; q < 4; ++q) f->attribute[CF_FLAKE_ORIENTATION].at[q][i] = (cf_real)state->turn[q];
}

/* Where a flake is after its move. Its lowest point is that of the disc round it. */
static uint32_t fate(const cf_snowfall *s, const cf_flake_state *state, const double radius) {
  const double body_normal[3] = {0, 0, 1};
  double n[3];
  cf_flake_turn(state->turn, body_normal, n);
  const double hangs = radius * sqrt(fmax(1 - n[2] * n[2], 0));
  if (state->x[2] - hangs <= cf_snowpack_top(&s->pack, state->x[0], state->x[1])) return HAS_LANDED;
  if (s->has_obstacles && cf_shape_distance(&s->obstacle, NULL, 0, state->x) < CAUGHT * radius)
    return HAS_LANDED;
  return state->x[2] > s->high[2] + 2 * radius && state->v[2] > 0 ? HAS_LEFT : IN_AIR;
}

static void move_one(const cf_snowfall *s, const double t, const double dt, const int64_t i) {
  cf_particles *f = s->flakes;
  const double radius = (double)f->attribute[CF_FLAKE_RADIUS].at[0][i];
  cf_flake flake;
  cf_flake_state state;
  double wind[3];
  load(f, i, &state);
  cf_snowfall_flake(s, f->id[i], (int)f->attribute[CF_FLAKE_KIND].at[0][i], radius, &flake);
  cf_gust_at(&s->gust, state.x, t + dt / 2, wind);
  cf_flake_step(&flake, &s->air, t, dt, wind, &state);
  for (int a = 0; a < 2; ++a) {
    const double width = s->high[a] - s->low[a];
    state.x[a] -= width * floor((state.x[a] - s->low[a]) / width);
  }
  store(f, i, &state);
  f->key[i] = fate(s, &state, radius);
}

/* --- landing ---------------------------------------------------------------------------------------------- */

/* The turn that takes the body's z to n, after one about z by `yaw`. */
static void lie_on(const double n[3], const double yaw, double turn[4]) {
  const double size = sqrt(fmax((1 + n[2]) / 2, 1e-12)), x = -n[1] / (2 * size), y = n[0] / (2 * size);
  const double c = cos(yaw / 2), w = sin(yaw / 2);
  turn[0] = size * c;
  turn[1] = x * c + y * w;
  turn[2] = y * c - x * w;
  turn[3] = size * w;
}

/* On the layer's top or where it touched the side of an obstacle, nearly flat. */
static void rest(const cf_snowfall *s, const int64_t id, const double radius, double x[3], double turn[4]) {
  const double top = cf_snowpack_top(&s->pack, x[0], x[1]), e = s->grid->h;
  double n[3] = {0, 0, 1};
  if (x[2] - radius > top + radius) {
    cf_shape_normal(&s->obstacle, NULL, 0, x, 0.1 * e, n);
  } else {
    x[2] = top;
    n[0] = -(cf_snowpack_top(&s->pack, x[0] + e, x[1]) - cf_snowpack_top(&s->pack, x[0] - e, x[1])) / (2 * e);
    n[1] = -(cf_snowpack_top(&s->pack, x[0], x[1] + e) - cf_snowpack_top(&s->pack, x[0], x[1] - e)) / (2 * e);
  }
  for (int a = 0; a < 3; ++a)
    n[a] += 0.3 * (cf_random((uint64_t)s->keys->seed, 100, (uint64_t)a, (uint64_t)id) - 0.5);
  const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (int a = 0; a < 3; ++a) n[a] = length > 0 ? n[a] / length : (a == 2);
  lie_on(n, 2 * PI * cf_random((uint64_t)s->keys->seed, 100, 3, (uint64_t)id), turn);
}

static cf_status settle(cf_snowfall *s, const int64_t i) {
  const cf_particles *f = s->flakes;
  const double radius = (double)f->attribute[CF_FLAKE_RADIUS].at[0][i];
  const int kind = (int)f->attribute[CF_FLAKE_KIND].at[0][i];
  cf_flake flake;
  double x[3], turn[4];
  int64_t j;
  for (int a = 0; a < 3; ++a) x[a] = (double)f->attribute[CF_PARTICLE_POSITION].at[a][i];
  cf_snowfall_flake(s, f->id[i], kind, radius, &flake);
  rest(s, f->id[i], radius, x, turn);
  cf_snowpack_land(&s->pack, x[0], x[1], flake.mass * s->keys->stands_for / s->keys->snow_density);
  s->landed += 1;
  CF_TRY(cf_particles_append(s->settled, 1, &j));
  for (int a = 0; a < 3; ++a) s->settled->attribute[CF_PARTICLE_POSITION].at[a][j] = (cf_real)x[a];
  for (int q = 0; q < 4; ++q) s->settled->attribute[CF_SETTLED_ORIENTATION].at[q][j] = (cf_real)turn[q];
  s->settled->attribute[CF_SETTLED_RADIUS].at[0][j] = (cf_real)radius;
  s->settled->attribute[CF_SETTLED_KIND].at[0][j] = (cf_real)kind;
  return CF_OK;
}

/* In the order of the flakes, which is the same for any number of threads. */
static cf_status land(cf_snowfall *s) {
  int64_t gone = 0;
  for (int64_t i = 0; i < s->flakes->count; ++i) {
    if (s->flakes->key[i] == IN_AIR) continue;
    ++gone;
    if (s->flakes->key[i] == HAS_LANDED) {
      CF_TRY(settle(s, i));
      continue;
    }
    cf_flake flake;
    cf_snowfall_flake(s, s->flakes->id[i], (int)s->flakes->attribute[CF_FLAKE_KIND].at[0][i],
                      (double)s->flakes->attribute[CF_FLAKE_RADIUS].at[0][i], &flake);
    s->ledger.left += flake.mass;
  }
  cf_particles_remove(s->flakes, s->grid->threads);
  return cf_snowfall_add(s, gone, true);
}

/* The layer slides, its points follow, and flakes deep under it are forgotten. */
static void settle_layer(cf_snowfall *s) {
  cf_real *top = s->ground->attribute[CF_PARTICLE_POSITION].at[2];
  cf_particles *lying = s->settled;
  cf_snowpack_slump(&s->pack, s->grid->threads);
  for (int64_t c = 0; c < s->ground->count; ++c) top[c] = s->pack.base[c] + s->pack.depth[c];
  cf_real *const *x = lying->attribute[CF_PARTICLE_POSITION].at;
  for (int64_t i = 0; i < lying->count; ++i) {
    const double under = cf_snowpack_top(&s->pack, (double)x[0][i], (double)x[1][i]) - (double)x[2][i];
    lying->key[i] = under > BURIED * 2 * (double)lying->attribute[CF_SETTLED_RADIUS].at[0][i];
  }
  cf_particles_remove(lying, s->grid->threads);
}

/* --- a step ----------------------------------------------------------------------------------------------- */

static cf_status snowfall_step(void *model, const double t, const double dt, cf_step_report *report) {
  cf_snowfall *s = model;
  double clock = cf_stage_clock();
#pragma omp parallel for schedule(static) num_threads(s->grid->threads)
  for (int64_t i = 0; i < s->flakes->count; ++i) move_one(s, t, dt, i);
  clock = cf_stage_end(report, CF_STAGE_FORCE, clock);
  CF_TRY(land(s));
  settle_layer(s);
  cf_stage_end(report, CF_STAGE_OTHER, clock);
  return CF_OK;
}

static double snowfall_natural_dt(const void *model, const double t) {
  const cf_snowfall *s = model;
  (void)t;
  return s->scene->time.cfl * LONGEST;
}

static cf_status snowfall_restored(void *model) {
  cf_snowfall_bind(model);
  return CF_OK;
}

/* --- what is shown ---------------------------------------------------------------------------------------- */

static bool snowfall_derived(const void *model, const int i, cf_derived *field) {
  (void)model;
  if (i > 0) return false;
  *field = (cf_derived){"snow", "kg/m^3"};
  return true;
}

/* Mass of the flakes in the air, a cell. */
static cf_status snowfall_derive(void *model, const int which, const cf_cell out) {
  const cf_snowfall *s = model;
  const cf_box *b = &s->grid->box;
  const cf_particles *f = s->flakes;
  const double volume = s->grid->h * s->grid->h * s->grid->h;
  (void)which;
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    memset(out.at + cf_box_row(b, r), 0, (size_t)b->n[0] * sizeof *out.at);
  for (int64_t i = 0; i < f->count; ++i) {
    ptrdiff_t p = 0;
    for (int a = 0; a < 3; ++a) {
      const double at = ((double)f->attribute[CF_PARTICLE_POSITION].at[a][i] - s->low[a]) / s->grid->h;
      p += b->stride[a] * (ptrdiff_t)fmin(fmax(floor(at), 0), b->n[a] - 1);
    }
    const cf_atlas_flake *a = &s->atlas->flakes.item[(int)f->attribute[CF_FLAKE_KIND].at[0][i]];
    out.at[p] +=
        (cf_real)(a->mass * pow((double)f->attribute[CF_FLAKE_RADIUS].at[0][i] / a->radius, 3) / volume);
  }
  return CF_OK;
}

static const char *const metric[] = {"in_air",     "landed",    "mean_speed", "max_speed",
                                     "mean_depth", "max_depth", "error_snow"};
enum { METRICS = sizeof metric / sizeof *metric };

static int snowfall_metric_names(const void *model, cf_metric *names) {
  (void)model;
  for (int i = 0; i < METRICS; ++i) snprintf(names[i].name, CF_NAME_MAX, "%s", metric[i]);
  return METRICS;
}

static void snowfall_metrics(const void *model, double *values) {
  const cf_snowfall *s = model;
  double sum = 0, fastest = 0, deepest = 0;
  for (int64_t i = 0; i < s->flakes->count; ++i) {
    double square = 0;
    for (int a = 0; a < 3; ++a) {
      const double v = (double)s->flakes->attribute[CF_FLAKE_VELOCITY].at[a][i];
      square += v * v;
    }
    sum += sqrt(square);
    fastest = fmax(fastest, sqrt(square));
  }
  for (int64_t c = 0; c < s->ground->count; ++c) deepest = fmax(deepest, (double)s->pack.depth[c]);
  const double volume = cf_snowpack_volume(&s->pack), area = s->pack.h * s->pack.h * (double)s->ground->count;
  const double lying = volume * s->keys->snow_density / s->keys->stands_for;
  values[0] = (double)s->flakes->count;
  values[1] = s->landed;
  values[2] = sum / fmax((double)s->flakes->count, 1);
  values[3] = fastest;
  values[4] = volume / area;
  values[5] = deepest;
  values[6] = (cf_snowfall_mass_in_air(s) + lying + s->ledger.left - s->ledger.entered) / s->ledger.entered;
}

static bool snowfall_describe(const void *model, const int line, char *text, const size_t size) {
  const cf_snowfall *s = model;
  cf_flake small, large;
  if (line > 0) return false;
  cf_snowfall_flake(s, 0, 0, s->keys->radius.value[0], &small);
  cf_snowfall_flake(s, 0, 0, s->keys->radius.value[1], &large);
  snprintf(text, size,
           "snowfall: %ld flakes of %d kinds, %.3g to %.3g mm across, falling at %.2g to %.2g m/s (Re %.0f "
           "to %.0f)",
           s->keys->flakes, s->atlas->flakes.count, 2e3 * s->keys->radius.value[0],
           2e3 * s->keys->radius.value[1], small.terminal_speed, large.terminal_speed, small.reynolds,
           large.reynolds);
  return true;
}

static bool snowfall_shows(const cf_scene *scene, const char *name) {
  static const char *const sets[] = {"flakes", "settled", "ground"};
  (void)scene;
  if (strcmp(name, "snow") == 0) return true;
  for (int i = 0; i < 3; ++i) {
    const size_t length = strlen(sets[i]);
    if (strncmp(name, sets[i], length) == 0 && (name[length] == '\0' || name[length] == '.')) return true;
  }
  return false;
}

static const char *const snowfall_keys[] = {"snowfall", "obstacles", NULL};
static const char *const snowfall_outputs[] = {"snow", "flakes", "settled", "ground", NULL};

const cf_model cf_model_snowfall = {
    .name = "snowfall",
    .summary = "flakes of an atlas falling in a gusty wind, and the layer they make",
    .keys = snowfall_keys,
    .outputs = snowfall_outputs,
    .resolve = cf_snowfall_resolve,
    .shows = snowfall_shows,
    .memory = cf_snowfall_memory,
    .create = cf_snowfall_create,
    .destroy = cf_snowfall_destroy,
    .restored = snowfall_restored,
    .natural_dt = snowfall_natural_dt,
    .describe = snowfall_describe,
    .step = snowfall_step,
    .derived = snowfall_derived,
    .derive = snowfall_derive,
    .metric_names = snowfall_metric_names,
    .metrics = snowfall_metrics,
};
