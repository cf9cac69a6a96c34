// Interference in a thin film over a dielectric or a metal: Airy's formulas (Born and Wolf 1999,
// section 7.6), and the colours of what it reflects.
#pragma once

#include <compare>
#include <glm/glm.hpp>

namespace penumbra {

/// A plane film that absorbs nothing. Indices but `optical` are relative to that of the light's side.
struct ThinFilm {
  double index = 1;       ///< of the film
  double optical = 1;     ///< of the film in a vacuum
  double base = 1.5;      ///< of the other side
  double nanometres = 0;  ///< thickness, at least 0
  double absorbed = 0;    ///< imaginary part of the index of the other side, at least 0

  friend auto operator<=>(const ThinFilm&, const ThinFilm&) = default;
};

/// The reflectance of the film for unpolarised light of this wavelength in a vacuum (nm) that arrives at
/// `cosine` in (0, 1]. In [0, 1]; 1 for total reflection at the other side.
double film_reflectance(const ThinFilm& film, double cosine, double wavelength);

/// The colour of that reflectance under D65 in linear Rec. 709, as any reflectance's here: white has 1 in
/// each channel. Colours outside of the gamut are clamped to [0, 1]. Where the way through the film and back
/// is longer than 12 micrometres, that is the mean of all phases.
glm::dvec3 film_colour(const ThinFilm& film, double cosine);

/// What the film adds to the colour of a metal that reflects `reflectance` in [0, 1] along the normal, at
/// `cosine`. The film's `base` and `absorbed` are not used: the metal is that which has this reflectance
/// along the normal, and Schlick's at the cosine 1 / 7, as F82 does without a tint.
glm::dvec3 film_on_metal(ThinFilm film, double reflectance, double cosine);

}  // namespace penumbra
