/* SPDX-License-Identifier: MIT */
#include "render/look.h"

#include <math.h>
#include <string.h>

#include "base/real.h"
#include "render/colormap.h"
#include "render/look_part.h"
#include "render/plot.h"

static const struct {
  const char *name;
  cf_status (*draw)(const cf_look *look, const cf_exhibit *e, cf_canvas *c);
} styles[] = {
#define STYLE(lower, upper) {#lower, cf_draw_##lower},
    CF_STYLE_LIST(STYLE)
#undef STYLE
};

cf_style cf_style_find(const char *name) {
  int i = 0;
  while (i < CF_STYLES && strcmp(styles[i].name, name) != 0) ++i;
  return (cf_style)i;
}

cf_look cf_look_default(const cf_style style) {
  const double open = (double)NAN;
  cf_look l = {.style = style,
               .width = 1280,
               .height = 720,
               .samples = 16,
               .noise = 0.01,
               .threads = 1,
               .zoom = 1,
               .floor = true};
  double *const numbers[] = {&l.low,   &l.high,  &l.strength, &l.level,      &l.turn,       &l.rise,
                             &l.angle, &l.focus, &l.aperture, &l.light_turn, &l.light_rise, &l.light_spread};
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; ++i) *numbers[i] = open;
  for (int a = 0; a < 3; ++a) l.colour[a] = l.background[a] = l.eye[a] = l.aim[a] = open;
  l.light_strength = 1;
  return l;
}

const cf_exhibit_field *cf_exhibit_find(const cf_exhibit *e, const char *name) {
  for (int i = 0; i < e->fields; ++i)
    if (strcmp(e->field[i].name, name) == 0) return &e->field[i];
  return NULL;
}

/* Into the lower right corner; beside a field with its axes, so that nothing of it is hidden. */
static cf_status set_in(const cf_look *look, cf_canvas *c) {
  const cf_canvas *inset = look->inset;
  const int rim = CF_MAX(c->height / 60, 6), y = CF_MAX(c->height - inset->height - rim, 0);
  if (look->style == CF_STYLE_FIELD) {
    cf_canvas wider;
    CF_TRY(cf_canvas_create(&wider, (c->width + inset->width + rim + 1) & ~1, c->height, cf_plot_ground));
    cf_canvas_copy(&wider, 0, 0, c);
    cf_canvas_destroy(c);
    *c = wider;
    cf_canvas_copy(c, c->width - inset->width - rim, y, inset);
    return CF_OK;
  }
  const int x = c->width - inset->width - rim;
  cf_canvas_fill(c, x - 1, y - 1, inset->width + 2, inset->height + 2, (cf_colour){120, 120, 125});
  cf_canvas_copy(c, x, y, inset);
  return CF_OK;
}

cf_status cf_look_draw(const cf_look *look, const cf_exhibit *e, cf_canvas *c) {
  *c = (cf_canvas){.rgb = NULL};
  if (look->style < 0 || look->style >= CF_STYLES)
    return cf_fail(CF_BAD_ARGUMENT, "there is no style %d", (int)look->style);
  if (look->width < 16 || look->height < 16)
    return cf_fail(CF_BAD_ARGUMENT, "a picture of %d x %d pixels: sides must be 16 at least", look->width,
                   look->height);
  CF_TRY(styles[look->style].draw(look, e, c));
  return look->inset != NULL ? set_in(look, c) : CF_OK;
}

cf_status cf_look_no(const cf_look *look, const char *what) {
  return cf_fail(CF_BAD_ARGUMENT, "style %s shows %s, and there is none", styles[look->style].name, what);
}

/* --- range --------------------------------------------------------------------------------------------------------- */

static void widen(double *low, double *high, const double v) {
  if (!isfinite(v)) return;
  *low = CF_MIN(*low, v);
  *high = CF_MAX(*high, v);
}

static const cf_mesh_attribute *attribute_of(const cf_exhibit *e) {
  for (int a = 0; e->mesh != NULL && e->attribute != NULL && a < e->mesh->attributes; ++a)
    if (strcmp(e->mesh->attribute[a].name, e->attribute) == 0) return &e->mesh->attribute[a];
  return NULL;
}

/* Ink and smoke begin at 0, and are at their densest where all but the densest quarter of what there is has been counted:
 * the few cells of a source do not make all the rest pale. */
static void widen_by_field(const cf_look *look, const cf_exhibit *e, double *low, double *high) {
  enum { BINS = 1024 };
  const cf_box *b = &e->grid->box;
  double least = (double)INFINITY, most = -(double)INFINITY, amount[BINS] = {0}, sum = 0;
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    for (int i = 0; i < b->n[0]; ++i) widen(&least, &most, (double)e->field[0].at[cf_box_row(b, r) + i]);
  if ((look->style != CF_STYLE_INK && look->style != CF_STYLE_SMOKE) || !(most > 0)) {
    widen(low, high, least), widen(low, high, most);
    return;
  }
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    for (int i = 0; i < b->n[0]; ++i) {
      const double v = (double)e->field[0].at[cf_box_row(b, r) + i];
      if (v > 0 && isfinite(v)) amount[CF_MIN((int)(v / most * BINS), BINS - 1)] += v, sum += v;
    }
  int top = BINS - 1;
  for (double above = amount[top]; top > 0 && above < 0.25 * sum;) above += amount[--top];
  widen(low, high, 0), widen(low, high, most * (top + 1) / BINS);
}

cf_status cf_exhibit_range(const cf_look *look, const cf_exhibit *e, double *low, double *high) {
  const cf_mesh_attribute *a = attribute_of(e);
  if (look->style == CF_STYLE_PARTICLES) {
    for (int64_t i = 0; e->value != NULL && i < e->particles; ++i) widen(low, high, (double)e->value[i]);
  } else if (a != NULL) {
    for (int64_t i = 0; i < e->mesh->vertices; ++i) widen(low, high, (double)a->at[i]);
  } else if (e->fields > 0) {
    const cf_preview p = cf_preview_default(e->field[0].name, "");
    const bool flat = look->style == CF_STYLE_FIELD;
    cf_scale s;
    if (flat) {
      CF_TRY(cf_preview_scale(&s, 1, &e->grid, &e->field[0].at, &p));
      widen(low, high, s.low), widen(low, high, s.high);
      return CF_OK;
    }
    widen_by_field(look, e, low, high);
  }
  return CF_OK;
}

/* --- what the styles share ------------------------------------------------------------------------------------------ */

void cf_look_box(const cf_exhibit *e, double low[3], double high[3]) {
  for (int a = 0; a < 3; ++a) {
    low[a] = e->grid->origin[a];
    high[a] = low[a] + e->grid->h * e->grid->box.n[a];
  }
}

void cf_look_stand(const cf_look *look, const cf_stand *usual, cf_studio *s) {
  const double aspect = (double)look->width / look->height;
  s->width = look->width, s->height = look->height;
  s->samples = look->samples, s->threads = look->threads;
  s->noise = (float)(look->noise * exp2(-look->exposure / 2)); /* of sqrt(light) before it is exposed */
  s->camera = cf_camera_around(usual->low, usual->high, cf_or(look->turn, usual->turn),
                               cf_or(look->rise, usual->rise), cf_or(look->angle, usual->angle), aspect);
  for (int a = 0; a < 3; ++a) {
    const double off = s->camera.eye[a] - s->camera.aim[a];
    s->camera.aim[a] = cf_or(look->aim[a], s->camera.aim[a]);
    s->camera.eye[a] = cf_or(look->eye[a], s->camera.aim[a] + off / look->zoom);
  }
  s->camera.focus = cf_or(look->focus, 0);
  s->camera.aperture = cf_or(look->aperture, 0);
}

void cf_look_key(const cf_look *look, const double turn, const double rise, const cf_vec colour,
                 const double spread, cf_studio *s) {
  s->light[0] =
      (cf_light){.toward = cf_light_toward(cf_or(look->light_turn, turn), cf_or(look->light_rise, rise)),
                 .colour = cf_vec_scale((float)look->light_strength, colour),
                 .spread = (float)(cf_or(look->light_spread, spread) * acos(-1.0) / 180)};
  s->lights = CF_MAX(s->lights, 1);
}

cf_status cf_look_take(const cf_look *look, const cf_studio *s, cf_develop how, cf_canvas *c) {
  cf_film f;
  how.exposure += look->exposure;
  CF_TRY(cf_studio_expose(s, &f));
  const cf_status status = cf_film_develop(&f, &how, c);
  cf_film_destroy(&f);
  return status;
}

void cf_look_colours(const cf_look *look, const char *usual, const int64_t count, const float *value,
                     float (*colour)[3]) {
  enum { SHADES = 512 };
  cf_colour shade[SHADES];
  cf_vec light[SHADES];
  cf_colormap map;
  const double low = cf_or(look->low, 0), high = cf_or(look->high, 1);
  if (look->map == NULL || cf_colormap_find(look->map, &map) != CF_OK) cf_colormap_find(usual, &map);
  cf_colormap_fill(map, SHADES, shade);
  for (int i = 0; i < SHADES; ++i) light[i] = cf_colour_light(shade[i]);
  for (int64_t i = 0; i < count; ++i) {
    const double part = high > low ? ((double)value[i] - low) / (high - low) : 0;
    const int n = isfinite(part) ? (int)lrint(CF_MIN(CF_MAX(part, 0), 1) * (SHADES - 1)) : 0;
    colour[i][0] = light[n].x, colour[i][1] = light[n].y, colour[i][2] = light[n].z;
  }
}

cf_solid cf_look_floor(const double low[3], const double high[3], const double z, const double reach,
                       float at[4][3]) {
  static const uint32_t corner[2][3] = {{0, 1, 2}, {0, 2, 3}};
  const double wide = reach * CF_MAX(high[0] - low[0], CF_MAX(high[1] - low[1], high[2] - low[2]));
  for (int i = 0; i < 4; ++i) {
    at[i][0] = (float)(0.5 * (low[0] + high[0]) + (i == 1 || i == 2 ? wide : -wide));
    at[i][1] = (float)(0.5 * (low[1] + high[1]) + (i >= 2 ? wide : -wide));
    at[i][2] = (float)z;
  }
  return (cf_solid){.vertices = 4, .triangles = 2, .at = (const float(*)[3])at, .corner = corner};
}
