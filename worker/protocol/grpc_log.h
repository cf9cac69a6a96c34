// Log messages of gRPC and protobuf, and the lifetime of gRPC.
#pragma once

namespace penumbra {

/// Hides these messages unless GRPC_VERBOSITY is set; then they are printed through the console like all
/// others. Lost connections are reported by our own messages. Call it at the start of main, before gRPC is
/// used.
void route_grpc_log();

/// Keeps gRPC initialised for the rest of the process. Otherwise it shuts down with its last channel, which
/// may wait ten seconds for a poll.
void keep_grpc_running();

}  // namespace penumbra
