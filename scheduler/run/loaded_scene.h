// A scene loaded for a command: the description with the options applied, and the device scene.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "kernels/host/device_scene.h"
#include "kernels/host/error.h"
#include "scenes/device/device_scene_builder.h"
#include "scenes/matte_names.h"
#include "scenes/scene_description.h"
#include "scheduler/advise/advice.h"
#include "scheduler/render/frames.h"
#include "scheduler/run/render_options.h"
#include "worker/protocol/asset_manifest.h"

namespace penumbra {

/// A device scene of a shot. What is equal in other frames is neither built, nor hashed, nor sent again.
struct KeptFrame {
  DeviceScene scene;
  AssetManifest manifest;
};

struct LoadedScene {
  SceneDescription description;
  DeviceScene device;
  SceneSummary summary;
  MatteNames mattes;                          ///< only with --cryptomatte
  std::map<int, std::string> boundary_names;  ///< see boundary_names()
  std::uint32_t asked_spp = 0;    ///< samples per pixel before a preview changed them; 0: it did not
  bool sampler_replaced = false;  ///< the scene's independent sampler, by sobol
  std::string choice = {};        ///< what kAutoIntegrator has chosen, for the user; empty: it was not asked
  SettingValues chosen = {};      ///< the same as settings, which the description has
  double seconds = 0;             ///< load time
  std::shared_ptr<const KeptFrame> kept = {};  ///< of the same shot, or null
  glm::dvec3 center{0.0};                      ///< see scene_center; set by reduce
  /// Of the device scene, until they are among the description's.
  std::vector<std::string> device_warnings = {};
};

/// Frees the description's shapes except polygon_lights_of it. Meshes and images are also in the device
/// scene, and two copies of the largest scenes would not fit into memory.
void reduce(LoadedScene& scene);
/// Gives the scene such a description without taking this one's shapes.
void reduce(LoadedScene& scene, const SceneDescription& description);

/// Reads the scene file and applies the options. The reader applies `-D` and `--set`; the others are applied
/// here.
Expected<SceneDescription> read_scene_with_options(const SceneOptions& options);

/// Takes a scene that was read with the same options, but for the frame, to the frame of these.
Expected<void> go_to_frame(SceneDescription& scene, const SceneOptions& options);

/// A description with what was chosen for it.
struct ReadScene {
  SceneDescription description;
  bool sampler_replaced = false;  ///< these are as in LoadedScene
  std::string choice = {};
  SettingValues chosen = {};
};

/// Renders the pilots of `--integrator auto` for a scene with the options applied.
Expected<Advice> advise(ReadScene& scene, const SceneOptions& options);

/// The same as read_scene_with_options, and replaces an independent sampler that no option asks for. With
/// kAutoIntegrator the scene gets what advise() chooses.
Expected<ReadScene> read_scene_to_render(const SceneOptions& options);

/// What the scene's file says, which complete_scene gives the settings of these options, or of others that
/// differ in settings alone (scene_file.h).
Expected<ReadScene> read_scene_file(const SceneOptions& options);
Expected<void> complete_scene(ReadScene& scene, const SceneOptions& options);

/// Builds the device scene. The result has no description. `kept`: a frame of the same shot, or null.
Expected<LoadedScene> build_scene(const ReadScene& scene, const SceneOptions& options,
                                  std::shared_ptr<const KeptFrame> kept = {});

/// Reads the scene and builds its device scene. `adjust`, which may be empty, changes the description before.
Expected<LoadedScene> load_scene(const SceneOptions& options,
                                 const std::function<void(SceneDescription&)>& adjust = {});
/// The same, reduced.
Expected<LoadedScene> load_reduced_scene(const SceneOptions& options,
                                         const std::function<void(SceneDescription&)>& adjust = {});

}  // namespace penumbra
