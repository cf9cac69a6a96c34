// The folder that `penumbra keys` makes: what is in it, and reading it.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>

#include "kernels/host/error.h"
#include "scheduler/keys/certificate.h"
#include "scheduler/keys/tokens.h"

namespace penumbra {

/// Who needs keys. Each has a folder of its own, so that a machine gets what it needs and no more.
enum class KeyRole { kScheduler, kWorker, kViewer, kUser };

struct KeyRoleInfo {
  KeyRole role;
  const char* folder;
  const char* who;
  CertificateUse use;
  bool watches, works, submits;  ///< which tokens it has
};
inline constexpr std::array<KeyRoleInfo, 4> kKeyRoles{
    {{KeyRole::kScheduler, "scheduler", "the scheduler", CertificateUse::kServer, true, true, true},
     {KeyRole::kWorker, "worker", "a worker", CertificateUse::kClient, false, true, false},
     {KeyRole::kViewer, "viewer", "a window", CertificateUse::kClient, true, false, false},
     {KeyRole::kUser, "user", "a user who submits", CertificateUse::kClient, true, false, true}}};
const KeyRoleInfo& info(KeyRole role);
/// Whether the role has the token of that kind.
bool has_token(const KeyRoleInfo& role, const TokenKind& kind);

namespace key_files {
inline constexpr const char* kAuthorityFolder = "authority";  ///< its key makes further certificates
inline constexpr const char* kAuthority = "authority.pem";
inline constexpr const char* kCertificate = "certificate.pem";
inline constexpr const char* kKey = "key.pem";
inline std::string token(const std::string& name) { return name + ".token"; }
}  // namespace key_files

/// What one side of a TLS connection shows, and what it believes.
struct Keys {
  std::string authority;         ///< its certificate, PEM: who shows one that it signed is believed
  std::string certificate, key;  ///< PEM
  Tokens tokens;                 ///< those of the role; the others are empty
  std::string folder;            ///< where they were, for messages
};

/// From `folder`, or from its folder of that role where there is one. Errors: what is missing, is not a
/// token, may be read by others than its owner, or is wrong about the certificate (see check_certificate).
/// From here on the process leaves no core dumps.
Expected<std::shared_ptr<const Keys>> read_keys(const std::filesystem::path& folder, KeyRole role);

}  // namespace penumbra
