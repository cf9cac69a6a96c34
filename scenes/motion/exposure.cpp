#include "scenes/motion/exposure.h"

#include <algorithm>

#include "scenes/motion/scene_motion.h"

namespace penumbra {

Exposure exposure_of(const SceneDescription& scene) {
  const CameraSettings& camera = scene.camera;
  const double frame = scene.frame_duration;
  const double of_file = scene.motion != nullptr ? scene.motion->shutter : 0.0;
  const double row = camera.shutter ? double(*camera.shutter) * frame : of_file;
  const double roll = camera.rolling_shutter * frame;
  const double whole = row + roll;
  constexpr double kShares[] = {0.0, 0.5, 1.0};  // of each ShutterPosition
  const double share = kShares[int(camera.shutter_position)];
  Exposure exposure{.open = scene.time - share * whole, .close = scene.time + (1.0 - share) * whole};
  if (whole > 0.0) {
    exposure.exposure = row / whole;
    exposure.rolling = roll / whole;
  }
  const double most = std::ranges::max(camera.shutter_curve);
  exposure.curve.clear();
  for (const double value : camera.shutter_curve) exposure.curve.push_back(value / most);
  exposure.before = exposure.middle() - frame;
  exposure.after = exposure.middle() + frame;
  return exposure;
}

}  // namespace penumbra
