// Finds Blender, and the script that exports by it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

/// Blender, or a Python that has Blender as its module bpy.
struct BlenderProgram {
  std::filesystem::path path;
  bool is_python = false;

  /// The arguments that run a script with these arguments, without the user's settings and without scripts of
  /// files.
  [[nodiscard]] std::vector<std::string> arguments(const std::filesystem::path& script,
                                                   std::vector<std::string> words) const;
};

/// The program that `named` (--blender) names, else PENUMBRA_BLENDER, else `blender` in PATH, else, also
/// where that is too old, PENUMBRA_BLENDER_PYTHON. Errors: there is none; it does not run, or is neither
/// Blender >= 4.2 nor a Python.
Expected<BlenderProgram> find_blender(const std::string& named);

/// command_line.py of the extension: share/penumbra/blender of the installed folder, or the build folder's.
Expected<std::filesystem::path> find_export_script();

}  // namespace penumbra
