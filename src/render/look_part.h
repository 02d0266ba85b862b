/* SPDX-License-Identifier: MIT
 *
 * What the styles share; see look.h.
 */
#ifndef CF_RENDER_LOOK_PART_H
#define CF_RENDER_LOOK_PART_H

#include "render/look.h"
#include "render/studio.h"

/* v, or what the style would take if it was left open. */
static inline double cf_or(const double v, const double usual) { return isnan(v) ? usual : v; }
static inline cf_vec cf_or_colour(const double v[3], const cf_vec usual) {
  return isnan(v[0]) ? usual : cf_vec_of(v);
}

typedef struct cf_stand {
  double low[3], high[3]; /* what is to be seen, m */
  double turn, rise, angle;
} cf_stand;

/* Size, samples, threads and camera. */
void cf_look_stand(const cf_look *look, const cf_stand *usual, cf_studio *s);

/* The key light, where the look says or as usual, as light[0]. */
void cf_look_key(const cf_look *look, double turn, double rise, cf_vec colour, double spread, cf_studio *s);

/* Box of the exhibit's grid. */
void cf_look_box(const cf_exhibit *e, double low[3], double high[3]);

/* Takes the picture, lays the cards over it where there are some, and develops it. */
cf_status cf_look_take(const cf_look *look, const cf_studio *s, cf_develop how, cf_canvas *c);

/* The colours of a map in linear light; `count` values to colour[i]. */
void cf_look_colours(const cf_look *look, const char *usual, int64_t count, const float *value,
                     float (*colour)[3]);

/* A level square `z` high around the box, `reach` times as wide. Keeps its corners in `at`. */
cf_solid cf_look_floor(const double low[3], const double high[3], double z, double reach, float at[4][3]);

cf_status cf_look_no(const cf_look *look, const char *what); /* CF_BAD_ARGUMENT: the exhibit lacks it */

/* --- the styles -------------------------------------------------------------------------------------- */

cf_status cf_draw_field(const cf_look *look, const cf_exhibit *e, cf_canvas *c);
cf_status cf_draw_ink(const cf_look *look, const cf_exhibit *e, cf_canvas *c);
cf_status cf_draw_smoke(const cf_look *look, const cf_exhibit *e, cf_canvas *c);
cf_status cf_draw_crystal(const cf_look *look, const cf_exhibit *e, cf_canvas *c);
cf_status cf_draw_coral(const cf_look *look, const cf_exhibit *e, cf_canvas *c);
cf_status cf_draw_mesh(const cf_look *look, const cf_exhibit *e, cf_canvas *c);
cf_status cf_draw_gel(const cf_look *look, const cf_exhibit *e, cf_canvas *c);
cf_status cf_draw_particles(const cf_look *look, const cf_exhibit *e, cf_canvas *c);
cf_status cf_draw_cards(const cf_look *look, const cf_exhibit *e, cf_canvas *c);

#endif
