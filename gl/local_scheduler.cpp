#include "gl/local_scheduler.h"

#include <utility>

namespace penumbra {
namespace {

std::vector<std::string> with_socket(const PrivateSocket& socket, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "preview");
  arguments.insert(arguments.end(), {"--listen", socket.address()});
  return arguments;
}

}  // namespace

LocalScheduler::LocalScheduler(PrivateSocket socket, const std::filesystem::path& penumbra,
                               std::vector<std::string> arguments)
    : socket_(std::move(socket)), process_(penumbra.string(), with_socket(socket_, std::move(arguments))) {}

Expected<std::unique_ptr<LocalScheduler>> LocalScheduler::start(const std::filesystem::path& penumbra,
                                                                std::vector<std::string> arguments) {
  Expected<PrivateSocket> socket = PrivateSocket::create();
  if (!socket) return std::unexpected(socket.error());
  std::unique_ptr<LocalScheduler> local(
      new LocalScheduler(std::move(*socket), penumbra, std::move(arguments)));
  if (const auto started = local->process_.start(); !started) return std::unexpected(started.error());
  return local;
}

Expected<void> LocalScheduler::restart() {
  process_.stop_all();
  if (const auto started = process_.start(); !started) return std::unexpected(started.error());
  return {};
}

std::optional<ChildExit> LocalScheduler::ended() {
  std::vector<ChildExit> exits = process_.reap();
  return exits.empty() ? std::nullopt : std::optional(std::move(exits.front()));
}

}  // namespace penumbra
