// Determines how an output path is written: links, devices, pipes and protected files.
#pragma once

#include <filesystem>

#include "kernels/host/error.h"

namespace penumbra {

struct FileTarget {
  enum class Kind {
    kFile,        ///< a regular file, or none yet: written to a temporary file and renamed
    kDirect,      ///< a device or a pipe, which a rename would replace: written directly
    kDescriptor,  ///< already open, such as /dev/stdout
  };
  Kind kind = Kind::kFile;
  std::filesystem::path path;  ///< the given path, or the target of a link
  int descriptor = -1;
};

/// Resolves symbolic links, which are kept, except links of other users in shared sticky folders. Errors:
/// such a link, a folder, a disk, a socket, a file that is not writable. A rename needs no permission of the
/// replaced file, and root needs none at all. Nevertheless a file without any write permission is refused,
/// because it was protected on purpose.
Expected<FileTarget> find_target(const std::filesystem::path& path);

/// The folder that holds it.
std::filesystem::path folder_of(const std::filesystem::path& path);

/// "cannot write PATH: WHY". The reason, from errno, is worded for this path.
std::unexpected<Error> cannot_write(const std::filesystem::path& path, int error);

}  // namespace penumbra
