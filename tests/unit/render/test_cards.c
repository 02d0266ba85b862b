/* SPDX-License-Identifier: MIT
 *
 * Flakes: how much light they keep whatever lens and shutter do to them, where it goes, what hides what.
 *
 * also in single precision
 */
#include "testing.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/rng.h"
#include "render/cards.h"

enum { SIDE = 64, WIDE = 240, TALL = 160 };

/* A disc that fills the texture. */
static cf_flake_picture disc(void) {
  static float cover[SIDE * SIDE], bright[SIDE * SIDE], slope[SIDE * SIDE][2];
  cf_flake_picture p;
  for (int j = 0; j < SIDE; ++j)
    for (int i = 0; i < SIDE; ++i) {
      const double r = hypot(i + 0.5 - SIDE / 2.0, j + 0.5 - SIDE / 2.0) / (SIDE / 2.0);
      cover[j * SIDE + i] = r < 0.9 ? 1 : 0, bright[j * SIDE + i] = 1;
    }
  OK(cf_flake_picture_create(&p, SIDE, cover, bright, (const float(*)[2])slope));
  return p;
}

static cf_card card_at(const double x, const double y, const double z, const double radius) {
  return (cf_card){
      .at = {(float)x, (float)y, (float)z}, .right = {(float)radius, 0, 0}, .up = {0, 0, (float)radius}};
}

static cf_camera camera_with(const double aperture) {
  return (cf_camera){.aim = {0, 1, 0}, .angle = 30, .focus = 2, .aperture = aperture};
}

/* Only scattered light, and all of what is behind is dark. */
static const cf_cards_light even = {.sky = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, .tint = {1, 1, 1}};

static cf_film draw(const cf_card *card, const int64_t count, const cf_camera *camera, const double shutter,
                    const int threads) {
  cf_flake_picture p = disc();
  const cf_cards all = {1, &p, count, card};
  cf_film f;
  OK(cf_film_create(&f, WIDE, TALL));
  for (int i = 0; i < WIDE * TALL; ++i) f.distance[i] = INFINITY;
  OK(cf_cards_draw(&all, &even, camera, shutter, threads, &f));
  cf_flake_picture_destroy(&p);
  return f;
}

typedef struct moments {
  double sum, x, y, wide, tall; /* total, middle, root mean squares about it */
} moments;

static moments moments_of(const cf_film *f) {
  moments m = {0, 0, 0, 0, 0};
  for (int pass = 0; pass < 2; ++pass) {
    for (int i = 0; i < WIDE * TALL; ++i) {
      const double v = (double)f->light[i].y, x = i % WIDE + 0.5, y = (double)(i / WIDE) + 0.5;
      if (pass == 0)
        m.sum += v, m.x += v * x, m.y += v * y;
      else
        m.wide += v * (x - m.x) * (x - m.x), m.tall += v * (y - m.y) * (y - m.y);
    }
    if (pass == 0) m.x /= m.sum, m.y /= m.sum;
  }
  m.wide = sqrt(m.wide / m.sum), m.tall = sqrt(m.tall / m.sum);
  return m;
}

static double pixels_a_metre(const double distance) {
  return TALL / (2 * tan(15 * acos(-1.0) / 180) * distance);
}

/* Light to a few per cent of a pixel's worth wherever the flake lies between pixels, and in the mean exactly. */
static void a_flake_has_its_place_size_and_light(void **state) {
  const cf_camera sharp = camera_with(0);
  const double scale = pixels_a_metre(2);
  (void)state;
  for (double radius = 0.001; radius < 0.3; radius *= 1.7) {
    const double r = 0.9 * radius * scale;
    double mean = 0;
    for (int n = 0; n < 9; ++n) {
      const double x = 0.13 + n % 3 / (3 * scale), z = 0.07 + n / 3 / (3 * scale);
      const cf_card card = card_at(x, 2, z, radius);
      cf_film f = draw(&card, 1, &sharp, 0, 1);
      const moments m = moments_of(&f);
      const double light = m.sum / (acos(-1.0) * r * r);
      CLOSE(light, 1, r < 1 ? 0.25 : r < 4 ? 0.1 : 0.02);
      CLOSE(m.x, WIDE / 2.0 + x * scale, 0.15);
      CLOSE(m.y, TALL / 2.0 - z * scale, 0.15);
      if (r > 5) CLOSE(m.wide, r / 2, 0.05 * r); /* of a disc */
      mean += light / 9;
      cf_film_destroy(&f);
    }
    CLOSE(mean, 1, 0.04);
  }
}

/* The lens spreads the light of a flake over the circle of confusion and loses none: the variance across is that of the
 * flake plus that of a disc of the lens' blur. */
static void focus_spreads_light_and_keeps_it(void **state) {
  const cf_camera open = camera_with(0.2), sharp = camera_with(0);
  (void)state;
  for (double z = 1; z < 5; z += 0.7) {
    const cf_card card = card_at(0, z, 0, 0.02);
    cf_film soft = draw(&card, 1, &open, 0, 1), hard = draw(&card, 1, &sharp, 0, 1);
    const moments a = moments_of(&soft), b = moments_of(&hard);
    const double blur = 0.1 * fabs(z - 2) / 2 * pixels_a_metre(z);
    const double r = 0.9 * 0.02 * pixels_a_metre(z);
    CLOSE(a.sum / (acos(-1.0) * r * r), 1, 0.04);
    CLOSE(a.wide, sqrt(b.wide * b.wide + blur * blur / 4), 0.06 * blur + 0.2);
    CLOSE(a.tall, sqrt(b.tall * b.tall + blur * blur / 4), 0.06 * blur + 0.2);
    cf_film_destroy(&hard);
    cf_film_destroy(&soft);
  }
}

/* Motion smears along the way alone, by way/sqrt(12). */
static void motion_smears_along_the_way(void **state) {
  const cf_camera sharp = camera_with(0);
  cf_card card = card_at(0, 2, 0, 0.02);
  (void)state;
  cf_film rest = draw(&card, 1, &sharp, 0.01, 1);
  card.velocity = (cf_vec){0, 0, -8};
  cf_film fall = draw(&card, 1, &sharp, 0.01, 1);
  const moments a = moments_of(&rest), b = moments_of(&fall);
  const double way = 0.08 * pixels_a_metre(2);
  CLOSE(b.sum / a.sum, 1, 0.04);
  CLOSE(b.wide, a.wide, 0.3);
  CLOSE(b.tall, sqrt(a.tall * a.tall + way * way / 12), 0.06 * way);
  cf_film_destroy(&fall);
  cf_film_destroy(&rest);
}

/* No grain: blurred flakes have no pixel that stands out from its neighbours. */
static void soft_flakes_have_no_grain(void **state) {
  const cf_camera open = camera_with(0.25);
  const cf_card card = card_at(0, 1, 0, 0.03);
  (void)state;
  cf_film f = draw(&card, 1, &open, 0, 1);
  double most = 0, rough = 0;
  for (int y = 1; y + 1 < TALL; ++y)
    for (int x = 1; x + 1 < WIDE; ++x) {
      const cf_vec *p = &f.light[y * WIDE + x];
      const double mean = 0.25 * ((double)p[-1].y + (double)p[1].y + (double)p[-WIDE].y + (double)p[WIDE].y);
      most = fmax(most, (double)p->y), rough = fmax(rough, fabs((double)p->y - mean));
    }
  BELOW(rough, 0.06 * most);
  cf_film_destroy(&f);
}

static void what_is_near_hides_what_is_far(void **state) {
  const cf_camera sharp = camera_with(0);
  const cf_card card[2] = {card_at(0, 2, 0, 0.1), card_at(0, 3, 0, 0.1)};
  const cf_card turned[2] = {card[1], card[0]};
  const size_t middle = (size_t)(TALL / 2) * WIDE + WIDE / 2;
  (void)state;
  cf_film one = draw(card, 2, &sharp, 0, 1), other = draw(turned, 2, &sharp, 0, 1);
  assert_memory_equal(one.light, other.light, sizeof *one.light * WIDE * TALL);
  cf_film alone = draw(card, 1, &sharp, 0, 1);
  CLOSE(one.light[middle].y, (double)alone.light[middle].y * 1.2, 0.01); /* ice lets a fifth by */
  /* Behind a wall at 2.5 m there is nothing of the far one; behind one that fills a quarter of each pixel, the rest. */
  cf_flake_picture p = disc();
  const cf_cards all = {1, &p, 1, &card[1]};
  float seen[3];
  for (int quarters = 0; quarters < 3; ++quarters) {
    for (int i = 0; i < WIDE * TALL; ++i)
      alone.light[i] = (cf_vec){0, 0, 0}, alone.distance[i] = 2.5f,
      alone.share[i] = quarters == 2 ? 1 : 0.25f * (float)quarters;
    OK(cf_cards_draw(&all, &even, &sharp, 0, 1, &alone));
    seen[quarters] = alone.light[middle].y;
  }
  CLOSE(seen[1], 0.75 * (double)seen[0], 1e-6);
  CLOSE(seen[2], 0, 0);
  assert_true(seen[0] > 0.1f);
  cf_flake_picture_destroy(&p);
  cf_film_destroy(&alone);
  cf_film_destroy(&other);
  cf_film_destroy(&one);
}

/* A plate that stands as a mirror between light and eye glints, one that does not is dull. */
static void plates_glint_where_they_mirror_the_light(void **state) {
  cf_flake_picture p = disc();
  const cf_camera sharp = camera_with(0);
  const cf_light sun = {.toward = {0, 0, 1}, .colour = {1, 1, 1}};
  const cf_cards_light how = {.lights = 1, .light = &sun, .tint = {1, 1, 1}, .glint = 5};
  const size_t middle = (size_t)(TALL / 2) * WIDE + WIDE / 2;
  double seen[2];
  (void)state;
  for (int n = 0; n < 2; ++n) {
    const cf_vec normal = cf_vec_unit((cf_vec){0, -1, n == 0 ? 1 : -0.2f}), right = {1, 0, 0};
    const cf_card card = {.at = {0, 2, 0},
                          .right = cf_vec_scale(0.1f, right),
                          .up = cf_vec_scale(0.1f, cf_vec_cross(normal, right))};
    const cf_cards all = {1, &p, 1, &card};
    cf_film f;
    OK(cf_film_create(&f, WIDE, TALL));
    for (int i = 0; i < WIDE * TALL; ++i) f.distance[i] = INFINITY;
    OK(cf_cards_draw(&all, &how, &sharp, 0, 1, &f));
    seen[n] = (double)f.light[middle].y;
    cf_film_destroy(&f);
  }
  assert_true(seen[0] > 5 && seen[1] < 1);
  cf_flake_picture_destroy(&p);
}

static void any_number_of_threads_draws_the_same(void **state) {
  const cf_camera open = camera_with(0.05);
  static cf_card card[500];
  (void)state;
  for (uint64_t i = 0; i < 500; ++i) {
    card[i] = card_at(2 * cf_random(1, 0, i, 0) - 1, 0.3 + 4 * cf_random(1, 1, i, 0),
                      cf_random(1, 2, i, 0) - 0.5, 0.01 + 0.05 * cf_random(1, 3, i, 0));
    card[i].velocity = (cf_vec){0.3f, 0, -1};
  }
  cf_film one = draw(card, 500, &open, 0.02, 1), many = draw(card, 500, &open, 0.02, 4);
  assert_memory_equal(one.light, many.light, sizeof *one.light * WIDE * TALL);
  cf_film_destroy(&many);
  cf_film_destroy(&one);
}

static void what_cannot_be_drawn_is_said(void **state) {
  cf_flake_picture p = disc();
  const cf_camera sharp = camera_with(0);
  cf_card card = card_at(0, 1, 0, 0.1);
  const cf_cards all = {1, &p, 1, &card};
  cf_flake_picture none;
  cf_film f;
  (void)state;
  OK(cf_film_create(&f, 8, 8));
  card.picture = 3;
  assert_int_equal(cf_cards_draw(&all, &even, &sharp, 0, 1, &f), CF_BAD_ARGUMENT);
  assert_non_null(strstr(cf_status_sentence(), "picture 3 of 1"));
  assert_int_equal(cf_flake_picture_create(&none, 0, NULL, NULL, NULL), CF_BAD_ARGUMENT);
  cf_film_destroy(&f);
  cf_flake_picture_destroy(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_flake_has_its_place_size_and_light),
      cmocka_unit_test(focus_spreads_light_and_keeps_it),
      cmocka_unit_test(motion_smears_along_the_way),
      cmocka_unit_test(soft_flakes_have_no_grain),
      cmocka_unit_test(what_is_near_hides_what_is_far),
      cmocka_unit_test(plates_glint_where_they_mirror_the_light),
      cmocka_unit_test(any_number_of_threads_draws_the_same),
      cmocka_unit_test(what_cannot_be_drawn_is_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
