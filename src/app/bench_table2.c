/* SPDX-License-Identifier: MIT
 *
 * cattaneo bench table2: the cost table of the paper (its Table 2), with this program's stages, on grids that fit.
 *
 * First some steps of the examples that stand for the paper's columns: seconds a step by stage, solver iterations,
 * memory. `paper` is the scheme of its eqs. 11-18, one implicit solve a step; `default` is what the program would do.
 *
 * Then what the iteration counts of the paper mean. Its diffusion solves (1 - beta lap) phi = b with
 *
 *     sigma = beta/h^2 = (k dt/h^2) (dt + F_T tau)/(dt + tau),
 *
 * so with F_T = 0 and dt << tau there is next to nothing to solve. Shown is what the solver here takes at the paper's
 * settings, with the paper's counts beside it.
 */
#define _GNU_SOURCE
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/bench.h"
#include "app/bench_case.h"
#include "app/examples.h"
#include "model/sim.h"

enum { WARM_STEPS = 2, STEPS = 7, SETS = 4, LAWS = 6, NONE = LAWS, TEXT = 64 };

/* The columns of the paper: F_T, and Fourier's law, which has no tau. Beside them no diffusion at all: what a step takes
 * more than this one is the whole price of diffusion, the transport of its flux included. */
static const struct {
  const char *name, *set;
  double f_t;
  int paper_iterations;
} laws[LAWS + 1] = {{"0", "diffusion.f_t=0", 0, 8},
                    {"0.25", "diffusion.f_t=0.25", 0.25, 28},
                    {"0.5", "diffusion.f_t=0.5", 0.5, 38},
                    {"0.75", "diffusion.f_t=0.75", 0.75, 43},
                    {"1", "diffusion.f_t=1", 1, 45},
                    {"Fourier", "diffusion.tau=0", 1, 45},
                    {"none", "diffusion={k: 0, tau: 0}", 0, 0}};

static const char *const stage_name[CF_STAGES] = {
#define STAGE_NAME(upper, text) text,
    CF_STAGE_LIST(STAGE_NAME)
#undef STAGE_NAME
};

/* --- steps of a scene ------------------------------------------------------------------------------------- */

/* One column: a scene with a law and a scheme. Seconds are medians of its steps, iterations means. */
typedef struct column {
  const char *example, *scheme;
  int law, n[3], threads;
  double seconds[CF_STAGES], total, iterations[CF_STAGES], bytes;
} column;

static const cf_example *example_of(const char *name) {
  for (const cf_example *e = cf_examples; e->name != NULL; ++e)
    if (strcmp(e->name, name) == 0) return e;
  return NULL;
}

/* Scenes are read from files. */
static cf_status read_example(const cf_example *e, const int sets, const char *const *set, cf_scene **scene) {
  char path[] = "/tmp/cattaneo-bench-XXXXXX.yaml";
  const int file = mkstemps(path, 5);
  if (file < 0) return cf_fail(CF_CANNOT_WRITE, "%s could not be made", path);
  const bool whole = write(file, e->scene, e->size) == (ssize_t)e->size;
  close(file);
  const cf_status status = whole ? cf_scene_read(scene, path, sets, set)
                                 : cf_fail(CF_CANNOT_WRITE, "%s could not be written", path);
  unlink(path);
  return status;
}

static cf_status take_steps(cf_sim *sim, column *c) {
  double spent[CF_STAGES + 1][STEPS] = {{0}};
  int taken = 0;
  for (int step = -WARM_STEPS; step < STEPS && !cf_sim_finished(sim); ++step) {
    bool on_frame;
    const double begun = cf_bench_clock(false);
    CF_TRY(cf_sim_step(sim, &on_frame));
    if (step < 0) continue;
    spent[CF_STAGES][taken] = cf_bench_clock(false) - begun;
    for (int s = 0; s < CF_STAGES; ++s) {
      spent[s][taken] = sim->report.seconds[s];
      c->iterations[s] += (double)sim->report.iterations[s] / STEPS;
    }
    ++taken;
    /* A model with one solver does not say to which stage its iterations belong. */
    if (c->iterations[CF_STAGE_DIFFUSE] == 0 && c->iterations[CF_STAGE_PROJECT] == 0)
      c->iterations[CF_STAGE_OTHER] = sim->report.solve.iterations;
  }
  if (taken == 0) return CF_OK;
  c->total = cf_bench_median(spent[CF_STAGES], taken);
  for (int s = 0; s < CF_STAGES; ++s) c->seconds[s] = cf_bench_median(spent[s], taken);
  memcpy(c->n, sim->grid.box.n, sizeof c->n);
  return CF_OK;
}

static cf_status run_column(const cf_example *e, const char *cells, column *c) {
  char scheme[TEXT];
  snprintf(scheme, sizeof scheme, "diffusion.scheme=%s", c->scheme);
  const char *const set[SETS] = {laws[c->law].set, scheme, "solver.tolerance=1e-6", cells};
  cf_scene *scene = NULL;
  cf_sim *sim = NULL;
  const double before = cf_bench_resident();
  cf_status status = read_example(e, cells != NULL ? SETS : SETS - 1, set, &scene);
  if (status == CF_OK) status = cf_sim_create(&sim, scene, c->threads);
  if (status == CF_OK) status = take_steps(sim, c);
  c->bytes = cf_bench_resident() - before;
  cf_sim_destroy(sim);
  cf_scene_destroy(scene);
  return status;
}

static void print_column_json(const column *c) {
  printf("{\"bench\": \"table2\", \"case\": \"%s\", \"law\": \"%s\", \"scheme\": \"%s\", \"n\": [%d, %d, %d]",
         c->example, c->law < 5 ? "C-F" : laws[c->law].name, c->scheme, c->n[0], c->n[1], c->n[2]);
  cf_bench_json_number("f_t", laws[c->law].f_t);
  printf(", \"threads\": %d", c->threads);
  cf_bench_json_number("seconds", c->total);
  cf_bench_json_number("bytes", c->bytes);
  printf(", \"stages\": {");
  for (int s = 0; s < CF_STAGES; ++s)
    printf("%s\"%s\": {\"seconds\": %.6g, \"iterations\": %.6g}", s > 0 ? ", " : "", stage_name[s],
           c->seconds[s], c->iterations[s]);
  printf("}}\n");
}

/* Columns side by side, a row a stage that has anything. */
static void print_columns(const column *c, const int columns) {
  printf("\n%s, %dx%dx%d, ms a step", c->example, c->n[0], c->n[1], c->n[2]);
  printf("\n%-26s", "F_T");
  for (int v = 0; v < columns; ++v) printf("%10s", laws[c[v].law].name);
  printf("\n%-26s", "scheme");
  for (int v = 0; v < columns; ++v) printf("%10s", c[v].scheme);
  for (int s = 0; s < CF_STAGES; ++s) {
    double most = 0, iterations = 0;
    for (int v = 0; v < columns; ++v) {
      most = fmax(most, c[v].seconds[s]);
      iterations = fmax(iterations, c[v].iterations[s]);
    }
    if (most > 0) printf("\n%-26s", stage_name[s]);
    for (int v = 0; v < columns && most > 0; ++v) printf("%10.2f", 1e3 * c[v].seconds[s]);
    if (iterations > 0) printf("\n%-26s", s == CF_STAGE_OTHER ? "  iterations, all" : "  iterations");
    for (int v = 0; v < columns && iterations > 0; ++v) printf("%10.1f", c[v].iterations[s]);
  }
  printf("\n%-26s", "total");
  for (int v = 0; v < columns; ++v) printf("%10.2f", 1e3 * c[v].total);
  printf("\n%-26s", "diffusion, % of it");
  for (int v = 0; v < columns; ++v) printf("%10.1f", 100 * c[v].seconds[CF_STAGE_DIFFUSE] / c[v].total);
  if (c[columns - 1].law == NONE) {
    printf("\n%-26s", "all of C-F, % of it");
    for (int v = 0; v < columns; ++v) printf("%10.1f", 100 * (1 - c[columns - 1].total / c[v].total));
  }
  printf("\n%-26s", "memory, MB");
  for (int v = 0; v < columns; ++v) printf("%10.1f", c[v].bytes * 1e-6);
  printf("\n");
}

static cf_status bench_example(const cf_bench_filter *f, const char *name, const int *law, const int count,
                               const char *cells) {
  const cf_example *e = example_of(name);
  static const char *const scheme[] = {"paper", "default"};
  if (e == NULL) return CF_OK;
  for (int v = 0; v < 2; ++v) {
    column c[LAWS + 1];
    for (int q = 0; q < count; ++q) {
      c[q] = (column){.example = name, .scheme = scheme[v], .law = law[q], .threads = f->threads};
      CF_TRY(run_column(e, cells, &c[q]));
      if (f->json) print_column_json(&c[q]);
      fflush(stdout);
    }
    if (!f->json) print_columns(c, count);
    fflush(stdout);
  }
  return CF_OK;
}

/* --- what the counts mean --------------------------------------------------------------------------------- */

typedef struct setting {
  const char *name;
  double k, tau, dt, h;
} setting;

static double sigma_of(const setting *p, const int law) {
  return p->k * p->dt / (p->h * p->h) * (p->dt + laws[law].f_t * p->tau) / (p->dt + p->tau);
}

static cf_status bench_setting(const cf_bench_filter *f, const setting *p) {
  double first = 0;
  if (!f->json)
    printf("\n%s: k = %g, tau = %g, dt = %.4g, h = %.4g\n%-10s%10s%14s%10s%10s%12s%12s\n", p->name, p->k,
           p->tau, p->dt, p->h, "F_T", "sigma", "method", "passes", "ns/cell", "over F_T=0", "paper: PCG");
  for (int law = 0; law < LAWS; ++law) {
    cf_bench_case c = {.name = "counts",
                       .dim = 3,
                       .n = {128, 128, 128},
                       .tolerance = 1e-6,
                       .threads = f->threads,
                       .walls = "ooo",
                       .sigma = sigma_of(p, law)};
    cf_bench_result r;
    CF_TRY(cf_bench_case_run(&c, 5, 0.2, &r));
    const double ns = 1e9 * r.seconds / ((double)c.n[0] * c.n[1] * c.n[2]);
    if (law == 0) first = ns;
    if (f->json) {
      printf("{\"bench\": \"table2\", \"case\": \"counts\", \"setting\": \"%s\", \"law\": \"%s\"", p->name,
             laws[law].name);
      cf_bench_json_number("sigma", c.sigma);
      cf_bench_json_number("seconds", r.seconds);
      printf(", \"iterations\": %d, \"paper_iterations\": %d, \"method\": \"%s\"}\n", r.report.iterations,
             laws[law].paper_iterations, r.report.method);
    } else {
      printf("%-10s%10.3g%14s%10d%10.2f%12.2f%12d\n", laws[law].name, c.sigma, r.report.method,
             r.report.iterations, ns, ns / first, laws[law].paper_iterations);
    }
    fflush(stdout);
  }
  return CF_OK;
}

/* --- all of it -------------------------------------------------------------------------------------------- */

cf_status cf_bench_table2(const cf_bench_filter *f) {
  static const int all[LAWS + 1] = {0, 1, 2, 3, 4, 5, NONE}, ends[2] = {0, 5};
  /* Fig 5 with its printed parameters; Fig 6, whose are not known, with a k at which Fourier's law is stiff. */
  static const setting settings[] = {{"Fig 5, 256 cells", 0.01, 4, 1.0 / 144, 4.0 / 256},
                                     {"a stiff one, 256 cells", 0.25, 4, 1.0 / 24, 4.0 / 256}};
  char cells[TEXT] = "domain.cells=[64, 128, 64]";
  if (f->boxes > 0) {
    if (f->dim[0] != 3 || f->boxes > 1)
      return cf_fail(CF_BAD_USAGE, "bench table2: --n takes one box of three extents here, like 64x128x64");
    snprintf(cells, sizeof cells, "domain.cells=[%d, %d, %d]", f->n[0][0], f->n[0][1], f->n[0][2]);
  }
  if (!f->json) printf("medians of %d steps, %d threads; tolerance 1e-6\n", STEPS, f->threads);
  CF_TRY(bench_example(f, "ink", all, LAWS + 1, cells));
  CF_TRY(bench_example(f, "smoke-cone", ends, 2, NULL));
  CF_TRY(bench_example(f, "hydrogel", ends, 2, NULL));
  for (int v = 0; v < 2; ++v) CF_TRY(bench_setting(f, &settings[v]));
  return CF_OK;
}
