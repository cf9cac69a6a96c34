#include "kernels/host/file_target.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string>

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr int kMostLinks = 40;  // the same limit as in Linux

std::unexpected<Error> refuse(const fs::path& path, std::string_view why) {
  return fail(fmt::format("cannot write {}: {}", path.string(), why));
}

/// The number N of /proc/self/fd/N, to which /dev/stdout and /dev/fd/N lead. This link is not followed: the
/// file behind it may have been renamed or removed, and its contents must be kept.
std::optional<int> descriptor_of(const fs::path& path) {
  const std::string name = path.filename().string();
  if (name.empty() || name.size() > 6 ||
      !std::ranges::all_of(name, [](char c) { return c >= '0' && c <= '9'; }))
    return std::nullopt;
  std::error_code error;
  const fs::path folder = fs::canonical(folder_of(path), error);
  if (error || folder != fs::canonical("/proc/self/fd", error) || error) return std::nullopt;
  return std::stoi(name);
}

Expected<FileTarget> open_target(const fs::path& path, const fs::path& at, int descriptor) {
  const int flags = fcntl(descriptor, F_GETFL);
  if (flags < 0) return cannot_write(path, errno);
  if ((flags & O_ACCMODE) == O_RDONLY) return refuse(path, "it is not open for writing");
  return FileTarget{FileTarget::Kind::kDescriptor, at, descriptor};
}

Expected<FileTarget> existing_target(const fs::path& path, const fs::path& at, const struct stat& status) {
  if (S_ISDIR(status.st_mode)) return refuse(path, "it is a folder");
  if (S_ISBLK(status.st_mode)) return refuse(path, "it is a disk");
  if (S_ISSOCK(status.st_mode)) return refuse(path, "it is a socket");
  if ((status.st_mode & (S_IWUSR | S_IWGRP | S_IWOTH)) == 0)
    return refuse(path, "it is write-protected (no write permission for any user)");
  if (access(at.c_str(), W_OK) != 0) return cannot_write(path, errno);
  return FileTarget{S_ISREG(status.st_mode) ? FileTarget::Kind::kFile : FileTarget::Kind::kDirect, at};
}

/// Linux's rule of protected_symlinks, whether or not it is enabled: in a world-writable sticky folder, only
/// links of the user or of the folder's owner are followed.
bool may_follow(const fs::path& link, const struct stat& status) {
  struct stat folder {};
  if (stat(folder_of(link).c_str(), &folder) != 0) return true;  // a later read reports the error
  constexpr mode_t kShared = S_ISVTX | S_IWOTH;
  return (folder.st_mode & kShared) != kShared || status.st_uid == geteuid() ||
         status.st_uid == folder.st_uid;
}

}  // namespace

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

std::unexpected<Error> cannot_write(const fs::path& path, int error) {
  const fs::path folder = folder_of(path);
  std::error_code ignored;
  if (error == ENOENT && !fs::exists(folder, ignored))
    return refuse(path, fmt::format("the folder {} does not exist", folder.string()));
  if (error == ENOTDIR) return refuse(path, fmt::format("{} is not a folder", folder.string()));
  return refuse(path, std::strerror(error));
}

Expected<FileTarget> find_target(const fs::path& path) {
  fs::path at = path;
  for (int links = 0; links <= kMostLinks; ++links) {
    if (!at.has_filename()) return refuse(path, "it names a folder");
    if (const auto descriptor = descriptor_of(at)) return open_target(path, at, *descriptor);
    struct stat status {};
    if (lstat(at.c_str(), &status) != 0) {
      if (errno == ENOENT) return FileTarget{FileTarget::Kind::kFile, at};
      return cannot_write(path, errno);
    }
    if (!S_ISLNK(status.st_mode)) return existing_target(path, at, status);
    if (!may_follow(at, status))
      return refuse(path,
                    fmt::format("{} is a link that somebody else has laid in a folder which all may write to",
                                at.string()));
    std::error_code error;
    const fs::path next = fs::read_symlink(at, error);
    if (error) return refuse(path, error.message());
    at = folder_of(at) / next;  // replaces the path if the link is absolute
  }
  return cannot_write(path, ELOOP);
}

}  // namespace penumbra
