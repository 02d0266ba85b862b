/* SPDX-License-Identifier: MIT */
#include "grid/isosurface_table.h"

#include <assert.h>
#include <string.h>

#define NOWHERE (-1)

static int corner_at(const int axis, const int along, const int next, const int after) {
  return along << axis | next << (axis + 1) % 3 | after << (axis + 2) % 3;
}

void cf_cube_corners(const int edge, int corner[2]) {
  for (int end = 0; end < 2; ++end) corner[end] = corner_at(edge / 4, end, edge & 1, edge >> 1 & 1);
}

static int edge_between(const int a, const int b) {
  for (int edge = 0; edge < 12; ++edge) {
    int c[2];
    cf_cube_corners(edge, c);
    if ((c[0] == a && c[1] == b) || (c[0] == b && c[1] == a)) return edge;
  }
  return NOWHERE;
}

/* The corners of a face, anticlockwise seen from outside. */
static void walk_around(const int axis, const int side, int corner[4]) {
  static const int next[4] = {0, 1, 1, 0}, after[4] = {0, 0, 1, 1};
  for (int i = 0; i < 4; ++i) {
    const int at = side ? i : 3 - i;
    corner[i] = corner_at(axis, side, next[at], after[at]);
  }
}

/* to[e]: where the line that begins on edge e ends; every edge that is crossed begins one line and ends one. */
static void draw_lines(const int inside, int to[12]) {
  for (int e = 0; e < 12; ++e) to[e] = NOWHERE;
  for (int face = 0; face < 6; ++face) {
    int c[4];
    walk_around(face / 2, face % 2, c);
    for (int i = 0; i < 4; ++i) {
      int last = (i + 1) % 4;
      if (inside >> c[i] & 1 || !(inside >> c[last] & 1)) continue; /* does not come inside here */
      while (inside >> c[(last + 1) % 4] & 1) last = (last + 1) % 4;
      to[edge_between(c[i], c[(i + 1) % 4])] = edge_between(c[last], c[(last + 1) % 4]);
    }
  }
}

static int share_a_face(const int e, const int f) {
  int a[2], b[2];
  cf_cube_corners(e, a);
  cf_cube_corners(f, b);
  const int all = a[0] & a[1] & b[0] & b[1], any = a[0] | a[1] | b[0] | b[1];
  return all != 0 || any != 7;
}

/* Cuts the loop's piece first..last into triangles; false if that takes a diagonal on a face. */
static int cut(const int *loop, const int first, const int last, cf_cube *cube) {
  if (last - first < 2) return 1;
  const signed char before = cube->triangles;
  for (int k = first + 1; k < last; ++k) {
    if (k > first + 1 && share_a_face(loop[first], loop[k])) continue;
    if (k < last - 1 && share_a_face(loop[k], loop[last])) continue;
    if (cut(loop, first, k, cube) && cut(loop, k, last, cube)) {
      assert(cube->triangles < CF_CUBE_TRIANGLES);
      signed char *edge = cube->edge + 3 * cube->triangles++;
      edge[0] = (signed char)loop[first], edge[1] = (signed char)loop[k], edge[2] = (signed char)loop[last];
      return 1;
    }
    cube->triangles = before;
  }
  return 0;
}

void cf_cube_table(cf_cube table[256]) {
  memset(table, 0, 256 * sizeof *table);
  for (int inside = 0; inside < 256; ++inside) {
    int to[12];
    draw_lines(inside, to);
    for (int e = 0; e < 12; ++e) {
      int loop[12], length = 0;
      for (int at = e; to[at] != NOWHERE;) {
        const int next = to[at];
        loop[length++] = at;
        to[at] = NOWHERE;
        at = next;
      }
      const int done = length == 0 || cut(loop, 0, length - 1, &table[inside]);
      assert(done);
      (void)done;
    }
  }
}
