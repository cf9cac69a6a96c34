// The small scenes of render cases: a floor, a light above it, a camera of one pixel.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "scenes/scene_description.h"
#include "scheduler/stress/case.h"

namespace penumbra::stress {

/// Where a scene is and how large: p becomes shift + scale p.
struct Placement {
  double scale = 1;
  glm::dvec3 shift{0};
  [[nodiscard]] glm::dvec3 operator()(const glm::dvec3& p) const { return shift + scale * p; }
};

/// An image of `width` x `height` pixels with box filter and independent samples, whose camera is at `origin`
/// and looks at `target`; fov in degrees.
SceneDescription empty_scene(int width, int height, std::uint32_t spp, glm::dvec3 origin, glm::dvec3 target,
                             double fov, const Placement& place = {});

/// A quad from `corner` along u and v that faces along u x v.
Shape quad_shape(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, int bsdf, std::optional<float> radiance,
                 const Placement& place = {});

int add_diffuse(SceneDescription& scene, float reflectance);
int add_phong(SceneDescription& scene, float specular, float exponent);

IntegratorSettings analytic();
/// One emitter sample of this kind, no other.
IntegratorSettings emitter_samples(EmitterSampling sampling);
/// One emitter and one BSDF sample, balance heuristic.
IntegratorSettings both_samples();
/// BSDF sampling alone, at most so many edges (-1: no limit), no roulette.
IntegratorSettings path(int max_depth);

/// Mean of the first pixel's red channel.
Numbers first_pixel(const FilmAccumulator& film);
/// Standard deviation of the first pixel's samples over their mean.
Numbers first_pixel_deviation(const FilmAccumulator& film);

}  // namespace penumbra::stress
