// The folder that `penumbra keys` makes: its contents, and reading it.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>

#include "kernels/host/error.h"
#include "worker/keys/certificate.h"

namespace penumbra {

/// A call over TCP must present a token, which determines what it may do. That of a viewer does not permit
/// sending samples.
struct Tokens {
  std::string watch = {};   ///< permits Watch, Control, and fetching the data for them
  std::string work = {};    ///< permits Work, and fetching the data for it
  std::string submit = {};  ///< permits all other calls, and everything that `watch` permits
};

/// For loops over all kinds of tokens.
struct TokenKind {
  const char* name;
  const char* what_for;
  std::string Tokens::*token;
};
inline constexpr std::array<TokenKind, 3> kTokenKinds{{{"watch", "watching", &Tokens::watch},
                                                       {"work", "workers", &Tokens::work},
                                                       {"submit", "submitting", &Tokens::submit}}};

/// The users of keys. Each role has a folder of its own, so that a machine gets only what it needs.
enum class KeyRole { kScheduler, kWorker, kViewer, kUser };

struct KeyRoleInfo {
  KeyRole role;
  const char* folder;
  const char* who;
  CertificateUse use;
  bool watches, works, submits;  ///< which tokens the role has
};
inline constexpr std::array<KeyRoleInfo, 4> kKeyRoles{
    {{KeyRole::kScheduler, "scheduler", "the scheduler", CertificateUse::kServer, true, true, true},
     {KeyRole::kWorker, "worker", "a worker", CertificateUse::kClient, false, true, false},
     {KeyRole::kViewer, "viewer", "a window", CertificateUse::kClient, true, false, false},
     {KeyRole::kUser, "user", "a user who submits", CertificateUse::kClient, true, false, true}}};
const KeyRoleInfo& info(KeyRole role);
/// Whether the role has a token of that kind.
bool has_token(const KeyRoleInfo& role, const TokenKind& kind);

namespace key_files {
inline constexpr const char* kAuthorityFolder = "authority";  ///< its key signs further certificates
inline constexpr const char* kAuthority = "authority.pem";
inline constexpr const char* kCertificate = "certificate.pem";
inline constexpr const char* kKey = "key.pem";
inline std::string token(const std::string& name) { return name + ".token"; }
}  // namespace key_files

/// The credentials of one side of a TLS connection, and the authority that it trusts.
struct Keys {
  std::string authority;         ///< certificate of the trusted authority, PEM
  std::string certificate, key;  ///< PEM
  Tokens tokens;                 ///< those of the role; others are empty
  std::string folder;            ///< where they were read from, for messages
};

/// Reads the keys from `folder`, or from its subfolder for the role if there is one. Errors: a missing file,
/// an invalid token, a file that other users may read, an invalid certificate (see check_certificate). From
/// then on the process writes no core dumps.
Expected<std::shared_ptr<const Keys>> read_keys(const std::filesystem::path& folder, KeyRole role);

}  // namespace penumbra
