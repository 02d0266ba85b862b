/* SPDX-License-Identifier: MIT
 *
 * Filling bodies with particles: a regular grid of places as many a cell as the scene asks for, in the body's own frame,
 * and of those the ones inside. A box's places divide its sides evenly, so that none is missing and the volume is that
 * of the box; elsewhere a particle has the volume of its place.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/rng.h"
#include "io/image.h"
#include "model/gel_part.h"
#include "model/surface.h"

typedef struct body {
  const cf_scene_gel_body *keys;
  int dim, n[3]; /* places */
  double low[3], step[3], center[3], turn[3][3];
  uint8_t *rgb; /* of an image */
  int width, height;
  cf_samples samples; /* of a mesh */
  cf_shape shape;
} body;

static void body_clear(body *b) {
  cf_free(b->rgb);
  cf_samples_destroy(&b->samples);
}

static cf_status fail_at(const cf_gel *g, const int i, const char *key) {
  char path[128], sentence[CF_SENTENCE_MAX];
  snprintf(path, sizeof path, "gel.bodies.%d.%s", i, key);
  snprintf(sentence, sizeof sentence, "%s", cf_status_sentence());
  return cf_scene_fail_at(g->scene, path, "%s: %s", path, sentence);
}

/* Half sides of the box that encloses a body in its own frame; a mesh says itself. */
static cf_status find_bounds(const cf_gel *g, body *b, double half[3]) {
  const cf_scene_gel_body *k = b->keys;
  for (int a = 0; a < b->dim; ++a) {
    b->center[a] = a < k->center.count ? k->center.value[a] : 0;
    half[a] = k->shape == CF_GEL_BODY_BALL ? k->radius
              : a < k->half.count          ? k->half.value[a]
                                           : k->thickness / 2;
  }
  if (k->shape == CF_GEL_BODY_IMAGE) {
    return cf_image_read(k->file, &b->width, &b->height, &b->rgb);
  }
  if (k->shape != CF_GEL_BODY_MESH) return CF_OK;
  double low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
  CF_TRY(cf_surface_read(k->file, &(cf_surface_place){&k->center, &k->half}, g->grid->h / 2, 2, &b->samples,
                         low, high));
  b->shape = cf_shape_sampled(&b->samples);
  for (int a = 0; a < 3; ++a) b->center[a] = (low[a] + high[a]) / 2, half[a] = (high[a] - low[a]) / 2;
  return CF_OK;
}

/* Rodrigues' formula. */
static void set_turn(body *b) {
  const double *axis = b->keys->axis.value, angle = b->keys->turn * acos(-1) / 180;
  const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  const double u[3] = {length > 0 ? axis[0] / length : 0, length > 0 ? axis[1] / length : 0,
                       length > 0 ? axis[2] / length : 1};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int k = 3 - i - j, cyclic = (i + 1) % 3 == j;
      b->turn[i][j] = (i == j ? cos(angle) : 0) + (1 - cos(angle)) * u[i] * u[j];
      if (i != j) b->turn[i][j] += (cyclic ? -1 : 1) * sin(angle) * u[k];
    }
}

static cf_status body_init(const cf_gel *g, const int i, body *b) {
  double half[3] = {0, 0, 0};
  *b = (body){.keys = &g->keys->bodies.item[i], .dim = g->grid->box.dim, .n = {1, 1, 1}};
  if (find_bounds(g, b, half) != CF_OK) return fail_at(g, i, "file");
  set_turn(b);
  for (int a = 0; a < b->dim; ++a) {
    b->n[a] = (int)CF_MAX(1, lround(2 * half[a] / g->grid->h * (double)g->keys->particles));
    b->step[a] = 2 * half[a] / b->n[a];
    b->low[a] = b->center[a] - half[a];
  }
  return CF_OK;
}

/* Whether a place, in the body's frame, is inside it. */
static bool is_inside(const body *b, const double place[3]) {
  if (b->keys->shape == CF_GEL_BODY_BALL) {
    double r2 = 0;
    for (int a = 0; a < b->dim; ++a) r2 += (place[a] - b->center[a]) * (place[a] - b->center[a]);
    return r2 < b->keys->radius * b->keys->radius;
  }
  if (b->keys->shape == CF_GEL_BODY_MESH) return cf_shape_distance(&b->shape, NULL, 0, place) < 0;
  if (b->keys->shape != CF_GEL_BODY_IMAGE) return true;
  const double across = (place[0] - b->low[0]) / (b->n[0] * b->step[0]);
  const double up = (place[1] - b->low[1]) / (b->n[1] * b->step[1]);
  const int i = CF_MIN((int)(across * b->width), b->width - 1);
  const int j = CF_MIN((int)((1 - up) * b->height), b->height - 1);
  const uint8_t *pixel = b->rgb + 3 * ((ptrdiff_t)j * b->width + i);
  return 2 * pixel[0] + 5 * pixel[1] + pixel[2] < 8 * 128;
}

static void out_of_frame(const body *b, const double place[3], double x[3]) {
  for (int a = 0; a < 3; ++a) {
    x[a] = b->center[a];
    for (int c = 0; c < 3; ++c) x[a] += b->turn[a][c] * (place[c] - b->center[c]);
  }
}

static void make_particle(cf_gel *g, const body *b, const int number, const int64_t p, const double x[3]) {
  const cf_scene_gel_body *k = b->keys;
  const double *axis = k->axis.value,
               length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  double volume = 1;
  for (int a = 0; a < b->dim; ++a) {
    const int c = (a + 1) % 3, d = (a + 2) % 3;
    const double w = length > 0 ? k->spin / length : 0;
    const double turning = w * (axis[c] * (x[d] - b->center[d]) - axis[d] * (x[c] - b->center[c]));
    volume *= b->step[a];
    g->set->attribute[g->at.position].at[a][p] = (cf_real)x[a];
    g->set->attribute[g->at.side].at[a][p] = (cf_real)b->step[a];
    g->set->attribute[g->at.velocity].at[a][p] =
        (cf_real)((a < k->velocity.count ? k->velocity.value[a] : 0) + turning);
    g->set->attribute[g->at.deformation].at[a * b->dim + a][p] = 1;
    for (int e = 0; e < b->dim && length > 0; ++e) /* the gradient of that velocity */
      if (e != a)
        g->set->attribute[g->at.affine].at[a * b->dim + e][p] =
            (cf_real)((e == d ? 1 : -1) * k->spin / length * axis[e == d ? c : d]);
  }
  const double S = cf_fn_at(&k->saturation.fn, x[0], x[1], x[2], 0);
  g->set->attribute[g->at.volume].at[0][p] = (cf_real)volume;
  g->set->attribute[g->at.plastic].at[0][p] = 1;
  g->set->attribute[g->at.material].at[0][p] = (cf_real)number;
  g->set->attribute[g->at.water].at[0][p] = (cf_real)(S * g->material[number].water * volume);
}

/* Whether a particle at x can be stepped: inside the domain, or within the lattice if there are no walls. */
static bool is_in_domain(const cf_gel *g, const double x[3]) {
  const bool walls = g->keys->walls != CF_GEL_WALL_NONE;
  for (int a = 0; a < g->grid->box.dim; ++a) {
    const cf_grid *where = walls ? g->grid : &g->lattice;
    const double edge = walls ? 0 : 4 * where->h;
    if (!(x[a] >= where->origin[a] + edge && x[a] <= where->origin[a] + where->box.n[a] * where->h - edge))
      return false;
  }
  return true;
}

static double jitter_of(const cf_gel *g, const int a, const int64_t id) {
  if (g->keys->jitter == 0) return 0;
  return g->keys->jitter * (cf_random((uint64_t)g->keys->seed, 1, (uint64_t)a, (uint64_t)id) - 0.5);
}

static cf_status fill_body(cf_gel *g, const int number, const body *b) {
  int64_t made = 0;
  for (int k = 0; k < b->n[2]; ++k)
    for (int j = 0; j < b->n[1]; ++j)
      for (int i = 0; i < b->n[0]; ++i) {
        const int at[3] = {i, j, k};
        double place[3] = {0, 0, 0}, x[3];
        for (int a = 0; a < b->dim; ++a)
          place[a] = b->low[a] + (at[a] + 0.5 + jitter_of(g, a, g->set->next_id)) * b->step[a];
        if (!is_inside(b, place)) continue;
        out_of_frame(b, place, x);
        if (!is_in_domain(g, x))
          return cf_scene_fail_at(g->scene, "gel.bodies",
                                  "gel.bodies.%d reaches out of the domain, to (%g, %g, %g)", number, x[0],
                                  x[1], x[2]);
        int64_t p;
        if (g->set->count == g->set->room)
          CF_TRY(cf_particles_reserve(g->set, g->set->room + g->set->room / 2));
        CF_TRY(cf_particles_append(g->set, 1, &p));
        make_particle(g, b, number, p, x);
        ++made;
      }
  if (made > 0) return CF_OK;
  return cf_scene_fail_at(g->scene, "gel.bodies",
                          "gel.bodies.%d has no particles: it is empty, or thinner than their spacing",
                          number);
}

cf_status cf_gel_fill(cf_gel *g) {
  for (int i = 0; i < g->keys->bodies.count; ++i) {
    body b;
    cf_status s = body_init(g, i, &b);
    if (s == CF_OK) s = fill_body(g, i, &b);
    body_clear(&b);
    CF_TRY(s);
  }
  return CF_OK;
}

double cf_gel_count(const cf_scene *scene) {
  double all = 0;
  for (int i = 0; i < scene->gel.bodies.count; ++i) {
    const cf_scene_gel_body *k = &scene->gel.bodies.item[i];
    double one = 1;
    for (int a = 0; a < scene->dim; ++a) {
      const double half = k->shape == CF_GEL_BODY_BALL ? k->radius
                          : a < k->half.count          ? k->half.value[a]
                          : k->given.thickness         ? k->thickness / 2
                                                       : scene->domain.size.value[a] / 4;
      one *= CF_MAX(1, 2 * half / scene->spacing * (double)scene->gel.particles);
    }
    all += one;
  }
  return all;
}
