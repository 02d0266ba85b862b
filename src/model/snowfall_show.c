/* SPDX-License-Identifier: MIT
 *
 * What a snowfall has to show that is no state: the snow in the air as a density, the top of the layer as a surface,
 * and the numbers of metrics.csv.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "grid/mesh.h"
#include "model/snowfall_part.h"

/* --- what is shown ---------------------------------------------------------------------------------------- */

bool cf_snowfall_derived(const void *model, const int i, cf_derived *field) {
  (void)model;
  if (i > 0) return false;
  *field = (cf_derived){"snow", "kg/m^3"};
  return true;
}

/* Mass of the flakes in the air, a cell. */
cf_status cf_snowfall_derive(void *model, const int which, const cf_cell out) {
  const cf_snowfall *s = model;
  const cf_box *b = &s->grid->box;
  const cf_particles *f = s->flakes;
  const double volume = s->grid->h * s->grid->h * s->grid->h;
  (void)which;
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)
    memset(out.at + cf_box_row(b, r), 0, (size_t)b->n[0] * sizeof *out.at);
  for (int64_t i = 0; i < f->count; ++i) {
    ptrdiff_t p = 0;
    for (int a = 0; a < 3; ++a) {
      const double at = ((double)f->attribute[CF_PARTICLE_POSITION].at[a][i] - s->low[a]) / s->grid->h;
      p += b->stride[a] * (ptrdiff_t)fmin(fmax(floor(at), 0), b->n[a] - 1);
    }
    const cf_atlas_flake *a = &s->atlas->flakes.item[(int)f->attribute[CF_FLAKE_KIND].at[0][i]];
    out.at[p] +=
        (cf_real)(a->mass * pow((double)f->attribute[CF_FLAKE_RADIUS].at[0][i] / a->radius, 3) / volume);
  }
  return CF_OK;
}

/* A vertex on every column's top, two triangles between four of them; open at the sides, where the box goes on. */
cf_status cf_snowfall_mesh(void *model, cf_mesh *mesh) {
  const cf_snowfall *s = model;
  const int n = s->pack.n[0], m = s->pack.n[1];
  cf_real *depth;
  CF_TRY(cf_mesh_resize(mesh, (int64_t)n * m, 2 * (int64_t)(n - 1) * (m - 1), true));
  CF_TRY(cf_mesh_attribute_add(mesh, "depth", "m", &depth));
  for (int64_t c = 0; c < mesh->vertices; ++c) {
    for (int a = 0; a < 3; ++a) mesh->place[c][a] = s->ground->attribute[CF_PARTICLE_POSITION].at[a][c];
    depth[c] = s->pack.depth[c];
  }
  int32_t(*corner)[3] = mesh->corner;
  for (int j = 0; j + 1 < m; ++j)
    for (int i = 0; i + 1 < n; ++i, corner += 2) {
      const int32_t c = (int32_t)(i + j * n);
      corner[0][0] = c, corner[0][1] = c + 1, corner[0][2] = c + 1 + n;
      corner[1][0] = c, corner[1][1] = c + 1 + n, corner[1][2] = c + n;
    }
  return cf_mesh_make_normals(mesh);
}

static const char *const metric[] = {"in_air",     "landed",    "mean_speed", "max_speed",
                                     "mean_depth", "max_depth", "error_snow"};
enum { METRICS = sizeof metric / sizeof *metric };

int cf_snowfall_metric_names(const void *model, cf_metric *names) {
  (void)model;
  for (int i = 0; i < METRICS; ++i) snprintf(names[i].name, CF_NAME_MAX, "%s", metric[i]);
  return METRICS;
}

void cf_snowfall_metrics(const void *model, double *values) {
  const cf_snowfall *s = model;
  double sum = 0, fastest = 0, deepest = 0;
  for (int64_t i = 0; i < s->flakes->count; ++i) {
    double square = 0;
    for (int a = 0; a < 3; ++a) {
      const double v = (double)s->flakes->attribute[CF_FLAKE_VELOCITY].at[a][i];
      square += v * v;
    }
    sum += sqrt(square);
    fastest = fmax(fastest, sqrt(square));
  }
  for (int64_t c = 0; c < s->ground->count; ++c) deepest = fmax(deepest, (double)s->pack.depth[c]);
  const double volume = cf_snowpack_volume(&s->pack), area = s->pack.h * s->pack.h * (double)s->ground->count;
  const double lying = volume * s->keys->snow_density / s->keys->stands_for;
  values[0] = (double)s->flakes->count;
  values[1] = s->landed;
  values[2] = sum / fmax((double)s->flakes->count, 1);
  values[3] = fastest;
  values[4] = volume / area;
  values[5] = deepest;
  values[6] = (cf_snowfall_mass_in_air(s) + lying + s->ledger.left - s->ledger.entered) / s->ledger.entered;
}

bool cf_snowfall_describe(const void *model, const int line, char *text, const size_t size) {
  const cf_snowfall *s = model;
  cf_flake small, large;
  if (line > 0) return false;
  cf_snowfall_flake(s, 0, 0, s->keys->radius.value[0], &small);
  cf_snowfall_flake(s, 0, 0, s->keys->radius.value[1], &large);
  snprintf(text, size,
           "snowfall: %ld flakes of %d kinds, %.3g to %.3g mm across, falling at %.2g to %.2g m/s (Re %.0f "
           "to %.0f)",
           s->keys->flakes, s->atlas->flakes.count, 2e3 * s->keys->radius.value[0],
           2e3 * s->keys->radius.value[1], small.terminal_speed, large.terminal_speed, small.reynolds,
           large.reynolds);
  return true;
}

bool cf_snowfall_shows(const cf_scene *scene, const char *name) {
  static const char *const sets[] = {"flakes", "settled", "ground"};
  (void)scene;
  if (strcmp(name, "snow") == 0) return true;
  for (int i = 0; i < 3; ++i) {
    const size_t length = strlen(sets[i]);
    if (strncmp(name, sets[i], length) == 0 && (name[length] == '\0' || name[length] == '.')) return true;
  }
  return false;
}
