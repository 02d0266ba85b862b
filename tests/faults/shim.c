/* SPDX-License-Identifier: MIT
 *
 * A disk that fails on demand: preloaded (LD_PRELOAD), it counts the calls by which a program changes the files below
 * one folder, and lets one of them go wrong.
 *
 *   FAULT_FOLDER  the folder, an absolute path; calls on other files are passed on and not counted
 *   FAULT_KIND    error  the call fails and does nothing         short  a write does half of what was asked, then fails
 *                 full   this and all later writes find no space  kill   a write does half, then the process is killed
 *   FAULT_AT      which call, counted from 1; 0: none
 *   FAULT_COUNT   a file that gets the number of calls at the end
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define REAL(name, type) ((type)(size_t)dlsym(RTLD_NEXT, #name))

typedef enum fault { NONE, ERROR, SHORT, FULL, KILL } fault;

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static long calls;

static bool is_below(const char *path) {
  const char *folder = getenv("FAULT_FOLDER");
  return folder != NULL && strncmp(path, folder, strlen(folder)) == 0;
}

static bool is_watched(const int file) {
  char link[64], path[PATH_MAX];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length <= 0) return false;
  path[length] = '\0';
  return is_below(path);
}

/* What becomes of this call; `writes`: it would take room on the disk. */
static fault next(const bool writes) {
  const char *at = getenv("FAULT_AT"), *kind = getenv("FAULT_KIND");
  const long wanted = at != NULL ? atol(at) : 0;
  pthread_mutex_lock(&lock);
  const long now = ++calls;
  pthread_mutex_unlock(&lock);
  if (kind == NULL || wanted == 0 || now < wanted) return NONE;
  if (strcmp(kind, "full") == 0) return writes ? FULL : NONE;
  if (now > wanted) return NONE;
  return strcmp(kind, "short") == 0 ? SHORT : strcmp(kind, "kill") == 0 ? KILL : ERROR;
}

__attribute__((destructor)) static void tell_count(void) {
  const char *path = getenv("FAULT_COUNT");
  FILE *file = path != NULL ? fopen(path, "w") : NULL;
  if (file == NULL) return;
  fprintf(file, "%ld\n", calls);
  fclose(file);
}

static void die(void) { kill(getpid(), SIGKILL); }

/* --- bytes ------------------------------------------------------------------------------------------------ */

ssize_t write(const int file, const void *bytes, const size_t size) {
  ssize_t (*real)(int, const void *, size_t) = REAL(write, ssize_t(*)(int, const void *, size_t));
  const fault f = is_watched(file) ? next(true) : NONE;
  if (f == NONE) return real(file, bytes, size);
  if (f == SHORT) return real(file, bytes, size / 2);
  if (f == KILL) {
    (void)!real(file, bytes, size / 2);
    die();
  }
  errno = ENOSPC;
  return -1;
}

static ssize_t faulty_pwrite(const int file, const void *bytes, const size_t size, const off_t at) {
  ssize_t (*real)(int, const void *, size_t, off_t) =
      REAL(pwrite64, ssize_t(*)(int, const void *, size_t, off_t));
  const fault f = is_watched(file) ? next(true) : NONE;
  if (f == NONE) return real(file, bytes, size, at);
  if (f == SHORT) return real(file, bytes, size / 2, at);
  if (f == KILL) {
    (void)!real(file, bytes, size / 2, at);
    die();
  }
  errno = ENOSPC;
  return -1;
}

ssize_t pwrite(const int file, const void *bytes, const size_t size, const off_t at) {
  return faulty_pwrite(file, bytes, size, at);
}
ssize_t pwrite64(const int file, const void *bytes, const size_t size, const off_t at) {
  return faulty_pwrite(file, bytes, size, at);
}

size_t fwrite(const void *bytes, const size_t size, const size_t count, FILE *file) {
  size_t (*real)(const void *, size_t, size_t, FILE *) =
      REAL(fwrite, size_t(*)(const void *, size_t, size_t, FILE *));
  const fault f = is_watched(fileno(file)) ? next(true) : NONE;
  if (f == NONE) return real(bytes, size, count, file);
  const size_t half = f == SHORT || f == KILL ? real(bytes, size, count / 2, file) : 0;
  if (f == KILL) {
    fflush_unlocked(file);
    die();
  }
  errno = ENOSPC;
  return half;
}

/* --- calls that do or do not ------------------------------------------------------------------------------ */

/* Whether the call is to fail, with errno set. */
static bool fails(const fault f, const int reason) {
  if (f == KILL) die();
  errno = reason;
  return f != NONE;
}

int fflush(FILE *file) {
  int (*real)(FILE *) = REAL(fflush, int (*)(FILE *));
  const fault f = file != NULL && is_watched(fileno(file)) ? next(true) : NONE;
  return fails(f, ENOSPC) ? EOF : real(file);
}

int fclose(FILE *file) {
  int (*real)(FILE *) = REAL(fclose, int (*)(FILE *));
  const fault f = is_watched(fileno(file)) ? next(true) : NONE;
  if (f == KILL) die();
  const int done = real(file); /* closed in any case */
  return fails(f, ENOSPC) ? EOF : done;
}

int close(const int file) {
  int (*real)(int) = REAL(close, int (*)(int));
  const fault f = is_watched(file) ? next(false) : NONE;
  if (f == KILL) die();
  const int done = real(file);
  return fails(f, EIO) ? -1 : done;
}

int fsync(const int file) {
  int (*real)(int) = REAL(fsync, int (*)(int));
  return fails(is_watched(file) ? next(false) : NONE, EIO) ? -1 : real(file);
}

int fdatasync(const int file) {
  int (*real)(int) = REAL(fdatasync, int (*)(int));
  return fails(is_watched(file) ? next(false) : NONE, EIO) ? -1 : real(file);
}

static int faulty_truncate(const int file, const off_t size) {
  int (*real)(int, off_t) = REAL(ftruncate64, int (*)(int, off_t));
  return fails(is_watched(file) ? next(false) : NONE, EIO) ? -1 : real(file, size);
}

int ftruncate(const int file, const off_t size) { return faulty_truncate(file, size); }
int ftruncate64(const int file, const off_t size) { return faulty_truncate(file, size); }

int rename(const char *from, const char *to) {
  int (*real)(const char *, const char *) = REAL(rename, int (*)(const char *, const char *));
  char path[PATH_MAX];
  const bool watched = realpath(from, path) != NULL && is_below(path);
  return fails(watched ? next(false) : NONE, EIO) ? -1 : real(from, to);
}

int unlink(const char *name) {
  int (*real)(const char *) = REAL(unlink, int (*)(const char *));
  char path[PATH_MAX];
  const bool watched = realpath(name, path) != NULL && is_below(path);
  return fails(watched ? next(false) : NONE, EIO) ? -1 : real(name);
}
