/* SPDX-License-Identifier: MIT
 *
 * The part of `check` that is about one scalar: the regime of its diffusion (section 3 and 5 of the paper) and
 * what the chosen step and spacing make of it.
 */
#ifndef CF_SESSION_CHECK_SCALAR_H
#define CF_SESSION_CHECK_SCALAR_H

#include "io/scene_text.h"
#include "model/scene.h"
#include "model/sim.h"

/* What the parts of `check` know of a scene. */
typedef struct cf_check {
  const cf_scene *scene;
  double dt;    /* s, of a step that is not shortened */
  double speed; /* the largest |u| at time 0, m/s */
  cf_sim *sim;  /* as a run would begin; NULL: too large to be tried */
  cf_writing page, warnings;
} cf_check;

/* Adds a row, the text wrapped in its column; `indent` blanks stand before the name. */
void cf_check_add(cf_check *c, int indent, const char *name, const char *text);

/* The least and the largest value of a function of place on a lattice of points in the box. */
typedef struct cf_extremes {
  double least, largest;
} cf_extremes;

/* `key` is where an error points. CF_BAD_SCENE: not finite somewhere. */
cf_status cf_check_sample(const cf_scene *scene, const cf_fn *f, const char *key, cf_extremes *e);

/* Adds the lines of scene->fields.item[field] to the page, and what is unlucky to the warnings; of the scheme only
 * where the scalar has a plan of its own. */
cf_status cf_check_scalar(cf_check *c, int field, bool planned);

#endif
