// Where the bytes of an output go: the one answer to links, devices, pipes and files that are protected.
#pragma once

#include <filesystem>

#include "kernels/host/error.h"

namespace penumbra {

struct FileTarget {
  enum class Kind {
    kFile,        ///< a plain file, or none yet: written aside, then renamed
    kDirect,      ///< a device or a pipe, which a rename would replace: written as it is
    kDescriptor,  ///< open already, as /dev/stdout is
  };
  Kind kind = Kind::kFile;
  std::filesystem::path path;  ///< as given, where that is no link; else what the link leads to
  int descriptor = -1;
};

/// Follows symbolic links, which stay, but for those of others in shared sticky folders. Errors: such a link,
/// a folder, a disk, a socket, a file that may not be written to. A rename needs no permission of the file
/// that it replaces, and root needs none at all: a file without any write permission is refused all the same,
/// since it has been protected on purpose.
Expected<FileTarget> find_target(const std::filesystem::path& path);

/// The folder that holds it.
std::filesystem::path folder_of(const std::filesystem::path& path);

/// "cannot write PATH: WHY", the reason of errno said in terms of the path.
std::unexpected<Error> cannot_write(const std::filesystem::path& path, int error);

}  // namespace penumbra
