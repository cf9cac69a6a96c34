// Refractive indices of named materials, with Mitsuba's names.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <string_view>

#include "scenes/plugin_values.h"

namespace penumbra {

/// The complex index of a conductor, eta - i k, each as linear Rec. 709. The default is a perfect mirror.
struct ComplexIndex {
  glm::vec3 eta{0.0f}, k{1.0f};
};

constexpr int kMirror = -1;  ///< the conductor "none"

/// The names of the conductors and "none", with their numbers.
OneOf<int> conductor_names();
ComplexIndex conductor_index(int conductor);

/// The index of a dielectric: a number, or the name of a material.
struct RefractiveIndex {
  static constexpr float kLeast = 1e-3f, kMost = 1e3f;
  [[nodiscard]] bool contains(float value) const { return value >= kLeast && value <= kMost; }
  [[nodiscard]] std::string values() const;
  /// The index of the named material; letter case is ignored.
  [[nodiscard]] Expected<float> parse(std::string_view name) const;
};

/// Least Abbe number that is read; the least of glasses is about 17.
inline constexpr float kLeastAbbe = 1.0f;

/// The refractive indices of red, green and blue light in a material of index `index` at the Fraunhofer line
/// d and Abbe number V = (n_d - 1) / (n_F - n_C), by Cauchy's n = A + B / wavelength^2. A channel stands for
/// the dominant wavelength of its Rec. 709 primary. Not below 1e-3.
glm::dvec3 channel_indices(double index, double abbe);

inline constexpr double kLeastMicrofacetIndex = 1.001;
/// Relative indices, each moved from around 1 to at least 1.001 or at most its inverse. By an index of 1 two
/// directions do not determine the microfacet between them, and nearer to 1 they do not in single precision.
glm::dvec3 microfacet_indices(const glm::dvec3& indices);

}  // namespace penumbra
