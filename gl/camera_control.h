// How the camera is moved, without a window. Everything is in the coordinates of the device scene: a scene's
// own, less its centre (`center`, which the builder subtracts and the header does not keep).
#pragma once

#include <glm/vec3.hpp>

#include "kernels/host/device_scene.h"

namespace penumbra {

/// Where the camera is and what it turns about. `up` is an axis of the world, not of the film: it stays as it
/// is while the camera turns, so that the horizon stays level.
struct CameraPose {
  glm::dvec3 eye{0, 0, 0}, at{0, 0, -1};
  glm::dvec3 up{0, 1, 0};  ///< unit
};

/// Right-handed, orthonormal: right = forward x up.
struct ViewFrame {
  glm::dvec3 right, up, forward;
};

/// The axes of a view. Where the view is along `up`, or there is none, axes are made up that are orthonormal
/// all the same.
ViewFrame view_frame(const CameraPose& pose);

/// Turns the eye about the target by `yaw` to the right, about `up`, and by `pitch` upwards, in radians. The
/// eye stays 0.1 degrees away from the poles; the distance is kept.
CameraPose orbit(const CameraPose& pose, double yaw, double pitch);

/// Moves eye and target by distances in the scene's units: to the right, along `up`, along the view.
CameraPose move(const CameraPose& pose, double right, double up, double forward);

/// Multiplies the distance between eye and target by `factor` > 0 (others change nothing): below 1 the eye
/// comes closer, but never to the target or past it, nor beyond what single precision can hold.
CameraPose dolly(const CameraPose& pose, double factor);

/// The pose of the header's camera with its target `distance` > 0 away. `up` is the axis of the scene's
/// coordinates that the camera has upright, to within half a degree; with none, the film's vertical axis.
CameraPose pose_of(const SceneHeader& header, double distance);

/// Moves the header's camera to a pose by turning its film as it is: field of view, aspect and, where
/// there is one, mirroring stay. Start from the same header each time; in a chain roundings add up.
void set_camera(const CameraPose& pose, SceneHeader& header);

/// Whether the film shows the scene as a mirror does: right of the picture is the frame's left. To
/// move or turn to the right of the picture, the camera then moves or turns to the left.
bool film_is_mirrored(const SceneHeader& header);

/// The diagonal of the box around all surfaces; 1 where that is no positive number.
double scene_extent(const DeviceScene& scene);

/// From the eye to the first surface along the viewing direction, beyond the near clipping plane; the scene's
/// extent where there is none. Never less than a millionth of the extent.
double default_distance(const DeviceScene& scene);

/// How far one press of a key moves: a twentieth of the distance to the target, within 1e-4 and 0.1 of the
/// scene's extent.
double step_length(const CameraPose& pose, double extent);

}  // namespace penumbra
