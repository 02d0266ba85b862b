/* SPDX-License-Identifier: MIT */
#include "grid/box.h"

#include <stdint.h>

static ptrdiff_t round_up(const ptrdiff_t n, const ptrdiff_t step) { return (n + step - 1) / step * step; }

cf_status cf_box_init(cf_box *b, const int dim, const int n[3], const int halo) {
  if (dim != 2 && dim != 3)
    return cf_fail(CF_BAD_ARGUMENT, "a box of %d dimensions: only 2 and 3 exist", dim);
  *b = (cf_box){.dim = dim, .n = {n[0], n[1], dim == 3 ? n[2] : 1}, .halo = halo};
  for (int a = 0; a < dim; ++a)
    if (n[a] < 1) return cf_fail(CF_BAD_ARGUMENT, "%d cells along axis %d: must be at least 1", n[a], a);
  /* The high wall's faces need one element past the last cell even where nothing asks for ghosts. */
  const ptrdiff_t low = halo, high = CF_MAX(halo, 1);
  const ptrdiff_t pad = round_up(low, CF_LANES);
  const ptrdiff_t depth = dim == 3 ? low + b->n[2] + high : 1;
  const double elements =
      (double)(pad + high + CF_LANES + b->n[0]) * (double)(low + high + b->n[1]) * (double)depth;
  if (elements > (double)(PTRDIFF_MAX / 64))
    return cf_fail(CF_BAD_ARGUMENT, "%d x %d x %d cells: more than can be addressed", b->n[0], b->n[1],
                   b->n[2]);
  b->stride[0] = 1;
  b->stride[1] = round_up(pad + b->n[0] + high, CF_LANES);
  /* Rows a power of two apart fall into the same sets of a cache: move them. */
  if ((b->stride[1] & (b->stride[1] - 1)) == 0 && b->stride[1] > 8 * CF_LANES) b->stride[1] += CF_LANES;
  b->stride[2] = b->stride[1] * (low + b->n[1] + high);
  b->first = pad + low * b->stride[1] + (dim == 3 ? low * b->stride[2] : 0);
  b->size = depth * b->stride[2] + CF_LANES; /* the last row may be read a vector past its end */
  return CF_OK;
}
