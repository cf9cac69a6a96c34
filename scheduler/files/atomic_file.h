// Files that appear whole or not at all: a crash, a full disk or a kill leaves the old file or the new one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

#include "kernels/host/error.h"
#include "kernels/host/owned_descriptor.h"
#include "scheduler/files/file_target.h"

namespace penumbra {

/// Bytes in a hidden file beside their target, which is removed again unless it is renamed. It is locked as
/// long as its writer lives, so that the next one removes what a killed one has left.
class StagedFile {
 public:
  /// Writes and flushes to the disk. `target` is a file or nothing yet, no link. Errors: the folder is
  /// missing or not writable, the disk is full.
  static Expected<StagedFile> write(const std::filesystem::path& target, std::span<const std::uint8_t> bytes);
  StagedFile(StagedFile&& other) noexcept;
  StagedFile& operator=(StagedFile&&) = delete;
  ~StagedFile();

  /// Puts it in the place of its target, whose permissions it gets.
  Expected<void> rename_into_place();

 private:
  StagedFile(std::filesystem::path target, std::filesystem::path name, OwnedDescriptor lock);

  std::filesystem::path target_, name_;  ///< no name: moved from, or renamed
  OwnedDescriptor lock_;
};

/// Writes `bytes` aside and renames, where the path is or leads to a plain file or nothing yet; on an error
/// the old file, if there is one, is untouched and nothing is left behind. Devices and pipes are written as
/// they are. Errors: those of find_target, a missing folder, a full disk.
Expected<void> write_file_atomically(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);

/// Removes what processes that were killed while they wrote the file have left beside it; or in the folder
/// whatever they wrote.
void remove_abandoned_parts(const std::filesystem::path& path);
void remove_all_abandoned_parts(const std::filesystem::path& folder);

/// Into a device, a pipe or an open descriptor.
Expected<void> write_directly(const FileTarget& target, std::span<const std::uint8_t> bytes);

/// The bytes of a text.
inline std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Whether `make_folders(path)` and `write_file_atomically(path, …)` can be expected to work, so that a
/// render of hours does not end at a missing permission. Leaves nothing behind.
Expected<void> check_writable(const std::filesystem::path& path);

/// Makes the folders that the file will be in, where they are missing.
Expected<void> make_folders(const std::filesystem::path& path);

/// Both: makes the folders and writes the file.
Expected<void> write_output(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);

}  // namespace penumbra
