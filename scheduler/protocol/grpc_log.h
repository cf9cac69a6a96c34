// What gRPC and protobuf have to say for themselves.
#pragma once

namespace penumbra {

/// Nothing of it reaches the user, who is told of lost connections in our words, unless GRPC_VERBOSITY is
/// set: then it goes through the console like any other message. Call at the start of main, before gRPC is
/// used.
void route_grpc_log();

}  // namespace penumbra
