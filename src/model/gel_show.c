/* SPDX-License-Identifier: MIT
 *
 * What a gel shows: saturation and fill on cells, saturation, volume and stress of particles, its surface, its numbers.
 * Nodes are scratch, so they are made afresh from the particles; that sorts them as the next step would.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "grid/isosurface.h"
#include "model/gel_part.h"

static const struct { const char *name, *unit; } shown[] = {{"saturation", ""}, {"fill", ""}};

bool cf_gel_shows(const cf_scene *scene, const char *name) {
  (void)scene;
  return strcmp(name, "saturation") == 0 || strcmp(name, "fill") == 0 || strcmp(name, "gel") == 0 ||
         strncmp(name, "gel.", 4) == 0;
}

bool cf_gel_derived(const void *model, const int i, cf_derived *field) {
  (void)model;
  if (i < 0 || i >= (int)(sizeof shown / sizeof *shown)) return false;
  *field = (cf_derived){0};
  snprintf(field->name, sizeof field->name, "%s", shown[i].name);
  snprintf(field->unit, sizeof field->unit, "%s", shown[i].unit);
  return true;
}

/* Nodes with less of a body than this show nothing. */
#define LEAST_SHOWN 0.02

/* Calls `body` with the lattice cell and the node of every node that has a share of a body. */
#define FOR_FILLED(g, cell, node, ...)                                           \
  do {                                                                           \
    const cf_nodes *nodes_ = (g)->mpm->nodes;                                    \
    for (int32_t b_ = 0; b_ < nodes_->count; ++b_)                               \
      for (int n_ = 0; n_ < CF_BLOCK_NODES; ++n_) {                              \
        int cell[3];                                                             \
        const cf_lanes *node = &nodes_->at[(ptrdiff_t)b_ * CF_BLOCK_NODES + n_]; \
        if (!((double)(*node)[CF_NODE_FILL] > 0)) continue;                      \
        cf_nodes_cell(nodes_, &nodes_->block[b_], n_, cell);                     \
        __VA_ARGS__                                                              \
      }                                                                          \
  } while (0)

cf_status cf_gel_derive(void *model, const int i, const cf_cell out) {
  cf_gel *g = model;
  const cf_box *box = &g->grid->box;
  for (ptrdiff_t r = 0; r < cf_box_rows(box); ++r)
    memset(out.at + cf_box_row(box, r), 0, sizeof *out.at * (size_t)box->n[0]);
  cf_mpm_scatter(g->mpm, 0);
  FOR_FILLED(g, cell, node, {
    bool inside = true;
    for (int a = 0; a < box->dim; ++a) {
      cell[a] -= g->offset[a];
      inside = inside && cell[a] >= 0 && cell[a] < box->n[a];
    }
    if (!inside || !((double)(*node)[CF_NODE_FILL] > LEAST_SHOWN)) continue;
    out.at[cf_box_at(box, cell[0], cell[1], cell[2])] =
        i == 1                          ? (*node)[CF_NODE_FILL]
        : (*node)[CF_NODE_CAPACITY] > 0 ? (*node)[CF_NODE_WATER] / (*node)[CF_NODE_CAPACITY]
                                        : 0;
  });
  return CF_OK;
}

cf_status cf_gel_show(void *model) {
  cf_gel *g = model;
  cf_mpm_derive(g->mpm, g->set->attribute[g->saturation].at[0], g->set->attribute[g->jacobian].at[0],
                g->set->attribute[g->stress].at);
  return CF_OK;
}

/* Fill, saturation and J on the lattice where the bodies are; low and high enclose them. */
static void lay_out(cf_gel *g, cf_isosurface *rule) {
  const cf_box *box = &g->lattice.box;
  for (int a = 0; a < 3; ++a) rule->low[a] = box->n[a], rule->high[a] = 0;
  FOR_FILLED(g, cell, node, {
    const ptrdiff_t p = cf_box_at(box, cell[0], cell[1], cell[2]);
    const cf_real fill = (*node)[CF_NODE_FILL], C = (*node)[CF_NODE_CAPACITY];
    g->on_lattice[0].at[p] = fill;
    g->on_lattice[1].at[p] = C > 0 ? (*node)[CF_NODE_WATER] / C : 0;
    for (int a = 0; a < 3; ++a) {
      rule->low[a] = CF_MIN(rule->low[a], cell[a] - 1);
      rule->high[a] = CF_MAX(rule->high[a], cell[a] + 2);
    }
  });
}

static void take_up(cf_gel *g) {
  const cf_box *box = &g->lattice.box;
  FOR_FILLED(g, cell, node, {
    const ptrdiff_t p = cf_box_at(box, cell[0], cell[1], cell[2]);
    for (int f = 0; f < 2; ++f) g->on_lattice[f].at[p] = 0;
  });
}

cf_status cf_gel_mesh(void *model, struct cf_mesh *mesh) {
  cf_gel *g = model;
  cf_isosurface rule = {.level = g->keys->surface};
  if (g->grid->box.dim == 2) return cf_mesh_resize(mesh, 0, 0, false);
  cf_mpm_scatter(g->mpm, 0);
  lay_out(g, &rule);
  cf_status s = cf_isosurface_make(mesh, &g->lattice, g->on_lattice[0], &rule);
  if (s == CF_OK) s = cf_mesh_sample(mesh, &g->lattice, g->on_lattice[1], "saturation", "");
  take_up(g);
  return s;
}

bool cf_gel_describe(const void *model, const int line, char *text, const size_t size) {
  const cf_gel *g = model;
  if (line > 0) return false;
  snprintf(text, size, "gel: %lld particles, %s, %s velocities", (long long)g->set->count,
           g->keys->transfer == CF_GEL_TRANSFER_FLIP ? "FLIP" : "APIC",
           g->keys->implicitness > 0 ? "semi-implicit" : "explicit");
  return true;
}

/* --- metrics ----------------------------------------------------------------------------------------------- */

static const char *const metric[] = {"water",          "error_water", "mean_saturation", "min_saturation",
                                     "max_saturation", "volume",      "min_J",           "max_J",
                                     "kinetic",        "momentum_x",  "momentum_y",      "momentum_z",
                                     "angular_x",      "angular_y",   "angular_z",       "center_x",
                                     "center_y",       "center_z",    "uptake",          "curvature"};

int cf_gel_metric_names(const void *model, cf_metric *names) {
  (void)model;
  const int n = (int)(sizeof metric / sizeof *metric);
  for (int i = 0; i < n; ++i) snprintf(names[i].name, CF_NAME_MAX, "%s", metric[i]);
  return n;
}

void cf_gel_metrics(const void *model, double *values) {
  const cf_gel *g = model;
  const cf_mpm_sums s = cf_mpm_sums_of(g->mpm);
  const double all[] = {s.water,
                        cf_ledger_error(&g->water, s.water),
                        s.capacity > 0 ? s.water / s.capacity : 0,
                        s.saturation_min,
                        s.saturation_max,
                        s.volume,
                        s.jacobian_min,
                        s.jacobian_max,
                        s.kinetic,
                        s.momentum[0],
                        s.momentum[1],
                        s.momentum[2],
                        s.angular[0],
                        s.angular[1],
                        s.angular[2],
                        s.center[0],
                        s.center[1],
                        s.center[2],
                        g->water.entered - g->water.left,
                        cf_gel_curvature(g)};
  memcpy(values, all, sizeof all);
}
