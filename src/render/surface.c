/* SPDX-License-Identifier: MIT */
#include "render/surface.h"

#include "base/real.h"

/* --- where --------------------------------------------------------------------------------------------------------- */

static cf_vec vec(const float v[3]) { return (cf_vec){v[0], v[1], v[2]}; }

static cf_vec weighed(const float (*v)[3], const uint32_t corner[3], const cf_hit *hit) {
  const cf_vec a = cf_vec_scale(1 - hit->u - hit->v, vec(v[corner[0]]));
  return cf_vec_along(cf_vec_along(a, hit->u, vec(v[corner[1]])), hit->v, vec(v[corner[2]]));
}

static cf_vec colour_of(const cf_thing *t, const cf_hit *hit) {
  if (t->solid != NULL && t->solid->colour != NULL)
    return weighed(t->solid->colour, t->solid->corner[hit->part], hit);
  if (t->balls != NULL && t->balls->colour != NULL) return vec(t->balls->colour[hit->part]);
  return (cf_vec){1, 1, 1};
}

/* The normals of the corners between them, drawn to that of the triangle where they say little about it. */
static cf_vec smooth_normal(const cf_solid *b, const cf_hit *hit, const cf_vec flat) {
  const cf_vec n = cf_vec_unit(weighed(b->normal, b->corner[hit->part], hit));
  return cf_vec_unit(cf_vec_mix(flat, n, cf_smooth_step(0, 0.3f, cf_vec_dot(n, flat))));
}

void cf_surface_meet(const cf_stage *s, const cf_ray *ray, const cf_hit *hit, cf_point *p) {
  const cf_thing *t = &s->thing[hit->object];
  const cf_vec flat = cf_vec_unit(hit->normal);
  const bool smooth = t->solid != NULL && t->solid->normal != NULL;
  const cf_vec normal = smooth ? smooth_normal(t->solid, hit, flat) : flat;
  const bool leaving = cf_vec_dot(ray->along, flat) > 0;
  *p = (cf_point){.at = cf_vec_along(ray->from, hit->distance, ray->along),
                  .flat = cf_vec_scale(leaving ? -1 : 1, flat),
                  .normal = cf_vec_scale(leaving ? -1 : 1, normal),
                  .colour = cf_vec_times(colour_of(t, hit), t->material->tint),
                  .material = t->material,
                  .leaving = leaving};
  /* A smooth normal may look away from the viewer near an outline. */
  if (cf_vec_dot(p->normal, ray->along) > 0) p->normal = p->flat;
  const float size = fmaxf(fabsf(p->at.x), fmaxf(fabsf(p->at.y), fabsf(p->at.z)));
  p->skin = 1e-4f * hit->distance + 4e-7f * size;
}

/* --- around ---------------------------------------------------------------------------------------------------------- */

cf_vec cf_surface_around(const cf_stage *s, const cf_vec along, const bool lamps) {
  cf_vec sum = cf_sky_from(&s->studio->sky, along);
  for (int l = 0; lamps && l < s->studio->lights; ++l) {
    const cf_light *light = &s->studio->light[l];
    const float spread = fmaxf(light->spread, 0.02f), edge = cosf(1.3f * spread), full = cosf(0.7f * spread);
    const float seen = cf_smooth_step(edge, full, cf_vec_dot(along, light->toward));
    /* What lights a surface as `colour` does fills pi sin^2(spread) of the half sphere. */
    const float strength = fminf(1 / (sinf(spread) * sinf(spread)), 60);
    sum = cf_vec_along(sum, seen * strength, light->colour);
  }
  return sum;
}

float cf_surface_mirror(const cf_point *p, const float cosine) {
  const float n = p->material->index > 0 ? p->material->index : 1, base = (n - 1) / (n + 1);
  const float straight = p->material->clear > 0 ? base * base : p->material->gloss;
  const float c = 1 - fminf(fmaxf(cosine, 0), 1);
  return straight + (1 - straight) * c * c * c * c * c * (1 - 0.8f * p->material->roughness);
}

/* --- lights ------------------------------------------------------------------------------------------------------------ */

/* What comes through to p from a direction: nothing past what is opaque, part through bodies that let light in. */
static cf_vec open_to(const cf_stage *s, const cf_point *p, const cf_ray *ray) {
  if (p->material->through <= 0)
    return cf_rays_blocked(s->rays, ray, 0, INFINITY) ? (cf_vec){0, 0, 0} : (cf_vec){1, 1, 1};
  cf_vec kept = {1, 1, 1};
  cf_ray on = *ray;
  for (int step = 0; step < 8; ++step) {
    cf_hit hit;
    cf_point met;
    if (!cf_rays_hit(s->rays, &on, 0, INFINITY, &hit)) return kept;
    cf_surface_meet(s, &on, &hit, &met);
    if (met.material->through <= 0 && met.material->clear <= 0) return (cf_vec){0, 0, 0};
    if (met.leaving) kept = cf_vec_times(kept, cf_vec_fade(cf_vec_scale(hit.distance, met.material->absorb)));
    on.from = cf_vec_along(met.at, -met.skin, met.flat);
  }
  return (cf_vec){0, 0, 0};
}

/* A direction to some point of the light. */
static cf_vec toward(const cf_light *light, cf_dice *dice) {
  float at[2], disc[2];
  cf_vec s, t;
  cf_dice_pair(dice, at);
  cf_sample_disc(at, disc);
  cf_vec_frame(light->toward, &s, &t);
  const float wide = tanf(fminf(light->spread, 1.4f));
  return cf_vec_unit(cf_vec_along(cf_vec_along(light->toward, wide * disc[0], s), wide * disc[1], t));
}

/* GGX's highlight with Smith's shadowing, times the cosine to the light; of a large light as of a small one on a rougher
 * surface. */
static float highlight(const cf_point *p, const cf_vec view, const cf_light *from) {
  const cf_vec light = from->toward, half = cf_vec_unit(cf_vec_add(view, light));
  const float nl = cf_vec_dot(p->normal, light), nv = fmaxf(cf_vec_dot(p->normal, view), 1e-3f);
  if (nl <= 0 || p->material->gloss <= 0) return 0;
  const float rough = p->material->roughness * p->material->roughness;
  const float a2 = fmaxf(rough * rough + 0.25f * from->spread * from->spread, 1e-5f);
  const float nh = cf_vec_dot(p->normal, half), d = nh * nh * (a2 - 1) + 1;
  const float spread = a2 / (d * d),
              shadow = 0.5f / (nl * sqrtf(nv * nv * (1 - a2) + a2) + nv * sqrtf(nl * nl * (1 - a2) + a2));
  return spread * shadow * nl * cf_surface_mirror(p, cf_vec_dot(view, half));
}

static cf_vec from_light(const cf_stage *s, const cf_ray *ray, const cf_point *p, const int l,
                         cf_dice *dice) {
  const cf_material *m = p->material;
  const cf_light *light = &s->studio->light[l];
  const cf_vec way = toward(light, dice), view = cf_vec_scale(-1, ray->along);
  const float nl = cf_vec_dot(p->normal, way), side = cf_vec_dot(p->flat, way);
  /* What goes in comes out on all sides: half of it as if from behind, half with the cosine wrapped around. */
  const float wrapped = fmaxf((nl + m->through) / (1 + m->through), 0) / (1 + m->through);
  const float diffuse = (1 - m->through) * fmaxf(nl, 0) + m->through * (0.5f * wrapped + 0.25f);
  if ((side <= 0 || nl <= 0) && m->through <= 0) return (cf_vec){0, 0, 0};
  const cf_ray out = {cf_vec_along(p->at, side > 0 ? p->skin : -p->skin, p->flat), way, ray->time};
  cf_vec kept = open_to(s, p, &out);
  if (cf_vec_luminance(kept) <= 0) return kept;
  for (int i = 0; i < s->studio->media; ++i)
    kept = cf_vec_times(kept, cf_medium_shade(s->studio->medium[i], l, p->at));
  const float shine = highlight(p, view, light);
  const cf_vec sent = cf_vec_add(cf_vec_scale(diffuse, p->colour), (cf_vec){shine, shine, shine});
  return cf_vec_times(cf_vec_times(sent, kept), light->colour);
}

/* --- the sky ------------------------------------------------------------------------------------------------------------- */

/* One ray finds the sky, or what stands in front of it, lit as if by the mean of the sky. */
static cf_vec from_sky(const cf_stage *s, const cf_ray *ray, const cf_point *p, cf_dice *dice) {
  float at[2];
  cf_hit hit;
  cf_dice_pair(dice, at);
  const cf_ray out = {cf_vec_along(p->at, p->skin, p->flat), cf_sample_cosine(at, p->normal), ray->time};
  if (!cf_rays_hit(s->rays, &out, 0, INFINITY, &hit)) return cf_sky_from(&s->studio->sky, out.along);
  cf_point met;
  cf_surface_meet(s, &out, &hit, &met);
  const cf_sky *sky = &s->studio->sky;
  const cf_vec mean = cf_vec_mix(sky->horizon, sky->zenith, 0.5f);
  const float handed = s->studio->bounce * (met.leaving ? 1 : 0.6f);
  return cf_vec_scale(handed, cf_vec_times(mean, met.colour));
}

/* Fresnel's part of what lies where the surface mirrors to. */
static cf_vec mirrored(const cf_stage *s, const cf_ray *ray, const cf_point *p) {
  const float cosine = -cf_vec_dot(ray->along, p->normal), part = cf_surface_mirror(p, cosine);
  if (p->material->gloss <= 0 || p->material->roughness > 0.6f) return (cf_vec){0, 0, 0};
  const cf_ray out = {cf_vec_along(p->at, p->skin, p->flat),
                      cf_vec_unit(cf_vec_along(ray->along, 2 * cosine, p->normal)), ray->time};
  if (cf_rays_blocked(s->rays, &out, 0, INFINITY)) return (cf_vec){0, 0, 0};
  return cf_vec_scale(part, cf_sky_from(&s->studio->sky, out.along));
}

cf_vec cf_surface_light(const cf_stage *s, const cf_ray *ray, const cf_point *p, cf_dice *dice) {
  if (p->material->bright) return p->colour;
  cf_vec sum = cf_vec_times(p->colour, from_sky(s, ray, p, dice));
  for (int l = 0; l < s->studio->lights; ++l) sum = cf_vec_add(sum, from_light(s, ray, p, l, dice));
  return cf_vec_add(sum, mirrored(s, ray, p));
}
