// Cost of the frames of a shot, of whose triangles 1 % move: the start of the first and of later ones, stage
// by stage, what a worker has already, and what two trees instead of one cost in rendering.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "kernels/host/native_kernels.h"
#include "scenes/device/device_scene_builder.h"
#include "scenes/motion/scene_motion.h"
#include "tests/benchmarks/bumpy_room.h"
#include "tests/benchmarks/load_stages.h"
#include "worker/device.h"
#include "worker/protocol/asset_manifest.h"

namespace penumbra {
namespace {

constexpr int kTextures = 10, kTextureSide = 4096;

std::shared_ptr<const Bitmap> noise(int number) {
  Bitmap bitmap{.name = "noise", .width = kTextureSide, .height = kTextureSide, .channels = 3, .words = {}};
  bitmap.words.resize(std::size_t(kTextureSide) * kTextureSide * 3 / 4);
  std::uint32_t state = std::uint32_t(number) + 1;
  for (std::uint32_t& word : bitmap.words) word = state = state * 1664525u + 1013904223u;
  return std::make_shared<const Bitmap>(std::move(bitmap));
}

/// Tiles with textures on the floor.
void add_textures(SceneDescription& scene) {
  for (int i = 0; i < kTextures; ++i) {
    scene.bitmaps.push_back(noise(i));
    BitmapTexture texture;
    texture.bitmap = i;
    scene.textures.push_back({"", texture, glm::dmat3(1.0)});
    DiffuseBsdf diffuse{glm::vec3(0.5f)};
    diffuse.reflectance.texture = i;
    scene.bsdfs.push_back({"tile", diffuse});
    const double x = -0.95 + 0.19 * i;
    Mesh tile{
        .positions = {{x, -0.99, -0.9}, {x, -0.99, 0.9}, {x + 0.18, -0.99, 0.9}, {x + 0.18, -0.99, -0.9}},
        .normals = {},
        .texcoords = {{0, 0}, {0, 1}, {1, 1}, {1, 0}},
        .triangles = {{0, 1, 2}, {0, 2, 3}}};
    Shape shape;
    shape.name = "tile";
    shape.geometry = std::move(tile);
    shape.front_bsdf = shape.back_bsdf = int(scene.bsdfs.size()) - 1;
    scene.shapes.push_back(std::move(shape));
  }
}

/// A smaller ball that circles about the large one.
void add_moving_ball(SceneDescription& scene, int triangles) {
  Shape ball = bumpy_room(triangles).shapes[1];
  ball.name = "moving ball";
  for (glm::dvec3& p : std::get<Mesh>(ball.geometry).positions) p *= 0.3;
  auto motion = std::make_shared<SceneMotion>();
  std::vector<TransformKey> keys;
  for (int i = 0; i <= 8; ++i) {
    glm::dmat4 place(1.0);
    place[3] = glm::dvec4(0.75 * std::cos(0.7 * i), 0.1 * i - 0.4, 0.75 * std::sin(0.7 * i), 1);
    keys.push_back({double(i), place});
  }
  motion->nodes.push_back({.keys = value_or_exit(keyed_transform(keys))});
  motion->shapes.push_back({.shape = scene.shapes.size(), .rest = ball.geometry, .place = {.node = 0}});
  scene.shapes.push_back(std::move(ball));
  scene.motion = motion;
}

struct Frame {
  DeviceScene scene;
  AssetManifest manifest;
};

Frame make_frame(SceneDescription& scene, int number, const Frame* earlier, double units) {
  Frame frame;
  const auto name = [&](const char* stage) { return fmt::format("frame {}: {}", number, stage); };
  show_stage(name("pose"), units, [&] {
    if (const auto posed = set_time(scene, number / 24.0); !posed) fmt::print("{}\n", posed.error().message);
  });
  show_stage(name("device scene"), units, [&] {
    frame.scene =
        value_or_exit(build_device_scene(scene, {.earlier = earlier != nullptr ? &earlier->scene : nullptr}));
  });
  show_stage(name("manifest"), units, [&] {
    frame.manifest = earlier != nullptr ? manifest_of(frame.scene, earlier->scene, earlier->manifest)
                                        : manifest_of(frame.scene);
  });
  if (earlier == nullptr) return frame;
  std::size_t changed = 0;
  for (const AssetPiece& piece : frame.manifest.pieces)
    if (std::ranges::find(earlier->manifest.pieces, piece) == earlier->manifest.pieces.end())
      changed += piece.size;
  fmt::print("frame {}: {:.2f} of {:.2f} MB have changed\n", number, double(changed) * 1e-6,
             double(frame.manifest.bytes()) * 1e-6);
  return frame;
}

double seconds_of_render(const DeviceScene& scene) {
  DeviceOptions options;
  options.threads = int(std::thread::hardware_concurrency());
  options.isa = best_isa();
  const auto device = value_or_exit(make_device(scene, options));
  RenderUnit unit{};
  unit.width = scene.header.film.width;
  unit.height = scene.header.film.height;
  unit.sample_count = 4;
  const std::clock_t start = std::clock();
  value_or_exit(device->render(unit));
  return double(std::clock() - start) / CLOCKS_PER_SEC;
}

void run(int triangles, bool textures, int frames) {
  SceneDescription scene = bumpy_room(triangles);
  if (textures) add_textures(scene);
  add_moving_ball(scene, triangles / 100);
  print_stage_heading("triangle");
  std::optional<Frame> last;
  for (int number = 0; number < frames; ++number) {
    Frame next = make_frame(scene, number, last ? &*last : nullptr, triangles);
    last = std::move(next);
  }
  SceneDescription still = scene;
  still.motion = nullptr;
  const DeviceScene one = value_or_exit(build_device_scene(still, {}));
  for (int i = 0; i < 5; ++i)
    fmt::print("seconds of cores: {:.3f} with one tree, {:.3f} with two\n", seconds_of_render(one),
               seconds_of_render(last->scene));
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  penumbra::run(argc > 1 ? std::atoi(argv[1]) : 1'000'000, argc <= 2 || std::string(argv[2]) != "plain",
                argc > 3 ? std::atoi(argv[3]) : 4);
}
