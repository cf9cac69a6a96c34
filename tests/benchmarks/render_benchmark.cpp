// Samples and rays per second of whole units on one thread, and of Embree alone on the rays of the same unit.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <memory>

#include "scenes/device/device_scene_builder.h"
#include "scenes/scene_reader.h"
#include "tests/benchmarks/recorded_rays.h"
#include "worker/embree_tracer.h"

namespace penumbra {
namespace {

constexpr std::uint32_t kSamples = 16;
constexpr int kTile = 128;

struct BenchmarkScene {
  DeviceScene portable, embree;
  RenderUnit unit;
  RecordedRays rays;
};

void report(benchmark::State& state, const BenchmarkScene& scene, std::size_t rays) {
  const double samples = double(scene.unit.width) * scene.unit.height * scene.unit.sample_count;
  state.counters["samples/s"] = benchmark::Counter(samples, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["rays/s"] = benchmark::Counter(double(rays), benchmark::Counter::kIsIterationInvariantRate);
}

void render_unit(benchmark::State& state, const BenchmarkScene& scene, bool embree, DeviceOptions options) {
  auto device = make_device(embree ? scene.embree : scene.portable, options);
  if (!device) {
    state.SkipWithError(device.error().message.c_str());
    return;
  }
  for (auto _ : state) {
    auto result = (*device)->render(scene.unit);
    if (!result) state.SkipWithError(result.error().message.c_str());
    benchmark::DoNotOptimize(result);
  }
  report(state, scene, scene.rays.rays);
}

/// Embree on the recorded rays, packing and unpacking included: what it would take if shading were free.
void bare_embree(benchmark::State& state, const BenchmarkScene& scene, Isa isa) {
  DeviceOptions options;
  options.isa = isa;
  auto made = EmbreeTracer::make(scene.embree, options);
  if (!made) {
    state.SkipWithError(made.error().message.c_str());
    return;
  }
  const Tracer tracer = (*made)->tracer();
  auto stages = scene.rays.stages;
  for (auto _ : state)
    for (RecordedStage& stage : stages) {
      const PathState paths = stage.paths();
      const bool shadow = stage.kind == RayKind::kShadow;
      (shadow ? tracer.occlude : tracer.intersect)(tracer.context, &paths, stage.count);
    }
  report(state, scene, scene.rays.rays);
}

int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const std::string file = argc > 1 ? argv[1] : PENUMBRA_SOURCE_DIR "/scenes/cornell-small/cornell-small.xml";
  ReadOptions reading;
  reading.lenient = true;
  auto description = read_scene(file, reading);
  if (!description) {
    fmt::print(stderr, "{}\n", description.error().message);
    return 2;
  }
  description->sampler.spp = kSamples;
  auto scene = std::make_shared<BenchmarkScene>();
  auto portable = build_device_scene(*description, {.intersector = IntersectorChoice::kPortable});
  auto embree = build_device_scene(*description, {.intersector = IntersectorChoice::kEmbree});
  if (!portable || !embree) {
    fmt::print(stderr, "{}\n", (portable ? embree : portable).error().message);
    return 2;
  }
  scene->portable = std::move(*portable);
  scene->embree = std::move(*embree);
  const Film& film = description->film;
  scene->unit = {film.width / 2 - kTile / 2, film.height / 2 - kTile / 2, kTile, kTile, 0, kSamples};
  scene->rays = record_rays(scene->embree, scene->unit, best_isa());

  for (const Isa isa : usable_isas()) {
    DeviceOptions options;
    options.isa = isa;
    const auto name = [&](const char* what) { return fmt::format("{}/{}", what, isa_name(isa)); };
    benchmark::RegisterBenchmark(name("native, portable intersector").c_str(),
                                 [=](benchmark::State& s) { render_unit(s, *scene, false, options); });
    benchmark::RegisterBenchmark(name("native, Embree").c_str(),
                                 [=](benchmark::State& s) { render_unit(s, *scene, true, options); });
    benchmark::RegisterBenchmark(name("Embree alone").c_str(),
                                 [=](benchmark::State& s) { bare_embree(s, *scene, isa); });
  }
  DeviceOptions opencl;
  opencl.backend = Backend::kOpenCl;
  benchmark::RegisterBenchmark("OpenCL, portable intersector", [=](benchmark::State& s) {
    render_unit(s, *scene, false, opencl);
  })->UseRealTime();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) { return penumbra::run(argc, argv); }
