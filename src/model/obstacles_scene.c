/* SPDX-License-Identifier: MIT
 *
 * The list of obstacles before there is a grid: what goes with what, what it takes, and what `check` says.
 */
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "model/obstacles.h"

enum { KEY_MAX = 96 };

/* An obstacle under check, with its number for messages. */
typedef struct checked {
  const cf_scene *scene;
  const cf_scene_obstacle *o;
  int number;
} checked;

static cf_status fail_at(const checked *c, const char *name, const char *sentence) {
  char key[KEY_MAX];
  snprintf(key, sizeof key, "obstacles.%d%s%s", c->number, name[0] != '\0' ? "." : "", name);
  return cf_scene_fail_at(c->scene, key, "%s %s", key, sentence);
}

/* --- the shape --------------------------------------------------------------------------------------------- */

/* A key that goes with some shapes only: wanted there, and nowhere else. */
static cf_status check_key(const checked *c, const char *name, const bool given, const bool goes,
                           const bool wanted) {
  static const char *const words[] = {"box", "sphere", "ball", "capsule", "plane", "expression", "file"};
  char sentence[96];
  if (given ? goes : !wanted) return CF_OK;
  snprintf(sentence, sizeof sentence, given ? "does not go with shape: %s%.0s" : "of shape %s needs %s",
           words[c->o->shape], name);
  return fail_at(c, given ? name : "", sentence);
}

static cf_status check_axes(const checked *c, const char *name, const int count) {
  char sentence[96];
  if (count == 0 || count == c->scene->dim) return CF_OK;
  snprintf(sentence, sizeof sentence, "has %d entries, domain.size has %d", count, c->scene->dim);
  return fail_at(c, name, sentence);
}

static cf_status check_normal(const checked *c) {
  double square = 0;
  for (int a = 0; a < c->o->normal.count; ++a) square += c->o->normal.value[a] * c->o->normal.value[a];
  return c->o->given.normal && !(square > 0) ? fail_at(c, "normal", "is no direction: it has no length")
                                             : CF_OK;
}

static cf_status check_shape(const checked *c) {
  const cf_scene_obstacle *o = c->o;
  const int s = o->shape;
  const bool box = s == CF_OBSTACLE_BOX, capsule = s == CF_OBSTACLE_CAPSULE, file = s == CF_OBSTACLE_FILE;
  const bool round = s == CF_OBSTACLE_SPHERE || s == CF_OBSTACLE_BALL || capsule;
  const bool plane = s == CF_OBSTACLE_PLANE, expression = s == CF_OBSTACLE_EXPRESSION;
  const char *dot = file && o->given.file ? strrchr(o->file, '.') : NULL;
  const bool array = dot != NULL && strcmp(dot, ".npy") == 0;
  CF_TRY(check_key(c, "center", o->given.center, !expression && !array, !expression && !file));
  CF_TRY(check_key(c, "half", o->given.half, box || (file && !array), box));
  CF_TRY(check_key(c, "radius", o->given.radius, round, round));
  CF_TRY(check_key(c, "end", o->given.end, capsule, capsule));
  CF_TRY(check_key(c, "normal", o->given.normal, plane, false));
  CF_TRY(check_key(c, "distance", o->given.distance, expression, expression));
  CF_TRY(check_key(c, "file", o->given.file, file, file));
  if (o->given.spacing && !array) return fail_at(c, "spacing", "goes with a NPY file");
  if (o->given.origin && !array) return fail_at(c, "origin", "goes with a NPY file");
  CF_TRY(check_axes(c, "center", o->center.count));
  CF_TRY(check_axes(c, "half", o->half.count));
  CF_TRY(check_axes(c, "end", o->end.count));
  CF_TRY(check_axes(c, "normal", o->normal.count));
  CF_TRY(check_axes(c, "origin", o->origin.count));
  CF_TRY(check_axes(c, "pivot", o->pivot.count));
  return check_normal(c);
}

/* --- the motion -------------------------------------------------------------------------------------------- */

static cf_status check_motion(const checked *c) {
  const cf_scene_obstacle *o = c->o;
  char name[32];
  CF_TRY(check_axes(c, "motion", o->motion.count));
  if (o->path.count > 0 && o->given.motion) return fail_at(c, "motion", "does not go with path");
  if (o->path.count > 0 && o->given.rotation) return fail_at(c, "rotation", "does not go with path");
  for (int i = 0; i < o->path.count; ++i) {
    const cf_scene_obstacle_stop *s = &o->path.item[i];
    snprintf(name, sizeof name, "path.%d", i);
    if (i > 0 && !(s->time > o->path.item[i - 1].time))
      return fail_at(c, name, "is not later than the stop before");
    if (s->given.place != o->path.item[0].given.place)
      return fail_at(c, name, "and the first: one has a place, the other has none");
    CF_TRY(check_axes(c, name, s->place.count));
  }
  return CF_OK;
}

/* --- what it does ------------------------------------------------------------------------------------------ */

static cf_status check_kind(const checked *c) {
  const cf_scene_obstacle *o = c->o;
  char name[CF_NAME_MAX + 16];
  if (o->kind == CF_OBSTACLE_HELD && !o->given.value) return fail_at(c, "kind", "needs `value` beside it");
  if (o->kind == CF_OBSTACLE_WALL && o->given.value)
    return fail_at(c, "value", "goes with kind: held; nothing passes a wall");
  for (int i = 0; i < o->fields.count; ++i) {
    const cf_scene_obstacle_field *f = &o->fields.item[i];
    const bool wall = f->given.kind && f->kind == CF_OBSTACLE_WALL;
    snprintf(name, sizeof name, "fields.%.*s", CF_NAME_MAX, f->name);
    if (cf_scene_field_index(c->scene, f->name) < 0 || cf_scene_name_is_flux(f->name))
      return fail_at(c, name, "is no scalar of this scene");
    if (wall && f->given.value) return fail_at(c, name, "is a wall: nothing passes, it has no value");
    if (!wall && !f->given.value && !o->given.value) return fail_at(c, name, "needs a value to be held at");
  }
  return CF_OK;
}

static bool changes(const cf_scene_obstacle *o) {
  return o->given.motion || o->given.rotation || o->path.count > 0 ||
         (o->given.distance && o->distance.fn.in_time);
}

bool cf_obstacles_change(const cf_scene *scene) {
  for (int i = 0; i < scene->obstacles.count; ++i)
    if (changes(&scene->obstacles.item[i])) return true;
  return false;
}

/* What not every model knows. */
static cf_status check_model(const checked *c) {
  const cf_scene_obstacle *o = c->o;
  const bool gel = c->scene->model == CF_SCENE_MODEL_GEL;
  const bool scalars = cf_model_reads(cf_model_of(c->scene->model), "fields");
  const bool touches = gel || c->scene->model == CF_SCENE_MODEL_FLOW;
  if (!touches && o->contact != CF_OBSTACLE_SEPARATE)
    return fail_at(c, "contact", "goes with models gel and flow");
  if (!gel && o->friction > 0) return fail_at(c, "friction", "goes with model gel");
  if (!scalars && o->kind == CF_OBSTACLE_HELD)
    return fail_at(c, "kind", "must be wall: this model has no scalars to hold");
  if (!scalars && o->fields.count > 0) return fail_at(c, "fields", "goes with models that have scalars");
  if (c->scene->model == CF_SCENE_MODEL_SNOWFALL && changes(o))
    return fail_at(c, "", "moves: snow comes to lie on what stands still");
  return CF_OK;
}

cf_status cf_obstacles_resolve(cf_scene *scene) {
  if (scene->obstacles.count > CF_OBSTACLES_MAX)
    return cf_scene_fail_at(scene, "obstacles", "obstacles: %d are too many, at most %d",
                            scene->obstacles.count, CF_OBSTACLES_MAX);
  for (int i = 0; i < scene->obstacles.count; ++i) {
    const checked c = {scene, &scene->obstacles.item[i], i};
    CF_TRY(check_shape(&c));
    CF_TRY(check_motion(&c));
    CF_TRY(check_kind(&c));
    CF_TRY(check_model(&c));
  }
  return CF_OK;
}

/* --- what it takes ----------------------------------------------------------------------------------------- */

double cf_obstacles_memory(const cf_scene *scene) {
  double cells = 1, scalars = 0;
  if (scene->obstacles.count == 0) return 0;
  for (int a = 0; a < scene->dim; ++a) cells *= (double)scene->domain.cells.value[a] + 2 * CF_HALO;
  for (int f = 0; f < scene->fields.count; ++f) scalars += !cf_scene_name_is_flux(scene->fields.item[f].name);
  /* owners twice; for each scalar and for all of them kinds, values, faces of k, the operator's coefficients */
  const double fields = 3 + 3.0 * scene->dim;
  return cells * (2.0 * sizeof(uint16_t) + (scalars + 1) * (1 + fields * sizeof(cf_real)));
}

static cf_status tell(const cf_obstacles *o, const cf_page *page) {
  const cf_scene *scene = o->scene;
  const double cells = (double)cf_box_cells(&o->grid->box);
  char text[160], name[CF_NAME_MAX + 16];
  snprintf(text, sizeof text, "%d: %td cells, %.3g %% of the box%s, %.3g MB", o->count, o->solid,
           100 * (double)o->solid / cells, o->changes ? " at time 0; they move" : "",
           cf_obstacles_memory(scene) / 1e6);
  page->row(page->context, "obstacles", text);
  for (int f = 0; f < scene->fields.count; ++f) {
    cf_region *r;
    ptrdiff_t held = 0;
    if (!cf_obstacles_holds(o, f)) continue;
    CF_TRY(cf_region_create(&r, o->grid));
    const cf_status s = cf_obstacles_region(o, f, r);
    for (ptrdiff_t row = 0; row < cf_box_rows(&o->grid->box); ++row)
      for (int i = 0; i < o->grid->box.n[0]; ++i)
        held += cf_region_kind(r, cf_box_row(&o->grid->box, row) + i) == CF_CELL_HELD;
    cf_region_destroy(r);
    CF_TRY(s);
    snprintf(name, sizeof name, "  hold %.*s", CF_NAME_MAX, scene->fields.item[f].name);
    snprintf(text, sizeof text, "%td cells; %td are walls", held, o->solid - held);
    page->row(page->context, name, text);
  }
  if (o->solid == 0 && !o->changes)
    page->warn(page->context,
               "no cell has its middle in an obstacle: are they outside the domain, or thinner than a cell?");
  if (o->solid == cf_box_cells(&o->grid->box) && !o->changes)
    page->warn(page->context, "obstacles fill the whole box: no cell is left to compute");
  return CF_OK;
}

cf_status cf_obstacles_check(const cf_scene *scene, const cf_page *page) {
  cf_grid g;
  cf_obstacles o;
  int n[3] = {1, 1, 1};
  if (scene->obstacles.count == 0) return CF_OK;
  for (int a = 0; a < scene->dim; ++a) n[a] = (int)scene->domain.cells.value[a];
  CF_TRY(cf_grid_init(&g, scene->dim, n, scene->spacing,
                      scene->domain.origin.count > 0 ? scene->domain.origin.value : NULL));
  cf_status s = cf_obstacles_create(&o, scene, &g);
  if (s == CF_OK) s = tell(&o, page);
  cf_obstacles_destroy(&o);
  return s;
}
