#include "worker/protocol/scene_fetch.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "kernels/host/content_hash.h"
#include "worker/protocol/client.h"
#include "worker/protocol/wire.h"

namespace penumbra {
namespace {

// The largest scenes have some GB, and slow networks some MB per second.
constexpr std::chrono::minutes kTimeToFetch{60};
constexpr std::chrono::seconds kTimeForManifest{60};

std::span<const std::uint8_t> bytes_of_chunk(const wire::AssetChunk& chunk) {
  return {reinterpret_cast<const std::uint8_t*>(chunk.data().data()), chunk.data().size()};
}

std::string with_cause(const std::string& hash, const grpc::Status& status) {
  return fmt::format("cannot fetch the scene {}: {}", hash, status_text(status));
}

}  // namespace

/// The current call, which cancel() can cancel.
class SceneFetch::Call {
 public:
  Call(SceneFetch& owner, std::chrono::system_clock::duration limit) : owner_(owner) {
    show_token(context, owner.token_);
    context.set_deadline(std::chrono::system_clock::now() + limit);
    const std::lock_guard lock(owner_.mutex_);
    outer_ = std::exchange(owner_.under_way_, &context);
    if (owner_.cancelled_) context.TryCancel();
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;
  ~Call() {
    const std::lock_guard lock(owner_.mutex_);
    owner_.under_way_ = outer_;
    if (owner_.cancelled_ && outer_ != nullptr) outer_->TryCancel();
  }
  grpc::ClientContext context;

 private:
  SceneFetch& owner_;
  grpc::ClientContext* outer_;
};

/// Receives pieces of an asset in order.
class SceneFetch::Stream {
 public:
  Stream(SceneFetch& owner, const AssetManifest& manifest, std::vector<std::uint32_t> pieces)
      : owner_(owner), manifest_(manifest), pieces_(std::move(pieces)) {}
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() {
    if (!reader_) return;
    call_->context.TryCancel();
    reader_->Finish();
  }

  /// The next piece, complete but not verified.
  Expected<std::vector<std::uint8_t>> next(const AssetPiece& piece) {
    if (!reader_) begin();
    std::vector<std::uint8_t> bytes;
    bytes.reserve(piece.size);
    while (bytes.size() < piece.size) {
      if (rest_.empty()) {
        if (!reader_->Read(&chunk_)) return end();
        rest_ = bytes_of_chunk(chunk_);
        continue;
      }
      const auto part = rest_.first(std::min(rest_.size(), piece.size - bytes.size()));
      bytes.insert(bytes.end(), part.begin(), part.end());
      rest_ = rest_.subspan(part.size());
    }
    return bytes;
  }

 private:
  void begin() {
    call_.emplace(owner_, kTimeToFetch);
    wire::AssetRequest request;
    request.set_hash(manifest_.hash);
    for (const std::uint32_t piece : pieces_) request.add_pieces(piece);
    reader_ = owner_.stub_.Asset(&call_->context, request);
  }
  std::unexpected<Error> end() {
    const grpc::Status status = reader_->Finish();
    reader_.reset();
    return fail(status.ok() ? fmt::format("the scene that came is damaged: {} is cut short", manifest_.hash)
                            : with_cause(manifest_.hash, status));
  }

  SceneFetch& owner_;
  const AssetManifest& manifest_;
  const std::vector<std::uint32_t> pieces_;
  std::optional<Call> call_;
  std::unique_ptr<grpc::ClientReader<wire::AssetChunk>> reader_;
  wire::AssetChunk chunk_;
  std::span<const std::uint8_t> rest_;  // the unread part of chunk_
};

void SceneFetch::cancel() {
  const std::lock_guard lock(mutex_);
  cancelled_ = true;
  if (under_way_ != nullptr) under_way_->TryCancel();
}

Expected<AssetManifest> SceneFetch::fetch_manifest(const std::string& hash) {
  Call call(*this, kTimeForManifest);
  wire::AssetRequest request;
  request.set_hash(hash);
  wire::AssetManifest reply;
  if (const grpc::Status status = stub_.Manifest(&call.context, request, &reply); !status.ok())
    return fail(with_cause(hash, status));
  return decode(reply, hash);
}

/// Takes a piece from the store, else from the stream. If the store has lost or damaged a piece meanwhile, it
/// is requested separately.
Expected<std::vector<std::uint8_t>> SceneFetch::take_piece(const AssetManifest& manifest, std::size_t index,
                                                           Stream& stream, bool streamed,
                                                           FetchedScene& fetched) {
  const AssetPiece& piece = manifest.pieces[index];
  if (!streamed) {
    if (auto found = store_->read(piece)) {
      if (found->size() == piece.size && content_hash(*found) == piece.hash) {
        fetched.bytes.found += piece.size;
        return std::move(*found);
      }
      store_->reject(piece);
    }
  }
  Expected<std::vector<std::uint8_t>> bytes =
      streamed ? stream.next(piece) : Stream(*this, manifest, {std::uint32_t(index)}).next(piece);
  if (!bytes) return bytes;
  fetched.bytes.fetched += piece.size;
  if (const std::string received = content_hash(*bytes); received != piece.hash)
    return fail(fmt::format("the scene that came is damaged: the hash of a piece is {} instead of {}",
                            received, piece.hash));
  if (store_ != nullptr) store_->keep(piece, *bytes);
  return bytes;
}

Expected<FetchedScene> SceneFetch::fetch(const std::string& hash) {
  Expected<AssetManifest> manifest = fetch_manifest(hash);
  if (!manifest) return std::unexpected(manifest.error());
  std::vector<std::uint32_t> missing;
  std::vector<bool> is_missing;
  std::uint64_t missing_bytes = 0;
  for (std::uint32_t i = 0; i < manifest->pieces.size(); ++i) {
    is_missing.push_back(store_ == nullptr || !store_->may_have(manifest->pieces[i]));
    if (!is_missing.back()) continue;
    missing.push_back(i);
    missing_bytes += manifest->pieces[i].size;
  }
  if (store_ != nullptr) store_->expect(missing_bytes, manifest->bytes());
  Stream stream(*this, *manifest, std::move(missing));
  FetchedScene fetched;
  DeviceSceneReader reader(manifest->bytes());
  for (std::size_t i = 0; i < manifest->pieces.size(); ++i) {
    const AssetPiece& piece = manifest->pieces[i];
    std::span<const std::uint8_t> bytes;
    Expected<std::vector<std::uint8_t>> taken;
    if (!is_missing[i]) bytes = store_->held(piece);
    if (bytes.empty()) {
      taken = take_piece(*manifest, i, stream, is_missing[i], fetched);
      if (!taken) return std::unexpected(taken.error());
      bytes = *taken;
    } else {
      fetched.bytes.found += piece.size;
    }
    if (const Expected<void> added = reader.add(bytes); !added)
      return fail("the scene that came cannot be used: " + added.error().message);
  }
  Expected<DeviceScene> scene = reader.finish();
  if (!scene) return fail("the scene that came cannot be used: " + scene.error().message);
  fetched.scene = std::move(*scene);
  fetched.manifest = std::move(*manifest);
  return fetched;
}

}  // namespace penumbra
