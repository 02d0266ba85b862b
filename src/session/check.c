/* SPDX-License-Identifier: MIT
 *
 * The page of `check`; see check.h. Where the machine has the memory, the model is created as a run would do it
 * (and thrown away): what only a grid can tell is then told here, not at the start of a run.
 */
#include "session/check.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/real.h"
#include "model/obstacles.h"
#include "model/sim.h"
#include "session/check_scalar.h"
#include "session/output.h"
#include "session/space.h"

/* Where a flow crosses more cells than this in a step, what it carries is no longer carried well. */
#define CELLS_A_STEP 2.0
#define MANY_FRAMES  10000.0

static void add(cf_check *c, const char *name, const char *text) { cf_check_add(c, 0, name, text); }

/* --- space ------------------------------------------------------------------------------------------------ */

static void add_grid(cf_check *c) {
  char text[256];
  const cf_scene_domain *d = &c->scene->domain;
  const bool deep = c->scene->dim == 3;
  double cells = 1;
  for (int a = 0; a < c->scene->dim; ++a) cells *= (double)d->cells.value[a];
  int n = snprintf(text, sizeof text, "%ld x %ld", d->cells.value[0], d->cells.value[1]);
  if (deep) n += snprintf(text + n, sizeof text - (size_t)n, " x %ld", d->cells.value[2]);
  snprintf(text + n, sizeof text - (size_t)n, " = %.3g cells of %.4g m", cells, c->scene->spacing);
  add(c, "grid", text);
  n = snprintf(text, sizeof text, "%.4g x %.4g", d->size.value[0], d->size.value[1]);
  if (deep) n += snprintf(text + n, sizeof text - (size_t)n, " x %.4g", d->size.value[2]);
  n += snprintf(text + n, sizeof text - (size_t)n, " m from (");
  for (int a = 0; a < c->scene->dim; ++a)
    n += snprintf(text + n, sizeof text - (size_t)n, "%s%.4g", a > 0 ? ", " : "",
                  d->origin.count > 0 ? d->origin.value[a] : 0.0);
  snprintf(text + n, sizeof text - (size_t)n, ")");
  add(c, "box", text);
}

static void add_walls(cf_check *c, const char *name, const cf_walls *walls) {
  static const char *const words[] = {
#define WALL_WORD(upper, lower) #lower,
      CF_WALL_LIST(WALL_WORD)
#undef WALL_WORD
  };
  char text[256];
  bool same = true;
  int n = 0;
  for (int a = 0; a < c->scene->dim; ++a)
    for (int side = 0; side < 2; ++side) same = same && walls->kind[a][side] == walls->kind[0][0];
  if (same)
    snprintf(text, sizeof text, "%s on all sides", words[walls->kind[0][0]]);
  else
    for (int a = 0; a < c->scene->dim; ++a)
      for (int side = 0; side < 2; ++side)
        n += snprintf(text + n, sizeof text - (size_t)n, "%s%c%c %s", n > 0 ? ", " : "", "xyz"[a], "-+"[side],
                      words[walls->kind[a][side]]);
  add(c, name, text);
}

static cf_status add_flow(cf_check *c) {
  const cf_param_functions *u = &c->scene->velocity;
  char text[128];
  double square = 0;
  bool in_time = false;
  for (int a = 0; a < c->scene->dim; ++a) {
    cf_extremes e;
    const cf_fn *f = &u->axis[u->count > 1 ? a : 0].fn;
    CF_TRY(cf_check_sample(c->scene, f, "velocity", &e));
    const double most = fmax(fabs(e.least), fabs(e.largest));
    square += most * most;
    in_time = in_time || f->in_time;
  }
  c->speed = sqrt(square);
  if (c->speed == 0 && !in_time)
    snprintf(text, sizeof text, "at rest");
  else
    snprintf(text, sizeof text, "up to %.4g m/s%s", c->speed,
             in_time ? " at time 0; it changes with time" : "");
  add(c, "flow", text);
  return CF_OK;
}

/* What gives nothing: easily a slip of the units, or of the sign of an origin. */
static void warn_of_sources(cf_check *c) {
  const cf_scene_domain *d = &c->scene->domain;
  for (int i = 0; i < c->scene->sources.count; ++i) {
    const cf_scene_source *s = &c->scene->sources.item[i];
    bool outside = false;
    for (int a = 0; a < c->scene->dim && s->given.center; ++a) {
      const double low = d->origin.count > 0 ? d->origin.value[a] : 0, high = low + d->size.value[a];
      const double half = s->shape == CF_SCENE_SHAPE_SPHERE ? s->radius : s->half.value[a];
      outside = outside || s->center.value[a] + half <= low || s->center.value[a] - half >= high;
    }
    if (outside) cf_writing_add(&c->warnings, "  sources.%d is outside the box and gives nothing\n", i);
  }
}

/* --- time ------------------------------------------------------------------------------------------------- */

/* The step of `dt: auto` where no model could be made: as the model does it, from the largest values. */
static cf_status guess_dt(cf_check *c) {
  const double h = c->scene->spacing, longest = c->scene->time.end / 100;
  double fastest = 0;
  for (int i = 0; i < c->scene->fields.count; ++i) {
    const cf_scene_diffusion *d = &c->scene->fields.item[i].diffusion;
    cf_extremes k;
    CF_TRY(cf_check_sample(c->scene, &d->k.fn, "diffusion.k", &k));
    const double speed = d->tau > 0 ? sqrt((1 - d->f_t) * k.largest / d->tau) : 0;
    fastest = fmax(fastest, fmax(speed, (d->tau > 0 ? d->f_t : 1) * k.largest / (16 * h)));
  }
  const double rate = (c->speed + fastest) / h;
  c->dt = rate > 0 ? fmin(c->scene->time.cfl / rate, longest) : longest;
  return CF_OK;
}

static void add_time(cf_check *c) {
  char text[256];
  const cf_scene_time *time = &c->scene->time;
  const bool automatic = isnan(time->dt);
  const double frames = time->frames > 0 ? ceil(time->end * time->frames * (1 - 1e-9)) : 1;
  const double interval = time->frames > 0 ? fmin(1 / time->frames, time->end) : time->end;
  const double in_frame = ceil(interval / c->dt * (1 - 1e-9));
  const double in_last = ceil((time->end - (frames - 1) * interval) / c->dt * (1 - 1e-9));
  snprintf(text, sizeof text, "0 to %.4g s in steps of %s%.4g s: about %.0f steps", time->end,
           automatic ? "(auto) " : "", c->dt, (frames - 1) * in_frame + in_last);
  add(c, "time", text);
  snprintf(text, sizeof text, "0 to %.0f, one every %.4g s", frames, interval);
  add(c, "frames", text);
  if (!automatic && c->dt > interval * (1 + 1e-9))
    cf_writing_add(&c->warnings,
                   "  time.dt is longer than the time between frames: steps are shortened to %.4g s\n",
                   interval);
  if (frames > MANY_FRAMES)
    cf_writing_add(&c->warnings, "  time.frames is a rate, frames per s: this run writes %.3g of them\n",
                   frames);
  const double cells = c->speed * c->dt / c->scene->spacing;
  if (cells > CELLS_A_STEP)
    cf_writing_add(&c->warnings,
                   "  the flow crosses %.3g cells a step: time.dt of %.2g s or less carries better\n", cells,
                   CELLS_A_STEP * c->scene->spacing / c->speed);
}

/* --- memory and disk -------------------------------------------------------------------------------------- */

/* Bytes of a frame's fields where no model could be made. */
static double guess_frame(const cf_scene *scene) {
  double cells = sizeof(cf_real), values = 0;
  for (int a = 0; a < scene->dim; ++a) cells *= (double)scene->domain.cells.value[a];
  const bool chosen = scene->output.fields.count > 0;
  const int count = chosen ? scene->output.fields.count : scene->fields.count;
  for (int i = 0; i < count; ++i) {
    const char *name = chosen ? scene->output.fields.item[i] : scene->fields.item[i].name;
    values += cf_scene_name_is_flux(name) || strcmp(name, "velocity") == 0 ? scene->dim : 1;
  }
  return cells * values * __builtin_popcount(scene->output.formats & ~(1u << CF_SCENE_FORMAT_PNG));
}

static void add_memory(cf_check *c) {
  char text[256], one[32], other[32], third[32];
  const double needed = cf_space_memory(c->scene), machine = cf_space_machine();
  cf_space_bytes(needed, one);
  snprintf(text, sizeof text, "%s at most, in %s precision", one, CF_PRECISION);
  add(c, "memory", text);
  if (needed > machine) {
    cf_space_bytes(machine, other);
    cf_writing_add(&c->warnings, "  the run may need %s, this machine has %s\n", one, other);
  }
  const double frame = c->sim != NULL ? cf_space_frame(c->sim) : guess_frame(c->scene),
               free = cf_space_free(".");
  const double frames = c->scene->time.frames > 0 ? c->scene->time.end * c->scene->time.frames + 1 : 2;
  cf_space_bytes(frame, one);
  cf_space_bytes(frame * frames, other);
  cf_space_bytes(free, third);
  snprintf(text, sizeof text, "%s a frame, %s in all, before compression; %s are free here", one, other,
           third);
  add(c, "disk", text);
  if (frame * frames > free)
    cf_writing_add(&c->warnings, "  the frames may need %s of disk, %s are free here\n", other, third);
}

/* --- the page --------------------------------------------------------------------------------------------- */

/* As a run would begin; leaves the step that `dt: auto` takes. */
static cf_status try_model(cf_check *c) {
  c->dt = c->scene->time.dt;
  if (cf_space_memory(c->scene) >= cf_space_machine() / 2) {
    cf_writing_add(&c->warnings,
                   "  too large to be tried here: a run may still find something wrong at its start\n");
    return CF_OK;
  }
  CF_TRY(cf_sim_create(&c->sim, c->scene, omp_get_num_procs()));
  if (isnan(c->dt)) c->dt = c->sim->model->natural_dt(c->sim->state, 0);
  return cf_output_check(c->sim);
}

/* What the model says of how it computes, "name: text", but of scalars that the page has already. */
static void add_model(cf_check *c) {
  const cf_model *model = cf_model_of(c->scene->model);
  char line[CF_SENTENCE_MAX];
  for (int i = 0; c->sim != NULL && model->describe != NULL; ++i) {
    if (!model->describe(c->sim->state, i, line, sizeof line)) return;
    char *end = strstr(line, ": ");
    if (end == NULL) continue;
    *end = '\0';
    if (cf_scene_field_index(c->scene, line) < 0) add(c, line, end + 2);
  }
}

static void row(void *context, const char *name, const char *text) { add(context, name, text); }

static void warn(void *context, const char *sentence) {
  cf_writing_add(&((cf_check *)context)->warnings, "  %s\n", sentence);
}

static cf_status write_page(cf_check *c) {
  const cf_model *model = cf_model_of(c->scene->model);
  cf_writing_add(&c->page, "%s: %s\n\n", cf_scene_path(c->scene),
                 c->scene->title[0] != '\0' ? c->scene->title : "without a title");
  CF_TRY(try_model(c));
  add_grid(c);
  add_walls(c, "walls", &c->scene->domain.walls.walls);
  if (cf_model_reads(model, "velocity")) CF_TRY(add_flow(c));
  if (isnan(c->dt)) CF_TRY(guess_dt(c));
  add_time(c);
  add_memory(c);
  warn_of_sources(c);
  for (int i = 0; i < c->scene->fields.count; ++i) {
    const cf_scene_field *field = &c->scene->fields.item[i];
    const cf_scalar_law law = model->law != NULL ? model->law(c->scene, i) : CF_SCALAR_PLANNED;
    if (cf_scene_name_is_flux(field->name) || law == CF_SCALAR_ELSEWHERE) continue;
    CF_TRY(cf_check_scalar(c, i, law == CF_SCALAR_PLANNED));
    if (field->given.walls) add_walls(c, "  walls", &field->walls.walls);
  }
  const cf_page page = {.row = row, .warn = warn, .context = c};
  add_model(c);
  if (c->sim != NULL) CF_TRY(cf_obstacles_check(c->scene, &page));
  return model->check != NULL ? model->check(c->scene, c->dt, &page) : CF_OK;
}

cf_status cf_check_text(const cf_scene *scene, char **text) {
  cf_check c = {.scene = scene};
  char *warnings = NULL;
  *text = NULL;
  cf_status status = write_page(&c);
  cf_sim_destroy(c.sim);
  const cf_status ended = cf_writing_end(&c.warnings, &warnings);
  if (status == CF_OK) status = ended;
  if (status == CF_OK)
    cf_writing_add(&c.page, "\n%s\n%s", *warnings != '\0' ? "warnings" : "no warnings", warnings);
  cf_free(warnings);
  const cf_status closed = cf_writing_end(&c.page, text);
  if (status == CF_OK) return closed;
  cf_free(*text);
  *text = NULL;
  return status;
}
