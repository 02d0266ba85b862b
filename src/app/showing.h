/* SPDX-License-Identifier: MIT
 *
 * The folder of a run made ready to be looked at: its scene says how (`render:`), its frames say what.
 */
#ifndef CF_APP_SHOWING_H
#define CF_APP_SHOWING_H

#include "app/options.h"
#include "io/frame.h"
#include "io/points.h"
#include "model/scene.h"
#include "render/look.h"
#include "session/overlay.h"

struct cf_flock;

typedef struct cf_showing {
  const char *folder;
  cf_scene *scene;
  cf_look look;
  char field[CF_NAME_MAX];   /* what is shown, or colours what is shown */
  char surface[CF_NAME_MAX]; /* whose surface is */
  int frames;
  int64_t *number; /* of the frames, ascending */
  int up;          /* axis that is upwards; 2: nothing is turned */

  /* of the frame that is loaded */
  cf_exhibit exhibit;
  cf_frame frame;
  cf_grid grid; /* of the fields or the box, upright */
  cf_cell values[CF_EXHIBIT_FIELDS];
  cf_mesh *mesh;
  cf_points points;
  float *value, *velocity;
  struct cf_flock *flock;
  cf_overlay overlay;
  cf_canvas inset;
} cf_showing;

/* Reads run.yaml under the options --set, --style, --field, --size, --threads and lists the frames. CF_BAD_FILE: no run,
 * or no frames; CF_BAD_SCENE, CF_BAD_USAGE. */
cf_status cf_showing_open(cf_showing *s, const char *folder, const cf_arguments *a);
void cf_showing_close(cf_showing *s); /* a zeroed one is fine */

/* Loads what the style shows of a frame. */
cf_status cf_showing_load(cf_showing *s, int64_t number);

/* Gives all of them one range of values, that of the frames from..to of each (by place in `number`), unless their
 * scenes say one. */
cf_status cf_showing_range(int count, cf_showing *s, const int64_t *from, const int64_t *to);

/* The picture of the frame that is loaded. */
cf_status cf_showing_draw(cf_showing *s, cf_canvas *c);

/* --- for the files that implement this ------------------------------------------------------------------ */

/* Flakes, settled ones, ground and atlas of a snowfall (showing_flakes.c). */
cf_status cf_flock_load(cf_showing *s, int64_t number);
void cf_flock_clear(struct cf_flock *f); /* of the frame; NULL is fine, as below */
void cf_flock_destroy(struct cf_flock *f);

/* The curves of render.plot as a picture for the corner (showing_inset.c). */
cf_status cf_showing_inset(cf_showing *s);

#endif
