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

static const cf_entry *shown_field(const cf_sim *sim) {
  return cf_registry_find(&sim->shown, sim->scene->output.preview.field);
}

/* "phi, q, velocity": what could have been meant. */
static void list_fields(const cf_sim *sim, char *text, const size_t size) {
  size_t used = 0;
  text[0] = '\0';
  for (int e = 0; e < sim->shown.count; ++e) {
    const cf_entry *entry = &sim->shown.entry[e];
    const bool fits = entry->kind == CF_KIND_CELL || entry->kind == CF_KIND_FACE;
    if (fits && used < size)
      used += (size_t)snprintf(text + used, size - used, "%s%s", used > 0 ? ", " : "", entry->name);
  }
}

cf_status cf_output_check(const cf_sim *sim) {
  const cf_scene *scene = sim->scene;
  char known[512], key[64];
  for (int i = 0; i < scene->output.fields.count; ++i) {
    const cf_entry *e = cf_registry_find(&sim->shown, scene->output.fields.item[i]);
    if (e != NULL && e->kind != CF_KIND_NUMBER && e->kind != CF_KIND_COUNTER) continue;
    list_fields(sim, known, sizeof known);
    snprintf(key, sizeof key, "output.fields.%d", i);
    return cf_scene_fail_at(scene, key, "there is no field %s; there are %s", scene->output.fields.item[i],
                            known);
  }
  if (scene->output.fields.count > CF_FRAME_FIELDS)
    return cf_scene_fail_at(scene, "output.fields", "more than %d fields", CF_FRAME_FIELDS);
  const cf_entry *shown = shown_field(sim);
  if (shown == NULL || (shown->kind != CF_KIND_CELL && shown->kind != CF_KIND_FACE)) {
    list_fields(sim, known, sizeof known);
    return cf_scene_fail_at(scene, "output.preview.field", "there is no field %s; there are %s",
                            scene->output.preview.field, known);
  }
  cf_colormap map;
  if (scene->output.preview.map[0] != '\0' && cf_colormap_find(scene->output.preview.map, &map) != CF_OK) {
    char why[CF_SENTENCE_MAX];
    snprintf(why, sizeof why, "%s", cf_status_sentence());
    return cf_scene_fail_at(scene, "output.preview.map", "%s", why);
  }
  return CF_OK;
}

/* |q| in cells, from the means of opposite faces. */
static void magnitude(const cf_box *box, const cf_face q, const cf_cell out) {
  for (ptrdiff_t r = 0; r < cf_box_rows(box); ++r)
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(box, r) + i;
      double sum = 0;
      for (int a = 0; a < box->dim; ++a) {
        const double mean = 0.5 * ((double)q.at[a][p] + (double)q.at[a][p + box->stride[a]]);
        sum += mean * mean;
      }
      out.at[p] = (cf_real)sqrt(sum);
    }
}

static cf_status draw(const cf_sim *sim, const cf_entry *e, const cf_real *values, cf_canvas *canvas) {
  const cf_scene_preview *wish = &sim->scene->output.preview;
  cf_overlay overlay;
  cf_overlay_cones(sim->scene, &sim->grid, sim->time, e->name, &overlay);
  cf_preview p = cf_preview_default(e->name, e->unit);
  p.title = sim->scene->title;
  p.time = sim->time;
  p.map = wish->map[0] != '\0' ? wish->map : NULL;
  if (wish->range.count == 2) p.low = wish->range.value[0], p.high = wish->range.value[1];
  if (wish->size.count == 2) p.size = (int)CF_MAX(wish->size.value[0], wish->size.value[1]);
  p.lines = overlay.count;
  p.line = overlay.line;
  return cf_preview_draw(canvas, &sim->grid, values, &p);
}

static cf_status draw_shown(const cf_sim *sim, const cf_entry *e, cf_canvas *canvas) {
  if (e->kind == CF_KIND_CELL) return draw(sim, e, e->cell.at, canvas);
  cf_cell size;
  CF_TRY(cf_cell_create(&size, &sim->grid.box));
  magnitude(&sim->grid.box, e->face, size);
  const cf_status s = draw(sim, e, size.at, canvas);
  cf_cell_destroy(&size, &sim->grid.box);
  return s;
}

static cf_status write_picture(const cf_sim *sim, const char *folder) {
  const cf_entry *e = shown_field(sim);
  cf_canvas canvas;
  cf_path path;
  char time[40];
  CF_TRY(draw_shown(sim, e, &canvas));
  snprintf(time, sizeof time, "%.17g", sim->time);
  const cf_image_text text[] = {{"Title", sim->scene->title}, {"Field", e->name}, {"Time", time}};
  cf_status s = cf_path_make(&path, "%s/preview_%06lld.png", folder, (long long)sim->frame);
  if (s == CF_OK) s = cf_image_write(path.text, canvas.width, canvas.height, canvas.rgb, 3, text);
  cf_canvas_destroy(&canvas);
  return s;
}

cf_status cf_output_frame(cf_sim *sim, const char *folder) {
  const unsigned formats = sim->scene->output.formats;
  const cf_param_texts *fields = &sim->scene->output.fields;
  const cf_frame_plan plan = {.count = fields->count, .names = fields->item};
  const cf_stamp stamp = {.title = sim->scene->title, .time = sim->time, .step = sim->step};
  CF_TRY(cf_sim_show(sim));
  if (formats & 1u << CF_SCENE_FORMAT_VTKHDF)
    CF_TRY(cf_frame_write(folder, sim->frame, &sim->shown, &plan, &stamp));
  if (formats & 1u << CF_SCENE_FORMAT_NPY)
    CF_TRY(cf_npy_write(folder, sim->frame, &sim->shown, plan.count, plan.names));
  if (formats & 1u << CF_SCENE_FORMAT_PNG) CF_TRY(write_picture(sim, folder));
  return CF_OK;
}
