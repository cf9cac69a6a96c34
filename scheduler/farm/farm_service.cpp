#include "scheduler/farm/farm_service.h"

#include <fmt/format.h>

#include <algorithm>

#include "scheduler/watch/watch_wire.h"
#include "worker/protocol/text.h"

namespace penumbra {
namespace {

// How often a viewer that has seen everything is checked for a lost connection.
constexpr std::chrono::milliseconds kWatchInterval{500};
grpc::Status no_asset(const wire::AssetRequest& request) {
  return {grpc::StatusCode::NOT_FOUND,
          fmt::format("there is no asset '{}'", wire_text(request.hash(), kLongestName))};
}

std::vector<std::span<const std::uint8_t>> pieces_of(const OfferedAsset& asset) {
  std::vector<std::span<const std::uint8_t>> pieces;
  std::span<const std::uint8_t> rest = asset.head;
  for (const AssetPiece& piece : asset.manifest.pieces) {
    if (rest.empty()) rest = asset.body;
    pieces.push_back(rest.first(piece.size));
    rest = rest.subspan(piece.size);
  }
  return pieces;
}

}  // namespace

// --- State shared by all addresses

void Farm::put(Arrival arrival) {
  const auto* beat = std::get_if<arrivals::Beat>(&arrival);
  if (beat == nullptr) return mailbox.put(std::move(arrival));
  const std::lock_guard lock(beats_mutex_);
  beats_[beat->worker] = beat->parts;
}

std::optional<arrivals::Beat> Farm::take_beat() {
  const std::lock_guard lock(beats_mutex_);
  if (beats_.empty()) return {};
  const auto first = beats_.extract(beats_.begin());
  return arrivals::Beat{first.key(), first.mapped()};
}

void Farm::add_asset(OfferedAsset asset) {
  const std::lock_guard lock(mutex_);
  CountedAsset& counted = assets_[asset.manifest.hash];
  if (counted.users++ == 0) counted.asset = std::make_shared<const OfferedAsset>(std::move(asset));
}

void Farm::remove_asset(const std::string& hash) {
  const std::lock_guard lock(mutex_);
  const auto found = assets_.find(hash);
  if (found != assets_.end() && --found->second.users == 0) assets_.erase(found);
}

std::shared_ptr<const OfferedAsset> Farm::asset(const std::string& hash) {
  const std::lock_guard lock(mutex_);
  const auto found = assets_.find(hash);
  return found == assets_.end() ? nullptr : found->second.asset;
}

std::pair<WorkerId, std::shared_ptr<WorkerConnection>> Farm::open() {
  const std::lock_guard lock(mutex_);
  const WorkerId worker = next_worker_++;
  return {worker, connections_[worker] = std::make_shared<WorkerConnection>(worker, room_)};
}

void Farm::close(WorkerId worker) {
  const std::lock_guard lock(mutex_);
  connections_.erase(worker);
}

std::shared_ptr<WorkerConnection> Farm::connection(WorkerId worker) {
  const std::lock_guard lock(mutex_);
  const auto found = connections_.find(worker);
  return found == connections_.end() ? nullptr : found->second;
}

std::vector<std::shared_ptr<WorkerConnection>> Farm::all_connections() {
  const std::lock_guard lock(mutex_);
  std::vector<std::shared_ptr<WorkerConnection>> all;
  for (const auto& [worker, connection] : connections_) all.push_back(connection);
  return all;
}

void Farm::show(JobId job, std::shared_ptr<WatchBoard> board, bool interactive) {
  {
    const std::lock_guard lock(boards_mutex_);
    boards_[job] = {std::move(board), interactive};
  }
  boards_changed_.notify_all();
}

void Farm::hide(JobId job) {
  const std::lock_guard lock(boards_mutex_);
  boards_.erase(job);
}

std::shared_ptr<WatchBoard> Farm::board(JobId job, std::chrono::milliseconds patience) {
  std::unique_lock lock(boards_mutex_);
  const auto found = [&] { return job == 0 ? boards_.begin() : boards_.find(job); };
  if (job == 0) boards_changed_.wait_for(lock, patience, [&] { return closed_ || !boards_.empty(); });
  return found() == boards_.end() ? nullptr : found()->second.board;
}

void Farm::close_boards() {
  {
    const std::lock_guard lock(boards_mutex_);
    closed_ = true;
  }
  boards_changed_.notify_all();
}

bool Farm::is_closed() {
  const std::lock_guard lock(boards_mutex_);
  return closed_;
}

Expected<JobId> Farm::controlled(JobId job, grpc::StatusCode& code) {
  const std::lock_guard lock(boards_mutex_);
  const auto found = job == 0 ? boards_.begin() : boards_.find(job);
  code = grpc::StatusCode::NOT_FOUND;
  if (found == boards_.end())
    return fail(job == 0 ? "there is no job" : fmt::format("there is no job {}, or it is over", job));
  code = grpc::StatusCode::FAILED_PRECONDITION;
  if (!found->second.interactive) return fail("this render goes its own way: it can be watched only");
  return found->first;
}

std::uint32_t Farm::change_view(JobId job, const View& view) {
  const std::lock_guard lock(view_mutex_);  // so that numbers arrive in order
  const std::uint32_t number = ++last_views_[job];
  mailbox.put(arrivals::ViewChanged{job, {number, view}});
  return number;
}

std::uint32_t Farm::next_view_number(JobId job) {
  const std::lock_guard lock(view_mutex_);
  return ++last_views_[job];
}

// --- The calls

grpc::Status FarmService::Manifest(grpc::ServerContext* context, const wire::AssetRequest* request,
                                   wire::AssetManifest* reply) {
  called(*context);
  const std::shared_ptr<const OfferedAsset> asset = farm_.asset(request->hash());
  if (asset == nullptr) return no_asset(*request);
  encode(asset->manifest, *reply);
  return grpc::Status::OK;
}

grpc::Status FarmService::Asset(grpc::ServerContext* context, const wire::AssetRequest* request,
                                grpc::ServerWriter<wire::AssetChunk>* writer) {
  called(*context);
  const std::shared_ptr<const OfferedAsset> asset = farm_.asset(request->hash());
  if (asset == nullptr) return no_asset(*request);
  const std::vector<std::span<const std::uint8_t>> pieces = pieces_of(*asset);
  if (std::size_t(request->pieces_size()) > pieces.size())
    return {grpc::StatusCode::INVALID_ARGUMENT, "more pieces than the asset has"};
  for (const std::uint32_t index : request->pieces()) {
    if (index >= pieces.size())
      return {grpc::StatusCode::INVALID_ARGUMENT,
              fmt::format("the asset has no piece {}, but {} of them", index, pieces.size())};
    wire::AssetChunk chunk;
    const std::span<const std::uint8_t> piece = pieces[index];
    for (std::size_t at = 0; at < piece.size(); at += kAssetChunkBytes) {
      chunk.set_data(piece.data() + at, std::min(kAssetChunkBytes, piece.size() - at));
      if (!writer->Write(chunk)) return grpc::Status::CANCELLED;
    }
  }
  return grpc::Status::OK;
}

grpc::Status FarmService::Watch(grpc::ServerContext* context, const wire::WatchRequest* request,
                                grpc::ServerWriter<wire::WatchEvent>* writer) {
  called(*context);
  if (const std::string mismatch = version_mismatch(request->protocol_version(), "window");
      !mismatch.empty()) {
    wire::WatchEvent refusal;
    refusal.mutable_refused()->set_reason(mismatch);
    writer->Write(refusal);
    return {grpc::StatusCode::FAILED_PRECONDITION, mismatch};
  }
  std::shared_ptr<WatchBoard> board;
  while (!board && !farm_.is_closed() && !context->IsCancelled()) {
    board = farm_.board(request->job(), kWatchInterval);
    if (!board && request->job() != 0)
      return {grpc::StatusCode::NOT_FOUND, fmt::format("there is no job {}, or it is over", request->job())};
  }
  if (!board) return grpc::Status::CANCELLED;
  WatchBoard::Watcher watcher(*board);
  std::optional<WatchedJob> job;
  while (!job && !watcher.at_end() && !context->IsCancelled()) job = watcher.job(kWatchInterval);
  if (!job || !writer->Write(encode(*job))) return grpc::Status::CANCELLED;
  // Write blocks while the viewer is slow; meanwhile the board keeps only the newest state.
  while (!watcher.at_end() && !context->IsCancelled()) {
    const std::optional<WatchItem> item = watcher.next(kWatchInterval);
    if (item && !writer->Write(encode(*item))) return grpc::Status::CANCELLED;
  }
  return grpc::Status::OK;
}

grpc::Status FarmService::Control(grpc::ServerContext* context, const wire::ControlRequest* request,
                                  wire::ControlReply* reply) {
  called(*context);
  grpc::StatusCode code{};
  if (request->has_want_layers()) {
    const std::shared_ptr<WatchBoard> board = farm_.board(request->job(), std::chrono::milliseconds(0));
    if (board == nullptr) return {grpc::StatusCode::NOT_FOUND, "there is no such job, or it is over"};
    board->want_layers({request->want_layers().names().begin(), request->want_layers().names().end()});
    return grpc::Status::OK;
  }
  const Expected<JobId> job = farm_.controlled(request->job(), code);
  if (!job) return {code, job.error().message};
  if (request->has_want_samples()) {
    farm_.mailbox.put(
        arrivals::SamplesWanted{*job, request->want_samples().view(), request->want_samples().spp()});
    return grpc::Status::OK;
  }
  if (!request->has_change_view())
    return {grpc::StatusCode::INVALID_ARGUMENT, "a request that this scheduler does not know"};
  const Expected<View> view = decode(request->change_view());
  if (!view) return {grpc::StatusCode::INVALID_ARGUMENT, view.error().message};
  reply->set_view(farm_.change_view(*job, *view));
  return grpc::Status::OK;
}

}  // namespace penumbra
