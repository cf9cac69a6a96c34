#include "scheduler/farm/server.h"

#include <fmt/format.h>
#include <grpcpp/resource_quota.h>
#include <grpcpp/server_builder.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include "scheduler/farm/farm_service.h"
#include "worker/protocol/wire.h"

namespace penumbra {
namespace {

// Time for calls that are about to end when the server ends.
constexpr std::chrono::milliseconds kTimeToEndCalls{300};

constexpr std::chrono::milliseconds kBeatDelay{20};  // how long a beat may wait while nothing else arrives

// The first address is only for this user, so apart from descriptors it needs no limit.
constexpr AcceptorLimits kLimitsOfOwn{.connections = 1 << 16, .share_of_descriptors = 2};
// Limits of the second address. A window has three calls at a time and a worker two; each takes a thread.
constexpr int kMostCalls = 8;  // per connection
constexpr int kMostThreads = 2048;
constexpr int kMostStrangersWithKeys = 2048;
constexpr int kHandshakeMilliseconds = 10'000, kIdleMilliseconds = 300'000;
// Clients send pings half as often; see protocol/client.cpp.
constexpr int kPingMilliseconds = 10'000;
constexpr int kLookaheadBytes = 1 << 20;  // bytes of a message that may arrive before it is read

void set_what_holds_for_all(grpc::ServerBuilder& builder) {
  builder.SetMaxReceiveMessageSize(kMaxRequestBytes);
  // No compression: samples hardly compress, and a small compressed message may expand to a large one.
  for (const grpc_compression_algorithm algorithm : {GRPC_COMPRESS_DEFLATE, GRPC_COMPRESS_GZIP})
    builder.SetCompressionAlgorithmSupportStatus(algorithm, false);
  builder.AddChannelArgument(GRPC_ARG_ENABLE_PER_MESSAGE_DECOMPRESSION, 0);
  // No channelz: its records of connections, which nobody reads, fragment the heap if many come and go.
  builder.AddChannelArgument(GRPC_ARG_ENABLE_CHANNELZ, 0);
}

using Connections = std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor>;

/// Makes a server for the acceptor's connections; null if gRPC does not start.
std::unique_ptr<grpc::Server> start(grpc::ServerBuilder& builder,
                                    const std::shared_ptr<grpc::ServerCredentials>& credentials,
                                    Acceptor& acceptor, Connections& connections) {
  connections = builder.experimental().AddExternalConnectionAcceptor(
      grpc::ServerBuilder::experimental_type::ExternalConnectionType::FROM_FD, credentials);
  std::unique_ptr<grpc::Server> server = builder.BuildAndStart();
  if (server == nullptr) return server;
  acceptor.start([receiver = connections.get()](int descriptor, int listener) {
    grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters connection;
    connection.fd = descriptor;
    connection.listener_fd = listener;
    receiver->HandleNewConnection(&connection);
  });
  return server;
}

std::string cannot_start(const std::string& address) {
  return fmt::format("cannot listen on {}; GRPC_VERBOSITY=error says why", address);
}

}  // namespace

struct Server::State {
  explicit State(const ListenOptions& options)
      : farm(options.room_for_results), comes_back(options.comes_back) {}

  Farm farm;
  Tokens tokens;
  bool comes_back = false;
  std::string more_address;
  // The second address has a server of its own. Its calls that need a thread (watching, assets) take none
  // from the scheduler's own workers.
  std::unique_ptr<Acceptor> own_acceptor, acceptor;
  std::unique_ptr<FarmService> own_service, more_service;
  std::shared_ptr<grpc::Service> further_service;
  Connections own_connections, more_connections;
  std::unique_ptr<grpc::Server> own_server, more_server;
};

Server::Server(std::unique_ptr<State> state) : state_(std::move(state)) {}

Expected<void> Server::listen_for_own(const ListenOptions& options) {
  Expected<std::unique_ptr<Acceptor>> acceptor = Acceptor::listen(options.address, kLimitsOfOwn);
  if (!acceptor) return std::unexpected(acceptor.error());
  state_->own_acceptor = std::move(*acceptor);
  state_->own_service = std::make_unique<FarmService>(state_->farm);
  grpc::ServerBuilder builder;
  set_what_holds_for_all(builder);
  builder.RegisterService(state_->own_service.get());
  state_->own_server =
      start(builder, grpc::InsecureServerCredentials(), *state_->own_acceptor, state_->own_connections);
  if (state_->own_server == nullptr) return fail(cannot_start(options.address));
  return {};
}

Expected<void> Server::listen_for_all(const ListenOptions& options) {
  AcceptorLimits limits = options.limits;
  // The workers of a cluster connect at the same time, and with keys each handshake takes some time.
  if (options.keys) limits.strangers = std::max(limits.strangers, kMostStrangersWithKeys);
  Expected<std::unique_ptr<Acceptor>> acceptor =
      Acceptor::listen(options.more, limits, options.keys != nullptr);
  if (!acceptor) return std::unexpected(acceptor.error());
  state_->acceptor = std::move(*acceptor);
  state_->more_address = state_->acceptor->address();
  std::shared_ptr<grpc::ServerCredentials> credentials = grpc::InsecureServerCredentials();
  if (is_tcp(options.more)) {
    keep_out_of_core_dumps();
    for (const TokenKind& kind : kTokenKinds)
      state_->tokens.*kind.token = options.keys ? options.keys->tokens.*kind.token : make_token();
    if (!options.keys && !options.watch_token.empty()) state_->tokens.watch = options.watch_token;
    credentials = token_credentials(state_->tokens, options.keys.get());
  }
  const auto on_call = [acceptor = state_->acceptor.get()](const std::string& peer) {
    acceptor->admit(peer);
  };
  state_->more_service = std::make_unique<FarmService>(state_->farm, on_call);
  if (options.service) state_->further_service = options.service(on_call);

  grpc::ServerBuilder builder;
  set_what_holds_for_all(builder);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kMostCalls);
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeMilliseconds);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, kIdleMilliseconds);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, kPingMilliseconds);
  // Otherwise the window of a fast sender grows before its data are read.
  builder.AddChannelArgument(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, kLookaheadBytes);
  builder.SetResourceQuota(grpc::ResourceQuota("more").SetMaxThreads(kMostThreads));
  builder.RegisterService(state_->more_service.get());
  if (state_->further_service) builder.RegisterService(state_->further_service.get());
  state_->more_server = start(builder, credentials, *state_->acceptor, state_->more_connections);
  if (state_->more_server == nullptr) return fail(cannot_start(options.more));
  return {};
}

Expected<std::unique_ptr<Server>> Server::listen(const ListenOptions& options) {
  raise_descriptor_limit();
  std::unique_ptr<Server> server(new Server(std::make_unique<State>(options)));
  Expected<void> listens = server->listen_for_own(options);
  if (listens && !options.more.empty()) listens = server->listen_for_all(options);
  if (!listens) return std::unexpected(listens.error());
  return server;
}

void Server::will_come_back() { state_->comes_back = true; }

const std::string& Server::more_address() const { return state_->more_address; }
const Tokens& Server::tokens() const { return state_->tokens; }

Server::~Server() {
  state_->farm.mailbox.close();
  state_->farm.close_boards();
  for (const auto& connection : state_->farm.all_connections())
    connection->dismiss(state_->comes_back ? "the scheduler is stopped" : "the render is over",
                        state_->comes_back);
  for (Acceptor* acceptor : {state_->own_acceptor.get(), state_->acceptor.get()})
    if (acceptor != nullptr) acceptor->stop();
  // A write to a peer that does not read ends only with its connection, and so does its call.
  std::jthread cutter([this](const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    const bool is_over =
        never.wait_for(lock, stop, 2 * kTimeToEndCalls, [&] { return stop.stop_requested(); });
    for (Acceptor* acceptor : {state_->own_acceptor.get(), state_->acceptor.get()})
      if (acceptor != nullptr && !is_over) acceptor->cut_off();
  });
  // A viewer's call that is cancelled may lose what was written last.
  for (const auto& server : {state_->more_server.get(), state_->own_server.get()}) {
    if (server == nullptr) continue;
    server->Shutdown(std::chrono::system_clock::now() + kTimeToEndCalls);
    server->Wait();
  }
}

void Server::add_asset(OfferedAsset asset) { state_->farm.add_asset(std::move(asset)); }

void Server::remove_asset(const std::string& hash) { state_->farm.remove_asset(hash); }

void Server::show_job(JobId job, std::shared_ptr<WatchBoard> board, bool interactive) {
  state_->farm.show(job, std::move(board), interactive);
}

void Server::hide_job(JobId job) { state_->farm.hide(job); }

void Server::send_job(WorkerId worker, JobId job, const std::string& scene_hash,
                      const DeviceOptions& device) {
  if (const auto connection = state_->farm.connection(worker)) connection->send_job(job, scene_hash, device);
}

void Server::forget_job(WorkerId worker, JobId job) {
  if (const auto connection = state_->farm.connection(worker)) connection->forget_job(job);
}

void Server::send_unit(WorkerId worker, const UnitId& id, const RenderUnit& unit, const FilmLayers& layers) {
  if (const auto connection = state_->farm.connection(worker)) connection->send_unit(id, unit, layers);
}

void Server::send_view(WorkerId worker, JobId job, const WatchView& view) {
  if (const auto connection = state_->farm.connection(worker)) connection->send_view(job, view);
}

std::uint32_t Server::next_view_number(JobId job) { return state_->farm.next_view_number(job); }

void Server::dismiss(WorkerId worker, const std::string& reason) {
  if (const auto connection = state_->farm.connection(worker)) connection->dismiss(reason);
}

void Server::refuse(WorkerId worker, const std::string& reason) {
  if (const auto connection = state_->farm.connection(worker)) connection->refuse(reason);
}

void Server::wake() { state_->farm.mailbox.put(arrivals::JobsNotified{}); }

void Server::stop_taking() { state_->farm.mailbox.close(); }

std::optional<Arrival> Server::next(std::chrono::milliseconds patience) {
  for (auto left = patience;; left -= kBeatDelay) {
    if (const auto beat = state_->farm.take_beat()) return *beat;
    std::optional<Arrival> arrival = state_->farm.mailbox.take(std::min(left, kBeatDelay));
    if (arrival || left <= kBeatDelay) return arrival;
  }
}

}  // namespace penumbra
