/* SPDX-License-Identifier: MIT
 *
 * The clock: which times are frames, how long the next step is, and what is checked after it. What a step does is
 * the model's.
 */
#include "model/sim.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/locale.h"
#include "base/mem.h"
#include "base/threads.h"
#include "model/obstacles.h"

static cf_status register_clock(cf_sim *sim) {
  CF_TRY(cf_registry_add_numbers(&sim->registry, "time", "s", &sim->time, 1));
  CF_TRY(cf_registry_add_numbers(&sim->registry, "dt", "s", &sim->dt, 1));
  CF_TRY(cf_registry_add_counter(&sim->registry, "step", &sim->step));
  if (sim->scene->time.retry > 0) CF_TRY(cf_registry_add_counter(&sim->registry, "retries", &sim->retries));
  return cf_registry_add_counter(&sim->registry, "frame", &sim->frame);
}

/* --- what a frame shows ----------------------------------------------------------------------------------- */

static const cf_obstacles *obstacles_of(const cf_sim *sim) {
  const cf_obstacles *o = sim->model->obstacles != NULL ? sim->model->obstacles(sim->state) : NULL;
  return o != NULL && o->count > 0 ? o : NULL;
}

/* Memory for the field that shows obstacles. */
static cf_status add_solid(cf_sim *sim) {
  cf_cell values;
  if (obstacles_of(sim) == NULL || cf_registry_find(&sim->shown, "solid") != NULL) return CF_OK;
  CF_TRY(cf_cell_create(&values, &sim->grid.box));
  const cf_status s = cf_registry_add_cell(&sim->shown, "solid", "", values);
  if (s != CF_OK) cf_cell_destroy(&values, &sim->grid.box);
  return s;
}

/* Memory for a derived field that the scene asks for. */
static cf_status add_derived(cf_sim *sim, const char *name) {
  cf_derived field;
  if (sim->model->derived == NULL || cf_registry_find(&sim->shown, name) != NULL) return CF_OK;
  for (int i = 0; sim->model->derived(sim->state, i, &field); ++i) {
    if (strcmp(field.name, name) != 0) continue;
    cf_cell values;
    CF_TRY(cf_cell_create(&values, &sim->grid.box));
    const cf_status s = cf_registry_add_cell(&sim->shown, name, field.unit, values);
    if (s != CF_OK) cf_cell_destroy(&values, &sim->grid.box);
    return s;
  }
  return CF_OK;
}

static cf_status make_shown(cf_sim *sim) {
  const cf_scene_output *output = &sim->scene->output;
  CF_TRY(cf_registry_init(&sim->shown, &sim->grid));
  CF_TRY(cf_registry_add_all(&sim->shown, &sim->registry));
  CF_TRY(add_solid(sim));
  for (int i = 0; i < output->fields.count; ++i) CF_TRY(add_derived(sim, output->fields.item[i]));
  return add_derived(sim, output->preview.field);
}

cf_status cf_sim_show(cf_sim *sim) {
  cf_derived field;
  const cf_obstacles *o = obstacles_of(sim);
  if (o != NULL) cf_obstacles_show(o, cf_registry_find(&sim->shown, "solid")->cell);
  for (int i = 0; sim->model->derived != NULL && sim->model->derived(sim->state, i, &field); ++i) {
    const cf_entry *e = cf_registry_find(&sim->shown, field.name);
    if (e != NULL) CF_TRY(sim->model->derive(sim->state, i, e->cell));
  }
  return sim->model->show != NULL ? sim->model->show(sim->state) : CF_OK;
}

static void destroy_shown(cf_sim *sim) {
  for (int e = sim->registry.count; e < sim->shown.count; ++e)
    cf_cell_destroy(&sim->shown.entry[e].cell, &sim->grid.box);
  cf_registry_clear(&sim->shown);
}

/* --- creation --------------------------------------------------------------------------------------------- */

static cf_status create(cf_sim *sim, const int threads) {
  const cf_scene *scene = sim->scene;
  int cells[3] = {1, 1, 1};
  CF_TRY(cf_threads_start(threads));
  for (int a = 0; a < scene->dim; ++a) cells[a] = (int)scene->domain.cells.value[a];
  CF_TRY(cf_grid_init(&sim->grid, scene->dim, cells, scene->spacing,
                      scene->domain.origin.count > 0 ? scene->domain.origin.value : NULL));
  sim->grid.threads = threads;
  CF_TRY(cf_registry_init(&sim->registry, &sim->grid));
  CF_TRY(register_clock(sim));
  CF_TRY(sim->model->create(&sim->state, scene, &sim->registry));
  return make_shown(sim);
}

cf_status cf_sim_create(cf_sim **sim, const cf_scene *scene, const int threads) {
  *sim = NULL;
  if (threads < 1) return cf_fail(CF_BAD_ARGUMENT, "%d threads: must be at least 1", threads);
  cf_sim *fresh;
  CF_TRY(CF_NEW(&fresh, 1));
  fresh->scene = scene;
  fresh->model = cf_model_of(scene->model);
  fresh->end = scene->time.end;
  void *before = cf_locale_plain();
  const cf_status s = create(fresh, threads);
  cf_locale_back(before);
  if (s != CF_OK) {
    cf_sim_destroy(fresh);
    return s;
  }
  *sim = fresh;
  return CF_OK;
}

void cf_sim_destroy(cf_sim *sim) {
  if (sim == NULL) return;
  sim->model->destroy(sim->state);
  destroy_shown(sim);
  cf_registry_clear(&sim->registry);
  cf_free(sim);
}

/* What is written and shown stands where the box is now; the model's own grid stays. */
static void place_box(cf_sim *sim) {
  double by[3] = {0};
  if (sim->model->moved == NULL) return;
  sim->model->moved(sim->state, by);
  for (int a = 0; a < sim->scene->dim; ++a) {
    const cf_param_numbers *origin = &sim->scene->domain.origin;
    sim->grid.origin[a] = (a < origin->count ? origin->value[a] : 0) + by[a];
  }
}

cf_status cf_sim_restored(cf_sim *sim) {
  if (sim->model->restored != NULL) CF_TRY(sim->model->restored(sim->state));
  place_box(sim);
  return CF_OK;
}

/* --- frames -----------------------------------------------------------------------------------------------
 */

int64_t cf_sim_frames(const cf_sim *sim) {
  const double rate = sim->scene->time.frames, whole = sim->scene->time.end * rate;
  if (rate == 0) return 2;
  const double nearest = round(whole);
  if (fabs(whole - nearest) <= 1e-9 * CF_MAX(1, nearest)) return (int64_t)nearest + 1;
  return (int64_t)floor(whole) + 2;
}

double cf_sim_frame_time(const cf_sim *sim, const int64_t i) {
  if (i <= 0) return 0;
  return i >= cf_sim_frames(sim) - 1 ? sim->scene->time.end : (double)i / sim->scene->time.frames;
}

bool cf_sim_finished(const cf_sim *sim) { return sim->time >= sim->end; }
double cf_sim_time(const cf_sim *sim) { return sim->time; }
double cf_sim_end(const cf_sim *sim) { return sim->end; }
int64_t cf_sim_step_count(const cf_sim *sim) { return sim->step; }

/* --- a step -----------------------------------------------------------------------------------------------
 */

static cf_status check_converged(cf_sim *sim) {
  const cf_solve_report *solve = &sim->report.solve;
  if (solve->converged) return CF_OK;
  char why[sizeof sim->warning];
  snprintf(why, sizeof why,
           "the solver stopped at a residual of %.3g after %d iterations in step %lld (t = %g s), above "
           "solver.tolerance = %g: raise the tolerance or solver.max_iterations, or take a smaller dt",
           solve->residual, solve->iterations, (long long)sim->step, sim->time, sim->scene->solver.tolerance);
  if (sim->scene->solver.on_stall == CF_SCENE_STALL_STOP) return cf_fail(CF_NOT_CONVERGED, "%s", why);
  if (sim->warning[0] == '\0') snprintf(sim->warning, sizeof sim->warning, "%s", why);
  return CF_OK;
}

static cf_status make_step(cf_sim *sim, const double t, const double dt) {
  memset(&sim->report, 0, sizeof sim->report);
  sim->report.solve.converged = true;
  CF_TRY(sim->model->step(sim->state, t, dt, &sim->report));
  place_box(sim);
  snprintf(sim->warning, sizeof sim->warning, "%s", sim->report.warning);
  return CF_OK;
}

/* A solver that was given what is not finite knows no place: the state is looked at for one. */
static cf_status find_not_finite(cf_sim *sim, const double dt) {
  char why[CF_SENTENCE_MAX];
  snprintf(why, sizeof why, "%s", cf_status_sentence());
  sim->dt = dt;
  ++sim->step;
  CF_TRY(cf_sim_check_finite(sim));
  return cf_fail(CF_NOT_FINITE, "%.700s, in step %lld from t = %g s with dt = %g s", why,
                 (long long)sim->step, sim->time, dt);
}

/* One step, that ends at `until` at the latest. */
static cf_status step(cf_sim *sim, const double until, bool *on_frame) {
  const double chosen =
      isnan(sim->scene->time.dt) ? sim->model->natural_dt(sim->state, sim->time) : sim->scene->time.dt;
  const double wish = ldexp(chosen, -(int)sim->retries);
  const double frame_time = cf_sim_frame_time(sim, sim->frame + 1), stop = CF_MIN(frame_time, until);
  const double left = stop - sim->time;
  const bool lands = left <= wish * (1 + 1e-9);
  const double dt = lands ? left : wish;
  if (!(sim->time + dt > sim->time))
    return cf_fail(CF_FAILED, "the step of %g s is too short to move time on from t = %g s", dt, sim->time);
  const cf_status made = make_step(sim, sim->time, dt);
  if (made != CF_OK) return made == CF_NOT_FINITE ? find_not_finite(sim, dt) : made;
  sim->time = lands ? stop : sim->time + dt;
  sim->dt = dt;
  ++sim->step;
  *on_frame = lands && stop == frame_time;
  if (*on_frame) ++sim->frame;
  CF_TRY(cf_sim_check_finite(sim));
  return check_converged(sim);
}

cf_status cf_sim_step(cf_sim *sim, bool *on_frame) {
  bool landed;
  if (cf_sim_finished(sim))
    return cf_fail(CF_FAILED, "no step is left: the run has reached its end, t = %g s", sim->end);
  return step(sim, sim->end, on_frame != NULL ? on_frame : &landed);
}

cf_status cf_sim_run(cf_sim *sim, const double until, const cf_sim_progress progress, void *context) {
  bool landed;
  if (isnan(until)) return cf_fail(CF_BAD_ARGUMENT, "a run until t = %g s: must be a number", until);
  const double stop = CF_MIN(until, sim->end);
  while (sim->time < stop) {
    CF_TRY(step(sim, stop, &landed));
    if (progress != NULL && !progress(context, sim))
      return cf_fail(CF_STOPPED, "stopped on request at step %lld, t = %g s", (long long)sim->step,
                     sim->time);
  }
  return CF_OK;
}

const char *cf_sim_warning(const cf_sim *sim) { return sim->warning; }

/* --- metrics ----------------------------------------------------------------------------------------------
 */

#define COMMON_METRICS 5

int cf_sim_metric_names(const cf_sim *sim, cf_metric *names) {
  static const char *const common[COMMON_METRICS] = {"step", "time", "dt", "iterations", "residual"};
  for (int i = 0; i < COMMON_METRICS; ++i) snprintf(names[i].name, sizeof names[i].name, "%s", common[i]);
  return COMMON_METRICS + sim->model->metric_names(sim->state, names + COMMON_METRICS);
}

void cf_sim_metrics(const cf_sim *sim, double *values) {
  values[0] = (double)sim->step;
  values[1] = sim->time;
  values[2] = sim->dt;
  values[3] = sim->report.solve.iterations;
  values[4] = sim->report.solve.residual;
  sim->model->metrics(sim->state, values + COMMON_METRICS);
}
