// When the shutter is open.
#pragma once

#include <vector>

#include "scenes/scene_description.h"

namespace penumbra {

/// Times are in seconds of the scene's motion. Each row of the film is exposed for `exposure` of the whole
/// time from `open` to `close`; the last row starts `rolling` of it later than the first one. Their sum is 1.
/// An `exposure` of 0 is a rolling shutter whose rows are of one instant each.
struct Exposure {
  double open = 0.0, close = 0.0;  ///< equal: an image of one instant
  double exposure = 1.0, rolling = 0.0;
  /// How far the shutter is open, at evenly spaced times of a row's exposure; linear between them. At least
  /// two values, not negative, not all 0.
  std::vector<double> curve{1.0, 1.0};
  double before = 0.0, after = 0.0;  ///< the middles of the exposures of the frame before and of the next one

  [[nodiscard]] double middle() const { return 0.5 * (open + close); }
};

/// The exposure of the frame that the scene shows, by its camera's shutter settings and, without them, its
/// file's shutter (SceneMotion). Of the whole time, with that of rolling, the frame's time is the start, the
/// middle or the end. The largest value of the curve is 1.
Exposure exposure_of(const SceneDescription& scene);

}  // namespace penumbra
