/* SPDX-License-Identifier: MIT
 *
 * Everything that can be said about a scene before it runs, as text for a person: grid, memory, frames and
 * steps; of every scalar the regime of its diffusion (front speed, H_c, cone, band of waves, dt against tau);
 * and warnings where a choice looks unlucky. Only the velocity and k are sampled; no field is made.
 */
#ifndef CF_SESSION_CHECK_H
#define CF_SESSION_CHECK_H

#include "model/scene.h"

/* The text is the caller's: cf_free. CF_NO_MEMORY; CF_NOT_FINITE: the velocity or k is not finite somewhere. */
cf_status cf_check_text(const cf_scene *scene, char **text);

#endif
