#include "tests/acceptance/extra_family_scenes.h"

#include <cmath>

#include "tests/acceptance/scene_pieces.h"
#include "tests/support/native_blocks.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

constexpr int kWidth = 24, kHeight = 16;

/// Returns the BSDF's index.
int add_phong(SceneDescription& scene) {
  scene.bsdfs.push_back({"glossy", PhongBsdf{glm::vec3(0.3f), glm::vec3(0.5f), 20.0f}});
  return int(scene.bsdfs.size()) - 1;
}

/// A diffuse BSDF that becomes an extra family of that family, which gives `specular`. Returns its index.
int add_extra_family(ExtraFamilyScene& scene, int family, float specular, float exponent = 0) {
  const int bsdf = add_diffuse(scene.description, 0);
  scene.extra_families.push_back({bsdf + 1, family, specular, exponent});
  return bsdf;
}

void add_wall(SceneDescription& scene, glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, int bsdf,
              int cells = 1) {
  for (int i = 0; i < cells * cells; ++i) {
    const glm::dvec3 cell = corner + u * (double(i % cells) / cells) + v * (double(i / cells) / cells);
    scene.shapes.push_back(parallelogram(cell, u / double(cells), v / double(cells), bsdf));
    scene.shapes.back().back_bsdf = bsdf;
  }
}

}  // namespace

std::pair<int, int> add_glass(SceneDescription& scene, float index) {
  DielectricBsdf glass;
  glass.int_ior = index;
  glass.ext_ior = 1;
  scene.bsdfs.push_back({"glass", glass});
  scene.bsdfs.push_back({"glass", glass.other_side()});
  return {int(scene.bsdfs.size()) - 2, int(scene.bsdfs.size()) - 1};
}

DeviceScene ExtraFamilyScene::build() const {
  DeviceScene scene = build_or_throw(description);
  put_extra_families(scene, extra_families);
  return scene;
}

ExtraFamilyScene extra_family_room(const RoomOptions& options) {
  ExtraFamilyScene room;
  SceneDescription& scene = room.description = empty_scene(kWidth, kHeight, 256, 0);
  scene.sampler.kind = SamplerKind::kSobol;
  scene.camera = look_at({0, 1, -3}, {0, 1.2, 2}, {0, 1, 0}, 60);
  scene.integrator = path_integrator(DirectSampling::kMis);
  const int diffuse = add_diffuse(scene, 0.6f), phong = add_phong(scene), glossy = add_phong(scene);
  room.extra_families.push_back(
      {.material = glossy + 1, .family = options.crude ? FAMILY_CRUDE : FAMILY_GLOSSY});
  const glm::dvec3 right(1, 0, 0), up(0, 1, 0), away(0, 0, 1);
  add_wall(scene, {-2, 0, -2}, 4.0 * right, 4.0 * away, options.crude ? glossy : diffuse,
           options.many_triangles ? 8 : 1);
  add_wall(scene, {-2, 0, -2}, 2.5 * up, 4.0 * away, phong);
  add_wall(scene, {2, 0, -2}, 2.5 * up, 4.0 * away, glossy);
  add_wall(scene, {-2, 0, 2}, 4.0 * right, 2.5 * up,
           options.mirror ? add_extra_family(room, FAMILY_MIRROR, 0.9f) : glossy);
  add_wall(scene, {-0.8, 1.2, 0}, 0.9 * right, 0.9 * away, diffuse);
  // The mirror shows the first; the camera sees neither.
  scene.shapes.push_back(parallelogram({-0.8, 2.4, -1}, 1.6 * right, 1.0 * away, kBlackBsdf, 6.0f));
  scene.shapes.push_back(parallelogram({1.2, 2.4, 0.5}, 0.5 * right, 0.5 * away, kBlackBsdf, 10.0f));
  if (options.front_pane || options.light_pane) {
    const int window = add_extra_family(room, FAMILY_WINDOW, 1.0f);
    if (options.front_pane) add_wall(scene, {-3, -2, -2.5}, 6.0 * right, 6.0 * up, window);
    if (options.light_pane) add_wall(scene, {-2, 2.2, -2}, 4.0 * right, 4.0 * away, window);
  }
  return room;
}

ExtraFamilyScene room_with_glass() {
  ExtraFamilyScene room = extra_family_room({.mirror = false});
  const auto [inward, outward] = add_glass(room.description, 1.5f);
  for (const glm::dvec3& center : {glm::dvec3(0.2, 0.7, -0.3), glm::dvec3(1.0, 1.2, 0.9)}) {
    Shape sphere;
    sphere.name = "glass";
    sphere.geometry = Sphere{.center = center, .radius = 0.6};
    sphere.front_bsdf = inward;
    sphere.back_bsdf = outward;
    room.description.shapes.push_back(sphere);
  }
  return room;
}

ExtraFamilyScene glass_ball(float index) {
  ExtraFamilyScene ball;
  SceneDescription& scene = ball.description = empty_scene(kWidth, kHeight, 64, 0);
  scene.camera = look_at({0, 0, -4}, {0, 0, 0}, {0, 1, 0}, 20);
  scene.integrator = path_integrator(DirectSampling::kMis);
  scene.emitters = {ConstantEnvironment{glm::vec3(1.0f)}};
  Shape sphere;
  sphere.name = "ball";
  sphere.geometry = Sphere{};
  sphere.front_bsdf = add_extra_family(ball, FAMILY_REFRACTING, 1.0f, index);
  sphere.back_bsdf = add_extra_family(ball, FAMILY_REFRACTING, 1.0f, 1 / index);
  scene.shapes.push_back(sphere);
  return ball;
}

std::vector<float> render_extra_families(const NativeKernel& kernel, const DeviceScene& scene) {
  const SceneHeader& h = scene.header;
  const RenderUnit unit{.width = h.film.width, .height = h.film.height, .sample_count = h.sampler.spp};
  return render_native_blocks(kernel, scene, unit, kBlockPaths);
}

statistics::Estimate extra_family_estimate(const ExtraFamilyScene& scene, int batches,
                                           std::uint32_t first_seed, int block) {
  DeviceScene built = scene.build();
  const int width = built.header.film.width, height = built.header.film.height;
  std::vector<statistics::Image> images;
  for (int batch = 0; batch < batches; ++batch) {
    built.header.sampler.seed = first_seed + std::uint32_t(batch);
    const std::vector<float> planes = render_extra_families(extra_family_kernel(), built);
    statistics::Image image(width, height, 3);
    for (int c = 0; c < 3; ++c)
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          image.at(x, y, c) = double(planes[std::size_t(((kMeanR + c) * height + y) * width + x)]);
    images.push_back(statistics::block_average(image, block));
  }
  return statistics::estimate_from_batches(images);
}

statistics::Sample extra_family_sample(const ExtraFamilyScene& scene, int channel) {
  const DeviceScene built = scene.build();
  const std::vector<float> planes = render_extra_families(extra_family_kernel(), built);
  const int pixels = built.header.film.width * built.header.film.height;
  const std::uint32_t spp = built.header.sampler.spp;
  double sum = 0, squares = 0;
  for (int p = 0; p < pixels; ++p) {
    const double mean = double(planes[std::size_t((kMeanR + channel) * pixels + p)]);
    const double deviation = double(planes[std::size_t((kDeviationR + channel) * pixels + p)]);
    sum += mean;
    squares += mean * mean + deviation * deviation;
  }
  const double mean = sum / pixels;
  return {std::uint64_t(pixels) * spp, mean, (squares - sum * mean) * spp};
}

}  // namespace penumbra
