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
  RecordedRays* out;
  mutable RayKind next = RayKind::kCamera;  ///< of the next intersect stage

  void keep(RayKind kind, const float* f, const int* ints, int capacity, int count) const {
    RecordedStage stage;
    stage.kind = kind;
    stage.count = count;
    stage.capacity = (count + kLanes - 1) / kLanes * kLanes;
    for (int k = 0; k < STATE_FLOATS; ++k)
      stage.floats.insert(stage.floats.end(), f + k * capacity, f + k * capacity + stage.capacity);
    for (int k = 0; k < STATE_INTS; ++k)
      stage.ints.insert(stage.ints.end(), ints + k * capacity, ints + k * capacity + stage.capacity);
    out->rays += count_rays(stage);
    out->stages.push_back(std::move(stage));
  }
  static void intersect(const void* self_, float* f, int* ints, int capacity, int count) {
    const auto& self = *static_cast<const Recorder*>(self_);
    self.keep(self.next, f, ints, capacity, count);
    self.next = RayKind::kBounce;
    self.inner.intersect(self.inner.context, f, ints, capacity, count);
  }
  static void occlude(const void* self_, float* f, int* ints, int capacity, int count) {
    const auto& self = *static_cast<const Recorder*>(self_);
    self.keep(RayKind::kShadow, f, ints, capacity, count);
    self.inner.occlude(self.inner.context, f, ints, capacity, count);
  }
};

}  // namespace

std::size_t count_rays(const RecordedStage& stage) {
  const int field = stage.kind == RayKind::kShadow ? SHADOW_TMAX : RAY_TMAX;
  const float* tmax = stage.floats.data() + field * stage.capacity;
  return std::size_t(std::count_if(tmax, tmax + stage.count, [](float t) { return t > 0; }));
}

RecordedRays record_rays(const DeviceScene& embree_scene, const RenderUnit& unit, Isa isa) {
  DeviceOptions options;
  options.isa = isa;
  auto tracer = EmbreeTracer::make(embree_scene, options);
  if (!tracer) throw std::runtime_error(tracer.error().message);
  const NativeKernel* kernel = find_native_kernel(kernel_target(isa), embree_scene.header.features);
  RecordedRays recorded;
  const Recorder recorder{(*tracer)->tracer(), &recorded};
  render_native_blocks(*kernel, embree_scene, unit, kPaths,
                       {&recorder, &Recorder::intersect, &Recorder::occlude},
                       [&](const NativeBlock&) { recorder.next = RayKind::kCamera; });
  return recorded;
}

}  // namespace penumbra
