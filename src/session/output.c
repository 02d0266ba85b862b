/* SPDX-License-Identifier: MIT */
#include "session/output.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/folder.h"
#include "io/frame.h"
#include "io/image.h"
#include "io/mesh.h"
#include "io/npy.h"
#include "io/vdb.h"
#include "render/colormap.h"
#include "render/preview.h"
#include "session/overlay.h"

static bool has_format(const cf_sim *sim, const int format) {
  return sim->scene->output.formats >> format & 1;
}

static bool is_drawable(const cf_entry *e) { return e->kind == CF_KIND_CELL || e->kind == CF_KIND_FACE; }

/* What the picture shows: the field that the scene names, or the first one there is where that has no picture of its
 * own (particles). NULL: there is nothing to draw. */
static const cf_entry *shown_field(const cf_sim *sim) {
  const cf_entry *e = cf_registry_find(&sim->shown, sim->scene->output.preview.field);
  for (int i = 0; i < sim->shown.count && (e == NULL || !is_drawable(e)); ++i) e = &sim->shown.entry[i];
  return e != NULL && is_drawable(e) ? e : NULL;
}

/* Passes the latest sentence on, at a key of the scene. */
static cf_status fail_at(const cf_scene *scene, const char *key) {
  char why[CF_SENTENCE_MAX];
  snprintf(why, sizeof why, "%s", cf_status_sentence());
  return cf_scene_fail_at(scene, key, "%s", why);
}

static cf_status check_fields(const cf_sim *sim) {
  const cf_scene *scene = sim->scene;
  char key[64];
  for (int i = 0; i < scene->output.fields.count; ++i) {
    const char *name = scene->output.fields.item[i];
    snprintf(key, sizeof key, "output.fields.%d", i);
    if (cf_choice_check(&(cf_choice){1, &name}, &sim->shown) != CF_OK) return fail_at(scene, key);
  }
  if (scene->output.fields.count > CF_FRAME_FIELDS)
    return cf_scene_fail_at(scene, "output.fields", "more than %d fields", CF_FRAME_FIELDS);
  return CF_OK;
}

static cf_status check_formats(const cf_sim *sim) {
  if (has_format(sim, CF_SCENE_FORMAT_PLY) && sim->model->mesh == NULL)
    return cf_scene_fail_at(sim->scene, "output.formats", "model %s has no surface to write as ply",
                            sim->model->name);
  if (has_format(sim, CF_SCENE_FORMAT_VDB) && !cf_vdb_built())
    return cf_scene_fail_at(
        sim->scene, "output.formats",
        "vdb files need OpenVDB, which this program was built without: install libopenvdb-dev and "
        "libboost-dev and build again");
  return CF_OK;
}

static cf_status check_preview(const cf_sim *sim) {
  const cf_scene_preview *preview = &sim->scene->output.preview;
  const char *name = preview->field;
  cf_colormap map;
  if (!has_format(sim, CF_SCENE_FORMAT_PNG)) return CF_OK;
  if (cf_choice_check(&(cf_choice){1, &name}, &sim->shown) != CF_OK)
    return fail_at(sim->scene, "output.preview.field");
  if (preview->map[0] != '\0' && cf_colormap_find(preview->map, &map) != CF_OK)
    return fail_at(sim->scene, "output.preview.map");
  return CF_OK;
}

cf_status cf_output_check(const cf_sim *sim) {
  CF_TRY(check_fields(sim));
  CF_TRY(check_formats(sim));
  return check_preview(sim);
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
  const cf_entry *solid = cf_registry_find(&sim->shown, "solid");
  if (solid != NULL && solid->kind == CF_KIND_CELL && solid != e) p.solid = solid->cell.at;
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
  if (e == NULL) return CF_OK;
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

static cf_status write_surface(const cf_sim *sim, const char *folder, const cf_stamp *stamp, cf_mesh *mesh) {
  cf_path path;
  CF_TRY(sim->model->mesh(sim->state, mesh));
  if (has_format(sim, CF_SCENE_FORMAT_VTKHDF))
    CF_TRY(cf_frame_write_mesh(folder, sim->frame, &sim->grid, mesh, stamp));
  if (!has_format(sim, CF_SCENE_FORMAT_PLY)) return CF_OK;
  CF_TRY(cf_path_make(&path, "%s/mesh_%06lld.ply", folder, (long long)sim->frame));
  return cf_ply_write(path.text, mesh, stamp);
}

/* A model's surface is made where the scene asks for ply; with vtkhdf it is written as that too. */
static cf_status write_mesh(const cf_sim *sim, const char *folder, const cf_stamp *stamp) {
  cf_mesh *mesh;
  if (sim->model->mesh == NULL || !has_format(sim, CF_SCENE_FORMAT_PLY)) return CF_OK;
  CF_TRY(cf_mesh_create(&mesh));
  const cf_status s = write_surface(sim, folder, stamp, mesh);
  cf_mesh_destroy(mesh);
  return s;
}

static cf_status write_volumes(const cf_sim *sim, const char *folder, const cf_choice choice,
                               const cf_stamp *stamp) {
  const cf_scene_vdb *wish = &sim->scene->output.vdb;
  const cf_vdb_plan plan = {.choice = choice,
                            .half = wish->half == CF_SCENE_SWITCH_ON,
                            .prune = wish->prune,
                            .rate = sim->scene->time.frames};
  return cf_vdb_write(folder, sim->frame, &sim->shown, &plan, stamp);
}

cf_status cf_output_frame(cf_sim *sim, const char *folder) {
  const cf_param_texts *fields = &sim->scene->output.fields;
  const cf_choice choice = {fields->count, fields->item};
  const cf_stamp stamp = {.title = sim->scene->title, .time = sim->time, .step = sim->step};
  CF_TRY(cf_sim_show(sim));
  if (has_format(sim, CF_SCENE_FORMAT_VTKHDF))
    CF_TRY(cf_frame_write(folder, sim->frame, &sim->shown, &(cf_frame_plan){choice, 0}, &stamp));
  if (has_format(sim, CF_SCENE_FORMAT_NPY)) CF_TRY(cf_npy_write(folder, sim->frame, &sim->shown, &choice));
  if (has_format(sim, CF_SCENE_FORMAT_VDB)) CF_TRY(write_volumes(sim, folder, choice, &stamp));
  CF_TRY(write_mesh(sim, folder, &stamp));
  return has_format(sim, CF_SCENE_FORMAT_PNG) ? write_picture(sim, folder) : CF_OK;
}
