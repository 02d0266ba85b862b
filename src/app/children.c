/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "app/children.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "app/stop.h"

enum { PAUSE = 20 * 1000 * 1000, NOT_STARTED = 127 }; /* ns between two looks */

/* In the child: what it prints is not for the user of the sweep, unless it fails. */
static void become(const cf_child *child, const pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(NOT_STARTED);
  const int nothing = open("/dev/null", O_WRONLY);
  if (nothing >= 0) dup2(nothing, STDOUT_FILENO);
  if (child->said != NULL) dup2(fileno(child->said), STDERR_FILENO);
  signal(SIGPIPE, SIG_DFL);
  /* Ctrl-C goes to this process alone, which passes it on once: a second one would end a run without ceremony. */
  setpgid(0, 0);
  execv("/proc/self/exe", child->argv);
  _exit(NOT_STARTED);
}

static cf_status start(cf_child *child) {
  const pid_t parent = getpid();
  fflush(NULL);
  child->said = tmpfile(); /* without one it says so at once */
  const pid_t made = fork();
  if (made < 0) return cf_fail(CF_FAILED, "no process can be made: %s", strerror(errno));
  if (made == 0) become(child, parent);
  child->process = made;
  return CF_OK;
}

/* Passes on what a child said, if it failed. */
static void hear(cf_child *child) {
  char line[1024];
  if (child->said == NULL) return;
  rewind(child->said);
  while (child->code != 0 && child->code != cf_status_exit_code(CF_STOPPED) &&
         fgets(line, sizeof line, child->said) != NULL)
    fputs(line, stderr);
  fclose(child->said);
  child->said = NULL;
}

/* One that is told to stop before it listens simply ends. */
static int code_of(const int how) {
  if (WIFEXITED(how)) return WEXITSTATUS(how);
  return WTERMSIG(how) == SIGTERM ? cf_status_exit_code(CF_STOPPED) : 128 + WTERMSIG(how);
}

static void note_end(cf_children *c, const pid_t process, const int how) {
  for (int i = 0; i < c->count; ++i) {
    if (c->child[i].process != process) continue;
    c->child[i].process = 0;
    c->child[i].code = code_of(how);
    hear(&c->child[i]);
    if (c->ended != NULL) c->ended(c->context, i);
  }
}

static void stop_all(const cf_children *c) {
  for (int i = 0; i < c->count; ++i)
    if (c->child[i].process > 0) kill((pid_t)c->child[i].process, SIGTERM);
}

cf_status cf_children_run(cf_children *c) {
  int next = 0, running = 0;
  bool stopping = false;
  cf_status status = CF_OK;
  for (int i = 0; i < c->count; ++i) c->child[i].code = -1;
  for (;;) {
    int how;
    if (!stopping && (cf_stop_asked() || status != CF_OK)) {
      stopping = true;
      stop_all(c);
    }
    while (!stopping && running < c->jobs && next < c->count && status == CF_OK) {
      status = start(&c->child[next++]);
      if (status == CF_OK) ++running;
    }
    if (running == 0) break;
    const pid_t ended = waitpid(-1, &how, WNOHANG);
    if (ended > 0) {
      --running;
      note_end(c, ended, how);
    } else {
      nanosleep(&(struct timespec){.tv_nsec = PAUSE}, NULL);
    }
  }
  if (status == CF_OK && stopping) return cf_fail(CF_STOPPED, "stopped");
  return status;
}
