/* SPDX-License-Identifier: MIT
 *
 * What the files of physics/advect.h share.
 *
 *   advect.c        creation, velocity and step, and what stands on the walls of cells, faces and the velocity itself
 *   advect_move.c   one substep of one component, by each scheme
 */
#ifndef CF_PHYSICS_ADVECT_PART_H
#define CF_PHYSICS_ADVECT_PART_H

#include "grid/wall.h"
#include "physics/advect.h"
#include "stencil/ppm.h"

struct cf_advect {
  const cf_grid *grid;
  cf_advect_scheme scheme;
  cf_face u;
  bool wrap[3], still[3]; /* still: nothing moves along this axis */
  double rate;            /* K per second */
  double time, dt;        /* of the step begun; dt of a substep */
  int substeps;           /* of the step begun */
  int64_t parity, first;  /* of the next step; of the step begun */
  cf_cell work, second;   /* second: of CF_ADVECT_WENO5 alone */
  cf_face turned;         /* q half a stretch on, or scratch of a second field; else not committed */
  cf_wall_values
      walls[CF_PPM_FIELDS]; /* room for every wall; the walls are those of the fields being moved */
  cf_real *rows;
  double *lines[CF_PPM_FIELDS];
};

/* What is being moved. */
typedef struct cf_moved {
  int component, count[3];
  cf_ghost ghost[3][2];
  const double *inflow[3][2]; /* CF_GHOST_INFLOW: what comes in, a value for each volume at the wall */
  bool mass;                  /* flux form: the sum is kept */
  cf_real *at;
  cf_through *through; /* NULL: nobody asks */
} cf_moved;

/* Whether the scheme goes back along paths: a step is then as long as one likes, and no sum is kept. */
bool cf_advect_is_traced(const cf_advect *a);

/* Moves `fields` of them, of the same kind, over substep number `substep` of the step begun; more than one by sweeps
 * alone share what they can. */
void cf_advect_move(cf_advect *a, const cf_moved *m, int fields, int substep);

#endif
