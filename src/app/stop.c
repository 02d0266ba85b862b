/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "app/stop.h"

#include <signal.h>
#include <stddef.h>

static volatile sig_atomic_t asked;

static void on_signal(const int number) {
  (void)number;
  asked = 1;
}

static void watch(const int number) {
  struct sigaction old, now = {.sa_handler = on_signal, .sa_flags = SA_RESTART | (int)SA_RESETHAND};
  sigemptyset(&now.sa_mask);
  if (sigaction(number, NULL, &old) == 0 && old.sa_handler == SIG_IGN) return;
  sigaction(number, &now, NULL);
}

void cf_stop_watch(void) {
  watch(SIGINT);
  watch(SIGTERM);
  watch(SIGHUP);
  signal(SIGPIPE, SIG_IGN);
}

bool cf_stop_asked(void) { return asked != 0; }
