#include "kernels/host/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <string>
#include <thread>
#include <utility>

#include "kernels/host/file_target.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kAllPermissions = 07777;
constexpr std::chrono::seconds kTimeToRead{10};  // time limit for the reader of a pipe
constexpr std::chrono::milliseconds kPollInterval{20};

/// Limit on simultaneous writers of one target.
constexpr int kMostParts = 64;
/// A process has some 1000 descriptors. Beyond this number, temporary files are not kept locked.
constexpr int kMostKeptDescriptors = 512;

fs::path part_name(const fs::path& path, int number) {
  const std::string name = path.filename().string();
  return folder_of(path) /
         (number == 0 ? fmt::format(".{}.part", name) : fmt::format(".{}.{}.part", name, number));
}

/// Removes a temporary file that nobody has locked, because its writer was killed. Returns whether it is
/// gone.
bool remove_if_abandoned(const fs::path& name) {
  const OwnedDescriptor part(open(name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (part.get() < 0) return errno == ENOENT;
  struct stat held {
  }, there{};
  if (fstat(part.get(), &held) != 0 || !S_ISREG(held.st_mode) || held.st_uid != geteuid()) return false;
  if (flock(part.get(), LOCK_EX | LOCK_NB) != 0) return false;
  if (lstat(name.c_str(), &there) != 0) return errno == ENOENT;
  // Another file has taken its place meanwhile.
  if (there.st_dev != held.st_dev || there.st_ino != held.st_ino) return false;
  return unlink(name.c_str()) == 0;
}

/// Removes abandoned temporary files from that number on.
void remove_abandoned_from(const fs::path& path, int number) {
  std::error_code ignored;
  for (; number < kMostParts && fs::exists(part_name(path, number), ignored); ++number)
    remove_if_abandoned(part_name(path, number));
}

struct Part {
  fs::path name;
  OwnedDescriptor descriptor;  ///< locked; negative: errno says why there is none
};

/// Creates a new temporary file beside `path` for this writer, and removes those left by killed writers.
Part new_part(const fs::path& path) {
  for (int number = 0; number < kMostParts;) {
    Part part{part_name(path, number),
              OwnedDescriptor(open(part_name(path, number).c_str(),
                                   O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666))};
    if (part.descriptor.get() < 0) {
      if (errno != EEXIST) return part;
      if (!remove_if_abandoned(part.name)) ++number;
      continue;
    }
    struct stat status {};
    flock(part.descriptor.get(), LOCK_EX);
    // Another process may have removed it as abandoned between creation and locking.
    if (fstat(part.descriptor.get(), &status) == 0 && status.st_nlink == 0) continue;
    remove_abandoned_from(path, number + 1);
    return part;
  }
  errno = EEXIST;
  return {};
}

/// Opens an existing device or pipe without truncating it. The reader of a pipe may come a little later.
/// Negative with errno = ENXIO if there is none.
int open_for_reader(const fs::path& path) {
  const auto deadline = std::chrono::steady_clock::now() + kTimeToRead;
  for (;;) {
    const int descriptor = open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
    if (descriptor >= 0 || errno != ENXIO || std::chrono::steady_clock::now() > deadline) return descriptor;
    std::this_thread::sleep_for(kPollInterval);
  }
}

/// Waits until a slow pipe accepts more data; false with errno set on failure.
bool wait_for_room(int descriptor) {
  pollfd entry{.fd = descriptor, .events = POLLOUT, .revents = 0};
  const int ready = poll(&entry, 1, int(std::chrono::milliseconds(kTimeToRead).count()));
  if (ready == 0) errno = ETIMEDOUT;
  return ready > 0 || (ready < 0 && errno == EINTR);
}

/// False with errno set on failure.
bool write_all(int descriptor, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0 && errno == EAGAIN && wait_for_room(descriptor)) continue;
    if (written < 0) return false;
    bytes = bytes.subspan(std::size_t(written));
  }
  return true;
}

/// Pipes and some file systems cannot be flushed; that is not an error.
bool flush(int descriptor) { return fsync(descriptor) == 0 || errno == EINVAL || errno == EROFS; }

/// The nearest existing parent folder.
fs::path existing_folder(fs::path folder) {
  std::error_code ignored;
  while (!fs::exists(folder, ignored) && folder.has_relative_path()) folder = folder_of(folder);
  return folder;
}

}  // namespace

StagedFile::StagedFile(fs::path target, fs::path name, OwnedDescriptor lock)
    : target_(std::move(target)), name_(std::move(name)), lock_(std::move(lock)) {}

StagedFile::StagedFile(StagedFile&& other) noexcept
    : target_(std::move(other.target_)),
      name_(std::exchange(other.name_, {})),
      lock_(std::move(other.lock_)) {}

StagedFile::~StagedFile() {
  if (!name_.empty()) unlink(name_.c_str());
}

Expected<StagedFile> StagedFile::write(const fs::path& target, std::span<const std::uint8_t> bytes) {
  Part part = new_part(target);
  const int descriptor = part.descriptor.get();
  if (descriptor < 0) return cannot_write(target, errno);
  StagedFile staged(target, part.name, std::move(part.descriptor));
  struct stat old {};
  if (stat(target.c_str(), &old) == 0) fchmod(descriptor, old.st_mode & kAllPermissions);
  if (!write_all(descriptor, bytes) || !flush(descriptor)) return cannot_write(target, errno);
  if (descriptor > kMostKeptDescriptors) staged.lock_ = OwnedDescriptor();
  return staged;
}

Expected<void> StagedFile::rename_into_place() {
  if (rename(name_.c_str(), target_.c_str()) != 0) return cannot_write(target_, errno);
  name_.clear();
  return {};
}

Expected<void> write_directly(const FileTarget& target, std::span<const std::uint8_t> bytes) {
  const int descriptor = target.kind == FileTarget::Kind::kDescriptor
                             ? fcntl(target.descriptor, F_DUPFD_CLOEXEC, 0)
                             : open_for_reader(target.path);
  if (descriptor < 0 && errno == ENXIO)
    return fail(fmt::format("cannot write {}: no reader has opened this pipe for {} s", target.path.string(),
                            kTimeToRead.count()));
  if (descriptor < 0) return cannot_write(target.path, errno);
  const bool written = write_all(descriptor, bytes);
  const int error = errno;
  const bool closed = close(descriptor) == 0;
  if (!written || !closed) return cannot_write(target.path, written ? errno : error);
  return {};
}

Expected<void> write_file_atomically(const fs::path& path, std::span<const std::uint8_t> bytes) {
  const auto target = find_target(path);
  if (!target) return std::unexpected(target.error());
  if (target->kind != FileTarget::Kind::kFile) return write_directly(*target, bytes);
  auto staged = StagedFile::write(target->path, bytes);
  if (!staged) return std::unexpected(staged.error());
  return staged->rename_into_place();
}

void remove_abandoned_parts(const fs::path& path) { remove_abandoned_from(path, 0); }

void remove_all_abandoned_parts(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with('.') && name.ends_with(".part")) remove_if_abandoned(entry->path());
  }
}

Expected<void> check_writable(const fs::path& path) {
  const auto target = find_target(path);
  if (!target) return std::unexpected(target.error());
  if (target->kind != FileTarget::Kind::kFile) return {};
  const fs::path folder = folder_of(target->path), existing = existing_folder(folder);
  std::error_code ignored;
  if (!fs::is_directory(existing, ignored))
    return fail(fmt::format("cannot write {}: {} is not a folder", path.string(), existing.string()));
  if (existing != folder) {
    if (access(existing.c_str(), W_OK | X_OK) == 0) return {};
    return fail(fmt::format("cannot write {}: no folder can be made in {}: {}", path.string(),
                            existing.string(), std::generic_category().message(errno)));
  }
  const Part probe = new_part(target->path);
  if (probe.descriptor.get() < 0) return cannot_write(path, errno);
  unlink(probe.name.c_str());
  return {};
}

Expected<void> make_folders(const fs::path& path) {
  const auto target = find_target(path);
  if (!target) return std::unexpected(target.error());
  std::error_code error;
  if (target->kind == FileTarget::Kind::kFile) fs::create_directories(folder_of(target->path), error);
  if (!error) return {};
  return fail(
      fmt::format("cannot make the folder {}: {}", folder_of(target->path).string(), error.message()));
}

Expected<void> write_output(const fs::path& path, std::span<const std::uint8_t> bytes) {
  if (auto made = make_folders(path); !made) return made;
  return write_file_atomically(path, bytes);
}

}  // namespace penumbra
