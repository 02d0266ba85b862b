/* SPDX-License-Identifier: MIT
 *
 * From any sufficient set of keys to k, tau and F; see scene_params.h. The unknowns are D, tau and F, or c in the
 * place of one of them; F is given, or follows from the blur, b^2 = F D tau, that is F = b^2/(b^2 + c^2 tau^2).
 * Two equations remain, and each pair of keys solves them in closed form. Where a blur and k leave two solutions
 * the one with less of Fourier's law is taken.
 */
#include "model/scene_params.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/real.h"
#include "io/scene.h"
#include "stencil/regime.h"

enum { KEY_MAX = 160 };
#define AGREE 1e-6 /* relative */

static const double pi = 3.14159265358979323846;

/* R/(c tau), and t_s D/L^2. */
static double reach_factor(void) { return 2 * log(20.0); }
static double saturation_factor(void) { return 4 * log(160 / (pi * pi)) / (pi * pi); }

/* What the keys say, by the quantity they fix; NULL: no key does. */
typedef enum quantity { D, TAU, SPEED, REACH, LENGTH, QUANTITIES } quantity;

typedef struct known {
  cf_scene *scene;
  const char *path;
  cf_scene_diffusion *d;
  const char *key[QUANTITIES];
  double value[QUANTITIES];
  bool blurred;
  double f_t, blur, capacity, wind;
} known;

typedef struct answer {
  double D, tau, c, f_t;
} answer;

static const char *const units[QUANTITIES] = {"m^2/s", "s", "m/s", "m", "m"};

static cf_status fail_at(const known *w, const char *name, const char *sentence) {
  char key[KEY_MAX];
  snprintf(key, sizeof key, "%s.%s", w->path, name);
  return cf_scene_fail_at(w->scene, key, "%s %s", key, sentence);
}

/* --- what the keys say -------------------------------------------------------------------------------------- */

static bool agree(const double a, const double b) { return fabs(a - b) <= AGREE * CF_MAX(fabs(a), fabs(b)); }

/* Two keys for one quantity must say the same. */
static cf_status take(known *w, const quantity q, const char *key, const double value) {
  char sentence[256];
  if (w->key[q] != NULL && !agree(w->value[q], value)) {
    snprintf(sentence, sizeof sentence, "contradicts %s.%s: they give %.6g and %.6g %s", w->path, w->key[q],
             value, w->value[q], units[q]);
    return fail_at(w, key, sentence);
  }
  if (w->key[q] == NULL) {
    w->key[q] = key;
    w->value[q] = value;
  }
  return CF_OK;
}

/* |u| of a uniform flow; NaN of another. */
static double uniform_speed(const cf_scene *scene) {
  double sum = 0;
  for (int a = 0; a < CF_MIN(scene->velocity.count, scene->dim); ++a) {
    const cf_fn *u = &scene->velocity.axis[a].fn;
    if (!cf_fn_is_constant(u)) return (double)NAN;
    sum += u->value * u->value;
  }
  return sqrt(sum);
}

static cf_status find_wind(known *w) {
  const cf_scene_diffusion *d = w->d;
  const char *user = d->given.cone_angle ? "cone_angle" : "visible_length";
  const double flow = uniform_speed(w->scene);
  char sentence[160];
  if (!d->given.cone_angle && !d->given.visible_length)
    return d->given.wind ? fail_at(w, "wind", "goes with cone_angle or visible_length") : CF_OK;
  w->wind = d->given.wind ? d->wind : flow;
  if (d->given.wind && flow > 0 && !agree(flow, d->wind)) {
    snprintf(sentence, sizeof sentence, "contradicts velocity, whose speed is %.6g m/s", flow);
    return fail_at(w, "wind", sentence);
  }
  if (isnan(w->wind))
    return fail_at(w, user, "needs `wind` beside it: the velocity is not the same everywhere");
  if (!(w->wind > 0)) return fail_at(w, user, "needs a wind: a `velocity`, or `wind` beside it");
  return CF_OK;
}

static cf_status take_slab(known *w) {
  const cf_scene_diffusion *d = w->d;
  const bool used = d->given.arrival || d->given.saturation;
  if (d->given.thickness && !used) return fail_at(w, "thickness", "goes with arrival or saturation");
  if (used && !d->given.thickness)
    return fail_at(w, d->given.arrival ? "arrival" : "saturation", "needs `thickness` beside it");
  if (d->given.arrival) CF_TRY(take(w, SPEED, "arrival", d->thickness / d->arrival));
  if (d->given.saturation)
    CF_TRY(take(w, D, "saturation", saturation_factor() * d->thickness * d->thickness / d->saturation));
  return CF_OK;
}

static cf_status take_all(known *w) {
  const cf_scene_diffusion *d = w->d;
  CF_TRY(find_wind(w));
  if (d->given.k) CF_TRY(take(w, D, "k", d->k.fn.value / w->capacity));
  if (d->given.tau) CF_TRY(take(w, TAU, "tau", d->tau));
  if (d->given.front_speed) CF_TRY(take(w, SPEED, "front_speed", d->front_speed));
  if (d->given.cone_angle) CF_TRY(take(w, SPEED, "cone_angle", w->wind * sin(d->cone_angle * pi / 180)));
  CF_TRY(take_slab(w));
  if (d->given.reach) CF_TRY(take(w, REACH, "reach", d->reach));
  if (d->given.visible_length) CF_TRY(take(w, LENGTH, "visible_length", d->visible_length));
  w->blurred = d->given.blur && !d->given.f_t;
  w->f_t = d->f_t;
  w->blur = d->given.blur ? d->blur : 0;
  return CF_OK;
}

/* --- pairs -------------------------------------------------------------------------------------------------- */

/* Speed and tau from a pair without D. */
static void from_pair(const known *w, const unsigned pair, answer *x) {
  const double *v = w->value, U = w->wind, p = v[REACH] / reach_factor();
  x->c = v[SPEED];
  x->tau = v[TAU];
  if (pair == (1u << TAU | 1u << REACH)) x->c = p / x->tau;
  if (pair == (1u << SPEED | 1u << REACH)) x->tau = p / x->c;
  if (pair == (1u << TAU | 1u << LENGTH)) x->c = U * sqrt(1 - v[LENGTH] / (2 * x->tau * U));
  if (pair == (1u << SPEED | 1u << LENGTH)) x->tau = v[LENGTH] / (2 * U * (1 - x->c * x->c / (U * U)));
  if (pair == (1u << REACH | 1u << LENGTH)) {
    x->tau = (v[LENGTH] + sqrt(v[LENGTH] * v[LENGTH] + 16 * p * p)) / (4 * U);
    x->c = p / x->tau;
  }
  const double b2 = w->blur * w->blur, p2 = x->c * x->c * x->tau * x->tau;
  x->f_t = w->blurred ? b2 / (b2 + p2) : w->f_t;
  x->D = x->c * x->c * x->tau / (1 - x->f_t);
}

/* tau and F from D and another. */
static void with_diffusivity(const known *w, const quantity other, answer *x) {
  const double *v = w->value, U = w->wind, b2 = w->blur * w->blur, p = v[REACH] / reach_factor();
  x->D = v[D];
  x->tau = v[TAU];
  x->f_t = w->f_t;
  if (other == REACH) {
    if (w->blurred) x->f_t = b2 / (b2 + p * p);
    x->c = (1 - x->f_t) * x->D / p;
    x->tau = p / x->c;
    return;
  }
  if (other == SPEED) {
    const double c2 = v[SPEED] * v[SPEED];
    x->tau = w->blurred ? (x->D + sqrt(x->D * x->D - 4 * c2 * b2)) / (2 * c2) : (1 - x->f_t) * x->D / c2;
  } else if (other == LENGTH) {
    const double B = v[LENGTH] + 2 * x->D / U;
    x->tau = w->blurred ? (B + sqrt(B * B - 16 * b2)) / (4 * U)
                        : v[LENGTH] / (2 * U) + (1 - x->f_t) * x->D / (U * U);
  }
  if (w->blurred) x->f_t = b2 / (x->D * x->tau);
  x->c = sqrt((1 - x->f_t) * x->D / x->tau);
}

static bool is_possible(const answer *x) {
  return isfinite(x->D) && isfinite(x->tau) && x->D > 0 && x->tau > 0 && x->c >= 0 && x->f_t >= 0 &&
         x->f_t <= 1;
}

/* --- checks ------------------------------------------------------------------------------------------------- */

/* What the answer says about a quantity. */
static double value_of(const known *w, const answer *x, const quantity q) {
  switch (q) {
    case D:
      return x->D;
    case TAU:
      return x->tau;
    case SPEED:
      return x->c;
    case REACH:
      return reach_factor() * x->c * x->tau;
    default:
      return 2 * x->tau * w->wind * (1 - x->c * x->c / (w->wind * w->wind));
  }
}

static cf_status check_agreement(const known *w, const answer *x, const char *const pair[2]) {
  char sentence[320];
  for (int q = 0; q < QUANTITIES; ++q) {
    if (w->key[q] == NULL || agree(w->value[q], value_of(w, x, (quantity)q))) continue;
    snprintf(sentence, sizeof sentence, "contradicts %s.%s and %s.%s: those give %.6g %s, with f_t = %.4g",
             w->path, pair[0], w->path, pair[1], value_of(w, x, (quantity)q), units[q], x->f_t);
    return fail_at(w, w->key[q], sentence);
  }
  const double blur = cf_regime_blur(x->D, x->tau, x->f_t);
  if (w->d->given.blur && !agree(w->blur, blur) && fabs(w->blur - blur) > 1e-300) {
    snprintf(sentence, sizeof sentence, "contradicts %s.f_t: with %s and %s that gives %.6g m", w->path,
             pair[0], pair[1], blur);
    return fail_at(w, "blur", sentence);
  }
  return CF_OK;
}

/* What keeps a set from having a solution, in words. */
static cf_status check_sense(const known *w) {
  const char *speed = w->key[SPEED], *front = speed != NULL           ? speed
                                              : w->key[REACH] != NULL ? w->key[REACH]
                                                                      : w->key[LENGTH];
  if (w->d->given.k && !cf_fn_is_constant(&w->d->k.fn))
    return fail_at(w, front != NULL ? front : "blur", "needs a k that is one number");
  if (!w->blurred && w->f_t >= 1 && front != NULL)
    return fail_at(w, front, "does not go with f_t = 1: Fourier's law has no front");
  if (w->key[TAU] != NULL && w->value[TAU] <= 0)
    return fail_at(w, front != NULL ? front : "blur", "needs tau > 0");
  if (w->key[LENGTH] != NULL && speed != NULL && w->value[SPEED] >= w->wind)
    return fail_at(w, "visible_length", "does not go with a front as fast as the wind: there is no cone");
  return CF_OK;
}

/* Every choice that would complete a lone key. */
static cf_status fail_incomplete(const known *w, const char *key) {
  return fail_at(w, key,
                 strcmp(key, "front_speed") == 0
                     ? "needs k or tau beside it"
                     : "is not enough: two of k (or saturation), tau, front_speed (or "
                       "cone_angle, arrival), reach and visible_length are wanted");
}

/* --- all ---------------------------------------------------------------------------------------------------- */

static cf_status solve(known *w, answer *x) {
  const char *pair[2] = {NULL, NULL};
  unsigned bits = 0;
  int count = 0;
  for (int q = 0; q < QUANTITIES && count < 2; ++q) {
    if (w->key[q] == NULL) continue;
    pair[count++] = w->key[q];
    bits |= 1u << q;
  }
  if (count < 2)
    return fail_incomplete(
        w, w->d->given.blur && (count == 0 || strcmp(pair[0], "k") == 0 || strcmp(pair[0], "tau") == 0)
               ? "blur"
               : pair[0]);
  CF_TRY(check_sense(w));

  quantity other = LENGTH;
  for (int q = LENGTH; q > D; --q)
    if ((bits & 1u << q) != 0) other = (quantity)q;
  if ((bits & 1u << D) != 0)
    with_diffusivity(w, other, x);
  else
    from_pair(w, bits, x);
  if (!is_possible(x)) {
    char sentence[256];
    snprintf(sentence, sizeof sentence, "and %s.%s%s go with no k and tau", w->path, pair[1],
             w->blurred ? ", with that blur," : "");
    return fail_at(w, pair[0], sentence);
  }
  return check_agreement(w, x, pair);
}

static void forget(cf_scene_diffusion *d) {
#define FORGET(name)     \
  d->name = (double)NAN; \
  d->given.name = false;
  FORGET(front_speed)
  FORGET(reach)
  FORGET(blur)
  FORGET(cone_angle)
  FORGET(visible_length)
  FORGET(wind)
  FORGET(thickness)
  FORGET(arrival)
  FORGET(saturation)
#undef FORGET
}

cf_status cf_scene_resolve_params(cf_scene *scene, const char *path, cf_scene_diffusion *d) {
  const bool any = d->given.front_speed || d->given.reach || d->given.blur || d->given.cone_angle ||
                   d->given.visible_length || d->given.wind || d->given.thickness || d->given.arrival ||
                   d->given.saturation;
  if (!any) return CF_OK;
  known w = {.scene = scene, .path = path, .d = d, .capacity = d->capacity.fn.value};
  answer x = {0};
  if (!cf_fn_is_constant(&d->capacity.fn))
    return fail_at(&w, "capacity", "must be one number where k and tau follow from other keys");
  CF_TRY(take_all(&w));
  CF_TRY(solve(&w, &x));
  if (!d->given.k) {
    d->k.fn = cf_fn_constant(x.D * w.capacity);
    CF_TRY(cf_config_text(scene->config, &d->k.text, "%.17g", d->k.fn.value));
  }
  if (!d->given.tau) d->tau = x.tau;
  if (!d->given.f_t) d->f_t = x.f_t;
  forget(d);
  d->given.k = d->given.tau = d->given.f_t = true;
  return CF_OK;
}

/* --- the other way ------------------------------------------------------------------------------------------- */

cf_scene_measures cf_scene_measure(const double diffusivity, const double tau, const double f_t,
                                   const double wind, const double thickness) {
  const double c = cf_regime_speed(diffusivity, tau, f_t), H_c = cf_regime_number(wind, c);
  const double L2 = thickness * thickness;
  const bool cone = H_c > 1 && isfinite(H_c);
  return (cf_scene_measures){
      .front_speed = c,
      .reach = tau > 0 ? reach_factor() * c * tau : 0,
      .blur = cf_regime_blur(diffusivity, tau, f_t),
      .cone_angle = cone ? cf_regime_cone_angle(H_c) * 180 / pi : (double)NAN,
      .visible_length = cone ? cf_regime_cone_length(wind, tau, H_c) : (double)NAN,
      .arrival = thickness / c,
      .saturation = saturation_factor() * L2 / diffusivity,
      .rings = f_t < 1 && tau > L2 / (pi * pi * diffusivity),
  };
}

void cf_scene_measures_text(const cf_scene_measures *m, const double thickness, char *text,
                            const size_t size) {
  size_t n = 0;
  text[0] = '\0';
#define ADD(...) n = CF_MIN(size - 1, n + (size_t)snprintf(text + n, size - n, __VA_ARGS__))
  if (m->front_speed > 0 && isfinite(m->front_speed))
    ADD("front_speed = %.4g m/s, reach = %.4g m, ", m->front_speed, m->reach);
  if (m->blur > 0) ADD("blur = %.4g m, ", m->blur);
  if (!isnan(m->cone_angle))
    ADD("cone_angle = %.4g degrees, visible_length = %.4g m, ", m->cone_angle, m->visible_length);
  if (thickness > 0 && isfinite(m->saturation)) {
    ADD("for a thickness of %.4g m ", thickness);
    if (m->front_speed > 0 && isfinite(m->front_speed)) ADD("arrival = %.4g s, ", m->arrival);
    ADD("saturation = %.4g s%s, ", m->saturation, m->rings ? " (it rings)" : "");
  }
#undef ADD
  if (n >= 2) text[n - 2] = '\0';
}
