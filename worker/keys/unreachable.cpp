#include "worker/keys/unreachable.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string_view>

#include "kernels/host/owned_descriptor.h"
#include "worker/keys/openssl_object.h"
#include "worker/keys/tcp_address.h"

namespace penumbra {
namespace {

using std::chrono::milliseconds;

using Context = std::unique_ptr<SSL_CTX, Freed<SSL_CTX_free>>;
using Connection = std::unique_ptr<SSL, Freed<SSL_free>>;

constexpr const char* kSilence = "nothing answers there in time";
constexpr char kTlsAlert = 21;  // the first byte of such a record
constexpr std::string_view kUnix = "unix:";
constexpr unsigned char kHttp2[] = {2, 'h', '2'};  // in ALPN's encoding, RFC 7301

/// Blocks SIGPIPE: OpenSSL writes to sockets without MSG_NOSIGNAL, and the other end may have gone.
class NoPipeSignal {
 public:
  NoPipeSignal() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  NoPipeSignal(const NoPipeSignal&) = delete;
  NoPipeSignal& operator=(const NoPipeSignal&) = delete;
  ~NoPipeSignal() {
    const timespec at_once{};
    while (sigtimedwait(&pipe_, nullptr, &at_once) > 0) {
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }

 private:
  sigset_t pipe_{}, before_{};
};

struct CertificateProblem {
  std::string host, text;
};

/// The errno of connecting; 0 on success.
int connect_in_time(int descriptor, const addrinfo& to, milliseconds patience) {
  if (connect(descriptor, to.ai_addr, to.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  pollfd entry{.fd = descriptor, .events = POLLOUT, .revents = 0};
  if (poll(&entry, 1, int(patience.count())) <= 0) return ETIMEDOUT;
  int error = 0;
  socklen_t size = sizeof error;
  getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

/// Stores the problem's text with the connection, because the certificate is gone after a failed handshake.
int note_failure(int is_verified, X509_STORE_CTX* verification) {
  if (is_verified == 1) return 1;
  const auto* ssl =
      static_cast<SSL*>(X509_STORE_CTX_get_ex_data(verification, SSL_get_ex_data_X509_STORE_CTX_idx()));
  auto& problem = *static_cast<CertificateProblem*>(SSL_get_app_data(ssl));
  // Names the certificate itself, not that of an unknown authority.
  X509* certificate = X509_STORE_CTX_get0_cert(verification);
  problem.text = verification_text(X509_STORE_CTX_get_error(verification), certificate, problem.host);
  return 0;
}

Context make_context(const Keys* keys) {
  Context context(SSL_CTX_new(TLS_client_method()));
  SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION);
  SSL_CTX_set_alpn_protos(context.get(), kHttp2, sizeof kHttp2);
  if (keys == nullptr) return context;
  X509* authority = PEM_read_bio_X509(pem_reader(keys->authority).get(), nullptr, nullptr, nullptr);
  X509* certificate = PEM_read_bio_X509(pem_reader(keys->certificate).get(), nullptr, nullptr, nullptr);
  EVP_PKEY* key = PEM_read_bio_PrivateKey(pem_reader(keys->key).get(), nullptr, nullptr, nullptr);
  if (authority != nullptr) X509_STORE_add_cert(SSL_CTX_get_cert_store(context.get()), authority);
  if (certificate != nullptr) SSL_CTX_use_certificate(context.get(), certificate);
  if (key != nullptr) SSL_CTX_use_PrivateKey(context.get(), key);
  X509_free(authority);
  X509_free(certificate);
  EVP_PKEY_free(key);
  SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, note_failure);
  return context;
}

/// Repeats an OpenSSL step on a non-blocking socket until it is done, or until nothing arrives for
/// `patience`.
template <typename Step>
bool finish(SSL* ssl, int descriptor, milliseconds patience, Step step) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  for (;;) {
    ERR_clear_error();
    const int done = step();
    if (done > 0) return true;
    const int reason = SSL_get_error(ssl, done);
    if (reason != SSL_ERROR_WANT_READ && reason != SSL_ERROR_WANT_WRITE) return false;
    const auto left =
        std::chrono::duration_cast<milliseconds>(deadline - std::chrono::steady_clock::now()).count();
    pollfd entry{
        .fd = descriptor, .events = short(reason == SSL_ERROR_WANT_READ ? POLLIN : POLLOUT), .revents = 0};
    if (left <= 0 || poll(&entry, 1, int(left)) <= 0) {
      errno = ETIMEDOUT;
      return false;
    }
  }
}

/// The text for a connection that failed while or after this side's certificate was sent.
std::string refusal_text(const Keys& keys, bool met_tls) {
  switch (ERR_GET_REASON(ERR_peek_error())) {
    case SSL_R_SSLV3_ALERT_CERTIFICATE_EXPIRED:
      return fmt::format("the scheduler takes the certificate in {} for expired", keys.folder);
    case SSL_R_TLSV1_ALERT_UNKNOWN_CA:
      return fmt::format(
          "the scheduler does not know the authority of the certificate in {}: its keys are others",
          keys.folder);
    case SSL_R_WRONG_VERSION_NUMBER:
    case SSL_R_HTTP_REQUEST:
      return "the scheduler there does not speak TLS: it was started without --keys";
    default:
      if (!met_tls)
        return "what listens there ended the connection at once: it is ending, no scheduler with keys, or "
               "more "
               "come at a time than it takes";
      return fmt::format(
          "the scheduler ended the connection when it had seen the certificate in {}: most likely its "
          "keys are of another `penumbra keys`, or this side's have expired there",
          keys.folder);
  }
}

std::string explain_tls(int descriptor, const std::string& host, const Keys* keys, milliseconds patience) {
  const Context context = make_context(keys);
  const Connection ssl(SSL_new(context.get()));
  const std::string name = bare_host(host);
  CertificateProblem problem{.host = name, .text = {}};
  SSL_set_app_data(ssl.get(), &problem);
  SSL_set_fd(ssl.get(), descriptor);
  if (X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(ssl.get()), name.c_str()) != 1) {
    SSL_set1_host(ssl.get(), name.c_str());
    SSL_set_tlsext_host_name(ssl.get(), name.c_str());
  }
  const bool is_connected = finish(ssl.get(), descriptor, patience, [&] { return SSL_connect(ssl.get()); });
  const int timed_out = errno == ETIMEDOUT;
  if (keys == nullptr) {
    // If a certificate was received, the other end uses TLS, whatever happened then.
    if (is_connected || SSL_get0_peer_certificate(ssl.get()) != nullptr)
      return "the scheduler there asks for TLS: give --keys";
    return "";
  }
  const bool met_tls = SSL_get0_peer_certificate(ssl.get()) != nullptr;
  if (!problem.text.empty()) return "the scheduler's certificate " + problem.text;
  if (!is_connected) return timed_out != 0 ? kSilence : refusal_text(*keys, met_tls);
  // With TLS 1.3 the server checks our certificate only after the handshake, and then answers.
  char byte = 0;
  if (finish(ssl.get(), descriptor, patience, [&] { return SSL_read(ssl.get(), &byte, 1); })) return "";
  return errno == ETIMEDOUT && ERR_peek_error() == 0 ? kSilence : refusal_text(*keys, true);
}

/// What an HTTP/2 client sends first: the preface and empty settings (RFC 9113, 3.4).
constexpr std::string_view kHttp2Begin("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\4\0\0\0\0\0", 33);
constexpr std::size_t kTypeOfFrame = 3;  // its place in a frame
constexpr char kSettingsFrame = 4;

/// Speaks HTTP/2 without TLS. A scheduler without keys answers with its settings.
std::string explain_plain(int descriptor, milliseconds patience) {
  if (send(descriptor, kHttp2Begin.data(), kHttp2Begin.size(), MSG_NOSIGNAL) < 0) return "";
  char answer[kTypeOfFrame + 1];
  pollfd entry{.fd = descriptor, .events = POLLIN, .revents = 0};
  if (poll(&entry, 1, int(patience.count())) <= 0) return kSilence;
  const auto length = recv(descriptor, answer, sizeof answer, MSG_DONTWAIT);
  const bool is_http2 = length == sizeof answer && answer[kTypeOfFrame] == kSettingsFrame;
  if (length <= 0 || is_http2 || answer[0] == kTlsAlert) return "";
  return "what answers there is no scheduler";
}

std::string why_unix_fails(const std::string& path) {
  const OwnedDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  if (socket.get() < 0 || path.size() >= sizeof to.sun_path) return "";
  std::copy(path.begin(), path.end(), to.sun_path);
  if (connect(socket.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) return "";
  if (errno == ENOENT || errno == ECONNREFUSED) return kNobodyListens;
  return std::strerror(errno);
}

}  // namespace

std::string why_unreachable(const std::string& address, const Keys* keys, milliseconds patience) {
  if (address.starts_with(kUnix)) return why_unix_fails(address.substr(kUnix.size()));
  if (!is_tcp(address)) return "";
  const NoPipeSignal none;
  const auto [host, port] = split_address(address);
  addrinfo hints{}, *found = nullptr;
  hints.ai_socktype = SOCK_STREAM;
  if (const int error = getaddrinfo(bare_host(host).c_str(), std::string(port).c_str(), &hints, &found);
      error != 0)
    return fmt::format("no address of '{}': {}", host, gai_strerror(error));
  const std::unique_ptr<addrinfo, Freed<freeaddrinfo>> all(found);
  std::string why;
  for (const addrinfo* to = found; to != nullptr; to = to->ai_next) {
    OwnedDescriptor socket(::socket(to->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    int error = socket.get() < 0 ? errno : connect_in_time(socket.get(), *to, patience);
    if (error == 0 && keys == nullptr) {
      if (const std::string reason = explain_plain(socket.get(), patience); !reason.empty()) return reason;
      socket = OwnedDescriptor(::socket(to->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
      error = socket.get() < 0 ? errno : connect_in_time(socket.get(), *to, patience);
    }
    if (error == 0) {
      std::string reason = explain_tls(socket.get(), std::string(host), keys, patience);
      ERR_clear_error();
      return reason;
    }
    why = error == ECONNREFUSED ? kNobodyListens : std::strerror(error);
  }
  return why;
}

}  // namespace penumbra
