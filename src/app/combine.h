/* SPDX-License-Identifier: MIT
 *
 * What a sweep runs: every combination of the values of --grid, for each scene.
 *
 *     --grid diffusion.f_t=0,0.5 --grid 'velocity=[0, 1],[0, 2]'
 *
 * are four runs. Commas inside brackets, braces, parentheses and quotes belong to a value. The last grid changes fastest.
 */
#ifndef CF_APP_COMBINE_H
#define CF_APP_COMBINE_H

#include "base/status.h"

#define CF_GRIDS_MAX        8
#define CF_COMBINATIONS_MAX 10000
#define CF_RUN_NAME_MAX     160

typedef struct cf_grid_axis {
  const char *key;   /* "diffusion.f_t" */
  const char *label; /* its last part, or the key where two grids share that */
  int count;
  const char **value;
} cf_grid_axis;

typedef struct cf_combination {
  int scene;
  const char *value[CF_GRIDS_MAX]; /* by axis */
  char *set[CF_GRIDS_MAX];         /* "diffusion.f_t=0.5" */
  char name[CF_RUN_NAME_MAX];      /* of its folder: "cone-f_t=0.5" */
  char caption[CF_RUN_NAME_MAX];   /* "cone, f_t = 0.5" */
} cf_combination;

typedef struct cf_combinations {
  int axes, count;
  cf_grid_axis axis[CF_GRIDS_MAX];
  cf_combination *item;
  char *texts; /* what the values point to */
} cf_combinations;

/* `grid`: the texts after --grid; `scene`: paths of the scenes, whose names lead those of the folders where there are
 * several. CF_BAD_USAGE: a grid that makes no sense, two runs with one name, or too many. */
cf_status cf_combinations_make(cf_combinations *c, int scenes, char *const *scene, int grids,
                               const char *const *grid);
void cf_combinations_clear(cf_combinations *c); /* a zeroed one is fine */

#endif
