// A listening address of the scheduler. Its number of connections is bounded, and they can be ended.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

/// As many files and connections as this user may have open: workers and what they send need some.
void raise_descriptor_limit();

struct AcceptorLimits {
  /// At once. A new connection replaces the oldest one that has not been admitted. If all have been admitted,
  /// the new one is closed. Workers cost no thread, so there may be many.
  int connections = 1 << 14;
  /// TCP only: of them so many that have not been admitted; further ones replace the oldest of those.
  int strangers = 64;
  /// TCP only: from here on a connection that has not been admitted is closed.
  std::chrono::milliseconds time_to_show_token{10000};
  /// At most one of so many descriptors of this process: others need some, too.
  int share_of_descriptors = 8;
};

/// Listens itself, since gRPC accepts any number of connections. A connection that is handed over belongs to
/// the receiver. A second descriptor stays here: it shows when the connection has ended, and can end it.
class Acceptor {
 public:
  /// `address`: one that check_listen_address lets pass, with keys or without. A Unix socket is reachable by
  /// its owner alone, whatever the umask. Errors: it is taken, or not of this host.
  static Expected<std::unique_ptr<Acceptor>> listen(const std::string& address, AcceptorLimits limits = {},
                                                    bool has_keys = false);
  Acceptor(const Acceptor&) = delete;
  Acceptor& operator=(const Acceptor&) = delete;
  ~Acceptor();

  /// The address with the port that was chosen.
  [[nodiscard]] const std::string& address() const { return address_; }
  /// Begins to accept. `hand_over` gets a non-blocking socket to keep, from a thread of this object.
  void start(std::function<void(int descriptor, int listener)> hand_over);
  /// The peer has shown a token. `peer` is gRPC's name of it, as in "ipv4:127.0.0.1:7000".
  void admit(const std::string& peer);
  /// Accepts no more; what was handed over stays.
  void stop();
  /// Ends all connections at once, also those whose peers do not read what was sent to them.
  void cut_off();

 private:
  using Clock = std::chrono::steady_clock;
  struct Connection {
    int descriptor = -1;
    std::string peer;  // the other end, see peer_name
    Clock::time_point since;
    bool admitted = false;
  };

  Acceptor(std::string address, int listener, AcceptorLimits limits);
  void serve();
  void accept_one();
  void drop(std::size_t index, bool by_force);
  [[nodiscard]] int milliseconds_to_wait();

  const std::string address_;
  const int listener_;
  const AcceptorLimits limits_;
  const bool is_tcp_;
  int wake_ = -1;  // an eventfd
  std::function<void(int, int)> hand_over_;
  std::mutex mutex_;
  std::vector<Connection> connections_;  // oldest first
  std::thread thread_;
};

}  // namespace penumbra
