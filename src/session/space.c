/* SPDX-License-Identifier: MIT
 *
 * Frames and checkpoints are counted from the registry, number by number; what HDF5 puts around them is a few kB.
 */
#define _GNU_SOURCE
#include "session/space.h"

#include <math.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "base/real.h"
#include "model/obstacles.h"

double cf_space_memory(const cf_scene *scene) {
  return cf_model_of(scene->model)->memory(scene) + cf_obstacles_memory(scene);
}

/* The limit of the control group that this process sees as its own, as containers and batch systems set it. */
static double group_limit(void) {
  double bytes = INFINITY;
  FILE *file = fopen("/sys/fs/cgroup/memory.max", "re"); /* "max" where there is none */
  if (file == NULL) return bytes;
  if (fscanf(file, "%lf", &bytes) != 1 || !(bytes > 0)) bytes = INFINITY;
  fclose(file);
  return bytes;
}

/* What the plans of models count for the program and its libraries, bytes. */
#define PROGRAM 64e6

/* What `ulimit -v` leaves for a run, the program that is there already included. */
static double address_space(void) {
  struct rlimit limit;
  double pages = 0;
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return INFINITY;
  FILE *file = fopen("/proc/self/statm", "re");
  if (file != NULL && fscanf(file, "%lf", &pages) != 1) pages = 0;
  if (file != NULL) fclose(file);
  return fmax((double)limit.rlim_cur - pages * (double)sysconf(_SC_PAGE_SIZE) + PROGRAM, 0);
}

double cf_space_machine(void) {
  const double bytes = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGE_SIZE);
  return fmin(fmin(bytes, address_space()), group_limit());
}

void cf_space_bytes(const double bytes, char text[32]) {
  if (bytes < 1e9)
    snprintf(text, 32, "%.3g MB", bytes / 1e6);
  else
    snprintf(text, 32, "%.3g GB", bytes / 1e9);
}

cf_status cf_space_check_memory(const cf_scene *scene, const double limit) {
  const double needed = cf_space_memory(scene), machine = cf_space_machine();
  char one[32], other[32];
  cf_space_bytes(needed, one);
  cf_space_bytes(limit > 0 ? limit : machine, other);
  if (limit > 0 && needed > limit)
    return cf_fail(CF_OVER_LIMIT,
                   "the scene needs up to %s and the limit is %s: use fewer cells, single precision, or "
                   "raise --mem-limit",
                   one, other);
  if (!(limit > 0) && needed > machine)
    return cf_fail(
        CF_OVER_LIMIT,
        "the scene needs up to %s and there are %s for it on this machine: use fewer cells or single "
        "precision, or try it nevertheless with --mem-limit %.0fG",
        one, other, ceil(needed / 0x1p30));
  return CF_OK;
}

/* --- disk ------------------------------------------------------------------------------------------------- */

static double entry_bytes(const cf_sim *sim, const cf_entry *e) {
  const cf_box *b = &sim->grid.box;
  double bytes = 0;
  if (e->kind == CF_KIND_CELL) bytes = (double)cf_box_cells(b) * sizeof(cf_real);
  for (int a = 0; e->kind == CF_KIND_FACE && a < b->dim; ++a)
    bytes += (double)cf_box_cells(b) * (b->n[a] + 1) / b->n[a] * sizeof(cf_real);
  if (e->kind != CF_KIND_PARTICLES) return bytes;
  const cf_particles *set = e->particles;
  bytes = sizeof *set->id;
  for (int i = 0; i < set->attributes; ++i) bytes += set->attribute[i].components * (double)sizeof(cf_real);
  return bytes * (double)set->count;
}

double cf_space_checkpoint(const cf_sim *sim) {
  double bytes = 0;
  for (int i = 0; i < sim->registry.count; ++i) bytes += entry_bytes(sim, &sim->registry.entry[i]);
  return bytes;
}

double cf_space_frame(const cf_sim *sim) {
  const cf_scene_output *output = &sim->scene->output;
  const unsigned copies = (output->formats & ~(1u << CF_SCENE_FORMAT_PNG)); /* a picture is small */
  double bytes = 0;
  for (int i = 0; i < output->fields.count; ++i) {
    const cf_entry *e = cf_registry_find(&sim->shown, output->fields.item[i]);
    if (e != NULL) bytes += entry_bytes(sim, e);
  }
  return bytes * __builtin_popcount(copies);
}

double cf_space_free(const char *folder) {
  struct statvfs facts;
  return statvfs(folder, &facts) == 0 ? (double)facts.f_bavail * (double)facts.f_frsize : INFINITY;
}

/* All that stands on the disk at the end; one checkpoint more than are kept is there while it is written. */
static double all_bytes(const cf_sim *sim) {
  const double kept = (double)sim->scene->output.checkpoint.keep + 1;
  return cf_space_frame(sim) * (double)cf_sim_frames(sim) + cf_space_checkpoint(sim) * fmin(kept, 1e3);
}

cf_status cf_space_check_disk(const cf_sim *sim, const char *folder) {
  const double checkpoint = cf_space_checkpoint(sim), frame = cf_space_frame(sim),
               free = cf_space_free(folder);
  char one[32], other[32], left[32];
  if (checkpoint + frame <= free) return CF_OK;
  cf_space_bytes(checkpoint, one);
  cf_space_bytes(frame, other);
  cf_space_bytes(free, left);
  return cf_fail(
      CF_OVER_LIMIT,
      "%s: a checkpoint takes %s and a frame %s, and %s are free on this disk: make room, or choose another "
      "with -o",
      folder, one, other, left);
}

void cf_space_text(const cf_sim *sim, const char *folder, char *text, const size_t size) {
  char needed[32], machine[32], frame[32], all[32], left[32];
  const double total = all_bytes(sim), free = cf_space_free(folder);
  cf_space_bytes(cf_space_memory(sim->scene), needed);
  cf_space_bytes(cf_space_machine(), machine);
  cf_space_bytes(cf_space_frame(sim), frame);
  cf_space_bytes(total, all);
  cf_space_bytes(free, left);
  snprintf(text, size,
           "memory: up to %s of %s; disk: %s a frame, %s in all with checkpoints, before compression; %s are "
           "free%s",
           needed, machine, frame, all, left, total > free ? ": this may not be enough" : "");
}
