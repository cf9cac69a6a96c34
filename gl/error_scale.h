// The range of the standard error's colour map, for the picture and its legend.
#pragma once

#include "gl/view_model.h"

namespace penumbra {

/// log10 of the values at the ends of the colour map.
struct ErrorScale {
  float log10_low, log10_high;
};

constexpr float kLog10Of2 = 0.30102999566f;

/// Relative errors: 0.001 to 1. Absolute errors: 0.0001 to 1 of the radiance that is white at this exposure.
inline ErrorScale error_scale(const DisplaySettings& settings) {
  if (settings.relative_error) return {-3, 0};
  const float white = -settings.exposure * kLog10Of2;
  return {white - 4, white};
}

}  // namespace penumbra
