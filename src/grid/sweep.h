/* SPDX-License-Identifier: MIT
 *
 * How kernels run over a grid. A kernel is a row function over n contiguous cells that knows nothing of
 * threads, ghosts or walls:
 *
 *     CF_KERNEL void scale_row(const int dim, const int n, const scale *s, const ptrdiff_t p) {
 *       CF_ROW_LOOP
 *       for (int i = 0; i < n; ++i) {
 *         cf_real sum = 0;
 *         CF_AXIS_LOOP
 *         for (int a = 0; a < dim; ++a) sum += s->f[p + i + s->stride[a]];
 *         ...
 *       }
 *     }
 *     CF_CLONED(scale_row, const scale *, ptrdiff_t)
 *
 * CF_CLONED makes scale_row_by_dim(dim, n, ...), which calls the row with dim a literal 2 or 3 so that the
 * axis loop unrolls, compiled for AVX-512, AVX2 and plain x86-64 with the choice made when the program
 * starts. No operation is contracted or reordered, so every version gives the same bits.
 *
 * A sweep runs rows in parallel:
 *
 *     CF_PARALLEL_ROWS(b, threads, r) scale_row_by_dim(b->dim, b->n[0], &s, cf_box_row(b, r));
 *
 * Sums go through one partial sum a row, added in a fixed order by cf_sum_ordered: the same bits for any
 * number of threads.
 */
#ifndef CF_GRID_SWEEP_H
#define CF_GRID_SWEEP_H

#include <stddef.h>

#include "grid/field.h"

#define CF_PRAGMA(text) _Pragma(#text)

#if defined(__clang__)
#define CF_ROW_LOOP  CF_PRAGMA(omp simd)
#define CF_AXIS_LOOP CF_PRAGMA(unroll)
#else
#define CF_ROW_LOOP  CF_PRAGMA(omp simd)
#define CF_AXIS_LOOP CF_PRAGMA(GCC unroll 3)
#endif

/* clang 14 compiles target_clones to nothing of use, and sanitized programs die before main with it. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__SANITIZE_ADDRESS__)
#define CF_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define CF_CLONES
#endif

#define CF_KERNEL static inline __attribute__((always_inline))

#define CF_CLONED(name, T1, T2)                                                         \
  CF_CLONES static void name##_in_2d(const int n, T1 x1, T2 x2) { name(2, n, x1, x2); } \
  CF_CLONES static void name##_in_3d(const int n, T1 x1, T2 x2) { name(3, n, x1, x2); } \
  static inline void name##_by_dim(const int dim, const int n, T1 x1, T2 x2) {          \
    if (dim == 3)                                                                       \
      name##_in_3d(n, x1, x2);                                                          \
    else                                                                                \
      name##_in_2d(n, x1, x2);                                                          \
  }

/* The same for a row with a second literal, `form` 0 or 1 (constant or varying coefficients), after dim. */
#define CF_CLONED_FORMS(name, T1, T2)                                                                 \
  CF_KERNEL void name##_form_0(const int dim, const int n, T1 x1, T2 x2) { name(dim, 0, n, x1, x2); } \
  CF_KERNEL void name##_form_1(const int dim, const int n, T1 x1, T2 x2) { name(dim, 1, n, x1, x2); } \
  CF_CLONED(name##_form_0, T1, T2)                                                                    \
  CF_CLONED(name##_form_1, T1, T2)                                                                    \
  static inline void name##_by_form(const int dim, const int form, const int n, T1 x1, T2 x2) {       \
    if (form)                                                                                         \
      name##_form_1_by_dim(dim, n, x1, x2);                                                           \
    else                                                                                              \
      name##_form_0_by_dim(dim, n, x1, x2);                                                           \
  }

/* Below this many cells a second thread costs more than it brings. */
#define CF_SERIAL_CELLS 8192

static inline int cf_sweep_threads(const cf_box *b, const int threads) {
  return cf_box_cells(b) < CF_SERIAL_CELLS ? 1 : threads;
}

#define CF_PARALLEL_ROWS(b, threads, r)                                                  \
  CF_PRAGMA(omp parallel for schedule(static) num_threads(cf_sweep_threads(b, threads))) \
  for (ptrdiff_t r = 0; r < cf_box_rows(b); ++r)

/* The same over the rows of faces of axis a, the high wall's included; a row has cf_box_extent(b, 0, a) of them. */
#define CF_PARALLEL_FACE_ROWS(b, threads, a, r)                                          \
  CF_PRAGMA(omp parallel for schedule(static) num_threads(cf_sweep_threads(b, threads))) \
  for (ptrdiff_t r = 0; r < (ptrdiff_t)cf_box_extent(b, 1, a) * cf_box_extent(b, 2, a); ++r)

static inline ptrdiff_t cf_box_face_row(const cf_box *b, const int a, const ptrdiff_t r) {
  const int rows = cf_box_extent(b, 1, a);
  return (r % rows) * b->stride[1] + (r / rows) * b->stride[2];
}

/* Partial sums of a row keep this many lanes apart and join them as a fixed tree. */
#define CF_SUM_LANES 8

static inline double cf_sum_lanes(const double s[CF_SUM_LANES]) {
  return ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
}

/* The sum of v[0..n-1] by halves: the order depends on n alone. */
double cf_sum_ordered(const double *v, ptrdiff_t n);

/* The sum of a row, in lanes. */
double cf_sweep_row_sum(int n, const cf_real *f);

/* Sum, least and largest of a cell field over the cells of the box. `rows` holds 3 doubles a row of the box. */
typedef struct cf_range {
  double sum, min, max;
} cf_range;
cf_range cf_sweep_range(const cf_box *b, int threads, const cf_real *f, double *rows);

/* The sum alone; `rows` holds a double a row of the box. */
double cf_sweep_sum(const cf_box *b, int threads, const cf_real *f, double *rows);

/* Whether every cell is finite; if not, *where is the index (i, j, k) of the first that is not. */
int cf_sweep_finite(const cf_box *b, int threads, const cf_real *f, int where[3]);

#endif
