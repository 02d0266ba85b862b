/* SPDX-License-Identifier: MIT */
#include "grid/mesh.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"

cf_status cf_mesh_create(cf_mesh **mesh) { return CF_NEW(mesh, 1); }

static void clear(cf_mesh *m) {
  for (int a = 0; a < m->attributes; ++a) cf_free(m->attribute[a].at);
  cf_free(m->place);
  cf_free(m->normal);
  cf_free(m->corner);
  *m = (cf_mesh){0};
}

void cf_mesh_destroy(cf_mesh *mesh) {
  if (mesh == NULL) return;
  clear(mesh);
  cf_free(mesh);
}

cf_status cf_mesh_resize(cf_mesh *m, const int64_t vertices, const int64_t triangles, const bool normals) {
  clear(m);
  if (vertices > INT32_MAX || triangles > INT32_MAX)
    return cf_fail(CF_OVER_LIMIT, "a mesh of %" PRId64 " vertices and %" PRId64 " triangles: at most %d each",
                   vertices, triangles, INT32_MAX);
  cf_status s = CF_NEW(&m->place, vertices);
  if (s == CF_OK) s = CF_NEW(&m->corner, triangles);
  if (s == CF_OK && normals) s = CF_NEW(&m->normal, vertices);
  if (s != CF_OK) {
    clear(m);
    return s;
  }
  m->vertices = vertices;
  m->triangles = triangles;
  return CF_OK;
}

cf_status cf_mesh_attribute_add(cf_mesh *m, const char *name, const char *unit, cf_real **at) {
  const size_t length = strlen(name);
  if (length == 0 || length >= CF_NAME_MAX)
    return cf_fail(CF_BAD_ARGUMENT, "an attribute of a mesh named \"%s\": a name has 1 to %d letters", name,
                   CF_NAME_MAX - 1);
  for (int a = 0; a < m->attributes; ++a)
    if (strcmp(m->attribute[a].name, name) == 0)
      return cf_fail(CF_BAD_ARGUMENT, "two attributes of a mesh are named \"%s\"", name);
  if (m->attributes == CF_MESH_ATTRIBUTES)
    return cf_fail(CF_OVER_LIMIT, "attribute %s of a mesh: there are %d already", name, CF_MESH_ATTRIBUTES);
  cf_mesh_attribute *a = &m->attribute[m->attributes];
  CF_TRY(CF_NEW(&a->at, m->vertices));
  snprintf(a->name, sizeof a->name, "%s", name);
  snprintf(a->unit, sizeof a->unit, "%s", unit);
  ++m->attributes;
  if (at != NULL) *at = a->at;
  return CF_OK;
}

/* --- values of a field ------------------------------------------------------------------------------------ */

/* Linear between the centres of cells; in 2D nothing changes along z. */
static double value_at(const cf_grid *g, const cf_real *f, const cf_real place[3]) {
  int low[3] = {0}, high[3] = {0};
  double t[3] = {0}, sum = 0;
  for (int a = 0; a < g->box.dim; ++a) {
    const double x = ((double)place[a] - g->origin[a]) / g->h - 0.5;
    const double inside = CF_MAX(0, CF_MIN(x, g->box.n[a] - 1));
    low[a] = (int)inside;
    high[a] = CF_MIN(low[a] + 1, g->box.n[a] - 1);
    t[a] = inside - low[a];
  }
  for (int c = 0; c < 8; ++c) {
    const int i = c & 1 ? high[0] : low[0], j = c & 2 ? high[1] : low[1], k = c & 4 ? high[2] : low[2];
    const double weight = (c & 1 ? t[0] : 1 - t[0]) * (c & 2 ? t[1] : 1 - t[1]) * (c & 4 ? t[2] : 1 - t[2]);
    if (weight > 0) sum += weight * (double)f[cf_box_at(&g->box, i, j, k)];
  }
  return sum;
}

cf_status cf_mesh_sample(cf_mesh *m, const cf_grid *g, const cf_cell f, const char *name, const char *unit) {
  cf_real *at;
  CF_TRY(cf_mesh_attribute_add(m, name, unit, &at));
#pragma omp parallel for schedule(static) num_threads(g->threads)
  for (int64_t v = 0; v < m->vertices; ++v) at[v] = (cf_real)value_at(g, f.at, m->place[v]);
  return CF_OK;
}

/* --- normals ---------------------------------------------------------------------------------------------- */

static void side(const cf_mesh *m, const int32_t from, const int32_t to, double d[3]) {
  for (int a = 0; a < 3; ++a) d[a] = (double)m->place[to][a] - (double)m->place[from][a];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double a[3], const double b[3], double c[3]) {
  for (int i = 0; i < 3; ++i) c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* Adds the triangle's normal, of the length of its angle there, to each of its corners. */
static void add_normal(cf_mesh *m, const int32_t corner[3]) {
  for (int c = 0; c < 3; ++c) {
    double u[3], v[3], n[3];
    side(m, corner[c], corner[(c + 1) % 3], u);
    side(m, corner[c], corner[(c + 2) % 3], v);
    cross(u, v, n);
    const double size = sqrt(dot(n, n));
    if (!(size > 0)) return;
    const double angle = atan2(size, dot(u, v));
    for (int a = 0; a < 3; ++a) m->normal[corner[c]][a] += (cf_real)(n[a] / size * angle);
  }
}

cf_status cf_mesh_make_normals(cf_mesh *m) {
  cf_free(m->normal);
  CF_TRY(CF_NEW(&m->normal, m->vertices));
  for (int64_t t = 0; t < m->triangles; ++t) add_normal(m, m->corner[t]);
  for (int64_t v = 0; v < m->vertices; ++v) {
    const double n[3] = {(double)m->normal[v][0], (double)m->normal[v][1], (double)m->normal[v][2]};
    const double size = sqrt(dot(n, n));
    for (int a = 0; a < 3; ++a) m->normal[v][a] = (cf_real)(size > 0 ? n[a] / size : 0);
  }
  return CF_OK;
}
