// What every client of a scheduler does: connect, and show its token.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/support/status.h>

#include <chrono>
#include <memory>
#include <string>

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

/// What went wrong with a call, for people: the words of whoever answered, and our own where gRPC itself says
/// so. "the connection broke", where that is all there is to say.
std::string status_text(const grpc::Status& status);

}  // namespace penumbra
