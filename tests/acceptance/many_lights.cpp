#include "tests/acceptance/many_lights.h"

#include <cmath>
#include <numbers>

#include "tests/acceptance/scene_pieces.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

SceneDescription scene_of_paths() {
  SceneDescription scene = empty_scene(48, 32, 16, 0);
  scene.sampler.kind = SamplerKind::kSobol;
  scene.integrator = path_integrator(DirectSampling::kMis);
  param::max_depth(scene.integrator) = 4;
  return scene;
}

/// Six walls that face inwards.
void add_room(SceneDescription& scene, glm::dvec3 low, glm::dvec3 high, int bsdf) {
  const glm::dvec3 x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
  for (const Shape& wall : {parallelogram(low, z, x, bsdf), parallelogram(low + y, x, z, bsdf),
                            parallelogram(low, x, y, bsdf), parallelogram(low + z, y, x, bsdf),
                            parallelogram(low, y, z, bsdf), parallelogram(low + x, z, y, bsdf)}) {
    scene.shapes.push_back(wall);
    scene.shapes.back().back_bsdf = bsdf;
  }
}

/// Six walls that face outwards.
void add_block(SceneDescription& scene, glm::dvec3 low, glm::dvec3 high, int bsdf) {
  const std::size_t first = scene.shapes.size();
  add_room(scene, low, high, bsdf);
  for (std::size_t i = first; i < scene.shapes.size(); ++i) scene.shapes[i].flip_normals = true;
}

void add_area_light(SceneDescription& scene, glm::dvec3 middle, double size, float radiance) {
  scene.shapes.push_back(parallelogram(middle - glm::dvec3(size / 2, 0, size / 2), {size, 0, 0}, {0, 0, size},
                                       kBlackBsdf, radiance));
}

void add_sky(SceneDescription& scene, float radiance) {
  ConstantEnvironment sky;
  sky.radiance = glm::vec3(radiance);
  scene.emitters.emplace_back(sky);
}

/// A mesh of that many small triangles under the ceiling of a hall and along its walls.
SceneDescription emissive_triangles(int count) {
  SceneDescription scene = scene_of_paths();
  const int grey = add_diffuse(scene, 0.5f);
  add_room(scene, {-10, 0, -30}, {10, 6, 6}, grey);
  add_block(scene, {-4, 0, -8}, {-2, 3, -6}, grey);
  add_block(scene, {2, 0, -14}, {4, 4, -12}, grey);
  RandomNumbers random(1);
  std::vector<glm::dvec3> corners;
  for (int k = 0; k < count; ++k) {
    const glm::dvec3 p(random.between(-9.5, 9.5), random.between(3, 5.9), random.between(-29, 5));
    for (int j = 0; j < 3; ++j) {
      const Exact3 d = random.direction();
      corners.push_back(p + 0.03 * glm::dvec3(double(d.x), double(d.y), double(d.z)));
    }
  }
  scene.shapes.push_back(triangles(corners, grey, 400000.0f / float(count)));
  scene.camera = look_at({0, 2, 5}, {0, 1.5, -10}, {0, 1, 0}, 60);
  scene.integrator.hide_emitters = true;  // pixels would be noisy by them alone
  scene.integrator.hidden_emitters = HiddenEmitters::kLookedThrough;
  return scene;
}

/// Blocks on a plain, seen from above.
SceneDescription town(RandomNumbers& random) {
  SceneDescription scene = scene_of_paths();
  const int grey = add_diffuse(scene, 0.5f);
  scene.shapes.push_back(parallelogram({-40, 0, -70}, {0, 0, 80}, {80, 0, 0}, grey));
  for (int k = 0; k < 60; ++k) {
    const double x = random.between(-38, 36), z = random.between(-68, 0), h = random.between(1, 6);
    add_block(scene, {x, 0, z}, {x + 2, h, z + 2}, grey);
  }
  scene.camera = look_at({0, 4, 8}, {0, 0, -15}, {0, 1, 0}, 60);
  return scene;
}

SceneDescription point_lights(int count) {
  RandomNumbers random(2);
  SceneDescription scene = town(random);
  for (int k = 0; k < count; ++k) {
    PointLight light;
    light.position = {random.between(-39, 39), random.between(0.5, 4), random.between(-69, 9)};
    light.intensity = glm::vec3(float(std::pow(10.0, random.between(-1, 1))));
    scene.emitters.emplace_back(light);
  }
  return scene;
}

/// Cones of 15 to 35 degrees about directions up to 45 degrees off the plumb line.
SceneDescription spot_lights(int count) {
  RandomNumbers random(3);
  SceneDescription scene = town(random);
  for (int k = 0; k < count; ++k) {
    SpotLight light;
    light.cutoff_angle = random.between(15, 35);
    light.beam_width = 0.75 * light.cutoff_angle;
    light.intensity = glm::vec3(float(std::pow(10.0, random.between(0, 2))));
    const glm::dvec3 at(random.between(-39, 39), random.between(2, 8), random.between(-69, 9));
    const double tilt = random.between(0, std::numbers::pi / 4),
                 turn = random.between(0, 2 * std::numbers::pi);
    const glm::dvec3 z(std::sin(tilt) * std::cos(turn), -std::cos(tilt), std::sin(tilt) * std::sin(turn));
    const glm::dvec3 x = glm::normalize(glm::cross(z, glm::dvec3(0.6, 0, 0.8)));
    light.to_world =
        glm::dmat4(glm::dvec4(x, 0), glm::dvec4(glm::cross(z, x), 0), glm::dvec4(z, 0), glm::dvec4(at, 1));
    scene.emitters.emplace_back(light);
  }
  return scene;
}

/// A light in a room without a window under a sky a thousand times as bright.
SceneDescription closed_room(double window, float sky) {
  SceneDescription scene = scene_of_paths();
  const int grey = add_diffuse(scene, 0.6f);
  add_room(scene, {-3, 0, -4}, {3, 3, 4}, grey);
  if (window > 0) {
    // A frame of four walls in the place of the one at x = 3.
    scene.shapes.pop_back();
    const auto wall = [&](double y, double z, double height, double width) {
      scene.shapes.push_back(parallelogram({3, y, z}, {0, 0, width}, {0, height, 0}, grey));
      scene.shapes.back().back_bsdf = grey;
    };
    const double side = (8 - window) / 2, low = (3 - window) / 2;
    wall(0, -4, 3, side);
    wall(0, 4 - side, 3, side);
    wall(0, -4 + side, low, window);
    wall(3 - low, -4 + side, low, window);
  }
  add_area_light(scene, {0, 2.99, -1}, 0.6, 10);
  add_sky(scene, sky);
  scene.camera = look_at({0, 1.6, 3.8}, {0, 1.2, -2}, {0, 1, 0}, 70);
  return scene;
}

/// A plain of that size at night or day, and a torch near the camera.
SceneDescription field(double size, float sky) {
  SceneDescription scene = scene_of_paths();
  const int grey = add_diffuse(scene, 0.4f);
  scene.shapes.push_back(parallelogram({-size, 0, -size}, {0, 0, 2 * size}, {2 * size, 0, 0}, grey));
  add_block(scene, {-1, 0, -4}, {0, 2, -3}, grey);
  Shape torch;
  torch.name = "torch";
  torch.geometry = Sphere{.center = {1, 1.5, -3}, .radius = 0.1};
  torch.radiance = glm::vec3(60);
  scene.shapes.push_back(torch);
  add_sky(scene, sky);
  scene.camera = look_at({0, 2, 3}, {0, 1, -4}, {0, 1, 0}, 60);
  return scene;
}

/// Rooms in a row, lights in each, seen through doors.
SceneDescription rooms(int count) {
  SceneDescription scene = scene_of_paths();
  const int grey = add_diffuse(scene, 0.6f);
  add_room(scene, {-3, 0, -4.0 * count}, {3, 3, 4}, grey);
  for (int k = 0; k < count; ++k) {
    const double z = -4.0 * k;
    for (const auto& [x, width] : {std::pair(-3.0, 2.4), std::pair(0.6, 2.4)}) {
      scene.shapes.push_back(parallelogram({x, 0, z}, {width, 0, 0}, {0, 3, 0}, grey));
      scene.shapes.back().back_bsdf = grey;
    }
    for (int j = 0; j < 4; ++j)
      add_area_light(scene, {j % 2 == 0 ? -1.5 : 1.5, 2.98, z - (j < 2 ? 1 : 3)}, 0.3,
                     float(2 << (j + k) % 5));
  }
  scene.camera = look_at({0, 1.6, 3.5}, {0, 1.3, -6}, {0, 1, 0}, 70);
  return scene;
}

/// A plate of plastic under lights of very different size and distance.
SceneDescription plate() {
  SceneDescription scene = scene_of_paths();
  RoughPlasticBsdf plastic;
  plastic.alpha = 0.15f;
  scene.bsdfs.push_back({"plastic", BsdfModel(plastic)});
  const int shiny = int(scene.bsdfs.size()) - 1;
  scene.shapes.push_back(parallelogram({-6, 0, -8}, {0, 0, 12}, {12, 0, 0}, shiny));
  for (int k = 0; k < 7; ++k)
    add_area_light(scene, {-4.5 + 1.5 * k, 0.4 + 0.5 * k, -3}, 0.1 + 0.2 * k,
                   40.0f / float((k + 1) * (k + 1)));
  scene.camera = look_at({0, 3, 4}, {0, 0.5, -3}, {0, 1, 0}, 60);
  return scene;
}

}  // namespace

std::vector<ManyLights> many_lights() {
  return {{"10000 emissive triangles", emissive_triangles(10'000)},
          {"1000 point lights", point_lights(1000)},
          {"area light in a closed room under a bright sky", closed_room(0, 1000)},
          {"room with a window", closed_room(1.5, 3)},
          {"room with a small window, bright sky", closed_room(0.6, 10)},
          {"torch in a field at night", field(100, 0.01f)},
          {"torch in a wide field by day", field(10'000, 1)},
          {"rooms in a row", rooms(6)},
          {"plastic under area lights", plate()},
          {"1000 spots", spot_lights(1000)}};
}

}  // namespace penumbra
