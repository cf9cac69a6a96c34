// A TCP relay between a worker and a scheduler on this host. It can be slow, or be cut for a while.
#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace penumbra {

class TcpRelay {
 public:
  /// `target`: "127.0.0.1:port", to which each connection is relayed.
  explicit TcpRelay(const std::string& target);
  TcpRelay(const TcpRelay&) = delete;
  TcpRelay& operator=(const TcpRelay&) = delete;
  ~TcpRelay();

  /// "127.0.0.1:port" to be connected to.
  [[nodiscard]] std::string address() const;
  /// Of each piece of data, in each direction, in their order.
  void set_delay(std::chrono::milliseconds delay) { delay_ms_ = int(delay.count()); }
  /// Bytes a second of each connection to the target, from now on; 0: unlimited. Nearly nothing is buffered.
  void set_rate(int bytes) { rate_ = bytes; }
  /// Nothing goes through, and nothing is lost: as of a network that drops all packets.
  void partition(bool is_cut) { cut_ = is_cut; }

 private:
  void accept_all();
  void relay(int from, int to, bool is_up);

  int target_port_ = 0, listener_ = -1, port_ = 0;
  std::atomic<int> delay_ms_ = 0, rate_ = 0;
  std::atomic<bool> cut_ = false, over_ = false;
  std::vector<std::thread> threads_;  // of the accepting one, which is the last to be joined
  std::thread acceptor_;
};

}  // namespace penumbra
