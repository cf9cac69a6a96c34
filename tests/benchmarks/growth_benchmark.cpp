// `growth_benchmark`: how the time of reading a scene and building its tables grows with the scene. The last
// lines of each give the fitted order (N, NlgN, N^2, ...) and the quality of the fit.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <functional>
#include <stdexcept>
#include <string>

#include "scenes/device/device_scene_builder.h"
#include "scenes/scene_reader.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

std::string somewhere(int i) {
  return fmt::format(
      "<transform name='to_world'><scale value='0.1'/><translate x='{}' y='{}' z='{}'/></transform>",
      i * 7919LL % 101 - 50, i * 104729LL % 103 - 51, i * 1299709LL % 107 - 53);
}
std::string cube(int i, const std::string& inside) {
  return "<shape type='cube'>" + somewhere(i) + inside + "</shape>";
}
std::string grey(const char* name, int i) {
  return fmt::format("<rgb name='{}' value='{}'/>", name, double(i % 1000) / 1000);
}

struct Kind {
  const char* name;
  std::string before;
  std::function<std::string(int)> part;  ///< by its number
};

const Kind kKinds[] = {
    {"shapes", "", [](int i) { return cube(i, ""); }},
    {"spheres", "", [](int i) { return "<shape type='sphere'>" + somewhere(i) + "</shape>"; }},
    {"area_lights", "",
     [](int i) { return cube(i, "<emitter type='area'>" + grey("radiance", i) + "</emitter>"); }},
    {"point_lights", "",
     [](int i) {
       return fmt::format("<emitter type='point'><point name='position' x='{}' y='{}' z='3'/></emitter>",
                          i % 101, i / 101);
     }},
    {"instances", "<shape type='shapegroup' id='g'><shape type='cube'/></shape>",
     [](int i) { return "<shape type='instance'><ref id='g'/>" + somewhere(i) + "</shape>"; }},
    {"groups", "",
     [](int i) {
       return fmt::format(
           "<shape type='shapegroup' id='g{}'><shape type='cube'/></shape><shape type='instance'><ref "
           "id='g{}'/>{}</shape>",
           i, i, somewhere(i));
     }},
    {"materials", "",
     [](int i) { return cube(i, "<bsdf type='diffuse'>" + grey("reflectance", i) + "</bsdf>"); }},
    {"references", "<bsdf type='diffuse' id='m'/>", [](int i) { return cube(i, "<ref id='m'/>"); }},
    {"aliases", "<bsdf type='diffuse' id='m0'/>",
     [](int i) { return fmt::format("<alias id='m{}' as='m{}'/>", i, i + 1); }},
    {"textures", "",
     [](int i) {
       return cube(i, "<bsdf type='diffuse'><texture type='checkerboard' name='reflectance'>" +
                          grey("color0", i) + "</texture></bsdf>");
     }},
    {"media", "",
     [](int i) {
       return cube(i, fmt::format("<bsdf type='null'/><medium name='interior' type='homogeneous'><float "
                                  "name='sigma_t' value='{}'/></medium>",
                                  1 + i));
     }},
};

void read_and_build(benchmark::State& state, const Kind& kind) {
  const TemporaryFolder folder;
  std::string text =
      "<scene version='3.0.0'><sensor type='perspective'/><emitter type='constant'/>" + kind.before;
  for (int i = 0; i < int(state.range(0)); ++i) text += kind.part(i);
  write_text(folder / "scene.xml", text + "</scene>");
  for (auto _ : state) {
    const auto scene = read_scene(folder / "scene.xml", {});
    if (!scene) throw std::runtime_error(scene.error().message);
    const auto built = build_device_scene(*scene, {});
    if (!built) throw std::runtime_error(built.error().message);
    benchmark::DoNotOptimize(built->words.data());
  }
  state.SetComplexityN(state.range(0));
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  for (const penumbra::Kind& kind : penumbra::kKinds)
    benchmark::RegisterBenchmark(kind.name,
                                 [&kind](benchmark::State& state) { penumbra::read_and_build(state, kind); })
        ->RangeMultiplier(10)
        ->Range(100, 100'000)
        ->Unit(benchmark::kMillisecond)
        ->Complexity();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
