#include "worker/embree_tracer.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "kernels/host/bounds.h"
#include "kernels/host/device_scene.h"
#include "kernels/intersect/instance.h"
#include "kernels/intersect/quadric.h"

namespace penumbra {
namespace {

constexpr float kBlocked = -std::numeric_limits<float>::infinity();  // Embree's mark of an occluded ray
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

/// Distance to the quadric within the ray's interval, or -1. In an instance the direction is not normalised.
float quadric_hit(const void* user, unsigned primitive, bool in_instance, RTCRayN* rays, unsigned n,
                  unsigned i) {
  const Quadric& q = static_cast<const Quadric*>(user)[primitive];
  const vec3 o = make_vec3(RTCRayN_org_x(rays, n, i), RTCRayN_org_y(rays, n, i), RTCRayN_org_z(rays, n, i));
  const vec3 d = make_vec3(RTCRayN_dir_x(rays, n, i), RTCRayN_dir_y(rays, n, i), RTCRayN_dir_z(rays, n, i));
  const UnitDirection unit = unit_direction(d);
  const float t = in_instance ? intersect_quadric(q, o, unit.d) / unit.length : intersect_quadric(q, o, d);
  return t > 0.0f && t < RTCRayN_tfar(rays, n, i) ? t : -1.0f;
}

void quadric_intersect(const RTCIntersectFunctionNArguments* arguments) {
  RTCRayN* rays = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
  RTCHitN* hits = RTCRayHitN_HitN(arguments->rayhit, arguments->N);
  const unsigned instance = arguments->context->instID[0];
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (!arguments->valid[i]) continue;
    const float t = quadric_hit(arguments->geometryUserPtr, arguments->primID,
                                instance != RTC_INVALID_GEOMETRY_ID, rays, arguments->N, i);
    if (t < 0) continue;
    RTCRayN_tfar(rays, arguments->N, i) = t;
    RTCHitN_primID(hits, arguments->N, i) = arguments->primID;
    RTCHitN_geomID(hits, arguments->N, i) = arguments->geomID;
    RTCHitN_instID(hits, arguments->N, i, 0) = instance;
  }
}

void quadric_occluded(const RTCOccludedFunctionNArguments* arguments) {
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (!arguments->valid[i]) continue;
    const bool in_instance = arguments->context->instID[0] != RTC_INVALID_GEOMETRY_ID;
    const float t = quadric_hit(arguments->geometryUserPtr, arguments->primID, in_instance, arguments->ray,
                                arguments->N, i);
    if (t >= 0) RTCRayN_tfar(arguments->ray, arguments->N, i) = kBlocked;
  }
}

// Embree reads vertices, 16 bytes each, directly from the scene's records.
constexpr std::size_t kTriangleWords = sizeof(Triangle) / sizeof(float);
constexpr std::size_t kVertexWords = 3;
static_assert(offsetof(Triangle, p1) == kVertexWords * sizeof(float));
static_assert(offsetof(Triangle, p2) == 2 * kVertexWords * sizeof(float));
static_assert(kTriangleWords > 3 * kVertexWords);

// Geometry IDs in the scene of each group. Instances are attached to that of group 0, after the others.
constexpr unsigned kTriangleGeometry = 0;
constexpr unsigned kQuadricGeometry = 1;
constexpr unsigned kFirstInstance = 2;

int instance_number(unsigned geometry) {
  return geometry == RTC_INVALID_GEOMETRY_ID ? -1 : int(geometry - kFirstInstance);
}

/// The primitives on which a packet's rays start; a ray's id is its index here.
struct Starts {
  RTCIntersectContext context;  // first, so that Embree's pointer to it points to the whole struct
  std::span<const PrimitiveGroup> groups;
  std::span<const Instance> instances;
  int primitives[kPacket], instance[kPacket];  ///< or -1

  Starts(std::span<const PrimitiveGroup> all_groups, std::span<const Instance> all_instances)
      : groups(all_groups), instances(all_instances) {
    rtcInitIntersectContext(&context);
  }

  [[nodiscard]] const PrimitiveGroup& group_of(int number) const {
    return groups[number < 0 ? 0 : std::size_t(instances[std::size_t(number)].group)];
  }
  /// Whether ray j starts on this triangle of this instance (-1: not instanced).
  [[nodiscard]] bool is_start(unsigned j, unsigned triangle, int number) const {
    return instance[j] == number && primitives[j] == group_of(number).first_triangle + int(triangle);
  }
};

/// Filter function: rejects hits of the triangle that the ray starts on.
void reject_start_triangle(const RTCFilterFunctionNArguments* arguments) {
  const unsigned n = arguments->N;
  const auto* starts = reinterpret_cast<const Starts*>(arguments->context);
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] != 0 && RTCHitN_geomID(arguments->hit, n, i) == kTriangleGeometry &&
        starts->is_start(RTCRayN_id(arguments->ray, n, i), RTCHitN_primID(arguments->hit, n, i),
                         instance_number(RTCHitN_instID(arguments->hit, n, i, 0))))
      arguments->valid[i] = 0;
  }
}

}  // namespace

struct EmbreeTracer::Impl {
  std::unique_ptr<RTCDeviceTy, DeviceRelease> device;
  std::unique_ptr<RTCSceneTy, SceneRelease> scene;
  std::vector<std::unique_ptr<RTCSceneTy, SceneRelease>> group_scenes;  ///< from group 1 on
  /// Indices into the scene's records, in words, from which Embree reads vertices. Those of a group's first
  /// triangle are 0, 3 and 6.
  std::vector<unsigned> indices;
  std::span<const Triangle> triangles;
  int triangle_count = 0;
  PrimitiveGroup whole{};  ///< for a scene without instances
  std::span<const PrimitiveGroup> groups;
  std::span<const Instance> instances;
  std::size_t still_instances = 0;

  /// Sets ray j of a packet; it is valid if `wanted`.
  template <typename Packet>
  static bool load(Packet& ray, int* valid, int j, bool wanted, const vec3& origin, const vec3& direction,
                   float tmax) {
    ray.org_x[j] = origin.x;
    ray.org_y[j] = origin.y;
    ray.org_z[j] = origin.z;
    ray.dir_x[j] = direction.x;
    ray.dir_y[j] = direction.y;
    ray.dir_z[j] = direction.z;
    ray.tnear[j] = std::numeric_limits<float>::min();
    ray.tfar[j] = tmax;
    ray.time[j] = 0;
    ray.mask[j] = ~0u;
    ray.id[j] = unsigned(j);
    ray.flags[j] = 0;
    valid[j] = wanted && tmax > 0 ? -1 : 0;
    return valid[j] != 0;
  }

  /// Whether Embree's arithmetic may hit the triangle with a ray that starts at this point of it and leads
  /// away. This is so if the point's height over it, times twice its area, is within about 8 roundings of the
  /// products in the computation, each at most the product of the largest distances along the three axes.
  [[nodiscard]] bool may_meet_again(unsigned triangle, int instance, const vec3& origin) const {
    const vec3 from = instance < 0 ? origin : to_group_point(instances[std::size_t(instance)], origin);
    const Triangle& t = triangles[triangle];
    const vec3 v0 = sub(t.p0, from), v1 = sub(t.p1, from), v2 = sub(t.p2, from);
    const float height = dot3(cross3(sub(v1, v0), sub(v2, v0)), v0);
    const auto reach = [](float a, float b, float c) { return max_f(FABS(a), max_f(FABS(b), FABS(c))); };
    const float products = reach(v0.x, v1.x, v2.x) * reach(v0.y, v1.y, v2.y) * reach(v0.z, v1.z, v2.z);
    constexpr float kProducts = 3 * 8;  // three products, of edges that are twice the distances
    // The rounding of the transform into a group is not known here.
    return instance >= 0 || !(FABS(height) > 8 * HALF_EPSILON * kProducts * products);
  }

  // A ray must not hit the triangle that it starts on: origins rely on it, since their offsets are 0 where a
  // plane passes through the scene's centre. Embree's filters slow every ray down, so only rays whose hit may
  // be that triangle are traced again with a filter.

  static void intersect(const void* self_, const PathState* paths, int count) {
    const Impl& self = *static_cast<const Impl*>(self_);
    Starts starts(self.groups, self.instances);
    const bool instances = !self.instances.empty();
    for (int first = 0; first < count; first += kPacket) {
      alignas(64) RTCRayHit16 rays;
      alignas(64) int valid[kPacket];
      bool any = false;
      for (int j = 0; j < kPacket; ++j) {
        const int i = std::min(first + j, count - 1);
        starts.primitives[j] = get_ray_skip(paths, i);
        starts.instance[j] = instances ? get_ray_skip_instance(paths, i) : -1;
        any |= load(rays.ray, valid, j, first + j < count, get_ray_origin(paths, i),
                    get_ray_direction(paths, i), get_ray_tmax(paths, i));
      }
      std::fill_n(rays.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
      std::fill_n(rays.hit.instID[0], kPacket, RTC_INVALID_GEOMETRY_ID);
      if (any) {
        starts.context.filter = nullptr;
        rtcIntersect16(valid, self.scene.get(), &starts.context, &rays);
        bool again = false;
        for (int j = 0; j < kPacket; ++j) {
          const bool starts_there =
              valid[j] != 0 && rays.hit.geomID[j] == kTriangleGeometry &&
              starts.is_start(unsigned(j), rays.hit.primID[j], instance_number(rays.hit.instID[0][j]));
          valid[j] = starts_there ? -1 : 0;
          if (!starts_there) continue;
          again = true;
          rays.ray.tfar[j] = get_ray_tmax(paths, first + j);
          rays.hit.geomID[j] = rays.hit.instID[0][j] = RTC_INVALID_GEOMETRY_ID;
        }
        starts.context.filter = reject_start_triangle;
        if (again) rtcIntersect16(valid, self.scene.get(), &starts.context, &rays);
      }
      for (int j = 0; j < kPacket && first + j < count; ++j) {
        const unsigned geometry = rays.hit.geomID[j];
        const int instance = instance_number(rays.hit.instID[0][j]);
        const PrimitiveGroup& group = starts.group_of(instance);
        const int offset =
            geometry == kQuadricGeometry ? self.triangle_count + group.first_quadric : group.first_triangle;
        set_hit(paths, first + j,
                geometry == RTC_INVALID_GEOMETRY_ID ? -1 : int(rays.hit.primID[j]) + offset);
        if (instances) set_hit_instance(paths, first + j, instance);
      }
    }
  }

  static void occlude(const void* self_, const PathState* paths, int count) {
    const Impl& self = *static_cast<const Impl*>(self_);
    Starts starts(self.groups, self.instances);
    const bool instances = !self.instances.empty();
    for (int first = 0; first < count; first += kPacket) {
      alignas(64) RTCRay16 rays;
      alignas(64) int valid[kPacket];
      bool any = false;
      for (int j = 0; j < kPacket; ++j) {
        const int i = std::min(first + j, count - 1);
        starts.primitives[j] = get_shadow_skip(paths, i);
        starts.instance[j] = instances ? get_shadow_skip_instance(paths, i) : -1;
        any |= load(rays, valid, j, first + j < count, get_shadow_origin(paths, i),
                    get_shadow_direction(paths, i), get_shadow_tmax(paths, i));
      }
      if (any) {
        starts.context.filter = nullptr;
        rtcOccluded16(valid, self.scene.get(), &starts.context, &rays);
        // Embree does not report the occluder: it may be the triangle that the ray starts on, if that is
        // close.
        bool again = false;
        for (int j = 0; j < kPacket; ++j) {
          const auto start = unsigned(starts.primitives[j]);
          const bool doubtful =
              valid[j] != 0 && rays.tfar[j] < 0 && start < unsigned(self.triangle_count) &&
              self.may_meet_again(start, starts.instance[j], {rays.org_x[j], rays.org_y[j], rays.org_z[j]});
          valid[j] = doubtful ? -1 : 0;
          if (!doubtful) continue;
          again = true;
          rays.tfar[j] = get_shadow_tmax(paths, first + j);
        }
        starts.context.filter = reject_start_triangle;
        if (again) rtcOccluded16(valid, self.scene.get(), &starts.context, &rays);
      }
      for (int j = 0; j < kPacket && first + j < count; ++j)
        set_shadow_transmittance(paths, first + j, rays.tfar[j] == kBlocked ? 0.0f : 1.0f);
    }
  }

  [[nodiscard]] std::unique_ptr<RTCSceneTy, SceneRelease> new_scene() const {
    std::unique_ptr<RTCSceneTy, SceneRelease> made(rtcNewScene(device.get()));
    rtcSetSceneFlags(made.get(),
                     RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
    return made;
  }

  /// Attaches the group's triangles and quadrics, which are consecutive in the scene.
  void attach(const PrimitiveGroup& group, std::span<const Quadric> quadrics, RTCSceneTy* to) const {
    const auto add = [&](RTCGeometry geometry, unsigned number) {
      rtcCommitGeometry(geometry);
      rtcAttachGeometryByID(to, geometry, number);
      rtcReleaseGeometry(geometry);
    };
    if (group.triangle_count > 0) {
      const auto count = std::size_t(group.triangle_count);
      RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
      rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                 triangles.data() + group.first_triangle, 0, sizeof(float),
                                 count * kTriangleWords);
      rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices.data(), 0, 12,
                                 count);
      add(geometry, kTriangleGeometry);
    }
    if (group.quadric_count > 0) {
      RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_USER);
      rtcSetGeometryUserPrimitiveCount(geometry, unsigned(group.quadric_count));
      rtcSetGeometryUserData(geometry, const_cast<Quadric*>(quadrics.data() + group.first_quadric));
      rtcSetGeometryBoundsFunction(geometry, quadric_bounds, nullptr);
      rtcSetGeometryIntersectFunction(geometry, quadric_intersect);
      rtcSetGeometryOccludedFunction(geometry, quadric_occluded);
      add(geometry, kQuadricGeometry);
    }
  }

  void attach_instances() const {
    for (std::size_t i = 0; i < still_instances; ++i) {
      const Instance& instance = instances[i];
      const float columns[12] = {instance.x.x, instance.x.y,  instance.x.z,  instance.y.x,
                                 instance.y.y, instance.y.z,  instance.z.x,  instance.z.y,
                                 instance.z.z, instance.at.x, instance.at.y, instance.at.z};
      RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
      rtcSetGeometryInstancedScene(geometry, group_scenes[std::size_t(instance.group) - 1].get());
      rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
      rtcCommitGeometry(geometry);
      rtcAttachGeometryByID(scene.get(), geometry, kFirstInstance + unsigned(i));
      rtcReleaseGeometry(geometry);
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
  // Embree uses the same names for instruction sets.
  const std::string configuration =
      fmt::format("threads={},isa={}", std::max(1, options.threads), isa_name(options.isa));
  impl.device.reset(rtcNewDevice(configuration.c_str()));
  if (!impl.device) return fail("Embree does not start with " + configuration);
  impl.scene = impl.new_scene();
  const auto triangles = impl.triangles = table<Triangle>(scene, scene.header.tables.triangles);
  const auto quadrics = table<Quadric>(scene, scene.header.tables.quadrics);
  impl.triangle_count = int(triangles.size());
  // What moves while the shutter is open has a hierarchy of its own; groups[0] is without it, too.
  const TableSpans& tables = scene.header.tables;
  impl.whole = {0, 0, impl.triangle_count - tables.triangle_motions.count, 0,
                int(quadrics.size()) - tables.quadric_motions.count};
  impl.still_instances = std::size_t(tables.instances.count - tables.instance_motions.count);
  impl.instances = table<Instance>(scene, scene.header.tables.instances);
  impl.groups = table<PrimitiveGroup>(scene, scene.header.tables.groups);
  if (impl.groups.empty()) impl.groups = std::span(&impl.whole, 1);
  impl.indices.resize(triangles.size() * 3);
  for (std::size_t i = 0; i < impl.indices.size(); ++i)
    impl.indices[i] = unsigned(i / 3 * kTriangleWords + i % 3 * kVertexWords);
  for (std::size_t g = 1; g < impl.groups.size(); ++g) {
    impl.group_scenes.push_back(impl.new_scene());
    impl.attach(impl.groups[g], quadrics, impl.group_scenes.back().get());
    rtcCommitScene(impl.group_scenes.back().get());
  }
  impl.attach(impl.groups[0], quadrics, impl.scene.get());
  impl.attach_instances();
  rtcCommitScene(impl.scene.get());
  if (const RTCError error = rtcGetDeviceError(impl.device.get()); error != RTC_ERROR_NONE)
    return fail(fmt::format("Embree failed to build its hierarchy over {} triangles (error {})",
                            triangles.size(), int(error)));
  return result;
}

}  // namespace penumbra
