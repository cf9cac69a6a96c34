// Prints one pixel of a film with full precision.
#pragma once

#include <string>

#include "scheduler/plan/film_accumulator.h"

namespace penumbra {

/// Radiance, its standard error, the sample count and, if the film has them, the feature layers of the pixel
/// at film coordinates. Numbers have 9 significant digits; the radiance is also given in C's hexadecimal
/// notation, exactly as in the EXR. Several lines.
std::string pixel_text(const FilmAccumulator& film, int x, int y);

}  // namespace penumbra
