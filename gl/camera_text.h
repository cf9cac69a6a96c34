// The camera of a view as text that a render takes.
#pragma once

#include <glm/vec3.hpp>
#include <string>

#include "kernels/scene_types.h"

namespace penumbra {

enum class CameraFormat { kSettings, kMitsuba, kTinyRender };

/// The names of CameraFormat in scripts.
constexpr const char* kCameraFormatNames[] = {"settings", "mitsuba", "tinyrender"};

/// Where a camera is, in the scene's coordinates.
struct CameraPlace {
  glm::dvec3 eye, at, up;  ///< `up` is the film's vertical axis
  bool is_mirrored;        ///< right on the film is left in the view: no lookat describes that
};

/// `center`: what the device scene's positions lack. `distance` > 0 of the target.
CameraPlace camera_place(const Camera& camera, const glm::dvec3& center, double distance);

/// kSettings: "camera.lookat=…" for --set, or camera.to_world for a mirrored film. kMitsuba: the sensor's
/// to_world and fov. kTinyRender: the table [camera]; it mirrors nothing.
std::string camera_text(const Camera& camera, const glm::dvec3& center, double distance, CameraFormat format);

}  // namespace penumbra
