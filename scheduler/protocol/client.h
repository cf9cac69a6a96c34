// What every client of a scheduler does: connect, and fetch a scene.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <chrono>
#include <memory>
#include <string>

#include "kernels/host/device_scene.h"
#include "kernels/host/error.h"
#include "penumbra.grpc.pb.h"
#include "scheduler/keys/key_folder.h"

namespace penumbra {

/// How long a channel pauses between attempts to connect, at first and at most.
struct ConnectPace {
  std::chrono::milliseconds first{20}, most{500};
};

/// A channel that takes our largest messages and tries again soon, for the scheduler may start a moment
/// later. With keys it is encrypted, and both ends show certificates.
std::shared_ptr<grpc::Channel> open_channel(const std::string& address, const Keys* keys = nullptr,
                                            const ConnectPace& pace = {});

/// Shows the token, if there is one, with the call.
void show_token(grpc::ClientContext& context, const std::string& token);

/// The device scene of that content hash; `context` is of this one call. Errors: the scheduler does not have
/// it, or the received data is damaged.
Expected<DeviceScene> fetch_scene(penumbra::v1::Farm::Stub& stub, grpc::ClientContext& context,
                                  const std::string& hash);

}  // namespace penumbra
