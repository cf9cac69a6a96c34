// Cameras and lights of glTF.
#pragma once

#include "scenes/gltf/asset.h"
#include "scenes/reader_report.h"
#include "scenes/scene_description.h"

namespace penumbra::gltf {

/// Lumens a watt that Blender's exporter counts ("Standard"), at every wavelength alike: candela over it are
/// W/sr, lux W/m².
constexpr double kLumensPerWatt = 683.0;

/// Sets the scene's view and the shape of its film from a camera of that frame, which looks along its -z.
void read_camera(const Asset& asset, int camera, const glm::dmat4& to_world, ReaderReport& report,
                 SceneDescription& scene);

/// Looks at the whole scene from in front, where a file has no camera.
void look_at_everything(SceneDescription& scene);

/// Adds a light of KHR_lights_punctual, which shines along its -z.
void read_light(const Asset& asset, int light, const glm::dmat4& to_world, ReaderReport& report,
                SceneDescription& scene);

}  // namespace penumbra::gltf
