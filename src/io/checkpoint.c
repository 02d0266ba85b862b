/* SPDX-License-Identifier: MIT
 *
 * Writing checkpoints, and the folder's list of them. (Reading: checkpoint_read.c.)
 */
#define _GNU_SOURCE
#include "io/checkpoint.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/version.h"
#include "io/checkpoint_head.h"

/* --- the registry into a file ------------------------------------------------------------------------------
 */

static cf_status write_facts(cf_hdf5 *h, const cf_registry *r, const cf_stamp *stamp) {
  const cf_grid *g = r->grid;
  const int64_t format = CF_CHECKPOINT_FORMAT, dim = g->box.dim,
                cells[3] = {g->box.n[0], g->box.n[1], g->box.n[2]};
  CF_TRY(cf_hdf5_set_text(h, "/", "title", stamp->title == NULL ? "" : stamp->title));
  CF_TRY(cf_hdf5_set_text(h, "/", "program", "Cattaneo"));
  CF_TRY(cf_hdf5_set_text(h, "/", "version", cf_version()));
  CF_TRY(cf_hdf5_set_text(h, "/", "git", cf_git_hash()));
  CF_TRY(cf_hdf5_set_text(h, "/", "precision", CF_PRECISION));
  CF_TRY(cf_hdf5_set_integers(h, "/", "format", 1, &format));
  CF_TRY(cf_hdf5_set_numbers(h, "/", "time", 1, &stamp->time));
  CF_TRY(cf_hdf5_set_integers(h, "/", "step", 1, &stamp->step));
  CF_TRY(cf_hdf5_set_integers(h, "/", "dim", 1, &dim));
  CF_TRY(cf_hdf5_set_integers(h, "/", "cells", 3, cells));
  CF_TRY(cf_hdf5_set_numbers(h, "/", "spacing", 1, &g->h));
  return cf_hdf5_set_numbers(h, "/", "origin", 3, g->origin);
}

static cf_status write_scene(cf_hdf5 *h, const char *scene) {
  const cf_array text = {CF_ELEMENT_BYTE, 1, {scene == NULL ? 0 : (int64_t)strlen(scene)}};
  return cf_hdf5_write(h, "/scene", &text, scene, NULL);
}

/* Entries of several parts are a group. */
static cf_status write_entry(cf_hdf5 *h, const cf_registry *r, const cf_entry *e, cf_head *head) {
  cf_path path;
  cf_part part;
  CF_TRY(cf_path_make(&path, "/state/%s", e->name));
  if (e->kind == CF_KIND_FACE || e->kind == CF_KIND_PARTICLES) CF_TRY(cf_hdf5_group(h, path.text));
  for (int i = 0; cf_part_of(r, e, i, &part); ++i) {
    cf_extent extent;
    if (part.derived) continue;
    CF_TRY(cf_path_make(&path, "/state/%s", part.name));
    CF_TRY(cf_hdf5_write_part(h, path.text, &part, 0, &extent));
    cf_head_add(head, part.name, &extent);
  }
  CF_TRY(cf_path_make(&path, "/state/%s", e->name));
  return cf_hdf5_set_text(h, path.text, "kind", cf_kind_name(e->kind));
}

static cf_status fill(cf_hdf5 *h, const cf_registry *r, const cf_stamp *stamp, cf_head *head) {
  CF_TRY(write_facts(h, r, stamp));
  CF_TRY(write_scene(h, stamp->scene));
  CF_TRY(cf_hdf5_group(h, "/state"));
  for (int e = 0; e < r->count; ++e) CF_TRY(write_entry(h, r, &r->entry[e], head));
  return CF_OK;
}

static cf_status write_file(const char *path, const cf_registry *r, const cf_stamp *stamp, cf_head *head) {
  cf_hdf5 h;
  CF_TRY(cf_hdf5_create(&h, path, head->size));
  CF_TRY(cf_hdf5_close(&h, fill(&h, r, stamp, head)));
  const cf_status s = cf_head_write(head, h.draft.temporary.text, path);
  if (s != CF_OK) {
    cf_draft_drop(&h.draft);
    return s;
  }
  return cf_draft_keep(&h.draft);
}

/* A name is a name in the HDF5 file and a word in the page of text. */
static cf_status check_names(const cf_registry *r) {
  for (int e = 0; e < r->count; ++e)
    if (strpbrk(r->entry[e].name, "/ \t\r\n") != NULL || strcmp(r->entry[e].name, ".") == 0)
      return cf_fail(CF_BAD_ARGUMENT, "state named \"%s\": no slash or blank can stand in a name",
                     r->entry[e].name);
  return CF_OK;
}

/* An old checkpoint that cannot be removed is no reason to stop. */
static cf_status prune(const char *folder, const int64_t step, const int keep) {
  int count, older = 0;
  int64_t *steps;
  CF_TRY(cf_folder_numbers(folder, "checkpoint", "h5", &count, &steps));
  while (older < count && steps[older] <= step) ++older;
  for (int i = 0; i < older - CF_MAX(keep, 1); ++i) {
    cf_path path;
    if (cf_path_make(&path, "%s/checkpoint_%06" PRId64 ".h5", folder, steps[i]) == CF_OK) unlink(path.text);
  }
  cf_free(steps);
  return CF_OK;
}

cf_status cf_checkpoint_write_to(const char *path, const cf_registry *r, const cf_stamp *stamp) {
  cf_head head;
  cf_part part;
  int arrays = 0;
  CF_TRY(check_names(r));
  for (int e = 0; e < r->count; ++e)
    for (int i = 0; cf_part_of(r, &r->entry[e], i, &part); ++i) ++arrays;
  CF_TRY(cf_head_create(&head, arrays));
  const cf_status s = write_file(path, r, stamp, &head);
  cf_head_destroy(&head);
  return s;
}

cf_status cf_checkpoint_write(const char *folder, const cf_registry *r, const cf_stamp *stamp,
                              const int keep) {
  cf_path path;
  CF_TRY(cf_path_make(&path, "%s/checkpoint_%06" PRId64 ".h5", folder, stamp->step));
  CF_TRY(cf_checkpoint_write_to(path.text, r, stamp));
  return prune(folder, stamp->step, keep);
}

/* --- the checkpoints of a folder ---------------------------------------------------------------------------
 */

static void note(cf_checkpoint_found *found) {
  const size_t length = strlen(found->passed_over), room = sizeof found->passed_over - length;
  snprintf(found->passed_over + length, room, "%s%s", length > 0 ? "\n" : "", cf_status_sentence());
}

cf_status cf_checkpoint_newest(const char *folder, cf_checkpoint_found *found) {
  int count;
  int64_t *steps;
  *found = (cf_checkpoint_found){.found = false};
  CF_TRY(cf_folder_numbers(folder, "checkpoint", "h5", &count, &steps));
  cf_status s = CF_OK;
  for (int i = count - 1; i >= 0 && !found->found && s == CF_OK; --i) {
    s = cf_path_make(&found->path, "%s/checkpoint_%06" PRId64 ".h5", folder, steps[i]);
    if (s != CF_OK) break;
    const cf_status whole = cf_checkpoint_check(found->path.text);
    found->found = whole == CF_OK;
    found->step = steps[i];
    if (whole == CF_BAD_FILE)
      note(found);
    else
      s = whole; /* memory ran out: the file may be good */
  }
  cf_free(steps);
  return s;
}

cf_status cf_checkpoint_cut(const char *folder, const int64_t step) {
  int count;
  int64_t *steps;
  cf_status s = CF_OK;
  CF_TRY(cf_folder_numbers(folder, "checkpoint", "h5", &count, &steps));
  for (int i = 0; i < count && s == CF_OK; ++i) {
    cf_path path;
    if (steps[i] <= step) continue;
    s = cf_path_make(&path, "%s/checkpoint_%06" PRId64 ".h5", folder, steps[i]);
    if (s == CF_OK && unlink(path.text) != 0)
      s = cf_fail(CF_CANNOT_WRITE, "%s: cannot be removed: %s", path.text, strerror(errno));
  }
  cf_free(steps);
  return s;
}
