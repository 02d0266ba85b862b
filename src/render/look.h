/* SPDX-License-Identifier: MIT
 *
 * Pictures of what a run has made: an exhibit is what there is to see at one time, a look is how it is shown.
 *
 *   field      a plane of a field in colours, with axes, contours, arrows and curves in a corner
 *   ink        a field as ink in a tank of water with a white light behind it
 *   smoke      a field as smoke under two lights
 *   crystal    a flat crystal lit from two sides in two colours, as snow crystals are photographed
 *   coral      a surface under water: light tips, dark crevices, fog
 *   mesh       a surface in a studio, coloured by an attribute
 *   gel        a translucent body, coloured by the water in it
 *   particles  particles as balls, coloured by an attribute
 *   cards      flakes in the air and the snow on the ground
 *
 * What a look leaves open (NaN, NULL) is chosen to suit the style. Pictures to be compared, and frames of a film, must be
 * given a range: cf_exhibit_range of all of them.
 */
#ifndef CF_RENDER_LOOK_H
#define CF_RENDER_LOOK_H

#include "grid/mesh.h"
#include "render/canvas.h"
#include "render/cards.h"
#include "render/preview.h"

#define CF_STYLE_LIST(S) \
  S(field, FIELD)        \
  S(ink, INK)            \
  S(smoke, SMOKE)        \
  S(crystal, CRYSTAL) S(coral, CORAL) S(mesh, MESH) S(gel, GEL) S(particles, PARTICLES) S(cards, CARDS)

typedef enum cf_style {
#define CF_STYLE_ENUM(lower, upper) CF_STYLE_##upper,
  CF_STYLE_LIST(CF_STYLE_ENUM)
#undef CF_STYLE_ENUM
      CF_STYLES
} cf_style;

/* CF_STYLES: there is none of that name. */
cf_style cf_style_find(const char *name);

typedef struct cf_look {
  cf_style style;
  int width, height, samples, threads;
  bool framed;           /* the picture has just that size; false: style field takes the shape of its plane */
  double noise;          /* a place that has less takes no more samples; parts of white */
  double exposure;       /* stops */
  double low, high;      /* of the values */
  double strength;       /* ink, smoke: depth of a tenth of the box at the upper end of the range */
  double level;          /* of the surface, where it is made of a field */
  double colour[3];      /* linear light: what ink lets through, what a surface sends back */
  double background[3];  /* linear light */
  const char *map;       /* of colours */
  double turn, rise;     /* of the camera around what it looks at, degrees */
  double angle, zoom;    /* of view, degrees; how much nearer */
  double eye[3], aim[3]; /* instead of turn and rise; m */
  double focus, aperture, shutter;                             /* m, m, s */
  double light_turn, light_rise, light_strength, light_spread; /* degrees, times the usual */
  int contours;           /* field: how many lines of equal value; 0: none */
  bool floor;             /* surfaces and particles stand on one */
  const cf_canvas *inset; /* a picture in the corner; NULL: none */
} cf_look;

/* Everything open. */
cf_look cf_look_default(cf_style style);

typedef struct cf_exhibit_field {
  const char *name, *unit;
  const cf_real *at; /* shaped by grid->box */
} cf_exhibit_field;

#define CF_EXHIBIT_FIELDS 6

/* One kind of flake: a texture, and where the flake is in it. */
typedef struct cf_exhibit_kind {
  cf_flake_picture picture;
  double half;      /* of the texture's side, over the radius of the flake */
  double middle[2]; /* of the texture, to the right and up from the flake's centre, over its radius */
} cf_exhibit_kind;

typedef struct cf_exhibit_flakes {
  int kinds;
  const cf_exhibit_kind *kind;
  struct {
    int64_t count;
    const float (*place)[3], (*velocity)[3]; /* velocity NULL: at rest */
    const float (*turn)[4];                  /* quaternions w, x, y, z that turn z to the normal */
    const float *radius, *number;            /* m; of the kind */
  } air, settled;
  int columns[2];        /* of the ground; 0: a level one */
  const float (*top)[3]; /* its places, x first */
} cf_exhibit_flakes;

typedef struct cf_exhibit {
  const char *title;
  double time;         /* s */
  const cf_grid *grid; /* of the fields, or of the box alone */
  int fields;          /* the first is what is shown; others by name: thickness, age, arrows_x ... */
  cf_exhibit_field field[CF_EXHIBIT_FIELDS];
  const cf_mesh *mesh;   /* NULL: the surface of the first field */
  const char *attribute; /* of the mesh that colours it; NULL: none */
  int64_t particles;
  const float (*place)[3], (*velocity)[3];
  const float *value; /* that colours them; NULL: none */
  double radius;      /* of a particle, m; 0: from how many there are */
  const cf_exhibit_flakes *flakes;
  int lines; /* over a field */
  const cf_polyline *line;
} cf_exhibit;

/* NULL if it has none of that name. */
const cf_exhibit_field *cf_exhibit_find(const cf_exhibit *e, const char *name);

/* Widens low..high (start with INFINITY, -INFINITY) by what the look would show of the exhibit. */
cf_status cf_exhibit_range(const cf_look *look, const cf_exhibit *e, double *low, double *high);

/* How near style crystal must go so that what is frozen of the first field fills the picture's height. */
double cf_crystal_zoom(const cf_exhibit *e);

/* The picture, on a fresh canvas. CF_BAD_ARGUMENT: the exhibit lacks what the style shows, with a sentence that says
 * what; CF_NO_MEMORY. */
cf_status cf_look_draw(const cf_look *look, const cf_exhibit *e, cf_canvas *c);

#endif
