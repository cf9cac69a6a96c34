#include "scheduler/protocol/client.h"

#include <fmt/format.h>
#include <grpcpp/create_channel.h>

#include <chrono>
#include <cstdint>
#include <span>

#include "scheduler/protocol/token.h"
#include "scheduler/protocol/wire.h"

namespace penumbra {
namespace {

// The largest scenes have some GB, and networks some MB a second.
constexpr std::chrono::minutes kTimeToFetch{60};

}  // namespace

std::shared_ptr<grpc::Channel> open_channel(const std::string& address) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxMessageBytes);
  // gRPC's usual second of pause between attempts is an age here.
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 20);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 20);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 500);
  // No detours: no proxy from the environment, no look-up of a service configuration.
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  arguments.SetInt(GRPC_ARG_SERVICE_CONFIG_DISABLE_RESOLUTION, 1);
  return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
}

void show_token(grpc::ClientContext& context, const std::string& token) {
  if (!token.empty()) context.AddMetadata(kTokenKey, token_metadata(token));
}

Expected<DeviceScene> fetch_scene(wire::Farm::Stub& stub, grpc::ClientContext& context,
                                  const std::string& hash) {
  context.set_deadline(std::chrono::system_clock::now() + kTimeToFetch);
  wire::AssetRequest request;
  request.set_hash(hash);
  const auto reader = stub.Asset(&context, request);
  ContentHash received;
  DeviceSceneReader scene_reader;
  Expected<void> added;
  wire::AssetChunk chunk;
  while (reader->Read(&chunk)) {
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(chunk.data().data()), chunk.data().size());
    received.add(bytes);
    if (added) added = scene_reader.add(bytes);
  }
  if (const grpc::Status status = reader->Finish(); !status.ok()) {
    return fail(fmt::format("cannot fetch the scene {}: {}", hash, status.error_message()));
  }
  if (received.text() != hash) {
    return fail(
        fmt::format("the scene that came is damaged: its hash is {} instead of {}", received.text(), hash));
  }
  Expected<DeviceScene> scene = added ? scene_reader.finish() : std::unexpected(added.error());
  if (!scene) return fail("the scene that came cannot be used: " + scene.error().message);
  return scene;
}

}  // namespace penumbra
