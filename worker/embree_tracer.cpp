#include "worker/embree_tracer.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#define FEATURES FEATURE_ALL
#include "kernels/host/bounds.h"
#include "kernels/host/device_scene_tables.h"
#include "kernels/intersect/quadric.h"

namespace penumbra {
namespace {

constexpr float kBlocked = -std::numeric_limits<float>::infinity();  // as Embree marks an occluded ray
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
    if (t >= 0) RTCRayN_tfar(arguments->ray, arguments->N, i) = kBlocked;
  }
}

constexpr unsigned kTriangleGeometry = 0;  // attached under these numbers
constexpr unsigned kQuadricGeometry = 1;

/// No hits of the triangle that the ray starts on, whose number is the ray's id.
void leave_start_out(const RTCFilterFunctionNArguments* arguments) {
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] != 0 && RTCHitN_geomID(arguments->hit, n, i) == kTriangleGeometry &&
        RTCHitN_primID(arguments->hit, n, i) == RTCRayN_id(arguments->ray, n, i))
      arguments->valid[i] = 0;
  }
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
      ray.tnear[j] = std::numeric_limits<float>::min();
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

  /// Whether Embree's arithmetic may find the triangle for a ray that starts at this point of it and leads
  /// away: if the point's height over it, times twice its area, is within some 8 roundings of the products
  /// that make it up, each at most that of the three coordinates' largest distances.
  [[nodiscard]] bool may_meet_again(unsigned triangle, const vec3& from) const {
    const float* p = vertices.data() + std::size_t(triangle) * 9;
    const vec3 v0 = sub(make_vec3(p[0], p[1], p[2]), from), v1 = sub(make_vec3(p[3], p[4], p[5]), from);
    const vec3 v2 = sub(make_vec3(p[6], p[7], p[8]), from);
    const float height = dot3(cross3(sub(v1, v0), sub(v2, v0)), v0);
    const auto reach = [](float a, float b, float c) { return max_f(FABS(a), max_f(FABS(b), FABS(c))); };
    const float products = reach(v0.x, v1.x, v2.x) * reach(v0.y, v1.y, v2.y) * reach(v0.z, v1.z, v2.z);
    constexpr float kProducts = 3 * 8;  // three, of edges that are twice the distances
    return !(FABS(height) > 8 * HALF_EPSILON * kProducts * products);
  }

  // A ray does not hit the triangle that it starts on: offsets of origins rely on it, and are 0 where a plane
  // goes through the scene's centre. Embree's filters slow every ray down, so only rays whose hit may be that
  // triangle are traced again with one.

  static void intersect(const void* self_, float* f, int* ints, int capacity, int count) {
    const Impl& self = *static_cast<const Impl*>(self_);
    for (int first = 0; first < count; first += kPacket) {
      alignas(64) RTCRayHit16 rays;
      alignas(64) int valid[kPacket];
      const bool any = load(rays.ray, valid, f, ints, capacity, first, count, RAY_ORIGIN_X, RAY_DIRECTION_X,
                            RAY_TMAX, RAY_SKIP);
      std::fill_n(rays.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
      if (any) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect16(valid, self.scene.get(), &context, &rays);
        bool again = false;
        for (int j = 0; j < kPacket; ++j) {
          const bool starts_there = valid[j] != 0 && rays.hit.geomID[j] == kTriangleGeometry &&
                                    rays.hit.primID[j] == rays.ray.id[j];
          valid[j] = starts_there ? -1 : 0;
          if (!starts_there) continue;
          again = true;
          rays.ray.tfar[j] = f[RAY_TMAX * capacity + first + j];
          rays.hit.geomID[j] = RTC_INVALID_GEOMETRY_ID;
        }
        context.filter = leave_start_out;
        if (again) rtcIntersect16(valid, self.scene.get(), &context, &rays);
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
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcOccluded16(valid, self.scene.get(), &context, &rays);
        // What is in the way is not known: it may be that triangle, which the ray leaves, if it is close.
        bool again = false;
        for (int j = 0; j < kPacket; ++j) {
          const unsigned start = rays.id[j];
          const bool doubtful = valid[j] != 0 && rays.tfar[j] < 0 && start < unsigned(self.triangle_count) &&
                                self.may_meet_again(start, {rays.org_x[j], rays.org_y[j], rays.org_z[j]});
          valid[j] = doubtful ? -1 : 0;
          if (!doubtful) continue;
          again = true;
          rays.tfar[j] = f[SHADOW_TMAX * capacity + first + j];
        }
        context.filter = leave_start_out;
        if (again) rtcOccluded16(valid, self.scene.get(), &context, &rays);
      }
      for (int j = 0; j < kPacket && first + j < count; ++j)
        ints[HIT * capacity + first + j] = rays.tfar[j] == kBlocked ? 0 : -1;
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

  const auto triangles = table<Triangle>(scene, scene.header.tables.triangles);
  const auto quadrics = table<Quadric>(scene, scene.header.tables.quadrics);
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
