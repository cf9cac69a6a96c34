// Curves in Mitsuba 3's text files. Each control point is a line "x y z radius"; an empty line separates two
// curves. Not in Mitsuba: a line of two numbers before a curve's points says where the parameter along the
// curve begins and ends.
#pragma once

#include <string>

#include "scenes/curves.h"
#include "scenes/diagnostic.h"

namespace penumbra {

/// Reads curves of the form, balls of at least 2 points each and others of 4. All numbers are finite. Radii
/// are not negative, but those of ribbons' splines may be: where they taper to nothing, the last control
/// point is beyond. Errors, with the line: anything else in the file; a file without curves.
Expected<Curves> read_curves(const SourceFile& file, CurveForm form);

/// The text of a file that read_curves reads as the same curves.
std::string text_of(const Curves& curves);

}  // namespace penumbra
