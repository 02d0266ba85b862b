/* SPDX-License-Identifier: MIT
 *
 * What is solid at first, which way each crystal is turned, and where it may grow.
 *
 * A seed is a profile across a signed distance d, eta = (1 - tanh(d/(2 sqrt(2) eps)))/2; where seeds overlap the
 * larger eta counts. Crystals with angles of their own are told apart by a label: a cell that begins to freeze takes
 * that of the neighbour with the most solid, so a crystal carries its axes with it wherever it grows.
 */
#include <math.h>

#include "base/mem.h"
#include "grid/halo.h"
#include "grid/shape.h"
#include "grid/sweep.h"
#include "model/phase_part.h"

/* From here on a cell belongs to a crystal: far ahead of where its direction matters. */
#define BEGINS_AT 1e-4
/* Around a seed, in widths. */
#define SEED_REACH 12

/* --- seeds ------------------------------------------------------------------------------------------------ */

static cf_shape shape_of(const cf_crystal *m, const cf_scene_phase_seed *s, double center[3]) {
  const int dim = m->grid->box.dim;
  const double radius = s->given.radius ? s->radius : 2 * m->grid->h;
  double half[3] = {0, 0, 0}, end[3] = {0, 0, 0};
  for (int a = 0; a < dim; ++a) {
    center[a] =
        s->given.center ? s->center.value[a] : m->grid->origin[a] + m->grid->box.n[a] * m->grid->h / 2;
    half[a] = s->given.half ? s->half.value[a] : radius;
    end[a] = s->given.end ? s->end.value[a] : center[a];
  }
  if (s->shape == CF_SCENE_SEED_BOX) return cf_shape_box(dim, center, half);
  if (s->shape == CF_SCENE_SEED_LINE) return cf_shape_capsule(center, end, radius);
  return cf_shape_sphere(center, radius);
}

/* A flat cylinder across z, where a disc has a half_height; otherwise the shape itself. */
static double distance_to(const cf_scene_phase_seed *s, const cf_shape *shape, const double center[3],
                          const double x[3]) {
  if (s->shape != CF_SCENE_SEED_DISC || !s->given.half_height) return cf_shape_distance(shape, NULL, 0, x);
  const double out = hypot(x[0] - center[0], x[1] - center[1]) - shape->radius;
  const double up = fabs(x[2] - center[2]) - s->half_height;
  return fmin(fmax(out, up), 0) + hypot(fmax(out, 0), fmax(up, 0));
}

static void plant(cf_crystal *m, const cf_scene_phase_seed *s, const int number, const cf_cell nearest) {
  const cf_box *box = &m->grid->box;
  const double across = 2 * sqrt(2) * m->params.width;
  double center[3] = {0, 0, 0};
  const cf_shape shape = shape_of(m, s, center);
  if (number == 0)
    for (int a = 0; a < 3; ++a) m->centre[a] = center[a];
  for (int k = 0; k < box->n[2]; ++k)
    for (int j = 0; j < box->n[1]; ++j)
      for (int i = 0; i < box->n[0]; ++i) {
        const ptrdiff_t p = cf_box_at(box, i, j, k);
        const double x[3] = {cf_grid_place(m->grid, 0, i, 0), cf_grid_place(m->grid, 1, j, 0),
                             box->dim == 3 ? cf_grid_place(m->grid, 2, k, 0) : 0};
        const double d = distance_to(s, &shape, center, x), eta = (1 - tanh(d / across)) / 2;
        if (eta >= 1e-16 && eta > (double)m->y.eta.at[p]) m->y.eta.at[p] = (cf_real)eta;
        if (nearest.at == NULL || d >= (double)nearest.at[p]) continue;
        nearest.at[p] = (cf_real)d;
        m->grain.at[p] = (cf_real)(d < SEED_REACH * m->params.width ? number + 1 : 0);
      }
}

double cf_crystal_far_T(const cf_crystal *m) {
  const cf_scene_field *T = &m->scene->fields.item[m->T_field];
  if (!T->given.initial) return -1;
  return cf_fn_at(&T->initial.axis[0].fn, m->grid->origin[0], m->grid->origin[1], m->grid->origin[2], 0);
}

static void fill(const cf_crystal *m, const cf_cell f, const double value) {
  const cf_box *box = &m->grid->box;
  for (ptrdiff_t r = 0; r < cf_box_rows(box); ++r)
    for (int i = 0; i < box->n[0]; ++i) f.at[cf_box_row(box, r) + i] = (cf_real)value;
}

cf_status cf_crystal_seed(cf_crystal *m) {
  static const cf_scene_phase_seed plain = {.shape = CF_SCENE_SEED_BALL};
  const cf_scene *scene = m->scene;
  const cf_scene_field *eta = &scene->fields.item[m->eta_field], *T = &scene->fields.item[m->T_field];
  cf_cell nearest = {NULL};
  if (eta->given.initial)
    CF_TRY(cf_grid_sample(m->grid, &eta->initial.axis[0].fn, CF_CENTRES, 0, m->y.eta.at));
  if (T->given.initial)
    CF_TRY(cf_grid_sample(m->grid, &T->initial.axis[0].fn, CF_CENTRES, 0, m->y.T.at));
  else
    fill(m, m->y.T, -1);
  fill(m, m->arrival, -1);
  for (int a = 0; a < m->grid->box.dim; ++a)
    m->centre[a] = m->grid->origin[a] + m->grid->box.n[a] * m->grid->h / 2;
  if (m->grain.at != NULL) {
    nearest = m->next_grain;
    fill(m, nearest, INFINITY);
  }
  for (int i = 0; i < scene->phase.seeds.count; ++i) plant(m, &scene->phase.seeds.item[i], i, nearest);
  if (scene->phase.seeds.count == 0 && !eta->given.initial) plant(m, &plain, 0, nearest);
  return CF_OK;
}

double cf_crystal_centre(const cf_crystal *m, const int axis) {
  return m->centre[axis] - (axis == m->window_axis ? m->window_cells * m->grid->h : 0);
}

cf_grid cf_crystal_window(const cf_crystal *m) {
  cf_grid at = *m->grid;
  if (m->window_axis >= 0) at.origin[m->window_axis] += m->window_cells * at.h;
  return at;
}

/* --- places ----------------------------------------------------------------------------------------------- */

static void fill_ghosts(const cf_crystal *m, const cf_cell f) {
  cf_halo halo = {0};
  for (int a = 0; a < m->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side)
      halo.rule[a][side] = m->walls.eta.kind[a][side] == CF_WALL_PERIODIC ? CF_HALO_WRAP : CF_HALO_COPY;
  cf_halo_fill(&m->grid->box, &halo, 1, CF_CENTRES, f.at);
}

static int folds_of(const cf_crystal *m) {
  return m->scene->phase.anisotropy.law == CF_SCENE_PHASE_FOLD ? (int)m->scene->phase.anisotropy.folds : 4;
}

/* Degrees in C become cos and sin of n times that in C and S. */
static void turn_cells(const cf_crystal *m) {
  const cf_box *box = &m->grid->box;
  const double per = folds_of(m) * acos(-1) / 180;
  CF_PARALLEL_ROWS (box, m->grid->threads, r)
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(box, r) + i;
      const double angle = per * (double)m->places.C.at[p];
      m->places.C.at[p] = (cf_real)cos(angle);
      m->places.S.at[p] = (cf_real)sin(angle);
    }
}

/* The axes of every grain; where nothing is frozen there are none. */
void cf_crystal_turn(cf_crystal *m) {
  const cf_box *box = &m->grid->box;
  const cf_scene_phase *s = &m->scene->phase;
  const double per = folds_of(m) * acos(-1) / 180, common = cf_fn_at(&s->anisotropy.angle.fn, 0, 0, 0, 0);
  CF_PARALLEL_ROWS (box, m->grid->threads, r)
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(box, r) + i;
      const int grain = (int)m->grain.at[p];
      const cf_scene_phase_seed *seed = grain > 0 ? &s->seeds.item[grain - 1] : NULL;
      const double angle = per * (seed != NULL && seed->given.angle ? seed->angle : common);
      m->places.C.at[p] = (cf_real)(seed != NULL ? cos(angle) : 0);
      m->places.S.at[p] = (cf_real)(seed != NULL ? sin(angle) : 0);
    }
  fill_ghosts(m, m->places.C);
  fill_ghosts(m, m->places.S);
}

static void mask_from_distance(const cf_crystal *m) {
  const cf_box *box = &m->grid->box;
  CF_PARALLEL_ROWS (box, m->grid->threads, r)
    for (int i = 0; i < box->n[0]; ++i) {
      const ptrdiff_t p = cf_box_row(box, r) + i;
      const double inside = 0.5 - (double)m->places.mobility.at[p] / m->grid->h;
      m->places.mobility.at[p] = (cf_real)fmax(0, fmin(1, inside));
    }
}

static cf_status check_between(const cf_crystal *m, const cf_cell f, const char *key) {
  const cf_range range = cf_sweep_range(&m->grid->box, m->grid->threads, f.at, m->rows);
  if (range.min >= 0 && range.max <= 1) return CF_OK;
  return cf_scene_fail_at(m->scene, key, "%s is between %g and %g: must be between 0 and 1", key, range.min,
                          range.max);
}

static cf_status sample(const cf_crystal *m, const cf_grid *at, const int which, const cf_cell f) {
  const cf_fn fn = cf_crystal_map_fn(m, which);
  return cf_grid_sample(at, &fn, CF_CENTRES, 0, f.at);
}

/* Sampled where the window is now. */
cf_status cf_crystal_make_places(cf_crystal *m) {
  const cf_scene_phase *s = &m->scene->phase;
  const cf_grid at = cf_crystal_window(m);
  if (m->places.mobility.at != NULL) {
    const bool mask = s->given.mask || m->map[CF_CRYSTAL_MASK].value != NULL;
    CF_TRY(sample(m, &at, mask ? CF_CRYSTAL_MASK : CF_CRYSTAL_DISTANCE, m->places.mobility));
    if (!mask) mask_from_distance(m);
    CF_TRY(check_between(m, m->places.mobility, mask && !s->given.mask ? "phase.maps.mask" : "phase.mask"));
  }
  if (m->places.strength.at == NULL) return CF_OK;
  CF_TRY(sample(m, &at, CF_CRYSTAL_STRENGTH, m->places.strength));
  if (m->map[CF_CRYSTAL_STRENGTH].value != NULL)
    CF_TRY(check_between(m, m->places.strength, "phase.maps.strength"));
  fill_ghosts(m, m->places.strength);
  if (m->grain.at != NULL) {
    cf_crystal_turn(m);
    return CF_OK;
  }
  CF_TRY(sample(m, &at, CF_CRYSTAL_ANGLE, m->places.C));
  turn_cells(m);
  fill_ghosts(m, m->places.C);
  fill_ghosts(m, m->places.S);
  return CF_OK;
}

/* --- grains ----------------------------------------------------------------------------------------------- */

/* The label of the neighbour with the most solid, of those that have one. */
static cf_real label_for(const cf_crystal *m, const int at[3]) {
  const cf_box *box = &m->grid->box;
  const ptrdiff_t p = cf_box_at(box, at[0], at[1], at[2]);
  cf_real best = 0, most = 0;
  for (int a = 0; a < box->dim; ++a)
    for (int side = -1; side <= 1; side += 2) {
      if (at[a] + side < 0 || at[a] + side >= box->n[a]) continue;
      const ptrdiff_t q = p + side * box->stride[a];
      if (m->grain.at[q] == 0 || m->y.eta.at[q] <= most) continue;
      most = m->y.eta.at[q];
      best = m->grain.at[q];
    }
  return best;
}

void cf_crystal_grow_grains(cf_crystal *m) {
  const cf_box *box = &m->grid->box;
  if (m->grain.at == NULL) return;
  CF_PARALLEL_ROWS (box, m->grid->threads, r) {
    int at[3] = {0, (int)(r % box->n[1]), (int)(r / box->n[1])};
    for (at[0] = 0; at[0] < box->n[0]; ++at[0]) {
      const ptrdiff_t p = cf_box_at(box, at[0], at[1], at[2]);
      const bool begins = m->grain.at[p] == 0 && m->y.eta.at[p] > (cf_real)BEGINS_AT;
      m->next_grain.at[p] = begins ? label_for(m, at) : m->grain.at[p];
    }
  }
  const cf_real *from = m->next_grain.at;
  CF_PARALLEL_ROWS (box, m->grid->threads, r)
    for (int i = 0; i < box->n[0]; ++i) m->grain.at[cf_box_row(box, r) + i] = from[cf_box_row(box, r) + i];
  cf_crystal_turn(m);
}

CF_CLONES static void arrival_row(const int n, const cf_real now, const cf_real *eta, cf_real *arrival) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) arrival[i] = arrival[i] < 0 && eta[i] >= (cf_real)0.5 ? now : arrival[i];
}

void cf_crystal_note_arrival(cf_crystal *m, const double t) {
  const cf_box *box = &m->grid->box;
  CF_PARALLEL_ROWS (box, m->grid->threads, r)
    arrival_row(box->n[0], (cf_real)t, m->y.eta.at + cf_box_row(box, r), m->arrival.at + cf_box_row(box, r));
}
