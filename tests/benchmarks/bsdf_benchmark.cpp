// Nanoseconds per evaluation and per sample of each family of BSDFs, LANES at a time.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "kernels/host/device_scene.h"
#include "scenes/bsdfs.h"
#include "tests/benchmarks/bsdf_stages.h"

namespace penumbra {
namespace {

constexpr int kGroups = 1000;

template <typename Model>
void add(const char* name, const Model& model) {
  const Closure closure = closure_of(material_of(model));
  for (const auto& [target, stages] :
       {std::pair("avx2", &bsdf_stages_avx2), std::pair("avx512", &bsdf_stages_avx512)}) {
    if (std::string_view(target) == "avx512" && !__builtin_cpu_supports("avx512f")) continue;
    for (const bool sample : {false, true})
      benchmark::RegisterBenchmark(fmt::format("{}/{}/{}", name, sample ? "sample" : "value", target).c_str(),
                                   [=, run = stages](benchmark::State& state) {
                                     for (auto _ : state)
                                       benchmark::DoNotOptimize(run(closure, sample, kGroups));
                                     state.counters["each"] = benchmark::Counter(
                                         double(state.iterations()) * kGroups * LANES,
                                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
                                   });
  }
}

int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  add("diffuse", DiffuseBsdf{});
  add("phong", PhongBsdf{});
  add("roughconductor", RoughConductorBsdf{});
  add("roughdielectric", RoughDielectricBsdf{});
  add("principled", PrincipledBsdf{});
  add("principledthin", PrincipledThinBsdf{});
  add("disney", DisneyBsdf{});
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) { return penumbra::run(argc, argv); }
