// The range of the standard error's colours, for the picture and for its legend.
#pragma once

#include "gl/view_model.h"

namespace penumbra {

/// log10 of the numbers at the ends of the colour map.
struct ErrorScale {
  float log10_low, log10_high;
};

constexpr float kLog10Of2 = 0.30102999566f;

/// Relative: 0.001 to 1. Absolute: 0.0001 to 1 of the radiance that is white at this exposure.
inline ErrorScale error_scale(const DisplaySettings& settings) {
  if (settings.relative_error) return {-3, 0};
  const float white = -settings.exposure * kLog10Of2;
  return {white - 4, white};
}

}  // namespace penumbra
