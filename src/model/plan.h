/* SPDX-License-Identifier: MIT
 *
 * How a scalar of a scene is computed: which scheme takes its steps, in which form its flux is kept, and why.
 *
 * A plan follows from the scene and the length of a step alone, so it is the same on every machine, for any
 * number of threads and after a resume.
 *
 *     scheme: default   leapfrog where its substeps are predicted to cost at most twice what two implicit stages do
 *                       (and err ten times less): the flux has a memory and no part of Fourier's law, and the step
 *                       is not many times what waves allow, 9 to 16 substeps at most. sdirk2 otherwise: much of
 *                       Fourier's law, tau far below the step, fine cells.
 *     the flux          as s = div q in cells (dim times less memory, one scalar for the flow to carry) where that is
 *                       exact and nobody asks for q: rate objective or a medium at rest, q named in none of
 *                       `fields`, `output`, `sources`, no radiating wall. On faces otherwise.
 */
#ifndef CF_MODEL_PLAN_H
#define CF_MODEL_PLAN_H

#include "model/scene.h"
#include "physics/diffuse.h"

typedef struct cf_plan {
  cf_diffuse_scheme scheme;
  bool scalar_form, front_filter, positive;
  double substeps; /* explicit ones, of the step the plan was made for; 1 for implicit schemes */
  char why[160];   /* "leapfrog, 2 explicit substeps a step: sharper fronts at 0.5 times the cost of ..." */
} cf_plan;

/* For the scalar scene->fields.item[field]. D: its largest k/C, m^2/s; dt: a step that is not shortened, s. */
void cf_plan_make(const cf_scene *scene, int field, double D, double dt, cf_plan *plan);

/* The step that a frame rate leaves of dt. */
double cf_plan_step(const cf_scene *scene, double dt);

/* The name of the flux of a scalar: q for phi or the only scalar, else q_NAME. */
void cf_plan_flux_name(const cf_scene *scene, int field, char name[CF_NAME_MAX]);

#endif
