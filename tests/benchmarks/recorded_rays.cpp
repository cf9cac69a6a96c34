#include "tests/benchmarks/recorded_rays.h"

#include <algorithm>
#include <stdexcept>

#include "worker/embree_tracer.h"

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
  const NativeKernel* kernel = find_native_kernel(isa == Isa::kAvx512 ? KernelTarget::kAvx512
                                                  : isa == Isa::kAvx2 ? KernelTarget::kAvx2
                                                                      : KernelTarget::kSse2,
                                                  embree_scene.header.features);
  RecordedRays recorded;
  const Recorder recorder{(*tracer)->tracer(), &recorded};
  std::vector<float> floats(std::size_t(STATE_FLOATS) * kPaths),
      slots(std::size_t(SLOT_FLOAT_COUNT) * kPaths);
  std::vector<int> ints(std::size_t(STATE_INTS) * kPaths);
  const Block block{floats.data(), ints.data(), slots.data(), kPaths, kPaths, nullptr};
  const Unit portable{unit.x, unit.y, unit.width, unit.height, unit.first_sample, int(unit.sample_count)};
  const int pixels = unit.width * unit.height,
            block_pixels = slot_pixels(kPaths, int(unit.sample_count), kernel->lanes);
  std::vector<float> out(std::size_t(kSampleBufferPlanes) * std::size_t(pixels));
  BadSamples bad[BAD_KINDS] = {};
  for (int first = 0; first < pixels; first += block_pixels) {
    recorder.next = RayKind::kCamera;
    kernel->render_block(embree_scene.header, embree_scene.words.data(),
                         {&recorder, &Recorder::intersect, &Recorder::occlude}, portable, first,
                         std::min(block_pixels, pixels - first), block, out.data(), bad);
  }
  return recorded;
}

}  // namespace penumbra
