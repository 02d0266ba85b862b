/* SPDX-License-Identifier: MIT */
#include "model/sources.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "grid/sweep.h"

/* One source on one component (cells, or the faces of an axis): a window of points with their fractions. */
typedef struct patch {
  const cf_fn *fn;
  int component; /* CF_CENTRES or an axis */
  enum { RATE, HOLD } kind;
  double per_cell; /* 1, or 1/volume for a point source */
  int low[3], high[3];
  double *fraction;
} patch;

struct cf_sources {
  const cf_grid *grid;
  int count;
  patch *patch;
  bool in_time[2][2]; /* [kind][0: cells, 1: faces]: must be sampled anew at every time */
  bool known[2][2];
  const cf_obstacles *obstacles; /* that hold it; NULL: none do */
  int field;
};

static bool on_faces(const patch *p) { return p->component != CF_CENTRES; }

/* --- shapes -----------------------------------------------------------------------------------------------
 */

/* The share of the interval [x - h/2, x + h/2] inside [low, high]. */
static double overlap(const double x, const double h, const double low, const double high) {
  const double from = CF_MAX(x - h / 2, low), to = CF_MIN(x + h / 2, high);
  return to > from ? (to - from) / h : 0;
}

static double box_fraction(const cf_scene_source *s, const int dim, const double h, const double x[3]) {
  double share = 1;
  for (int a = 0; a < dim; ++a)
    share *= overlap(x[a], h, s->center.value[a] - s->half.value[a], s->center.value[a] + s->half.value[a]);
  return share;
}

#define SPHERE_POINTS 8

static double sphere_fraction(const cf_scene_source *s, const int dim, const double h, const double x[3]) {
  double distance = 0;
  for (int a = 0; a < dim; ++a) distance += (x[a] - s->center.value[a]) * (x[a] - s->center.value[a]);
  distance = sqrt(distance);
  const double reach = h * sqrt((double)dim) / 2;
  if (distance + reach <= s->radius) return 1;
  if (distance - reach >= s->radius) return 0;
  int inside = 0, points = 0;
  for (int k = 0; k < (dim == 3 ? SPHERE_POINTS : 1); ++k)
    for (int j = 0; j < SPHERE_POINTS; ++j)
      for (int i = 0; i < SPHERE_POINTS; ++i, ++points) {
        const int at[3] = {i, j, k};
        double r = 0;
        for (int a = 0; a < dim; ++a) {
          const double y = x[a] + ((at[a] + 0.5) / SPHERE_POINTS - 0.5) * h - s->center.value[a];
          r += y * y;
        }
        inside += r <= s->radius * s->radius;
      }
  return (double)inside / points;
}

/* Linear weight of the cell centred at x for a point; beyond the outermost centres the border cell takes all.
 */
static double point_fraction(const cf_grid *g, const cf_scene_source *s, const double x[3], const int at[3]) {
  double weight = 1;
  for (int a = 0; a < g->box.dim; ++a) {
    const double away = (s->at.value[a] - x[a]) / g->h, size = fabs(away);
    const bool border = (at[a] == 0 && away < 0) || (at[a] == g->box.n[a] - 1 && away > 0);
    weight *= border && size <= 0.5 ? 1 : CF_MAX(0, 1 - size);
  }
  return weight;
}

static double fraction_at(const cf_grid *g, const cf_scene_source *s, const double x[3], const int at[3]) {
  if (s->given.at) return point_fraction(g, s, x, at);
  switch (s->shape) {
    case CF_SCENE_SHAPE_BOX:
      return box_fraction(s, g->box.dim, g->h, x);
    case CF_SCENE_SHAPE_SPHERE:
      return sphere_fraction(s, g->box.dim, g->h, x);
    default:
      return 1;
  }
}

/* The points that the shape may touch, clipped to the box. */
static void window_of(const cf_grid *g, const cf_scene_source *s, patch *p) {
  for (int a = 0; a < 3; ++a) {
    const int extent = cf_box_extent(&g->box, a, p->component);
    p->low[a] = 0;
    p->high[a] = extent;
    if (a >= g->box.dim || (!s->given.at && s->shape == CF_SCENE_SHAPE_EVERYWHERE)) continue;
    const double middle = s->given.at ? s->at.value[a] : s->center.value[a];
    const double reach = s->given.at ? 0 : s->shape == CF_SCENE_SHAPE_BOX ? s->half.value[a] : s->radius;
    const double from = (middle - reach - g->origin[a]) / g->h - 2,
                 to = (middle + reach - g->origin[a]) / g->h + 2;
    p->low[a] = (int)CF_MAX(0, CF_MIN(floor(from), extent));
    p->high[a] = (int)CF_MIN(extent, CF_MAX(ceil(to), 0));
  }
}

static void place_of(const cf_grid *g, const patch *p, const int at[3], double x[3]) {
  for (int a = 0; a < 3; ++a) x[a] = a < g->box.dim ? cf_grid_place(g, a, at[a], a == p->component) : 0;
}

#define FOR_WINDOW(p, at)                                              \
  for (int at[3] = {0, 0, (p)->low[2]}; at[2] < (p)->high[2]; ++at[2]) \
    for (at[1] = (p)->low[1]; at[1] < (p)->high[1]; ++at[1])           \
      for (at[0] = (p)->low[0]; at[0] < (p)->high[0]; ++at[0])

static cf_status patch_fill(const cf_grid *g, const cf_scene_source *s, patch *p) {
  window_of(g, s, p);
  ptrdiff_t points = 1;
  for (int a = 0; a < 3; ++a) points *= CF_MAX(0, p->high[a] - p->low[a]);
  CF_TRY(CF_NEW(&p->fraction, points));
  ptrdiff_t i = 0;
  FOR_WINDOW (p, at) {
    double x[3];
    place_of(g, p, at, x);
    p->fraction[i++] = fraction_at(g, s, x, at);
  }
  return CF_OK;
}

/* --- the callbacks ----------------------------------------------------------------------------------------
 */

static void zero_cells(const cf_box *box, const cf_cell f) {
  for (ptrdiff_t r = 0; r < cf_box_rows(box); ++r)
    memset(f.at + cf_box_row(box, r), 0, (size_t)box->n[0] * sizeof(cf_real));
}

static void zero_faces(const cf_box *box, const cf_face f) {
  for (int a = 0; a < box->dim; ++a)
    for (int k = 0; k < cf_box_extent(box, 2, a); ++k)
      for (int j = 0; j < cf_box_extent(box, 1, a); ++j)
        memset(f.at[a] + cf_box_at(box, 0, j, k), 0, (size_t)cf_box_extent(box, 0, a) * sizeof(cf_real));
}

static double value_at(const cf_grid *g, const patch *p, const int at[3], const double t) {
  double x[3];
  place_of(g, p, at, x);
  return cf_fn_at(p->fn, x[0], x[1], x[2], t);
}

static void add_patch(const cf_grid *g, const patch *p, const double t, cf_real *out) {
  ptrdiff_t i = 0;
  FOR_WINDOW (p, at) {
    const double share = p->fraction[i++] * p->per_cell;
    if (share != 0) out[cf_box_at(&g->box, at[0], at[1], at[2])] += (cf_real)(share * value_at(g, p, at, t));
  }
}

/* Whether fields filled at an earlier time still hold. */
static bool still_known(cf_sources *s, const int kind, const int faces) {
  const bool known = s->known[kind][faces] && !s->in_time[kind][faces];
  s->known[kind][faces] = true;
  return known;
}

static cf_status rate(void *context, const double t, const cf_cell W) {
  cf_sources *s = context;
  if (still_known(s, RATE, 0)) return CF_OK;
  zero_cells(&s->grid->box, W);
  for (int i = 0; i < s->count; ++i)
    if (s->patch[i].kind == RATE && !on_faces(&s->patch[i])) add_patch(s->grid, &s->patch[i], t, W.at);
  return CF_OK;
}

static cf_status flux_rate(void *context, const double t, const cf_face B) {
  cf_sources *s = context;
  if (still_known(s, RATE, 1)) return CF_OK;
  zero_faces(&s->grid->box, B);
  for (int i = 0; i < s->count; ++i)
    if (s->patch[i].kind == RATE && on_faces(&s->patch[i]))
      add_patch(s->grid, &s->patch[i], t, B.at[s->patch[i].component]);
  return CF_OK;
}

/* Where shapes overlap the later one in the list is laid over the earlier. */
static cf_status hold(void *context, const double t, const cf_cell fraction, const cf_cell value) {
  cf_sources *s = context;
  if (still_known(s, HOLD, 0)) return CF_OK;
  zero_cells(&s->grid->box, fraction);
  zero_cells(&s->grid->box, value);
  for (int i = 0; i < s->count; ++i) {
    const patch *p = &s->patch[i];
    if (p->kind != HOLD || on_faces(p)) continue;
    ptrdiff_t n = 0;
    FOR_WINDOW (p, at) {
      const double f = p->fraction[n++];
      const ptrdiff_t c = cf_box_at(&s->grid->box, at[0], at[1], at[2]);
      const double under = (double)fraction.at[c] * (1 - f), all = under + f;
      if (f == 0) continue;
      value.at[c] = (cf_real)((under * (double)value.at[c] + f * value_at(s->grid, p, at, t)) / all);
      fraction.at[c] = (cf_real)all;
    }
  }
  return CF_OK;
}

void cf_sources_hold_flux(const cf_sources *s, const double t, const cf_face q) {
  for (int i = 0; i < s->count; ++i) {
    const patch *p = &s->patch[i];
    if (p->kind != HOLD || !on_faces(p)) continue;
    ptrdiff_t n = 0;
    FOR_WINDOW (p, at) {
      const double f = p->fraction[n++];
      cf_real *face = &q.at[p->component][cf_box_at(&s->grid->box, at[0], at[1], at[2])];
      if (f != 0) *face = (cf_real)((1 - f) * (double)*face + f * value_at(s->grid, p, at, t));
    }
  }
}

/* --- creation ---------------------------------------------------------------------------------------------
 */

static cf_status add_one(cf_sources *s, const cf_scene_source *from, const cf_fn *fn, const int component,
                         const bool held) {
  patch *p = &s->patch[s->count++];
  *p = (patch){.fn = fn, .component = component, .kind = held ? HOLD : RATE, .per_cell = 1};
  if (from->given.at) p->per_cell = 1 / cf_grid_volume(s->grid);
  if (fn->in_time) s->in_time[p->kind][on_faces(p)] = true;
  return patch_fill(s->grid, from, p);
}

static cf_status add_source(cf_sources *s, const cf_scene_source *from, const bool flux) {
  if (from->given.at) return add_one(s, from, &from->amount.fn, CF_CENTRES, false);
  const bool held = from->given.value;
  const cf_param_functions *functions = held ? &from->value : &from->rate;
  if (!flux) return add_one(s, from, &functions->axis[0].fn, CF_CENTRES, held);
  for (int a = 0; a < s->grid->box.dim; ++a)
    CF_TRY(add_one(s, from, &functions->axis[functions->count > 1 ? a : 0].fn, a, held));
  return CF_OK;
}

static cf_status add_all(cf_sources *s, const cf_scene *scene, const char *scalar, const char *flux) {
  CF_TRY(CF_NEW(&s->patch, 3 * scene->sources.count + 1));
  for (int i = 0; i < scene->sources.count; ++i) {
    const cf_scene_source *from = &scene->sources.item[i];
    if (strcmp(from->field, scalar) == 0) CF_TRY(add_source(s, from, false));
    if (strcmp(from->field, flux) == 0) CF_TRY(add_source(s, from, true));
  }
  return CF_OK;
}

cf_status cf_sources_create(cf_sources **s, const cf_scene *scene, const cf_grid *g, const int scalar,
                            const char *flux, cf_source *acts) {
  *s = NULL;
  *acts = (cf_source){0};
  cf_sources *fresh;
  CF_TRY(CF_NEW(&fresh, 1));
  fresh->grid = g;
  fresh->field = scalar;
  const cf_status status = add_all(fresh, scene, scene->fields.item[scalar].name, flux);
  if (status != CF_OK) {
    cf_sources_destroy(fresh);
    return status;
  }
  acts->context = fresh;
  for (int i = 0; i < fresh->count; ++i) {
    const patch *p = &fresh->patch[i];
    if (p->kind == RATE && on_faces(p)) acts->flux_rate = flux_rate;
    if (p->kind == RATE && !on_faces(p)) acts->rate = rate;
    if (p->kind == HOLD && !on_faces(p)) acts->hold = hold;
  }
  *s = fresh;
  return CF_OK;
}

static cf_status held(void *context, const double t, const cf_cell value) {
  const cf_sources *s = context;
  cf_obstacles_values(s->obstacles, s->field, t, value);
  return CF_OK;
}

void cf_sources_add_held(cf_sources *s, const cf_obstacles *o, cf_source *acts) {
  if (!cf_obstacles_value_in_time(o, s->field)) return;
  s->obstacles = o;
  acts->held = held;
}

void cf_sources_destroy(cf_sources *s) {
  if (s == NULL) return;
  for (int i = 0; i < s->count; ++i) cf_free(s->patch[i].fraction);
  cf_free(s->patch);
  cf_free(s);
}
