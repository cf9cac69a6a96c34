#include "worker/embree_tracer.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#define FEATURES FEATURE_ALL
#include "kernels/host/bounds.h"
#include "kernels/host/device_scene_check.h"
#include "kernels/quadric.h"

namespace penumbra {
namespace {

constexpr int kPacket = 16;

struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

void quadric_bounds(const RTCBoundsFunctionArguments* arguments) {
  const Box box = bounds_of(static_cast<const Quadric*>(arguments->geometryUserPtr)[arguments->primID]);
  *arguments->bounds_o = {box.low[0], box.low[1], box.low[2], 0, box.high[0], box.high[1], box.high[2], 0};
}

/// Distance to the quadric inside the ray's interval, or -1.
float quadric_hit(const void* user, unsigned primitive, RTCRayN* rays, unsigned n, unsigned i) {
  const Quadric& q = static_cast<const Quadric*>(user)[primitive];
  const vec3 o = make_vec3(RTCRayN_org_x(rays, n, i), RTCRayN_org_y(rays, n, i), RTCRayN_org_z(rays, n, i));
  const vec3 d = make_vec3(RTCRayN_dir_x(rays, n, i), RTCRayN_dir_y(rays, n, i), RTCRayN_dir_z(rays, n, i));
  const float t = intersect_quadric(q, o, d);
  return t > 0.0f && t < RTCRayN_tfar(rays, n, i) ? t : -1.0f;
}

void quadric_intersect(const RTCIntersectFunctionNArguments* arguments) {
  RTCRayN* rays = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
  RTCHitN* hits = RTCRayHitN_HitN(arguments->rayhit, arguments->N);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (!arguments->valid[i]) continue;
    const float t = quadric_hit(arguments->geometryUserPtr, arguments->primID, rays, arguments->N, i);
    if (t < 0) continue;
    RTCRayN_tfar(rays, arguments->N, i) = t;
    RTCHitN_primID(hits, arguments->N, i) = arguments->primID;
    RTCHitN_geomID(hits, arguments->N, i) = arguments->geomID;
    RTCHitN_instID(hits, arguments->N, i, 0) = RTC_INVALID_GEOMETRY_ID;
  }
}

void quadric_occluded(const RTCOccludedFunctionNArguments* arguments) {
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (!arguments->valid[i]) continue;
    const float t =
        quadric_hit(arguments->geometryUserPtr, arguments->primID, arguments->ray, arguments->N, i);
    if (t >= 0) RTCRayN_tfar(arguments->ray, arguments->N, i) = -std::numeric_limits<float>::infinity();
  }
}

constexpr unsigned kTriangleGeometry = 0;  // attached under these numbers
constexpr unsigned kQuadricGeometry = 1;

/// What counts as a hit of a triangle is the kernels' rule: in front of the ray's origin, and not the
/// triangle that the ray starts on, which is the ray's id. Offsets of origins rely on it: where a plane goes
/// through the scene's centre they are 0.
void keep_hits_in_front(const RTCFilterFunctionNArguments* arguments) {
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] == 0) continue;
    const bool starts_there = RTCHitN_geomID(arguments->hit, n, i) == kTriangleGeometry &&
                              RTCHitN_primID(arguments->hit, n, i) == RTCRayN_id(arguments->ray, n, i);
    if (starts_there || !(RTCRayN_tfar(arguments->ray, n, i) > 0.0f)) arguments->valid[i] = 0;
  }
}

RTCIntersectContext make_context() {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.filter = keep_hits_in_front;
  return context;
}

}  // namespace

struct EmbreeTracer::Impl {
  std::unique_ptr<RTCDeviceTy, DeviceRelease> device;
  std::unique_ptr<RTCSceneTy, SceneRelease> scene;
  std::vector<float> vertices;
  std::vector<unsigned> indices;
  int triangle_count = 0;

  /// Fills a packet's rays from lanes first ... of the block; false if none of them is a ray.
  template <typename Packet>
  static bool load(Packet& ray, int* valid, const float* f, const int* ints, int capacity, int first,
                   int count, int origin, int direction, int tmax, int skip) {
    bool any = false;
    for (int j = 0; j < kPacket; ++j) {
      const int i = std::min(first + j, count - 1);
      ray.org_x[j] = f[origin * capacity + i];
      ray.org_y[j] = f[(origin + 1) * capacity + i];
      ray.org_z[j] = f[(origin + 2) * capacity + i];
      ray.dir_x[j] = f[direction * capacity + i];
      ray.dir_y[j] = f[(direction + 1) * capacity + i];
      ray.dir_z[j] = f[(direction + 2) * capacity + i];
      ray.tnear[j] = 0;
      ray.tfar[j] = f[tmax * capacity + i];
      ray.time[j] = 0;
      ray.mask[j] = ~0u;
      ray.id[j] = unsigned(ints[skip * capacity + i]);
      ray.flags[j] = 0;
      valid[j] = first + j < count && ray.tfar[j] > 0 ? -1 : 0;
      any = any || valid[j] != 0;
    }
    return any;
  }

  static void intersect(const void* self_, float* f, int* ints, int capacity, int count) {
    const Impl& self = *static_cast<const Impl*>(self_);
    for (int first = 0; first < count; first += kPacket) {
      alignas(64) RTCRayHit16 rays;
      alignas(64) int valid[kPacket];
      const bool any = load(rays.ray, valid, f, ints, capacity, first, count, RAY_ORIGIN_X, RAY_DIRECTION_X,
                            RAY_TMAX, RAY_SKIP);
      std::fill_n(rays.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
      if (any) {
        RTCIntersectContext context = make_context();
        rtcIntersect16(valid, self.scene.get(), &context, &rays);
      }
      for (int j = 0; j < kPacket && first + j < count; ++j) {
        const unsigned geometry = rays.hit.geomID[j];
        const int offset = geometry == kQuadricGeometry ? self.triangle_count : 0;
        ints[HIT * capacity + first + j] =
            geometry == RTC_INVALID_GEOMETRY_ID ? -1 : int(rays.hit.primID[j]) + offset;
      }
    }
  }

  static void occlude(const void* self_, float* f, int* ints, int capacity, int count) {
    const Impl& self = *static_cast<const Impl*>(self_);
    for (int first = 0; first < count; first += kPacket) {
      alignas(64) RTCRay16 rays;
      alignas(64) int valid[kPacket];
      if (load(rays, valid, f, ints, capacity, first, count, SHADOW_ORIGIN_X, SHADOW_DIRECTION_X, SHADOW_TMAX,
               SHADOW_SKIP)) {
        RTCIntersectContext context = make_context();
        rtcOccluded16(valid, self.scene.get(), &context, &rays);
      }
      for (int j = 0; j < kPacket && first + j < count; ++j)
        ints[HIT * capacity + first + j] = valid[j] != 0 && rays.tfar[j] < 0 ? 0 : -1;
    }
  }
};

EmbreeTracer::~EmbreeTracer() = default;

Tracer EmbreeTracer::tracer() const { return {impl_.get(), &Impl::intersect, &Impl::occlude}; }

RTCSceneTy* EmbreeTracer::scene() const { return impl_->scene.get(); }

Expected<std::unique_ptr<EmbreeTracer>> EmbreeTracer::make(const DeviceScene& scene,
                                                           const DeviceOptions& options) {
  std::unique_ptr<EmbreeTracer> result(new EmbreeTracer);
  result->impl_ = std::make_unique<Impl>();
  Impl& impl = *result->impl_;
  // Embree has the same names for the sets.
  const std::string configuration =
      fmt::format("threads={},isa={}", std::max(1, options.threads), isa_name(options.isa));
  impl.device.reset(rtcNewDevice(configuration.c_str()));
  if (!impl.device) return fail("Embree does not start with " + configuration);
  impl.scene.reset(rtcNewScene(impl.device.get()));
  rtcSetSceneFlags(impl.scene.get(),
                   RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));

  const auto triangles = table<Triangle>(scene, scene.header.triangles, scene.header.triangle_count);
  const auto quadrics = table<Quadric>(scene, scene.header.quadrics, scene.header.quadric_count);
  impl.triangle_count = int(triangles.size());
  if (!triangles.empty()) {
    impl.vertices.reserve(triangles.size() * 9 + 4);
    for (const Triangle& t : triangles)
      for (const vec3& p : {t.p0, t.p1, t.p2}) impl.vertices.insert(impl.vertices.end(), {p.x, p.y, p.z});
    impl.vertices.resize(impl.vertices.size() + 4);  // Embree reads 16 bytes for each vertex
    impl.indices.resize(triangles.size() * 3);
    for (std::size_t i = 0; i < impl.indices.size(); ++i) impl.indices[i] = unsigned(i);
    RTCGeometry geometry = rtcNewGeometry(impl.device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, impl.vertices.data(),
                               0, 12, triangles.size() * 3);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, impl.indices.data(), 0,
                               12, triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(impl.scene.get(), geometry, kTriangleGeometry);
    rtcReleaseGeometry(geometry);
  }
  if (!quadrics.empty()) {
    RTCGeometry geometry = rtcNewGeometry(impl.device.get(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, unsigned(quadrics.size()));
    rtcSetGeometryUserData(geometry, const_cast<Quadric*>(quadrics.data()));
    rtcSetGeometryBoundsFunction(geometry, quadric_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, quadric_intersect);
    rtcSetGeometryOccludedFunction(geometry, quadric_occluded);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(impl.scene.get(), geometry, kQuadricGeometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(impl.scene.get());
  if (const RTCError error = rtcGetDeviceError(impl.device.get()); error != RTC_ERROR_NONE)
    return fail(fmt::format("Embree failed to build its hierarchy over {} triangles (error {})",
                            triangles.size(), int(error)));
  return result;
}

}  // namespace penumbra
