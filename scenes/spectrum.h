// Spectra as linear Rec. 709 RGB, the way Mitsuba 3's RGB modes take them.
//
// A reflectance is what it looks like under D65, so that a constant spectrum c is exactly (c, c, c). An
// emission is the colour of the light itself: a constant spectrum is equal-energy white, which is not D65 but
// reddish, about (1.205, 0.948, 0.909) c.
#pragma once

#include <glm/glm.hpp>
#include <span>

namespace penumbra {

struct SpectrumSample {
  double wavelength;  ///< nm
  double value;
};

/// A tabulated reflectance, in [0, 1]. Wavelengths ascend strictly; linear between them, zero outside.
/// Colours outside the gamut are clamped to it.
glm::vec3 reflectance_to_rgb(std::span<const SpectrumSample> samples);

/// A tabulated number that has no upper limit, a refractive index for example: the same but for the clamp
/// at 1.
glm::vec3 index_to_rgb(std::span<const SpectrumSample> samples);

/// A tabulated emission, scaled so that a constant 1 has luminance 1; otherwise the same.
glm::vec3 emission_to_rgb(std::span<const SpectrumSample> samples);

/// The radiance of a black body (Planck's law) of that temperature in kelvins, W/(m² sr nm), as an emission.
glm::vec3 blackbody_to_rgb(double temperature);

/// An emission that is the same at all wavelengths.
glm::vec3 emission_to_rgb(double constant);

/// The sRGB transfer function's inverse, IEC 61966-2-1.
double srgb_to_linear(double encoded);

}  // namespace penumbra
