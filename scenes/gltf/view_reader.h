// Reads the cameras and lights of glTF.
#pragma once

#include <numbers>

#include "scenes/gltf/asset.h"
#include "scenes/reader_report.h"
#include "scenes/scene_description.h"

namespace penumbra::gltf {

/// Lumens per watt in Blender's exporter ("Standard"), the same at all wavelengths: candela divided by it are
/// W/sr, and lux W/m².
constexpr double kLumensPerWatt = 683.0;
constexpr double kDegrees = 180.0 / std::numbers::pi;  ///< per radian

/// From this renderer's camera space to glTF's: +x points to the left of the image and +z is the view
/// direction, where glTF's cameras have +x to the right and look along -z.
glm::dmat4 camera_space();

/// Sets the scene's camera and the film's aspect ratio from a glTF camera.
void read_camera(const Asset& asset, int camera, const glm::dmat4& to_world, ReaderReport& report,
                 SceneDescription& scene);

/// Sets a camera that sees the whole scene from the front, for files without a camera; if it moves, at
/// several times of its animation. It is then shown at another time.
void look_at_everything(SceneDescription& scene);

/// The colour of a light of KHR_lights_punctual.
glm::dvec3 colour_of(const tinygltf::Light& light);

/// Adds a light of KHR_lights_punctual, which shines along its -z axis.
void read_light(const Asset& asset, int light, const glm::dmat4& to_world, ReaderReport& report,
                SceneDescription& scene);

}  // namespace penumbra::gltf
