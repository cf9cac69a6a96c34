#include "worker/protocol/client.h"

#include <fmt/format.h>
#include <grpcpp/create_channel.h>

#include <chrono>

#include "worker/keys/tcp_address.h"
#include "worker/protocol/token.h"
#include "worker/protocol/wire.h"

namespace penumbra {
namespace {

// In milliseconds. Schedulers accept pings twice as often; see server.cpp.
constexpr int kAliveInterval = 20'000, kAlivePatience = 10'000;
constexpr int kTimeToHandshake = 10'000;

std::shared_ptr<grpc::ChannelCredentials> credentials(const Keys* keys) {
  if (keys == nullptr) return grpc::InsecureChannelCredentials();
  return grpc::SslCredentials(
      {.pem_root_certs = keys->authority, .pem_private_key = keys->key, .pem_cert_chain = keys->certificate});
}

}  // namespace

std::shared_ptr<grpc::Channel> open_channel(const std::string& address, const Keys* keys,
                                            const ConnectPace& pace) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxMessageBytes);
  // gRPC's default pause of one second between attempts is too long here.
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, int(pace.first.count()));
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, int(pace.most.count()));
  // The time limit of one connection attempt.
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, kTimeToHandshake);
  // Channels share neither connections nor earlier failures to reach the address.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  if (is_tcp(address)) {
    // If a host is cut off from the network, its connections do not end by themselves.
    arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, kAliveInterval);
    arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kAlivePatience);
  }
  // Connect directly: no proxy from the environment, no look-up of a service configuration.
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  arguments.SetInt(GRPC_ARG_SERVICE_CONFIG_DISABLE_RESOLUTION, 1);
  // gRPC does not interpret ":7000" and names with a scheme as hosts.
  const std::string target = is_tcp(address) ? "dns:///" + address : address;
  return grpc::CreateCustomChannel(target, credentials(keys), arguments);
}

void show_token(grpc::ClientContext& context, const std::string& token) {
  if (!token.empty()) context.AddMetadata(kTokenKey, token_metadata(token));
}

std::string status_text(const grpc::Status& status) {
  switch (status.error_code()) {  // codes that our services never use in answers
    case grpc::StatusCode::UNAVAILABLE:
    case grpc::StatusCode::CANCELLED:
      return "the connection broke";
    case grpc::StatusCode::DEADLINE_EXCEEDED:
      return "there was no answer in time";
    case grpc::StatusCode::UNIMPLEMENTED:
      return "it does not know the request: it is another program, or another release";
    case grpc::StatusCode::INTERNAL:
    case grpc::StatusCode::UNKNOWN:
      return "its answer makes no sense: it is another program, or the connection is damaged";
    case grpc::StatusCode::ABORTED:
    case grpc::StatusCode::DATA_LOSS:
    case grpc::StatusCode::OUT_OF_RANGE:
      return "the connection is damaged";
    default:
      break;
  }
  // Codes of our services that gRPC uses as well.
  const std::string& text = status.error_message();
  if (text.find("larger than max") != std::string::npos)
    return fmt::format("a message has more than {} MiB: it is another program, or another release",
                       kMaxMessageBytes >> 20);
  if (text.starts_with("Received http2 header")) return "what answers is another program, such as a proxy";
  return text;
}

}  // namespace penumbra
