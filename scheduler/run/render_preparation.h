// Prepares a render: everything is checked before rendering begins.
#pragma once

#include <functional>
#include <memory>

#include "scheduler/checkpoint/checkpoint_file.h"
#include "scheduler/farm/render_farm.h"
#include "scheduler/record/render_record.h"
#include "scheduler/run/loaded_scene.h"
#include "scheduler/run/output_files.h"
#include "scheduler/run/render_options.h"
#include "worker/cli/exit_code.h"

namespace penumbra {

struct PreparedRender {
  OutputFiles files;
  bool is_denoised_later = false;  ///< the denoised files are written by others, of several images
  /// The device scene is moved to the job; of the shapes only polygon_lights_of the scene are kept.
  LoadedScene scene;
  RenderRecord record;
  RenderJob job;
  FarmOptions farm;  ///< complete except for the worker's executable
  /// The job's checkpoint file; null: none; see attach_checkpoint.
  std::shared_ptr<CheckpointFile> checkpoint;
};

/// Gives the result of load_reduced_scene.
using SceneLoader = std::function<Expected<LoadedScene>(const SceneOptions&)>;

/// Chooses the files, reads the scene, applies the options. All errors are errors of the input: an output
/// that cannot be written or would overwrite an input, an invalid scene, more pixels than fit into memory, a
/// crop outside the film, options that exclude each other or that this machine does not support. `load`:
/// provides the scene if the render is one of several.
Expected<PreparedRender> prepare_render(const RenderOptions& options, const SceneLoader& load = {});

/// The job for a record. `manifest` is the scene's.
RenderJob job_of_record(const RenderRecord& record, const DeviceOptions& device, DeviceScene scene,
                        AssetManifest manifest);

/// The same for commands at a terminal, possibly with viewers: also finds the worker's executable, checks
/// that the requested device exists, and prints the scene's warnings. On failure the error is printed.
std::expected<PreparedRender, ExitCode> prepare_watched_render(const RenderOptions& options);

/// Tells viewers that `--integrator auto` chose the job's integrator, if it did.
void show_choice(PreparedRender& prepared);

/// The device that a request asks for, the widest instruction set of this machine unless it names one.
DeviceOptions device_of(const RenderRequest& request);

/// Checks that this machine has the instruction set, and that the backend has a use for the options.
Expected<void> check_device_options(const RenderRequest& request);

/// The farm's options for the render, except keys and the worker's executable.
FarmOptions farm_of(const RenderOptions& options);

/// Sets how the workers are launched.
void set_launch(const RenderOptions& options, FarmOptions& farm);

/// Checks that the requested OpenCL device exists. The error lists the existing ones. Without this check each
/// worker would report the error later, one after the other.
Expected<void> check_device(const DeviceOptions& device);

}  // namespace penumbra
