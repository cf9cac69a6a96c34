#include "tests/benchmarks/embree_calls.h"

#include <embree3/rtcore.h>

#include <vector>

namespace penumbra {
namespace {

RTCRay load_ray(const float* f, int capacity, int i, int origin, int direction, int tmax) {
  RTCRay ray;
  ray.org_x = f[origin * capacity + i];
  ray.org_y = f[(origin + 1) * capacity + i];
  ray.org_z = f[(origin + 2) * capacity + i];
  ray.dir_x = f[direction * capacity + i];
  ray.dir_y = f[(direction + 1) * capacity + i];
  ray.dir_z = f[(direction + 2) * capacity + i];
  ray.tnear = 0;
  ray.tfar = f[tmax * capacity + i];
  ray.time = 0;
  ray.mask = ~0u;
  ray.id = 0;
  ray.flags = 0;
  return ray;
}

void intersect_single(const void* scene_, float* f, int* ints, int capacity, int count) {
  auto* scene = static_cast<RTCSceneTy*>(const_cast<void*>(scene_));
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (int i = 0; i < count; ++i) {
    alignas(16) RTCRayHit r;
    r.ray = load_ray(f, capacity, i, RAY_ORIGIN_X, RAY_DIRECTION_X, RAY_TMAX);
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    if (r.ray.tfar > 0) rtcIntersect1(scene, &context, &r);
    ints[HIT * capacity + i] = r.hit.geomID == RTC_INVALID_GEOMETRY_ID ? -1 : int(r.hit.primID);
  }
}

void occlude_single(const void* scene_, float* f, int* ints, int capacity, int count) {
  auto* scene = static_cast<RTCSceneTy*>(const_cast<void*>(scene_));
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (int i = 0; i < count; ++i) {
    alignas(16) RTCRay ray = load_ray(f, capacity, i, SHADOW_ORIGIN_X, SHADOW_DIRECTION_X, SHADOW_TMAX);
    const bool wanted = ray.tfar > 0;
    if (wanted) rtcOccluded1(scene, &context, &ray);
    ints[HIT * capacity + i] = wanted && ray.tfar < 0 ? 0 : -1;
  }
}

RTCRayNp stream_rays(float* f, int capacity, int count, int origin, int direction, int tmax) {
  static thread_local std::vector<float> zeros, ends;
  static thread_local std::vector<unsigned> ones;
  zeros.assign(std::size_t(count), 0.0f);
  ones.assign(std::size_t(count), ~0u);
  ends.assign(f + tmax * capacity, f + tmax * capacity + count);
  RTCRayNp rays;
  rays.org_x = f + origin * capacity;
  rays.org_y = f + (origin + 1) * capacity;
  rays.org_z = f + (origin + 2) * capacity;
  rays.dir_x = f + direction * capacity;
  rays.dir_y = f + (direction + 1) * capacity;
  rays.dir_z = f + (direction + 2) * capacity;
  rays.tnear = zeros.data();
  rays.time = zeros.data();
  rays.tfar = ends.data();
  rays.mask = ones.data();
  rays.id = ones.data();
  rays.flags = ones.data();
  return rays;
}

void intersect_stream(const void* scene_, float* f, int* ints, int capacity, int count) {
  auto* scene = static_cast<RTCSceneTy*>(const_cast<void*>(scene_));
  static thread_local std::vector<float> numbers;
  static thread_local std::vector<unsigned> geometry, primitive, instance;
  RTCRayHitNp r;
  r.ray = stream_rays(f, capacity, count, RAY_ORIGIN_X, RAY_DIRECTION_X, RAY_TMAX);
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
  for (int i = 0; i < count; ++i) {
    ints[HIT * capacity + i] =
        geometry[std::size_t(i)] == RTC_INVALID_GEOMETRY_ID ? -1 : int(primitive[std::size_t(i)]);
  }
}

void occlude_stream(const void* scene_, float* f, int* ints, int capacity, int count) {
  auto* scene = static_cast<RTCSceneTy*>(const_cast<void*>(scene_));
  RTCRayNp rays = stream_rays(f, capacity, count, SHADOW_ORIGIN_X, SHADOW_DIRECTION_X, SHADOW_TMAX);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccludedNp(scene, &context, &rays, unsigned(count));
  for (int i = 0; i < count; ++i)
    ints[HIT * capacity + i] = f[SHADOW_TMAX * capacity + i] > 0 && rays.tfar[i] < 0 ? 0 : -1;
}

}  // namespace

Tracer embree_single(const EmbreeTracer& tracer) {
  return {tracer.scene(), &intersect_single, &occlude_single};
}

Tracer embree_stream(const EmbreeTracer& tracer) {
  return {tracer.scene(), &intersect_stream, &occlude_stream};
}

}  // namespace penumbra
