#include "tests/benchmarks/recorded_rays.h"

#include <algorithm>
#include <stdexcept>

#include "tests/support/native_blocks.h"
#include "worker/embree_tracer.h"
#include "worker/native_device.h"

namespace penumbra {
namespace {

constexpr int kPaths = 4096, kLanes = 16;

struct Recorder {
  Tracer inner;
  std::uint64_t features;
  RecordedRays* out;
  mutable RayKind next = RayKind::kCamera;  ///< of the next intersect stage

  void keep(RayKind kind, const PathState* paths, int count) const {
    const int capacity = (count + kLanes - 1) / kLanes * kLanes;
    RecordedStage stage{kind, count, BlockMemory(features, capacity, 0)};
    const PathState kept = stage.paths();
    for (int i = 0; i < capacity; ++i) {
#define KEEP_FIELD(type, name, needs, travels) \
  if (is_stored(features, needs)) set_##name(&kept, i, get_##name(paths, i));
      PATH_FIELDS(KEEP_FIELD)
#undef KEEP_FIELD
    }
    out->rays += count_rays(stage);
    out->stages.push_back(std::move(stage));
  }
  static void intersect(const void* self_, const PathState* paths, int count) {
    const auto& self = *static_cast<const Recorder*>(self_);
    self.keep(self.next, paths, count);
    self.next = RayKind::kBounce;
    self.inner.intersect(self.inner.context, paths, count);
  }
  static void occlude(const void* self_, const PathState* paths, int count) {
    const auto& self = *static_cast<const Recorder*>(self_);
    self.keep(RayKind::kShadow, paths, count);
    self.inner.occlude(self.inner.context, paths, count);
  }
};

}  // namespace

std::size_t count_rays(RecordedStage& stage) {
  const PathState paths = stage.paths();
  std::size_t rays = 0;
  for (int i = 0; i < stage.count; ++i) {
    const bool shadow = stage.kind == RayKind::kShadow;
    rays += (shadow ? get_shadow_tmax(&paths, i) : get_ray_tmax(&paths, i)) > 0 ? 1 : 0;
  }
  return rays;
}

RecordedRays record_rays(const DeviceScene& embree_scene, const RenderUnit& unit, Isa isa) {
  DeviceOptions options;
  options.isa = isa;
  auto tracer = EmbreeTracer::make(embree_scene, options);
  if (!tracer) throw std::runtime_error(tracer.error().message);
  const NativeKernel* kernel = find_native_kernel(isa);
  RecordedRays recorded;
  const Recorder recorder{(*tracer)->tracer(), embree_scene.header.features, &recorded};
  render_native_blocks(*kernel, embree_scene, unit, kPaths,
                       {&recorder, &Recorder::intersect, &Recorder::occlude},
                       [&](const NativeBlock&) { recorder.next = RayKind::kCamera; });
  return recorded;
}

}  // namespace penumbra
