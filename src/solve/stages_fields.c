/* SPDX-License-Identifier: MIT
 *
 * The stages of stages.h on a level whose coefficients are fields (fields.h), above levels of couplings in natural order.
 */
#include "solve/fields.h"
#include "solve/stages_apply.h"

/* --- halves ------------------------------------------------------------------------------------------- */

/* One half of a row, as cf_half; couplings of the low and of the high face along each axis. */
typedef struct half {
  float *e, *r;
  const float *side, *low[3], *high[3], *inverse, *fixed;
  ptrdiff_t down[3], up[3];
  int parity;
} half;

CF_KERNEL half half_of(const int dim, const cf_split *s, const int j, const int k, const int colour) {
  const cf_fields *f = s->fields;
  const int parity = (j + k + colour) & 1;
  const ptrdiff_t row = j * s->row + k * s->plane, at = row + (parity ? s->odd : 0);
  half h = {.e = s->e + at,
            .r = s->r + at,
            .side = s->e + row + (parity ? 0 : s->odd - 1),
            .low = {f->c[0] + at},
            .high = {f->c[0] + row + (parity ? 1 : s->odd)},
            .inverse = f->inverse + at,
            .fixed = f->fixed + (f->is_even ? at - row : at),
            .parity = parity};
  for (int a = 1; a < dim; ++a) {
    const ptrdiff_t stride = a == 1 ? s->row : s->plane;
    h.down[a] = cf_step_down(s, a, a == 1 ? j : k, stride);
    h.up[a] = cf_step_up(s, a, a == 1 ? j : k, stride);
    h.low[a] = f->c[a] + at;
    h.high[a] = f->c[a] + at + h.up[a];
  }
  return h;
}

/* cf_half_join. */
CF_KERNEL void join(const cf_split *s, const cf_strip *t, const half *h) {
  if (!s->wraps[0]) return;
  if (h->parity == 1 && t->to == s->width) h->e[-1] = h->e[s->half[1] - 1];
  if (h->parity == 0 && (t->from == 0 || t->to == s->width)) h->e[s->half[0]] = h->e[0];
}

/* The padding has heard of what lies across a seam. */
CF_KERNEL void clear_pad(const cf_split *s, const cf_strip *t, const half *h) {
  if (t->to == s->width && s->half[h->parity] < s->width) h->r[s->half[h->parity]] = 0;
}

CF_KERNEL float around(const int dim, const half *h, const int m) {
  const float *e = h->e + m, *side = h->side + m;
  float sum = h->low[0][m] * side[0] + h->high[0][m] * side[1];
  sum += h->low[1][m] * e[h->down[1]] + h->high[1][m] * e[h->up[1]];
  if (dim == 3) sum += h->low[2][m] * e[h->down[2]] + h->high[2][m] * e[h->up[2]];
  return sum;
}

/* A e from differences, which are exact where e is smooth, and the diagonal. */
CF_KERNEL float applied(const int dim, const half *h, const int m, float *diagonal) {
  const float *e = h->e + m, *side = h->side + m, c = e[0], fixed = h->fixed[m];
  float sum = h->low[0][m] * (c - side[0]) - h->high[0][m] * (side[1] - c);
  float all = h->low[0][m] + h->high[0][m];
  sum += h->low[1][m] * (c - e[h->down[1]]) - h->high[1][m] * (e[h->up[1]] - c);
  all += h->low[1][m] + h->high[1][m];
  if (dim == 3) {
    sum += h->low[2][m] * (c - e[h->down[2]]) - h->high[2][m] * (e[h->up[2]] - c);
    all += h->low[2][m] + h->high[2][m];
  }
  *diagonal = fixed + all;
  return fixed * c + sum;
}

/* A cell is over-relaxed by what couplings have of its diagonal, if alpha holds any much (form 1). */
CF_KERNEL float over_of(const int form, const half *h, const int m, const float over) {
  const float share = form ? 1 - h->fixed[m] * h->inverse[m] : 1;
  return form ? over * share * share : over;
}

/* --- half sweeps -------------------------------------------------------------------------------------- */

CF_KERNEL void start_half(const int form, const half *of, const cf_strip *t, const float omega) {
  const half h = *of;
  CF_FOR_PIECE(m, t) h.e[m] = (1 + over_of(form, &h, m, omega - 1)) * (h.inverse[m] * h.r[m]);
}

CF_KERNEL void first(const int dim, const int form, const cf_pass *p, const cf_strip *t, const float omega) {
  CF_FOR_ROWS(j, t) {
    const half h = half_of(dim, p->at, j, t->k, 0);
    start_half(form, &h, t, omega);
    join(p->at, t, &h);
  }
}

/* fresh: what e was counts as 0. */
CF_KERNEL void relax(const int dim, const int form, const bool fresh, const cf_pass *p, const cf_strip *t,
                     const int colour, const float omega) {
  CF_FOR_ROWS(j, t) {
    const half h = half_of(dim, p->at, j, t->k, colour);
    CF_FOR_PIECE(m, t) {
      const float over = over_of(form, &h, m, omega - 1);
      const float e = h.inverse[m] * (h.r[m] + around(dim, &h, m));
      h.e[m] = fresh ? (1 + over) * e : (1 + over) * e - over * h.e[m];
    }
    join(p->at, t, &h);
  }
}

CF_KERNEL void second(const int dim, const int form, const cf_pass *p, const cf_strip *t, const float omega) {
  relax(dim, form, true, p, t, 1, omega);
}
CF_KERNEL void red(const int dim, const int form, const cf_pass *p, const cf_strip *t, const float omega) {
  relax(dim, form, false, p, t, 0, omega);
}
CF_KERNEL void black(const int dim, const int form, const cf_pass *p, const cf_strip *t, const float omega) {
  relax(dim, form, false, p, t, 1, omega);
}

/* --- the end of a cycle ------------------------------------------------------------------------------- */

CF_KERNEL void last(const int dim, const int form, const cf_pass *p, const cf_strip *t, const float omega) {
  CF_FOR_ROWS(j, t) {
    const half h = half_of(dim, p->at, j, t->k, 1);
    CF_FOR_PIECE(m, t) {
      float diagonal;
      const float residual = h.r[m] - applied(dim, &h, m, &diagonal), old = h.e[m];
      const float fresh = old + (1 + over_of(form, &h, m, omega - 1)) * (h.inverse[m] * residual);
      h.r[m] = residual - diagonal * (fresh - old);
      h.e[m] = fresh;
    }
    clear_pad(p->at, t, &h);
    join(p->at, t, &h);
  }
}

CF_KERNEL void add_row(const cf_pass *p, const cf_strip *t, const int j) {
  const cf_split *s = p->at;
  const ptrdiff_t at = j * s->row + t->k * s->plane + t->from;
  const int n = cf_natural_count(s, t);
  if (t->next_k >= 0) cf_fetch_x(p, t, j);
  cf_real *x = p->x + cf_box_at(&s->plain->box, 2 * t->from, j, t->k);
  if (p->keep != NULL) memcpy(p->keep + (x - p->x), x, (size_t)n * sizeof *x);
  cf_add_woven(n, p->gain, 0, s->e + at, s->e + at + s->odd, x);
  double *sums = cf_sums_of(p, t, j);
  if (p->sums_of_x) cf_sum_row(n, x, &sums[CF_SUM_X * p->sums], &sums[CF_SUM_X2 * p->sums]);
}

CF_KERNEL void add(const int dim, const int form, const cf_pass *p, const cf_strip *t, const float omega) {
  (void)dim, (void)form, (void)omega;
  CF_FOR_ROWS(j, t) add_row(p, t, j);
}

CF_KERNEL void update(const int dim, const int form, const cf_pass *p, const cf_strip *t, const float omega) {
  const cf_split *s = p->at;
  CF_FOR_ROWS(j, t) {
    const half h = half_of(dim, s, j, t->k, 0);
    const ptrdiff_t at = j * s->row + t->k * s->plane + t->from;
    add_row(p, t, j);
    CF_FOR_PIECE(m, t) {
      float diagonal;
      const float r = h.r[m] - applied(dim, &h, m, &diagonal);
      h.r[m] = r;
      h.e[m] = (1 + over_of(form, &h, m, omega - 1)) * (h.inverse[m] * r);
    }
    clear_pad(s, t, &h);
    join(s, t, &h);
    cf_sums_of(p, t, j)[CF_SUM_RESIDUAL * p->sums] =
        cf_squares(t->to - t->from, s->r + at, s->r + at + s->odd);
  }
}

/* --- between levels ----------------------------------------------------------------------------------- */

/* What a fine row leaves to the coarse row above it; of both colours, or of the red one where the last half sweep has left the
 * black one nothing. */
CF_KERNEL void gather(const int dim, const bool red_alone, const bool fresh, const cf_split *s,
                      const cf_strip *t, const int j, const int k, float *to) {
  const half h = half_of(dim, s, j, k, 0), g = half_of(dim, s, j, k, 1);
  CF_FOR_PIECE(m, t) {
    float diagonal, rest = h.r[m] - applied(dim, &h, m, &diagonal);
    if (!red_alone) rest += g.r[m] - applied(dim, &g, m, &diagonal);
    to[m] = fresh ? rest : to[m] + rest;
  }
}

/* Rows come in pairs, planes too; the last one of them finds all ready. */
CF_KERNEL void restrict_rows(const int dim, const bool red_alone, const cf_pass *p, const cf_strip *t) {
  const cf_split *s = p->at;
  if (dim == 3 && t->k % 2 == 0) return;
  CF_FOR_ROWS(j, t) {
    if (j % 2 == 0) continue;
    float *to = t->scratch; /* a coarse row has no room for padding */
    for (int k = dim == 3 ? t->k - 1 : t->k; k <= t->k; ++k)
      for (int row = j - 1; row <= j; ++row) {
        if (row < j && k < t->k + (dim == 2))
          gather(dim, red_alone, true, s, t, row, k, to);
        else
          gather(dim, red_alone, false, s, t, row, k, to);
      }
    memcpy(p->below->r + cf_box_at(&p->below->box, t->from, j / 2, t->k / 2), to + t->from,
           (size_t)(CF_MIN(t->to, s->half[1]) - t->from) * sizeof *to);
  }
}
CF_KERNEL void restrict_both(const int dim, const int form, const cf_pass *p, const cf_strip *t,
                             const float omega) {
  (void)form, (void)omega;
  restrict_rows(dim, false, p, t);
}
CF_KERNEL void restrict_red(const int dim, const int form, const cf_pass *p, const cf_strip *t,
                            const float omega) {
  (void)form, (void)omega;
  restrict_rows(dim, true, p, t);
}

/* e of a half += what the coarse row and its neighbours say; `beyond`: the coarse cell before those of even ones, after those of odd
 * ones. Cells that alpha holds take no correction (coupled_transfer.c). */
CF_KERNEL void spread_half(const int dim, const int form, const cf_split *s, const cf_strip *t,
                           const half *of, const ptrdiff_t at, const float *const row[3]) {
  const half h = *of;
  const cf_fields *f = s->fields;
  const unsigned char *w_x = f->weight[0] + at, *w_y = f->weight[1] + at,
                      *w_z = dim == 3 ? f->weight[2] + at : NULL;
  const float *own = row[0], *beyond = own + (h.parity ? 1 : -1), *y = row[1], *z = row[2];
  const cf_sixteen unit = (cf_sixteen){0} + 1.0f / 256;
  for (int m = t->from; m < t->to; m += CF_SPLIT_LANES) {
    const cf_sixteen here = CF_SIXTEEN_OF(own + m);
    cf_sixteen sum = __builtin_convertvector(CF_SIXTEEN_OF_BYTES(w_x + m), cf_sixteen) *
                     (CF_SIXTEEN_OF(beyond + m) - here);
    sum += __builtin_convertvector(CF_SIXTEEN_OF_BYTES(w_y + m), cf_sixteen) * (CF_SIXTEEN_OF(y + m) - here);
    if (dim == 3)
      sum +=
          __builtin_convertvector(CF_SIXTEEN_OF_BYTES(w_z + m), cf_sixteen) * (CF_SIXTEEN_OF(z + m) - here);
    const cf_sixteen e = CF_SIXTEEN_OF(h.e + m) + (here + unit * sum);
    *(cf_sixteen_floats *)(h.e + m) = e;
  }
  if (form) {
    CF_FOR_PIECE(m, t) h.e[m] = h.fixed[m] * h.inverse[m] > 0.99f ? h.inverse[m] * h.r[m] : h.e[m];
  }
  for (int m = CF_MAX(t->from, s->half[h.parity]); m < t->to; ++m) h.e[m] = 0;
}

CF_KERNEL void prolong(const int dim, const int form, const cf_pass *p, const cf_strip *t,
                       const float omega) {
  (void)omega;
  const cf_split *s = p->at;
  const cf_box *b = &p->below->box;
  CF_FOR_ROWS(j, t) {
    const float *own = p->below->e + cf_box_at(b, 0, j / 2, t->k / 2);
    const float *const row[3] = {own, own + (j % 2 == 0 ? -1 : 1) * b->stride[1],
                                 dim == 3 ? own + (t->k % 2 == 0 ? -1 : 1) * b->stride[2] : NULL};
    for (int colour = 0; colour < 2; ++colour) {
      const half h = half_of(dim, s, j, t->k, colour);
      spread_half(dim, form, s, t, &h, h.e - s->e, row);
      join(s, t, &h);
    }
  }
}

/* --- which way ---------------------------------------------------------------------------------------- */

typedef void stage(const cf_pass *p, const cf_strip *t, float omega);

#define STAGE(name, dim, form)                                                                          \
  CF_CLONES static void name##_##dim##_##form(const cf_pass *p, const cf_strip *t, const float omega) { \
    name(dim, form, p, t, omega);                                                                       \
  }
#define STAGES(name) \
  STAGE(name, 2, 0)  \
  STAGE(name, 2, 1)  \
  STAGE(name, 3, 0)  \
  STAGE(name, 3, 1)  \
  static stage *const name##_by[2][2] = {{name##_2_0, name##_2_1}, {name##_3_0, name##_3_1}};
STAGES(first)
STAGES(second)
STAGES(red)
STAGES(black)
STAGES(last)
STAGES(add)
STAGES(update)
STAGES(restrict_both)
STAGES(restrict_red)
STAGES(prolong)

/* --- fetching ahead ------------------------------------------------------------------------------------- */

/* What the same stage will be the first to touch in the next plane: its lowest row, or all of them where it is the first stage.
 * It asks for couplings to the plane after that as well, and for e around. */
static void fetch_row(const cf_split *s, const int j, const int k) {
  const cf_fields *f = s->fields;
  const ptrdiff_t at = j * s->row + k * s->plane;
  const float *of[] = {f->c[0] + at, f->c[1] + at,         f->c[2] + at + s->plane, f->inverse + at,
                       s->r + at,    s->e + at + s->plane, s->e + at - s->row};
  for (ptrdiff_t m = 0; m < s->row; m += CF_ALIGN / (int)sizeof(float))
    for (int v = 0; v < 7; ++v) __builtin_prefetch(of[v] + m, 0, 2);
}

static void fetch(const cf_split *s, const int number, const cf_strip *t) {
  if (t->next_k < 0 || t->next_k == t->k || t->next_k + 1 >= s->n[2]) return;
  const int rows = number == 0 ? t->end - t->j : 1;
  for (int j = t->next_j; j < t->next_j + rows; ++j) fetch_row(s, j, t->next_k);
}

void cf_stage_on_fields(const cf_pass *p, const int number, const cf_strip *t, const float omega) {
  const int dim = p->at->dim - 2, form = p->at->fields->is_gentle;
  fetch(p->at, number, t);
  switch (p->stage[number]) {
    case CF_PASS_FORM:
      cf_stage_form_on_fields(p, t);
      first_by[dim][form](p, t, omega);
      break;
    case CF_PASS_FIRST:
      first_by[dim][form](p, t, omega);
      break;
    case CF_PASS_SECOND:
      second_by[dim][form](p, t, omega);
      break;
    case CF_PASS_RED:
      red_by[dim][form](p, t, omega);
      break;
    case CF_PASS_BLACK:
      black_by[dim][form](p, t, omega);
      break;
    case CF_PASS_LAST:
      last_by[dim][form](p, t, omega);
      break;
    case CF_PASS_ADD:
      add_by[dim][form](p, t, omega);
      break;
    case CF_PASS_UPDATE:
      update_by[dim][form](p, t, omega);
      break;
    case CF_PASS_RESTRICT:
      restrict_both_by[dim][form](p, t, omega);
      break;
    case CF_PASS_RESTRICT_RED:
      restrict_red_by[dim][form](p, t, omega);
      break;
    case CF_PASS_PROLONG:
      prolong_by[dim][form](p, t, omega);
      break;
    default: /* what segments and odd seams ask for */
      break;
  }
}
