/* SPDX-License-Identifier: MIT
 *
 * cattaneo atlas RUN... -o DIR
 *
 * Flakes for model snowfall: the last frame of each run, as maps and numbers (render/portrait.h), in the format of
 * model/atlas.h. All runs are looked at before anything is written, and the index comes last, so that an atlas.json
 * always has its pictures.
 *
 * The thickness is the field `thickness` of the frame. Where it was not written it is worked out as the model does, from
 * the field `arrival` or `age`: d = eta sqrt(2 k (age + end/400)), k = phase.thickening, age = t - arrival, end = time.end.
 */
#include "model/atlas.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "app/command.h"
#include "base/mem.h"
#include "io/frame.h"
#include "io/image.h"
#include "model/scene.h"
#include "render/portrait.h"

#define RADIUS 1.5e-3 /* m, of common stars of snow */

enum { PIXELS = 256, PIXELS_LEAST = 16, LETTERS_MAX = 64, ENTRY_MAX = 1024 };

typedef struct flake {
  const char *folder;
  char name[LETTERS_MAX]; /* of the run's folder; letters that file names may have */
  int symmetry;
} flake;

static cf_status unfit(const flake *f, const char *why) {
  return cf_fail(CF_BAD_USAGE, "atlas: %s: %s", f->folder, why);
}

/* --- a run ------------------------------------------------------------------------------------------------------------------ */

static bool is_name(const char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
}

static void take_name(flake *f) {
  size_t end = strlen(f->folder), start, length = 0;
  while (end > 1 && f->folder[end - 1] == '/') --end;
  for (start = end; start > 0 && f->folder[start - 1] != '/';) --start;
  for (; start < end && length < LETTERS_MAX - 8; ++start) {
    const char c = f->folder[start];
    const bool fits = is_name(c) || (c == '.' && length > 0);
    f->name[length++] = fits ? c : '_';
  }
  f->name[length] = '\0';
}

/* Runs of several places may have the same name. */
static void number_name(flake *all, const int i) {
  const size_t length = strlen(all[i].name);
  for (int before = 0, number = 2; before < i; ++before) {
    if (strcmp(all[before].name, all[i].name) != 0) continue;
    snprintf(all[i].name + length, LETTERS_MAX - length, "-%d", number++);
    before = -1; /* all of them again, with the new name */
  }
}

static int symmetry_of(const cf_scene *scene) {
  const cf_scene_phase_anisotropy *a = &scene->phase.anisotropy;
  if (a->law == CF_SCENE_PHASE_NONE) return 0;
  return a->law == CF_SCENE_PHASE_FOLD ? (int)a->folds : 4;
}

static cf_status last_frame(const flake *f, cf_frame *frame) {
  int count;
  int64_t *numbers;
  cf_path path;
  CF_TRY(cf_folder_numbers(f->folder, "fields", "vtkhdf", &count, &numbers));
  const int64_t last = count > 0 ? numbers[count - 1] : -1;
  cf_free(numbers);
  if (last < 0) return unfit(f, "has no frames; output.formats must have vtkhdf in it");
  CF_TRY(cf_path_make(&path, "%s/fields_%06" PRId64 ".vtkhdf", f->folder, last));
  CF_TRY(cf_frame_read(frame, path.text));
  if (frame->grid.box.dim != 2)
    return unfit(f, "its crystal grew in space: flakes are made of crystals in the plane");
  return frame->time > 0 ? CF_OK : unfit(f, "nothing has grown yet: there is only the frame at the start");
}

static bool has(const cf_frame *frame, const char *name) {
  for (int i = 0; i < frame->count; ++i)
    if (strcmp(frame->field[i].name, name) == 0 && frame->field[i].components == 1) return true;
  return false;
}

/* The law of model phase; `values` is the arrival or age, and becomes the thickness. */
static void thicken(const cf_scene *scene, const cf_frame *frame, const bool arrival, const cf_cell eta,
                    const cf_cell values) {
  const cf_box *b = &frame->grid.box;
  for (int j = 0; j < b->n[1]; ++j)
    for (int i = 0; i < b->n[0]; ++i) {
      const ptrdiff_t p = cf_box_at(b, i, j, 0);
      const double v = (double)values.at[p], ice = fmax(0, fmin(1, (double)eta.at[p]));
      const double age = arrival ? (v >= 0 ? fmax(0, frame->time - v) : 0) : fmax(0, v);
      values.at[p] = (cf_real)(ice * sqrt(2 * scene->phase.thickening * (age + scene->time.end / 400)));
    }
}

static cf_status read_fields(const flake *f, const cf_scene *scene, const cf_frame *frame, const cf_cell eta,
                             const cf_cell thickness) {
  static const char *const names[] = {"thickness", "arrival", "age"};
  int which = 0;
  if (!has(frame, "eta")) return unfit(f, "its frames have no field eta: name it in output.fields");
  while (which < 3 && !has(frame, names[which])) ++which;
  if (which == 3)
    return unfit(f, "its frames have neither thickness, arrival nor age: name one in output.fields");
  CF_TRY(cf_frame_read_cell(frame, "eta", 0, eta));
  CF_TRY(cf_frame_read_cell(frame, names[which], 0, thickness));
  if (which > 0) thicken(scene, frame, which == 1, eta, thickness);
  return CF_OK;
}

static cf_status make_portrait(const flake *f, const cf_scene *scene, const cf_frame *frame,
                               const cf_arguments *a, cf_portrait *p) {
  const cf_box *box = &frame->grid.box;
  char why[CF_SENTENCE_MAX];
  cf_cell eta, thickness;
  CF_TRY(cf_cell_create(&eta, box));
  cf_status status = cf_cell_create(&thickness, box);
  if (status == CF_OK) {
    status = read_fields(f, scene, frame, eta, thickness);
    if (status == CF_OK) status = cf_portrait_create(p, &frame->grid, eta, thickness, a->pixels, a->radius);
    cf_cell_destroy(&thickness, box);
  }
  cf_cell_destroy(&eta, box);
  if (status != CF_BAD_ARGUMENT) return status;
  snprintf(why, sizeof why, "%s", cf_status_sentence());
  return unfit(f, why);
}

static cf_status open_scene(const flake *f, cf_scene **scene) {
  cf_path path;
  *scene = NULL;
  CF_TRY(cf_path_make(&path, "%s/run.yaml", f->folder));
  if (access(path.text, F_OK) != 0) return unfit(f, "there is no run in it");
  return cf_scene_read(scene, path.text, 0, NULL);
}

static cf_status portray(flake *f, const cf_arguments *a, cf_portrait *p) {
  cf_scene *scene;
  cf_frame frame;
  *p = (cf_portrait){.pixels = 0};
  CF_TRY(open_scene(f, &scene));
  cf_status status = CF_OK;
  if (scene->model != CF_SCENE_MODEL_PHASE)
    status = unfit(f, "is no run of model phase: crystals are grown with that");
  if (status == CF_OK) status = last_frame(f, &frame);
  f->symmetry = symmetry_of(scene);
  if (status == CF_OK) status = make_portrait(f, scene, &frame, a, p);
  cf_scene_destroy(scene);
  return status;
}

/* --- files ------------------------------------------------------------------------------------------------------------------- */

static cf_status write_map(const char *folder, const flake *f, const char *word, const int pixels,
                           const int channels, const uint16_t *values) {
  cf_path path;
  CF_TRY(cf_path_make(&path, "%s/%s.%s.png", folder, f->name, word));
  return cf_image_write_deep(path.text, pixels, pixels, channels, values);
}

static cf_status write_maps(const char *folder, const flake *f, const cf_portrait *p) {
  CF_TRY(write_map(folder, f, "rgba", p->pixels, 4, p->rgba));
  CF_TRY(write_map(folder, f, "height", p->pixels, 1, p->height));
  return write_map(folder, f, "normal", p->pixels, 3, p->normal);
}

static void write_entry(char *text, const flake *f, const cf_portrait *p) {
  snprintf(text, ENTRY_MAX,
           "  {\"name\": \"%s\",\n"
           "   \"rgba\": \"%s.rgba.png\", \"height\": \"%s.height.png\", \"normal\": \"%s.normal.png\",\n"
           "   \"pixels\": [%d, %d], \"metres_per_pixel\": %.9g, \"center\": [%.7g, %.7g],\n"
           "   \"radius\": %.9g, \"area\": %.9g, \"mean_thickness\": %.9g, \"height_scale\": %.9g,\n"
           "   \"mass\": %.9g, \"symmetry\": %d}",
           f->name, f->name, f->name, f->name, p->pixels, p->pixels, p->metres_per_pixel, p->center[0],
           p->center[1], p->radius, p->area, p->mean_thickness, p->height_scale, p->mass, f->symmetry);
}

/* Makes the maps of all runs; with `entries`, writes them and adds their lines there. */
static cf_status each(flake *all, const int count, const cf_arguments *a, char (*entries)[ENTRY_MAX]) {
  for (int i = 0; i < count; ++i) {
    cf_portrait p;
    CF_TRY(portray(&all[i], a, &p));
    cf_status status = CF_OK;
    if (entries != NULL) {
      write_entry(entries[i], &all[i], &p);
      status = write_maps(a->output, &all[i], &p);
    } else if (p.cut) {
      fprintf(stderr, "note: %s: its crystal touches the border of the domain and is cut off there\n",
              all[i].folder);
    }
    cf_portrait_destroy(&p);
    CF_TRY(status);
  }
  return CF_OK;
}

static cf_status write_index(const char *path, const int count, char (*entries)[ENTRY_MAX]) {
  char *text;
  size_t length = 0;
  const size_t most = (size_t)count * (ENTRY_MAX + 2) + 64;
  CF_TRY(CF_NEW(&text, most));
  length += (size_t)snprintf(text, most, "{\"cattaneo_atlas\": 1,\n \"flakes\": [\n");
  for (int i = 0; i < count; ++i)
    length += (size_t)snprintf(text + length, most - length, "%s%s\n", entries[i], i + 1 < count ? "," : "");
  length += (size_t)snprintf(text + length, most - length, " ]}\n");
  const cf_status status = cf_file_write(path, text, length);
  cf_free(text);
  return status;
}

static cf_status write_all(flake *all, const int count, const cf_arguments *a, const char *index) {
  char(*entries)[ENTRY_MAX];
  CF_TRY(CF_NEW(&entries, count));
  cf_status status = cf_folder_make(a->output);
  /* The old index would speak of pictures that are about to change. */
  if (status == CF_OK && unlink(index) != 0 && errno != ENOENT)
    status = cf_fail(CF_CANNOT_WRITE, "%s: cannot be removed: %s", index, strerror(errno));
  if (status == CF_OK) status = each(all, count, a, entries);
  if (status == CF_OK) status = write_index(index, count, entries);
  cf_free(entries);
  return status;
}

cf_status cf_atlas_command(cf_arguments *a) {
  const int count = a->operands;
  cf_path index;
  flake *all;
  if (a->output == NULL) return cf_fail(CF_BAD_USAGE, "atlas: -o DIR is missing");
  if (a->radius <= 0) a->radius = RADIUS;
  if (a->pixels == 0) a->pixels = PIXELS;
  if (a->pixels < PIXELS_LEAST)
    return cf_fail(CF_BAD_USAGE, "--pixels %d: must be at least %d", a->pixels, PIXELS_LEAST);
  CF_TRY(cf_path_make(&index, "%s/atlas.json", a->output));
  if (!a->force && access(index.text, F_OK) == 0)
    return cf_fail(CF_BAD_USAGE, "%s is there already: --force overwrites it", index.text);
  CF_TRY(CF_NEW(&all, count));
  for (int i = 0; i < count; ++i) {
    all[i].folder = a->operand[i];
    take_name(&all[i]);
    number_name(all, i);
  }
  cf_status status = each(all, count, a, NULL);
  if (status == CF_OK) status = write_all(all, count, a, index.text);
  cf_free(all);
  if (status == CF_OK) printf("%s\n", index.text);
  return status;
}
