// Which renders a command with several scenes, or with job files, comes to, and where their files go.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/cli/output_files.h"
#include "scheduler/cli/render_options.h"

namespace penumbra {

/// One render of a set: its options are those of a command with this scene alone.
struct SetMember {
  RenderOptions options;
  OutputFiles files = {};
  int priority = 0;
  std::string name;  ///< for people: the scene, and what is varied
  std::vector<std::pair<std::string, std::string>> choices = {};  ///< all that it was given but the scene
};

struct SetPlan {
  std::vector<SetMember> members;  ///< those of the highest priority first, else in the order given
  std::filesystem::path summary;
};

/// Of each render.
std::vector<const SceneOptions*> scenes_of(const SetPlan& plan);

/// All renders of the command's scenes and job files; what the command says counts for each, also where a job
/// file says otherwise. `-o`, or a file's `out`, is a folder, made if it is missing, or a name with fields:
/// {scene} (the scene's name without its extension), {folder} (that of the folder it is in), and whatever the
/// render is given: {seed:03}, {integrator}. Errors: a wrong job file, another field, two renders with one
/// output, options that mean one image.
Expected<SetPlan> plan_set(const RenderOptions& options, const CLI::App& command);

}  // namespace penumbra
