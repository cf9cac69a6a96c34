// Colours of pbrt: RGB, tabulated and named spectra, black bodies.
#pragma once

#include <optional>
#include <string_view>

#include "scenes/pbrt/parameters.h"
#include "scenes/refractive_indices.h"

namespace penumbra::pbrt {

/// The quantity that a colour describes.
enum class ColourOf { kReflectance, kIndex, kLight };

/// The colour of a parameter of type rgb, spectrum or blackbody. Nothing, and an error, if it is not a
/// colour. The spectrum of a light is scaled to luminance 1, as in pbrt, and so is a black body; RGB values
/// are unchanged.
std::optional<glm::vec3> colour_of(const Parameter& parameter, ColourOf use, const FileAccess& files,
                                   const std::filesystem::path& folder, ReaderReport& report);

/// The luminance of a linear Rec. 709 colour.
double luminance(const glm::dvec3& colour);

/// The matrix, for linear Rec. 709, of a film whose white balance is that temperature, in kelvins: what a
/// daylight of it (CIE 15:2004; below 4000 K, a black body) lights becomes what D65 lights, by the Bradford
/// transform of Lam (1985).
glm::dmat3 white_balance(double kelvin);

/// The complex index of a metal, by its number among conductor_names: like a reflectance, one that is the
/// same at all wavelengths is grey, while Mitsuba's has the colour of a constant emission.
ComplexIndex metal_index(int metal);

/// Whether pbrt has a colour space of this name.
bool is_colour_space(std::string_view name);

struct Glass {
  double index;  ///< at the Fraunhofer line d
  double abbe;   ///< Abbe number
};
/// A named glass, "glass-BK7" for example.
std::optional<Glass> glass_named(std::string_view name);

}  // namespace penumbra::pbrt
