// Compiled kernels on disk, so that a worker compiles a set of them once for each device and not at each
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

/// The user's choice of folder: PENUMBRA_KERNEL_CACHE, else penumbra/kernels below XDG_CACHE_HOME, else
/// below
/// ~/.cache. Empty, which is no cache: PENUMBRA_KERNEL_CACHE=off, or none of these variables is set.
std::filesystem::path default_kernel_cache();

/// Files named after what they were compiled from. Several processes may use one folder: a file is written
/// aside and renamed, and whatever is not whole, or not what its name says, is never returned.
class KernelCache {
 public:
  static constexpr int kMostFiles = 64;  ///< of some 100 kB

  /// An empty folder: nothing is found and nothing kept.
  explicit KernelCache(std::filesystem::path folder, int most_files = kMostFiles);

  /// 32 hexadecimal digits of all the parts, which are told apart: {"ab", "c"} is not {"a", "bc"}.
  static std::string key_of(std::span<const std::string> parts);

  struct Found {
    std::optional<std::vector<unsigned char>> binary;
    std::string note;  ///< for people: what was wrong with a file that was there, and is removed; else empty
  };
  /// What was kept under the key. It then counts as the one used last.
  [[nodiscard]] Found find(std::string_view key) const;

  /// Keeps a binary, and of all files only those used last. Fails, in words for a log, if the folder cannot
  /// be made or written; that is no reason not to go on.
  Expected<void> keep(std::string_view key, std::span<const unsigned char> binary) const;

  void remove(std::string_view key) const { files_.remove(key); }

  [[nodiscard]] std::filesystem::path file_of(std::string_view key) const { return files_.file_of(key); }
  [[nodiscard]] bool enabled() const { return files_.enabled(); }

 private:
  CacheFolder files_;
};

}  // namespace penumbra
