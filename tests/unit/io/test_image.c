/* SPDX-License-Identifier: MIT
 */
#define _GNU_SOURCE
#include <signal.h>
#include <sys/resource.h>

#include "io/image.h"
#include "output_case.h"

#define WIDTH  13
#define HEIGHT 7

static cf_path folder, path;
static uint8_t pixels[WIDTH * HEIGHT * 3];

static int setup(void **state) {
  char text[] = "/tmp/cattaneo-test-XXXXXX";
  (void)state;
  assert_non_null(mkdtemp(text));
  assert_int_equal(cf_path_make(&folder, "%s", text), CF_OK);
  assert_int_equal(cf_path_make(&path, "%s/preview_000001.png", text), CF_OK);
  for (int i = 0; i < WIDTH * HEIGHT * 3; ++i) pixels[i] = (uint8_t)(i * 29);
  return 0;
}

static int teardown(void **state) {
  (void)state;
  folder_remove(folder.text);
  return 0;
}

static const cf_image_text texts[] = {{"Title", "Cone \xcf\x84 = 4"}, {"Description", "phi, t = 0.5 s"}};

static void picture_reads_back_as_written(void **state) {
  uint8_t *back;
  int width, height;
  (void)state;
  assert_int_equal(cf_image_write(path.text, WIDTH, HEIGHT, pixels, 2, texts), CF_OK);
  assert_int_equal(cf_image_read(path.text, &width, &height, &back), CF_OK);
  assert_true(width == WIDTH && height == HEIGHT);
  assert_memory_equal(back, pixels, sizeof pixels);
  cf_free(back);
}

static void texts_are_in_the_file_and_no_date(void **state) {
  char *bytes;
  size_t size;
  (void)state;
  assert_int_equal(cf_image_write(path.text, WIDTH, HEIGHT, pixels, 2, texts), CF_OK);
  assert_int_equal(cf_file_read(path.text, 1 << 20, &bytes, &size), CF_OK);
  assert_non_null(memmem(bytes, size, "iTXtTitle", 9));
  assert_non_null(memmem(bytes, size, texts[0].value, strlen(texts[0].value)));
  assert_non_null(memmem(bytes, size, "tEXtDescription", 15));
  assert_non_null(memmem(bytes, size, "tEXtSoftware\0Cattaneo ", 22));
  assert_null(memmem(bytes, size, "tIME", 4));
  cf_free(bytes);
}

static void a_full_disk_leaves_the_old_picture(void **state) {
  struct rlimit old;
  uint8_t *back;
  int width, height;
  (void)state;
  assert_int_equal(cf_image_write(path.text, WIDTH, HEIGHT, pixels, 0, NULL), CF_OK);
  signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
  for (rlim_t most = 0; most < 200; most += 50) {
    const struct rlimit limit = {most, old.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    const cf_status s = cf_image_write(path.text, WIDTH, HEIGHT, pixels, 2, texts);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
    assert_int_equal(s, CF_CANNOT_WRITE);
    assert_says("preview_000001.png: cannot be written: File too large");
  }
  assert_int_equal(files_in(folder.text), 1);
  assert_int_equal(cf_image_read(path.text, &width, &height, &back), CF_OK);
  cf_free(back);
}

static void what_is_no_picture_is_refused(void **state) {
  uint8_t *back;
  int width, height;
  (void)state;
  assert_int_equal(cf_image_read(path.text, &width, &height, &back), CF_BAD_FILE);
  assert_int_equal(cf_file_write(path.text, "\x89PNG\r\n\x1a\n", 8), CF_OK);
  assert_int_equal(cf_image_read(path.text, &width, &height, &back), CF_BAD_FILE);
  assert_null(back);
  assert_int_equal(cf_image_write(path.text, 0, 5, pixels, 0, NULL), CF_BAD_ARGUMENT);
  assert_int_equal(cf_image_write(path.text, 5, 1 << 20, pixels, 0, NULL), CF_BAD_ARGUMENT);
  assert_int_equal(cf_image_write("/no/such/folder/a.png", 1, 1, pixels, 0, NULL), CF_CANNOT_WRITE);
}

static void a_cut_picture_is_refused(void **state) {
  char *bytes;
  size_t size;
  (void)state;
  assert_int_equal(cf_image_write(path.text, WIDTH, HEIGHT, pixels, 2, texts), CF_OK);
  assert_int_equal(cf_file_read(path.text, 1 << 20, &bytes, &size), CF_OK);
  for (size_t length = 0; length + 12 < size; length += 9) {
    uint8_t *back;
    int width, height;
    assert_int_equal(cf_file_write(path.text, bytes, length), CF_OK);
    if (cf_image_read(path.text, &width, &height, &back) == CF_OK) cf_free(back); /* all pixels were there */
  }
  cf_free(bytes);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(picture_reads_back_as_written, setup, teardown),
      cmocka_unit_test_setup_teardown(texts_are_in_the_file_and_no_date, setup, teardown),
      cmocka_unit_test_setup_teardown(a_full_disk_leaves_the_old_picture, setup, teardown),
      cmocka_unit_test_setup_teardown(what_is_no_picture_is_refused, setup, teardown),
      cmocka_unit_test_setup_teardown(a_cut_picture_is_refused, setup, teardown),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
