// Decides which method of sampling points on a planar light is worth its cost in a scene.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "scenes/device/polygon_outline.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// A point on the scene's surfaces that receives light on both sides.
struct Receiver {
  glm::dvec3 p{0.0}, n{0.0};  ///< position and unit normal
};

/// At most kReceivers points, spread evenly over the area of all shapes, relative to `origin`. The same scene
/// always gives the same points. Empty if no shape has an area.
std::vector<Receiver> light_receivers(const SceneDescription& scene, const glm::dvec3& origin);
constexpr int kReceivers = 64;

/// The relative variance of one sample of a light's unshadowed irradiance, with area and with solid-angle
/// sampling. It is the mean over all receivers, weighted by their irradiance; the variance of each is clamped
/// to kMostVariance.
struct SamplingVariance {
  double area = 0, solid_angle = 0;
};
constexpr double kMostVariance = 4;

/// The variance for a light of these outlines, which are in the receivers' coordinates. The moments are
/// computed by quadrature. A rectangle or triangle of the light is chosen in proportion to its area. Both
/// variances are 0 if no receiver gets light.
SamplingVariance sampling_variance(std::span<const LightTriangle> triangles, const Outlines& outlines,
                                   bool two_sided, std::span<const Receiver> receivers);

/// Whether solid-angle sampling reaches a given error in less time, for an integrator that samples emitters.
/// Time is the number of samples times the cost of one. The number of samples is proportional to the variance
/// of a pixel, to which the light contributes only a part. So solid-angle sampling pays if
///      (other + solid angle) (1 + cost) < other + area.
/// `other` is the variance of a sample due to shadows, materials and further bounces. It is set to 0.2: the
/// sample scenes have a relMSE of 0.17 to 0.2 with one sample. `cost` was measured: 2 % for direct
/// illumination, but 17 % for a path, where it needs kernels with more features. Projected solid angle is
/// never chosen: no measured scene gains from it (its time to equal error is 1.2 to 2.3 times that of area
/// sampling; for solid angle it is 0.6 to 1.1).
bool solid_angle_pays(const SamplingVariance& variance, const IntegratorSettings& integrator);

}  // namespace penumbra
