/* SPDX-License-Identifier: MIT
 *
 * hypre's structured solver: conjugate gradients around PFMG with red-black Gauss-Seidel, coarse operators
 * that keep the stencil, and relaxation skipped where it can be. The matrix is a general one, as hypre's are. Debian's hypre
 * works in MPI processes; here there is one.
 */
#include <HYPRE_krylov.h>
#include <HYPRE_struct_ls.h>
#include <math.h>
#include <mpi.h>
#include <stdlib.h>

#include "base/mem.h"
#include "race.h"

enum { ENTRIES = 4 };

typedef struct structured {
  HYPRE_StructGrid grid;
  HYPRE_StructStencil stencil;
  HYPRE_StructMatrix A;
  HYPRE_StructVector x, b;
  HYPRE_StructSolver solver, cycle;
  double *values, *matrix; /* a vector; the diagonal and high couplings, cell by cell */
  int low[3], high[3];
} structured;

/* The diagonal and the couplings to the high neighbours (the matrix is symmetric). */
static void fill_values(const cf_bench_case *c, const cf_bench_system *s, double *values) {
  const double alpha = isinf(c->sigma) ? 0 : 1, number = isinf(c->sigma) ? 1 : c->sigma;
  double *v = values;
  for (int k = 0; k < c->n[2]; ++k)
    for (int j = 0; j < c->n[1]; ++j)
      for (int i = 0; i < c->n[0]; ++i, v += c->dim + 1) {
        const int at[3] = {i, j, k};
        v[0] = alpha;
        for (int a = 0; a < c->dim; ++a) {
          const bool p = c->walls[a] == 'p', first = at[a] == 0, last = at[a] == c->n[a] - 1;
          const double wall = c->walls[a] == 'o' ? 2 : 0;
          const cf_real *beta = c->varied ? s->beta.at[a] + cf_box_at(&s->grid.box, i, j, k) : NULL;
          const double low = beta != NULL ? (double)beta[0] : number;
          const double high = beta != NULL ? (double)beta[s->grid.box.stride[a]] : number;
          v[0] += low * (!first || p ? 1 : wall) + high * (!last || p ? 1 : wall);
          v[1 + a] = !last || p ? -high : 0;
        }
      }
}

static void make_solver(structured *h, const cf_bench_case *c) {
  HYPRE_StructPCGCreate(MPI_COMM_WORLD, &h->solver);
  HYPRE_StructPCGSetTol(h->solver, c->tolerance);
  HYPRE_StructPCGSetMaxIter(h->solver, 200);
  HYPRE_StructPCGSetTwoNorm(h->solver, 1);
  HYPRE_StructPFMGCreate(MPI_COMM_WORLD, &h->cycle);
  HYPRE_StructPFMGSetMaxIter(h->cycle, 1);
  HYPRE_StructPFMGSetTol(h->cycle, 0);
  HYPRE_StructPFMGSetZeroGuess(h->cycle);
  HYPRE_StructPFMGSetRAPType(h->cycle, 1);
  HYPRE_StructPFMGSetRelaxType(h->cycle, 2);
  HYPRE_StructPFMGSetNumPreRelax(h->cycle, 1);
  HYPRE_StructPFMGSetNumPostRelax(h->cycle, 1);
  HYPRE_StructPFMGSetSkipRelax(h->cycle, 1);
  HYPRE_StructPCGSetPrecond(h->solver, HYPRE_StructPFMGSolve, HYPRE_StructPFMGSetup, h->cycle);
  HYPRE_StructPCGSetup(h->solver, h->A, h->b, h->x);
}

static void destroy_matrix(structured *h) {
  HYPRE_StructPCGDestroy(h->solver);
  HYPRE_StructPFMGDestroy(h->cycle);
  HYPRE_StructMatrixDestroy(h->A);
}

static void structured_destroy(void *made) {
  structured *h = made;
  if (h == NULL) return;
  destroy_matrix(h);
  HYPRE_StructVectorDestroy(h->x);
  HYPRE_StructVectorDestroy(h->b);
  HYPRE_StructStencilDestroy(h->stencil);
  HYPRE_StructGridDestroy(h->grid);
  cf_free(h->values);
  cf_free(h->matrix);
  cf_free(h);
}

static void make_grid(structured *h, const cf_bench_case *c) {
  int periodic[3] = {0}, stencil[ENTRIES][3] = {{0}};
  for (int a = 0; a < c->dim; ++a) {
    h->high[a] = c->n[a] - 1;
    periodic[a] = c->walls[a] == 'p' ? c->n[a] : 0;
    stencil[1 + a][a] = 1;
  }
  HYPRE_StructGridCreate(MPI_COMM_WORLD, c->dim, &h->grid);
  HYPRE_StructGridSetExtents(h->grid, h->low, h->high);
  HYPRE_StructGridSetPeriodic(h->grid, periodic);
  HYPRE_StructGridAssemble(h->grid);
  HYPRE_StructStencilCreate(c->dim, c->dim + 1, &h->stencil);
  for (int e = 0; e <= c->dim; ++e) HYPRE_StructStencilSetElement(h->stencil, e, stencil[e]);
}

static void finish(void) {
  HYPRE_Finalize();
  MPI_Finalize();
}

static void begin(void) {
  int begun = 0;
  MPI_Initialized(&begun);
  if (begun) return;
  MPI_Init(NULL, NULL);
  HYPRE_Init();
  atexit(finish);
}

/* The matrix from its values, and the solver. */
static void make_matrix(structured *h, const cf_bench_case *c) {
  int entries[ENTRIES] = {0, 1, 2, 3};
  HYPRE_StructMatrixCreate(MPI_COMM_WORLD, h->grid, h->stencil, &h->A);
  HYPRE_StructMatrixSetSymmetric(h->A, 1);
  HYPRE_StructMatrixInitialize(h->A);
  HYPRE_StructMatrixSetBoxValues(h->A, h->low, h->high, c->dim + 1, entries, h->matrix);
  HYPRE_StructMatrixAssemble(h->A);
  make_solver(h, c);
}

static cf_status structured_create(void **made, const cf_bench_case *c, const cf_bench_system *s) {
  const ptrdiff_t cells = (ptrdiff_t)c->n[0] * c->n[1] * c->n[2];
  *made = NULL;
  begin();
  structured *h;
  CF_TRY(CF_NEW(&h, 1));
  cf_status status = CF_NEW(&h->values, cells);
  if (status == CF_OK) status = CF_NEW(&h->matrix, cells * (c->dim + 1));
  if (status != CF_OK) {
    cf_free(h->values);
    cf_free(h);
    return status;
  }
  make_grid(h, c);
  HYPRE_StructVectorCreate(MPI_COMM_WORLD, h->grid, &h->x);
  HYPRE_StructVectorInitialize(h->x);
  HYPRE_StructVectorCreate(MPI_COMM_WORLD, h->grid, &h->b);
  HYPRE_StructVectorInitialize(h->b);
  fill_values(c, s, h->matrix);
  make_matrix(h, c);
  *made = h;
  return CF_OK;
}

static void copy_in(const cf_bench_case *c, const cf_bench_system *s, double *values) {
  for (ptrdiff_t r = 0; r < cf_box_rows(&s->grid.box); ++r)
    for (int i = 0; i < c->n[0]; ++i)
      values[r * c->n[0] + i] = (double)s->b.at[cf_box_row(&s->grid.box, r) + i];
}

static cf_status structured_solve(void *made, const cf_bench_case *c, const cf_bench_system *s,
                                  double *seconds, int *iterations) {
  structured *h = made;
  copy_in(c, s, h->values);
  HYPRE_StructVectorSetBoxValues(h->b, h->low, h->high, h->values);
  HYPRE_StructVectorSetConstantValues(h->x, 0);
  if (c->set_up) destroy_matrix(h);
  const double begun = cf_bench_clock(c->own_time);
  if (c->set_up) make_matrix(h, c);
  HYPRE_StructPCGSolve(h->solver, h->A, h->b, h->x);
  *seconds = cf_bench_clock(c->own_time) - begun;
  HYPRE_StructPCGGetNumIterations(h->solver, iterations);
  HYPRE_StructVectorGetBoxValues(h->x, h->low, h->high, h->values);
  for (ptrdiff_t r = 0; r < cf_box_rows(&s->grid.box); ++r)
    for (int i = 0; i < c->n[0]; ++i)
      s->x.at[cf_box_row(&s->grid.box, r) + i] = (cf_real)h->values[r * c->n[0] + i];
  return CF_OK;
}

const race_solver race_hypre = {"hypre PCG+PFMG", structured_create, structured_solve, structured_destroy};
