#include "scheduler/farm/access.h"

#include <fmt/format.h>
#include <grpcpp/security/auth_metadata_processor.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <string_view>
#include <system_error>

#include "scheduler/protocol/token.h"

namespace penumbra {
namespace {

constexpr int kLargestPort = 65535;

/// In a time that does not depend on where they differ.
bool are_equal(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    difference |= unsigned(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  return difference == 0;
}

/// Looks at the metadata of each call.
class TokenCheck final : public grpc::AuthMetadataProcessor {
 public:
  explicit TokenCheck(const Tokens& tokens)
      : watch_(token_metadata(tokens.watch)),
        work_(token_metadata(tokens.work)),
        submit_(tokens.submit.empty() ? "" : token_metadata(tokens.submit)) {
    complete_ = true;
  }

  bool IsBlocking() const override { return false; }

  grpc::Status Process(const InputMetadata& metadata, grpc::AuthContext*, OutputMetadata*,
                       OutputMetadata*) override {
    if (!complete_) return grpc::Status::CANCELLED;
    const std::string_view shown = find(metadata, kTokenKey), call = find(metadata, ":path");
    const bool watches = are_equal(shown, watch_), works = are_equal(shown, work_),
               submits = !submit_.empty() && are_equal(shown, submit_);
    if (!watches && !works && !submits)
      return {grpc::StatusCode::UNAUTHENTICATED,
              "the token is missing or wrong; the scheduler printed it when it started"};
    const bool is_work = call.ends_with("/Work");
    const bool is_for_submitting =
        call.find(".Jobs/") != std::string_view::npos && !call.ends_with("/Status");
    if (call.ends_with("/Asset") || call.ends_with("/Manifest"))
      return grpc::Status::OK;  // all of them need the scene
    if (is_work ? works : submits || (watches && !is_for_submitting)) return grpc::Status::OK;
    return {grpc::StatusCode::PERMISSION_DENIED,
            fmt::format("this token is for {}; the scheduler printed another one for {}",
                        works     ? "workers"
                        : submits ? "submitting"
                                  : "watching",
                        is_work             ? "workers"
                        : is_for_submitting ? "submitting"
                                            : "watching")};
  }

 private:
  static std::string_view find(const InputMetadata& metadata, const char* key) {
    const auto found = metadata.find(key);
    return found == metadata.end() ? std::string_view()
                                   : std::string_view(found->second.data(), found->second.size());
  }

  const std::string watch_, work_, submit_;
  // gRPC hands this over to threads of its own; unlike its hand-over, the thread sanitizer sees this one.
  std::atomic<bool> complete_ = false;
};

}  // namespace

HostAndPort split_address(std::string_view address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string_view::npos) return {address, {}};
  return {address.substr(0, colon), address.substr(colon + 1)};
}

std::string unix_path(const std::string& address) { return address.substr(std::string_view("unix:").size()); }

bool is_port(std::string_view text) {
  int port = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  return error == std::errc() && end == text.data() + text.size() && port >= 0 && port <= kLargestPort;
}

bool is_tcp(const std::string& address) { return !address.empty() && !address.starts_with("unix:"); }

Expected<void> check_listen_address(const std::string& address) {
  if (!is_tcp(address)) {
    if (address.size() > std::string_view("unix:").size()) return {};
    return fail(fmt::format("cannot listen on '{}': give a path, as in unix:/tmp/render.socket", address));
  }
  const auto [host, port] = split_address(address);
  if (!is_port(port))
    return fail(fmt::format(
        "cannot listen on '{}': give host and port, as in 127.0.0.1:7000, or 0 for any free port, "
        "or unix:/path",
        address));
  if (host == "127.0.0.1" || host == "[::1]" || host == "localhost") return {};
  return fail(fmt::format(
      "cannot listen on {}: other hosts would be let in without encryption. Listen on 127.0.0.1:{} "
      "and reach it through ssh -L",
      address, port));
}

std::string with_port(const std::string& address, int port) {
  return fmt::format("{}:{}", split_address(address).host, port);
}

std::string make_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != ssize_t(bytes.size()))
    throw std::system_error(errno, std::generic_category(), "no random numbers for a token");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

std::shared_ptr<grpc::ServerCredentials> token_credentials(const Tokens& tokens) {
  // The check belongs to credentials. These are of connections within one host: they change nothing on the
  // wire.
  std::shared_ptr<grpc::ServerCredentials> credentials =
      grpc::experimental::LocalServerCredentials(LOCAL_TCP);
  credentials->SetAuthMetadataProcessor(std::make_shared<TokenCheck>(tokens));
  return credentials;
}

}  // namespace penumbra
