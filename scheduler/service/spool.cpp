#include "scheduler/service/spool.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <fstream>
#include <limits>
#include <optional>

#include "kernels/host/atomic_file.h"
#include "kernels/host/content_hash.h"
#include "kernels/host/file_target.h"
#include "kernels/host/owned_descriptor.h"
#include "kernels/host/plain_file.h"
#include "worker/keys/secrets.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kReadBytes = std::size_t(16) << 20;
constexpr std::uint64_t kMostTokenBytes = 256;
constexpr std::string_view kIncoming = ".incoming-";

std::optional<JobId> number_of(const fs::path& path) {
  const std::string name = path.filename().string();
  JobId number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error != std::errc() || end != name.data() + name.size() || number == 0) return {};
  return number;
}

Expected<std::string> read_whole(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || file.bad()) return fail(fmt::format("cannot read {}", path.string()));
  return bytes;
}

/// Flushes the folder to disk, so that file names survive a crash of the machine.
void flush_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

}  // namespace

Expected<std::unique_ptr<Spool>> Spool::open(const fs::path& folder) {
  std::error_code error;
  for (const fs::path& path : {folder, folder / "scenes", folder / "groups", folder / "jobs"}) {
    const bool made = fs::create_directories(path, error);
    if (error) return fail(fmt::format("cannot make the folder {}: {}", path.string(), error.message()));
    if (made) fs::permissions(path, fs::perms::owner_all, error);
  }
  const fs::path lock_path = folder / "lock";
  const int lock = ::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (lock < 0) return cannot_write(lock_path, errno);
  if (flock(lock, LOCK_EX | LOCK_NB) != 0) {
    close(lock);
    return fail(fmt::format("{} belongs to another service that is running", folder.string()));
  }
  for (const auto& entry : fs::directory_iterator(folder / "scenes", error))
    if (entry.path().filename().string().starts_with(kIncoming)) fs::remove(entry.path(), error);
  remove_all_abandoned_parts(folder);
  remove_all_abandoned_parts(folder / "groups");
  for (const auto& entry : fs::directory_iterator(folder / "jobs", error))
    remove_all_abandoned_parts(entry.path());
  return std::unique_ptr<Spool>(new Spool(folder, lock));
}

Spool::~Spool() { close(lock_); }

fs::path Spool::folder_of(JobId job) const { return folder_ / "jobs" / fmt::to_string(job); }

Expected<std::string> Spool::watch_token() {
  const fs::path path = folder_ / "watch.token";
  std::string token = make_token();
  if (auto kept = read_plain_file(path, kMostTokenBytes); kept && kept->size() == token.size()) return kept;
  const OwnedDescriptor file(
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (file.get() < 0 || ::write(file.get(), token.data(), token.size()) != ssize_t(token.size()))
    return cannot_write(path, errno);
  return token;
}

std::vector<wire::StoredJob> Spool::read_jobs(std::vector<std::string>& problems) const {
  std::vector<wire::StoredJob> jobs;
  std::error_code error;
  fs::directory_iterator folders(folder_ / "jobs", error);
  if (error)
    problems.push_back(fmt::format("cannot list the jobs of {}: {}", folder_.string(), error.message()));
  for (const auto& entry : folders) {
    const std::optional<JobId> number = number_of(entry.path());
    const fs::path file = entry.path() / "job";
    if (!number) {
      problems.push_back(fmt::format("{} is no job's folder and left as it is", entry.path().string()));
      continue;
    }
    const auto bytes = read_whole(file);
    wire::StoredJob job;
    if (!bytes || !job.ParseFromString(*bytes) || job.status().job() != *number)
      problems.push_back(
          fmt::format("{} cannot be read; the job {} is left as it is", file.string(), *number));
    else
      jobs.push_back(std::move(job));
  }
  std::ranges::sort(jobs, {}, [](const wire::StoredJob& job) { return job.status().job(); });
  return jobs;
}

Expected<void> Spool::keep(const wire::StoredJob& job) {
  const fs::path path = folder_of(job.status().job()) / "job";
  const std::string bytes = job.SerializeAsString();
  const auto written = write_output(path, bytes_of(bytes));
  if (written) {
    flush_folder(path.parent_path());
    flush_folder(path.parent_path().parent_path());
  }
  return written;
}

std::vector<wire::StoredGroup> Spool::read_groups(std::vector<std::string>& problems) const {
  std::vector<wire::StoredGroup> groups;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder_ / "groups", ignored)) {
    const std::optional<JobId> number = number_of(entry.path());
    const auto bytes = read_whole(entry.path());
    wire::StoredGroup group;
    if (!number || !bytes || !group.ParseFromString(*bytes) || group.group().number() != *number)
      problems.push_back(fmt::format("{} cannot be read and is left as it is", entry.path().string()));
    else
      groups.push_back(std::move(group));
  }
  return groups;
}

Expected<void> Spool::keep(const wire::StoredGroup& group) {
  const fs::path path = folder_ / "groups" / fmt::to_string(group.group().number());
  const std::string bytes = group.SerializeAsString();
  const auto written = write_output(path, bytes_of(bytes));
  if (written) flush_folder(path.parent_path());
  return written;
}

void Spool::remove_group(JobId group) {
  std::error_code ignored;
  fs::remove(folder_ / "groups" / fmt::to_string(group), ignored);
}

void Spool::remove(JobId job) {
  std::error_code ignored;
  fs::remove_all(folder_of(job), ignored);
}

fs::path Spool::checkpoint_of(JobId job, const wire::Submission& submission) const {
  fs::path path = folder_of(job) / (submission.files_size() > 0 ? submission.files(0) : "none");
  return path += ".checkpoint";
}

void Spool::remove_checkpoint(JobId job, const wire::Submission& submission) {
  std::error_code ignored;
  if (submission.files_size() > 0) fs::remove(checkpoint_of(job, submission), ignored);
}

JobId Spool::next_number() const {
  JobId next = 1;
  if (const auto text = read_whole(folder_ / "next"))
    std::from_chars(text->data(), text->data() + text->size(), next);
  std::error_code ignored;  // also if that file is lost
  for (const char* kind : {"jobs", "groups"})
    for (const auto& entry : fs::directory_iterator(folder_ / kind, ignored))
      if (const auto number = number_of(entry.path())) next = std::max(next, *number + 1);
  return next;
}

Expected<void> Spool::use_number(JobId number) {
  const std::string text = fmt::format("{}\n", number + 1);
  return write_output(folder_ / "next", bytes_of(text));
}

bool Spool::has_scene(const std::string& hash) const {
  std::error_code ignored;
  return is_content_hash(hash) && fs::is_regular_file(scene_path(hash), ignored);
}

Expected<StoredScene> Spool::read_scene(const std::string& hash) const {
  const fs::path path = scene_path(hash);
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) return fail(fmt::format("cannot read the scene {}", path.string()));
  DeviceSceneReader reader{std::size_t(size)};
  std::vector<std::uint8_t> part(std::min<std::size_t>(kReadBytes, std::size_t(size)));
  while (file.read(reinterpret_cast<char*>(part.data()), std::streamsize(part.size())), file.gcount() > 0) {
    const std::span bytes(part.data(), std::size_t(file.gcount()));
    if (const auto added = reader.add(bytes); !added)
      return fail(fmt::format("{}: {}", path.string(), added.error().message));
  }
  auto scene = reader.finish();
  AssetManifest manifest = scene ? manifest_of(*scene) : AssetManifest();
  if (manifest.hash != hash) return fail(fmt::format("the scene {} is damaged", path.string()));
  return StoredScene{std::move(*scene), std::move(manifest)};
}

void Spool::remove_other_scenes(const std::set<std::string>& used) {
  std::error_code ignored;
  std::vector<fs::path> unused;
  for (const auto& entry : fs::directory_iterator(folder_ / "scenes", ignored)) {
    const std::string name = entry.path().filename().string();
    if (is_content_hash(name) && !used.contains(name)) unused.push_back(entry.path());
  }
  for (const fs::path& path : unused) fs::remove(path, ignored);
}

// --- Receiving a scene

struct Spool::IncomingScene::State {
  std::string hash;
  fs::path temporary, target;
  int descriptor = -1;
  DeviceSceneReader reader{};
  std::ifstream base;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (descriptor < 0) return;
    close(descriptor);
    unlink(temporary.c_str());
  }
};

Spool::IncomingScene::IncomingScene(std::unique_ptr<State> state) : state_(std::move(state)) {}
Spool::IncomingScene::IncomingScene(IncomingScene&&) noexcept = default;
Spool::IncomingScene::~IncomingScene() = default;

Expected<Spool::IncomingScene> Spool::receive_scene(const std::string& hash, const std::string& base) {
  if (!is_content_hash(hash))
    return fail(fmt::format("'{}' is no content hash", hash.substr(0, 2 * sizeof(ContentDigest))));
  static std::atomic<unsigned> counter = 0;
  auto state = std::make_unique<IncomingScene::State>();
  state->hash = hash;
  state->target = scene_path(hash);
  state->temporary = folder_ / "scenes" / fmt::format("{}{}-{}", kIncoming, hash, ++counter);
  state->descriptor = ::open(state->temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (state->descriptor < 0) return cannot_write(state->temporary, errno);
  if (!base.empty()) {
    if (has_scene(base)) state->base.open(scene_path(base), std::ios::binary);
    if (!state->base.is_open()) return fail(fmt::format("the scene {} is not here (any more)", base));
  }
  return IncomingScene(std::move(state));
}

Expected<void> Spool::IncomingScene::add(std::span<const std::uint8_t> bytes) {
  if (const auto added = state_->reader.add(bytes); !added) return added;
  if (!write_whole(state_->descriptor, bytes)) return cannot_write(state_->temporary, errno);
  return {};
}

Expected<void> Spool::IncomingScene::add_of_base(std::uint64_t from, std::uint64_t bytes) {
  const auto too_few = [] { return fail("parts of a scene that has not so many bytes"); };
  if (from > std::uint64_t(std::numeric_limits<std::streamoff>::max())) return too_few();
  state_->base.seekg(std::streamoff(from));
  std::vector<std::uint8_t> part(std::min<std::uint64_t>(kReadBytes, bytes));
  while (bytes > 0) {
    const auto count = std::min<std::uint64_t>(part.size(), bytes);
    if (!state_->base.read(reinterpret_cast<char*>(part.data()), std::streamsize(count))) return too_few();
    if (const auto added = add(std::span(part).first(count)); !added) return added;
    bytes -= count;
  }
  return {};
}

Expected<void> Spool::IncomingScene::finish() {
  const auto scene = state_->reader.finish();
  if (!scene) return fail("the scene that came is damaged: " + scene.error().message);
  if (const std::string hash = manifest_of(*scene).hash; hash != state_->hash)
    return fail(
        fmt::format("the scene that came is damaged: its hash is {} instead of {}", hash, state_->hash));
  if (fsync(state_->descriptor) != 0) return cannot_write(state_->temporary, errno);
  if (rename(state_->temporary.c_str(), state_->target.c_str()) != 0)
    return cannot_write(state_->target, errno);
  close(std::exchange(state_->descriptor, -1));
  flush_folder(state_->target.parent_path());
  return {};
}

}  // namespace penumbra
