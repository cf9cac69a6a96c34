// Small scenes for render cases: a floor, a light above it, a camera of one pixel.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>

#include "scenes/scene_description.h"
#include "scheduler/stress/case.h"

namespace penumbra::stress {

/// Position and scale of a scene: p becomes shift + scale p.
struct Placement {
  double scale = 1;
  glm::dvec3 shift{0};
  [[nodiscard]] glm::dvec3 operator()(const glm::dvec3& p) const { return shift + scale * p; }
};

/// A scene without shapes. The image has `width` x `height` pixels, a box filter and independent samples. The
/// camera is at `origin` and looks at `target`; fov is in degrees.
SceneDescription empty_scene(int width, int height, std::uint32_t spp, glm::dvec3 origin, glm::dvec3 target,
                             double fov, const Placement& place = {});

/// A parallelogram from `corner` along u and v that faces along u x v.
Shape quad_shape(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, int bsdf, std::optional<float> radiance,
                 const Placement& place = {});

int add_diffuse(SceneDescription& scene, float reflectance);
int add_phong(SceneDescription& scene, float specular, float exponent);

IntegratorSettings analytic();
/// Only one emitter sample, with this kind of sampling.
IntegratorSettings emitter_samples(EmitterSampling sampling);
/// One emitter and one BSDF sample with the balance heuristic.
IntegratorSettings both_samples();
/// Only BSDF sampling, at most `max_depth` edges (-1: no limit), no Russian roulette.
IntegratorSettings path(int max_depth);

/// The mean of the first pixel's red channel.
Numbers first_pixel(const FilmAccumulator& film);
/// The number of standard errors by which the first pixel is off.
std::function<Numbers(const FilmAccumulator&)> errors_from(double truth);
/// The relative standard deviation of the first pixel's samples.
Numbers first_pixel_deviation(const FilmAccumulator& film);

}  // namespace penumbra::stress
