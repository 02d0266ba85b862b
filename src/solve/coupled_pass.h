/* SPDX-License-Identifier: MIT
 *
 * A list of stages over a level of couplings, all done in one sweep through memory (lean.h): what is between two visits to
 * the levels around it. Along periodic axes, where a stage needs what the other end of the axis has become, it goes stage by
 * stage.
 */
#ifndef CF_SOLVE_COUPLED_PASS_H
#define CF_SOLVE_COUPLED_PASS_H

#include "solve/coupled.h"

typedef enum cf_coupled_stage {
  CF_STAGE_NONE,
  CF_STAGE_FIRST,  /* e of a colour from its r, 0 elsewhere */
  CF_STAGE_HALF,   /* a half sweep */
  CF_STAGE_BAND,   /* the same over rows of the band */
  CF_STAGE_REST,   /* rest = r - A e */
  CF_STAGE_SUM,    /* coarse->r = sums of r - A e, which goes nowhere else; not for a level that has odds */
  CF_STAGE_SPREAD, /* e += interpolated coarse->e; as above */
  CF_STAGE_OWN     /* what `own` does to a run of row (j, k); it may read e of cells around */
} cf_coupled_stage;

#define CF_STAGES_MAX 32

typedef struct cf_coupled_pass {
  const cf_coupled *l, *coarse;
  int count;
  struct {
    cf_coupled_stage kind;
    int colour;
    float omega;
  } stage[CF_STAGES_MAX];
  void (*own)(const void *of, const cf_run *run, int j, int k);
  const void *of;
  ptrdiff_t own_bytes; /* of a cell, that `own` visits besides the level's */
} cf_coupled_pass;

static inline void cf_pass_add(cf_coupled_pass *s, const cf_coupled_stage kind, const int colour,
                               const float omega) {
  if (s->count == CF_STAGES_MAX) return;
  s->stage[s->count].kind = kind;
  s->stage[s->count].colour = colour;
  s->stage[s->count++].omega = omega;
}

/* Half sweeps, the colours in turn from `colour` on. */
static inline void cf_pass_add_halves(cf_coupled_pass *s, const int count, const int colour,
                                      const float omega) {
  for (int v = 0; v < count; ++v) cf_pass_add(s, CF_STAGE_HALF, (colour + v) % 2, omega);
}

/* Stages are done in their order; `back`: where they go stage by stage, cells in the opposite order. */
void cf_coupled_run(const cf_coupled_pass *s, bool back);

#endif
