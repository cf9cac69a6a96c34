// The connection of one browser: a socket, or TLS over it. It bounds what a request and a slow peer may take.
#pragma once

#include <openssl/types.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "kernels/host/error.h"
#include "kernels/host/owned_descriptor.h"
#include "worker/keys/key_folder.h"

namespace penumbra {

/// The server's side of TLS 1.2 and 1.3 with the certificate of these keys. Browsers show no certificate.
/// Error: OpenSSL's.
Expected<std::shared_ptr<SSL_CTX>> make_tls_context(const Keys& keys);

struct ConnectionLimits {
  std::size_t request_bytes = std::size_t(16) << 10;  ///< of a request, which has no body
  /// For the handshake, for a whole request, and for a peer that takes nothing of what it is sent.
  std::chrono::milliseconds patience{10000};
};

/// For one thread.
class ClientConnection {
 public:
  /// Takes a non-blocking socket. `tls` may be null.
  ClientConnection(int descriptor, SSL_CTX* tls, ConnectionLimits limits = {});
  ClientConnection(const ClientConnection&) = delete;
  ClientConnection& operator=(const ClientConnection&) = delete;
  ~ClientConnection();

  /// Shakes hands if this is TLS. Returns whether it succeeded.
  bool begin();
  /// Waits for the next request, at most `patience`. From then on the limits of a request count. Returns
  /// false if there is none, or the peer has gone.
  bool wait_for_request(std::chrono::milliseconds patience);
  /// Reads what has come, at most `room.size()` bytes. Returns 0 if the peer has ended the connection, and -1
  /// on an error or beyond a limit.
  std::ptrdiff_t read(std::span<char> room);
  /// Sends all of it. Returns false if the peer has gone or takes nothing.
  bool write(std::string_view bytes);
  /// Whether the peer is still there.
  [[nodiscard]] bool is_open() const;

  [[nodiscard]] int descriptor() const { return socket_.get(); }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] bool wait(short events, Clock::time_point until) const;
  /// What to wait for after a call of OpenSSL returned `result`; 0: it has failed.
  [[nodiscard]] short wanted(int result) const;

  OwnedDescriptor socket_;
  const ConnectionLimits limits_;
  std::unique_ptr<SSL, void (*)(SSL*)> tls_;  // null: not encrypted
  std::size_t bytes_left_ = 0;                // of the request
  Clock::time_point deadline_{};
};

}  // namespace penumbra
