/* SPDX-License-Identifier: MIT
 *
 * What a run takes of the machine, known before it is taken: memory, and room on the disk.
 */
#ifndef CF_SESSION_SPACE_H
#define CF_SESSION_SPACE_H

#include "model/sim.h"

/* Bytes that a run of the scene needs at most. */
double cf_space_memory(const cf_scene *scene);

/* Bytes that a process can have here: what the machine, its control group or `ulimit -v` leaves, whichever is least. */
double cf_space_machine(void);

/* CF_OVER_LIMIT with the numbers if the run may need more than `limit` bytes; 0: than the machine has. */
cf_status cf_space_check_memory(const cf_scene *scene, double limit);

/* Bytes of a frame's fields and of a checkpoint, before compression; bytes that are free where `folder` is. */
double cf_space_frame(const cf_sim *sim);
double cf_space_checkpoint(const cf_sim *sim);
double cf_space_free(const char *folder);

/* CF_OVER_LIMIT with the numbers if not even a frame and a checkpoint fit on the disk. */
cf_status cf_space_check_disk(const cf_sim *sim, const char *folder);

/* "memory: up to 12 MB of 16 GB; disk: 0.5 MB a frame, ..." */
void cf_space_text(const cf_sim *sim, const char *folder, char *text, size_t size);

/* Sizes for people: "12 MB", "3.4 GB". */
void cf_space_bytes(double bytes, char text[32]);

#endif
