/* SPDX-License-Identifier: MIT */
#include "session/output.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/folder.h"
#include "io/frame.h"
#include "io/image.h"
#include "io/npy.h"
#include "render/colormap.h"
#include "render/preview.h"
#include "session/overlay.h"

/* The fields to write: those of output.fields, or the scalars and the fluxes that the scene names. */
static int field_names(const cf_sim *sim, const char *names[CF_FRAME_FIELDS]) {
  const cf_scene *scene = sim->scene;
  int count = 0;
  if (scene->output.fields.count > 0) {
    for (int i = 0; i < scene->output.fields.count && count < CF_FRAME_FIELDS; ++i)
      names[count++] = scene->output.fields.item[i];
    return count;
  }
  for (int i = 0; i < scene->fields.count && count < CF_FRAME_FIELDS; ++i)
    names[count++] = scene->fields.item[i].name;
  return count;
}

static const cf_entry *shown_field(const cf_sim *sim) {
  const char *named = sim->scene->output.preview.field, *names[CF_FRAME_FIELDS];
  if (named[0] != '\0') return cf_registry_find(&sim->registry, named);
  const int count = field_names(sim, names);
  for (int i = 0; i < count; ++i) {
    const cf_entry *e = cf_registry_find(&sim->registry, names[i]);
    if (e != NULL && e->kind == CF_KIND_CELL) return e;
  }
  for (int e = 0; e < sim->registry.count; ++e)
    if (sim->registry.entry[e].kind == CF_KIND_CELL) return &sim->registry.entry[e];
  return NULL;
}

/* "phi, q, velocity": what could have been meant. */
static void list_fields(const cf_sim *sim, const bool cells_only, char *text, const size_t size) {
  size_t used = 0;
  text[0] = '\0';
  for (int e = 0; e < sim->registry.count; ++e) {
    const cf_entry *entry = &sim->registry.entry[e];
    const bool fits = entry->kind == CF_KIND_CELL || (!cells_only && entry->kind == CF_KIND_FACE);
    if (fits && used < size)
      used += (size_t)snprintf(text + used, size - used, "%s%s", used > 0 ? ", " : "", entry->name);
  }
}

cf_status cf_output_check(const cf_sim *sim) {
  const cf_scene *scene = sim->scene;
  char known[512], key[64];
  for (int i = 0; i < scene->output.fields.count; ++i) {
    const cf_entry *e = cf_registry_find(&sim->registry, scene->output.fields.item[i]);
    if (e != NULL && e->kind != CF_KIND_NUMBER && e->kind != CF_KIND_COUNTER) continue;
    list_fields(sim, false, known, sizeof known);
    snprintf(key, sizeof key, "output.fields.%d", i);
    return cf_scene_fail_at(scene, key, "there is no field %s; there are %s", scene->output.fields.item[i],
                            known);
  }
  if (scene->output.fields.count > CF_FRAME_FIELDS)
    return cf_scene_fail_at(scene, "output.fields", "more than %d fields", CF_FRAME_FIELDS);
  if (scene->output.preview.field[0] != '\0') {
    const cf_entry *e = shown_field(sim);
    list_fields(sim, true, known, sizeof known);
    if (e == NULL || e->kind != CF_KIND_CELL)
      return cf_scene_fail_at(scene, "output.preview.field", "a picture shows a field in cells: one of %s",
                              known);
  }
  cf_colormap map;
  if (scene->output.preview.map[0] != '\0' && cf_colormap_find(scene->output.preview.map, &map) != CF_OK) {
    char why[CF_SENTENCE_MAX];
    snprintf(why, sizeof why, "%s", cf_status_sentence());
    return cf_scene_fail_at(scene, "output.preview.map", "%s", why);
  }
  return CF_OK;
}

static cf_status write_picture(const cf_sim *sim, const char *folder) {
  const cf_scene_preview *wish = &sim->scene->output.preview;
  const cf_entry *e = shown_field(sim);
  if (e == NULL) return CF_OK;
  cf_overlay overlay;
  cf_overlay_cones(sim, e->name, &overlay);
  cf_preview p = cf_preview_default(e->name, e->unit);
  p.title = sim->scene->title;
  p.time = sim->time;
  p.map = wish->map[0] != '\0' ? wish->map : NULL;
  if (wish->range.count == 2) p.low = wish->range.value[0], p.high = wish->range.value[1];
  if (wish->size.count == 2) p.size = (int)CF_MAX(wish->size.value[0], wish->size.value[1]);
  p.lines = overlay.count;
  p.line = overlay.line;
  cf_canvas canvas;
  CF_TRY(cf_preview_draw(&canvas, &sim->grid, e->cell.at, &p));
  cf_path path;
  char time[40];
  snprintf(time, sizeof time, "%.17g", sim->time);
  const cf_image_text text[] = {{"Title", sim->scene->title}, {"Field", e->name}, {"Time", time}};
  cf_status s = cf_path_make(&path, "%s/preview_%06lld.png", folder, (long long)sim->frame);
  if (s == CF_OK) s = cf_image_write(path.text, canvas.width, canvas.height, canvas.rgb, 3, text);
  cf_canvas_destroy(&canvas);
  return s;
}

cf_status cf_output_frame(const cf_sim *sim, const char *folder) {
  const unsigned formats = sim->scene->output.formats;
  const char *names[CF_FRAME_FIELDS];
  const cf_frame_plan plan = {.count = field_names(sim, names), .names = names};
  const cf_stamp stamp = {.title = sim->scene->title, .time = sim->time, .step = sim->step};
  if (formats & 1u << CF_SCENE_FORMAT_VTKHDF)
    CF_TRY(cf_frame_write(folder, sim->frame, &sim->registry, &plan, &stamp));
  if (formats & 1u << CF_SCENE_FORMAT_NPY)
    CF_TRY(cf_npy_write(folder, sim->frame, &sim->registry, plan.count, plan.names));
  if (formats & 1u << CF_SCENE_FORMAT_PNG) CF_TRY(write_picture(sim, folder));
  return CF_OK;
}
