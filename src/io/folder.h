/* SPDX-License-Identifier: MIT
 *
 * The output folder and the rules that keep its files whole.
 *
 * A file appears under its name only when it is complete (cf_draft): it is written under a hidden temporary
 * name in the same folder, synced, renamed, and the folder is synced. A run holds a lock on its folder that
 * dies with the process, so no two runs write the same folder. A folder that holds a run is refused unless
 * told otherwise.
 *
 * Names: run.yaml, metrics.csv, log.txt, WORD_000012.EXT for frame 12, checkpoint_000100.h5 for step 100.
 */
#ifndef CF_IO_FOLDER_H
#define CF_IO_FOLDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/status.h"

#define CF_PATH_MAX 1024

typedef struct cf_path {
  char text[CF_PATH_MAX];
} cf_path;

/* CF_BAD_ARGUMENT: longer than CF_PATH_MAX - 1. */
cf_status cf_path_make(cf_path *p, const char *format, ...) CF_PRINTF(2, 3);

/* The path as a word that can be pasted into a shell: as it is, or in quotes. */
void cf_path_quote(const char *path, char *text, size_t size);

/* --- one file, whole or not at all ----------------------------------------------------------------- */

typedef struct cf_draft {
  cf_path path, temporary; /* write to `temporary` */
} cf_draft;

/* Chooses the temporary name for `path`; touches nothing. */
cf_status cf_draft_begin(cf_draft *d, const char *path);

/* Before long work for a file: whether its folder can be written, and its name is no folder's. CF_CANNOT_WRITE. */
cf_status cf_draft_try(const char *path);

/* Syncs the temporary file (which must be closed), gives it its name, syncs the folder. On failure the
 * temporary file is gone and whatever stood at `path` is as it was. CF_CANNOT_WRITE. */
cf_status cf_draft_keep(const cf_draft *d);

/* Removes the temporary file, if there is one. */
void cf_draft_drop(const cf_draft *d);

/* A file that `fill` writes, whole or not at all; false, or any failure of the stream, gives it up. CF_CANNOT_WRITE
 * with path and reason. */
cf_status cf_file_fill(const char *path, bool (*fill)(FILE *file, const void *what), const void *what);

/* A small file, whole or not at all. CF_CANNOT_WRITE. */
cf_status cf_file_write(const char *path, const void *bytes, size_t size);

/* A file to be read. What is no file, a pipe that nobody writes to or a device without an end, is never waited for:
 * the first returns NULL and errno, and leaves it to the caller to look what was opened; the second refuses it, and
 * says how many bytes there are now. CF_BAD_FILE. */
FILE *cf_file_stream(const char *path);
cf_status cf_file_open(const char *path, FILE **file, size_t *size);

/* A small file (at most `most` bytes), zero-terminated; the text is the caller's: cf_free. CF_BAD_FILE. */
cf_status cf_file_read(const char *path, size_t most, char **text, size_t *size);

/* --- the folder of a run ------------------------------------------------------------------------------ */

typedef struct cf_folder {
  cf_path path;
  int lock; /* file descriptor */
  int log;
} cf_folder;

/* Makes a folder, and those above it; one that is there already will do. CF_CANNOT_WRITE. */
cf_status cf_folder_make(const char *path);

/* Makes the folder (and those above it) and locks it. A folder that holds a run is refused, CF_BAD_USAGE,
 * with a sentence that says what was found; with `force` the files of that run are removed, and no others.
 * CF_CANNOT_WRITE: the folder cannot be made, or another process is running in it. */
cf_status cf_folder_create(cf_folder *f, const char *path, bool force);

/* Locks the folder of a run that is to go on. CF_BAD_FILE: there is no run.yaml in it. */
cf_status cf_folder_open(cf_folder *f, const char *path);

/* Releases the lock; a zeroed folder is fine. */
void cf_folder_close(cf_folder *f);

/* Appends one line to log.txt (the newline is added). */
cf_status cf_folder_log(cf_folder *f, const char *format, ...) CF_PRINTF(2, 3);

/* What a name in an output folder is. */
typedef enum cf_file_kind { CF_FILE_OTHER, CF_FILE_RUN, CF_FILE_FRAME, CF_FILE_CHECKPOINT } cf_file_kind;
cf_file_kind cf_file_kind_of(const char *name, int64_t *number);

/* Calls `visit` for every name in a folder, in no order. CF_BAD_FILE: it cannot be listed. */
cf_status cf_folder_each(const char *path, void (*visit)(void *context, const char *name), void *context);

/* The numbers, ascending, of the files WORD_<number>.EXT in a folder. The list is the caller's: cf_free. A
 * folder that is not there has none. */
cf_status cf_folder_numbers(const char *path, const char *word, const char *ext, int *count,
                            int64_t **numbers);

/* Removes the files of every frame numbered above `last` (-1: of all frames). */
cf_status cf_folder_cut_frames(const char *path, int64_t last);

#endif
