// Log messages of gRPC and protobuf, and how long gRPC lives.
#pragma once

namespace penumbra {

/// Hides these messages unless GRPC_VERBOSITY is set; then they go through the console like any other
/// message. Lost connections are reported by our own messages. Call at the start of main, before gRPC is
/// used.
void route_grpc_log();

/// Starts gRPC for the rest of the process: otherwise it ends with its last channel, which may wait ten
/// seconds for a poll.
void keep_grpc_running();

}  // namespace penumbra
