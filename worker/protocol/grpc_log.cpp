#include "worker/protocol/grpc_log.h"

#include <fmt/format.h>
#include <google/protobuf/stubs/logging.h>
#include <grpc/grpc.h>
#include <grpc/support/log.h>

#include <cstdlib>
#include <string_view>

#include "kernels/host/console.h"

namespace penumbra {
namespace {

bool is_wanted() {
  static const bool wanted = std::getenv("GRPC_VERBOSITY") != nullptr;
  return wanted;
}

void on_grpc_log(gpr_log_func_args* said) {
  // gRPC aborts after such a message.
  const bool is_fatal = std::string_view(said->message).starts_with("assertion failed");
  if (is_wanted() || is_fatal)
    print_message(fmt::format("gRPC: {}:{}: {}", said->file, said->line, said->message));
}

void on_protobuf_log(google::protobuf::LogLevel level, const char* file, int line,
                     const std::string& message) {
  if (is_wanted() || level == google::protobuf::LOGLEVEL_FATAL)
    print_message(fmt::format("protobuf: {}:{}: {}", file, line, message));
}

}  // namespace

void route_grpc_log() {
  is_wanted();
  gpr_set_log_function(on_grpc_log);
  google::protobuf::SetLogHandler(on_protobuf_log);
}

void keep_grpc_running() {
  static const bool runs = (grpc_init(), true);
  (void)runs;
}

}  // namespace penumbra
