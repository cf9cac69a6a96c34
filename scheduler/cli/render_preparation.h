// Everything that a render needs, checked before any of it is rendered.
#pragma once

#include <memory>

#include "scheduler/checkpoint/checkpoint_file.h"
#include "scheduler/cli/exit_code.h"
#include "scheduler/cli/loaded_scene.h"
#include "scheduler/cli/output_files.h"
#include "scheduler/cli/render_options.h"
#include "scheduler/cli/sets/shared_scenes.h"
#include "scheduler/farm/render_farm.h"
#include "scheduler/record/render_record.h"

namespace penumbra {

struct PreparedRender {
  OutputFiles files;
  LoadedScene scene;  ///< its device form is in the job; of its shapes there are only polygon_lights_of it
  RenderRecord record;
  RenderJob job;
  FarmOptions farm;                            ///< all but the worker's executable
  std::shared_ptr<CheckpointFile> checkpoint;  ///< the job's; null: none, see attach_checkpoint
};

/// Chooses the files, reads the scene, applies the options. Errors, all of them of the input: an output that
/// cannot be written or would overwrite an input, a bad scene, more pixels than memory, a crop outside the
/// film, options that exclude each other or that this machine has not.
/// `shared`, where the render is one of a set: reads the scene, or has it.
Expected<PreparedRender> prepare_render(const RenderOptions& options, SharedScenes* shared = nullptr);

/// What a record says of its job. `manifest`: of the scene.
RenderJob job_of_record(const RenderRecord& record, const DeviceOptions& device, DeviceScene scene,
                        AssetManifest manifest);

/// The same for commands at a terminal, perhaps with viewers: finds the worker's executable, checks that the
/// requested device exists, and prints the scene's warnings. On failure the error is printed.
std::expected<PreparedRender, ExitCode> prepare_watched_render(const RenderOptions& options);

/// A farm for it, but for keys and the worker's executable.
FarmOptions farm_of(const RenderOptions& options);

/// Who starts the workers.
void set_launch(const RenderOptions& options, FarmOptions& farm);

/// Whether the requested OpenCL device exists; the error lists the existing ones. Otherwise each worker would
/// report it later, one after the other.
Expected<void> check_device(const DeviceOptions& device);

}  // namespace penumbra
