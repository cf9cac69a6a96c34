// Keys for tests: those of a farm, and invalid ones.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "worker/keys/key_folder.h"
#include "worker/keys/secrets.h"

namespace penumbra {

constexpr Validity kGood{.until = std::chrono::hours(24)};
constexpr Validity kPast{.from = -std::chrono::hours(48), .until = -std::chrono::hours(24)};
constexpr Validity kFuture{.from = std::chrono::hours(24), .until = std::chrono::hours(48)};

/// An authority and what it signs, in memory.
class FarmKeys {
 public:
  explicit FarmKeys(const std::string& name = "penumbra farm test")
      : authority_(make_authority(name, kGood).value()) {
    for (const TokenKind& kind : kTokenKinds) tokens.*kind.token = make_token();
  }

  std::shared_ptr<Keys> server(const std::vector<std::string>& names = {"localhost", "127.0.0.1", "::1"},
                               const Validity& validity = kGood) const {
    return keys(CertificateUse::kServer, names, validity);
  }
  std::shared_ptr<Keys> client(const Validity& validity = kGood) const {
    return keys(CertificateUse::kClient, {}, validity);
  }

  Tokens tokens;

 private:
  std::shared_ptr<Keys> keys(CertificateUse use, const std::vector<std::string>& names,
                             const Validity& validity) const {
    KeyPair pair = make_certificate(authority_, "penumbra test", use, names, validity).value();
    auto made = std::make_shared<Keys>();
    made->authority = authority_.certificate;
    made->certificate = std::move(pair.certificate);
    made->key = std::move(pair.key);
    made->tokens = tokens;
    made->folder = "the test's keys";
    return made;
  }

  KeyPair authority_;
};

}  // namespace penumbra
