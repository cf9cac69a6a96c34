// A cache on disk of what is computed from some input. Files are named after the hash of the input, and a
// file that is incomplete, damaged, another one than its name says or perhaps another user's is never
// returned.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/cache_folder.h"
#include "kernels/host/error.h"

namespace penumbra {

/// Several processes may use one folder: a file is written under another name and renamed.
class CheckedCache {
 public:
  /// With an empty folder nothing is found or stored.
  CheckedCache(std::filesystem::path folder, std::string suffix, CacheLimits limits);

  /// A content hash of the parts and their sizes: {"ab", "c"} and {"a", "bc"} differ.
  static std::string key_of(std::span<const std::string> parts);

  struct Found {
    std::optional<std::vector<std::uint8_t>> bytes;
    std::string note;  ///< for users: what was wrong with a file, which is removed; else empty
  };
  /// The bytes stored under the key, which become the most recently used.
  [[nodiscard]] Found find(std::string_view key) const;

  /// Stores the parts, one after the other, and removes the least recently used files. Errors, for a log: the
  /// folder cannot be created or written, or is not this user's alone; the caller can go on without the
  /// cache.
  Expected<void> keep(std::string_view key, std::span<const std::span<const std::uint8_t>> parts) const;
  Expected<void> keep(std::string_view key, std::span<const std::uint8_t> bytes) const;

  void remove(std::string_view key) const { files_.remove(key); }

  [[nodiscard]] std::filesystem::path file_of(std::string_view key) const { return files_.file_of(key); }
  [[nodiscard]] bool enabled() const { return files_.enabled(); }

 private:
  CacheFolder files_;
};

}  // namespace penumbra
