/* SPDX-License-Identifier: MIT
 *
 * How the surface goes through a cube, for each of the 256 ways in which its corners can be inside.
 *
 * Corner c of a cube is at (c & 1, c >> 1 & 1, c >> 2). Edge 4 a + b runs along axis a; the low bit of b is its place
 * on the next axis (cyclically), the high bit that on the one after. On every face of the cube the surface is a line
 * from the edge where a walk around the face comes inside to the edge where it leaves again, so corners that touch
 * only across a diagonal stay apart; the two cubes beside a face see the same four corners and draw the same lines, so
 * there are no holes. The lines of the six faces join to loops, and loops are cut into triangles along diagonals that
 * lie on no face, for the cube beyond it may have the same one, and an edge would have four triangles.
 */
#ifndef CF_GRID_ISOSURFACE_TABLE_H
#define CF_GRID_ISOSURFACE_TABLE_H

#include "base/status.h"

#define CF_CUBE_TRIANGLES 6 /* at most */

typedef struct cf_cube {
  signed char triangles;
  signed char
      edge[3 * CF_CUBE_TRIANGLES]; /* on which the corners of the triangles lie, anticlockwise from outside */
} cf_cube;

/* The two corners of an edge, the lower one first. */
void cf_cube_corners(int edge, int corner[2]);

/* For each set of corners inside (bit c: corner c). */
void cf_cube_table(cf_cube table[256]);

#endif
