// Cost of textures: a room of glossy boxes whose materials have 0, 1, 4 or 16 bitmaps each, in samples per
// second, with path tracing and with direct light.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scenes/device/device_scene_builder.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/native_blocks.h"

namespace penumbra {
namespace {

constexpr int kMaterials = 8, kSide = 512;
constexpr RenderUnit kUnit{.width = 96, .height = 96, .sample_count = 16};

std::mt19937 generator(1);  // NOLINT: one sequence for all

double uniform(double from, double to) {
  return from + (to - from) * double(generator()) / double(std::mt19937::max());
}

std::shared_ptr<const Bitmap> random_bitmap(TexelType type) {
  Bitmap bitmap{"", kSide, kSide, 3, type, {}};
  const std::size_t words = std::size_t(kSide * kSide * 3) * size_of(type) / 4;
  // Halves and floats in [0.5, 1).
  for (std::size_t i = 0; i < words; ++i)
    bitmap.words.push_back(type == TexelType::kByte ? std::uint32_t(generator())
                           : type == TexelType::kHalf
                               ? 0x38003800u | (std::uint32_t(generator()) & 0x03ff03ffu)
                               : 0x3f000000u | std::uint32_t(generator()) >> 9);
  return std::make_shared<const Bitmap>(std::move(bitmap));
}

/// A quad with texture coordinates.
void add_quad(Mesh& mesh, glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v) {
  const auto first = unsigned(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {corner, corner + u, corner + u + v, corner + v});
  mesh.texcoords.insert(mesh.texcoords.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

void add_box(Mesh& mesh, glm::dvec3 least, glm::dvec3 size) {
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 u(0), v(0), w(0);
    u[(axis + 1) % 3] = size[(axis + 1) % 3];
    v[(axis + 2) % 3] = size[(axis + 2) % 3];
    w[axis] = size[axis];
    add_quad(mesh, least, u, v);
    add_quad(mesh, least + w, u, v);
  }
}

class TexturedRoom {
 public:
  explicit TexturedRoom(TexelType type) : type_(type) {
    scene_.source = "textured room";
    for (int k = 0; k < kMaterials; ++k) {
      Mesh mesh;
      if (k == 0) add_box(mesh, {-1, -1, -1}, {2, 2, 2});
      for (int box = 0; box < 60; ++box)
        add_box(mesh, {uniform(-0.9, 0.8), uniform(-1, 0.5), uniform(-0.5, 0.8)},
                glm::dvec3(uniform(0.02, 0.15)));
      Shape shape;
      shape.name = "boxes";
      shape.geometry = std::move(mesh);
      shape.front_bsdf = shape.back_bsdf = k;
      scene_.shapes.push_back(shape);
    }
    Shape light;
    light.name = "light";
    Mesh area_light;
    add_quad(area_light, {-0.4, 0.98, -0.4}, {0.8, 0, 0}, {0, 0, 0.8});
    light.geometry = std::move(area_light);
    light.radiance = glm::vec3(4.0f);
    scene_.shapes.push_back(light);
    scene_.camera.to_world[3] = glm::dvec4(0, 0, -0.95, 1);
    scene_.camera.fov = 80;
    scene_.film.width = scene_.film.crop_width = kUnit.width;
    scene_.film.height = scene_.film.crop_height = kUnit.height;
  }

  /// Each material has that many bitmaps, all different.
  SceneDescription with_bitmaps(int count, bool direct) {
    SceneDescription scene = scene_;
    if (direct) use(scene.integrator, IntegratorKind::kDirect);
    if (direct) param::emitter_samples(scene.integrator) = 4;
    if (!direct) param::max_depth(scene.integrator) = 6;
    for (int k = 0; k < kMaterials; ++k) {
      PhongBsdf phong{glm::vec3(0.4f), glm::vec3(0.3f), 20.0f};
      if (count == 1) phong.diffuse.texture = add_tree(scene, 1, 0.8f);
      if (count > 1) {
        phong.diffuse.texture = add_tree(scene, count / 2, 0.6f);
        phong.specular.texture = add_tree(scene, count / 4, 0.3f);
        phong.exponent.texture = add_tree(scene, count / 4, 40.0f);
      }
      scene.bsdfs.push_back({"glossy", phong});
    }
    return scene;
  }

 private:
  /// Checkerboards of checkerboards down to so many bitmaps, a power of two, times a number.
  int add_tree(SceneDescription& scene, int bitmaps, float scale) {
    const auto add = [&](const TextureModel& model, double size) {
      scene.textures.push_back({"", model, glm::dmat3(size)});
      return int(scene.textures.size()) - 1;
    };
    const auto grow = [&](const auto& self, int count) -> int {
      if (count == 1) {
        BitmapTexture bitmap;
        bitmap.bitmap = int(scene.bitmaps.size());
        scene.bitmaps.push_back(random_bitmap(type_));
        return add(bitmap, 1);
      }
      CheckerboardTexture board;
      board.color0 = board.color1 = glm::vec3(1.0f);
      board.color0.texture = self(self, count / 2);
      board.color1.texture = self(self, count / 2);
      return add(board, count);
    };
    return add(ScaleTexture{glm::vec3(scale), grow(grow, bitmaps)}, 1);
  }

  TexelType type_;
  SceneDescription scene_;
};

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + double(now.tv_nsec) * 1e-9;
}

void measure(benchmark::State& state, const NativeKernel& kernel, const DeviceScene& scene) {
  std::vector<double> seconds;
  for (auto _ : state) {
    const double before = thread_seconds();
    benchmark::DoNotOptimize(render_native_blocks(kernel, scene, kUnit, kBlockPaths));
    seconds.push_back(thread_seconds() - before);
  }
  std::ranges::nth_element(seconds, seconds.begin() + std::ptrdiff_t(seconds.size() / 2));
  state.counters["samples/s"] =
      double(kUnit.width * kUnit.height) * kUnit.sample_count / seconds[seconds.size() / 2];
  state.counters["textures_MB"] = double(scene.header.tables.texels.count) * 4e-6;
}

int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  for (const auto& [type, name] :
       {std::pair(TexelType::kByte, "bytes"), std::pair(TexelType::kHalf, "halves"),
        std::pair(TexelType::kFloat, "floats")})
    for (const bool direct : {false, true})
      for (const int count : {0, 1, 4, 16}) {
        if (count == 0 && type != TexelType::kByte) continue;
        const auto built = build_device_scene(TexturedRoom(type).with_bitmaps(count, direct),
                                              {.intersector = IntersectorChoice::kPortable});
        if (!built) {
          fmt::print(stderr, "{}\n", built.error().message);
          return 2;
        }
        for (const Isa target : {Isa::kAvx2, Isa::kAvx512})
          if (const NativeKernel* kernel = find_native_kernel(target))
            benchmark::RegisterBenchmark(
                fmt::format("{}/{} {}/{}", direct ? "direct" : "path", count, name, isa_name(target)).c_str(),
                [=, scene = *built](benchmark::State& state) { measure(state, *kernel, scene); })
                ->Unit(benchmark::kMillisecond)
                ->MinTime(2);
      }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) { return penumbra::run(argc, argv); }
