/* SPDX-License-Identifier: MIT
 *
 * The grid that particles see: nodes at the centres of a lattice's cells, only where particles reach, and the ways
 * between the two. A node has eight numbers side by side, so that one vector instruction serves them all.
 *
 *     cf_nodes_update(nodes, set, threads);                       // sorts the set by block, finds the blocks
 *     CF_PARALLEL_... over colours and blocks                     // cf_nodes_scatter_block, see physics/mpm_part.h
 *
 * Blocks are 4^3 (8^2) cells. Blocks with particles are visited with a window, a copy of their nodes and of one layer
 * around them, that stays in the first-level cache; to scatter, windows are added to the nodes colour by colour (2^dim
 * colours: windows of one colour never meet), each node in the same order whatever the number of threads: no atomic
 * operation, the same bits. Nodes are kept block after block, so memory and time go with the blocks that
 * particles reach and not with the lattice.
 *
 * What the eight numbers are depends on the moment: sums before the grid's step, values after it.
 */
#ifndef CF_STENCIL_NODES_H
#define CF_STENCIL_NODES_H

#include <string.h>

#include "grid/grid.h"
#include "grid/particles.h"
#include "grid/sweep.h"
#include "stencil/bspline.h"

enum {                       /* of sums over particles                  after the grid's step */
       CF_NODE_MASS = 0,     /* inertia           the same */
       CF_NODE_VELOCITY = 1, /* momentum, dim     velocity */
       CF_NODE_CAPACITY = 4, /* C                 sum of held values (times held) */
       CF_NODE_WATER = 5,    /* m                 its change over C */
       CF_NODE_MEMORY = 6,   /* A                 its change over C */
       CF_NODE_FILL = 7,     /* theta             1 where saturation is held */
       CF_NODE_NUMBERS = 8
};

#define CF_BLOCK_NODES          64
#define CF_BLOCK_EDGE(dim)      ((dim) == 3 ? 4 : 8)
#define CF_WINDOW_EDGE(dim)     (CF_BLOCK_EDGE(dim) + 2)
#define CF_WINDOW_NODES         216 /* 6^3; 10^2 in 2D */
#define CF_NODES_AROUND         27  /* blocks around a block, itself in the middle; in 2D the middle nine */
#define CF_NODES_AT(dx, dy, dz) (((dz) + 1) * 9 + ((dy) + 1) * 3 + (dx) + 1)
#define CF_NODES_HERE           13

typedef struct cf_block {
  int cell[3];                     /* its lowest cell in the lattice */
  int32_t around[CF_NODES_AROUND]; /* ranks of the blocks around it, -1: not there */
  int64_t first, count;            /* its particles */
} cf_block;

typedef struct cf_nodes {
  const cf_grid *grid;
  int dim, lattice[3]; /* blocks an axis */
  int32_t *table;      /* rank + 1 by the block's place in the lattice */
  int32_t count, room; /* blocks there are, can be */
  int32_t held;        /* blocks whose memory has been touched */
  cf_block *block;     /* in the order of their places */
  uint32_t *key;       /* those places */
  cf_lanes *at;        /* CF_BLOCK_NODES vectors a block */
  int32_t *visit;      /* ranks of blocks with particles, by colour */
  int32_t colour[9];   /* where each colour starts in `visit` */
  double *partial;     /* one a block, for ordered sums */
} cf_nodes;

/* For at most `particles` particles on the lattice `g`, which must outlive it. CF_OVER_LIMIT, CF_NO_MEMORY. */
cf_status cf_nodes_create(cf_nodes **nodes, const cf_grid *g, int64_t particles);
void cf_nodes_destroy(cf_nodes *nodes);

/* Sorts the set by block and finds the blocks its particles reach. All particles must be inside the lattice, one
 * cell away from its sides. Allocates nothing. */
void cf_nodes_update(cf_nodes *nodes, cf_particles *set, int threads);

/* Below, `at` is nodes->at or an array laid out like it (another eight numbers a node). All become 0. */
void cf_nodes_clear(cf_nodes *nodes, cf_lanes *at, int threads);

/* The window of block b, read from the nodes; and added to them. `window` has CF_WINDOW_NODES vectors. */
void cf_nodes_load(const cf_nodes *nodes, const cf_block *b, const cf_lanes *at, cf_lanes *window);
void cf_nodes_add(const cf_nodes *nodes, const cf_block *b, cf_lanes *at, const cf_lanes *window);

/* Cell (i, j, k) of node n of a block. */
static inline void cf_nodes_cell(const cf_nodes *nodes, const cf_block *b, const int n, int cell[3]) {
  const int edge = CF_BLOCK_EDGE(nodes->dim);
  cell[0] = b->cell[0] + n % edge;
  cell[1] = b->cell[1] + n / edge % edge;
  cell[2] = b->cell[2] + n / (edge * edge);
}

/* Runs over the blocks of one colour, b the block; and over all blocks, b their rank. */
#define CF_PARALLEL_VISITS(nodes, threads, c, v)                        \
  CF_PRAGMA(omp parallel for schedule(dynamic, 4) num_threads(threads)) \
  for (int32_t v = (nodes)->colour[c]; v < (nodes)->colour[(c) + 1]; ++v)
#define CF_PARALLEL_ALL_VISITS(nodes, threads, v)                       \
  CF_PRAGMA(omp parallel for schedule(dynamic, 4) num_threads(threads)) \
  for (int32_t v = 0; v < (nodes)->colour[8]; ++v)
#define CF_PARALLEL_BLOCKS(nodes, threads, b)                       \
  CF_PRAGMA(omp parallel for schedule(static) num_threads(threads)) \
  for (int32_t b = 0; b < (nodes)->count; ++b)

/* --- eight particles --------------------------------------------------------------------------------------- */

/* Where eight particles of a block are in its window. */
typedef struct cf_reach {
  int base[CF_WIDE];         /* of the lowest of a particle's nodes */
  cf_lanes w[3][3], d[3][3]; /* weights, distances over h: [axis][node] */
} cf_reach;

CF_SMALL void cf_reach_set(const int dim, const cf_grid *g, const cf_block *b, const cf_lanes *x,
                           cf_reach *r) {
  const int edge = CF_WINDOW_EDGE(dim);
  int stride = 1;
  CF_SMALL_LOOP
  for (int l = 0; l < CF_WIDE; ++l) r->base[l] = 0;
  CF_SMALL_LOOP
  for (int a = 0; a < dim; ++a) {
    int cell[CF_WIDE];
    const cf_lanes at = (x[a] - (cf_real)g->origin[a]) * (cf_real)(1 / g->h);
    cf_bspline(&at, cell, r->w[a], r->d[a]);
    CF_SMALL_LOOP
    for (int l = 0; l < CF_WIDE; ++l) r->base[l] += (cell[l] - b->cell[a]) * stride;
    stride *= edge;
  }
}

/* Particle l adds w (value + sum over axes of slope[a] (x_i - x)_a/h) to its nodes. */
CF_SMALL void cf_reach_scatter(const int dim, const cf_reach *r, const int l, const cf_lanes *value,
                               const cf_lanes *slope, cf_lanes *window) {
  const int edge = CF_WINDOW_EDGE(dim), planes = dim == 3 ? 3 : 1;
  cf_lanes in_x[3];
  CF_SMALL_LOOP
  for (int i = 0; i < 3; ++i) in_x[i] = slope[0] * r->d[0][i][l];
  CF_SMALL_LOOP
  for (int k = 0; k < planes; ++k) {
    cf_lanes in_z = *value;
    if (dim == 3) in_z += slope[dim - 1] * r->d[dim - 1][k][l];
    CF_SMALL_LOOP
    for (int j = 0; j < 3; ++j) {
      const cf_lanes in_y = in_z + slope[1] * r->d[1][j][l];
      const cf_real w = dim == 3 ? r->w[1][j][l] * r->w[2][k][l] : r->w[1][j][l];
      cf_lanes *node = window + r->base[l] + (k * edge + j) * edge;
      CF_SMALL_LOOP
      for (int i = 0; i < 3; ++i) node[i] += (w * r->w[0][i][l]) * (in_y + in_x[i]);
    }
  }
}

/* The same without slopes. */
CF_SMALL void cf_reach_scatter_plain(const int dim, const cf_reach *r, const int l, const cf_lanes *value,
                                     cf_lanes *window) {
  const int edge = CF_WINDOW_EDGE(dim), planes = dim == 3 ? 3 : 1;
  CF_SMALL_LOOP
  for (int k = 0; k < planes; ++k) CF_SMALL_LOOP
  for (int j = 0; j < 3; ++j) {
    const cf_real w = dim == 3 ? r->w[1][j][l] * r->w[2][k][l] : r->w[1][j][l];
    cf_lanes *node = window + r->base[l] + (k * edge + j) * edge;
    CF_SMALL_LOOP
    for (int i = 0; i < 3; ++i) node[i] += (w * r->w[0][i][l]) * *value;
  }
}

/* value = sum w node, moment[a] = sum w (x_i - x)_a/h node. moment NULL: only the first. */
CF_SMALL void cf_reach_gather(const int dim, const cf_reach *r, const int l, const cf_lanes *window,
                              cf_lanes *value, cf_lanes *moment) {
  const int edge = CF_WINDOW_EDGE(dim), planes = dim == 3 ? 3 : 1;
  cf_lanes sum = {0}, mx = {0}, my = {0}, mz = {0};
  CF_SMALL_LOOP
  for (int k = 0; k < planes; ++k) {
    cf_lanes plane = {0}, plane_x = {0}, plane_y = {0};
    CF_SMALL_LOOP
    for (int j = 0; j < 3; ++j) {
      const cf_lanes *node = window + r->base[l] + (k * edge + j) * edge;
      const cf_lanes n0 = r->w[0][0][l] * node[0], n1 = r->w[0][1][l] * node[1], n2 = r->w[0][2][l] * node[2];
      const cf_lanes row = r->w[1][j][l] * (n0 + n1 + n2);
      plane += row;
      if (moment != NULL) {
        plane_x += r->w[1][j][l] * (r->d[0][0][l] * n0 + r->d[0][1][l] * n1 + r->d[0][2][l] * n2);
        plane_y += r->d[1][j][l] * row;
      }
    }
    if (dim == 2) {
      sum = plane, mx = plane_x, my = plane_y;
    } else {
      const cf_real w = r->w[2][k][l];
      plane = w * plane;
      sum += plane;
      if (moment != NULL) {
        mx += w * plane_x, my += w * plane_y;
        mz += r->d[2][k][l] * plane;
      }
    }
  }
  *value = sum;
  if (moment == NULL) return;
  moment[0] = mx, moment[1] = my;
  if (dim == 3) moment[dim - 1] = mz;
}

/* Components of `n` <= 8 particles from `first` on; lanes beyond repeat the first of them. */
CF_SMALL void cf_lanes_load(const int n, const cf_real *f, const int64_t first, cf_lanes *x) {
  if (n == CF_WIDE) {
    *x = CF_LANES_AT(f + first);
    return;
  }
  cf_real few[CF_WIDE];
  for (int l = 0; l < CF_WIDE; ++l) few[l] = f[first + (l < n ? l : 0)];
  *x = CF_LANES_AT(few);
}

CF_SMALL void cf_lanes_store(const int n, const cf_lanes *x, cf_real *f, const int64_t first) {
  if (n == CF_WIDE) {
    CF_LANES_AT_PUT(f + first) = *x;
    return;
  }
  for (int l = 0; l < n; ++l) f[first + l] = (*x)[l];
}

#endif
