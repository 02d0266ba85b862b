/* SPDX-License-Identifier: MIT
 *
 * What diffusion with memory does in a flow, in a few numbers: k (m^2/s), relaxation time tau (s), Fourier share
 * F in [0, 1], speed of the medium U (m/s).
 *
 *   c     = sqrt((1 - F) k/tau)          speed of fronts
 *   H_c   = U/c                          below 1 fronts run upstream, above 1 they stay in a cone
 *   alpha = asin(1/H_c)                  half-angle of the cone behind a point source
 *   L_c   = 2 tau U (1 - 1/H_c^2)        how far behind the source the cone's edge is seen (F = 0)
 *   K     waves exist between K_lo and K_hi = (1 -+ sqrt(1 - F))/(F sqrt(tau k)); their phase speed is largest at
 *         K* = 1/sqrt(F tau k), where it is c
 *   b     = sqrt(F k tau) = 1/K*         length over which fronts are blurred
 *
 * For 0 < F < 1 some influence is everywhere at once and c is the speed of the visible front. Without memory
 * (tau = 0, whatever F, or F = 1) there are no waves at all.
 *
 * One implicit stage of length delta turns the two equations into (1 - div beta k grad) phi = ...; with
 * sigma = beta k/h^2 it tells how hard the system is.
 */
#ifndef CF_STENCIL_REGIME_H
#define CF_STENCIL_REGIME_H

#include <math.h>

/* name, word, what it means */
#define CF_REGIME_LIST(R)                                                       \
  R(STILL, "no diffusion", "k = 0: things only move with the medium")           \
  R(FOURIER, "Fourier", "no memory: no fronts, influence everywhere at once")   \
  R(SUBCRITICAL, "sub-critical", "fronts outrun the medium and reach upstream") \
  R(CRITICAL, "critical", "fronts stand still against the medium")              \
  R(SUPERCRITICAL, "super-critical", "fronts stay inside a cone behind the source")

typedef enum cf_regime {
#define CF_REGIME_ENUM(name, word, meaning) CF_REGIME_##name,
  CF_REGIME_LIST(CF_REGIME_ENUM)
#undef CF_REGIME_ENUM
} cf_regime;

static inline const char *cf_regime_word(const cf_regime regime) {
  static const char *const words[] = {
#define CF_REGIME_WORD(name, word, meaning) word,
      CF_REGIME_LIST(CF_REGIME_WORD)
#undef CF_REGIME_WORD
  };
  return words[regime];
}

/* c. Infinite for tau = 0; 0 for F = 1 or k = 0. */
static inline double cf_regime_speed(const double k, const double tau, const double f) {
  const double carried = (1 - f) * k;
  if (!(carried > 0)) return 0;
  return tau > 0 ? sqrt(carried / tau) : (double)INFINITY;
}

/* H_c. 0 where c is infinite or nothing moves; infinite where c = 0 and something does. */
static inline double cf_regime_number(const double speed, const double c) {
  const double u = fabs(speed);
  if (!(u > 0) || isinf(c)) return 0;
  return c > 0 ? u / c : (double)INFINITY;
}

/* alpha in radians; pi/2 at H_c = 1, NaN below, where there is no cone; 0 for an infinite H_c. */
static inline double cf_regime_cone_angle(const double h_c) { return h_c < 1 ? (double)NAN : asin(1 / h_c); }

/* L_c in m; 0 where there is no cone. */
static inline double cf_regime_cone_length(const double speed, const double tau, const double h_c) {
  return h_c > 1 ? 2 * tau * fabs(speed) * (1 - 1 / (h_c * h_c)) : 0;
}

/* The wave numbers (1/m) that oscillate, and the one whose phase speed is c. For F = 0 the band has no upper end
 * and the fastest wave is infinitely short; without waves low = high = peak = infinity. */
typedef struct cf_wave_band {
  double low, high, peak;
} cf_wave_band;

static inline cf_wave_band cf_regime_wave_band(const double k, const double tau, const double f) {
  const double infinite = (double)INFINITY, length = sqrt(tau * k);
  if (!(length > 0) || f >= 1) return (cf_wave_band){infinite, infinite, infinite};
  const double more = 1 + sqrt(1 - f); /* (1 - sqrt(1 - F))/F = 1/more, also for F -> 0 */
  const cf_wave_band band = {1 / (more * length), f > 0 ? more / (f * length) : infinite,
                             f > 0 ? 1 / (sqrt(f) * length) : infinite};
  return band;
}

/* b in m. */
static inline double cf_regime_blur(const double k, const double tau, const double f) {
  return sqrt(f * k * tau);
}

/* Within one part in a million of H_c = 1 counts as critical. */
static inline cf_regime cf_regime_of(const double k, const double tau, const double f, const double speed) {
  if (!(k > 0)) return CF_REGIME_STILL;
  if (!(tau > 0) || f >= 1) return CF_REGIME_FOURIER;
  const double h_c = cf_regime_number(speed, cf_regime_speed(k, tau, f));
  if (fabs(h_c - 1) < 1e-6) return CF_REGIME_CRITICAL;
  return h_c < 1 ? CF_REGIME_SUBCRITICAL : CF_REGIME_SUPERCRITICAL;
}

/* beta/k of a stage of length delta: delta (delta + F tau)/(tau + delta), in s. Between delta^2/tau (waves) and
 * delta (Fourier). */
static inline double cf_regime_stage(const double delta, const double tau, const double f) {
  if (!(delta > 0)) return 0;
  return isinf(tau) ? delta * f : delta * (delta + f * tau) / (tau + delta);
}

/* sigma = beta k/h^2 of that stage. */
static inline double cf_regime_sigma(const double stage, const double k, const double h) {
  return stage * k / (h * h);
}

#endif
