#include "worker/keys/client_access.h"

#include <fmt/format.h>

#include <cstdlib>

#include "worker/keys/address_file.h"
#include "worker/keys/secrets.h"
#include "worker/keys/tcp_address.h"

namespace penumbra {

Expected<void> check_encrypted(const std::string& address, const Keys* keys, KeyRole role) {
  const auto [host, port] = split_address(address);
  if (!is_tcp(address) || keys != nullptr || is_loopback(host)) return {};
  return fail(fmt::format(
      "{} is another host: give --keys (or {}), a copy of the folder '{}' that `penumbra keys` made "
      "for that scheduler; without encryption everybody in between could read the token. Or reach it "
      "through ssh -L as 127.0.0.1:{}",
      address, kKeysVariable, info(role).folder, port));
}

Expected<ClientAccess> client_access(const std::string& address, const std::string& folder, KeyRole role) {
  ClientAccess access;
  if (const char* token = std::getenv(kTokenVariable)) access.token = token;
  unsetenv(kTokenVariable);
  if (!access.token.empty()) keep_out_of_core_dumps();
  if (!is_tcp(address)) return access;
  if (!folder.empty()) {
    Expected<std::shared_ptr<const Keys>> keys = read_keys(folder, role);
    if (!keys) return fail("--keys: " + keys.error().message);
    access.keys = std::move(*keys);
    const Tokens& tokens = access.keys->tokens;
    access.token = role == KeyRole::kWorker ? tokens.work
                   : role == KeyRole::kUser ? tokens.submit
                                            : tokens.watch;
    return access;
  }
  if (!address_file_of(address).empty()) return access;
  if (const auto checked = check_encrypted(address, nullptr, role); !checked)
    return std::unexpected(checked.error());
  return access;
}

}  // namespace penumbra
