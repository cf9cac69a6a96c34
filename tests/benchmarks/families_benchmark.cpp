// Cost of many BSDF families relative to one of equal cost: several families that differ only by their
// number, mixed at random in a room of boxes, against a single one. Both give the same image.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <random>
#include <vector>

#include "scenes/device/device_scene_builder.h"
#include "tests/support/extra_families/extra_family_kernels.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/native_blocks.h"

namespace penumbra {

NativeRenderBlock render_benchmarked_families;
NativeTracePhotons trace_benchmarked_families;

namespace {

constexpr int kFamilies = 6;
constexpr int kPhongs = FAMILY_GLOSSY - FAMILY_CRUDE + 1;  ///< families of the same cost
constexpr RenderUnit kUnit{.width = 96, .height = 96, .sample_count = 16};

/// Quads with a family each, at random.
class RandomFamilies {
 public:
  void add_quad(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v) {
    Mesh& mesh = meshes_[random_() % kFamilies];
    const auto first = unsigned(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {corner, corner + u, corner + u + v, corner + v});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }

  /// The six sides of the box from `least` on, each of `cells` x `cells` quads.
  void add_box(glm::dvec3 least, glm::dvec3 size, int cells) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 u(0), v(0), w(0);
      u[(axis + 1) % 3] = size[(axis + 1) % 3] / cells;
      v[(axis + 2) % 3] = size[(axis + 2) % 3] / cells;
      w[axis] = size[axis];
      for (int cell = 0; cell < cells * cells; ++cell) {
        const glm::dvec3 corner = least + u * double(cell % cells) + v * double(cell / cells);
        add_quad(corner, u, v);
        add_quad(corner + w, u, v);
      }
    }
  }

  double uniform(double from, double to) {
    return from + (to - from) * double(random_()) / double(random_.max());
  }

  [[nodiscard]] const std::array<Mesh, kFamilies>& meshes() const { return meshes_; }

 private:
  std::array<Mesh, kFamilies> meshes_;
  std::mt19937 random_{1};
};

/// `boxes` in a room whose walls are of `cells` x `cells` quads each.
SceneDescription room_of_boxes(int boxes, int cells) {
  RandomFamilies quads;
  quads.add_box({-1, -1, -1}, {2, 2, 2}, cells);
  for (int box = 0; box < boxes; ++box) {
    const glm::dvec3 least(quads.uniform(-0.9, 0.8), quads.uniform(-1, 0.5), quads.uniform(-0.5, 0.8));
    quads.add_box(least, glm::dvec3(quads.uniform(0.02, 0.15)), 1);
  }
  SceneDescription scene;
  scene.source = "room of boxes";
  for (int k = 0; k < kFamilies; ++k) {
    scene.bsdfs.push_back({"glossy", PhongBsdf{glm::vec3(0.4f), glm::vec3(0.3f), 20.0f}});
    Shape shape;
    shape.name = "boxes";
    shape.geometry = quads.meshes()[std::size_t(k)];
    shape.front_bsdf = shape.back_bsdf = k;
    scene.shapes.push_back(shape);
  }
  Shape light;
  light.name = "light";
  light.geometry =
      Mesh{.positions = {{-0.4, 0.98, -0.4}, {0.4, 0.98, -0.4}, {0.4, 0.98, 0.4}, {-0.4, 0.98, 0.4}},
           .normals = {},
           .texcoords = {},
           .triangles = {{0, 1, 2}, {0, 2, 3}}};
  light.radiance = glm::vec3(4.0f);
  scene.shapes.push_back(light);
  scene.camera.to_world[3] = glm::dvec4(0, 0, -0.95, 1);
  scene.camera.fov = 80;
  scene.film.width = scene.film.crop_width = kUnit.width;
  scene.film.height = scene.film.crop_height = kUnit.height;
  param::max_depth(scene.integrator) = 6;
  return scene;
}

/// The same scene with `count` families.
DeviceScene with_families(const DeviceScene& scene, int count) {
  DeviceScene changed = scene;
  std::vector<ExtraFamily> extra_families;
  for (int k = 0; k < kFamilies; ++k)
    extra_families.push_back({.material = k + 1, .family = FAMILY_CRUDE + k % count});
  put_extra_families(changed, extra_families);
  return changed;
}

/// The kernels with the additional families, compiled as the renderer's own.
constexpr NativeKernel kKernel{Isa::kSse2, 16, render_benchmarked_families, trace_benchmarked_families};

double thread_milliseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) * 1e3 + double(now.tv_nsec) * 1e-6;
}

/// Of rendering the unit.
double milliseconds(const NativeKernel& kernel, const DeviceScene& scene) {
  const double before = thread_milliseconds();
  benchmark::DoNotOptimize(render_native_blocks(kernel, scene, kUnit, kBlockPaths));
  return thread_milliseconds() - before;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Its paths are not sorted by family.
DeviceScene unsorted(DeviceScene scene) {
  scene.header.features &= ~std::uint64_t(FEATURE_MIXED_FAMILIES);
  return scene;
}

/// In turns, since a machine's speed changes; medians, since it is interrupted.
void compare(benchmark::State& state, const NativeKernel& kernel, const DeviceScene& one,
             const DeviceScene& several) {
  const DeviceScene shuffled = unsorted(several);
  std::vector<double> ones, sorted, unsorted, sorted_ratios, unsorted_ratios;
  for (auto _ : state) {
    ones.push_back(milliseconds(kernel, one));
    sorted.push_back(milliseconds(kernel, several));
    unsorted.push_back(milliseconds(kernel, shuffled));
    sorted_ratios.push_back(sorted.back() / ones.back());
    unsorted_ratios.push_back(unsorted.back() / ones.back());
  }
  state.counters["one_ms"] = median(ones);
  state.counters["several_ms"] = median(sorted);
  state.counters["ratio"] = median(sorted_ratios);
  state.counters["unsorted_ms"] = median(unsorted);
  state.counters["unsorted_ratio"] = median(unsorted_ratios);
}

bool register_room(const char* name, const SceneDescription& description) {
  const auto built = build_device_scene(description, {.intersector = IntersectorChoice::kPortable});
  if (!built) {
    fmt::print(stderr, "{}\n", built.error().message);
    return false;
  }
  const DeviceScene one = with_families(*built, 1), several = with_families(*built, kPhongs);
  benchmark::RegisterBenchmark(name, [=](benchmark::State& state) { compare(state, kKernel, one, several); })
      ->Unit(benchmark::kMillisecond)
      ->MinTime(8);
  return true;
}

int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (!register_room("9000 triangles", room_of_boxes(500, 16))) return 2;
  if (!register_room("62 triangles, tested one by one", room_of_boxes(4, 1))) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) { return penumbra::run(argc, argv); }
