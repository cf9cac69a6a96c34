// Rays per second of the intersectors alone, on one thread and the rays of a path-traced render: the portable
// one against Embree's single rays, packets and streams, for camera, bounced and shadow rays, over the number
// of triangles. `traversal_benchmark [SCENE...]` uses scene files instead of rooms.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <memory>
#include <utility>

#include "scenes/device/device_scene_builder.h"
#include "scenes/scene_reader.h"
#include "tests/benchmarks/bumpy_room.h"
#include "tests/benchmarks/embree_calls.h"
#include "tests/benchmarks/portable_stages.h"
#include "tests/benchmarks/recorded_rays.h"
#include "tests/support/integrator_parameters.h"
#include "worker/native_device.h"

namespace penumbra {
namespace {

constexpr std::uint32_t kSamples = 8;
constexpr int kTile = 96;

struct TraversalScene {
  DeviceScene portable, embree;
  RecordedRays rays;
  std::unique_ptr<EmbreeTracer> tracer;
};

/// Calls stage(recorded stage) for those of one kind, over and over.
template <typename Stage>
void time_rays(benchmark::State& state, const TraversalScene& scene, RayKind kind, Stage stage) {
  std::vector<RecordedStage> wanted;
  std::size_t rays = 0;
  for (const RecordedStage& recorded : scene.rays.stages)
    if (recorded.kind == kind) rays += count_rays(wanted.emplace_back(recorded));
  for (auto _ : state)
    for (RecordedStage& recorded : wanted) stage(recorded);
  state.counters["rays/s"] = benchmark::Counter(double(rays), benchmark::Counter::kIsIterationInvariantRate);
}

void add_embree(const std::string& name, std::shared_ptr<TraversalScene> scene, RayKind kind, Tracer tracer) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    time_rays(state, *scene, kind, [&](RecordedStage& stage) {
      const PathState paths = stage.paths();
      (kind == RayKind::kShadow ? tracer.occlude : tracer.intersect)(tracer.context, &paths, stage.count);
    });
  });
}

void add_portable(const std::string& name, std::shared_ptr<TraversalScene> scene, RayKind kind,
                  PortableStage* stage, bool whole) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    SceneHeader header = scene->portable.header;
    if (whole) header.features &= ~std::uint64_t(FEATURE_BVH);
    time_rays(state, *scene, kind, [&](RecordedStage& recorded) {
      const PathState paths = recorded.paths();
      stage(header, scene->portable.words.data(), kind == RayKind::kShadow, kind == RayKind::kCamera, &paths,
            recorded.count);
    });
  });
}

bool add_scene(const std::string& name, SceneDescription description) {
  description.sampler.spp = kSamples;
  use(description.integrator, IntegratorKind::kPath);
  auto scene = std::make_shared<TraversalScene>();
  const bool layers = false;
  auto portable = build_device_scene(description,
                                     {.intersector = IntersectorChoice::kPortable, .feature_layers = layers});
  auto embree =
      build_device_scene(description, {.intersector = IntersectorChoice::kEmbree, .feature_layers = layers});
  if (!portable || !embree) {
    fmt::print(stderr, "{}\n", (portable ? embree : portable).error().message);
    return false;
  }
  scene->portable = std::move(*portable);
  scene->embree = std::move(*embree);
  const Film& film = description.film;
  scene->rays = record_rays(
      scene->embree, {film.width / 2 - kTile / 2, film.height / 2 - kTile / 2, kTile, kTile, 0, kSamples},
      best_isa());
  DeviceOptions options;
  options.isa = best_isa();
  auto tracer = EmbreeTracer::make(scene->embree, options);
  if (!tracer) {
    fmt::print(stderr, "{}\n", tracer.error().message);
    return false;
  }
  scene->tracer = std::move(*tracer);
  const SceneHeader& header = scene->portable.header;
  const bool hierarchy = (header.features & FEATURE_BVH) != 0, whole = header.tables.corners.count > 0;
  for (const auto& [kind, rays] :
       {std::pair{RayKind::kCamera, "camera"}, {RayKind::kBounce, "bounce"}, {RayKind::kShadow, "shadow"}}) {
    const std::string title = fmt::format("{}/{} triangles/{}/", name, header.tables.triangles.count, rays);
    using Set = std::pair<Isa, PortableStage*>;
    for (const auto& [isa, stage] :
         {Set{Isa::kAvx512, portable_stage_avx512}, Set{Isa::kAvx2, portable_stage_avx2},
          Set{Isa::kSse2, portable_stage_sse2}}) {
      if (!machine_has(isa)) continue;
      const std::string set(isa_name(isa));
      if (hierarchy) add_portable(title + "hierarchy " + set, scene, kind, stage, false);
      if (whole) add_portable(title + "whole " + set, scene, kind, stage, true);
    }
    add_embree(title + "Embree single", scene, kind, embree_single(*scene->tracer));
    add_embree(title + "Embree packets", scene, kind, scene->tracer->tracer());
    add_embree(title + "Embree stream", scene, kind, embree_stream(*scene->tracer));
  }
  return true;
}

int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  for (int i = 1; i < argc; ++i) {
    ReadOptions reading;
    reading.lenient = true;
    auto description = read_scene(argv[i], reading);
    if (!description) {
      fmt::print(stderr, "{}\n", description.error().message);
      return 2;
    }
    if (!add_scene(argv[i], std::move(*description))) return 2;
  }
  for (const int ball : {18, 50, 72, 128, 500, 2000, 10'000, 100'000, 500'000, 4'000'000})
    if (argc == 1 && !add_scene("room", bumpy_room(ball))) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) { return penumbra::run(argc, argv); }
