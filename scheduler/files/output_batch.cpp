#include "scheduler/files/output_batch.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <utility>

#include "scheduler/files/folder_locks.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

/// Candidates for the folder of files that cannot be written to their place; each is tried if the previous
/// one has no room.
std::vector<fs::path> rescue_folders() {
  std::error_code error;
  const fs::path preferred = fs::temp_directory_path(error);
  std::vector<fs::path> parents;
  for (const fs::path& parent :
       {error ? fs::path("/tmp") : preferred, fs::path("/tmp"), fs::path("/var/tmp")})
    if (std::ranges::find(parents, parent) == parents.end()) parents.push_back(parent);
  return parents;
}

}  // namespace

void OutputBatch::complain(const std::string& text) { errors_ += (errors_.empty() ? "" : "\n") + text; }

void OutputBatch::Entry::write_aside() {
  const auto found = find_target(path);
  if (!found) {
    error = found.error().message;
    return;
  }
  target = *found;
  if (target.kind != FileTarget::Kind::kFile) return;
  auto file = StagedFile::write(target.path, bytes);
  if (file)
    staged.emplace(std::move(*file));
  else
    error = file.error().message;
}

void OutputBatch::Entry::make_and_write_aside(const std::function<Expected<Bytes>()>& make) {
  Expected<Bytes> result = fail("");
  try {
    result = make();
  } catch (const std::exception& exception) {  // usually out of memory
    result = fail(fmt::format("cannot write {}: {}", path.string(), exception.what()));
  }
  if (result) {
    bytes = std::move(*result);
    return write_aside();
  }
  made = false;
  error = result.error().message;
}

void OutputBatch::add(fs::path path, Bytes bytes) {
  Entry& entry = entries_.emplace_back();
  entry.path = std::move(path);
  entry.bytes = std::move(bytes);
  entry.write_aside();
}

void OutputBatch::add_aside(fs::path path, std::function<Expected<Bytes>()> make) {
  Entry& entry = entries_.emplace_back();
  entry.path = std::move(path);
  // If no thread can be started, wait() does the work.
  entry.making = std::async(std::launch::async | std::launch::deferred,
                            [&entry, make = std::move(make)] { entry.make_and_write_aside(make); });
}

void OutputBatch::wait() {
  for (Entry& entry : entries_)
    if (entry.making.valid()) entry.making.get();
}

/// Puts no file in place if one could not be written: an old image beside a new report would be inconsistent.
void OutputBatch::put_in_place() {
  if (!errors_.empty()) {
    for (Entry& entry : entries_) entry.staged.reset();
    return;
  }
  std::vector<fs::path> folders;
  for (const Entry& entry : entries_)
    if (entry.staged) folders.push_back(folder_of(entry.target.path));
  const FolderLocks locks(folders);
  for (Entry& entry : entries_) {
    if (!entry.staged) continue;
    const auto renamed = entry.staged->rename_into_place();
    entry.written = renamed.has_value();
    if (!renamed) complain(renamed.error().message);
  }
}

void OutputBatch::write_directly() {
  for (Entry& entry : entries_) {
    if (!entry.made || entry.target.kind == FileTarget::Kind::kFile) continue;
    const auto done = penumbra::write_directly(entry.target, entry.bytes);
    entry.written = done.has_value();
    if (!done) complain(done.error().message);
  }
}

std::string OutputBatch::rescue() {
  std::string places;
  for (const fs::path& parent : rescue_folders()) {
    if (std::ranges::all_of(entries_, [](const Entry& e) { return e.written || !e.made; })) break;
    std::string folder = (parent / "penumbra-image-XXXXXX").string();
    if (mkdtemp(folder.data()) == nullptr) continue;
    for (Entry& entry : entries_) {
      if (entry.written || !entry.made) continue;
      const fs::path place = fs::path(folder) / entry.path.filename();
      auto staged = StagedFile::write(place, entry.bytes);
      if (!staged || fs::exists(place) || !staged->rename_into_place()) continue;
      entry.written = true;
      places += (places.empty() ? "" : ", ") + place.string();
    }
    rmdir(folder.c_str());  // succeeds only if it is empty
  }
  std::string text = places.empty() ? "" : "; written instead: " + places;
  std::string lost;
  for (const Entry& entry : entries_)
    if (!entry.written && entry.made) lost += (lost.empty() ? "" : ", ") + entry.path.string();
  if (!lost.empty()) text += "; lost, as there is no room in TMPDIR, /tmp or /var/tmp either: " + lost;
  return text;
}

Expected<void> OutputBatch::finish() {
  wait();
  for (const Entry& entry : entries_)
    if (!entry.error.empty()) complain(entry.error);
  put_in_place();
  write_directly();
  if (errors_.empty()) return {};
  const std::string instead = rescue();
  return fail(errors_ + instead);
}

}  // namespace penumbra
