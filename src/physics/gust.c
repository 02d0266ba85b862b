/* SPDX-License-Identifier: MIT */
#include "physics/gust.h"

#include <math.h>

#include "base/real.h"
#include "base/rng.h"

#define PI 3.14159265358979323846

/* What the counted numbers are for. */
enum { STREAM_HEIGHT = 1, STREAM_TURN, STREAM_ACROSS, STREAM_PHASE };

static double draw(const cf_gust *g, const uint64_t stream, const int m) {
  return cf_random(g->p.seed, stream, 0, (uint64_t)m);
}

/* A direction for mode m, and the wave vector of that length: sideways the nearest that fits the period, so that not
 * both can be had exactly. */
static void choose_wave(cf_gust *g, const int m, const double length) {
  const double z = 2 * (m + draw(g, STREAM_HEIGHT, m)) / CF_GUST_MODES - 1, across = sqrt(1 - z * z);
  const double turn = 2 * PI * draw(g, STREAM_TURN, m);
  const double n[3] = {across * cos(turn), across * sin(turn), z};
  for (int a = 0; a < 2; ++a) {
    const double unit = 2 * PI / g->p.period[a];
    g->k[m][a] = unit * round(length * n[a] / unit);
  }
  g->k[m][2] = length * n[2];
  /* A wave that fits in neither way would be one that is the same everywhere on a level: let it vary along x. */
  if (g->k[m][0] == 0 && g->k[m][1] == 0) g->k[m][0] = 2 * PI / g->p.period[0];
}

/* a across k with |k x a| = speed, in a random direction. */
static void choose_amplitude(cf_gust *g, const int m, const double speed) {
  const double *k = g->k[m], size = sqrt(k[0] * k[0] + k[1] * k[1] + k[2] * k[2]);
  const double level = sqrt(k[0] * k[0] + k[1] * k[1]);
  const double e[3] = {-k[1] / level, k[0] / level, 0}; /* across k, level; f is across both */
  const double f[3] = {-k[2] * e[1] / size, k[2] * e[0] / size, (k[0] * e[1] - k[1] * e[0]) / size};
  const double turn = 2 * PI * draw(g, STREAM_ACROSS, m), c = cos(turn), s = sin(turn);
  for (int a = 0; a < 3; ++a) g->a[m][a] = speed / size * (c * e[a] + s * f[a]);
}

void cf_gust_create(cf_gust *g, const cf_gust_params *p) {
  double energy = 0, speed[CF_GUST_MODES];
  g->p = *p;
  for (int m = 0; m < CF_GUST_MODES; ++m) {
    /* neighbours in m differ in height: 7 steps through the modes give every part of the sphere all sizes */
    const int rank = (7 * m) % CF_GUST_MODES;
    choose_wave(g, m, 2 * PI / p->length * pow(CF_GUST_RANGE, rank / (CF_GUST_MODES - 1.0)));
    const double *k = g->k[m], size = sqrt(k[0] * k[0] + k[1] * k[1] + k[2] * k[2]);
    speed[m] = pow(size * p->length / (2 * PI), -1.0 / 3);
    energy += speed[m] * speed[m] / 2; /* of a cosine, all three components together */
  }
  const double scale = energy > 0 ? p->strength * sqrt(3 / energy) : 0;
  for (int m = 0; m < CF_GUST_MODES; ++m) {
    const double *k = g->k[m], size = sqrt(k[0] * k[0] + k[1] * k[1] + k[2] * k[2]);
    choose_amplitude(g, m, scale * speed[m]);
    g->rate[m] = 0.5 * scale * speed[m] * size;
    g->phase[m] = 2 * PI * draw(g, STREAM_PHASE, m);
  }
}

void cf_gust_at(const cf_gust *g, const double place[3], const double t, double u[3]) {
  const double zeta = CF_MIN(CF_MAX((place[2] - g->p.ground) / g->p.length, 0), 1);
  const double ramp = zeta * zeta * (3 - 2 * zeta), slope = 6 * zeta * (1 - zeta) / g->p.length;
  double psi[3] = {0, 0, 0}, curl[3] = {0, 0, 0};
  for (int m = 0; m < CF_GUST_MODES; ++m) {
    const double *k = g->k[m], *a = g->a[m];
    double angle = g->phase[m] + g->rate[m] * t;
    for (int d = 0; d < 3; ++d) angle += k[d] * (place[d] - g->p.wind[d] * t);
    const double c = cos(angle), s = -sin(angle);
    for (int d = 0; d < 3; ++d) {
      const int e = (d + 1) % 3, f = (d + 2) % 3;
      psi[d] += a[d] * c;
      curl[d] += s * (k[e] * a[f] - k[f] * a[e]);
    }
  }
  u[0] = g->p.wind[0] * ramp + ramp * curl[0] - slope * psi[1];
  u[1] = g->p.wind[1] * ramp + ramp * curl[1] + slope * psi[0];
  u[2] = ramp * (g->p.wind[2] + curl[2]);
}
