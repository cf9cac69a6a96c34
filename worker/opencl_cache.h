// A cache of compiled kernels on disk, so that a worker compiles them once for each device and not at every
// start.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "worker/cache_folder.h"

namespace penumbra {

/// The folder: PENUMBRA_KERNEL_CACHE, else penumbra/kernels below XDG_CACHE_HOME, else below ~/.cache. Empty
/// (no cache) if PENUMBRA_KERNEL_CACHE=off, or if none of these variables is set.
std::filesystem::path default_kernel_cache();

/// Files are named after the hash of what they were compiled from. Several processes may use one folder: a
/// file is written under another name and renamed. A file that is incomplete or does not match its name is
/// never returned.
class KernelCache {
 public:
  static constexpr int kMostFiles = 64;  ///< of about 100 kB each

  /// With an empty folder nothing is found or stored.
  explicit KernelCache(std::filesystem::path folder, int most_files = kMostFiles);

  /// A hash of the parts as 32 hexadecimal digits. {"ab", "c"} and {"a", "bc"} differ.
  static std::string key_of(std::span<const std::string> parts);

  struct Found {
    std::optional<std::vector<unsigned char>> binary;
    std::string note;  ///< for users: what was wrong with a file, which is removed; else empty
  };
  /// The binary stored under the key, which becomes the most recently used.
  [[nodiscard]] Found find(std::string_view key) const;

  /// Stores a binary, and removes the least recently used ones. Errors, for a log: the folder cannot be
  /// created or written; the caller can go on without the cache.
  Expected<void> keep(std::string_view key, std::span<const unsigned char> binary) const;

  void remove(std::string_view key) const { files_.remove(key); }

  [[nodiscard]] std::filesystem::path file_of(std::string_view key) const { return files_.file_of(key); }
  [[nodiscard]] bool enabled() const { return files_.enabled(); }

 private:
  CacheFolder files_;
};

}  // namespace penumbra
