#include "scheduler/web/client_connection.h"

#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

#include "worker/keys/openssl_object.h"

namespace penumbra {

Expected<std::shared_ptr<SSL_CTX>> make_tls_context(const Keys& keys) {
  std::shared_ptr<SSL_CTX> context(SSL_CTX_new(TLS_server_method()), SSL_CTX_free);
  const std::unique_ptr<X509, Freed<X509_free>> certificate(
      PEM_read_bio_X509(pem_reader(keys.certificate).get(), nullptr, nullptr, nullptr));
  const std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>> key(
      PEM_read_bio_PrivateKey(pem_reader(keys.key).get(), nullptr, nullptr, nullptr));
  const bool is_good = context && certificate && key &&
                       SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION) == 1 &&
                       SSL_CTX_use_certificate(context.get(), certificate.get()) == 1 &&
                       SSL_CTX_use_PrivateKey(context.get(), key.get()) == 1;
  ERR_clear_error();
  if (!is_good) return fail("the certificate or its key cannot be used for TLS");
  SSL_CTX_set_mode(context.get(), SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
  SSL_CTX_set_options(context.get(), SSL_OP_NO_RENEGOTIATION);
  return context;
}

ClientConnection::ClientConnection(int descriptor, SSL_CTX* tls, ConnectionLimits limits)
    : socket_(descriptor), limits_(limits), tls_(tls != nullptr ? SSL_new(tls) : nullptr, SSL_free) {
  if (tls_) SSL_set_fd(tls_.get(), descriptor);
}

ClientConnection::~ClientConnection() {
  if (tls_ && SSL_is_init_finished(tls_.get()) == 1) SSL_shutdown(tls_.get());
  ERR_clear_error();
  shutdown(socket_.get(), SHUT_RDWR);  // the acceptor has a duplicate, so closing alone would not end it
}

bool ClientConnection::wait(short events, Clock::time_point until) const {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
    pollfd entry{socket_.get(), events, 0};
    const int ready = poll(&entry, 1, int(std::max<std::int64_t>(left.count(), 0)));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

short ClientConnection::wanted(int result) const {
  const int error = SSL_get_error(tls_.get(), result);
  ERR_clear_error();
  return short(error == SSL_ERROR_WANT_READ ? POLLIN : error == SSL_ERROR_WANT_WRITE ? POLLOUT : 0);
}

bool ClientConnection::begin() {
  const Clock::time_point until = Clock::now() + limits_.patience;
  while (tls_) {
    const int result = SSL_accept(tls_.get());
    if (result == 1) return true;
    const short events = wanted(result);
    if (events == 0 || !wait(events, until)) return false;
  }
  return true;
}

bool ClientConnection::wait_for_request(std::chrono::milliseconds patience) {
  const bool has_some = tls_ && SSL_pending(tls_.get()) > 0;
  if (!has_some && !wait(POLLIN, Clock::now() + patience)) return false;
  bytes_left_ = limits_.request_bytes;
  deadline_ = Clock::now() + limits_.patience;
  return true;
}

std::ptrdiff_t ClientConnection::read(std::span<char> room) {
  room = room.first(std::min(room.size(), bytes_left_));
  if (room.empty()) return -1;
  for (;;) {
    short events = POLLIN;
    std::ptrdiff_t got = 0;
    if (tls_) {
      got = SSL_read(tls_.get(), room.data(), int(room.size()));
      if (got <= 0) events = wanted(int(got));
      if (got <= 0 && events == 0) return 0;
    } else {
      got = recv(socket_.get(), room.data(), room.size(), 0);
      if (got == 0) return 0;
      if (got < 0 && errno == EINTR) continue;
      if (got < 0 && errno != EAGAIN) return -1;
    }
    if (got > 0) {
      bytes_left_ -= std::size_t(got);
      return got;
    }
    if (!wait(events, deadline_)) return -1;
  }
}

bool ClientConnection::write(std::string_view bytes) {
  while (!bytes.empty()) {
    short events = POLLOUT;
    std::ptrdiff_t sent = 0;
    if (tls_) {
      constexpr std::size_t kAtOnce = 1 << 14;  // a record of TLS
      sent = SSL_write(tls_.get(), bytes.data(), int(std::min(bytes.size(), kAtOnce)));
      if (sent <= 0) events = wanted(int(sent));
      if (sent <= 0 && events == 0) return false;
    } else {
      sent = send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent < 0 && errno != EAGAIN) return false;
    }
    if (sent > 0)
      bytes.remove_prefix(std::size_t(sent));
    else if (!wait(events, Clock::now() + limits_.patience))
      return false;
  }
  return true;
}

bool ClientConnection::is_open() const {
  pollfd entry{socket_.get(), POLLRDHUP, 0};
  return poll(&entry, 1, 0) == 0;
}

}  // namespace penumbra
