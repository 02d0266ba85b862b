/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "app/showing.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/real.h"
#include "io/mesh.h"
#include "render/cloud.h"
#include "render/colormap.h"
#include "render/turn.h"

enum { RANGE_FRAMES = 12, /* looked at for a film's range */ WIDTH = 1280, HEIGHT = 720 };

/* --- how ------------------------------------------------------------------------------------------------------------- */

static const char *model_of(const cf_scene *scene) {
  static const char *const words[] = {
#define WORD(upper, lower) #lower,
      CF_MODEL_WORDS(WORD)
#undef WORD
  };
  return words[scene->model];
}

static cf_style usual_style(const cf_scene *scene) {
  const char *model = model_of(scene);
  if (strcmp(model, "snowfall") == 0) return CF_STYLE_CARDS;
  if (strcmp(model, "gel") == 0) return scene->dim == 3 ? CF_STYLE_GEL : CF_STYLE_PARTICLES;
  if (strcmp(model, "phase") == 0) return scene->dim == 3 ? CF_STYLE_CORAL : CF_STYLE_CRYSTAL;
  return scene->dim == 3 ? CF_STYLE_INK : CF_STYLE_FIELD;
}

static cf_status no_style(const char *given) {
  static const char words[] = CF_WORDS(CF_RENDER_STYLE_WORDS);
  const int length = (int)sizeof words - 2; /* without the last bar */
  char near[32];
  if (cf_param_word_nearest(words, given, near, sizeof near))
    return cf_fail(CF_BAD_USAGE, "--style %.64s: must be one of %.*s; did you mean %s?", given, length, words,
                   near);
  return cf_fail(CF_BAD_USAGE, "--style %.64s: must be one of %.*s", given, length, words);
}

static cf_status take_style(cf_showing *s, const cf_arguments *a) {
  char word[32];
  if (a->style == NULL) {
    cf_param_word_at(CF_WORDS(CF_RENDER_STYLE_WORDS), s->scene->render.style, word, sizeof word);
    s->look.style = cf_style_find(word);
  } else {
    s->look.style = cf_style_find(a->style);
    if (s->look.style == CF_STYLES && strcmp(a->style, "auto") != 0) return no_style(a->style);
  }
  if (s->look.style == CF_STYLES) s->look.style = usual_style(s->scene);
  return CF_OK;
}

/* Which axis is upwards. */
static int up_of(const cf_showing *s) {
  const int word = s->scene->render.camera.up; /* auto, x, y, z */
  const double *size = s->scene->domain.size.value;
  if (s->scene->dim == 2 || s->look.style == CF_STYLE_CARDS) return 2;
  if (word > 0) return word - 1;
  for (int a = 0; a < 2; ++a)
    if (size[a] > 1.01 * size[(a + 1) % 3] && size[a] > 1.01 * size[(a + 2) % 3]) return a;
  return 2;
}

static void take_vector(const cf_param_numbers *from, double to[3]) {
  for (int a = 0; a < 3 && from->count == 3; ++a) to[a] = from->value[a];
}

static void take_look(cf_showing *s, const cf_arguments *a) {
  const cf_scene_render *r = &s->scene->render;
  const cf_scene_camera *c = &r->camera;
  cf_look *l = &s->look;
  *l = cf_look_default(l->style);
  l->framed = a->width > 0 || r->size.count == 2;
  l->width = a->width > 0 ? a->width : l->framed ? (int)r->size.value[0] : WIDTH;
  l->height = a->height > 0 ? a->height : l->framed ? (int)r->size.value[1] : HEIGHT;
  l->samples = (int)r->samples, l->noise = r->noise;
  l->threads = a->threads > 0 ? a->threads : omp_get_num_procs();
  l->exposure = r->exposure, l->strength = r->strength, l->level = r->level;
  l->map = r->map[0] != '\0' ? r->map : NULL;
  l->contours = (int)r->contours, l->floor = r->floor;
  if (r->range.count == 2) l->low = r->range.value[0], l->high = r->range.value[1];
  take_vector(&r->colour, l->colour);
  take_vector(&r->background, l->background);
  take_vector(&c->aim, l->aim);
  take_vector(&c->eye, l->eye);
  l->turn = c->turn, l->rise = c->rise, l->angle = c->angle, l->zoom = c->zoom;
  l->focus = c->focus, l->aperture = c->aperture, l->shutter = c->shutter;
  l->light_turn = r->light.turn, l->light_rise = r->light.rise;
  s->up = up_of(s);
  cf_turn_vector(s->up, l->aim);
  cf_turn_vector(s->up, l->eye);
  l->light_strength = r->light.strength, l->light_spread = r->light.spread;
}

static cf_status take_names(cf_showing *s, const cf_arguments *a) {
  const cf_scene_render *r = &s->scene->render;
  const char *preview = s->scene->output.preview.field;
  const char *field = a->field != NULL ? a->field : r->field[0] != '\0' ? r->field : preview;
  const char *surface = r->surface[0] != '\0' ? r->surface : preview;
  cf_colormap map;
  if (strlen(field) >= CF_NAME_MAX || strlen(surface) >= CF_NAME_MAX)
    return cf_fail(CF_BAD_USAGE, "%.64s...: the name of a field is not that long", field);
  snprintf(s->field, sizeof s->field, "%s", field);
  snprintf(s->surface, sizeof s->surface, "%s", surface);
  if (s->look.map == NULL || cf_colormap_find(s->look.map, &map) == CF_OK) return CF_OK;
  char why[CF_SENTENCE_MAX];
  snprintf(why, sizeof why, "%s", cf_status_sentence());
  return cf_scene_fail_at(s->scene, "render.map", "%s", why);
}

/* --- opening ----------------------------------------------------------------------------------------------------------- */

static cf_status list_frames(cf_showing *s) {
  static const char *const words[][2] = {{"fields", "vtkhdf"}, {"particles", "vtkhdf"}, {"mesh", "ply"}};
  for (size_t i = 0; i < sizeof words / sizeof *words; ++i) {
    CF_TRY(cf_folder_numbers(s->folder, words[i][0], words[i][1], &s->frames, &s->number));
    if (s->frames > 0) return CF_OK;
    cf_free(s->number);
    s->number = NULL;
  }
  return cf_fail(CF_BAD_FILE, "%s: has no frames to show; output.formats must have vtkhdf in it", s->folder);
}

/* What has been computed stays as it is. */
static cf_status check_sets(const cf_arguments *a) {
  for (int i = 0; i < a->sets; ++i) {
    const size_t length = strcspn(a->set[i], ".=");
    if (strncmp(a->set[i], "render", length) == 0 || strncmp(a->set[i], "title", length) == 0) continue;
    return cf_fail(CF_BAD_USAGE,
                   "--set %.200s: pictures show what a run has computed; of its scene render and title alone "
                   "may be set for them",
                   a->set[i]);
  }
  return CF_OK;
}

cf_status cf_showing_open(cf_showing *s, const char *folder, const cf_arguments *a) {
  cf_path path;
  *s = (cf_showing){.folder = folder};
  CF_TRY(check_sets(a));
  CF_TRY(cf_path_make(&path, "%s/run.yaml", folder));
  if (access(path.text, R_OK) != 0)
    return cf_fail(CF_BAD_FILE, "%s: is no folder of a run: run.yaml: %s", folder, strerror(errno));
  cf_status status = cf_scene_read(&s->scene, path.text, a->sets, a->set);
  if (status == CF_OK) status = take_style(s, a);
  if (status == CF_OK) take_look(s, a);
  if (status == CF_OK) status = take_names(s, a);
  if (status == CF_OK) status = list_frames(s);
  if (status != CF_OK) cf_showing_close(s);
  return status;
}

static void unload(cf_showing *s) {
  for (int i = 0; i < CF_EXHIBIT_FIELDS; ++i) {
    if (s->values[i].at != NULL) cf_cell_destroy(&s->values[i], &s->grid.box);
    s->values[i].at = NULL;
  }
  cf_mesh_destroy(s->mesh);
  cf_points_clear(&s->points);
  cf_free(s->value);
  cf_free(s->velocity);
  cf_flock_clear(s->flock);
  cf_canvas_destroy(&s->inset);
  s->mesh = NULL, s->value = s->velocity = NULL;
  s->exhibit = (cf_exhibit){.title = NULL};
}

void cf_showing_close(cf_showing *s) {
  unload(s);
  cf_flock_destroy(s->flock);
  cf_free(s->number);
  cf_scene_destroy(s->scene);
  s->number = NULL, s->scene = NULL, s->flock = NULL;
}

/* --- what ---------------------------------------------------------------------------------------------------------------- */

static const cf_frame_field *find(const cf_frame *f, const char *name) {
  for (int i = 0; i < f->count; ++i)
    if (strcmp(f->field[i].name, name) == 0) return &f->field[i];
  return NULL;
}

/* Adds a field to the exhibit as `known`: its values, the length of vectors, or one component. */
static cf_status add_field(cf_showing *s, const char *name, const char *known, const int component) {
  const int n = s->exhibit.fields;
  const cf_frame_field *f = find(&s->frame, name);
  cf_cell values;
  CF_TRY(cf_cell_create(&values, &s->frame.grid.box));
  cf_status status = cf_frame_read_cell(&s->frame, name, component, values);
  if (status == CF_OK) status = cf_cell_create(&s->values[n], &s->grid.box);
  if (status == CF_OK) cf_turn_field(s->up, &s->frame.grid, values.at, &s->grid, s->values[n].at);
  cf_cell_destroy(&values, &s->frame.grid.box);
  CF_TRY(status);
  s->exhibit.field[n] = (cf_exhibit_field){known, f != NULL ? f->unit : "", s->values[n].at};
  s->exhibit.fields = n + 1;
  return CF_OK;
}

static int size_of(const cf_frame *f, const char *name) {
  const cf_frame_field *field = find(f, name);
  return field != NULL && field->components > 1 ? CF_MAGNITUDE : 0;
}

/* The grid of what is shown. */
static cf_status upright(cf_showing *s, const cf_grid *g) {
  s->exhibit.grid = &s->grid;
  if (g->box.dim == 3) return cf_turn_grid(s->up, g, &s->grid);
  s->grid = *g;
  return CF_OK;
}

static cf_status read_head(cf_showing *s, const int64_t number) {
  cf_path path;
  CF_TRY(cf_path_make(&path, "%s/fields_%06" PRId64 ".vtkhdf", s->folder, number));
  CF_TRY(cf_frame_read(&s->frame, path.text));
  s->exhibit.time = s->frame.time;
  return upright(s, &s->frame.grid);
}

static cf_status load_fields(cf_showing *s, const int64_t number) {
  const char *arrows = s->scene->render.arrows;
  CF_TRY(read_head(s, number));
  const bool crystal = s->look.style == CF_STYLE_CRYSTAL;
  const char *main = crystal ? s->surface : s->field;
  CF_TRY(add_field(s, main, main, size_of(&s->frame, main)));
  static const char *const relief[] = {"thickness", "age"};
  for (int i = 0; i < 2 && crystal; ++i)
    if (find(&s->frame, relief[i]) != NULL) CF_TRY(add_field(s, relief[i], relief[i], 0));
  if (s->look.style != CF_STYLE_FIELD) return CF_OK;
  if (find(&s->frame, "solid") != NULL && strcmp(main, "solid") != 0)
    CF_TRY(add_field(s, "solid", "solid", 0));
  if (arrows[0] != '\0') {
    CF_TRY(add_field(s, arrows, "arrows_x", 0));
    CF_TRY(add_field(s, arrows, "arrows_y", 1));
  }
  cf_overlay_cones(s->scene, &s->frame.grid, s->frame.time, main, &s->overlay);
  s->exhibit.lines = s->overlay.count, s->exhibit.line = s->overlay.line;
  return CF_OK;
}

static bool has_file(const cf_showing *s, const char *word, const char *ext, const int64_t number) {
  int count;
  int64_t *numbers;
  bool found = false;
  if (cf_folder_numbers(s->folder, word, ext, &count, &numbers) != CF_OK) return false;
  for (int i = 0; i < count; ++i) found = found || numbers[i] == number;
  cf_free(numbers);
  return found;
}

/* The mesh that the run wrote, or the surface of a field; and what colours it. */
static cf_status load_surface(cf_showing *s, const int64_t number) {
  s->exhibit.attribute = s->field;
  const bool fields = has_file(s, "fields", "vtkhdf", number);
  if (fields) CF_TRY(read_head(s, number));
  if (has_file(s, "mesh", "ply", number)) {
    cf_path path;
    CF_TRY(cf_path_make(&path, "%s/mesh_%06" PRId64 ".ply", s->folder, number));
    CF_TRY(cf_mesh_create(&s->mesh));
    s->exhibit.mesh = s->mesh;
    CF_TRY(cf_mesh_read(s->mesh, path.text));
    cf_turn_mesh(s->up, s->mesh);
    return CF_OK;
  }
  if (!fields)
    return cf_fail(CF_BAD_FILE, "%s: frame %" PRId64 " has neither a mesh nor fields", s->folder, number);
  CF_TRY(add_field(s, s->surface, s->surface, size_of(&s->frame, s->surface)));
  if (strcmp(s->field, s->surface) == 0) return CF_OK;
  return add_field(s, s->field, s->field, size_of(&s->frame, s->field));
}

static cf_status load_particles(cf_showing *s, const int64_t number) {
  cf_path path;
  CF_TRY(cf_path_make(&path, "%s/particles_%06" PRId64 ".vtkhdf", s->folder, number));
  CF_TRY(cf_points_read(&s->points, path.text));
  s->exhibit.time = s->points.time;
  s->exhibit.particles = s->points.count;
  cf_turn_vectors(s->up, s->points.count, s->points.place);
  s->exhibit.place = (const float(*)[3])s->points.place;
  /* The field in the previews need not be an attribute; one that was asked for must be. */
  const bool asked = strcmp(s->field, s->scene->output.preview.field) != 0;
  cf_status status = cf_points_attribute(&s->points, s->field, 1, &s->value);
  if (status != CF_OK && (asked || status != CF_BAD_FILE)) return status;
  s->exhibit.value = s->value;
  if (s->look.shutter > 0) {
    CF_TRY(cf_points_attribute(&s->points, "velocity", 3, &s->velocity));
    cf_turn_vectors(s->up, s->points.count, (float(*)[3])s->velocity);
    s->exhibit.velocity = (const float(*)[3])s->velocity;
  }
  return CF_OK;
}

/* Points as the density of ink or smoke. */
static cf_status load_cloud(cf_showing *s, const int64_t number) {
  const double cell = s->grid.h;
  const cf_grid coarse = s->grid;
  cf_path path;
  CF_TRY(cf_path_make(&path, "%s/particles_%06" PRId64 ".vtkhdf", s->folder, number));
  CF_TRY(cf_points_read(&s->points, path.text));
  s->exhibit.time = s->points.time;
  cf_turn_vectors(s->up, s->points.count, s->points.place);
  cf_cloud_grid(&coarse, s->points.count, &s->grid);
  CF_TRY(cf_cell_create(&s->values[0], &s->grid.box));
  cf_cloud_density(&s->grid, cell, s->points.count, (const float(*)[3])s->points.place, s->values[0]);
  s->exhibit.field[0] = (cf_exhibit_field){"points", "1/cell", s->values[0].at};
  s->exhibit.fields = 1;
  return CF_OK;
}

static bool is_cloud(const cf_showing *s) {
  return s->scene->points.count > 0 && strcmp(s->field, "points") == 0;
}

/* The box of the scene, where no file says more. */
static cf_status scene_grid(cf_showing *s) {
  const cf_scene_domain *d = &s->scene->domain;
  int cells[3] = {1, 1, 1};
  for (int a = 0; a < s->scene->dim; ++a) cells[a] = (int)d->cells.value[a];
  cf_grid g;
  CF_TRY(cf_grid_init(&g, s->scene->dim, cells, s->scene->spacing, d->origin.value));
  CF_TRY(cf_box_init(&g.box, s->scene->dim, cells, 0));
  return upright(s, &g);
}

/* When frame `number` is, for files that do not say it. */
static double time_of(const cf_scene *scene, const int64_t number) {
  const double time = scene->time.frames > 0 ? (double)number / scene->time.frames
                      : number > 0           ? INFINITY
                                             : 0;
  return CF_MIN(time, scene->time.end);
}

cf_status cf_showing_load(cf_showing *s, const int64_t number) {
  unload(s);
  s->exhibit.title = s->scene->title[0] != '\0' ? s->scene->title : NULL;
  s->exhibit.time = time_of(s->scene, number);
  CF_TRY(scene_grid(s));
  cf_status status;
  switch (s->look.style) {
    case CF_STYLE_CORAL:
    case CF_STYLE_MESH:
    case CF_STYLE_GEL:
      status = load_surface(s, number);
      break;
    case CF_STYLE_PARTICLES:
      status = load_particles(s, number);
      break;
    case CF_STYLE_CARDS:
      status = cf_flock_load(s, number);
      break;
    default:
      status = is_cloud(s) ? load_cloud(s, number) : load_fields(s, number);
  }
  if (status == CF_OK && s->scene->render.plot.count > 0) status = cf_showing_inset(s);
  return status;
}

/* --- range --------------------------------------------------------------------------------------------------------------- */

/* So near that the crystal of this frame, the last of those that are shown, fills the picture. */
static cf_status frame_crystal(cf_showing *s, const int64_t number) {
  if (cf_scene_has(s->scene, "render.camera.zoom") || s->scene->dim != 2) return CF_OK;
  CF_TRY(cf_showing_load(s, number));
  s->look.zoom = cf_crystal_zoom(&s->exhibit);
  return CF_OK;
}

cf_status cf_showing_range(const int count, cf_showing *s, const int64_t *from, const int64_t *to) {
  double low = (double)INFINITY, high = -(double)INFINITY;
  for (int i = 0; i < count; ++i) {
    const cf_look look = s[i].look;
    if (look.style == CF_STYLE_CARDS) return CF_OK;
    if (look.style == CF_STYLE_CRYSTAL) {
      CF_TRY(frame_crystal(&s[i], s[i].number[to[i]]));
      continue;
    }
    if (!isnan(look.low)) continue; /* its scene says one */
    const int64_t frames = to[i] - from[i] + 1, looks = CF_MIN(frames, RANGE_FRAMES);
    for (int64_t n = 0; n < looks; ++n) {
      const int64_t at = from[i] + (looks > 1 ? n * (frames - 1) / (looks - 1) : 0);
      CF_TRY(cf_showing_load(&s[i], s[i].number[at]));
      CF_TRY(cf_exhibit_range(&look, &s[i].exhibit, &low, &high));
    }
  }
  for (int i = 0; i < count; ++i)
    if (isnan(s[i].look.low) && low < high) s[i].look.low = low, s[i].look.high = high;
  return CF_OK;
}

cf_status cf_showing_draw(cf_showing *s, cf_canvas *c) {
  s->look.inset = s->inset.rgb != NULL ? &s->inset : NULL;
  return cf_look_draw(&s->look, &s->exhibit, c);
}
