// Finds and reads the files that a scene refers to, optionally confined to one folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/diagnostic.h"

namespace penumbra {

constexpr std::uint64_t kMaxSceneFileBytes = std::uint64_t{64} << 20;
constexpr std::uint64_t kMaxMeshFileBytes = std::uint64_t{4} << 30;
constexpr std::uint64_t kMaxImageFileBytes = std::uint64_t{4} << 30;
constexpr std::uint64_t kMaxVolumeFileBytes = std::uint64_t{4} << 30;
constexpr std::uint64_t kMaxMeasuredFileBytes = std::uint64_t{1} << 30;

class FileAccess {
 public:
  /// With `confine_to`, files outside that folder are never accessed, whether by "..", an absolute path or a
  /// symbolic link.
  explicit FileAccess(std::optional<std::filesystem::path> confine_to);

  /// The path of `name`: itself if it is absolute, else in the first of `folders` that contains it. If no
  /// folder does, backslashes are taken as slashes and letter case is ignored; remarks() then mention it.
  /// Errors: not found (the message lists the folders searched), outside the confinement, a name that is too
  /// long.
  [[nodiscard]] Expected<std::filesystem::path> find(std::string_view name,
                                                     std::span<const std::filesystem::path> folders) const;

  /// All bytes of the file; a gzip file is decompressed. Errors: those of read, except those about text.
  [[nodiscard]] Expected<std::string> read_bytes(const std::filesystem::path& file,
                                                 std::uint64_t max_bytes) const;

  /// The whole text file, without a UTF-8 byte order mark. Errors: the file does not exist, is not a regular
  /// file, is larger than `max_bytes` or unreadable, is a Git LFS pointer, or has a byte order mark of UTF-16
  /// or UTF-32.
  [[nodiscard]] Expected<std::unique_ptr<SourceFile>> read(const std::filesystem::path& file,
                                                           std::uint64_t max_bytes) const;

  /// Remarks about file names that find() could only match loosely; each once.
  [[nodiscard]] const std::vector<std::string>& remarks() const { return remarks_; }

  /// A hash of the contents of all files read so far, in their order. It does not depend on their paths.
  [[nodiscard]] std::uint64_t contents_hash() const { return contents_hash_; }

  /// Whether the path, after following all symbolic links, lies inside the confinement.
  [[nodiscard]] bool allows(const std::filesystem::path& file) const;

  /// All files that were read, in that order.
  [[nodiscard]] const std::vector<std::filesystem::path>& files_read() const { return files_read_; }

 private:
  /// The entries of a folder, keyed by their names in lower case. Of several names that differ only in case
  /// the first is kept. Empty for a folder outside the confinement.
  const std::map<std::string, std::filesystem::path>& entries(const std::filesystem::path& folder) const;
  /// The file whose path differs from `path` only in letter case.
  [[nodiscard]] std::optional<std::filesystem::path> find_in_any_case(
      const std::filesystem::path& path) const;
  [[nodiscard]] std::optional<std::filesystem::path> find_nearly(
      std::string_view name, const std::vector<std::filesystem::path>& candidates) const;

  std::optional<std::filesystem::path> root_;
  mutable std::uint64_t contents_hash_ = 0;
  mutable std::vector<std::filesystem::path> files_read_;
  mutable std::vector<std::string> remarks_;
  mutable std::set<std::string> said_;  ///< remarks already in remarks_
  mutable std::map<std::filesystem::path, std::map<std::string, std::filesystem::path>> entries_;
};

}  // namespace penumbra
