/* SPDX-License-Identifier: MIT
 *
 * Fields and particles by name: what the registry knows of them, as views for whoever uses the library.
 */
#include <stdio.h>
#include <string.h>

#include "model/sim.h"

static bool is_field(const cf_entry *e) { return e->kind == CF_KIND_CELL || e->kind == CF_KIND_FACE; }

const char *cf_sim_field_name(const cf_sim *sim, const int i) {
  int fields = 0;
  for (int e = 0; e < sim->registry.count; ++e)
    if (is_field(&sim->registry.entry[e]) && fields++ == i) return sim->registry.entry[e].name;
  return NULL;
}

/* "phi, q, velocity": what could have been meant. */
static void list_names(const cf_sim *sim, char *text, const size_t size) {
  size_t used = 0;
  const char *name;
  text[0] = '\0';
  for (int i = 0; (name = cf_sim_field_name(sim, i)) != NULL && used < size; ++i)
    used += (size_t)snprintf(text + used, size - used, "%s%s", i > 0 ? ", " : "", name);
}

static void fill(const cf_sim *sim, const cf_entry *e, const int staggered, cf_view *view) {
  const cf_grid *g = &sim->grid;
  *view = (cf_view){.at = staggered < 0 ? e->cell.at : e->face.at[staggered],
                    .staggered = staggered,
                    .h = g->h,
                    .unit = e->unit};
  for (int a = 0; a < 3; ++a) {
    view->shape[a] = cf_box_extent(&g->box, a, staggered);
    view->stride[a] = g->box.stride[a];
    view->place[a] = a < g->box.dim ? cf_grid_place(g, a, 0, a == staggered) : 0;
  }
}

cf_status cf_sim_field(cf_sim *sim, const char *name, const int component, cf_view *view) {
  const cf_entry *e = cf_registry_find(&sim->registry, name);
  if (e == NULL || !is_field(e)) {
    char known[512];
    list_names(sim, known, sizeof known);
    return cf_fail(CF_BAD_ARGUMENT, "there is no field \"%.64s\"; there are %s", name, known);
  }
  const int components = e->kind == CF_KIND_FACE ? sim->grid.box.dim : 1;
  if (component < 0 || component >= components)
    return cf_fail(CF_BAD_ARGUMENT, "component %d of %s: it has %d, counted from 0", component, name,
                   components);
  fill(sim, e, e->kind == CF_KIND_FACE ? component : CF_CENTRES, view);
  return CF_OK;
}

/* --- particles -------------------------------------------------------------------------------------------- */

const char *cf_sim_particles_name(const cf_sim *sim, const int i) {
  int sets = 0;
  for (int e = 0; e < sim->registry.count; ++e)
    if (sim->registry.entry[e].kind == CF_KIND_PARTICLES && sets++ == i) return sim->registry.entry[e].name;
  return NULL;
}

static const cf_particles *find_set(const cf_sim *sim, const char *name) {
  const cf_entry *e = cf_registry_find(&sim->registry, name);
  return e != NULL && e->kind == CF_KIND_PARTICLES ? e->particles : NULL;
}

const char *cf_sim_particles_attribute(const cf_sim *sim, const char *set, const int i) {
  const cf_particles *s = find_set(sim, set);
  return s != NULL && i >= 0 && i < s->attributes ? s->attribute[i].name : NULL;
}

/* "position, S, F" of a set, or the sets where that is NULL. */
static void list_particles(const cf_sim *sim, const char *set, char *text, const size_t size) {
  size_t used = 0;
  snprintf(text, size, "none");
  for (int i = 0; used < size; ++i) {
    const char *name = set == NULL ? cf_sim_particles_name(sim, i) : cf_sim_particles_attribute(sim, set, i);
    if (name == NULL) return;
    used += (size_t)snprintf(text + used, size - used, "%s%s", i > 0 ? ", " : "", name);
  }
}

cf_status cf_sim_particles(cf_sim *sim, const char *set, const char *attribute, cf_particle_view *view) {
  const cf_particles *s = find_set(sim, set);
  const int number = s != NULL ? cf_particles_find(s, attribute) : -1;
  char known[512];
  if (number < 0) {
    list_particles(sim, s != NULL ? set : NULL, known, sizeof known);
    if (s == NULL)
      return cf_fail(CF_BAD_ARGUMENT, "there are no particles \"%.64s\"; there are %s", set, known);
    return cf_fail(CF_BAD_ARGUMENT, "the particles %s have no \"%.64s\"; they have %s", set, attribute,
                   known);
  }
  const cf_attribute *a = &s->attribute[number];
  *view = (cf_particle_view){.count = s->count, .id = s->id, .components = a->components, .unit = a->unit};
  for (int c = 0; c < a->components; ++c) view->at[c] = a->at[c];
  return CF_OK;
}
