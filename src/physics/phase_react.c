/* SPDX-License-Identifier: MIT
 *
 * The driving force in a row: f = eta (1 - eta)(eta - 1/2 + psi), or four times that with the psi of Karma and
 * Rappel, and what in it depends on the direction of the gradient.
 */
#include "physics/phase_part.h"
#include "stencil/arctan.h"

CF_CLONES void cf_phase_add_row(const int n, const cf_real weight, const cf_real *x, cf_real *y) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) y[i] += weight * x[i];
}

/* --- f ---------------------------------------------------------------------------------------------------- */

CF_KERNEL void atan_loop(const int directed, const int noisy, const int n, const cf_phase_react *f) {
  const cf_real half = (cf_real)0.5;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const cf_real e = f->eta[i], beta = directed ? f->beta[i] : 1, noise = noisy ? f->noise[i] : 0;
    const cf_real psi = noise - f->alpha_pi * cf_arctan(f->gamma * beta * f->T[i]);
    f->react[i] = e * (1 - e) * ((e - half) + psi);
  }
}

CF_CLONES static void atan_row(const int n, const cf_phase_react *f) {
  if (f->beta == NULL && f->noise == NULL)
    atan_loop(0, 0, n, f);
  else if (f->beta == NULL)
    atan_loop(0, 1, n, f);
  else if (f->noise == NULL)
    atan_loop(1, 0, n, f);
  else
    atan_loop(1, 1, n, f);
}

/* The same with T = H + K eta, and f' = (1 - 2 eta)(eta - 1/2 + psi) + eta (1 - eta)(1 + psi'). */
CF_KERNEL void atan_lean_loop(const int directed, const int noisy, const int n, const cf_phase_react *f) {
  const cf_real half = (cf_real)0.5;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const cf_real e = f->eta[i], steep = f->gamma * (directed ? f->beta[i] : 1);
    const cf_real y = steep * (f->T[i] + f->latent * e), bump = e * (1 - e);
    const cf_real psi = (noisy ? f->noise[i] : 0) - f->alpha_pi * cf_arctan(y);
    const cf_real bulk = (1 - 2 * e) * ((e - half) + psi) + bump;
    const cf_real slope = bulk - f->latent * (bump > 0 ? bump : 0) * (f->alpha_pi * steep / (1 + y * y));
    f->react[i] = bump * ((e - half) + psi);
    f->lean[i] = slope < 0 ? slope : 0;
  }
}

CF_CLONES static void atan_lean_row(const int n, const cf_phase_react *f) {
  if (f->beta == NULL && f->noise == NULL)
    atan_lean_loop(0, 0, n, f);
  else if (f->beta == NULL)
    atan_lean_loop(0, 1, n, f);
  else if (f->noise == NULL)
    atan_lean_loop(1, 0, n, f);
  else
    atan_lean_loop(1, 1, n, f);
}

CF_CLONES static void karma_row(const int n, const cf_phase_react *f) {
  const cf_real half = (cf_real)0.5;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const cf_real e = f->eta[i], bump = e * (1 - e), T = f->T[i];
    const cf_real psi = (f->noise != NULL ? f->noise[i] : 0) - 2 * f->coupling * T * bump;
    f->react[i] = 4 * bump * ((e - half) + psi);
  }
}

CF_CLONES static void karma_lean_row(const int n, const cf_phase_react *f) {
  const cf_real half = (cf_real)0.5;
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const cf_real e = f->eta[i], bump = e * (1 - e), T = f->T[i] + f->latent * e;
    const cf_real psi = (f->noise != NULL ? f->noise[i] : 0) - 2 * f->coupling * T * bump;
    const cf_real d_psi = -2 * f->coupling * (T * (1 - 2 * e) + f->latent * bump);
    const cf_real slope = 4 * ((1 - 2 * e) * ((e - half) + psi) + bump * (1 + d_psi));
    f->react[i] = 4 * bump * ((e - half) + psi);
    f->lean[i] = slope < 0 ? slope : 0;
  }
}

void cf_phase_react_row(const int n, const cf_phase_react *f) {
  if (f->karma && f->lean != NULL)
    karma_lean_row(n, f);
  else if (f->karma)
    karma_row(n, f);
  else if (f->lean != NULL)
    atan_lean_row(n, f);
  else
    atan_row(n, f);
}

/* --- the direction at a cell ------------------------------------------------------------------------------ */

typedef struct central {
  ptrdiff_t stride[3];
  const cf_real *eta, *e, *C, *S;
  const cf_anisotropy *law;
  cf_facing facing;
  cf_real star[3]; /* Gamma/(2 h) */
  cf_real *out;
} central;

CF_KERNEL cf_vec central_at(const int dim, const central *c, const ptrdiff_t p) {
  const ptrdiff_t *s = c->stride;
  return (cf_vec){c->star[0] * (c->eta[p + s[0]] - c->eta[p - s[0]]),
                  c->star[1] * (c->eta[p + s[1]] - c->eta[p - s[1]]),
                  dim == 3 ? c->star[2] * (c->eta[p + s[2]] - c->eta[p - s[2]]) : 0};
}

CF_KERNEL cf_facing facing_of(const int varies, const central *c, const ptrdiff_t p) {
  return varies ? (cf_facing){c->e[p], c->C[p], c->S[p]} : c->facing;
}

/* 1 - delta (1 - sum v_i^4/|v|^4), turned in the plane: sum = rho^4 (3 + cos 4 (theta - theta_0))/4 + v_z^4. Where
 * there is no gradient it does not matter, as f = 0 there. */
CF_KERNEL void beta_row(const int dim, const int varies, const int n, const central *c,
                        const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    const cf_vec v = central_at(dim, c, start + i);
    const cf_facing f = facing_of(varies, c, start + i);
    const cf_real xx = v.x * v.x, yy = v.y * v.y, zz = v.z * v.z, rho2 = (xx + yy) + (cf_real)1e-20;
    const cf_real u = (xx - yy) / rho2, w = 2 * (v.x * v.y) / rho2;
    const cf_real cosine = (u * u - w * w) * f.C + 2 * (u * w) * f.S, size2 = rho2 + zz;
    const cf_real flat = rho2 / size2, axis = zz / size2;
    c->out[i] = 1 - f.e * (1 - (flat * flat * (3 + cosine) / 4 + axis * axis));
  }
}
CF_CLONED_FORMS(beta_row, const central *, const ptrdiff_t)

CF_KERNEL void square_loop(const int dim, const int facets, const int varies, const int n, const central *c,
                           const ptrdiff_t start) {
  CF_ROW_LOOP
  for (int i = 0; i < n; ++i) {
    cf_vec B;
    const cf_real A = cf_anisotropy_at(dim, facets, c->law, facing_of(varies, c, start + i),
                                       central_at(dim, c, start + i), &B);
    c->out[i] = A * A;
  }
}

CF_KERNEL void square_row(const int dim, const int varies, const int n, const central *c,
                          const ptrdiff_t start) {
  switch (c->law->facets) {
    case CF_FACETS_NONE:
      square_loop(dim, CF_FACETS_NONE, varies, n, c, start);
      break;
    case CF_FACETS_FOUR:
      square_loop(dim, CF_FACETS_FOUR, varies, n, c, start);
      break;
    case CF_FACETS_SIX:
      square_loop(dim, CF_FACETS_SIX, varies, n, c, start);
      break;
    case CF_FACETS_CUBIC:
      square_loop(dim, CF_FACETS_CUBIC, varies, n, c, start);
      break;
    default:
      square_loop(dim, CF_FACETS_ANY, varies, n, c, start);
  }
}
CF_CLONED_FORMS(square_row, const central *, const ptrdiff_t)

static central central_of(const cf_phase *p, const cf_real *eta, cf_real *out) {
  central c = {
      .eta = eta, .e = p->places.strength.at, .C = p->places.C.at, .S = p->places.S.at, .law = &p->law};
  c.facing = (cf_facing){(cf_real)p->law.strength, (cf_real)p->law.C, (cf_real)p->law.S};
  c.out = out;
  for (int a = 0; a < p->grid->box.dim; ++a) {
    c.stride[a] = p->grid->box.stride[a];
    c.star[a] = (cf_real)((a == 2 ? p->p.star : 1) / (2 * p->grid->h));
  }
  return c;
}

void cf_phase_beta_row(const cf_phase *p, const int n, const cf_real *eta, const ptrdiff_t start,
                       cf_real *beta) {
  central c = central_of(p, eta, beta);
  if (c.e == NULL)
    c.facing = (cf_facing){(cf_real)p->p.drive_strength, (cf_real)p->drive_C, (cf_real)p->drive_S};
  beta_row_by_form(p->grid->box.dim, c.e != NULL, n, &c, start);
}

void cf_phase_A2_row(const cf_phase *p, const int n, const cf_real *eta, const ptrdiff_t start, cf_real *A2) {
  const central c = central_of(p, eta, A2);
  square_row_by_form(p->grid->box.dim, c.e != NULL, n, &c, start);
}

cf_phase_react cf_phase_react_of(const cf_phase *p, const cf_phase_rows *rows, const int n,
                                 const cf_real *eta, const ptrdiff_t start) {
  cf_phase_react f = {.eta = eta + start, .react = rows->react, .karma = p->p.karma_rappel};
  f.gamma = (cf_real)p->p.gamma;
  f.alpha_pi = (cf_real)(p->p.alpha / 3.14159265358979323846);
  f.latent = (cf_real)p->p.latent;
  f.coupling = (cf_real)p->p.coupling;
  if (p->places.noise.at != NULL) f.noise = p->places.noise.at + start;
  if (p->p.drive_strength == 0) return f;
  cf_phase_beta_row(p, n, eta, start, rows->beta);
  f.beta = rows->beta;
  return f;
}
