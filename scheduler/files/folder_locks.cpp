#include "scheduler/files/folder_locks.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <map>
#include <thread>
#include <utility>

namespace penumbra {
namespace {

void lock_patiently(int descriptor) {
  constexpr std::chrono::seconds kPatience{10};
  constexpr std::chrono::milliseconds kPause{5};
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && (errno == EWOULDBLOCK || errno == EINTR) &&
         std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(kPause);
}

}  // namespace

FolderLocks::FolderLocks(const std::vector<std::filesystem::path>& folders) {
  std::map<std::pair<dev_t, ino_t>, int>
      in_order;  // the same order in every process, which prevents deadlock
  for (const std::filesystem::path& folder : folders) {
    const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    struct stat status {};
    if (descriptor < 0) continue;
    descriptors_.push_back(descriptor);
    if (fstat(descriptor, &status) == 0) in_order.try_emplace({status.st_dev, status.st_ino}, descriptor);
  }
  for (const auto& [identity, descriptor] : in_order) lock_patiently(descriptor);
}

FolderLocks::~FolderLocks() {
  for (const int descriptor : descriptors_) close(descriptor);
}

}  // namespace penumbra
