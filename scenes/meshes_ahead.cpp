#include "scenes/meshes_ahead.h"

#include <xxhash.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <string>

namespace penumbra {
namespace {

std::pair<std::uint64_t, std::uint64_t> digest_of(const std::string& text) {
  const XXH128_hash_t digest = XXH3_128bits(text.data(), text.size());
  return {digest.high64, digest.low64};
}

Expected<MeshFile> parse(const MeshRequest& request, const SourceFile& file) {
  auto read =
      request.format == MeshRequest::Format::kPly ? read_ply(file, request.attributes) : read_obj(file);
  // The text, which may take more memory than the mesh, will be gone.
  if (read)
    for (OddFaces* odd :
         {&read->faces.warped, &read->faces.tangled, &read->faces.too_short, &read->faces.untextured})
      odd->first = {};
  return read;
}

}  // namespace

MeshesAhead::Key MeshesAhead::key_of(const MeshRequest& request) {
  return {request.file, request.format, request.attributes.vertex, request.attributes.face};
}

MeshesAhead::MeshesAhead(const std::vector<MeshRequest>& requests, const FileAccess& files, unsigned helpers,
                         std::size_t most_bytes)
    : most_bytes_(most_bytes), files_(files) {
  for (const MeshRequest& request : requests) {
    Slot*& slot = by_key_[key_of(request)];
    if (slot == nullptr) slot = &slots_.emplace_back(Slot{.request = request});
    ++slot->uses;
  }
  next_ = slots_.begin();
  const std::size_t useful = slots_.empty() ? 0 : slots_.size() - 1;
  for (std::size_t i = 0; i < std::min<std::size_t>(helpers, useful); ++i)
    helpers_.emplace_back([this, own = files] { help(own); });
}

MeshesAhead::~MeshesAhead() {
  {
    const std::lock_guard lock(mutex_);
    stops_ = true;
  }
  changed_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void MeshesAhead::help(const FileAccess& files) {
  std::unique_lock lock(mutex_);
  do {
    changed_.wait(lock, [&] { return stops_ || held_bytes_ <= most_bytes_; });
  } while (!stops_ && read_next(files, lock));
}

/// Reads the next mesh that nobody has begun to read, with the lock open. False: there is none.
bool MeshesAhead::read_next(const FileAccess& files, std::unique_lock<std::mutex>& lock) {
  next_ = std::find_if(next_, slots_.end(), [](const Slot& slot) { return slot.state == State::kWaiting; });
  if (next_ == slots_.end()) return false;
  Slot& slot = *next_;
  slot.state = State::kReading;
  lock.unlock();
  std::unique_ptr<SourceFile> file;
  std::optional<Expected<MeshFile>> mesh;
  try {
    if (auto read = files.read(slot.request.file, kMaxMeshFileBytes)) file = std::move(*read);
    if (file) mesh = parse(slot.request, *file);
  } catch (const std::exception&) {
    mesh.reset();  // no memory: whoever asks for the mesh finds out
  }
  if (mesh) {
    store(slot, *file, std::move(*mesh));
  } else {
    const std::lock_guard found(mutex_);
    slot.state = State::kRead;
  }
  changed_.notify_all();
  lock.lock();
  return true;
}

void MeshesAhead::store(Slot& slot, const SourceFile& file, Expected<MeshFile> mesh) {
  const Digest text = digest_of(file.text);
  const std::lock_guard lock(mutex_);
  slot.text = text;
  slot.bytes = file.text.size();
  slot.mesh = std::move(mesh);
  slot.state = State::kRead;
  held_bytes_ += slot.bytes;
}

Expected<MeshFile> MeshesAhead::read(const MeshRequest& request, const SourceFile& file) {
  const auto found = by_key_.find(key_of(request));
  if (found == by_key_.end()) return parse(request, file);
  Slot& slot = *found->second;
  std::unique_lock lock(mutex_);
  if (slot.state == State::kWaiting) {
    slot.state = State::kReading;
    lock.unlock();
    auto mesh = parse(request, file);
    if (slot.uses <= 1) {
      lock.lock();
      slot.state = State::kRead;  // without the mesh: whoever asks once more reads it again
      return mesh;
    }
    store(slot, file, std::move(mesh));
    lock.lock();
  }
  // Another mesh is read while a helper reads this one.
  while (slot.state != State::kRead)
    if (held_bytes_ > most_bytes_ || !read_next(files_, lock)) changed_.wait(lock);
  if (!slot.mesh || slot.text != digest_of(file.text)) {
    lock.unlock();
    return parse(request, file);
  }
  if (--slot.uses > 0) return *slot.mesh;
  held_bytes_ -= slot.bytes;
  Expected<MeshFile> mesh = std::move(*slot.mesh);
  slot.mesh.reset();
  lock.unlock();
  changed_.notify_all();
  return mesh;
}

}  // namespace penumbra
