#include "scheduler/farm/access.h"

#include <fmt/format.h>
#include <grpcpp/security/auth_metadata_processor.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <iterator>
#include <optional>
#include <string_view>
#include <vector>

#include "kernels/host/process.h"
#include "worker/keys/host_names.h"
#include "worker/protocol/token.h"

namespace penumbra {
namespace {

/// Checks the metadata of each call.
class TokenCheck final : public grpc::AuthMetadataProcessor {
 public:
  TokenCheck(const Tokens& tokens, const char* where_tokens_are) : where_tokens_are_(where_tokens_are) {
    for (std::size_t i = 0; i < kTokenKinds.size(); ++i)
      if (const std::string& token = tokens.*kTokenKinds[i].token; !token.empty())
        expected_[i] = token_metadata(token);
    complete_ = true;
  }

  bool IsBlocking() const override { return false; }

  grpc::Status Process(const InputMetadata& metadata, grpc::AuthContext*, OutputMetadata*,
                       OutputMetadata*) override {
    if (!complete_) return grpc::Status::CANCELLED;
    const std::string_view shown = find(metadata, kTokenKey), call = find(metadata, ":path");
    // Compare with all tokens, so that the time does not reveal which one matched.
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < kTokenKinds.size(); ++i)
      if (are_equal_secrets(shown, expected_[i]) && !expected_[i].empty()) found = i;
    if (!found)
      return {grpc::StatusCode::UNAUTHENTICATED,
              fmt::format("the token is missing or wrong; {}", where_tokens_are_)};
    const std::string Tokens::*kind = kTokenKinds[*found].token;
    const std::size_t needed = kind_that(call, kind);
    if (kTokenKinds[needed].token == kind) return grpc::Status::OK;
    return {grpc::StatusCode::PERMISSION_DENIED,
            fmt::format("this token is for {}, and another one for {}; {}", kTokenKinds[*found].what_for,
                        kTokenKinds[needed].what_for, where_tokens_are_)};
  }

 private:
  static std::string_view find(const InputMetadata& metadata, const char* key) {
    const auto found = metadata.find(key);
    return found == metadata.end() ? std::string_view()
                                   : std::string_view(found->second.data(), found->second.size());
  }

  /// Of the tokens that permit the call: the shown one if it is among them.
  static std::size_t kind_that(std::string_view call, const std::string Tokens::*shown) {
    constexpr std::size_t kWatch = 0, kWork = 1, kSubmit = 2;
    const std::string_view name = call.substr(call.rfind('/') + 1);
    const bool submits = shown == &Tokens::submit;
    if (name == "Work") return kWork;
    if (name == "Asset" || name == "Manifest")
      return submits ? kSubmit : shown == &Tokens::work ? kWork : kWatch;
    if (name == "Watch" || name == "Control" || name == "Status") return submits ? kSubmit : kWatch;
    return kSubmit;
  }

  const std::string where_tokens_are_;
  std::array<std::string, kTokenKinds.size()> expected_;  // metadata values; empty: there is no such token
  // gRPC hands this object to its own threads. The thread sanitizer does not see that synchronisation, but
  // sees this one.
  std::atomic<bool> complete_ = false;
};

}  // namespace

std::string unix_path(const std::string& address) { return address.substr(std::string_view("unix:").size()); }

Expected<void> check_listen_address(const std::string& address, bool has_keys) {
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
  if (is_loopback(host) || (has_keys && !host.empty())) return {};
  return fail(fmt::format(
      "cannot listen on {}: other hosts would be let in without encryption. `penumbra keys FOLDER` makes "
      "certificates and tokens; then say --keys FOLDER{}. Or listen on 127.0.0.1:{} and reach it through ssh "
      "-L",
      address, host.empty() ? fmt::format(" --listen 0.0.0.0:{}", port) : "", port));
}

Expected<std::shared_ptr<const Keys>> listening_keys(const std::string& address, const std::string& folder) {
  const bool uses_keys = is_tcp(address) && !folder.empty();
  if (!address.empty())
    if (const auto checked = check_listen_address(address, uses_keys); !checked)
      return fail("--listen: " + checked.error().message);
  if (!uses_keys) return nullptr;
  auto keys = read_keys(folder, KeyRole::kScheduler);
  if (!keys) return fail("--keys: " + keys.error().message);
  return keys;
}

std::string reachable_address(const std::string& address, const Keys* keys) {
  if (!is_tcp(address)) return address;
  const auto [host, port] = split_address(address);
  const bool is_everywhere = host == "0.0.0.0" || host == "[::]";
  const std::string usual = is_everywhere ? host_name() : bare_host(host);
  std::string reached = usual;
  if (keys != nullptr && !is_certificate_for(keys->certificate, usual)) {
    std::vector<std::string> promised = certificate_names(keys->certificate);
    std::erase_if(promised, [](const std::string& name) { return name.starts_with("*."); });
    std::vector<std::string> names = is_everywhere ? host_names() : std::vector<std::string>();
    // Names of the loopback interface first where it listens there, else last.
    const std::vector<std::string> loopback = loopback_names();
    for (const bool is_local : {is_loopback(host), !is_loopback(host)})
      std::ranges::copy_if(promised, std::back_inserter(names), [&](const std::string& name) {
        return (std::ranges::find(loopback, name) != loopback.end()) == is_local;
      });
    const auto found = std::ranges::find_if(
        names, [&](const std::string& name) { return is_certificate_for(keys->certificate, name); });
    if (found != names.end()) reached = *found;
  }
  return fmt::format("{}:{}", reached.contains(':') ? fmt::format("[{}]", reached) : reached, port);
}

std::shared_ptr<grpc::ServerCredentials> token_credentials(const Tokens& tokens, const Keys* keys) {
  std::shared_ptr<grpc::ServerCredentials> credentials;
  if (keys != nullptr) {
    grpc::SslServerCredentialsOptions options(GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
    options.pem_root_certs = keys->authority;
    options.pem_key_cert_pairs.push_back({keys->key, keys->certificate});
    credentials = grpc::SslServerCredentials(options);
  } else {
    // The token check needs credentials. These are for local connections and change nothing on the wire.
    credentials = grpc::experimental::LocalServerCredentials(LOCAL_TCP);
  }
  credentials->SetAuthMetadataProcessor(std::make_shared<TokenCheck>(
      tokens, keys != nullptr ? "tokens are in the folders that `penumbra keys` made for this scheduler"
                              : "the scheduler printed its tokens when it started"));
  return credentials;
}

}  // namespace penumbra
