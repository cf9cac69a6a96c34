// Moves the camera; independent of a window. All coordinates are those of the device scene: the scene's own
// minus its centre (`center`), which the builder subtracts and the header does not store.
#pragma once

#include <glm/vec3.hpp>

#include "kernels/host/device_scene.h"

namespace penumbra {

/// The camera's position and the target that it turns about. `up` is an axis of the world, not of the film:
/// it does not change while the camera turns, so that the horizon stays level.
struct CameraPose {
  glm::dvec3 eye{0, 0, 0}, at{0, 0, -1};
  glm::dvec3 up{0, 1, 0};  ///< unit
};

/// Right-handed, orthonormal: right = forward x up.
struct ViewFrame {
  glm::dvec3 right, up, forward;
};

/// The axes of a view. If the view is along `up` or has no direction, arbitrary orthonormal axes are chosen.
ViewFrame view_frame(const CameraPose& pose);

/// Rotates the eye about the target, by `yaw` to the right about `up`, and by `pitch` upwards, in radians.
/// The eye stays 0.1 degrees away from the poles; its distance does not change.
CameraPose orbit(const CameraPose& pose, double yaw, double pitch);

/// Moves eye and target in scene units: to the right, along `up`, and along the view.
CameraPose move(const CameraPose& pose, double right, double up, double forward);

/// Multiplies the distance between eye and target by `factor` > 0 (other factors do nothing). Below 1 the eye
/// comes closer, but never reaches the target, nor a distance that single precision cannot represent.
CameraPose dolly(const CameraPose& pose, double factor);

/// The pose of the header's camera, with its target at `distance` > 0. `up` is the coordinate axis that is
/// upright in the image, to within half a degree; if there is none, the film's vertical axis.
CameraPose pose_of(const SceneHeader& header, double distance);

/// Moves the header's camera to a pose by rotating its film: field of view, aspect and mirroring do not
/// change. Always start from the same header; in a chain of moves rounding errors add up.
void set_camera(const CameraPose& pose, SceneHeader& header);

/// Whether the film is mirrored: right in the image is left in the view frame. To move or turn to the image's
/// right, the camera then moves or turns to the left.
bool film_is_mirrored(const SceneHeader& header);

/// The diagonal of the bounding box of all surfaces; 1 if that is not a positive number.
double scene_extent(const DeviceScene& scene);

/// Distance from the eye to the first surface along the view, beyond the near clipping plane; the scene's
/// extent if there is none. At least a millionth of the extent.
double default_distance(const DeviceScene& scene);

/// The distance of one key press: a twentieth of the distance to the target, clamped to 1e-4 and 0.1 of the
/// scene's extent.
double step_length(const CameraPose& pose, double extent);

}  // namespace penumbra
