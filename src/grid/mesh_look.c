/* SPDX-License-Identifier: MIT
 *
 * What a mesh is, told by its edges: sorted by their two vertices, those of neighbouring triangles lie side by side.
 */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "grid/mesh.h"

/* The vertices of an edge, the smaller one high, and whether the triangle goes from the larger to the smaller one. */
typedef struct edge {
  uint64_t ends;
  bool down;
} edge;

static int compare(const void *a, const void *b) {
  const uint64_t x = ((const edge *)a)->ends, y = ((const edge *)b)->ends;
  return (x > y) - (x < y);
}

static edge edge_of(const int32_t from, const int32_t to) {
  const bool down = from > to;
  const uint64_t small = (uint64_t)(down ? to : from), large = (uint64_t)(down ? from : to);
  return (edge){small << 32 | large, down};
}

static void look_at_edges(edge *list, const int64_t count, cf_mesh_facts *f, int64_t *edges) {
  qsort(list, (size_t)count, sizeof *list, compare);
  *edges = 0;
  for (int64_t i = 0, next; i < count; i = next) {
    for (next = i + 1; next < count && list[next].ends == list[i].ends;) ++next;
    ++*edges;
    f->open_edges += next - i == 1;
    f->crowded_edges += next - i > 2;
    f->turned_edges += next - i == 2 && list[i].down == list[i + 1].down;
  }
}

static double determinant(const double a[3], const double b[3], const double c[3]) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Places count from the corner `low`, so that a body far from the origin keeps its digits. */
static void add_triangle(const cf_mesh *m, const int32_t corner[3], cf_mesh_facts *f) {
  double p[3][3], n[3];
  for (int c = 0; c < 3; ++c)
    for (int a = 0; a < 3; ++a) p[c][a] = (double)m->place[corner[c]][a] - f->low[a];
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    n[i] = (p[1][j] - p[0][j]) * (p[2][k] - p[0][k]) - (p[1][k] - p[0][k]) * (p[2][j] - p[0][j]);
  }
  f->area += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
  f->volume += determinant(p[0], p[1], p[2]) / 6;
}

static int64_t used_vertices(const cf_mesh *m, unsigned char *used) {
  int64_t count = 0;
  for (int64_t t = 0; t < m->triangles; ++t)
    for (int c = 0; c < 3; ++c) {
      count += used[m->corner[t][c]] == 0;
      used[m->corner[t][c]] = 1;
    }
  return count;
}

static void look_at_places(const cf_mesh *m, cf_mesh_facts *f) {
  for (int a = 0; a < 3; ++a) {
    f->low[a] = m->vertices > 0 ? INFINITY : 0;
    f->high[a] = m->vertices > 0 ? -INFINITY : 0;
    for (int64_t v = 0; v < m->vertices; ++v) {
      f->low[a] = fmin(f->low[a], (double)m->place[v][a]);
      f->high[a] = fmax(f->high[a], (double)m->place[v][a]);
    }
  }
  for (int64_t t = 0; t < m->triangles; ++t) {
    const int32_t *c = m->corner[t];
    add_triangle(m, c, f);
    f->degenerate += c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
  }
}

cf_status cf_mesh_look(const cf_mesh *m, cf_mesh_facts *facts) {
  cf_mesh_facts f = {0};
  edge *list;
  unsigned char *used;
  int64_t edges;
  CF_TRY(CF_NEW(&list, 3 * m->triangles));
  const cf_status s = CF_NEW(&used, m->vertices);
  if (s != CF_OK) {
    cf_free(list);
    return s;
  }
  for (int64_t t = 0; t < m->triangles; ++t)
    for (int c = 0; c < 3; ++c) list[3 * t + c] = edge_of(m->corner[t][c], m->corner[t][(c + 1) % 3]);
  look_at_edges(list, 3 * m->triangles, &f, &edges);
  f.euler = used_vertices(m, used) - edges + m->triangles;
  look_at_places(m, &f);
  cf_free(used);
  cf_free(list);
  *facts = f;
  return CF_OK;
}

cf_status cf_mesh_check_closed(const cf_mesh *m) {
  cf_mesh_facts f;
  CF_TRY(cf_mesh_look(m, &f));
  if (m->triangles == 0) return cf_fail(CF_BAD_ARGUMENT, "the mesh has no triangles");
  if (f.open_edges > 0)
    return cf_fail(CF_BAD_ARGUMENT, "the mesh is not closed: %" PRId64 " open edges: fill its holes",
                   f.open_edges);
  if (f.crowded_edges > 0)
    return cf_fail(CF_BAD_ARGUMENT,
                   "the mesh is not a surface: %" PRId64
                   " edges have more than two triangles: take apart what only touches",
                   f.crowded_edges);
  if (f.turned_edges > 0)
    return cf_fail(CF_BAD_ARGUMENT,
                   "the mesh has no inside: at %" PRId64
                   " edges its triangles disagree about it: turn them all outwards",
                   f.turned_edges);
  return CF_OK;
}
