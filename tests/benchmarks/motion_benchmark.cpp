// Rays per second among what moves, on one thread and random rays at random times: the portable traversal of
// linear boxes against Embree's motion blur with the same states, in one run. Prints nanoseconds a ray of
// both, their ratio, and the share of rays that hit. `motion_benchmark [BOXES [TRIANGLES]]`.
#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <random>
#include <utility>
#include <variant>
#include <vector>

#include "kernels/host/native_kernels.h"
#include "kernels/motion/motion.h"
#include "scenes/device/device_scene_builder.h"
#include "scenes/motion/scene_motion.h"
#include "tests/benchmarks/bumpy_room.h"
#include "tests/benchmarks/moving_rays.h"
#include "tests/support/integrator_parameters.h"
#include "worker/device.h"

namespace penumbra {
namespace {

constexpr int kRays = 1 << 16, kRounds = 9;
constexpr double kRoomSide = 10;

std::vector<MovingRayCase> random_rays() {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<MovingRayCase> rays;
  while (rays.size() < kRays) {
    const auto point = [&] { return glm::vec3(unit(random), unit(random), unit(random)) * float(kRoomSide); };
    const glm::vec3 from = point(), to = point();
    const glm::vec3 d = glm::normalize(to - from);
    rays.push_back({make_vec3(from.x, from.y, from.z), make_vec3(d.x, d.y, d.z), 0.5f + 0.5f * unit(random)});
  }
  return rays;
}

Shape white(Mesh mesh) {
  Shape shape;
  shape.name = "shape";
  shape.geometry = std::move(mesh);
  shape.front_bsdf = shape.back_bsdf = 0;
  return shape;
}

/// Cubes that move and turn, each its own way.
SceneDescription moving_boxes(int count) {
  SceneDescription scene = bumpy_room(18);
  const Mesh cube = std::get<Mesh>(scene.shapes[0].geometry);
  auto motion = std::make_shared<SceneMotion>();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 from = 0.9 * kRoomSide * vector(), axis = glm::normalize(vector());
    KeyedTransform keys;
    keys.stretch = KeyedValue<glm::dmat3>::constant(glm::dmat3(0.03 * kRoomSide));
    keys.translation = {.times = {0, 1}, .values = {from, from + 0.2 * kRoomSide * vector()}};
    keys.rotation = {.times = {0, 1},
                     .values = {glm::dquat(1, 0, 0, 0), glm::angleAxis(2 * unit(random), axis)}};
    motion->nodes.push_back({.keys = keys});
    motion->shapes.push_back({.shape = scene.shapes.size(), .rest = cube, .place = {.node = i}});
    scene.shapes.push_back(white(cube));
  }
  scene.motion = motion;
  return scene;
}

/// A bumpy ball that becomes longer, wider and twisted.
SceneDescription deforming_ball(int triangles) {
  SceneDescription scene = bumpy_room(18);
  Mesh ball = std::get<Mesh>(bumpy_room(triangles).shapes[1].geometry);
  MorphTarget target;
  for (glm::dvec3& p : ball.positions) {
    p *= 1.4 * kRoomSide;
    target.positions.push_back(
        {0.2 * p.x + 0.1 * p.y * std::sin(p.y), 0.3 * p.y, 0.1 * kRoomSide * std::sin(0.5 * p.x)});
  }
  auto deformation = std::make_shared<MeshDeformation>();
  deformation->targets.push_back(std::move(target));
  deformation->weights = {.times = {0, 1}, .values = {{0.0}, {1.0}}};
  auto motion = std::make_shared<SceneMotion>();
  motion->shapes.push_back({.shape = scene.shapes.size(), .rest = ball, .deformation = deformation});
  scene.shapes.push_back(white(std::move(ball)));
  scene.motion = motion;
  return scene;
}

/// Embree's scene of what moves in `scene`, with the same states.
class EmbreeMotion {
 public:
  explicit EmbreeMotion(const Scene& scene) : device_(rtcNewDevice("threads=1")), top_(new_scene()) {
    const TableSpans& tables = scene.header.tables;
    for (int i = 0; i < tables.instance_motions.count; ++i) add_instance(scene, i);
    if (tables.triangle_motions.count > 0) add_triangles(scene);
    rtcCommitScene(top_);
  }
  EmbreeMotion(const EmbreeMotion&) = delete;
  EmbreeMotion& operator=(const EmbreeMotion&) = delete;
  ~EmbreeMotion() {
    for (RTCScene scene : scenes_) rtcReleaseScene(scene);
    rtcReleaseDevice(device_);
  }

  /// The number of rays that hit.
  [[nodiscard]] int trace(const std::vector<MovingRayCase>& rays, bool any) const {
    int hits = 0;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (const MovingRayCase& ray : rays) {
      alignas(16) RTCRayHit r{};
      r.ray = {ray.origin.x,
               ray.origin.y,
               ray.origin.z,
               0,
               ray.direction.x,
               ray.direction.y,
               ray.direction.z,
               ray.time,
               INFINITY,
               ~0u,
               0,
               0};
      r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      if (any)
        rtcOccluded1(top_, &context, &r.ray);
      else
        rtcIntersect1(top_, &context, &r);
      hits += (any ? r.ray.tfar < 0 : r.hit.geomID != RTC_INVALID_GEOMETRY_ID) ? 1 : 0;
    }
    return hits;
  }

 private:
  RTCScene new_scene() {
    scenes_.push_back(rtcNewScene(device_));
    rtcSetSceneFlags(scenes_.back(), RTC_SCENE_FLAG_ROBUST);
    return scenes_.back();
  }
  static void attach(RTCScene to, RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(to, geometry);
    rtcReleaseGeometry(geometry);
  }
  static void set_corners(RTCGeometry geometry, unsigned step, int count, const auto& corner_of) {
    auto* out = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, step,
                                                            RTC_FORMAT_FLOAT3, 12, std::size_t(count) * 3));
    for (int i = 0; i < 3 * count; ++i) {
      const vec3 p = corner_of(i / 3, i % 3);
      *out++ = p.x;
      *out++ = p.y;
      *out++ = p.z;
    }
    if (step > 0) return;
    auto* index = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                                 RTC_FORMAT_UINT3, 12, std::size_t(count)));
    for (unsigned i = 0; i < unsigned(3 * count); ++i) index[i] = i;
  }
  void add_instance(const Scene& scene, int number) {
    const Motion& motion = scene.instance_motions[number];
    const PrimitiveGroup& group =
        scene.groups[scene.instances[scene.shutter->still_instances + number].group];
    RTCScene inside = new_scene();
    RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    set_corners(mesh, 0, group.triangle_count, [&](int triangle, int corner) {
      const Triangle& t = scene.triangles[group.first_triangle + triangle];
      return corner == 0 ? t.p0 : corner == 1 ? t.p1 : t.p2;
    });
    attach(inside, mesh);
    rtcCommitScene(inside);
    RTCGeometry placed = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(placed, inside);
    rtcSetGeometryTimeStepCount(placed, unsigned(motion.steps) + 1);
    for (int s = 0; s <= motion.steps; ++s) {
      const InstanceState& state = scene.instance_states[motion.first + s * motion.stride];
      const float matrix[12] = {state.x.x, state.x.y, state.x.z, state.y.x,  state.y.y,  state.y.z,
                                state.z.x, state.z.y, state.z.z, state.at.x, state.at.y, state.at.z};
      rtcSetGeometryTransform(placed, unsigned(s), RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix);
    }
    attach(top_, placed);
  }
  void add_triangles(const Scene& scene) {
    const int count = scene.header.tables.triangle_motions.count, steps = scene.triangle_motions[0].steps;
    RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryTimeStepCount(mesh, unsigned(steps) + 1);
    for (int s = 0; s <= steps; ++s)
      set_corners(mesh, unsigned(s), count, [&](int triangle, int corner) {
        const Motion& motion = scene.triangle_motions[triangle];
        const TriangleState& t = scene.triangle_states[motion.first + s * motion.stride];
        return corner == 0 ? t.p0 : corner == 1 ? t.p1 : t.p2;
      });
    attach(top_, mesh);
  }

  RTCDevice device_;
  std::vector<RTCScene> scenes_;
  RTCScene top_;
};

/// CPU seconds of the fastest of kRounds alternating calls of each.
template <typename Ours, typename Theirs>
std::pair<double, double> fastest(Ours ours, Theirs theirs) {
  const auto seconds = [](auto& call) {
    const std::clock_t start = std::clock();
    call();
    return double(std::clock() - start) / CLOCKS_PER_SEC;
  };
  std::pair<double, double> best{INFINITY, INFINITY};
  for (int round = 0; round < kRounds; ++round) {
    best.first = std::min(best.first, seconds(ours));
    best.second = std::min(best.second, seconds(theirs));
  }
  return best;
}

MovingRayStage* best_stage() {
  switch (best_isa()) {
    case Isa::kAvx512:
      return moving_ray_stage_avx512;
    case Isa::kAvx2:
      return moving_ray_stage_avx2;
    default:
      return moving_ray_stage_sse2;
  }
}

bool compare(std::string_view name, SceneDescription description) {
  use(description.integrator, IntegratorKind::kPath);
  description.frame_duration = 1.0;
  description.camera.shutter = 1.0f;
  const auto built =
      build_device_scene(description, {.intersector = IntersectorChoice::kPortable, .feature_layers = false});
  if (!built) {
    fmt::print(stderr, "{}\n", built.error().message);
    return false;
  }
  const Scene scene = make_scene(built->header, built->words.data());
  const TableSpans& tables = built->header.tables;
  const EmbreeMotion embree(scene);
  const std::vector<MovingRayCase> rays = random_rays();
  fmt::print("{}: {} instances and {} triangles move\n", name, tables.instance_motions.count,
             tables.triangle_motions.count);
  MovingRayStage* stage = best_stage();
  for (const bool any : {false, true}) {
    int ours = 0, theirs = 0;
    const auto [mine, other] =
        fastest([&] { ours = stage(built->header, built->words.data(), any, rays.data(), kRays); },
                [&] { theirs = embree.trace(rays, any); });
    fmt::print("  {}: {:.0f} ns a ray, Embree {:.0f} ns, ratio {:.2f}; hits {:.2f} % and {:.2f} %\n",
               any ? "any hit" : "closest hit", mine / kRays * 1e9, other / kRays * 1e9, mine / other,
               100.0 * ours / kRays, 100.0 * theirs / kRays);
  }
  return true;
}

int run(int argc, char** argv) {
  const int boxes = argc > 1 ? std::atoi(argv[1]) : 1000;
  const int triangles = argc > 2 ? std::atoi(argv[2]) : 100'000;
  return compare("boxes", moving_boxes(boxes)) && compare("mesh", deforming_ball(triangles)) ? 0 : 2;
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) { return penumbra::run(argc, argv); }
