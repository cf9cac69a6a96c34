// What every client of a scheduler does: connect, and show its token.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <memory>
#include <string>

namespace penumbra {

/// A channel that takes our largest messages and tries again soon, for the scheduler may start a moment
/// later.
std::shared_ptr<grpc::Channel> open_channel(const std::string& address);

/// Shows the token, if there is one, with the call.
void show_token(grpc::ClientContext& context, const std::string& token);

}  // namespace penumbra
