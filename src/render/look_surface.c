/* SPDX-License-Identifier: MIT
 *
 * Surfaces: in a studio, under water, and as jelly. The mesh of the exhibit, or, where it has none, the surface on which
 * its first field has the value `level`.
 */
#include "render/look_part.h"

#include <string.h>

#include "base/mem.h"
#include "base/real.h"
#include "grid/isosurface.h"

/* A mesh in the numbers that rays want. */
typedef struct body {
  cf_mesh *made; /* NULL: it was given */
  const cf_mesh *mesh;
  float (*at)[3], (*normal)[3], (*colour)[3];
  float *value; /* that colours it */
  uint32_t (*corner)[3];
  double low[3], high[3];
} body;

static void body_destroy(body *b) {
  cf_mesh_destroy(b->made);
  cf_free(b->at);
  cf_free(b->normal);
  cf_free(b->colour);
  cf_free(b->value);
  cf_free(b->corner);
}

static cf_status make_mesh(const cf_look *look, const cf_exhibit *e, body *b) {
  cf_isosurface rule = {.level = cf_or(look->level, 0.5), .caps = true};
  b->mesh = e->mesh;
  if (b->mesh != NULL) return CF_OK;
  if (e->fields == 0 || e->grid->box.dim != 3)
    return cf_look_no(look, "a mesh, or the surface of a field in 3D");
  CF_TRY(cf_mesh_create(&b->made));
  CF_TRY(cf_isosurface_make(b->made, e->grid, (cf_cell){(cf_real *)(uintptr_t)e->field[0].at}, &rule));
  for (int i = 1; i < e->fields && b->made->vertices > 0; ++i)
    CF_TRY(cf_mesh_sample(b->made, e->grid, (cf_cell){(cf_real *)(uintptr_t)e->field[i].at}, e->field[i].name,
                          e->field[i].unit));
  b->mesh = b->made;
  return CF_OK;
}

static const cf_mesh_attribute *attribute_of(const body *b, const char *name) {
  for (int a = 0; name != NULL && a < b->mesh->attributes; ++a)
    if (strcmp(b->mesh->attribute[a].name, name) == 0) return &b->mesh->attribute[a];
  return NULL;
}

static void fill(body *b, const cf_mesh_attribute *a) {
  for (int64_t i = 0; i < b->mesh->vertices; ++i) {
    for (int c = 0; c < 3; ++c) {
      b->at[i][c] = (float)b->mesh->place[i][c];
      if (b->mesh->normal != NULL) b->normal[i][c] = (float)b->mesh->normal[i][c];
      b->low[c] = i == 0 ? (double)b->at[i][c] : CF_MIN(b->low[c], (double)b->at[i][c]);
      b->high[c] = i == 0 ? (double)b->at[i][c] : CF_MAX(b->high[c], (double)b->at[i][c]);
    }
    b->value[i] = a != NULL ? (float)a->at[i] : 0;
  }
  for (int64_t t = 0; t < b->mesh->triangles; ++t)
    for (int c = 0; c < 3; ++c) b->corner[t][c] = (uint32_t)b->mesh->corner[t][c];
}

/* *coloured: the exhibit names an attribute that the mesh has. */
static cf_status body_create(const cf_look *look, const cf_exhibit *e, body *b, bool *coloured) {
  *b = (body){.made = NULL};
  CF_TRY(make_mesh(look, e, b));
  const int64_t n = b->mesh->vertices;
  if (n == 0) return cf_look_no(look, "a surface");
  CF_TRY(CF_NEW(&b->at, n));
  CF_TRY(CF_NEW(&b->normal, n));
  CF_TRY(CF_NEW(&b->colour, n));
  CF_TRY(CF_NEW(&b->value, n));
  CF_TRY(CF_NEW(&b->corner, CF_MAX(b->mesh->triangles, 1)));
  const cf_mesh_attribute *a = attribute_of(b, e->attribute);
  *coloured = a != NULL;
  fill(b, a);
  return CF_OK;
}

static cf_solid solid_of(const body *b, const cf_material m) {
  return (cf_solid){.vertices = b->mesh->vertices,
                    .triangles = b->mesh->triangles,
                    .at = (const float(*)[3])b->at,
                    .normal = b->mesh->normal != NULL ? (const float(*)[3])b->normal : NULL,
                    .colour = (const float(*)[3])b->colour,
                    .corner = (const uint32_t(*)[3])b->corner,
                    .material = m};
}

static void paint(const body *b, const cf_vec colour) {
  for (int64_t i = 0; i < b->mesh->vertices; ++i)
    b->colour[i][0] = colour.x, b->colour[i][1] = colour.y, b->colour[i][2] = colour.z;
}

/* The range of the look, or the values' own. */
static cf_look with_range(const cf_look *look, const body *b) {
  cf_look l = *look;
  double low = (double)INFINITY, high = -(double)INFINITY;
  for (int64_t i = 0; i < b->mesh->vertices; ++i) {
    low = CF_MIN(low, (double)b->value[i]);
    high = CF_MAX(high, (double)b->value[i]);
  }
  l.low = cf_or(look->low, low), l.high = cf_or(look->high, high);
  return l;
}

/* A floor under it: at the floor of the box if it stands there, else a little below. */
static double floor_of(const cf_exhibit *e, const body *b) {
  const double tall = b->high[2] - b->low[2];
  const double box = e->grid != NULL ? e->grid->origin[2] : b->low[2];
  return b->low[2] - box < 0.1 * tall ? CF_MIN(box, b->low[2]) - 1e-3 * tall : b->low[2] - 0.03 * tall;
}

static void frame(const cf_look *look, const body *b, cf_stand stand, cf_studio *s) {
  for (int a = 0; a < 3; ++a) stand.low[a] = b->low[a], stand.high[a] = b->high[a];
  cf_look_stand(look, &stand, s);
}

static cf_status end(const cf_look *look, cf_studio *s, const cf_develop *how, body *b, cf_status status,
                     cf_canvas *c) {
  if (status == CF_OK) status = cf_look_take(look, s, *how, c);
  body_destroy(b);
  return status;
}

/* --- in a studio ----------------------------------------------------------------------------------------------------- */

static void studio_light(const cf_look *look, cf_studio *s) {
  cf_look_key(look, 40, 48, (cf_vec){2.0f, 1.9f, 1.75f}, 9, s);
  s->light[s->lights++] = (cf_light){cf_light_toward(-70, 25), {0.30f, 0.36f, 0.46f}, 0.4f};
  s->light[s->lights++] = (cf_light){cf_light_toward(165, 35), {0.55f, 0.62f, 0.72f}, 0.2f};
  s->sky = (cf_sky){{0.50f, 0.54f, 0.60f}, {0.36f, 0.37f, 0.39f}, {0.10f, 0.10f, 0.10f}};
  s->bounce = 0.5f;
}

/* Floor and wall run into each other, as on a roll of paper. */
static void paper_roll(const cf_look *look, const cf_exhibit *e, const body *b, float corners[4][3],
                       cf_studio *s) {
  const cf_vec paper = cf_or_colour(look->background, (cf_vec){0.62f, 0.64f, 0.67f});
  double tall = 0, away = 0;
  for (int a = 0; a < 3; ++a) {
    tall = CF_MAX(tall, b->high[a] - b->low[a]);
    away += (s->camera.eye[a] - s->camera.aim[a]) * (s->camera.eye[a] - s->camera.aim[a]);
  }
  const float fade = (float)(0.35 / sqrt(away));
  s->backdrop = (cf_backdrop){paper, cf_vec_scale(0.55f, paper), {0.5f, 0.4f}, 1.1f};
  if (!look->floor) return;
  s->solid[s->solids] = cf_look_floor(b->low, b->high, floor_of(e, b), 40, corners);
  s->solid[s->solids++].material = (cf_material){.tint = cf_vec_scale(0.72f, paper)};
  s->haze = (cf_haze){{0.3f * fade, 0.3f * fade, 0.3f * fade}, cf_vec_scale(0.8f, paper)};
}

cf_status cf_draw_mesh(const cf_look *look, const cf_exhibit *e, cf_canvas *c) {
  const cf_develop how = {.contrast = 1.2, .white = 3.5, .vignette = 0.2};
  cf_studio s = {.seed = 1};
  float corners[4][3];
  bool coloured = false;
  body b;
  const cf_status status = body_create(look, e, &b, &coloured);
  if (status == CF_OK) {
    const cf_look l = with_range(look, &b);
    if (coloured && isnan(look->colour[0]))
      cf_look_colours(&l, "moss", b.mesh->vertices, b.value, b.colour);
    else
      paint(&b, cf_or_colour(look->colour, (cf_vec){0.66f, 0.64f, 0.60f}));
    frame(look, &b, (cf_stand){.turn = 28, .rise = 22, .angle = 24}, &s);
    studio_light(look, &s);
    paper_roll(look, e, &b, corners, &s);
    s.solid[s.solids++] = solid_of(&b, (cf_material){.tint = {1, 1, 1}, .gloss = 0.035f, .roughness = 0.45f});
  }
  return end(look, &s, &how, &b, status, c);
}

/* --- jelly ------------------------------------------------------------------------------------------------------------- */

/* Dry gel is straw-coloured, wet gel blue; the band between moves. */
static void colour_by_water(const cf_look *look, const body *b) {
  static const cf_vec dry = {0.66f, 0.34f, 0.08f}, damp = {0.48f, 0.52f, 0.38f}, wet = {0.008f, 0.11f, 0.42f};
  const cf_look l = with_range(look, b);
  for (int64_t i = 0; i < b->mesh->vertices; ++i) {
    const double part = l.high > l.low ? ((double)b->value[i] - l.low) / (l.high - l.low) : 0;
    const float x = (float)CF_MIN(CF_MAX(part, 0), 1);
    const cf_vec v = x < 0.5f ? cf_vec_mix(dry, damp, 2 * x) : cf_vec_mix(damp, wet, 2 * x - 1);
    b->colour[i][0] = v.x, b->colour[i][1] = v.y, b->colour[i][2] = v.z;
  }
}

cf_status cf_draw_gel(const cf_look *look, const cf_exhibit *e, cf_canvas *c) {
  const cf_develop how = {.contrast = 1.18, .white = 3.5, .vignette = 0.2};
  cf_studio s = {.seed = 1};
  float corners[4][3];
  bool coloured = false;
  body b;
  const cf_status status = body_create(look, e, &b, &coloured);
  if (status == CF_OK) {
    if (coloured && look->map != NULL) {
      const cf_look l = with_range(look, &b);
      cf_look_colours(&l, look->map, b.mesh->vertices, b.value, b.colour);
    } else if (coloured) {
      colour_by_water(look, &b);
    } else {
      paint(&b, cf_or_colour(look->colour, (cf_vec){0.35f, 0.62f, 0.82f}));
    }
    frame(look, &b, (cf_stand){.turn = 28, .rise = 26, .angle = 24}, &s);
    studio_light(look, &s);
    paper_roll(look, e, &b, corners, &s);
    /* Light is down to a third after the shortest side of the body. */
    const double side = CF_MIN(b.high[0] - b.low[0], CF_MIN(b.high[1] - b.low[1], b.high[2] - b.low[2]));
    const float dim = (float)(0.8 / CF_MAX(side, 1e-6 * (b.high[0] - b.low[0])));
    s.solid[s.solids++] = solid_of(&b, (cf_material){.tint = {1, 1, 1},
                                                     .gloss = 0.028f,
                                                     .roughness = 0.16f,
                                                     .through = 0.5f,
                                                     .absorb = {dim, 0.8f * dim, 0.7f * dim},
                                                     .clear = 0.12f,
                                                     .index = 1.34f});
  }
  return end(look, &s, &how, &b, status, c);
}

/* --- under water --------------------------------------------------------------------------------------------------------- */

/* Without an attribute the height is what colours it: tips are young. */
static void colour_coral(const cf_look *look, const body *b, const bool coloured) {
  const cf_vec young = {0.90f, 0.64f, 0.44f};
  const cf_vec old = cf_or_colour(look->colour, (cf_vec){0.55f, 0.16f, 0.10f});
  const cf_look l = with_range(look, b);
  const double tall = CF_MAX(b->high[2] - b->low[2], 1e-30);
  for (int64_t i = 0; i < b->mesh->vertices; ++i) {
    double part = ((double)b->at[i][2] - b->low[2]) / tall;
    if (coloured) part = l.high > l.low ? ((double)b->value[i] - l.low) / (l.high - l.low) : 0;
    const float x = cf_smooth_step(0.35f, 1.02f, (float)part);
    const cf_vec v = cf_vec_mix(old, young, x * x);
    b->colour[i][0] = v.x, b->colour[i][1] = v.y, b->colour[i][2] = v.z;
  }
}

cf_status cf_draw_coral(const cf_look *look, const cf_exhibit *e, cf_canvas *c) {
  const cf_develop how = {.contrast = 1.25, .white = 3.5, .glow = 0.05, .vignette = 0.45};
  const cf_vec water = cf_or_colour(look->background, (cf_vec){0.018f, 0.120f, 0.190f});
  cf_studio s = {.seed = 1, .bounce = 0.4f};
  float corners[4][3];
  bool coloured = false;
  body b;
  const cf_status status = body_create(look, e, &b, &coloured);
  if (status == CF_OK) {
    colour_coral(look, &b, coloured);
    frame(look, &b, (cf_stand){.turn = 25, .rise = 14, .angle = 30}, &s);
    cf_look_key(look, 35, 58, (cf_vec){2.1f, 2.0f, 1.75f}, 4, &s);
    s.light[s.lights++] = (cf_light){cf_light_toward(-120, 35), {0.22f, 0.55f, 0.75f}, 0.4f};
    s.sky = (cf_sky){{0.42f, 0.72f, 0.85f}, {0.10f, 0.28f, 0.38f}, {0.04f, 0.07f, 0.08f}};
    s.backdrop = (cf_backdrop){.middle = water, .edge = water}; /* no horizon: the floor ends in fog */
    double away = 0;
    for (int a = 0; a < 3; ++a)
      away += (s.camera.eye[a] - s.camera.aim[a]) * (s.camera.eye[a] - s.camera.aim[a]);
    const float fade = (float)(1 / sqrt(away));
    s.haze = (cf_haze){{0.40f * fade, 0.26f * fade, 0.23f * fade}, water};
    if (look->floor) {
      s.solid[s.solids] = cf_look_floor(b.low, b.high, floor_of(e, &b), 40, corners);
      s.solid[s.solids++].material = (cf_material){.tint = {0.30f, 0.27f, 0.21f}};
    }
    s.solid[s.solids++] = solid_of(&b, (cf_material){.tint = {1, 1, 1}, .gloss = 0.02f, .roughness = 0.6f});
  }
  return end(look, &s, &how, &b, status, c);
}
