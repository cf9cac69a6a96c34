#include "tests/acceptance/scene_pieces.h"

#include <array>
#include <cmath>

#include "tests/support/integrator_parameters.h"

namespace penumbra {

CameraSettings look_at(glm::dvec3 origin, glm::dvec3 target, glm::dvec3 up, double fov) {
  const glm::dvec3 forward = glm::normalize(target - origin);
  const glm::dvec3 left = glm::normalize(glm::cross(up, forward));
  const glm::dvec3 above = glm::cross(forward, left);
  CameraSettings camera;
  camera.to_world =
      glm::dmat4(glm::dvec4(left, 0), glm::dvec4(above, 0), glm::dvec4(forward, 0), glm::dvec4(origin, 1));
  camera.fov = fov;
  camera.near_clip = 1e-4;
  return camera;
}

int add_diffuse(SceneDescription& scene, float reflectance) {
  scene.bsdfs.push_back({"grey", DiffuseBsdf{glm::vec3(reflectance)}});
  return int(scene.bsdfs.size()) - 1;
}

Shape triangles(std::span<const glm::dvec3> positions, int bsdf, std::optional<float> radiance) {
  Mesh mesh;
  mesh.positions.assign(positions.begin(), positions.end());
  for (unsigned i = 0; i + 2 < positions.size(); i += 3) mesh.triangles.emplace_back(i, i + 1, i + 2);
  Shape shape;
  shape.name = "triangles";
  shape.geometry = std::move(mesh);
  shape.front_bsdf = bsdf;
  if (radiance) shape.radiance = glm::vec3(*radiance);
  return shape;
}

Shape parallelogram(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, int bsdf, std::optional<float> radiance) {
  return triangles(std::array{corner, corner + u, corner + u + v, corner, corner + u + v, corner + v}, bsdf,
                   radiance);
}

SceneDescription empty_scene(int width, int height, std::uint32_t spp, std::uint32_t seed) {
  SceneDescription scene;
  scene.source = "a test";
  scene.film.width = scene.film.crop_width = width;
  scene.film.height = scene.film.crop_height = height;
  scene.film.filter = FilterKind::kBox;
  scene.film.filter_radius = 0.5f;
  scene.sampler = {.kind = SamplerKind::kIndependent, .spp = spp, .seed = seed};
  scene.camera = look_at(glm::dvec3(0), glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 0), 10);
  return scene;
}

IntegratorSettings path_integrator(DirectSampling sampling) {
  IntegratorSettings settings;
  param::direct_sampling(settings) = sampling;
  return settings;
}

IntegratorSettings direct_integrator(int emitter_samples, int bsdf_samples, MisHeuristic heuristic) {
  IntegratorSettings settings;
  use(settings, IntegratorKind::kDirect);
  param::emitter_samples(settings) = emitter_samples;
  param::bsdf_samples(settings) = bsdf_samples;
  param::heuristic(settings) = heuristic;
  return settings;
}

}  // namespace penumbra
