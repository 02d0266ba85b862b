/* SPDX-License-Identifier: MIT
 *
 * Surfaces and volumes, ours and those of others: what stands in the file's head, how large it is, and for a surface
 * whether it is closed, which an obstacle or a body made of it must be.
 */
#define _GNU_SOURCE
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "io/folder.h"
#include "io/info_part.h"
#include "io/mesh.h"
#include "io/vdb.h"

/* A word or two of somebody else's: what no terminal should be told is a blank. */
static void clean(char *text) {
  for (char *c = text; *c != '\0'; ++c)
    if ((unsigned char)*c < ' ' || *c == 127) *c = ' ';
}

static cf_status say_box(cf_report *r, const char *indent, const double low[3], const double high[3]) {
  return cf_report_say(r, "%sbox      (%.9g, %.9g, %.9g) to (%.9g, %.9g, %.9g) m\n", indent, low[0], low[1],
                       low[2], high[0], high[1], high[2]);
}

/* --- a surface -------------------------------------------------------------------------------------------- */

/* The comments in the head of a PLY file: ours say title, time and step. Units stand with what has them. */
static cf_status say_comments(cf_report *r, const char *path) {
  char line[256];
  cf_status s = CF_OK;
  FILE *file = cf_file_stream(path);
  if (file == NULL) return CF_OK; /* it could be read a moment ago */
  while (s == CF_OK && fgets(line, sizeof line, file) != NULL && strncmp(line, "end_header", 10) != 0) {
    if (strncmp(line, "comment ", 8) != 0 || strncmp(line + 8, "unit of ", 8) == 0) continue;
    line[strcspn(line, "\r\n")] = '\0';
    clean(line);
    s = cf_report_say(r, "  comment  %s\n", line + 8);
  }
  fclose(file);
  return s;
}

static cf_status say_whole(cf_report *r, const cf_mesh *m) {
  cf_mesh_facts f;
  CF_TRY(cf_mesh_look(m, &f));
  CF_TRY(say_box(r, "  ", f.low, f.high));
  if (f.open_edges + f.crowded_edges + f.turned_edges == 0)
    return cf_report_say(r, "  closed   area %.9g m^2, volume %.9g m^3\n", f.area, f.volume);
  return cf_report_say(r,
                       "  open     area %.9g m^2; edges with one triangle: %" PRId64
                       ", with more than two: %" PRId64 ", turned against each other: %" PRId64 "\n",
                       f.area, f.open_edges, f.crowded_edges, f.turned_edges);
}

static cf_status say_places(cf_report *r, const cf_mesh *m) {
  cf_real *line;
  cf_status s = CF_NEW(&line, m->vertices);
  for (int a = 0; s == CF_OK && a < 3; ++a) {
    const char name[] = {'P', 'o', 'i', 'n', 't', 's', '.', "xyz"[a], '\0'};
    for (int64_t v = 0; v < m->vertices; ++v) line[v] = m->place[v][a];
    s = cf_report_list(r, name, "m", (int)m->vertices, line);
  }
  cf_free(line);
  return s;
}

static cf_status say_mesh(cf_report *r, const char *path, const cf_mesh *m) {
  CF_TRY(cf_report_say(r, "%s: a surface\n", path));
  if (strcasecmp(strrchr(path, '.'), ".ply") == 0) CF_TRY(say_comments(r, path));
  CF_TRY(cf_report_say(r, "  size     %" PRId64 " vertices, %" PRId64 " triangles\n", m->vertices,
                       m->triangles));
  CF_TRY(say_whole(r, m));
  CF_TRY(cf_report_say(r, "%s", cf_report_columns));
  CF_TRY(say_places(r, m));
  for (int i = 0; i < m->attributes; ++i) {
    const cf_mesh_attribute *a = &m->attribute[i];
    CF_TRY(cf_report_list(r, a->name, a->unit, (int)m->vertices, a->at));
  }
  return cf_report_say(r, "  checksum of all arrays: %016" PRIx64 "\n", cf_checksum_end(&r->all));
}

cf_status cf_report_mesh(cf_report *r, const char *path) {
  cf_mesh *mesh;
  CF_TRY(cf_mesh_create(&mesh));
  cf_status s = cf_mesh_read(mesh, path);
  if (s == CF_OK) s = say_mesh(r, path, mesh);
  cf_mesh_destroy(mesh);
  return s;
}

/* --- a volume --------------------------------------------------------------------------------------------- */

typedef struct volume {
  cf_report *r;
  cf_status status;
} volume;

static void say_word(void *context, const char *name, const char *value) {
  volume *v = context;
  char line[512];
  snprintf(line, sizeof line, "%-8.64s %.400s", name, value);
  clean(line);
  if (v->status == CF_OK) v->status = cf_report_say(v->r, "  %s\n", line);
}

static cf_status say_values(cf_report *r, const cf_vdb_facts *f) {
  const char *what = f->components == 3 ? "lengths of vectors" : "values";
  if (f->components == 0)
    return cf_report_say(r, "    neither numbers of 32 bits nor vectors of them: looked at no further\n");
  if (f->active == 0) return cf_report_say(r, "    empty\n");
  return cf_report_say(r, "    %s from %.9g to %.9g%s%s, stored with %d bits\n", what, f->low, f->high,
                       f->unit[0] != '\0' ? " " : "", f->unit, f->half ? 16 : 32);
}

static cf_status say_grid(cf_report *r, const cf_vdb_facts *f) {
  char name[sizeof f->name];
  memcpy(name, f->name, sizeof name);
  clean(name);
  CF_TRY(cf_report_say(r, "  grid     %s: %s, %" PRId64 " voxels in use, h = %.9g m\n", name, f->kind,
                       f->active, f->h));
  CF_TRY(say_values(r, f));
  return f->active > 0 ? say_box(r, "    ", f->box[0], f->box[1]) : CF_OK;
}

static void visit_grid(void *context, const cf_vdb_facts *f) {
  volume *v = context;
  if (v->status == CF_OK) v->status = say_grid(v->r, f);
}

cf_status cf_report_volume(cf_report *r, const char *path) {
  volume v = {r, CF_OK};
  CF_TRY(cf_report_say(r, "%s: a volume\n", path));
  CF_TRY(cf_vdb_look(path, &(cf_vdb_viewer){say_word, visit_grid, &v}));
  return v.status;
}
