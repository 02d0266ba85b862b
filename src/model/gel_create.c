/* SPDX-License-Identifier: MIT
 *
 * Making a gel: lattice, materials, obstacles and water from their keys, then particles, then what steps them.
 */
#include <math.h>

#include "base/mem.h"
#include "model/gel_part.h"

/* --- obstacles --------------------------------------------------------------------------------------------- */

/* A direction with dim entries; left out: along the last axis. */
static void direction(const cf_param_numbers *given, const int dim, double n[3]) {
  for (int a = 0; a < 3; ++a) n[a] = a < given->count ? given->value[a] : given->count == 0 && a == dim - 1;
}

static void middle_of(const cf_param_numbers *given, double x[3]) {
  for (int a = 0; a < 3; ++a) x[a] = a < given->count ? given->value[a] : 0;
}

/* The walls of the domain: half spaces outside it. */
static void make_walls(cf_gel *g) {
  if (g->keys->walls == CF_GEL_WALL_NONE) return;
  for (int a = 0; a < g->grid->box.dim; ++a)
    for (int side = 0; side < 2; ++side) {
      double at[3] = {0, 0, 0}, inwards[3] = {0, 0, 0};
      at[a] = g->grid->origin[a] + (side == 0 ? 0 : g->grid->box.n[a] * g->grid->h);
      inwards[a] = side == 0 ? 1 : -1;
      g->shape[g->obstacles] = cf_shape_plane(at, inwards);
      g->obstacle[g->obstacles] =
          (cf_mpm_obstacle){.shape = &g->shape[g->obstacles], .contact = (cf_mpm_contact)g->keys->walls};
      ++g->obstacles;
    }
}

static void make_obstacles(cf_gel *g) {
  for (int i = 0; i < g->solids.count; ++i) {
    const cf_obstacle *o = &g->solids.item[i];
    g->obstacle[g->obstacles++] = (cf_mpm_obstacle){.shape = &o->shape,
                                                    .motion = o->posed ? &o->motion : NULL,
                                                    .contact = (cf_mpm_contact)o->keys->contact,
                                                    .friction = o->keys->friction};
  }
}

/* --- water ------------------------------------------------------------------------------------------------- */

static void make_water(cf_gel *g, const int i) {
  const cf_scene_gel_water *k = &g->keys->water.item[i];
  const int dim = g->grid->box.dim;
  double at[3], n[3], half[3];
  middle_of(&k->center, at);
  direction(&k->normal, dim, n);
  for (int a = 0; a < 3; ++a) half[a] = a < k->half.count ? k->half.value[a] : (double)INFINITY;
  if (k->shape == CF_GEL_PLACE_BOX) g->place[i] = cf_shape_box(dim, at, half);
  if (k->shape == CF_GEL_PLACE_BALL) g->place[i] = cf_shape_sphere(at, k->radius);
  if (k->shape == CF_GEL_PLACE_PLANE) g->place[i] = cf_shape_plane(at, n);
  g->dry[i] = cf_shape_complement(&g->place[i]);
  g->source[i] = (cf_poro_source){
      .kind = (cf_poro_kind)k->kind,
      .shape = k->shape == CF_GEL_PLACE_EVERYWHERE ? NULL
               : k->outside                        ? &g->dry[i]
                                                   : &g->place[i],
      .value = k->value.fn,
      .from = k->from,
      .to = k->given.to ? k->to : (double)INFINITY,
      .amount = k->given.amount ? k->amount : (double)INFINITY,
      .given = &g->given[i],
  };
}

/* --- the object -------------------------------------------------------------------------------------------- */

static cf_status make_tables(cf_gel *g) {
  const int walls = 2 * g->grid->box.dim, most = walls + g->scene->obstacles.count,
            sources = CF_MAX(1, g->keys->water.count);
  CF_TRY(CF_NEW(&g->material, g->keys->bodies.count));
  CF_TRY(CF_NEW(&g->filter_due, g->keys->bodies.count));
  CF_TRY(CF_NEW(&g->eta, g->keys->bodies.count));
  CF_TRY(CF_NEW(&g->obstacle, most));
  CF_TRY(CF_NEW(&g->shape, walls));
  CF_TRY(CF_NEW(&g->source, sources));
  CF_TRY(CF_NEW(&g->place, sources));
  CF_TRY(CF_NEW(&g->dry, sources));
  CF_TRY(CF_NEW(&g->given, sources));
  for (int i = 0; i < g->keys->bodies.count; ++i) g->material[i] = cf_gel_material(g->scene, i);
  make_walls(g);
  CF_TRY(cf_obstacles_create(&g->solids, g->scene, g->grid));
  make_obstacles(g);
  g->sources = g->keys->water.count;
  for (int i = 0; i < g->sources; ++i) make_water(g, i);
  return CF_OK;
}

static cf_status make_particles(cf_gel *g) {
  const int dim = g->grid->box.dim;
  const char *cube = "";
  CF_TRY(cf_particles_create(&g->set, "gel", dim, (int64_t)cf_gel_room(g->scene)));
  CF_TRY(cf_mpm_attributes_add(g->set, &g->at));
  CF_TRY(cf_particles_attribute(g->set, "saturation", cube, 1, CF_DERIVED, &g->saturation));
  CF_TRY(cf_particles_attribute(g->set, "J", cube, 1, CF_DERIVED, &g->jacobian));
  CF_TRY(cf_particles_attribute(g->set, "stress", "Pa", dim * dim, CF_DERIVED, &g->stress));
  return cf_gel_fill(g);
}

/* Whether bodies differ in k or F_T; *most: the largest k. */
static bool is_mixture(const cf_gel *g, double *most) {
  bool mixed = false;
  *most = 0;
  for (int i = 0; i < g->keys->bodies.count; ++i) {
    mixed = mixed || g->material[i].k != g->material[0].k || g->material[i].f_t != g->material[0].f_t;
    *most = CF_MAX(*most, g->material[i].k);
  }
  return mixed;
}

static cf_status make_solvers(cf_gel *g) {
  double most;
  cf_mpm_params p = {.materials = g->keys->bodies.count,
                     .material = g->material,
                     .obstacles = g->obstacles,
                     .obstacle = g->obstacle,
                     .flip = g->keys->transfer == CF_GEL_TRANSFER_FLIP ? g->keys->flip : -1,
                     .implicitness = g->keys->implicitness,
                     .damping = g->keys->damping,
                     .mixture = is_mixture(g, &most),
                     .solver = {g->scene->solver.tolerance, (int)g->scene->solver.max_iterations}};
  for (int a = 0; a < g->keys->gravity.count; ++a) p.gravity[a] = g->keys->gravity.value[a];
  CF_TRY(cf_mpm_create(&g->mpm, &g->lattice, g->set, &g->at, &p));
  for (int i = 0; i < 3; ++i) CF_TRY(cf_cell_create(&g->on_lattice[i], &g->lattice.box));
  const cf_scene_diffusion *d = &g->scene->diffusion;
  if (!(most > 0) && g->sources == 0) return CF_OK;
  const cf_poro_params w = {.k = g->material[0].k,
                            .tau = d->tau,
                            .f_t = g->material[0].f_t,
                            .mixture = g->mpm->mixture,
                            .two_stages = d->scheme != CF_SCENE_SCHEME_PAPER,
                            .solver = p.solver,
                            .sources = g->sources,
                            .source = g->source};
  return cf_poro_create(&g->poro, &g->lattice, &w);
}

static cf_status add_state(cf_gel *g, cf_registry *r) {
  CF_TRY(cf_registry_add_particles(r, g->set));
  CF_TRY(cf_registry_add_numbers(r, "water_ledger", "kg", &g->water.first, 3));
  if (g->sources > 0) CF_TRY(cf_registry_add_numbers(r, "water_given", "kg", g->given, g->sources));
  return cf_registry_add_numbers(r, "filter_due", "", g->filter_due, g->keys->bodies.count);
}

static cf_status make(cf_gel *g, cf_registry *r) {
  CF_TRY(make_tables(g));
  CF_TRY(make_particles(g));
  CF_TRY(make_solvers(g));
  g->water.first = cf_mpm_sums_of(g->mpm).water;
  return add_state(g, r);
}

cf_status cf_gel_create(void **model, const cf_scene *scene, cf_registry *registry) {
  *model = NULL;
  cf_gel *g;
  CF_TRY(CF_NEW(&g, 1));
  g->scene = scene;
  g->keys = &scene->gel;
  g->grid = registry->grid;
  cf_status s = cf_gel_lattice(scene, &g->lattice, g->offset);
  g->lattice.threads = g->grid->threads;
  if (s == CF_OK) s = make(g, registry);
  if (s != CF_OK) {
    cf_gel_destroy(g);
    return s;
  }
  *model = g;
  return CF_OK;
}

void cf_gel_destroy(void *model) {
  cf_gel *g = model;
  if (g == NULL) return;
  cf_poro_destroy(g->poro);
  cf_mpm_destroy(g->mpm);
  cf_particles_destroy(g->set);
  for (int i = 0; i < 3; ++i) cf_cell_destroy(&g->on_lattice[i], &g->lattice.box);
  cf_obstacles_destroy(&g->solids);
  void *tables[] = {g->material, g->filter_due, g->eta, g->obstacle, g->shape,
                    g->source,   g->place,      g->dry, g->given};
  for (size_t i = 0; i < sizeof tables / sizeof *tables; ++i) cf_free(tables[i]);
  cf_free(g);
}
