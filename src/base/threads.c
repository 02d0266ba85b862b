/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "base/threads.h"

#include <pthread.h>
#include <stdbool.h>
#include <string.h>

#include "base/mem.h"

static void *wait_for(void *gate) {
  pthread_mutex_lock(gate);
  pthread_mutex_unlock(gate);
  return NULL;
}

/* As many threads as OpenMP would start, all there at the same time. */
static int try_threads(const int count, pthread_t *thread) {
  pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
  int started = 0, error = 0;
  pthread_mutex_lock(&gate);
  while (started < count && error == 0) {
    error = pthread_create(&thread[started], NULL, wait_for, &gate);
    if (error == 0) ++started;
  }
  pthread_mutex_unlock(&gate);
  while (started > 0) pthread_join(thread[--started], NULL);
  return error;
}

cf_status cf_threads_start(const int threads) {
  static _Thread_local int known = 1; /* the team of this thread has been as large as that */
  pthread_t *thread;
  if (threads <= known) return CF_OK;
  CF_TRY(CF_NEW(&thread, threads - 1));
  const int error = try_threads(threads - 1, thread);
  cf_free(thread);
  if (error != 0)
    return cf_fail(CF_OVER_LIMIT,
                   "%d threads cannot be started here (%s): use fewer, or lift the limit (see `ulimit -u` "
                   "and `ulimit -v`)",
                   threads, strerror(error));
  int there = 0;
#pragma omp parallel num_threads(threads) reduction(+ : there)
  there += 1;
  known = there;
  return CF_OK;
}
