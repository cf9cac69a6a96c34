// Measured subsurface scattering of named materials, with pbrt's names.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra::pbrt {

/// Coefficients in 1 / mm, linear Rec. 709. Scattering is the reduced coefficient.
struct Scattering {
  glm::vec3 scattered{0.0f}, absorbed{0.0f};
};

std::optional<Scattering> scattering_of(std::string_view name);
std::vector<std::string> scattering_names();

}  // namespace penumbra::pbrt
