// Who may see the page: whoever shows a token, at a name that this server has.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scheduler/web/http.h"
#include "worker/keys/key_folder.h"

namespace penumbra {

/// Checks an address for the page: host and port. Without keys it must be on the loopback interface.
Expected<void> check_web_address(const std::string& address, bool has_keys);

/// Whether the page at this address is encrypted. On the loopback interface it is not, keys or not: browsers
/// would warn of an authority that they do not know, and nobody else can listen.
bool is_encrypted_at(const std::string& address);

class WebAccess {
 public:
  /// `address`: the address with its actual port. `tokens`: any of them admits. `keys`: for another address
  /// than loopback.
  WebAccess(std::string address, std::vector<std::string> tokens, std::shared_ptr<const Keys> keys);

  /// Whether the Host header names this server. A page of another site whose name leads here (DNS rebinding)
  /// has another one.
  [[nodiscard]] bool is_own_name(std::string_view host_header) const;
  /// Whether the text is one of the tokens.
  [[nodiscard]] bool is_token(std::string_view text) const;
  /// Whether the request shows a token: as bearer, or by the cookie.
  [[nodiscard]] bool admits(const WebRequest& request) const;
  /// The Set-Cookie header for a browser that has shown a token. Its value admits to this page only: other
  /// servers of the same host, whatever their port, get the cookie too.
  [[nodiscard]] std::string cookie() const;

  /// "http://127.0.0.1:8080/". `host`: as others reach it; see reachable_address.
  [[nodiscard]] std::string url() const;

 private:
  [[nodiscard]] std::string cookie_name() const;

  const std::string address_;
  const std::vector<std::string> tokens_;
  const std::shared_ptr<const Keys> keys_;  // null: not encrypted
  std::vector<std::string> cookie_values_;
};

}  // namespace penumbra
