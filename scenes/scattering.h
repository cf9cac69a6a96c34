// Measured subsurface scattering of named materials, with pbrt's names.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra {

/// Coefficients in 1 / mm, linear Rec. 709. Scattering is the reduced coefficient.
struct Scattering {
  glm::vec3 scattered{0.0f}, absorbed{0.0f};
};

std::optional<Scattering> scattering_of(std::string_view name);
std::vector<std::string> scattering_names();

/// Those that Jensen et al. measured in 2001, which Mitsuba 0.6 knows by the same names in any case and
/// scatters evenly.
std::optional<Scattering> jensen_scattering_of(std::string_view name);
std::vector<std::string> jensen_scattering_names();

}  // namespace penumbra
