/* SPDX-License-Identifier: MIT
 *
 * What the files of physics/diffuse.h share: the object, and what every scheme needs alike: sources, held cells,
 * walls, the ledger.
 *
 *   diffuse.c            creation, and which scheme takes a step
 *   diffuse_sources.c    sources, held cells, walls, the ledger
 *   diffuse_stage.c      the implicit stage and the schemes made of it
 *   diffuse_operator.c   the equation of a stage, and its solve
 *   diffuse_leapfrog.c   the explicit scheme
 *   diffuse_wave.c       the explicit scheme with WENO5
 *   diffuse_region.c     what walls and held cells within the box make of all that
 *
 * Memory of the flux comes in two forms. The face form keeps q_C on faces. The scalar form keeps s = div q_C in
 * cells: what happens to phi depends on q_C through s alone, and with one tau for all
 *
 *     tau s_t + s + (1 - F_T) div k grad phi = 0,     C phi_t + s - F_T div k grad phi = C W,
 *
 * so it gives the same phi with one array in place of dim. Sources of q and waves that leave through a wall need
 * the flux itself, hence the face form.
 *
 * Radiating walls. Where q.n = Z (phi_w - phi_inf), Z = sqrt(C (1 - F_T) k/tau) = C c, a wave that meets the wall
 * head on leaves without echo. phi_w, on the wall face, is eliminated: with what is left of the flux on the wall,
 * m q_w, and the conductance K = per 2 k/h between cell and wall,
 *
 *     m q_w + K (phi_p - phi_w) = Z (phi_w - phi_inf)   gives   phi_w = (1 - theta) phi_p + theta phi_inf + theta m q_w/Z,
 *     theta = Z/(K + Z),
 *
 * a held wall with the share theta of its conductance: 1 as tau -> 0, where the wall holds phi_inf, and less the
 * longer a wave takes across half a cell. Without waves (tau = 0 or F_T = 1) the wall is held at phi_inf.
 */
#ifndef CF_PHYSICS_DIFFUSE_PART_H
#define CF_PHYSICS_DIFFUSE_PART_H

#include "grid/region.h"
#include "grid/rim.h"
#include "grid/sweep.h"
#include "grid/wall.h"
#include "physics/diffuse.h"

/* The state that a step works on: one of q and s is there. */
typedef struct cf_diffused {
  cf_cell phi;
  cf_face q;
  cf_cell s;
} cf_diffused;

/* What the WENO5 scheme keeps of the beginning of a substep, and its rate. */
typedef struct cf_diffuse_kept {
  cf_cell phi, phi_rate;
  cf_face q;
} cf_diffuse_kept;

struct cf_diffuse {
  const cf_grid *grid;
  cf_diffuse_params p;
  cf_source source;
  cf_wall_values walls;         /* radiating ones count as held, at phi_inf */
  bool radiates[3][2];          /* and are told apart here */
  bool has_radiation, has_open; /* some wall radiates; something can pass through some wall */
  int axes;                     /* along which something can flow */
  cf_helmholtz *A;              /* NULL for explicit schemes */
  bool k_varies, c_varies;      /* k_varies: it is taken from faces */
  double k_max, c_min, speed_max;
  double delta, per; /* for which A is set; -1: none */
  cf_face k, beta;   /* on faces, and its multiple for the operator; where k varies, or a wall radiates */
  cf_cell k_cells;   /* k at centres, where it varies and there is a region */
  cf_cell capacity, alpha; /* C where it varies; C plus what holds, where something holds */
  cf_cell x, b, W;         /* phi~, right side, source */
  cf_cell fraction, value; /* of held cells */
  cf_cell change;          /* phi~ less its guess, where cells are held */
  cf_face B;               /* source of the flux */
  cf_cell filtered;        /* scratch of the front filter */
  cf_diffuse_kept kept;
  cf_rim rim; /* of the region, where fronts are filtered */
  double *rows;
};

/* What a flux goes through in a time delta: `left` of q stays, and `per` is the weight of -k grad phi in the mean
 * flux. */
typedef struct cf_flux_law {
  double delta, left, per;
} cf_flux_law;

/* What a row has to look at beside fluxes: the second literal of those below, after dim and `form`. A row that looked at
 * the pointers itself would load from nowhere, masked out, which costs more than all the rest of it. */
enum {
  CF_ACTS_NOTHING,
  CF_ACTS_SOURCE,
  CF_ACTS_ALL
}; /* of W and a capacity that varies: neither; W; perhaps both */

#define CF_CLONED_ACTS_ONE(name, acts, T)                                                                \
  CF_KERNEL void name##_##acts(const int dim, const int form, const int n, T x, const ptrdiff_t start) { \
    name(dim, form, CF_ACTS_##acts, n, x, start);                                                        \
  }                                                                                                      \
  CF_CLONED_FORMS(name##_##acts, T, const ptrdiff_t)

#define CF_CLONED_ACTS(name, T)                                                      \
  CF_CLONED_ACTS_ONE(name, NOTHING, T)                                               \
  CF_CLONED_ACTS_ONE(name, SOURCE, T)                                                \
  CF_CLONED_ACTS_ONE(name, ALL, T)                                                   \
  static inline void name##_by_form(const int dim, const int form, const int n, T x, \
                                    const ptrdiff_t start) {                         \
    if (x->capacity != NULL)                                                         \
      name##_ALL_by_form(dim, form, n, x, start);                                    \
    else if (x->W != NULL)                                                           \
      name##_SOURCE_by_form(dim, form, n, x, start);                                 \
    else                                                                             \
      name##_NOTHING_by_form(dim, form, n, x, start);                                \
  }

/* --- sources and walls ------------------------------------------------------------------------------------ */

/* What times the sources of a substep are taken at. */
typedef struct cf_source_times {
  double rate, flux_rate, walls, hold;
} cf_source_times;
cf_status cf_diffuse_sample(cf_diffuse *d, const cf_source_times *t);

/* q += factor B on all faces but those of insulated walls, and seams closed. */
void cf_diffuse_add_flux_source(const cf_diffuse *d, double factor, cf_face q);

/* On a periodic axis the last layer of faces is the first. */
void cf_diffuse_close_seams(const cf_diffuse *d, cf_face q);

/* One layer of ghosts of x so that differences across walls are those of the walls' laws. */
void cf_diffuse_ghosts(const cf_diffuse *d, const cf_flux_law *law, cf_cell x, cf_face q);

/* What a radiating wall does: theta, and theta/Z; cell p, wall face f. */
typedef struct cf_radiation {
  double share, gain;
} cf_radiation;
cf_radiation cf_diffuse_radiation(const cf_diffuse *d, const cf_flux_law *law, int axis, ptrdiff_t p,
                                  ptrdiff_t f);

/* One layer of ghosts: wrapped on periodic walls, copies elsewhere. */
void cf_diffuse_copy_ghosts(const cf_diffuse *d, cf_cell f);

/* Walks over the faces of a wall that radiates. */
typedef void cf_wall_visit(const cf_diffuse *d, const cf_wall_side *w, ptrdiff_t p, ptrdiff_t f,
                           ptrdiff_t place, void *context);
void cf_diffuse_visit_radiating(const cf_diffuse *d, cf_wall_visit *visit, void *context);

/* phi moves to the held value by its fraction, in cells of which at least `from` is held. Returns the content
 * gained. */
double cf_diffuse_hold(const cf_diffuse *d, double from, cf_cell phi);

/* The front filter, if the parameters ask for it, for waves that moved over dt; cells that are held stay so. */
void cf_diffuse_filter_phi(const cf_diffuse *d, double weight, double dt, cf_cell phi, cf_ledger *ledger);
void cf_diffuse_filter_flux(const cf_diffuse *d, double weight, double dt, cf_face q);

/* --- sums ------------------------------------------------------------------------------------------------- */

/* Integral of C f, and of f. */
double cf_diffuse_integral(const cf_diffuse *d, cf_cell f);
double cf_diffuse_plain_integral(const cf_diffuse *d, cf_cell f);

void cf_diffuse_copy(const cf_diffuse *d, const cf_real *from, cf_real *to);

/* --- a region: nothing is done without one ---------------------------------------------------------------- */

void cf_diffuse_halve_held(const cf_diffuse *d, cf_face beta); /* the operator doubles it there itself */
void cf_diffuse_fill_outside(const cf_diffuse *d, cf_real value, cf_cell f); /* ... is that value there */
void cf_diffuse_clear_outside(const cf_diffuse *d, cf_cell f); /* f = 0 in cells that are not inside */
double cf_diffuse_sum_inside(const cf_diffuse *d, cf_cell phi);

/* What held cells, which were 0 before, have taken up is counted, and they get their value. */
void cf_diffuse_take_outside(const cf_diffuse *d, cf_cell phi, cf_ledger *ledger);

/* --- the equation of a stage ------------------------------------------------------------------------------ */

/* Makes it that of `law`, and of what is held now. */
cf_status cf_diffuse_set_operator(cf_diffuse *d, const cf_flux_law *law);

/* x from b, from the guess in x; what is held counts. Changes b where something is held. */
cf_status cf_diffuse_solve(cf_diffuse *d, cf_solve_report *report);

/* --- schemes ---------------------------------------------------------------------------------------------- */

cf_status cf_diffuse_paper(cf_diffuse *d, double t, double dt, const cf_diffused *y, cf_ledger *ledger,
                           cf_solve_report *report);
cf_status cf_diffuse_sdirk2(cf_diffuse *d, double t, double dt, const cf_diffused *y, cf_ledger *ledger,
                            cf_solve_report *report);
cf_status cf_diffuse_leapfrog(cf_diffuse *d, double t, double dt, const cf_diffused *y, cf_ledger *ledger,
                              cf_solve_report *report);
cf_status cf_diffuse_wave(cf_diffuse *d, double t, double dt, const cf_diffused *y, cf_ledger *ledger,
                          cf_solve_report *report);

/* phi_t = F_T div k grad phi / C alone, over dt; q stays. */
cf_status cf_diffuse_fourier_part(cf_diffuse *d, double t, double dt, const cf_diffused *y, cf_ledger *ledger,
                                  cf_solve_report *report);

#endif
