/* SPDX-License-Identifier: MIT
 *
 * What a run writes at a frame, by the scene's `output:` section: fields for ParaView and NumPy, and a
 * picture.
 */
#ifndef CF_SESSION_OUTPUT_H
#define CF_SESSION_OUTPUT_H

#include "model/sim.h"

/* Checks output.fields and output.preview against what the model has. CF_BAD_SCENE at the key. */
cf_status cf_output_check(const cf_sim *sim);

/* Writes every format of frame sim->frame into the folder. */
cf_status cf_output_frame(cf_sim *sim, const char *folder);

#endif
