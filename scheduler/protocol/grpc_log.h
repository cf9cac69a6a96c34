// Log messages of gRPC and protobuf.
#pragma once

namespace penumbra {

/// Hides these messages unless GRPC_VERBOSITY is set; then they go through the console like any other
/// message. Lost connections are reported by our own messages. Call at the start of main, before gRPC is
/// used.
void route_grpc_log();

}  // namespace penumbra
