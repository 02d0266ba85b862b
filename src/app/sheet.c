/* SPDX-License-Identifier: MIT
 *
 * cattaneo sheet DIR... -o FILE.png
 */
#include "app/sheet.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/command.h"
#include "base/mem.h"
#include "io/frame.h"
#include "io/image.h"
#include "model/scene.h"
#include "render/preview.h"
#include "session/overlay.h"

enum { WIDTH = 1400, CAPTION = 160 };

/* One run of the sheet. */
typedef struct exhibit {
  cf_scene *scene;
  cf_frame frame; /* of the fields, */
  cf_cell values;
  cf_canvas picture; /* or a preview */
  char caption[CAPTION];
} exhibit;

static void clear(exhibit *e, const int count) {
  for (int i = 0; e != NULL && i < count; ++i) {
    if (e[i].values.at != NULL) cf_cell_destroy(&e[i].values, &e[i].frame.grid.box);
    cf_canvas_destroy(&e[i].picture);
    cf_scene_destroy(e[i].scene);
  }
  cf_free(e);
}

/* The number of the last file WORD_<number>.EXT; -1: there is none. */
static cf_status last_number(const char *folder, const char *word, const char *ext, int64_t *last) {
  int count;
  int64_t *numbers;
  CF_TRY(cf_folder_numbers(folder, word, ext, &count, &numbers));
  *last = count > 0 ? numbers[count - 1] : -1;
  cf_free(numbers);
  return CF_OK;
}

static cf_status read_fields(const char *folder, const int64_t number, const char *field, exhibit *e) {
  cf_path path;
  CF_TRY(cf_path_make(&path, "%s/fields_%06lld.vtkhdf", folder, (long long)number));
  CF_TRY(cf_frame_read(&e->frame, path.text));
  CF_TRY(cf_cell_create(&e->values, &e->frame.grid.box));
  int components = 1;
  for (int i = 0; i < e->frame.count; ++i)
    if (strcmp(e->frame.field[i].name, field) == 0) components = e->frame.field[i].components;
  return cf_frame_read_cell(&e->frame, field, components == 1 ? 0 : CF_MAGNITUDE, e->values);
}

static cf_status read_preview(const char *folder, const int64_t number, exhibit *e) {
  cf_path path;
  CF_TRY(cf_path_make(&path, "%s/preview_%06lld.png", folder, (long long)number));
  return cf_image_read(path.text, &e->picture.width, &e->picture.height, &e->picture.rgb);
}

/* Reads the last frame of one run; *found: there is one. */
static cf_status read_run(const cf_sheet *s, const int i, exhibit *e, bool *found) {
  const char *folder = s->folder[i];
  cf_path path;
  int64_t fields, preview;
  *found = false;
  CF_TRY(cf_path_make(&path, "%s/run.yaml", folder));
  CF_TRY(last_number(folder, "fields", "vtkhdf", &fields));
  CF_TRY(last_number(folder, "preview", "png", &preview));
  if (fields < 0 && (preview < 0 || s->field != NULL)) return CF_OK;
  CF_TRY(cf_scene_read(&e->scene, path.text, 0, NULL));
  snprintf(e->caption, sizeof e->caption, "%s", s->caption != NULL ? s->caption[i] : e->scene->title);
  if (e->caption[0] == '\0') snprintf(e->caption, sizeof e->caption, "%s", folder);
  *found = true;
  return fields >= 0
             ? read_fields(folder, fields, s->field != NULL ? s->field : e->scene->output.preview.field, e)
             : read_preview(folder, preview, e);
}

/* --- drawing ------------------------------------------------------------------------------------------------ */

/* The map that all scenes name, and the range that all of theirs share; otherwise they follow from the values. */
static cf_preview common_preview(const exhibit *e, const int count, const char *field) {
  const cf_scene_preview *first = &e[0].scene->output.preview;
  bool range = true, map = first->map[0] != '\0', time = true;
  double low = -(double)INFINITY, high = (double)INFINITY;
  const char *unit = "";
  for (int i = 0; i < e[0].frame.count; ++i)
    if (strcmp(e[0].frame.field[i].name, field) == 0) unit = e[0].frame.field[i].unit;
  for (int i = 0; i < count; ++i) {
    const cf_scene_preview *p = &e[i].scene->output.preview;
    range = range && p->range.count == 2;
    low = range ? CF_MAX(low, p->range.value[0]) : low;
    high = range ? CF_MIN(high, p->range.value[1]) : high;
    map = map && strcmp(p->map, first->map) == 0;
    time = time && e[i].frame.time == e[0].frame.time;
  }
  cf_preview p = cf_preview_default(field, unit);
  if (map) p.map = first->map;
  if (range && low < high) p.low = low, p.high = high;
  p.time = time ? e[0].frame.time : (double)NAN;
  p.size = WIDTH;
  return p;
}

static cf_status draw_fields(cf_canvas *c, const exhibit *e, const int count, const cf_sheet *s,
                             const int columns) {
  const char *field = s->field != NULL ? s->field : e[0].scene->output.preview.field;
  const cf_preview p = common_preview(e, count, field);
  cf_panel *panel;
  cf_overlay *overlay;
  CF_TRY(CF_NEW(&panel, count));
  cf_status status = CF_NEW(&overlay, count);
  for (int i = 0; status == CF_OK && i < count; ++i) {
    cf_overlay_cones(e[i].scene, &e[i].frame.grid, e[i].frame.time, field, &overlay[i]);
    panel[i] = (cf_panel){.grid = &e[i].frame.grid,
                          .f = e[i].values.at,
                          .caption = e[i].caption,
                          .lines = overlay[i].count,
                          .line = overlay[i].line};
  }
  if (status == CF_OK) status = cf_sheet_draw(c, count, panel, columns, &p);
  cf_free(overlay);
  cf_free(panel);
  return status;
}

static cf_status draw_pictures(cf_canvas *c, const exhibit *e, const int count, const int columns) {
  const cf_canvas **picture;
  const char **caption;
  CF_TRY(CF_NEW(&picture, count));
  cf_status status = CF_NEW(&caption, count);
  for (int i = 0; status == CF_OK && i < count; ++i) picture[i] = &e[i].picture, caption[i] = e[i].caption;
  if (status == CF_OK) status = cf_sheet_pictures(c, count, picture, caption, columns, WIDTH);
  if (status == CF_OK) cf_free(caption);
  cf_free(picture);
  return status;
}

static cf_status draw(const exhibit *e, const int count, const cf_sheet *s) {
  cf_canvas c = {0};
  const int columns = s->columns > 0 ? CF_MIN(s->columns, count) : (int)ceil(sqrt(count));
  bool fields = true;
  for (int i = 0; i < count; ++i) fields = fields && e[i].values.at != NULL;
  for (int i = 0; i < count && !fields; ++i)
    if (e[i].values.at != NULL)
      return cf_fail(CF_BAD_FILE, "some of the runs have fields and others pictures alone: no common sheet");
  cf_status status = fields ? draw_fields(&c, e, count, s, columns) : draw_pictures(&c, e, count, columns);
  const cf_image_text text = {"Title", "Last frames of several runs"};
  if (status == CF_OK) status = cf_image_write(s->file, c.width, c.height, c.rgb, 1, &text);
  cf_canvas_destroy(&c);
  return status;
}

cf_status cf_sheet_write(const cf_sheet *s) {
  exhibit *e;
  int count = 0;
  CF_TRY(CF_NEW(&e, s->count));
  cf_status status = CF_OK;
  for (int i = 0; i < s->count && status == CF_OK; ++i) {
    bool found;
    status = read_run(s, i, &e[count], &found);
    count += found || status != CF_OK ? 1 : 0;
  }
  if (status == CF_OK && count == 0)
    status = cf_fail(CF_BAD_FILE, "%.256s: has no frames to make a sheet of", s->folder[0]);
  if (status == CF_OK) status = draw(e, count, s);
  clear(e, count);
  return status;
}

cf_status cf_sheet_command(cf_arguments *a) {
  if (a->output == NULL) return cf_fail(CF_BAD_USAGE, "sheet: -o FILE.png is missing");
  CF_TRY(cf_arguments_check_file(a, ".png"));
  const cf_sheet s = {.count = a->operands,
                      .folder = (const char *const *)a->operand,
                      .columns = a->columns,
                      .field = a->field,
                      .file = a->output};
  CF_TRY(cf_sheet_write(&s));
  printf("%s\n", a->output);
  return CF_OK;
}
