#include "tests/benchmarks/embree_calls.h"

#include <embree3/rtcore.h>

#include <vector>

namespace penumbra {
namespace {

RTCRay load_ray(const vec3& origin, const vec3& direction, float tmax) {
  RTCRay ray;
  ray.org_x = origin.x;
  ray.org_y = origin.y;
  ray.org_z = origin.z;
  ray.dir_x = direction.x;
  ray.dir_y = direction.y;
  ray.dir_z = direction.z;
  ray.tnear = 0;
  ray.tfar = tmax;
  ray.time = 0;
  ray.mask = ~0u;
  ray.id = 0;
  ray.flags = 0;
  return ray;
}

void intersect_single(const void* scene_, const PathState* paths, int count) {
  auto* scene = static_cast<RTCSceneTy*>(const_cast<void*>(scene_));
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (int i = 0; i < count; ++i) {
    alignas(16) RTCRayHit r;
    r.ray = load_ray(get_ray_origin(paths, i), get_ray_direction(paths, i), get_ray_tmax(paths, i));
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    if (r.ray.tfar > 0) rtcIntersect1(scene, &context, &r);
    set_hit(paths, i, r.hit.geomID == RTC_INVALID_GEOMETRY_ID ? -1 : int(r.hit.primID));
  }
}

void occlude_single(const void* scene_, const PathState* paths, int count) {
  auto* scene = static_cast<RTCSceneTy*>(const_cast<void*>(scene_));
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (int i = 0; i < count; ++i) {
    alignas(16) RTCRay ray =
        load_ray(get_shadow_origin(paths, i), get_shadow_direction(paths, i), get_shadow_tmax(paths, i));
    const bool wanted = ray.tfar > 0;
    if (wanted) rtcOccluded1(scene, &context, &ray);
    set_shadow_transmittance(paths, i, wanted && ray.tfar < 0 ? 0.0f : 1.0f);
  }
}

/// The arrays of a block's rays; a vec3's coordinates are `capacity` apart.
RTCRayNp stream_rays(int capacity, int count, float* origin, float* direction, const float* tmax) {
  static thread_local std::vector<float> zeros, ends;
  static thread_local std::vector<unsigned> ones;
  zeros.assign(std::size_t(count), 0.0f);
  ones.assign(std::size_t(count), ~0u);
  ends.assign(tmax, tmax + count);
  RTCRayNp rays;
  rays.org_x = origin;
  rays.org_y = origin + capacity;
  rays.org_z = origin + 2 * capacity;
  rays.dir_x = direction;
  rays.dir_y = direction + capacity;
  rays.dir_z = direction + 2 * capacity;
  rays.tnear = zeros.data();
  rays.time = zeros.data();
  rays.tfar = ends.data();
  rays.mask = ones.data();
  rays.id = ones.data();
  rays.flags = ones.data();
  return rays;
}

void intersect_stream(const void* scene_, const PathState* paths, int count) {
  auto* scene = static_cast<RTCSceneTy*>(const_cast<void*>(scene_));
  static thread_local std::vector<float> numbers;
  static thread_local std::vector<unsigned> geometry, primitive, instance;
  RTCRayHitNp r;
  r.ray = stream_rays(paths->capacity, count, paths->ray_origin, paths->ray_direction, paths->ray_tmax);
  numbers.resize(std::size_t(count) * 5);
  geometry.assign(std::size_t(count), RTC_INVALID_GEOMETRY_ID);
  primitive.resize(std::size_t(count));
  instance.resize(std::size_t(count));
  r.hit.Ng_x = numbers.data();
  r.hit.Ng_y = numbers.data() + count;
  r.hit.Ng_z = numbers.data() + 2 * count;
  r.hit.u = numbers.data() + 3 * count;
  r.hit.v = numbers.data() + 4 * count;
  r.hit.primID = primitive.data();
  r.hit.geomID = geometry.data();
  r.hit.instID[0] = instance.data();
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersectNp(scene, &context, &r, unsigned(count));
  for (int i = 0; i < count; ++i)
    set_hit(paths, i,
            geometry[std::size_t(i)] == RTC_INVALID_GEOMETRY_ID ? -1 : int(primitive[std::size_t(i)]));
}

void occlude_stream(const void* scene_, const PathState* paths, int count) {
  auto* scene = static_cast<RTCSceneTy*>(const_cast<void*>(scene_));
  RTCRayNp rays =
      stream_rays(paths->capacity, count, paths->shadow_origin, paths->shadow_direction, paths->shadow_tmax);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccludedNp(scene, &context, &rays, unsigned(count));
  for (int i = 0; i < count; ++i)
    set_shadow_transmittance(paths, i, get_shadow_tmax(paths, i) > 0 && rays.tfar[i] < 0 ? 0.0f : 1.0f);
}

}  // namespace

Tracer embree_single(const EmbreeTracer& tracer) {
  return {tracer.scene(), &intersect_single, &occlude_single};
}

Tracer embree_stream(const EmbreeTracer& tracer) {
  return {tracer.scene(), &intersect_stream, &occlude_stream};
}

}  // namespace penumbra
