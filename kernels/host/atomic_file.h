// Atomic file writes: after a crash, a full disk or a kill there is either the old file or the new one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

#include "kernels/host/error.h"
#include "kernels/host/file_target.h"
#include "kernels/host/owned_descriptor.h"

namespace penumbra {

/// A temporary hidden file beside its target. It is removed again unless it is renamed to the target. It is
/// locked while its writer lives, so that the next writer can recognise and remove files left by a killed
/// one.
class StagedFile {
 public:
  /// Writes the bytes and flushes them to disk. `target` is a file or does not exist, and is not a link.
  /// Errors: the folder is missing or not writable, the disk is full.
  static Expected<StagedFile> write(const std::filesystem::path& target, std::span<const std::uint8_t> bytes);
  StagedFile(StagedFile&& other) noexcept;
  StagedFile& operator=(StagedFile&&) = delete;
  ~StagedFile();

  /// Renames it to its target and gives it the target's permissions.
  Expected<void> rename_into_place();

 private:
  StagedFile(std::filesystem::path target, std::filesystem::path name, OwnedDescriptor lock);

  std::filesystem::path target_, name_;  ///< name_ is empty after a move or rename
  OwnedDescriptor lock_;
};

/// Writes a temporary file and renames it, if the path is or leads to a regular file or does not exist. On an
/// error an existing file is unchanged and nothing is left behind. Devices and pipes are written directly.
/// Errors: those of find_target, a missing folder, a full disk.
Expected<void> write_file_atomically(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);

/// Removes the temporary files that killed processes have left: those of this file, or all in a folder.
void remove_abandoned_parts(const std::filesystem::path& path);
void remove_all_abandoned_parts(const std::filesystem::path& folder);

/// Writes to a device, a pipe or an open descriptor.
Expected<void> write_directly(const FileTarget& target, std::span<const std::uint8_t> bytes);

/// The bytes of a text.
inline std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Checks that `make_folders(path)` and `write_file_atomically(path, …)` will probably succeed, so that a
/// long render does not fail at the end for lack of permission. Leaves nothing behind.
Expected<void> check_writable(const std::filesystem::path& path);

/// Creates missing folders of the file's path.
Expected<void> make_folders(const std::filesystem::path& path);

/// make_folders, then write_file_atomically.
Expected<void> write_output(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);

}  // namespace penumbra
