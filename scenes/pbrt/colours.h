// Colours of pbrt: rgb, tabulated and named spectra, black bodies.
#pragma once

#include <optional>
#include <string_view>

#include "scenes/pbrt/parameters.h"

namespace penumbra::pbrt {

/// What a colour is of.
enum class ColourOf { kReflectance, kIndex, kLight };

/// Of a parameter of the type rgb, spectrum or blackbody; none, and an error, where it is no colour. A
/// light's spectrum has luminance 1, as pbrt makes it, and so has a black body's; an rgb is what it is.
std::optional<glm::vec3> colour_of(const Parameter& parameter, ColourOf use, const FileAccess& files,
                                   const std::filesystem::path& folder, ReaderReport& report);

/// Of linear Rec. 709.
double luminance(const glm::dvec3& colour);

/// Whether pbrt knows it by this name.
bool is_colour_space(std::string_view name);

/// The refractive index of a named glass, "glass-BK7", at 589 nm.
std::optional<double> glass_index(std::string_view name);

}  // namespace penumbra::pbrt
