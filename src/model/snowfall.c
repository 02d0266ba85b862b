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
  if (s->obstacles.count > 0 && cf_obstacles_distance(&s->obstacles, state->x) < CAUGHT * radius)
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
    cf_obstacles_normal(&s->obstacles, x, 0.1 * e, n);
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
  /* Those that it stands for lie around it, side by side. */
  cf_snowpack_land(&s->pack, x[0], x[1], radius * sqrt(s->keys->stands_for),
                   flake.mass * s->keys->stands_for / s->keys->snow_density);
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

static const char *const snowfall_keys[] = {"snowfall", "obstacles", NULL};
static const char *const snowfall_outputs[] = {"snow", "flakes", "settled", "ground", NULL};

const cf_model cf_model_snowfall = {
    .name = "snowfall",
    .summary = "flakes of an atlas falling in a gusty wind, and the layer they make",
    .keys = snowfall_keys,
    .outputs = snowfall_outputs,
    .resolve = cf_snowfall_resolve,
    .shows = cf_snowfall_shows,
    .memory = cf_snowfall_memory,
    .create = cf_snowfall_create,
    .destroy = cf_snowfall_destroy,
    .restored = snowfall_restored,
    .natural_dt = snowfall_natural_dt,
    .describe = cf_snowfall_describe,
    .step = snowfall_step,
    .derived = cf_snowfall_derived,
    .derive = cf_snowfall_derive,
    .mesh = cf_snowfall_mesh,
    .metric_names = cf_snowfall_metric_names,
    .metrics = cf_snowfall_metrics,
};
