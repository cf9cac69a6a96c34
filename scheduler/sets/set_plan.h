// Expands a command with several scenes or with job files to a list of renders and their output files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/render/frame_files.h"
#include "scheduler/run/output_files.h"
#include "scheduler/run/render_options.h"
#include "worker/cli/command_line.h"

namespace penumbra {

/// One render of a set. Its options are those of a command with only this scene.
struct SetMember {
  RenderOptions options;
  OutputFiles files = {};
  int priority = 0;
  std::filesystem::path base =
      {};  ///< the folder of the job file, if that says where the images go; else empty
  std::vector<std::size_t> after = {};  ///< earlier members of the plan that must be done before
  std::string name;                     ///< for display: the scene, and the varied parameters
  std::vector<std::pair<std::string, std::string>> choices = {};  ///< all its parameters except the scene
  std::string shot = {};  ///< of a frame: its image, with # for the digits of the frame; else empty
};

/// Members that differ in the frame alone.
struct SetShot {
  FrameFiles pictures;               ///< PNG files, absolute
  std::filesystem::path sheet = {};  ///< the contact sheet, if there are several frames; empty: none
  std::vector<std::pair<int, std::size_t>> frames = {};  ///< their numbers, ascending, and members
};

struct SetPlan {
  /// By descending priority, else in the given order; but each after those that must be done before.
  std::vector<SetMember> members;
  std::vector<SetShot> shots = {};  ///< in the order of their first members
  std::string name;                 ///< for display: the job file, or the scene, and how many more there are
  bool has_job_file = false;
  std::filesystem::path summary;
};

/// The scene options of each render.
std::vector<const SceneOptions*> scenes_of(const SetPlan& plan);

/// Lists all renders of the command's scenes and job files. Options of the command line apply to every render
/// and override those of job files. `-o`, or `out` in a job file, is either a folder, which is created if
/// missing, or a name with fields: {scene} (the scene's name without its extension), {folder} (the name of
/// its folder), and the parameters of the render, such as {seed:03} or {integrator}. Errors: an invalid job
/// file, an unknown field, two renders with the same output, options that only make sense for a single image.
Expected<SetPlan> plan_set(const RenderOptions& options, const CommandLine& command);

}  // namespace penumbra
