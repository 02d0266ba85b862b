/* SPDX-License-Identifier: MIT
 *
 * One scalar's regime as text; see check_scalar.h and, for the numbers, stencil/regime.h. With a capacity C it is
 * the diffusivity D = k/C that sets speeds. Where k, C or the flow vary, the largest D and the largest |u| count.
 */
#include "session/check_scalar.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/real.h"
#include "model/plan.h"
#include "model/scene_params.h"
#include "solve/multigrid.h"
#include "stencil/regime.h"

static const double pi = 3.14159265358979323846;

/* Points of the lattice on an axis: enough to find an extreme of anything that the cells could show. */
enum { LATTICE_2D = 256, LATTICE_3D = 64 };

/* Fewer cells than this do not carry a wave; more cells a step than this smear a front. */
#define CELLS_A_WAVE     6.0
#define CELLS_A_SIDE     8
#define CELLS_A_STEP     2.0
#define STEPS_OF_NOTHING 10.0 /* dt/tau above this: memory is over within a step */

/* --- sampling --------------------------------------------------------------------------------------------- */

static void row_extremes(const cf_fn *f, const int n, const double *x, const double *y, const double *z,
                         cf_extremes *e) {
  double value[LATTICE_2D];
  cf_fn_row(f, n, x, y, z, 0, value);
  for (int i = 0; i < n; ++i) {
    if (!isfinite(value[i])) e->least = e->largest = NAN;
    if (value[i] < e->least) e->least = value[i];
    if (value[i] > e->largest) e->largest = value[i];
  }
}

cf_status cf_check_sample(const cf_scene *scene, const cf_fn *f, const char *key, cf_extremes *e) {
  const double *size = scene->domain.size.value;
  double place[3][LATTICE_2D], origin[3] = {0};
  int n[3] = {1, 1, 1};
  *e = (cf_extremes){f->value, f->value};
  if (cf_fn_is_constant(f)) return CF_OK;
  *e = (cf_extremes){INFINITY, -INFINITY};
  for (int a = 0; a < scene->dim; ++a) {
    if (scene->domain.origin.count > 0) origin[a] = scene->domain.origin.value[a];
    n[a] = (int)CF_MIN(scene->domain.cells.value[a], scene->dim == 2 ? LATTICE_2D : LATTICE_3D);
  }
  double y[LATTICE_2D], z[LATTICE_2D];
  for (int i = 0; i < n[0]; ++i) place[0][i] = origin[0] + (i + 0.5) * size[0] / n[0];
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        y[i] = origin[1] + (j + 0.5) * size[1] / n[1];
        z[i] = scene->dim == 3 ? origin[2] + (k + 0.5) * size[2] / n[2] : 0;
      }
      row_extremes(f, n[0], place[0], y, z, e);
      if (isnan(e->least)) return cf_scene_fail_at(scene, key, "%s is not finite somewhere in the box", key);
    }
  return CF_OK;
}

/* --- the numbers of a scalar ------------------------------------------------------------------------------ */

typedef struct numbers {
  const cf_scene_field *field;
  const cf_scene_diffusion *d;
  cf_extremes k, capacity;
  double D; /* the largest k/C, m^2/s */
  double c; /* the largest front speed, m/s; INFINITY without memory */
  bool waves;
  double dt; /* of a step between two frames, s */
  cf_plan plan;
  bool planned, implicit; /* the plan counts; it is implicit */
} numbers;

static cf_status find_numbers(const cf_check *c, const int field, numbers *n) {
  const cf_scene *scene = c->scene;
  n->field = &scene->fields.item[field];
  n->d = &n->field->diffusion;
  CF_TRY(cf_check_sample(scene, &n->d->k.fn, "diffusion.k", &n->k));
  CF_TRY(cf_check_sample(scene, &n->d->capacity.fn, "diffusion.capacity", &n->capacity));
  n->D = n->k.largest / n->capacity.least;
  n->c = cf_regime_speed(n->D, n->d->tau, n->d->f_t);
  n->waves = n->c > 0 && isfinite(n->c);
  n->dt = cf_plan_step(scene, c->dt);
  cf_plan_make(scene, field, n->D, n->dt, &n->plan);
  n->implicit = n->plan.scheme == CF_DIFFUSE_PAPER || n->plan.scheme == CF_DIFFUSE_SDIRK2;
  return CF_OK;
}

void cf_check_add(cf_check *c, const int indent, const char *name, const char *text) {
  const int column = 16, width = 96;
  cf_writing_add(&c->page, "%*s%-*s", indent, "", column - indent, name);
  for (int at = column; *text != '\0';) {
    const int length = (int)strcspn(text, " ");
    if (at > column && at + 1 + length > width) {
      cf_writing_add(&c->page, "\n%*s", column, "");
      at = column;
    }
    cf_writing_add(&c->page, "%s%.*s", at > column ? " " : "", length, text);
    at += length + (at > column ? 1 : 0);
    text += length;
    text += strspn(text, " ");
  }
  cf_writing_add(&c->page, "\n");
}

static void add(cf_check *c, const char *name, const char *text) { cf_check_add(c, 2, name, text); }

static void extremes_text(const cf_extremes *e, const char *unit, char *text, const size_t size) {
  if (e->least == e->largest)
    snprintf(text, size, "%.4g%s", e->least, unit);
  else
    snprintf(text, size, "%.4g to %.4g%s", e->least, e->largest, unit);
}

static void add_law(cf_check *c, const numbers *n) {
  char text[256], k[64], capacity[64];
  extremes_text(&n->k, " m^2/s", k, sizeof k);
  extremes_text(&n->capacity, "", capacity, sizeof capacity);
  const bool plain = n->capacity.least == 1 && n->capacity.largest == 1;
  const char *law = n->D == 0                          ? "no diffusion"
                    : n->d->tau == 0 || n->d->f_t == 1 ? "Fourier's law"
                    : n->d->f_t == 0                   ? "Cattaneo's law"
                                                       : "Cattaneo's and Fourier's law mixed";
  snprintf(text, sizeof text, "k = %s, tau = %.4g s, F_T = %.4g%s%s: %s", k, n->d->tau, n->d->f_t,
           plain ? "" : ", C = ", plain ? "" : capacity, law);
  add(c, "diffusion", text);
}

/* --- waves ------------------------------------------------------------------------------------------------ */

static void warn_of_short_waves(cf_check *c, const double length, const char *which) {
  const double cells = length / c->scene->spacing;
  if (cells < CELLS_A_WAVE)
    cf_writing_add(&c->warnings,
                   "  %s are %.2g cells long: finer cells show them (%g cells or more a wave)\n", which,
                   cells, CELLS_A_WAVE);
}

static void add_waves(cf_check *c, const numbers *n) {
  char text[256], name[128];
  const double tau = n->d->tau, reach = 2 * n->c * tau;
  const cf_wave_band band = cf_regime_wave_band(n->D, tau, n->d->f_t);
  if (!n->waves) {
    add(c, "waves", n->D == 0 ? "none" : "none: what diffuses is felt everywhere at once");
    return;
  }
  snprintf(text, sizeof text, "%.4g m/s%s", n->c, isfinite(band.peak) ? " (the fastest of the band)" : "");
  add(c, "front speed", text);
  if (isinf(band.high)) {
    snprintf(text, sizeof text, "shorter than %.3g m; they die out in %.3g s, after %.3g m",
             2 * pi / band.low, 2 * tau, reach);
    snprintf(name, sizeof name, "waves of %.40s", n->field->name);
    warn_of_short_waves(c, 2 * pi / band.low, name);
  } else {
    snprintf(text, sizeof text, "%.3g to %.3g m long, fastest at %.3g m; Fourier's share blurs over %.3g m",
             2 * pi / band.high, 2 * pi / band.low, 2 * pi / band.peak, cf_regime_blur(n->D, tau, n->d->f_t));
    snprintf(name, sizeof name, "the fastest waves of %.40s", n->field->name);
    warn_of_short_waves(c, 2 * pi / band.peak, name);
  }
  add(c, "waves", text);
}

static void add_stream(cf_check *c, const numbers *n) {
  char text[256];
  if (!n->waves || c->speed == 0) return;
  const double H_c = cf_regime_number(c->speed, n->c);
  const cf_regime regime = cf_regime_of(n->D, n->d->tau, n->d->f_t, c->speed);
  const char *word = cf_regime_word(regime);
  if (regime == CF_REGIME_SUPERCRITICAL)
    snprintf(text, sizeof text, "%.4g: %s, a cone of half-angle %.3g degrees, seen over %.3g m", H_c, word,
             cf_regime_cone_angle(H_c) * 180 / pi, cf_regime_cone_length(c->speed, n->d->tau, H_c));
  else if (regime == CF_REGIME_CRITICAL)
    snprintf(text, sizeof text, "1: %s, fronts stand still against the stream", word);
  else
    snprintf(text, sizeof text, "%.4g: %s, fronts go upstream at %.3g m/s", H_c, word, n->c - c->speed);
  add(c, "H_c", text);
}

/* The keys that could stand for k, tau and f_t; the thickness is that of the box. */
static void add_words(cf_check *c, const numbers *n) {
  char text[512];
  double side = INFINITY;
  for (int a = 0; a < c->scene->dim; ++a) /* an axis of a few cells stands for a scene of fewer dimensions */
    if (c->scene->domain.cells.value[a] >= CELLS_A_SIDE) side = CF_MIN(side, c->scene->domain.size.value[a]);
  if (isinf(side)) side = 0;
  const cf_scene_measures m = cf_scene_measure(n->D, n->d->tau, n->d->f_t, c->speed, side);
  cf_scene_measures_text(&m, side, text, sizeof text);
  if (n->D > 0) add(c, "same as", text);
}

/* --- the step --------------------------------------------------------------------------------------------- */

static void add_step(cf_check *c, const numbers *n) {
  char text[256];
  const double h = c->scene->spacing, tau = n->d->tau, cells = n->c * n->dt / h;
  const char *name = n->field->name;
  if (n->waves)
    snprintf(text, sizeof text, "dt/tau = %.3g; a front crosses %.3g cells a step", n->dt / tau, cells);
  else
    snprintf(text, sizeof text, "k dt/h^2 = %.3g", n->D * n->dt / (h * h));
  if (n->D > 0) add(c, "step", text);
  if (!n->waves) return;
  if (n->dt > STEPS_OF_NOTHING * tau)
    cf_writing_add(&c->warnings,
                   "  dt is %.3g tau: memory of %.40s is over within a step, which leaves Fourier's law\n",
                   n->dt / tau, name);
  else if (n->planned && n->implicit && cells > CELLS_A_STEP)
    cf_writing_add(&c->warnings,
                   "  fronts of %.40s cross %.3g cells a step and get smeared: time.dt of %.2g s or less\n",
                   name, cells, CELLS_A_STEP * h / n->c);
}

/* How the solver goes about a stage, from the solver itself, and why so. */
static cf_status describe_solver(const cf_scene *scene, const numbers *n, const double sigma, char *text,
                                 const size_t size) {
  static const struct {
    const char *method, *why;
  } reason[] = {{"sor", "half sweeps alone, for diffusion adds little to the diagonal"},
                {"multigrid", "cycles alone, for the coefficients are numbers"},
                {"multigrid-pcg", "conjugate gradients around cycles"},
                {"pcg", "conjugate gradients, for diffusion adds little to the diagonal"},
                {"line", "elimination, for it is a line"},
                {"direct", "elimination, for cells are few"}};
  cf_grid g;
  cf_helmholtz *A;
  int cells[3] = {1, 1, 1};
  const double h = scene->spacing;
  for (int a = 0; a < scene->dim; ++a) cells[a] = (int)scene->domain.cells.value[a];
  CF_TRY(cf_grid_init(&g, scene->dim, cells, h, NULL));
  CF_TRY(cf_helmholtz_create(&A, &g, &n->field->walls.walls, (int)scene->solver.levels));
  const cf_status status = cf_helmholtz_set(A, &(cf_coefficients){.alpha = 1, .beta = sigma * h * h});
  const bool varies = n->k.least != n->k.largest || n->capacity.least != n->capacity.largest;
  const char *method = varies ? "multigrid-pcg" : cf_helmholtz_method(A), *why = "";
  const int levels = varies ? A->levels : strcmp(method, "sor") == 0 ? 1 : A->depth;
  for (size_t v = 0; v < sizeof reason / sizeof *reason; ++v)
    if (strcmp(method, reason[v].method) == 0) why = reason[v].why;
  snprintf(text, size, "sigma = %.3g, %d level%s of multigrid: %s", sigma, levels, levels == 1 ? "" : "s",
           why);
  cf_helmholtz_destroy(A);
  return status;
}

static cf_status add_scheme(cf_check *c, const numbers *n) {
  char text[256];
  const bool paper = n->plan.scheme == CF_DIFFUSE_PAPER;
  const double delta = (paper ? 1 : 1 - sqrt(0.5)) * n->dt, h = c->scene->spacing;
  const double sigma = cf_regime_sigma(cf_regime_stage(delta, n->d->tau, n->d->f_t), n->D, h);
  add(c, "scheme", n->plan.why);
  if (n->implicit && c->sim != NULL) {
    CF_TRY(describe_solver(c->scene, n, sigma, text, sizeof text));
    add(c, "solver", text);
  }
  snprintf(text, sizeof text, "%s%s",
           n->plan.scalar_form ? "kept as its divergence, one number a cell" : "kept on faces",
           n->plan.front_filter ? "; front filter on" : "");
  add(c, "flux", text);
  if (paper && n->waves && n->c * n->dt > 0.5 * h)
    cf_writing_add(&c->warnings, "  scheme paper smears the fronts of %.40s: `scheme: default` keeps them\n",
                   n->field->name);
  return CF_OK;
}

/* --- everything ------------------------------------------------------------------------------------------- */

cf_status cf_check_scalar(cf_check *c, const int field, const bool planned) {
  numbers n = {.planned = planned};
  CF_TRY(find_numbers(c, field, &n));
  cf_writing_add(&c->page, "\n%s\n", n.field->name);
  add_law(c, &n);
  add_waves(c, &n);
  add_stream(c, &n);
  add_words(c, &n);
  add_step(c, &n);
  if (!planned) return CF_OK;
  if (n.D > 0) CF_TRY(add_scheme(c, &n));
  if (n.waves && n.d->f_t < 0.1 && !n.plan.positive)
    add(c, "note", "values may fall below 0 where fronts meet, as those of the exact solution do");
  return CF_OK;
}
