/* SPDX-License-Identifier: MIT
 *
 * Particles and the surface of a frame as VTKHDF PolyData: points, one cell that holds them all or triangles, and the
 * attributes.
 *
 * Readers want all four groups of cells to be there, empty ones with the one offset 0.
 */
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "io/frame_part.h"

static cf_status write_integers(cf_hdf5 *h, const char *group, const char *name, const int64_t count,
                                const int64_t *values) {
  const cf_array a = {CF_ELEMENT_INTEGER, 1, {count}};
  cf_path path;
  CF_TRY(cf_path_make(&path, "/VTKHDF/%s/%s", group, name));
  return cf_hdf5_write(h, path.text, &a, values, NULL);
}

/* `cells` cells of `size` points each; point i of all is corner[i], or i where corner is NULL. */
static cf_status write_cells(cf_hdf5 *h, const char *group, const int64_t cells, const int64_t size,
                             const int32_t *corner) {
  const int64_t ids = cells * size;
  int64_t *list;
  cf_path path;
  CF_TRY(cf_path_make(&path, "/VTKHDF/%s", group));
  CF_TRY(cf_hdf5_group(h, path.text));
  CF_TRY(write_integers(h, group, "NumberOfCells", 1, &cells));
  CF_TRY(write_integers(h, group, "NumberOfConnectivityIds", 1, &ids));
  CF_TRY(CF_NEW(&list, CF_MAX(ids, cells + 1)));
  for (int64_t i = 0; i <= cells; ++i) list[i] = i * size;
  cf_status s = write_integers(h, group, "Offsets", cells + 1, list);
  for (int64_t i = 0; i < ids; ++i) list[i] = corner == NULL ? i : corner[i];
  if (s == CF_OK) s = write_integers(h, group, "Connectivity", ids, list);
  cf_free(list);
  return s;
}

static cf_status write_points(cf_hdf5 *h, const int64_t points, const int64_t triangles,
                              const int32_t *corner) {
  CF_TRY(write_integers(h, ".", "NumberOfPoints", 1, &points));
  CF_TRY(write_cells(h, "Vertices", points > 0 && triangles == 0, points, NULL));
  CF_TRY(write_cells(h, "Lines", 0, 0, NULL));
  CF_TRY(write_cells(h, "Polygons", triangles, 3, corner));
  CF_TRY(write_cells(h, "Strips", 0, 0, NULL));
  return cf_hdf5_group(h, "/VTKHDF/PointData");
}

/* Places and vectors have three components in VTK: z = 0 in 2D. */
static void pad(cf_part *p) {
  if (!p->streamed || p->slabs.components != 2) return;
  p->slabs.components = 3;
  p->slabs.at[2] = NULL;
}

static cf_status fill_particles(cf_hdf5 *h, const cf_frame_job *j, const void *what) {
  const cf_entry *e = what;
  cf_part part;
  cf_path path;
  CF_TRY(cf_frame_root(h, j, "PolyData"));
  CF_TRY(cf_hdf5_set_text(h, "/", "set", e->name));
  CF_TRY(write_points(h, e->particles->count, 0, NULL));
  for (int i = 0; cf_part_of(j->r, e, i, &part); ++i) {
    if (i == CF_PART_NEXT_ID) continue;
    const bool places = part.attribute == CF_PARTICLE_POSITION;
    if (!places && !cf_choice_has_part(&j->plan->choice, &part)) continue;
    pad(&part);
    CF_TRY(cf_path_make(&path, "/VTKHDF/%s%s", places ? "Points" : "PointData/",
                        places ? "" : cf_part_own(&part)));
    CF_TRY(cf_hdf5_write_part(h, path.text, &part, j->plan->compression, NULL));
  }
  return CF_OK;
}

cf_status cf_frame_particles(const char *folder, const cf_frame_job *j, const cf_entry *e) {
  char word[2 * CF_NAME_MAX];
  cf_particles_word(j->r, e->particles, word, sizeof word);
  return cf_frame_file(folder, j, word, fill_particles, e);
}

/* --- a surface -------------------------------------------------------------------------------------------- */

static cf_status write_reals(cf_hdf5 *h, const char *name, const int64_t count, const int components,
                             const void *values, const char *unit) {
  const cf_array a = {CF_ELEMENT_REAL, components > 1 ? 2 : 1, {count, components}};
  cf_path path;
  CF_TRY(cf_path_make(&path, "/VTKHDF/%s", name));
  CF_TRY(cf_hdf5_write(h, path.text, &a, values, NULL));
  return cf_hdf5_set_text(h, path.text, "unit", unit);
}

static cf_status fill_mesh(cf_hdf5 *h, const cf_frame_job *j, const void *what) {
  const cf_mesh *m = what;
  CF_TRY(cf_frame_root(h, j, "PolyData"));
  CF_TRY(write_points(h, m->vertices, m->triangles, (const int32_t *)m->corner));
  CF_TRY(write_reals(h, "Points", m->vertices, 3, m->place, "m"));
  if (m->normal != NULL) CF_TRY(write_reals(h, "PointData/Normals", m->vertices, 3, m->normal, ""));
  for (int i = 0; i < m->attributes; ++i) {
    cf_path name;
    CF_TRY(cf_path_make(&name, "PointData/%s", m->attribute[i].name));
    CF_TRY(write_reals(h, name.text, m->vertices, 1, m->attribute[i].at, m->attribute[i].unit));
  }
  return CF_OK;
}

cf_status cf_frame_write_mesh(const char *folder, const int64_t frame, const cf_grid *g, const cf_mesh *mesh,
                              const cf_stamp *stamp) {
  const cf_registry r = {.grid = g};
  const cf_frame_plan plan = {0};
  return cf_frame_file(folder, &(cf_frame_job){.r = &r, .plan = &plan, .stamp = stamp, .frame = frame},
                       "mesh", fill_mesh, mesh);
}
