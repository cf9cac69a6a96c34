// A scene with all kinds of lights except environment maps.
#pragma once

#include <bit>
#include <cstdint>
#include <memory>
#include <vector>

#include "scenes/scene_description.h"

namespace penumbra {

/// Gives each shape of the scene that emits a texture, and adds lights of all other kinds, about `middle` and
/// as far from it as `size`. Of the two textures one has few bright texels, by which points are chosen.
inline void add_every_emitter(SceneDescription& scene, const glm::dvec3& middle, double size) {
  const int first = int(scene.textures.size());
  for (const bool sparse : {false, true}) {
    Bitmap image{"", 11, 6, 3, TexelType::kFloat, {}};
    for (int i = 0; i < 11 * 6 * 3; ++i) {
      const float value =
          sparse ? (i / 3 % 7 == 3 ? 2.0f + float(i % 5) : 0.02f) : 0.3f + 0.05f * float(i % 11);
      image.words.push_back(std::bit_cast<std::uint32_t>(value));
    }
    BitmapTexture texture;
    texture.bitmap = int(scene.bitmaps.size());
    scene.bitmaps.push_back(std::make_shared<const Bitmap>(std::move(image)));
    scene.textures.push_back({"", texture});
  }
  const int even = first, sparse = first + 1;
  bool which = false;
  for (Shape& shape : scene.shapes) {
    if (!shape.radiance) continue;
    shape.radiance_texture = which ? even : sparse;
    which = !which;
  }
  const glm::dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const auto add = [&](decltype(Shape::geometry) geometry, int texture) {
    Shape shape;
    shape.name = "textured";
    shape.geometry = std::move(geometry);
    shape.radiance = glm::vec3(1.0f, 0.8f, 0.5f);
    shape.radiance_texture = texture;
    scene.shapes.push_back(shape);
  };
  add(Sphere{middle + 0.3 * size * x, 0.1 * size, x, y, z}, sparse);
  add(Sphere{middle - 0.3 * size * x, 0.1 * size, x, y, z}, even);
  add(Disk{middle - 0.3 * size * y, z, 0.15 * size, x, y}, sparse);
  scene.shapes.back().camera_sees_emission = false;
  scene.shapes.back().emission_spread = 100;
  const auto placed = [&](const glm::dvec3& at, const glm::dvec3& along) {
    const glm::dvec3 n = glm::normalize(along), s = glm::normalize(glm::cross(glm::dvec3(0.3, 1, 0.2), n));
    return glm::dmat4(glm::dvec4(s, 0), glm::dvec4(glm::cross(n, s), 0), glm::dvec4(n, 0), glm::dvec4(at, 1));
  };
  const float power = float(size * size);
  SpotLight spot;
  spot.intensity = glm::vec3(0.6f, 0.4f, 0.2f) * power;
  spot.to_world = placed(middle + size * 0.4 * (x + y), -x - y - 0.5 * z);
  spot.cutoff_angle = 50;
  spot.beam_width = 10;
  scene.emitters.emplace_back(spot);
  spot.falloff = SpotFalloff::kSmoothstep;
  spot.texture = glm::vec3(1.0f);
  spot.texture.texture = even;
  spot.to_world = placed(middle + size * 0.4 * (y - x), x - y - 0.2 * z);
  scene.emitters.emplace_back(spot);
  DirectionalLight sun;
  sun.irradiance = glm::vec3(0.2f, 0.3f, 0.5f);
  sun.direction = glm::dvec3(0.2, -0.3, -1);
  scene.emitters.emplace_back(sun);
  sun.angle = 25;
  sun.direction = glm::dvec3(-0.4, 0.3, -1);
  scene.emitters.emplace_back(sun);
  sun.angle = 3;
  sun.seen_by_camera = false;
  sun.direction = glm::dvec3(0.6, -0.1, -0.5);
  scene.emitters.emplace_back(sun);
  spot.radius = 0.07 * size;
  spot.to_world = placed(middle + size * 0.4 * (z - x), x - z - 0.2 * y);
  scene.emitters.emplace_back(spot);
  ProjectorLight projector;
  projector.irradiance = glm::vec3(0.3f) * power;
  projector.irradiance.texture = sparse;
  projector.to_world = placed(middle + 0.4 * size * z, -z + 0.3 * x);
  scene.emitters.emplace_back(projector);
  projector.irradiance = glm::vec3(0.1f) * power;
  projector.to_world = placed(middle + 0.4 * size * z, -z - 0.3 * x);
  scene.emitters.emplace_back(projector);
}

}  // namespace penumbra
