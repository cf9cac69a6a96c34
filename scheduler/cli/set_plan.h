// Which renders a command with several scenes comes to, and where their files go.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/cli/output_files.h"
#include "scheduler/cli/render_options.h"

namespace penumbra {

/// One render of a set: its options are those of a command with this scene alone.
struct SetMember {
  RenderOptions options;
  OutputFiles files;
};

struct SetPlan {
  std::vector<SetMember> members;  ///< in the order of the command line
  std::filesystem::path summary;
};

/// `-o` is a folder, made if it is missing, or a name in which {scene} is the scene's name without its
/// extension and {folder} that of the folder it is in. Errors: another field, two scenes with one output,
/// options that mean one image.
Expected<SetPlan> plan_set(const RenderOptions& options);

}  // namespace penumbra
