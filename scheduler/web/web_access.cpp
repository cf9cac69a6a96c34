#include "scheduler/web/web_access.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <algorithm>

#include "scenes/names.h"
#include "scheduler/farm/access.h"
#include "worker/keys/certificate.h"
#include "worker/keys/host_names.h"
#include "worker/keys/secrets.h"
#include "worker/keys/tcp_address.h"

namespace penumbra {
namespace {

constexpr std::string_view kBearer = "Bearer ";

std::string cookie_value(const std::string& token) {
  static constexpr std::string_view kPurpose = "penumbra page";
  unsigned char hash[EVP_MAX_MD_SIZE];
  unsigned size = 0;
  HMAC(EVP_sha256(), token.data(), int(token.size()), reinterpret_cast<const unsigned char*>(kPurpose.data()),
       kPurpose.size(), hash, &size);
  return fmt::format("{:02x}", fmt::join(hash, hash + size, ""));
}

/// The host of a Host header, without its port.
std::string_view host_of(std::string_view header) {
  const std::size_t colon = header.rfind(':');
  const bool has_port = colon != std::string_view::npos && header.find(']', colon) == std::string_view::npos;
  return has_port ? header.substr(0, colon) : header;
}

bool is_any_of(std::string_view text, const std::vector<std::string>& secrets) {
  bool found = false;  // of all, so that the time does not tell which
  for (const std::string& secret : secrets) found |= !secret.empty() && are_equal_secrets(text, secret);
  return found;
}

}  // namespace

Expected<void> check_web_address(const std::string& address, bool has_keys) {
  if (!is_tcp(address))
    return fail(
        fmt::format("cannot listen on '{}': a browser needs host and port, as in 127.0.0.1:8080, or 0 "
                    "for any free port",
                    address));
  return check_listen_address(address, has_keys);
}

bool is_encrypted_at(const std::string& address) { return !is_loopback(split_address(address).host); }

WebAccess::WebAccess(std::string address, std::vector<std::string> tokens, std::shared_ptr<const Keys> keys)
    : address_(std::move(address)),
      tokens_(std::move(tokens)),
      keys_(is_encrypted_at(address_) ? std::move(keys) : nullptr) {
  for (const std::string& token : tokens_)
    if (!token.empty()) cookie_values_.push_back(cookie_value(token));
}

bool WebAccess::is_own_name(std::string_view host_header) const {
  // Names of hosts are the same in capitals, and with the dot of the root at their end (RFC 1035, 2.3.3 and
  // 5.1).
  std::string host = to_lower_case(host_of(host_header));
  if (host.ends_with('.')) host.pop_back();
  if (host.empty()) return false;
  const std::string bare = bare_host(host);
  if (is_loopback(host) || std::ranges::count(loopback_names(), bare) > 0) return true;
  return host == to_lower_case(split_address(address_).host) ||
         (keys_ && is_certificate_for(keys_->certificate, bare));
}

bool WebAccess::is_token(std::string_view text) const { return is_any_of(text, tokens_); }

bool WebAccess::admits(const WebRequest& request) const {
  const std::string_view shown = request.authorization;
  if (shown.starts_with(kBearer) && is_token(shown.substr(kBearer.size()))) return true;
  const std::string name = cookie_name() + "=";
  for (std::string_view rest = request.cookie; !rest.empty();) {
    const std::size_t end = rest.find(';');
    std::string_view one = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    one.remove_prefix(std::min(one.find_first_not_of(' '), one.size()));
    if (one.starts_with(name) && is_any_of(one.substr(name.size()), cookie_values_)) return true;
  }
  return false;
}

// Pages of two farms on one host differ only in their ports, and cookies have none.
std::string WebAccess::cookie_name() const {
  return fmt::format("{}penumbra_{}", keys_ ? "__Host-" : "", split_address(address_).port);
}

std::string WebAccess::cookie() const {
  return fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict{}", cookie_name(),
                     cookie_values_.empty() ? "" : cookie_values_.front(), keys_ ? "; Secure" : "");
}

std::string WebAccess::url() const {
  return fmt::format("{}://{}/", keys_ ? "https" : "http", reachable_address(address_, keys_.get()));
}

}  // namespace penumbra
