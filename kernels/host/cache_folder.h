// A folder of files that can be recomputed, shared by several processes. A file is written under another name
// and renamed, nothing is locked, and the least recently used files are removed first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "kernels/host/error.h"

namespace penumbra {

/// A file descriptor that is closed with its owner.
class CacheFile {
 public:
  /// `flags`: see open(2).
  CacheFile(const std::filesystem::path& path, int flags);
  CacheFile(const CacheFile&) = delete;
  CacheFile& operator=(const CacheFile&) = delete;
  ~CacheFile() { close(); }

  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }
  [[nodiscard]] int descriptor() const { return descriptor_; }
  bool close();
  /// The size of a regular file. Errors: anything else, since reading it might never end.
  [[nodiscard]] Expected<std::uint64_t> size() const;
  /// Whether this user alone can have written it; see check_cache_folder.
  [[nodiscard]] bool is_own() const;
  /// Reads at most `bytes` bytes; returns how many were read.
  std::size_t read(void* to, std::size_t bytes);
  bool write(const void* from, std::size_t bytes);
  /// Marks the file as the most recently used. Fails silently in another user's folder.
  void touch();

 private:
  int descriptor_;
};

struct CacheLimits {
  std::size_t most_files = std::numeric_limits<std::size_t>::max();
  std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max();
};

class CacheFolder {
 public:
  /// Files of the cache end in `suffix`; others are left alone. An empty path means no cache. The folder need
  /// not exist.
  CacheFolder(std::filesystem::path folder, std::string suffix, CacheLimits limits)
      : folder_(std::move(folder)), suffix_(std::move(suffix)), limits_(limits) {}

  [[nodiscard]] bool enabled() const { return !folder_.empty(); }
  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
  [[nodiscard]] std::filesystem::path file_of(std::string_view name) const;

  /// Writes the parts, one after the other, as the file's content. Errors, for a log: the folder cannot be
  /// created or written; the caller can go on without the cache.
  [[nodiscard]] Expected<void> write(std::string_view name,
                                     std::span<const std::span<const std::uint8_t>> parts) const;
  void remove(std::string_view name) const;
  /// Removes the least recently used files until the limits are met with `room` bytes to spare, and what dead
  /// processes have left. Several processes may do so at once.
  void remove_oldest(std::uint64_t room = 0) const;

 private:
  std::filesystem::path folder_;
  std::string suffix_;
  CacheLimits limits_;
};

/// What is in a folder that others can write to may be anything with a right checksum, so only a folder of
/// this user, to which neither group nor others can write, is used. Error, for users: why it is not. A folder
/// that is not there yet is right.
Expected<void> check_cache_folder(const std::filesystem::path& folder);

/// The folder that the environment variable names, else penumbra/`name` below XDG_CACHE_HOME, else below
/// ~/.cache. Empty (no cache) if the variable is "off", or if none of them is set.
std::filesystem::path cache_folder(const char* variable, std::string_view name);

}  // namespace penumbra
