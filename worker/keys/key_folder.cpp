#include "worker/keys/key_folder.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstring>

#include "kernels/host/plain_file.h"
#include "worker/keys/secrets.h"

namespace penumbra {
namespace {

constexpr std::uint64_t kMostBytes = 64 << 10;
constexpr std::size_t kShortestToken = 32, kLongestToken = 256;

/// Error if other users may read the file.
Expected<void> check_private(const std::filesystem::path& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0)
    return fail(fmt::format("cannot read {}: {}", file.string(), std::strerror(errno)));
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return fail(
        fmt::format("{} is open to others (mode {:04o}): chmod 600 it, or make new keys if somebody may "
                    "have read it",
                    file.string(), status.st_mode & 07777));
  return {};
}

Expected<std::string> read_secret(const std::filesystem::path& file) {
  if (const auto checked = check_private(file); !checked) return std::unexpected(checked.error());
  return read_plain_file(file, kMostBytes);
}

Expected<std::string> read_token(const std::filesystem::path& file) {
  Expected<std::string> text = read_secret(file);
  if (!text) return text;
  while (text->ends_with('\n')) text->pop_back();
  const auto is_allowed = [](unsigned char c) { return c > ' ' && c < 0x7f; };
  if (text->size() < kShortestToken || text->size() > kLongestToken ||
      !std::ranges::all_of(*text, is_allowed))
    return fail(fmt::format("{} holds no token: {} to {} letters and digits are one", file.string(),
                            kShortestToken, kLongestToken));
  return text;
}

}  // namespace

bool has_token(const KeyRoleInfo& role, const TokenKind& kind) {
  return kind.token == &Tokens::watch  ? role.watches
         : kind.token == &Tokens::work ? role.works
                                       : role.submits;
}

const KeyRoleInfo& info(KeyRole role) { return *std::ranges::find(kKeyRoles, role, &KeyRoleInfo::role); }

Expected<std::shared_ptr<const Keys>> read_keys(const std::filesystem::path& folder, KeyRole role) {
  const KeyRoleInfo& wanted = info(role);
  std::error_code ignored;
  const std::filesystem::path own =
      std::filesystem::is_directory(folder / wanted.folder, ignored) ? folder / wanted.folder : folder;
  if (!std::filesystem::is_directory(own, ignored))
    return fail(
        fmt::format("there is no folder {}; `penumbra keys {}` makes one", own.string(), folder.string()));
  keep_out_of_core_dumps();
  auto keys = std::make_shared<Keys>();
  keys->folder = own.string();
  for (const auto& [name, part, is_secret] : {std::tuple{key_files::kAuthority, &keys->authority, false},
                                              std::tuple{key_files::kCertificate, &keys->certificate, false},
                                              std::tuple{key_files::kKey, &keys->key, true}}) {
    Expected<std::string> text =
        is_secret ? read_secret(own / name) : read_plain_file(own / name, kMostBytes);
    if (!text) return std::unexpected(text.error());
    *part = std::move(*text);
  }
  if (const auto checked = check_certificate(keys->authority, keys->certificate, keys->key, wanted.use);
      !checked)
    return fail(fmt::format("the certificate {} {}; `penumbra keys` makes new ones",
                            (own / key_files::kCertificate).string(), checked.error().message));
  for (const TokenKind& kind : kTokenKinds) {
    const std::filesystem::path file = own / key_files::token(kind.name);
    if (!has_token(wanted, kind)) continue;
    if (!std::filesystem::exists(file, ignored))
      return fail(
          fmt::format("{} is missing: these are not the keys of {}, which are in the folder '{}' of what "
                      "`penumbra keys` made",
                      file.string(), wanted.who, wanted.folder));
    Expected<std::string> token = read_token(file);
    if (!token) return std::unexpected(token.error());
    keys.get()->tokens.*kind.token = std::move(*token);
  }
  return keys;
}

}  // namespace penumbra
