/* SPDX-License-Identifier: MIT */
#include "render/turn.h"

#include <string.h>

void cf_turn_vector(const int up, double v[3]) {
  double out[3];
  for (int a = 0; a < 3; ++a) out[a] = v[cf_turn_axis(up, a)];
  memcpy(v, out, sizeof out);
}

void cf_turn_vectors(const int up, const int64_t count, float (*v)[3]) {
  for (int64_t i = 0; i < count; ++i) {
    float out[3];
    for (int a = 0; a < 3; ++a) out[a] = v[i][cf_turn_axis(up, a)];
    memcpy(v[i], out, sizeof out);
  }
}

static void turn_reals(const int up, const int64_t count, cf_real (*v)[3]) {
  for (int64_t i = 0; i < count; ++i) {
    cf_real out[3];
    for (int a = 0; a < 3; ++a) out[a] = v[i][cf_turn_axis(up, a)];
    memcpy(v[i], out, sizeof out);
  }
}

void cf_turn_mesh(const int up, cf_mesh *mesh) {
  turn_reals(up, mesh->vertices, mesh->place);
  if (mesh->normal != NULL) turn_reals(up, mesh->vertices, mesh->normal);
}

cf_status cf_turn_grid(const int up, const cf_grid *g, cf_grid *turned) {
  int n[3];
  double origin[3];
  for (int a = 0; a < 3; ++a)
    n[a] = g->box.n[cf_turn_axis(up, a)], origin[a] = g->origin[cf_turn_axis(up, a)];
  CF_TRY(cf_grid_init(turned, 3, n, g->h, origin));
  return cf_box_init(&turned->box, 3, n, 0);
}

void cf_turn_field(const int up, const cf_grid *g, const cf_real *f, const cf_grid *turned, cf_real *out) {
  const cf_box *b = &turned->box;
  ptrdiff_t stride[3];
  for (int a = 0; a < 3; ++a) stride[a] = g->box.stride[cf_turn_axis(up, a)];
  for (int k = 0; k < b->n[2]; ++k)
    for (int j = 0; j < b->n[1]; ++j)
      for (int i = 0; i < b->n[0]; ++i)
        out[cf_box_at(b, i, j, k)] = f[i * stride[0] + j * stride[1] + k * stride[2]];
}
