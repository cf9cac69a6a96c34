// Small scenes whose radiance has a closed form, built from a few parts.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "scenes/scene_description.h"

namespace penumbra {

/// A camera at `origin` that looks at `target`.
CameraSettings look_at(glm::dvec3 origin, glm::dvec3 target, glm::dvec3 up, double fov);

/// A grey diffuse reflector; returns its index.
int add_diffuse(SceneDescription& scene, float reflectance);

/// Triangles of `positions`, three by three, facing where they are seen counter-clockwise; grey radiance if
/// given.
Shape triangles(std::span<const glm::dvec3> positions, int bsdf,
                std::optional<float> radiance = std::nullopt);

/// The parallelogram from `corner` along `u` and `v`, facing along u x v.
Shape parallelogram(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, int bsdf,
                    std::optional<float> radiance = std::nullopt);

/// An empty scene: independent samples (so that t-tests hold), box filter, `width` x `height` pixels, near
/// clip 1e-4.
SceneDescription empty_scene(int width, int height, std::uint32_t spp, std::uint32_t seed);

/// Path tracing without a depth limit.
IntegratorSettings path_integrator(DirectSampling sampling);

/// Direct light with n_g emitter samples and n_f direction samples, also where lights are seen whole.
IntegratorSettings direct_integrator(int emitter_samples, int bsdf_samples,
                                     MisHeuristic heuristic = MisHeuristic::kBalance);

}  // namespace penumbra
