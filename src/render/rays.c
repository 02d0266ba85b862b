/* SPDX-License-Identifier: MIT */
#include "render/rays.h"

#include <embree3/rtcore.h>
#include <string.h>

#include "base/mem.h"

struct cf_rays {
  RTCDevice device;
  RTCScene scene;
};

static cf_status why(const cf_rays *r, const char *what) {
  const enum RTCError e = rtcGetDeviceError(r->device);
  if (e == RTC_ERROR_NONE) return CF_OK;
  if (e == RTC_ERROR_OUT_OF_MEMORY) return cf_fail(CF_NO_MEMORY, "out of memory while %s", what);
  return cf_fail(CF_FAILED, "Embree failed while %s (error %d)", what, (int)e);
}

cf_status cf_rays_create(cf_rays **r) {
  CF_TRY(CF_NEW(r, 1));
  (*r)->device = rtcNewDevice("threads=1,set_affinity=0,start_threads=0");
  if ((*r)->device != NULL) (*r)->scene = rtcNewScene((*r)->device);
  if ((*r)->scene != NULL) {
    rtcSetSceneFlags((*r)->scene, RTC_SCENE_FLAG_ROBUST);
    return CF_OK;
  }
  const cf_status s = why(*r, "starting");
  cf_rays_destroy(*r);
  *r = NULL;
  return s != CF_OK ? s : cf_fail(CF_FAILED, "Embree did not start");
}

void cf_rays_destroy(cf_rays *r) {
  if (r == NULL) return;
  if (r->scene != NULL) rtcReleaseScene(r->scene);
  if (r->device != NULL) rtcReleaseDevice(r->device);
  cf_free(r);
}

static cf_status attach(cf_rays *r, RTCGeometry g, unsigned *object) {
  rtcCommitGeometry(g);
  *object = rtcAttachGeometry(r->scene, g);
  rtcReleaseGeometry(g);
  return why(r, "a surface was added");
}

static void *room(RTCGeometry g, const enum RTCBufferType type, const unsigned slot,
                  const enum RTCFormat format, const size_t size, const int64_t count) {
  return rtcSetNewGeometryBuffer(g, type, slot, format, size, (size_t)count);
}

cf_status cf_rays_add_mesh(cf_rays *r, const int64_t vertices, const float (*at)[3], const int64_t triangles,
                           const uint32_t (*corner)[3], unsigned *object) {
  for (int64_t t = 0; t < triangles; ++t)
    for (int c = 0; c < 3; ++c)
      if (corner[t][c] >= vertices)
        return cf_fail(CF_BAD_ARGUMENT, "triangle %lld has the corner %u of %lld vertices", (long long)t,
                       (unsigned)corner[t][c], (long long)vertices);
  RTCGeometry g = rtcNewGeometry(r->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  if (g == NULL) return why(r, "a mesh was made");
  void *places = room(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof *at, vertices);
  void *corners = room(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof *corner, triangles);
  if (places != NULL && corners != NULL && vertices > 0) {
    memcpy(places, at, (size_t)vertices * sizeof *at);
    memcpy(corners, corner, (size_t)triangles * sizeof *corner);
  }
  return attach(r, g, object);
}

cf_status cf_rays_add_balls(cf_rays *r, const int64_t count, const float (*at)[4], const float (*moved)[3],
                            unsigned *object) {
  RTCGeometry g = rtcNewGeometry(r->device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
  const unsigned times = moved != NULL ? 2 : 1;
  if (g == NULL) return why(r, "balls were made");
  rtcSetGeometryTimeStepCount(g, times);
  for (unsigned t = 0; t < times; ++t) {
    float(*places)[4] = room(g, RTC_BUFFER_TYPE_VERTEX, t, RTC_FORMAT_FLOAT4, sizeof *places, count);
    if (places == NULL) break;
    for (int64_t i = 0; i < count; ++i) {
      memcpy(places[i], at[i], sizeof *places);
      for (int a = 0; a < 3 && moved != NULL; ++a) places[i][a] += ((float)t - 0.5f) * moved[i][a];
    }
  }
  return attach(r, g, object);
}

cf_status cf_rays_ready(cf_rays *r) {
  rtcCommitScene(r->scene);
  return why(r, "the tree was built");
}

bool cf_rays_bounds(const cf_rays *r, cf_vec *low, cf_vec *high) {
  struct RTCBounds b;
  rtcGetSceneBounds(r->scene, &b);
  *low = (cf_vec){b.lower_x, b.lower_y, b.lower_z}, *high = (cf_vec){b.upper_x, b.upper_y, b.upper_z};
  return low->x <= high->x;
}

static struct RTCRay embree_ray(const cf_ray *ray, const float near, const float far) {
  return (struct RTCRay){.org_x = ray->from.x,
                         .org_y = ray->from.y,
                         .org_z = ray->from.z,
                         .tnear = near,
                         .dir_x = ray->along.x,
                         .dir_y = ray->along.y,
                         .dir_z = ray->along.z,
                         .time = ray->time,
                         .tfar = far,
                         .mask = ~0u};
}

bool cf_rays_hit(const cf_rays *r, const cf_ray *ray, const float near, const float far, cf_hit *hit) {
  struct RTCIntersectContext context;
  struct RTCRayHit q = {.ray = embree_ray(ray, near, far)};
  q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcInitIntersectContext(&context);
  rtcIntersect1(r->scene, &context, &q);
  if (q.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  *hit = (cf_hit){.distance = q.ray.tfar,
                  .normal = {q.hit.Ng_x, q.hit.Ng_y, q.hit.Ng_z},
                  .u = q.hit.u,
                  .v = q.hit.v,
                  .object = q.hit.geomID,
                  .part = q.hit.primID};
  return true;
}

bool cf_rays_blocked(const cf_rays *r, const cf_ray *ray, const float near, const float far) {
  struct RTCIntersectContext context;
  struct RTCRay q = embree_ray(ray, near, far);
  rtcInitIntersectContext(&context);
  rtcOccluded1(r->scene, &context, &q);
  return q.tfar < 0;
}
