// Photon maps with one thread: photon paths and stored photons a second while a map is made, and density
// estimates a second while an image takes light from it.
//
//     photon_benchmark [SCENE...]
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenes/device/device_scene_builder.h"
#include "scenes/scene_reader.h"
#include "worker/device.h"

namespace penumbra {
namespace {

constexpr int kPhotons = 250'000, kSide = 512;

template <typename T>
T or_throw(Expected<T> value) {
  if (!value) throw std::runtime_error(value.error().message);
  return std::move(*value);
}

DeviceScene scene_of(const std::string& file) {
  SceneDescription scene = or_throw(read_scene(file, {}));
  ProgressivePhotonIntegrator ppm;
  ppm.photon_count = kPhotons;
  scene.integrator.method = ppm;
  scene.film.width = scene.film.crop_width = kSide;
  scene.film.height = scene.film.crop_height = kSide;
  return or_throw(build_device_scene(scene, {}));
}

std::unique_ptr<Device> device_of(const DeviceScene& scene) {
  return or_throw(make_device(scene, {.threads = 1, .isa = best_isa()}));
}

RenderUnit unit_of(int side, std::uint32_t map) {
  return {.x = 0, .y = 0, .width = side, .height = side, .first_sample = map, .sample_count = 1};
}

/// A pixel of each pass needs the pass's map.
void make_maps(benchmark::State& state, const DeviceScene& scene) {
  const std::unique_ptr<Device> device = device_of(scene);
  std::uint32_t map = 0;
  for (auto _ : state) benchmark::DoNotOptimize(device->render(unit_of(1, map++)));
  state.counters["photon paths"] =
      benchmark::Counter(double(state.iterations()) * kPhotons, benchmark::Counter::kIsRate);
}

void take_light(benchmark::State& state, const DeviceScene& scene) {
  const std::unique_ptr<Device> device = device_of(scene);
  benchmark::DoNotOptimize(device->render(unit_of(1, 0)));
  for (auto _ : state) benchmark::DoNotOptimize(device->render(unit_of(kSide, 0)));
  state.counters["camera paths"] =
      benchmark::Counter(double(state.iterations()) * kSide * kSide, benchmark::Counter::kIsRate);
}

}  // namespace
}  // namespace penumbra

int main(int count, char** arguments) {
  benchmark::Initialize(&count, arguments);
  std::vector<std::string> files(arguments + 1, arguments + count);
  if (files.empty())
    for (const char* name : {"cornell/cornell", "caustics/caustics", "smoke/smoke"})
      files.push_back(fmt::format("{}/scenes/{}.xml", PENUMBRA_SOURCE_DIR, name));
  std::vector<std::unique_ptr<penumbra::DeviceScene>> scenes;
  for (const std::string& file : files) {
    scenes.push_back(std::make_unique<penumbra::DeviceScene>(penumbra::scene_of(file)));
    const penumbra::DeviceScene* scene = scenes.back().get();
    const std::string name = std::filesystem::path(file).stem();
    benchmark::RegisterBenchmark((name + ", map").c_str(), [scene](auto& s) {
      penumbra::make_maps(s, *scene);
    })->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark((name + ", image").c_str(), [scene](auto& s) {
      penumbra::take_light(s, *scene);
    })->Unit(benchmark::kMillisecond);
  }
  benchmark::RunSpecifiedBenchmarks();
}
