#include "scheduler/stress/cases/scene_pieces.h"

#include <cmath>
#include <functional>

namespace penumbra::stress {

SceneDescription empty_scene(int width, int height, std::uint32_t spp, glm::dvec3 origin, glm::dvec3 target,
                             double fov, const Placement& place) {
  SceneDescription scene;
  scene.source = "a case";
  scene.film.width = scene.film.crop_width = width;
  scene.film.height = scene.film.crop_height = height;
  scene.film.filter = FilterKind::kBox;
  scene.film.filter_radius = 0.5f;
  scene.sampler = {.kind = SamplerKind::kIndependent, .spp = spp, .seed = 1};
  const glm::dvec3 forward = glm::normalize(target - origin);
  const glm::dvec3 up = std::abs(forward.y) < .9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
  const glm::dvec3 left = glm::normalize(glm::cross(up, forward));
  scene.camera.to_world = glm::dmat4(glm::dvec4(left, 0), glm::dvec4(glm::cross(forward, left), 0),
                                     glm::dvec4(forward, 0), glm::dvec4(place(origin), 1));
  scene.camera.fov = fov;
  scene.camera.near_clip = 1e-5 * place.scale;
  scene.camera.far_clip = 1e5 * place.scale;
  return scene;
}

Shape quad_shape(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, int bsdf, std::optional<float> radiance,
                 const Placement& place) {
  Mesh mesh;
  mesh.positions = {place(corner), place(corner + u), place(corner + u + v), place(corner + v)};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  Shape shape;
  shape.name = "quad";
  shape.geometry = std::move(mesh);
  shape.front_bsdf = bsdf;
  if (radiance) shape.radiance = glm::vec3(*radiance);
  return shape;
}

int add_diffuse(SceneDescription& scene, float reflectance) {
  scene.bsdfs.push_back({"grey", DiffuseBsdf{glm::vec3(reflectance)}});
  return int(scene.bsdfs.size()) - 1;
}

int add_phong(SceneDescription& scene, float specular, float exponent) {
  scene.bsdfs.push_back({"glossy", PhongBsdf{glm::vec3(0), glm::vec3(specular), exponent}});
  return int(scene.bsdfs.size()) - 1;
}

IntegratorSettings analytic() { return {.method = PolygonAnalyticIntegrator{}}; }

IntegratorSettings emitter_samples(EmitterSampling sampling) {
  DirectIntegrator direct{.bsdf_samples = 0, .emitter_sampling = sampling};
  // Parts of a light by what they contribute: then samples by projected solid angle are all the same.
  if (sampling == EmitterSampling::kProjected) direct.light_choice = LightChoice::kAnalytic;
  return {.method = direct};
}

IntegratorSettings both_samples() {
  return {.method = DirectIntegrator{.emitter_sampling = EmitterSampling::kArea}};
}

IntegratorSettings path(int max_depth) {
  return {.method = PathIntegrator{
              .max_depth = max_depth, .rr_depth = 100000, .direct_sampling = DirectSampling::kBsdfOnly}};
}

Numbers first_pixel(const FilmAccumulator& film) { return {film.at(0, 0).mean[0]}; }

Numbers first_pixel_deviation(const FilmAccumulator& film) {
  const PixelStatistics& pixel = film.at(0, 0);
  return {std::sqrt(pixel.m2[0] / double(pixel.count - 1)) / pixel.mean[0]};
}

std::function<Numbers(const FilmAccumulator&)> errors_from(double truth) {
  return [truth](const FilmAccumulator& film) {
    const PixelStatistics& pixel = film.at(0, 0);
    const double count = double(pixel.count);
    return Numbers{(pixel.mean[0] - truth) / std::sqrt(pixel.m2[0] / (count * (count - 1)))};
  };
}

}  // namespace penumbra::stress
