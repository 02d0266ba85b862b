/* SPDX-License-Identifier: MIT
 *
 * Material points without water moving between them: what is conserved, free swelling and the frequency of a bar
 * against closed forms, laws, transfers, obstacles, and the same bits for any number of threads.
 */
/* also in single precision */
#include <stdlib.h>

#include "base/real.h"
#include "gel_case.h"
#include "reference.h"

static const double round_off = 40 * CF_REAL_EPSILON;

static void blob(gel_case *g, const int dim, const int per, const double jitter, const cf_mpm_params *p) {
  const int n = 32;
  const double h = 1.0 / n, w = dim == 3 ? 5 * h : 8 * h;
  const double low[3] = {0.31, 0.31, 0.31}, high[3] = {0.31 + w, 0.31 + w, 0.31 + w};
  OK(cf_grid_init(&g->grid, dim, (int[]){n, n, n}, h, NULL));
  gel_fill(g, low, high, per, jitter);
  gel_start(g, p);
}

/* A rotation, a shear and a shift, all at once. */
static void set_moving(const gel_case *g) {
  const int dim = g->grid.box.dim;
  for (int64_t i = 0; i < g->set->count; ++i) {
    const double x = (double)gel_at(g, 0, 0)[i] - 0.4, y = (double)gel_at(g, 0, 1)[i] - 0.4;
    gel_at(g, g->at.velocity, 0)[i] = (cf_real)(0.3 - 2 * y + 0.5 * x);
    gel_at(g, g->at.velocity, 1)[i] = (cf_real)(2 * x - 0.1);
    if (dim == 3) gel_at(g, g->at.velocity, 2)[i] = (cf_real)(0.2 + y);
    gel_at(g, g->at.affine, 1)[i] = -2, gel_at(g, g->at.affine, dim)[i] = 2;
    gel_at(g, g->at.water, 0)[i] = (cf_real)(0.2 * (double)gel_at(g, g->at.volume, 0)[i] * (1 + sin(20 * x)));
  }
}

static void momenta_are_kept(const int dim, const double flip, const double angular_tolerance) {
  gel_case g = {
      .material = {{.mu = 16, .lambda = 24, .density = 3, .water = 0.7, .swelling = 10, GEL_ELASTIC}}};
  blob(&g, dim, 2, 0.3, &(cf_mpm_params){.flip = flip});
  set_moving(&g);
  const cf_mpm_sums first = cf_mpm_sums_of(g.mpm);
  for (int s = 0; s < 100; ++s) gel_step(&g, 0, 2e-3);
  const cf_mpm_sums last = cf_mpm_sums_of(g.mpm);
  const double size = sqrt(2 * first.kinetic * first.mass), grow = sqrt(100.0);
  for (int a = 0; a < 3; ++a) {
    CLOSE(last.momentum[a], first.momentum[a], grow * round_off * size);
    CLOSE(last.angular[a], first.angular[a], grow * round_off * size + angular_tolerance * size * 0.1);
  }
  CLOSE(last.water, first.water, grow * round_off * first.water);
  assert_true(fabs(last.volume / first.volume - 1) > 1e-3); /* something happened */
  gel_end(&g);
}

static void apic_keeps_momentum_and_angular_momentum(void **state) {
  (void)state;
  momenta_are_kept(2, -1, 0);
  momenta_are_kept(3, -1, 0);
}

static void flip_keeps_momentum(void **state) {
  (void)state;
  momenta_are_kept(2, 0.95, 10);
  momenta_are_kept(3, 0.95, 10);
}

/* The semi-implicit step turns the stress of the state before by the motion of the state after: it keeps momentum, and
 * loses angular momentum of the second order of a step. */
static void semi_implicit_step_keeps_momentum(void **state) {
  (void)state;
  double lost[2];
  for (int v = 0; v < 2; ++v) {
    gel_case g = {
        .material = {{.mu = 16, .lambda = 24, .density = 3, .water = 0.7, .swelling = 10, GEL_ELASTIC}}};
    const double dt = 4e-3 / (1 << v);
    blob(&g, 2, 2, 0.3,
         &(cf_mpm_params){
             .flip = -1, .implicitness = 1, .solver = {CF_REAL_EPSILON < 1e-10 ? 1e-12 : 1e-6, 300}});
    set_moving(&g);
    const cf_mpm_sums first = cf_mpm_sums_of(g.mpm);
    const double size = sqrt(2 * first.kinetic * first.mass);
    for (int s = 0; s < 25 << v; ++s) gel_step(&g, 0, dt);
    const cf_mpm_sums last = cf_mpm_sums_of(g.mpm);
    for (int a = 0; a < 3; ++a) CLOSE(last.momentum[a], first.momentum[a], 1000 * round_off * size);
    lost[v] = fabs(last.angular[2] - first.angular[2]) / (0.1 * size);
    gel_end(&g);
  }
  print_message("angular momentum lost in 0.1 s: %.3g of it, with half the step %.3g\n", lost[0], lost[1]);
  BELOW(lost[0], 2e-3);
  BELOW(lost[1], 0.6 * lost[0]);
}

/* Free swelling: 2 mu (s - 1) s + lambda (s^d - 1) s^d = chi S, at the capacity of the swollen body. */
static void free_swelling_is_that_of_the_closed_form(void **state) {
  (void)state;
  table t = table_read("swelling.csv");
  for (int r = 0; r < t.rows; ++r) {
    const int dim = (int)table_at(&t, r, "d");
    const double chi = table_at(&t, r, "chi_S"), J = table_at(&t, r, "J");
    if (dim == 3 && chi != 4) continue;
    gel_case g = {.material = {{.mu = table_at(&t, r, "mu"),
                                .lambda = table_at(&t, r, "lambda"),
                                .density = 1,
                                .water = 0.7,
                                .swelling = chi,
                                GEL_ELASTIC}}};
    blob(&g, dim, 2, 0.3, &(cf_mpm_params){.flip = -1, .damping = 20});
    for (int s = 0; s < 500; ++s) { /* S = 1 whatever J is */
      cf_real *c = gel_at(&g, g.at.water, 0);
      const cf_real *V = gel_at(&g, g.at.volume, 0);
      cf_real *J_of = malloc(sizeof *J_of * (size_t)g.set->count);
      cf_mpm_derive(g.mpm, NULL, J_of, NULL);
      for (int64_t i = 0; i < g.set->count; ++i) c[i] = (cf_real)0.7 * V[i] * J_of[i];
      free(J_of);
      gel_step(&g, 0, 0.35 * g.grid.h / sqrt(56 + chi));
    }
    const cf_mpm_sums sums = cf_mpm_sums_of(g.mpm);
    const double V0 = (double)gel_at(&g, g.at.volume, 0)[0] * (double)g.set->count;
    CLOSE(sums.volume / V0, J, 1e-4 * (chi > 4 ? 2 : 1));
    gel_end(&g);
  }
  table_free(&t);
}

/* The frequency of a bar of length 1 between slippery walls, fixed at one end, with n cells a length. */
static double bar_frequency(const int n, const cf_mpm_material *material, const double c) {
  const double h = 1.0 / n, low[3] = {8 * h, 8 * h, 0}, high[3] = {low[0] + 1, low[1] + 0.5, 0};
  gel_case g = {.material = {*material}};
  const cf_shape wall[3] = {cf_shape_plane((double[3]){low[0], 0, 0}, (double[3]){1, 0, 0}),
                            cf_shape_plane((double[3]){0, low[1], 0}, (double[3]){0, 1, 0}),
                            cf_shape_plane((double[3]){0, high[1], 0}, (double[3]){0, -1, 0})};
  const cf_mpm_obstacle walls[3] = {{.shape = &wall[0], .contact = CF_MPM_STICKY},
                                    {.shape = &wall[1], .contact = CF_MPM_SLIP},
                                    {.shape = &wall[2], .contact = CF_MPM_SLIP}};
  OK(cf_grid_init(&g.grid, 2, (int[]){n + 24, n / 2 + 24, 1}, h, NULL));
  gel_fill(&g, low, high, 2, 0);
  gel_start(&g, &(cf_mpm_params){.flip = -1, .obstacles = 3, .obstacle = walls});
  for (int64_t i = 0; i < g.set->count; ++i)
    gel_at(&g, g.at.velocity, 0)[i] =
        (cf_real)(1e-2 * sin(acos(-1) / 2 * ((double)gel_at(&g, 0, 0)[i] - low[0])));
  const double dt = 0.4 * h / c;
  double before = 1, crossing[2] = {0, 0};
  for (int s = 0, found = 0; found < 2 && s < 2000; ++s) {
    gel_step(&g, 0, dt);
    const double now = cf_mpm_sums_of(g.mpm).momentum[0];
    if (now * before < 0 && s > 0) crossing[found++] = dt * (s + now / (before - now));
    before = now;
  }
  gel_end(&g);
  return 0.5 / (crossing[1] - crossing[0]);
}

/* f = sqrt(M/rho)/(4 L). A wall is felt about a cell behind its surface, so errors are of first order; what they
 * extrapolate to is not. */
static void bar_swings_at_its_frequency(void **state) {
  (void)state;
  table t = table_read("elastic_bar.csv");
  const double f = table_at(&t, 0, "f_confined"), c = table_at(&t, 0, "c_p");
  const cf_mpm_material material = {.mu = table_at(&t, 0, "mu"),
                                    .lambda = table_at(&t, 0, "lambda"),
                                    .density = table_at(&t, 0, "rho"),
                                    .water = 0.7,
                                    GEL_ELASTIC};
  const double coarse = bar_frequency(20, &material, c) / f, fine = bar_frequency(40, &material, c) / f;
  CLOSE(fine, 1, 0.06);
  CLOSE(2 * fine - coarse, 1, 0.02);
  table_free(&t);
}

/* The stress of a turned body is the turned stress: T(Q F) = Q T(F) Q^T. */
static void rotation_leaves_stress_alone(void **state) {
  (void)state;
  for (int law = 0; law < 2; ++law) {
    gel_case g = {.material = {{.law = law ? CF_MPM_NEO_HOOKEAN : CF_MPM_COROTATED,
                                .mu = 16,
                                .lambda = 24,
                                .density = 1,
                                .water = 0.7,
                                .swelling = 5,
                                GEL_ELASTIC}}};
    blob(&g, 2, 1, 0, &(cf_mpm_params){.flip = -1});
    const double F[4] = {1.2, 0.3, -0.1, 0.9}, c = cos(1.1), s = sin(1.1), Q[4] = {c, -s, s, c};
    for (int k = 0; k < 4; ++k) {
      gel_at(&g, g.at.deformation, k)[0] = (cf_real)F[k];
      gel_at(&g, g.at.deformation, k)[1] =
          (cf_real)(Q[k / 2 * 2] * F[k % 2] + Q[k / 2 * 2 + 1] * F[2 + k % 2]);
    }
    for (int i = 0; i < 2; ++i) gel_at(&g, g.at.water, 0)[i] = (cf_real)0.3 * gel_at(&g, g.at.volume, 0)[i];
    cf_real T[4][2048], *stress[4] = {T[0], T[1], T[2], T[3]};
    assert_true(g.set->count <= 2048);
    cf_mpm_derive(g.mpm, NULL, NULL, stress);
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        double turned = 0;
        for (int a = 0; a < 2; ++a)
          for (int b = 0; b < 2; ++b) turned += Q[2 * i + a] * (double)T[2 * a + b][0] * Q[2 * j + b];
        CLOSE(T[2 * i + j][1], turned, 400 * round_off);
      }
    gel_end(&g);
  }
}

/* A block thrown at a floor: never far below it, and at rest in the end. */
static void dropped_block_comes_to_rest(void **state) {
  (void)state;
  gel_case g = {.material = {{.mu = 60, .lambda = 90, .density = 3, .water = 0.7, GEL_ELASTIC}}};
  const cf_shape floor = cf_shape_plane((double[3]){0, 0.25, 0}, (double[3]){0, 1, 0});
  const cf_mpm_obstacle below = {.shape = &floor, .contact = CF_MPM_SEPARATE, .friction = 0.3};
  blob(&g, 2, 2, 0.2,
       &(cf_mpm_params){.flip = -1, .obstacles = 1, .obstacle = &below, .gravity = {0, -5, 0}, .damping = 1});
  for (int64_t i = 0; i < g.set->count; ++i) gel_at(&g, g.at.velocity, 0)[i] = (cf_real)0.2;
  double highest = 0;
  for (int s = 0; s < 4000; ++s) {
    gel_step(&g, 0, 1.5e-3);
    if (s == 2000) highest = cf_mpm_sums_of(g.mpm).kinetic;
  }
  const cf_mpm_sums end = cf_mpm_sums_of(g.mpm);
  BELOW(end.kinetic, 1e-4 * end.mass);
  assert_true(highest >= end.kinetic * 0.5);
  double lowest = 1;
  for (int64_t i = 0; i < g.set->count; ++i) lowest = CF_MIN(lowest, (double)gel_at(&g, 0, 1)[i]);
  BELOW(fabs(lowest - 0.25), 1.0 / 32);
  gel_end(&g);
}

/* The implicit step at a small dt is the explicit one, and stands steps far beyond the explicit limit. */
static void semi_implicit_step_agrees_and_is_stable(void **state) {
  (void)state;
  for (int law = 0; law < 2; ++law) {
    double energy[2];
    for (int implicit = 0; implicit < 2; ++implicit) {
      gel_case g = {.material = {{.law = law ? CF_MPM_NEO_HOOKEAN : CF_MPM_COROTATED,
                                  .mu = 16,
                                  .lambda = 24,
                                  .density = 3,
                                  .water = 0.7,
                                  .swelling = 5,
                                  GEL_ELASTIC}}};
      blob(&g, 2, 2, 0.2, &(cf_mpm_params){.flip = -1, .implicitness = implicit, .solver = {1e-5, 200}});
      set_moving(&g);
      for (int s = 0; s < 100; ++s) gel_step(&g, 0, 2e-4);
      energy[implicit] = cf_mpm_sums_of(g.mpm).kinetic;
      const double before = energy[implicit];
      for (int s = 0; s < 20 && implicit; ++s) gel_step(&g, 0, 2e-2); /* five times the explicit limit */
      if (implicit) BELOW(cf_mpm_sums_of(g.mpm).kinetic, 1.5 * before);
      gel_end(&g);
    }
    CLOSE(energy[1] / energy[0], 1, 6e-3);
  }
}

/* Stretched beyond its limit a body keeps stretches within it, and the total volume. */
static void plastic_stretches_stay_within_their_limits(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim) {
    gel_case g = {.material = {{.mu = 16,
                                .lambda = 24,
                                .density = 3,
                                .water = 0.7,
                                .stretch = 0.02,
                                .compression = 0.05,
                                .hardening = 2}}};
    blob(&g, dim, 2, 0.2, &(cf_mpm_params){.flip = -1});
    for (int64_t i = 0; i < g.set->count; ++i)
      gel_at(&g, g.at.affine, 0)[i] = 3, gel_at(&g, g.at.velocity, 0)[i] =
                                             (cf_real)(3 * ((double)gel_at(&g, 0, 0)[i] - 0.43));
    for (int s = 0; s < 40; ++s) gel_step(&g, 0, 1e-3);
    const cf_mpm_sums end = cf_mpm_sums_of(g.mpm);
    assert_true(end.jacobian_max > 1.04);
    double most = 0;
    for (int64_t i = 0; i < g.set->count; ++i) {
      double norm = 0;
      for (int k = 0; k < dim * dim; ++k) norm += pow((double)gel_at(&g, g.at.deformation, k)[i], 2);
      most = CF_MAX(most, norm);
    }
    BELOW(most, dim * 1.02 * 1.02 + 1e-5);
    gel_end(&g);
  }
}

static void threads_do_not_change_a_bit(void **state) {
  (void)state;
  gel_case g[2];
  for (int t = 0; t < 2; ++t) {
    g[t] = (gel_case){
        .material = {{.mu = 16, .lambda = 24, .density = 3, .water = 0.7, .swelling = 10, GEL_ELASTIC}}};
    blob(&g[t], 3, 2, 0.3, &(cf_mpm_params){.flip = -1, .implicitness = 1, .solver = {1e-6, 50}});
    g[t].grid.threads = 1 + 2 * t;
    set_moving(&g[t]);
    for (int s = 0; s < 5; ++s) gel_step(&g[t], 0, 2e-3);
    cf_mpm_filter(g[t].mpm, &(double){0.3});
  }
  for (int a = 0; a < g[0].set->attributes; ++a)
    for (int c = 0; c < g[0].set->attribute[a].components; ++c)
      assert_memory_equal(gel_at(&g[0], a, c), gel_at(&g[1], a, c),
                          sizeof(cf_real) * (size_t)g[0].set->count);
  for (int t = 0; t < 2; ++t) gel_end(&g[t]);
}

/* A block that turns and is drawn out: particles that stand for more than 1.1 cells are cut until none does. */
static void splitting_keeps_all_sums_and_leaves_nothing_long(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; ++dim) {
    gel_case g = {
        .material = {{.mu = 16, .lambda = 24, .density = 3, .water = 0.7, .swelling = 10, GEL_ELASTIC}}};
    blob(&g, dim, 2, 0.3, &(cf_mpm_params){.flip = -1});
    cf_mpm_destroy(g.mpm);
    OK(cf_particles_reserve(g.set, 40 * g.set->count));
    gel_start(&g, &(cf_mpm_params){.flip = -1});
    set_moving(&g);
    const int64_t count = g.set->count;
    for (int64_t i = 0; i < count; ++i) {
      for (int a = 0; a < dim; ++a) gel_at(&g, g.at.side, a)[i] = (cf_real)(g.grid.h / 2);
      gel_at(&g, g.at.deformation, 0)[i] = (cf_real)(1 + 8 * ((double)gel_at(&g, 0, 0)[i] - 0.31) / 0.25);
      gel_at(&g, g.at.deformation, 1)[i] = 1.5f;
      gel_at(&g, g.at.memory, 0)[i] = (cf_real)(1e-3 * sin((double)i));
    }
    const cf_mpm_sums first = cf_mpm_sums_of(g.mpm);
    int times = 0;
    while (cf_mpm_split(g.mpm, 1.1) > 0) ++times;
    const cf_mpm_sums last = cf_mpm_sums_of(g.mpm);
    assert_in_range(times, 2, 3);
    assert_true(g.set->count > 2 * count && g.set->count < g.set->room);
    const double size = sqrt(2 * first.kinetic * first.mass);
    for (int a = 0; a < 3; ++a) {
      CLOSE(last.momentum[a], first.momentum[a], round_off * size);
      CLOSE(last.angular[a], first.angular[a], round_off * size);
      CLOSE(last.center[a], first.center[a], round_off);
    }
    CLOSE(last.mass, first.mass, round_off * first.mass);
    CLOSE(last.water, first.water, round_off * first.water);
    CLOSE(last.memory, first.memory, round_off * 1e-3 * sqrt((double)count));
    CLOSE(last.saturation_max, first.saturation_max, round_off);
    for (int64_t i = 0; i < g.set->count; ++i)
      for (int a = 0; a < dim; ++a) {
        double square = 0;
        for (int r = 0; r < dim; ++r) square += pow((double)gel_at(&g, g.at.deformation, r * dim + a)[i], 2);
        BELOW(sqrt(square) * (double)gel_at(&g, g.at.side, a)[i], 1.1 * g.grid.h * (1 + 1e-6));
      }
    gel_end(&g);
  }
}

/* A bar drawn out by its own motion to three times its length leaves no cell between its ends empty, as it does without
 * splitting. */
static void what_is_drawn_out_stays_whole(void **state) {
  (void)state;
  int empty[2];
  for (int split = 0; split < 2; ++split) {
    gel_case g = {.material = {{.mu = 0.25, .density = 1, GEL_ELASTIC}}};
    const double h = 1.0 / 64, middle = 0.5;
    OK(cf_grid_init(&g.grid, 2, (int[]){64, 64, 1}, h, NULL));
    gel_fill(&g, (double[]){middle - 6 * h, 0.4, 0}, (double[]){middle + 6 * h, 0.4 + 6 * h, 0}, 2, 0);
    OK(cf_particles_reserve(g.set, 8 * g.set->count));
    gel_start(&g, &(cf_mpm_params){.flip = -1});
    for (int64_t i = 0; i < g.set->count; ++i) {
      gel_at(&g, g.at.side, 0)[i] = gel_at(&g, g.at.side, 1)[i] = (cf_real)(h / 2);
      gel_at(&g, g.at.velocity, 0)[i] = (cf_real)(26 * ((double)gel_at(&g, 0, 0)[i] - middle));
      gel_at(&g, g.at.affine, 0)[i] = 26;
    }
    double longest = 0;
    empty[split] = 0;
    for (int s = 0; s < 400; ++s) {
      gel_step(&g, 0, 5e-4);
      if (split) cf_mpm_split(g.mpm, 1);
      bool filled[64] = {false};
      int low = 63, high = 0;
      for (int64_t i = 0; i < g.set->count; ++i) {
        const int cell = (int)((double)gel_at(&g, 0, 0)[i] / h);
        filled[cell] = true, low = CF_MIN(low, cell), high = CF_MAX(high, cell);
      }
      for (int i = low; i <= high; ++i) empty[split] += !filled[i];
      longest = CF_MAX(longest, (high - low + 1) / 12.0);
    }
    printf("%s: %.2f times as long, %d cells empty, %d particles\n", split ? "split" : "whole", longest,
           empty[split], (int)g.set->count);
    gel_end(&g);
  }
  assert_true(empty[0] > 0);
  assert_int_equal(empty[1], 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(apic_keeps_momentum_and_angular_momentum),
      cmocka_unit_test(flip_keeps_momentum),
      cmocka_unit_test(semi_implicit_step_keeps_momentum),
      cmocka_unit_test(free_swelling_is_that_of_the_closed_form),
      cmocka_unit_test(bar_swings_at_its_frequency),
      cmocka_unit_test(rotation_leaves_stress_alone),
      cmocka_unit_test(dropped_block_comes_to_rest),
      cmocka_unit_test(semi_implicit_step_agrees_and_is_stable),
      cmocka_unit_test(plastic_stretches_stay_within_their_limits),
      cmocka_unit_test(splitting_keeps_all_sums_and_leaves_nothing_long),
      cmocka_unit_test(what_is_drawn_out_stays_whole),
      cmocka_unit_test(threads_do_not_change_a_bit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
