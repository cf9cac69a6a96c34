// Locks of folders, between processes.
#pragma once

#include <filesystem>
#include <vector>

namespace penumbra {

/// Locks folders while it lives, so that no other process with such locks puts files into them meanwhile.
/// Goes on without a lock if the file system does not support it, or if another process holds it for long.
/// Leaves nothing behind (flock).
class FolderLocks {
 public:
  explicit FolderLocks(const std::vector<std::filesystem::path>& folders);
  FolderLocks(const FolderLocks&) = delete;
  FolderLocks& operator=(const FolderLocks&) = delete;
  ~FolderLocks();

 private:
  std::vector<int> descriptors_;
};

}  // namespace penumbra
