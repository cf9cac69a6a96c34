// What all clients of a scheduler share: connecting and authenticating.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/support/status.h>

#include <chrono>
#include <memory>
#include <string>

#include "worker/keys/key_folder.h"

namespace penumbra {

/// The pause between connection attempts, initially and at most.
struct ConnectPace {
  std::chrono::milliseconds first{20}, most{500};
};

/// Opens a channel that accepts the largest messages and retries soon, because the scheduler may start a
/// moment later. With keys it is encrypted, and both ends authenticate with certificates.
std::shared_ptr<grpc::Channel> open_channel(const std::string& address, const Keys* keys = nullptr,
                                            const ConnectPace& pace = {});

/// Adds the token, if there is one, to the call's metadata.
void show_token(grpc::ClientContext& context, const std::string& token);

/// The error of a call as text for the user: the peer's message, or our own words for errors of gRPC itself.
/// "the connection broke" if nothing else is known.
std::string status_text(const grpc::Status& status);

}  // namespace penumbra
