/* SPDX-License-Identifier: MIT
 *
 * Half sweeps of red-black Gauss-Seidel.
 */
#include <string.h>

#include "solve/stages_part.h"

CF_KERNEL void first(const int dim, const cf_split *s, const cf_strip *t, const float omega) {
  CF_FOR_ROWS(j, t) {
    const cf_half red = cf_half_of(dim, s, j, t->k, 0);
    cf_first_half(s, &red, t, omega);
  }
}
CF_CLONES static void first_2d(const cf_split *s, const cf_strip *t, const float omega) {
  first(2, s, t, omega);
}
CF_CLONES static void first_3d(const cf_split *s, const cf_strip *t, const float omega) {
  first(3, s, t, omega);
}

void cf_stage_first(const cf_split *s, const cf_strip *t, const float omega) {
  (s->dim == 3 ? first_3d : first_2d)(s, t, omega);
}

/* What a half sweep makes of the half's old e. AGAIN: (1 - omega) of it stays; ANEW: omega is 1, and it need not be there;
 * SECOND: the same, as it counts as 0, and so do the images of the other half's cells behind the walls. */
enum { AGAIN, ANEW, SECOND, WAYS };

CF_KERNEL void relax(const int dim, const int even, const int way, const cf_split *s, const cf_strip *t,
                     const int colour, const float omega) {
  const float keep = 1 - omega;
  CF_FOR_ROWS(j, t) {
    const cf_half h = cf_half_of(dim, s, j, t->k, colour);
    if (way == SECOND) {
      const cf_half other = cf_half_of(dim, s, j, t->k, 1 - colour);
      cf_half_set_images(s, t, &other, 0);
    }
    CF_FOR_PIECE(m, t) {
      const float e = h.inverse[m] * (h.r[m] + cf_around(dim, even, &h, m));
      h.e[m] = way == ANEW ? e : way == SECOND ? omega * e : keep * h.e[m] + omega * e;
    }
    cf_half_join(s, t, &h);
  }
}

typedef void half_sweep(const cf_split *s, const cf_strip *t, int colour, float omega);

#define HALF_SWEEP(name, dim, even, way)                                                                  \
  CF_CLONES static void name(const cf_split *s, const cf_strip *t, const int colour, const float omega) { \
    relax(dim, even, way, s, t, colour, omega);                                                           \
  }
HALF_SWEEP(again_2d_uneven, 2, 0, AGAIN)
HALF_SWEEP(again_2d_even, 2, 1, AGAIN)
HALF_SWEEP(again_3d_uneven, 3, 0, AGAIN)
HALF_SWEEP(again_3d_even, 3, 1, AGAIN)
HALF_SWEEP(anew_2d_uneven, 2, 0, ANEW)
HALF_SWEEP(anew_2d_even, 2, 1, ANEW)
HALF_SWEEP(anew_3d_uneven, 3, 0, ANEW)
HALF_SWEEP(anew_3d_even, 3, 1, ANEW)
HALF_SWEEP(second_2d_uneven, 2, 0, SECOND)
HALF_SWEEP(second_2d_even, 2, 1, SECOND)
HALF_SWEEP(second_3d_uneven, 3, 0, SECOND)
HALF_SWEEP(second_3d_even, 3, 1, SECOND)

static half_sweep *const by_form[WAYS][2][2] = {
    {{again_2d_uneven, again_2d_even}, {again_3d_uneven, again_3d_even}},
    {{anew_2d_uneven, anew_2d_even}, {anew_3d_uneven, anew_3d_even}},
    {{second_2d_uneven, second_2d_even}, {second_3d_uneven, second_3d_even}}};

void cf_stage_relax(const cf_split *s, const cf_strip *t, const int colour, const float omega) {
  by_form[omega == 1 ? ANEW : AGAIN][s->dim - 2][s->even_couplings](s, t, colour, omega);
}

void cf_stage_second(const cf_split *s, const cf_strip *t, const float omega) {
  by_form[SECOND][s->dim - 2][s->even_couplings](s, t, 1, omega);
}

void cf_stage_clear(const cf_split *s, const cf_strip *t) {
  CF_FOR_ROWS(j, t)
  for (int parity = 0; parity < 2; ++parity)
    memset(s->e + j * s->row + t->k * s->plane + parity * s->odd + t->from, 0,
           (size_t)(t->to - t->from) * sizeof(float));
}
