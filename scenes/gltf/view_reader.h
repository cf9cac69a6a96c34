// Reads the cameras and lights of glTF.
#pragma once

#include "scenes/gltf/asset.h"
#include "scenes/reader_report.h"
#include "scenes/scene_description.h"

namespace penumbra::gltf {

/// Lumens per watt in Blender's exporter ("Standard"), the same at all wavelengths: candela divided by it are
/// W/sr, and lux W/m².
constexpr double kLumensPerWatt = 683.0;

/// Sets the scene's camera and the film's aspect ratio from a glTF camera, which looks along its -z axis.
void read_camera(const Asset& asset, int camera, const glm::dmat4& to_world, ReaderReport& report,
                 SceneDescription& scene);

/// Sets a camera that sees the whole scene from the front, for files without a camera.
void look_at_everything(SceneDescription& scene);

/// Adds a light of KHR_lights_punctual, which shines along its -z axis.
void read_light(const Asset& asset, int light, const glm::dmat4& to_world, ReaderReport& report,
                SceneDescription& scene);

}  // namespace penumbra::gltf
