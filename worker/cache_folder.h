// A folder of files that can be made again, shared by several processes: a file is written aside and renamed,
// nothing is locked, and the oldest go first.
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

/// A file descriptor that does not stay open.
class CacheFile {
 public:
  /// `flags`: of open(2).
  CacheFile(const std::filesystem::path& path, int flags);
  CacheFile(const CacheFile&) = delete;
  CacheFile& operator=(const CacheFile&) = delete;
  ~CacheFile() { close(); }

  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }
  [[nodiscard]] int descriptor() const { return descriptor_; }
  bool close();
  /// Its size if it is a plain file; nothing else may be read, since that might never end.
  [[nodiscard]] Expected<std::uint64_t> size() const;
  /// How many bytes there were to read, at most so many.
  std::size_t read(void* to, std::size_t bytes);
  bool write(const void* from, std::size_t bytes);
  /// It counts as the one used last; fails without harm in another user's folder.
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
  /// Its files end in `suffix`; others are left alone. An empty folder is no cache. It need not exist.
  CacheFolder(std::filesystem::path folder, std::string suffix, CacheLimits limits)
      : folder_(std::move(folder)), suffix_(std::move(suffix)), limits_(limits) {}

  [[nodiscard]] bool enabled() const { return !folder_.empty(); }
  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
  [[nodiscard]] std::filesystem::path file_of(std::string_view name) const;

  /// Its whole content is the parts, one after the other. Fails, in words for a log, if the folder cannot be
  /// made or written; that is no reason not to go on.
  [[nodiscard]] Expected<void> write(std::string_view name,
                                     std::span<const std::span<const std::uint8_t>> parts) const;
  void remove(std::string_view name) const;
  /// Removes those used longest ago until there are no more than the limits say, and so many bytes less; and
  /// what dead processes have left. Several processes may do it at once.
  void remove_oldest(std::uint64_t room = 0) const;

 private:
  std::filesystem::path folder_;
  std::string suffix_;
  CacheLimits limits_;
};

/// The folder penumbra/`name` below XDG_CACHE_HOME, else below ~/.cache; empty if neither variable is set.
std::filesystem::path user_cache(std::string_view name);

}  // namespace penumbra
