// Converts spectra to linear Rec. 709 RGB as Mitsuba 3's RGB modes do.
//
// A reflectance becomes its colour under D65, so a constant spectrum c is exactly (c, c, c). An emission
// becomes the colour of the light itself. A constant emission is equal-energy white, which is more reddish
// than D65: about (1.205, 0.948, 0.909) c.
#pragma once

#include <glm/glm.hpp>
#include <span>

namespace penumbra {

struct SpectrumSample {
  double wavelength;  ///< nm
  double value;
};

/// Converts a tabulated reflectance in [0, 1]. Wavelengths must ascend strictly. The spectrum is linear
/// between samples and zero outside. Colours outside the gamut are clamped.
glm::vec3 reflectance_to_rgb(std::span<const SpectrumSample> samples);

/// Converts a tabulated quantity without an upper limit, such as a refractive index. Like reflectance_to_rgb,
/// but values above 1 are not clamped.
glm::vec3 index_to_rgb(std::span<const SpectrumSample> samples);

/// The same, before the gamut is clamped: linear in the values.
glm::dvec3 unclamped_index_to_rgb(std::span<const SpectrumSample> samples);

/// Converts a tabulated emission. It is scaled so that a constant spectrum of 1 has luminance 1.
/// Interpolation and gamut clamping are those of reflectance_to_rgb.
glm::vec3 emission_to_rgb(std::span<const SpectrumSample> samples);

/// The emission of a black body (Planck's law) at `temperature` kelvins, in W/(m² sr nm).
glm::vec3 blackbody_to_rgb(double temperature);

/// The same spectrum, scaled to a maximum of 1 (Wien's displacement law), in units in which a constant
/// spectrum of 1 has the luminance luminance_of_unit_power().
glm::vec3 unit_blackbody_to_rgb(double temperature);

/// An emission that is constant over wavelength.
glm::vec3 emission_to_rgb(double constant);

/// The colour of unit power at one wavelength (nm): the matching functions in Rec. 709, whose channels may be
/// below 0. Its integral over the wavelength, divided by luminance_of_unit_power(), is emission_to_rgb(1).
glm::dvec3 matching_rgb(double wavelength);

/// The colour, under D65, of a reflectance at one wavelength (nm) alone, in the unit in which its integral
/// over the wavelength is white. Channels may be below 0.
glm::dvec3 reflectance_weight(double wavelength);

/// The integral of the luminous efficiency function over the wavelength, in nm.
double luminance_of_unit_power();

/// Decodes an sRGB value (the inverse of the transfer function of IEC 61966-2-1).
double srgb_to_linear(double encoded);

}  // namespace penumbra
