#include "scheduler/server.h"

#include <fmt/format.h>
#include <grpcpp/server_builder.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <utility>

#include "scheduler/access.h"
#include "scheduler/protocol/mailbox.h"
#include "scheduler/protocol/wire.h"
#include "scheduler/watch/watch_wire.h"

namespace penumbra {
namespace {

constexpr std::uint32_t kJob = 1;  // one job a run, so far
// How often a watcher that has seen everything looks whether it is still there.
constexpr std::chrono::milliseconds kWatchInterval{500};
// For calls that are about to end when the server does.
constexpr std::chrono::milliseconds kTimeToEnd{300};

using WorkStream = grpc::ServerReaderWriter<wire::SchedulerMessage, wire::WorkerMessage>;

/// One worker's stream: a single reader (the thread of its call), any number of writers.
class Connection {
 public:
  Connection(WorkerId worker, WorkStream* stream) : worker_(worker), stream_(stream) {}

  void send(const wire::SchedulerMessage& message) {
    const std::lock_guard lock(mutex_);
    if (stream_ != nullptr) stream_->Write(message);  // if it fails, the reader notices too
  }

  void send_unit(const UnitId& id, const RenderUnit& unit, int planes) {
    wire::SchedulerMessage message;
    message.mutable_unit()->set_job(kJob);
    encode(id, *message.mutable_unit()->mutable_id());
    encode(unit, *message.mutable_unit());
    const std::lock_guard lock(mutex_);
    expected_[id] = {unit, planes};
    if (stream_ != nullptr) stream_->Write(message);
  }

  void send_view(const WatchView& view) {
    wire::SchedulerMessage message;
    message.mutable_view()->set_number(view.number);
    encode(view.view, *message.mutable_view()->mutable_camera());
    const std::lock_guard lock(mutex_);
    view_ = view.number;
    std::erase_if(expected_, [&](const auto& expected) { return expected.first.image < view_; });
    if (stream_ != nullptr) stream_->Write(message);
  }

  /// Whether a unit is of a view that nobody looks at any more.
  bool is_outdated(const wire::UnitId& id) {
    const std::lock_guard lock(mutex_);
    return id.image() < view_;
  }

  /// The call ends; the stream is about to be destroyed.
  void close() {
    const std::lock_guard lock(mutex_);
    stream_ = nullptr;
  }

  Arrival decode_result(const wire::UnitResult& message) {
    const UnitId id = decode(message.id());
    const std::optional<Expectation> expected = fulfil(id);
    if (!expected || message.job() != kJob) {
      return arrivals::BadResult{worker_, id, "the worker was not asked for this unit"};
    }
    Expected<SampleBuffer> buffer = decode(message, expected->unit, expected->planes);
    if (!buffer) return arrivals::BadResult{worker_, id, buffer.error().message};
    return arrivals::Result{.worker = worker_,
                            .unit = id,
                            .buffer = std::move(*buffer),
                            .hash = result_hash(message),
                            .busy_seconds = message.busy_seconds(),
                            .peak_memory_bytes = message.peak_memory_bytes()};
  }

  Arrival decode_failure(const wire::UnitFailed& message) {
    const UnitId id = decode(message.id());
    if (!fulfil(id)) return arrivals::BadResult{worker_, id, "the worker was not asked for this unit"};
    return arrivals::UnitFailed{worker_, id, message.message()};
  }

 private:
  struct Expectation {
    RenderUnit unit;
    int planes = 0;
  };

  std::optional<Expectation> fulfil(const UnitId& id) {
    const std::lock_guard lock(mutex_);
    const auto found = expected_.extract(id);
    return found ? std::optional(found.mapped()) : std::nullopt;
  }

  const WorkerId worker_;
  std::mutex mutex_;
  WorkStream* stream_;
  std::map<UnitId, Expectation> expected_;
  std::uint32_t view_ = 0;
};

/// The result or the failure of a unit of an older view.
bool is_outdated(Connection& connection, const wire::WorkerMessage& message) {
  return (message.has_result() && connection.is_outdated(message.result().id())) ||
         (message.has_unit_failed() && connection.is_outdated(message.unit_failed().id()));
}

/// What a worker says after its Hello; nothing for a message that is not its to send.
std::optional<Arrival> understand(WorkerId worker, Connection& connection,
                                  const wire::WorkerMessage& message) {
  switch (message.content_case()) {
    case wire::WorkerMessage::kCompiling:
      return arrivals::Compiling{worker, message.compiling().device()};
    case wire::WorkerMessage::kReady:
      return arrivals::Ready{worker, message.ready().device(), decode(message.ready())};
    case wire::WorkerMessage::kJobFailed:
      return arrivals::JobFailed{worker, message.job_failed().message()};
    case wire::WorkerMessage::kResult:
      return connection.decode_result(message.result());
    case wire::WorkerMessage::kUnitFailed:
      return connection.decode_failure(message.unit_failed());
    default:
      return {};
  }
}

/// Sets that this scheduler does not know are left out.
std::vector<Isa> isas_of(const wire::Hello& hello) {
  std::vector<Isa> isas;
  for (const Isa isa : {Isa::kSse2, Isa::kAvx2, Isa::kAvx512})
    if (std::ranges::find(hello.isas(), int(encode(isa))) != hello.isas().end()) isas.push_back(isa);
  return isas;
}

class Service final : public wire::Farm::Service {
 public:
  Service(WatchBoard& board, bool interactive) : board_(board), interactive_(interactive) {}

  Mailbox<Arrival> mailbox;
  std::string token;  // of TCP connections

  grpc::Status Work(grpc::ServerContext* context, WorkStream* stream) override {
    if (grpc::Status status = check_access(*context, token); !status.ok()) return status;
    wire::WorkerMessage message;
    if (!stream->Read(&message)) return grpc::Status::OK;
    if (!message.has_hello()) {
      return {grpc::StatusCode::INVALID_ARGUMENT, "the first message of a worker must be Hello"};
    }
    const wire::Hello hello = message.hello();
    if (const std::string mismatch = version_mismatch(hello.protocol_version(), "worker");
        !mismatch.empty()) {
      wire::SchedulerMessage refusal;
      refusal.mutable_refused()->set_reason(mismatch);
      stream->Write(refusal);
      return {grpc::StatusCode::FAILED_PRECONDITION, mismatch};
    }

    const auto [worker, connection] = open(stream);
    mailbox.put(arrivals::Connected{worker, hello.host(), hello.pid(), isas_of(hello)});
    grpc::Status status = grpc::Status::OK;
    while (stream->Read(&message)) {
      if (is_outdated(*connection, message)) continue;
      std::optional<Arrival> arrival = understand(worker, *connection, message);
      if (!arrival) {
        status = {grpc::StatusCode::INVALID_ARGUMENT, "a message that a worker may not send here"};
        break;
      }
      mailbox.put(std::move(*arrival));
    }
    connection->close();
    {
      const std::lock_guard lock(mutex_);
      connections_.erase(worker);
    }
    mailbox.put(arrivals::Gone{worker});
    return status;
  }

  grpc::Status Asset(grpc::ServerContext* context, const wire::AssetRequest* request,
                     grpc::ServerWriter<wire::AssetChunk>* writer) override {
    if (grpc::Status status = check_access(*context, token); !status.ok()) return status;
    const std::shared_ptr<const std::vector<std::uint8_t>> bytes = asset(request->hash());
    if (bytes == nullptr) {
      return {grpc::StatusCode::NOT_FOUND, fmt::format("there is no asset '{}'", request->hash())};
    }
    wire::AssetChunk chunk;
    for (std::size_t at = 0; at < bytes->size(); at += kAssetChunkBytes) {
      chunk.set_data(bytes->data() + at, std::min(kAssetChunkBytes, bytes->size() - at));
      if (!writer->Write(chunk)) return grpc::Status::CANCELLED;
    }
    return grpc::Status::OK;
  }

  grpc::Status Watch(grpc::ServerContext* context, const wire::WatchRequest* request,
                     grpc::ServerWriter<wire::WatchEvent>* writer) override {
    if (grpc::Status status = check_access(*context, token); !status.ok()) return status;
    if (const std::string mismatch = version_mismatch(request->protocol_version(), "window");
        !mismatch.empty()) {
      wire::WatchEvent refusal;
      refusal.mutable_refused()->set_reason(mismatch);
      writer->Write(refusal);
      return {grpc::StatusCode::FAILED_PRECONDITION, mismatch};
    }
    WatchBoard::Watcher watcher(board_);
    std::optional<WatchedJob> job;
    while (!job && !watcher.at_end() && !context->IsCancelled()) job = watcher.job(kWatchInterval);
    if (!job || !writer->Write(encode(*job))) return grpc::Status::CANCELLED;
    // Write waits while the watcher is slow; meanwhile the board keeps only what is newest.
    while (!watcher.at_end() && !context->IsCancelled()) {
      const std::optional<WatchItem> item = watcher.next(kWatchInterval);
      if (item && !writer->Write(encode(*item))) return grpc::Status::CANCELLED;
    }
    return grpc::Status::OK;
  }

  grpc::Status Control(grpc::ServerContext* context, const wire::ControlRequest* request,
                       wire::ControlReply* reply) override {
    if (grpc::Status status = check_access(*context, token); !status.ok()) return status;
    if (!interactive_)
      return {grpc::StatusCode::FAILED_PRECONDITION, "this render goes its own way: it can be watched only"};
    if (request->has_want_samples()) {
      mailbox.put(arrivals::SamplesWanted{request->want_samples().view(), request->want_samples().spp()});
      return grpc::Status::OK;
    }
    if (!request->has_change_view())
      return {grpc::StatusCode::INVALID_ARGUMENT, "a request that this scheduler does not know"};
    const Expected<View> view = decode(request->change_view());
    if (!view) return {grpc::StatusCode::INVALID_ARGUMENT, view.error().message};
    const std::lock_guard lock(view_mutex_);  // so that numbers arrive in order
    reply->set_view(++last_view_);
    mailbox.put(arrivals::ViewChanged{{last_view_, *view}});
    return grpc::Status::OK;
  }

  void add_asset(std::string hash, std::vector<std::uint8_t> bytes) {
    const std::lock_guard lock(mutex_);
    assets_[std::move(hash)] = std::make_shared<const std::vector<std::uint8_t>>(std::move(bytes));
  }

  std::shared_ptr<Connection> connection(WorkerId worker) {
    const std::lock_guard lock(mutex_);
    const auto found = connections_.find(worker);
    return found == connections_.end() ? nullptr : found->second;
  }

 private:
  std::pair<WorkerId, std::shared_ptr<Connection>> open(WorkStream* stream) {
    const std::lock_guard lock(mutex_);
    const WorkerId worker = next_worker_++;
    return {worker, connections_[worker] = std::make_shared<Connection>(worker, stream)};
  }

  std::shared_ptr<const std::vector<std::uint8_t>> asset(const std::string& hash) {
    const std::lock_guard lock(mutex_);
    const auto found = assets_.find(hash);
    return found == assets_.end() ? nullptr : found->second;
  }

  WatchBoard& board_;
  const bool interactive_;
  std::mutex view_mutex_;
  std::uint32_t last_view_ = 0;
  std::mutex mutex_;
  WorkerId next_worker_ = 1;
  std::map<WorkerId, std::shared_ptr<Connection>> connections_;
  std::map<std::string, std::shared_ptr<const std::vector<std::uint8_t>>> assets_;
};

}  // namespace

struct Server::State {
  State(WatchBoard& board, bool interactive) : service(board, interactive) {}

  Service service;
  std::string more_address;
  std::unique_ptr<grpc::Server> server;
};

Server::Server(std::unique_ptr<State> state) : state_(std::move(state)) {}

Expected<std::unique_ptr<Server>> Server::listen(const ListenOptions& options, WatchBoard& board) {
  auto state = std::make_unique<State>(board, options.interactive);
  grpc::ServerBuilder builder;
  // Two schedulers must not share a port, each with half of the connections.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.AddListeningPort(options.address, grpc::InsecureServerCredentials());
  int port = 0;
  if (!options.more.empty()) {
    if (const Expected<void> checked = check_listen_address(options.more); !checked)
      return std::unexpected(checked.error());
    // gRPC would take the place over and leave the other without its callers.
    if (!is_tcp(options.more) && is_answered(options.more))
      return fail(fmt::format("cannot listen on {}: somebody listens there already", options.more));
    builder.AddListeningPort(options.more, grpc::InsecureServerCredentials(), &port);
    if (is_tcp(options.more)) state->service.token = make_token();
  }
  builder.SetMaxReceiveMessageSize(kMaxMessageBytes);
  builder.RegisterService(&state->service);
  state->server = builder.BuildAndStart();
  if (state->server == nullptr || (!options.more.empty() && port == 0)) {
    const bool both = !options.more.empty();
    return fail(fmt::format("cannot listen on {}{}{}; GRPC_VERBOSITY=error says why", options.address,
                            both ? " and " : "", options.more));
  }
  state->more_address = is_tcp(options.more) ? with_port(options.more, port) : options.more;
  return std::unique_ptr<Server>(new Server(std::move(state)));
}

const std::string& Server::more_address() const { return state_->more_address; }
const std::string& Server::token() const { return state_->service.token; }

Server::~Server() {
  // A watcher's call that is cancelled may lose what was written last.
  state_->server->Shutdown(std::chrono::system_clock::now() + kTimeToEnd);
  state_->server->Wait();
}

std::string Server::add_asset(std::vector<std::uint8_t> bytes) {
  std::string hash = content_hash(bytes);
  state_->service.add_asset(hash, std::move(bytes));
  return hash;
}

void Server::send_job(WorkerId worker, const std::string& scene_hash, const DeviceOptions& device) {
  const auto connection = state_->service.connection(worker);
  if (connection == nullptr) return;
  wire::SchedulerMessage message;
  message.mutable_job()->set_id(kJob);
  message.mutable_job()->set_scene(scene_hash);
  encode(device, *message.mutable_job()->mutable_device());
  connection->send(message);
}

void Server::send_unit(WorkerId worker, const UnitId& id, const RenderUnit& unit, int planes) {
  if (const auto connection = state_->service.connection(worker)) connection->send_unit(id, unit, planes);
}

void Server::send_view(WorkerId worker, const WatchView& view) {
  if (const auto connection = state_->service.connection(worker)) connection->send_view(view);
}

void Server::dismiss(WorkerId worker, const std::string& reason) {
  const auto connection = state_->service.connection(worker);
  if (connection == nullptr) return;
  wire::SchedulerMessage message;
  message.mutable_dismiss()->set_reason(reason);
  connection->send(message);
}

void Server::refuse(WorkerId worker, const std::string& reason) {
  const auto connection = state_->service.connection(worker);
  if (connection == nullptr) return;
  wire::SchedulerMessage message;
  message.mutable_refused()->set_reason(reason);
  connection->send(message);
}

std::optional<Arrival> Server::next(std::chrono::milliseconds patience) {
  return state_->service.mailbox.take(patience);
}

}  // namespace penumbra
