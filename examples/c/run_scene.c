/* SPDX-License-Identifier: MIT
 *
 * Level 1: runs a scene and looks at a field.
 *
 *     cc run_scene.c -o run_scene $(pkg-config --cflags --libs cattaneo)
 *     ./run_scene pulse.yaml [diffusion.tau=2 ...]
 *
 * Prints how much there is, and how far from the middle of the box the crest of the ring is.
 */
#include <cattaneo.h>
#include <math.h>
#include <stdio.h>

/* Called after every step; false would stop the run. */
static bool progress(void *context, cf_sim *sim) {
  const double percent = 100 * cf_sim_time(sim) / cf_sim_end(sim);
  fprintf((FILE *)context, "\r%3.0f %%", percent);
  return true;
}

static void report(cf_sim *sim, const cf_view *phi) {
  const ptrdiff_t *s = phi->stride;
  double sum = 0, crest = 0, highest = -1;
  for (int j = 0; j < phi->shape[1]; ++j)
    for (int i = 0; i < phi->shape[0]; ++i) {
      const double value = (double)phi->at[i * s[0] + j * s[1]];
      sum += value * phi->h * phi->h;
      if (value <= highest) continue;
      highest = value;
      crest = hypot(phi->place[0] + i * phi->h, phi->place[1] + j * phi->h);
    }
  printf("t = %.3f s after %lld steps: sum %.6f, crest at %.2f m\n", cf_sim_time(sim),
         (long long)cf_sim_step_count(sim), sum, crest);
}

static int fail(void) {
  fprintf(stderr, "%s\n", cf_status_sentence());
  return 1;
}

int main(int count, char **argument) {
  cf_scene *scene = NULL;
  cf_sim *sim = NULL;
  cf_view phi;
  if (count < 2) return fprintf(stderr, "usage: run_scene SCENE.yaml [KEY=VALUE ...]\n"), 2;
  if (cf_scene_read(&scene, argument[1], count - 2, (const char *const *)argument + 2) != CF_OK)
    return fail();
  if (cf_sim_create(&sim, scene, 2) != CF_OK) return fail();
  if (cf_sim_run(sim, INFINITY, progress, stderr) != CF_OK) return fail();
  if (cf_sim_field(sim, "phi", 0, &phi) != CF_OK) return fail();
  fprintf(stderr, "\n");
  report(sim, &phi);
  cf_sim_destroy(sim);
  cf_scene_destroy(scene);
  return 0;
}
