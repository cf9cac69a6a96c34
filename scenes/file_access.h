// Finding and reading the files that a scene names, optionally confined to one folder.
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

class FileAccess {
 public:
  /// With `confine_to`, nothing outside that folder is looked at: neither through "..", nor an absolute path,
  /// nor a symbolic link.
  explicit FileAccess(std::optional<std::filesystem::path> confine_to);

  /// `name` itself if absolute, else the first of `folders` that has it. Where none has, back slashes count
  /// as slashes, and capital letters as small ones: then remarks() say so. Errors: nowhere found (says where
  /// it looked), outside the confinement, longer than any name.
  [[nodiscard]] Expected<std::filesystem::path> find(std::string_view name,
                                                     std::span<const std::filesystem::path> folders) const;

  /// All bytes of the file; of one of gzip, unpacked. Errors: as of read, but for those of text.
  [[nodiscard]] Expected<std::string> read_bytes(const std::filesystem::path& file,
                                                 std::uint64_t max_bytes) const;

  /// The whole file, without the byte order mark of UTF-8. Errors: not there, not a plain file, larger than
  /// `max_bytes`, unreadable, a pointer of Git LFS, UTF-16 or UTF-32 by its byte order mark.
  [[nodiscard]] Expected<std::unique_ptr<SourceFile>> read(const std::filesystem::path& file,
                                                           std::uint64_t max_bytes) const;

  /// What is odd about names that find() was given, in words for people; each once.
  [[nodiscard]] const std::vector<std::string>& remarks() const { return remarks_; }

  /// Of the contents of all files read so far, in their order; not of where they are.
  [[nodiscard]] std::uint64_t contents_hash() const { return contents_hash_; }

  /// Whether the path, all symbolic links followed, lies inside the confinement.
  [[nodiscard]] bool allows(const std::filesystem::path& file) const;

  /// All that have been read, in that order.
  [[nodiscard]] const std::vector<std::filesystem::path>& files_read() const { return files_read_; }

 private:
  /// The names in a folder by their small letters, of several alike the first; none of a folder outside the
  /// confinement.
  const std::map<std::string, std::filesystem::path>& entries(const std::filesystem::path& folder) const;
  /// The file of a path that differs only in the case of letters.
  [[nodiscard]] std::optional<std::filesystem::path> find_in_any_case(
      const std::filesystem::path& path) const;
  [[nodiscard]] std::optional<std::filesystem::path> find_nearly(
      std::string_view name, const std::vector<std::filesystem::path>& candidates) const;

  std::optional<std::filesystem::path> root_;
  mutable std::uint64_t contents_hash_ = 0;
  mutable std::vector<std::filesystem::path> files_read_;
  mutable std::vector<std::string> remarks_;
  mutable std::set<std::string> said_;  ///< the remarks
  mutable std::map<std::filesystem::path, std::map<std::string, std::filesystem::path>> entries_;
};

}  // namespace penumbra
