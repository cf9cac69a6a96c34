// A listening socket of the scheduler. It limits the number of connections, and it can end them.
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

/// Raises the limit on open file descriptors as far as this user may. Every worker needs a connection, and
/// results need some memory mappings and files.
void raise_descriptor_limit();

struct AcceptorLimits {
  /// Limit on simultaneous connections. At the limit a new connection replaces the oldest one that has not
  /// been admitted. If all have been admitted, the new one is closed. A worker needs no thread here, so there
  /// may be many.
  int connections = 1 << 14;
  /// TCP only: limit on connections that have not been admitted. Further ones replace the oldest of them.
  int strangers = 64;
  /// TCP only: a connection that has not been admitted after this time is closed.
  std::chrono::milliseconds time_to_show_token{10000};
  /// Connections use at most one of so many file descriptors of this process, because others are needed too.
  int share_of_descriptors = 8;
};

/// Accepts connections itself, because gRPC would accept any number of them. A connection that is handed over
/// belongs to the receiver. This class keeps a duplicate of its descriptor, with which it notices the end of
/// the connection and can end it.
class Acceptor {
 public:
  /// `address` must have passed check_listen_address, with or without keys. A Unix socket is accessible only
  /// to its owner, whatever the umask. Errors: the address is in use, or does not belong to this host.
  static Expected<std::unique_ptr<Acceptor>> listen(const std::string& address, AcceptorLimits limits = {},
                                                    bool has_keys = false);
  Acceptor(const Acceptor&) = delete;
  Acceptor& operator=(const Acceptor&) = delete;
  ~Acceptor();

  /// The address, with the actual port if port 0 was requested.
  [[nodiscard]] const std::string& address() const { return address_; }
  /// Begins to accept. `hand_over` is called from a thread of this object and takes ownership of a
  /// non-blocking socket.
  void start(std::function<void(int descriptor, int listener)> hand_over);
  /// The peer has shown a valid token. `peer` is gRPC's name of it, such as "ipv4:127.0.0.1:7000".
  void admit(const std::string& peer);
  /// The same for a connection that was handed over, by its descriptor.
  void admit(int descriptor);
  /// Stops accepting. Existing connections stay open.
  void stop();
  /// Ends all connections at once, including those whose peers do not read what was sent to them.
  void cut_off();

 private:
  using Clock = std::chrono::steady_clock;
  struct Connection {
    int descriptor = -1;
    std::string peer;  // the other end; see peer_name
    Clock::time_point since;
    bool admitted = false;
  };

  Acceptor(std::string address, int listener, AcceptorLimits limits);
  void serve();
  void accept_one();
  void drop(std::size_t index, bool by_force);
  void admit_named(const std::string& name);
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
