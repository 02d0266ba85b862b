/* SPDX-License-Identifier: MIT
 *
 * cattaneo movie DIR [-o FILM.mp4]
 *
 * Frames go as raw pixels through a pipe to ffmpeg, a program of its own, which writes aside; the film gets its name when it
 * is whole.
 */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/command.h"
#include "app/showing.h"
#include "app/stop.h"
#include "base/mem.h"

enum { NOT_STARTED = 127, SAID = 600 };

typedef struct film {
  cf_draft draft;
  int width, height; /* even, as films want them */
  double fps;
  pid_t process;
  int pipe;
  FILE *said;
} film;

/* --- ffmpeg --------------------------------------------------------------------------------------------------------------- */

/* In the child. */
static void become_ffmpeg(const film *f, const int from) {
  char size[48], rate[48];
  snprintf(size, sizeof size, "%dx%d", f->width, f->height);
  snprintf(rate, sizeof rate, "%.10g", f->fps);
  const int nothing = open("/dev/null", O_WRONLY);
  dup2(from, STDIN_FILENO);
  if (nothing >= 0) dup2(nothing, STDOUT_FILENO);
  if (f->said != NULL) dup2(fileno(f->said), STDERR_FILENO);
  signal(SIGPIPE, SIG_DFL);
  signal(SIGINT, SIG_IGN); /* the end of the pipe tells it */
  /* Grain is kept: crf 16; yuv420p is what every player reads; bt709 is said so that colours come out as they went in. */
  execlp("ffmpeg", "ffmpeg", "-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo", "-pixel_format",
         "rgb24", "-video_size", size, "-framerate", rate, "-i", "-", "-vf",
         "scale=out_color_matrix=bt709:out_range=tv", "-c:v", "libx264", "-preset", "slow", "-crf", "16",
         "-pix_fmt", "yuv420p", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709",
         "-movflags", "+faststart", "-f", "mp4", f->draft.temporary.text, (char *)NULL);
  if (errno != ENOENT) perror("ffmpeg");
  _exit(NOT_STARTED);
}

static cf_status start(film *f) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return cf_fail(CF_FAILED, "no pipe can be made: %s", strerror(errno));
  f->said = tmpfile();
  fflush(NULL);
  f->process = fork();
  if (f->process == 0) become_ffmpeg(f, ends[0]);
  close(ends[0]);
  f->pipe = ends[1];
  if (f->process > 0) return CF_OK;
  close(f->pipe);
  return cf_fail(CF_FAILED, "no process can be made: %s", strerror(errno));
}

/* The first lines that ffmpeg said. */
static void hear(film *f, char *text, const size_t size) {
  text[0] = '\0';
  if (f->said == NULL) return;
  rewind(f->said);
  text[fread(text, 1, size - 1, f->said)] = '\0';
  text[strcspn(text, "\n")] = '\0';
}

static cf_status finish(film *f, const cf_status so_far) {
  char said[SAID];
  int how = 0;
  close(f->pipe);
  while (waitpid(f->process, &how, 0) < 0 && errno == EINTR) continue;
  hear(f, said, sizeof said);
  if (f->said != NULL) fclose(f->said);
  const int code = WIFEXITED(how) ? WEXITSTATUS(how) : 128;
  if (so_far == CF_OK && code == 0) return cf_draft_keep(&f->draft);
  cf_draft_drop(&f->draft);
  if (code == NOT_STARTED && said[0] != '\0')
    return cf_fail(CF_FAILED, "ffmpeg, which films are made with, cannot be started: %s", said);
  if (code == NOT_STARTED)
    return cf_fail(CF_FAILED, "ffmpeg is not installed, and films are made with it: apt-get install ffmpeg");
  if (so_far != CF_OK && so_far != CF_CANNOT_WRITE) return so_far;
  return cf_fail(CF_CANNOT_WRITE, "%s: ffmpeg could not write the film%s%s", f->draft.path.text,
                 said[0] != '\0' ? ": " : "", said);
}

/* --- frames ----------------------------------------------------------------------------------------------------------------- */

static cf_status send(const film *f, const cf_canvas *c) {
  for (int y = 0; y < f->height; ++y) {
    const uint8_t *row = c->rgb + 3 * (size_t)y * (size_t)c->width;
    for (size_t sent = 0, all = 3 * (size_t)f->width; sent < all;) {
      const ssize_t n = write(f->pipe, row + sent, all - sent);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return cf_fail(CF_CANNOT_WRITE, "ffmpeg took no more frames");
      sent += (size_t)n;
    }
  }
  return CF_OK;
}

static cf_status draw_frame(film *f, cf_showing *s, const int64_t i, cf_canvas *c) {
  *c = (cf_canvas){.rgb = NULL};
  CF_TRY(cf_showing_load(s, s->number[i]));
  CF_TRY(cf_showing_draw(s, c));
  if (i == 0) {
    f->width = c->width & ~1, f->height = c->height & ~1;
    return start(f);
  }
  if (c->width >= f->width && c->height >= f->height) return CF_OK;
  return cf_fail(CF_FAILED, "frame %" PRId64 " is %d x %d pixels, the first was %d x %d", s->number[i],
                 c->width, c->height, f->width, f->height);
}

static cf_status film_all(film *f, cf_showing *s, const bool tell) {
  cf_status status = CF_OK;
  for (int64_t i = 0; i < s->frames && status == CF_OK; ++i) {
    cf_canvas c;
    status = draw_frame(f, s, i, &c);
    if (status == CF_OK) status = send(f, &c);
    cf_canvas_destroy(&c);
    if (status == CF_OK && cf_stop_asked()) status = cf_fail(CF_STOPPED, "stopped; no film was written");
    if (status == CF_OK && tell) fprintf(stderr, "frame %" PRId64 " of %d\n", i + 1, s->frames);
  }
  return f->process > 0 ? finish(f, status) : status;
}

cf_status cf_movie_command(cf_arguments *a) {
  film f = {.fps = a->fps > 0 ? a->fps : 24};
  cf_showing s;
  cf_path path;
  CF_TRY(cf_arguments_check_file(a, ".mp4"));
  CF_TRY(cf_showing_open(&s, a->operand[0], a));
  const int64_t from = 0, to = s.frames - 1;
  cf_stop_watch();
  cf_status status = a->output != NULL ? cf_path_make(&path, "%s", a->output)
                                       : cf_path_make(&path, "%s/movie.mp4", s.folder);
  if (status == CF_OK) status = cf_draft_try(path.text);
  if (status == CF_OK) status = cf_draft_begin(&f.draft, path.text);
  if (status == CF_OK) status = cf_showing_range(1, &s, &from, &to);
  if (status == CF_OK) status = film_all(&f, &s, a->progress != CF_PROGRESS_NONE);
  cf_showing_close(&s);
  if (status == CF_OK) printf("%s\n", path.text);
  return status;
}
