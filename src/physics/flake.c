/* SPDX-License-Identifier: MIT */
#include "physics/flake.h"

#include <math.h>

#include "base/real.h"

#define PI       3.14159265358979323846
#define CENTRE   0.1  /* of pressure ahead of the middle, in D (thin plates: .25 at small angles, 0 flat) */
#define SHED     0.02 /* torque of the vortices, in m g D */
#define STROUHAL 0.13
#define SPINNING 0.1 /* damping about the normal over that about a diameter */
#define RESOLVED 0.2 /* a substep is at most this over the fastest rate */

void cf_flake_settle_speed(cf_flake *f, const cf_air *air) {
  const double eta = air->viscosity, rho = air->density, D = f->diameter;
  const double A_r = CF_MIN(f->area / (PI / 4 * D * D), 1);
  const double X = 8 * f->mass * air->gravity * rho / (PI * eta * eta * sqrt(A_r));
  const double root = sqrt(1 + sqrt(X) / (16 * sqrt(0.35))) - 1;
  f->reynolds = 16 * root * root;
  f->terminal_speed = eta * f->reynolds / (rho * D);
  f->glide = CF_MIN(2.66 / (1.1 * sqrt(f->reynolds)), 2.0 / 3);
}

void cf_flake_turn(const double turn[4], const double body[3], double world[3]) {
  const double w = turn[0], *q = turn + 1;
  double t[3];
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    t[a] = 2 * (q[b] * body[c] - q[c] * body[b]);
  }
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    world[a] = body[a] + w * t[a] + q[b] * t[c] - q[c] * t[b];
  }
}

/* World to body: the other way round. */
static void turn_back(const double turn[4], const double world[3], double body[3]) {
  const double back[4] = {turn[0], -turn[1], -turn[2], -turn[3]};
  cf_flake_turn(back, world, body);
}

/* turn <- turn exp(spin dt/2), of length 1 again. */
static void rotate(double turn[4], const double spin[3], const double dt) {
  const double angle = sqrt(spin[0] * spin[0] + spin[1] * spin[1] + spin[2] * spin[2]) * dt;
  const double c = cos(angle / 2), s = angle > 1e-12 ? sin(angle / 2) / angle * dt : dt / 2;
  const double p[4] = {turn[0], turn[1], turn[2], turn[3]};
  const double q[4] = {c, s * spin[0], s * spin[1], s * spin[2]};
  turn[0] = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3];
  turn[1] = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2];
  turn[2] = p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1];
  turn[3] = p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0];
  const double length = sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2] + turn[3] * turn[3]);
  for (int i = 0; i < 4; ++i) turn[i] /= length;
}

/* m dv/dt = m g - K |u| (u_n + r u_t), in body axes; leaves u as it was before, for the torques. */
static void move(const cf_flake *f, const cf_air *air, const double dt, const double w[3], double u[3],
                 cf_flake_state *s) {
  const double down[3] = {0, 0, -air->gravity};
  double relative[3], g[3], v[3], wind[3];
  for (int a = 0; a < 3; ++a) relative[a] = s->v[a] - w[a];
  turn_back(s->turn, relative, u);
  turn_back(s->turn, down, g);
  turn_back(s->turn, s->v, v);
  turn_back(s->turn, w, wind);
  const double speed = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
  const double rate = air->gravity * speed / (f->terminal_speed * f->terminal_speed); /* K |u|/m */
  for (int a = 0; a < 3; ++a) {
    const double of_axis = a == 2 ? rate : f->glide * rate;
    v[a] = (v[a] + dt * (g[a] + of_axis * wind[a])) / (1 + dt * of_axis);
  }
  cf_flake_turn(s->turn, v, s->v);
  for (int a = 0; a < 3; ++a) s->x[a] += dt * s->v[a];
}

/* The plane that the vortices rock turns slowly round, by the golden angle a second. */
static void add_shedding(const cf_flake *f, const cf_air *air, const double t, double torque[3]) {
  const double share = CF_MIN(CF_MAX((f->reynolds - 100) / 200, 0), 1);
  const double often = STROUHAL * f->terminal_speed / f->diameter;
  const double size = air->flutter * share * SHED * f->mass * air->gravity * f->diameter *
                      sin(2 * PI * (often * t + f->shed_phase));
  const double plane = 2.399963 * t + 2 * PI * f->shed_phase;
  torque[0] += size * cos(plane);
  torque[1] += size * sin(plane);
}

/* Spin over one substep; u: relative velocity in body axes. */
static void spin(const cf_flake *f, const cf_air *air, const double t, const double dt, const double u[3],
                 cf_flake_state *s) {
  const double speed = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
  const double K = f->mass * air->gravity / (f->terminal_speed * f->terminal_speed);
  const double push = -K * speed * u[2]; /* along n */
  const double ahead = speed > 0 ? CENTRE * f->diameter / speed : 0;
  const double arm[2] = {ahead * u[0] + f->offset[0], ahead * u[1] + f->offset[1]};
  double torque[3] = {arm[1] * push, -arm[0] * push, 0};
  add_shedding(f, air, t, torque);
  /* what slides past an off-centre plate turns it about n */
  torque[2] += f->glide * K * speed * (f->offset[1] * u[0] - f->offset[0] * u[1]);
  const double *I = f->inertia, damping = 2 * K * speed * f->diameter * f->diameter / 16;
  for (int a = 0; a < 3; ++a) {
    const double inertia = a == 2 ? I[1] : I[0], rate = (a == 2 ? SPINNING : 1) * damping / inertia;
    s->spin[a] = (s->spin[a] + dt * torque[a] / inertia) / (1 + dt * rate);
  }
  /* O x I O of a body of revolution turns (O_x, O_y) about n */
  const double angle = -(I[1] - I[0]) / I[0] * s->spin[2] * dt, c = cos(angle), sine = sin(angle);
  const double x = s->spin[0], y = s->spin[1];
  s->spin[0] = c * x + sine * y;
  s->spin[1] = c * y - sine * x;
}

/* 1/s: drag, the pendulum that T_pressure makes of it, the vortices, and the spin itself. */
static double fastest(const cf_flake *f, const cf_air *air, const cf_flake_state *s) {
  const double v = f->terminal_speed, D = f->diameter, g = air->gravity;
  const double pendulum = sqrt(CENTRE * f->mass * g * D / f->inertia[0]);
  const double turning = sqrt(s->spin[0] * s->spin[0] + s->spin[1] * s->spin[1] + s->spin[2] * s->spin[2]);
  return CF_MAX(CF_MAX(g / v, pendulum), CF_MAX(2 * PI * STROUHAL * v / D, turning));
}

void cf_flake_step(const cf_flake *f, const cf_air *air, const double t, const double dt, const double w[3],
                   cf_flake_state *s) {
  const double wish = ceil(dt * fastest(f, air, s) / RESOLVED);
  const int substeps = wish < 1 ? 1 : wish > 1000 ? 1000 : (int)wish;
  for (int i = 0; i < substeps; ++i) {
    const double part = dt / substeps;
    double u[3];
    move(f, air, part, w, u, s);
    spin(f, air, t + i * part, part, u, s);
    rotate(s->turn, s->spin, part);
  }
}
