// Materials whose scattering was measured, by the names that pbrt has for them.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra::pbrt {

/// Linear Rec. 709, 1 / mm; scattering is the reduced one.
struct Scattering {
  glm::vec3 scattered{0.0f}, absorbed{0.0f};
};

std::optional<Scattering> scattering_of(std::string_view name);
std::vector<std::string> scattering_names();

}  // namespace penumbra::pbrt
