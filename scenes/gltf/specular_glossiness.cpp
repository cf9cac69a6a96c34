#include "scenes/gltf/specular_glossiness.h"

#include <algorithm>
#include <cmath>

namespace penumbra::gltf {
namespace {

constexpr double kDielectric = 0.04;  ///< reflectance at normal incidence for a refractive index of 1.5

double luminance(const glm::dvec3& colour) { return glm::dot(colour, glm::dvec3(0.2126, 0.7152, 0.0722)); }

/// The metalness of a material with these reflectances. With base colour b and metalness m they are b (1 - m)
/// (1 - d) and d (1 - m) + b m, where d is a dielectric's reflectance. Eliminating b gives a quadratic
/// equation for m.
double metalness(double diffuse, double specular) {
  if (specular <= kDielectric) return 0.0;
  const double linear = diffuse / (1.0 - kDielectric) + specular - 2.0 * kDielectric;
  const double root = std::sqrt(linear * linear + 4.0 * kDielectric * (specular - kDielectric));
  return std::clamp((root - linear) / (2.0 * kDielectric), 0.0, 1.0);
}

}  // namespace

MetalRoughness metal_roughness_of(const glm::dvec3& diffuse, const glm::dvec3& specular, double glossiness) {
  // In the extension, the diffuse part is reduced by the strongest specular channel.
  const double strongest = std::clamp(std::max({specular.x, specular.y, specular.z}), 0.0, 1.0);
  const glm::dvec3 scattered = diffuse * (1.0 - strongest);
  const double m = metalness(luminance(scattered), luminance(specular));
  const glm::dvec3 both = scattered + specular - kDielectric * (1.0 - m);
  return {glm::clamp(both / ((1.0 - kDielectric) * (1.0 - m) + m), glm::dvec3(0.0), glm::dvec3(1.0)), m,
          std::clamp(1.0 - glossiness, 0.0, 1.0)};
}

}  // namespace penumbra::gltf
