// One pixel of a film in all its digits.
#pragma once

#include <string>

#include "scheduler/plan/film_accumulator.h"

namespace penumbra {

/// Radiance, its standard error, sample count and, where the film has them, the feature layers of the pixel
/// at film coordinates: 9 significant digits, and the exact bits of the radiance as the EXR holds them, in
/// C's hexadecimal notation. Several lines.
std::string pixel_text(const FilmAccumulator& film, int x, int y);

}  // namespace penumbra
