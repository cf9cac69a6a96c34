#include "gl/local_scheduler.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

namespace penumbra {
namespace {

constexpr int kPollMilliseconds = 100;
constexpr std::size_t kLongestLine = 4096, kMostLines = 1000;

std::vector<std::string> with_socket(const PrivateSocket& socket, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "preview");
  arguments.insert(arguments.end(), {"--listen", socket.address()});
  return arguments;
}

}  // namespace

LocalScheduler::LocalScheduler(PrivateSocket socket, const std::filesystem::path& penumbra,
                               std::vector<std::string> arguments, int read_end, int write_end)
    : socket_(std::move(socket)),
      read_end_(read_end),
      write_end_(write_end),
      forwarder_([this](const std::stop_token& stop) { forward(stop); }),
      process_(penumbra.string(), with_socket(socket_, std::move(arguments))) {
  process_.send_output_to(write_end);
}

Expected<std::unique_ptr<LocalScheduler>> LocalScheduler::start(const std::filesystem::path& penumbra,
                                                                std::vector<std::string> arguments) {
  Expected<PrivateSocket> socket = PrivateSocket::create();
  if (!socket) return std::unexpected(socket.error());
  std::array<int, 2> pipe{};
  if (pipe2(pipe.data(), O_CLOEXEC) != 0)
    return fail(fmt::format("cannot start '{}': {}", penumbra.string(), std::strerror(errno)));
  std::unique_ptr<LocalScheduler> local(
      new LocalScheduler(std::move(*socket), penumbra, std::move(arguments), pipe[0], pipe[1]));
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

/// Runs on a thread of its own: a child must never wait for the window to read what it writes.
void LocalScheduler::forward(const std::stop_token& stop) {
  std::string line;
  for (bool stopping = false; !stopping;) {
    // What is in the pipe when the stop is requested is forwarded too.
    stopping = stop.stop_requested();
    pollfd entry{.fd = read_end_.get(), .events = POLLIN, .revents = 0};
    while (poll(&entry, 1, stopping ? 0 : kPollMilliseconds) > 0) {
      std::array<char, 4096> bytes;
      const ssize_t got = read(read_end_.get(), bytes.data(), bytes.size());
      if (got <= 0) return;
      const std::string_view text(bytes.data(), std::size_t(got));
      [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text.data(), text.size());
      for (const char c : text) {
        if (c != '\n') {
          if (line.size() < kLongestLine) line += c;
          continue;
        }
        const std::lock_guard lock(mutex_);
        if (lines_.size() < kMostLines) lines_.push_back(line);
        line.clear();
      }
    }
  }
}

std::vector<std::string> LocalScheduler::take_lines() {
  const std::lock_guard lock(mutex_);
  return std::exchange(lines_, {});
}

}  // namespace penumbra
