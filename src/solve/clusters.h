/* SPDX-License-Identifier: MIT
 *
 * Levels of clusters, for equations whose couplings are far from alike: fluids a thousand times apart in density, layers,
 * grains of a cell. A level of blocks (coarsen.h) has one value for all that lies in a block, on whatever side of a jump; a
 * cluster is made of cells that are strongly coupled, wherever they lie, and so knows of no jump within.
 *
 * Cells are matched in pairs, pairs with pairs, and in space those once more: up to 4 or 8 cells a cluster, the unknowns of a
 * graph whose couplings are the sums of those between clusters (the Galerkin operator of a correction that is constant on
 * each); these are matched again, until few are left, which elimination solves. Two clusters g and h are matched if
 *
 *     2 / (1/D_g + 1/D_h)  <=  kappa (c_gh + 1/(1/f_g + 1/f_h)),
 *
 * D the diagonals of their cells, f what alpha and known values add; the best partner for each in turn. That bounds what two
 * grids leave of any error, whatever the coefficients (Napov, Notay 2012). What alpha holds fast is left to smoothing.
 *
 * Constant corrections are too stiff by a factor of about two for what is smooth, more with each level. So each level is solved
 * by one or two steps of conjugate gradients around the next (the K-cycle; Notay, Vassilevski 2008).
 *
 * Everything that is made follows one order of the cells, and sums have fixed pieces: the same bits for any number of threads,
 * with tiles and without. Making them costs about as much as a solution and goes on one thread.
 */
#ifndef CF_SOLVE_CLUSTERS_H
#define CF_SOLVE_CLUSTERS_H

#include "solve/coupled.h"

#define CF_CLUSTER_LEVELS_MAX  40
#define CF_CLUSTER_COLOURS_MAX 32

/* A level below the finest. Arrays have one entry an unknown where nothing else is said. */
typedef struct cf_cluster_level {
  int32_t n;
  int32_t *start, *to; /* neighbours of u: to[start[u]], ..., to[start[u + 1] - 1]; */
  int32_t *later;      /* from to[later[u]] on those that a sweep forth meets after u */
  float *c;            /* couplings with them */
  float *fixed, *inverse;
  int32_t *first, *child; /* what u is made of: unknowns child[first[u]], ... of the level above, or cells */
  int colours;
  int32_t colour[CF_CLUSTER_COLOURS_MAX + 1], *order; /* unknowns by colour; neighbours have different ones */
  float *e, *r, *rest, *u, *Au;
} cf_cluster_level;

typedef struct cf_clusters {
  int levels; /* level[0] is below the finest */
  cf_cluster_level level[CF_CLUSTER_LEVELS_MAX];
  double *factor; /* of the last level, if it is eliminated; */
  int32_t
      *part; /* of its unknowns that hang together: the first one, or -1 where something fixes their level */
  double *sums;
  int threads;
} cf_clusters;

/* Makes all levels for l, whose couplings are complete. *made: false where there is nothing to make them of, or too many cells
 * to number. CF_NO_MEMORY: there are none. */
cf_status cf_clusters_make(cf_clusters *q, const cf_coupled *l, bool *made);
void cf_clusters_clear(cf_clusters *q); /* a zeroed one is fine */

/* l->e += a correction for l->rest. */
void cf_clusters_correct(const cf_clusters *q, const cf_coupled *l);

/* Whether couplings of some cell of l differ so much that clusters are called for. */
bool cf_clusters_are_called_for(const cf_coupled *l);

#endif
