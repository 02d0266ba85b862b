/* SPDX-License-Identifier: MIT */
#include "model/surface.h"

#include "base/mem.h"
#include "io/mesh.h"
#include "io/npy.h"

/* Moves and scales the vertices; low and high become the box around them. */
static void put(cf_mesh *mesh, const cf_mesh_facts *facts, const cf_surface_place *place, double low[3],
                double high[3]) {
  for (int a = 0; a < 3; ++a) {
    const double middle = (facts->low[a] + facts->high[a]) / 2, half = (facts->high[a] - facts->low[a]) / 2;
    const double scale = a < place->half->count && half > 0 ? place->half->value[a] / half : 1;
    const double to = a < place->center->count ? place->center->value[a] : middle;
    for (int64_t v = 0; v < mesh->vertices; ++v)
      mesh->place[v][a] = (cf_real)(to + scale * ((double)mesh->place[v][a] - middle));
    low[a] = to - scale * half;
    high[a] = to + scale * half;
  }
}

cf_status cf_surface_read(const char *path, const cf_surface_place *place, const double h, const int margin,
                          cf_samples *samples, double low[3], double high[3]) {
  cf_mesh *mesh;
  cf_mesh_facts facts;
  CF_TRY(cf_mesh_create(&mesh));
  cf_status s = cf_mesh_read(mesh, path);
  if (s == CF_OK) s = cf_mesh_check_closed(mesh);
  if (s == CF_OK) s = cf_mesh_look(mesh, &facts);
  if (s == CF_OK) {
    put(mesh, &facts, place, low, high);
    s = cf_mesh_distance(mesh, h, margin, samples);
  }
  cf_mesh_destroy(mesh);
  return s;
}

cf_status cf_surface_read_distances(const char *path, const int dim, const double h, const double origin[3],
                                    cf_samples *samples) {
  int axes;
  cf_samples s = {.h = h};
  CF_TRY(cf_npy_read(path, &axes, s.n, &s.value));
  for (int a = 0; a < 3; ++a) s.place[a] = a < dim ? origin[a] : 0;
  *samples = s;
  if (axes == dim) return CF_OK;
  cf_samples_destroy(samples);
  return cf_fail(CF_BAD_FILE, "%s: has %d axes, the scene has %d", path, axes, dim);
}
