// X.509 certificates by OpenSSL: an authority, what it signs, and what is wrong about one, in words.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

/// A certificate and its private key, both as PEM.
struct KeyPair {
  std::string certificate, key;
};

/// From now on; may be negative.
struct Validity {
  std::chrono::seconds from{-300};  ///< clocks differ
  std::chrono::seconds until{};
};

/// What a certificate is for; one is never good as the other.
enum class CertificateUse { kServer, kClient };

/// An elliptic curve key (P-256) and a certificate of its own that may sign others, not authorities.
Expected<KeyPair> make_authority(const std::string& name, const Validity& validity);
/// One that the authority signs. `names`: host names and addresses that a server may be reached at; a name
/// that is neither is an error.
Expected<KeyPair> make_certificate(const KeyPair& authority, const std::string& name, CertificateUse use,
                                   const std::vector<std::string>& names, const Validity& validity);

/// Says what is wrong: unreadable, expired or not valid yet, not of this authority, not for this use, not the
/// key's. Texts begin with a verb, as in "has expired on Jan  1 00:00:00 2026 GMT".
Expected<void> check_certificate(const std::string& authority, const std::string& certificate,
                                 const std::string& key, CertificateUse use);

/// Whether it is an IPv4 or IPv6 address, or a host name as certificates have them ("*.farm.example" too).
bool is_certificate_name(const std::string& name);

/// Why a verification failed with this code of OpenSSL (X509_V_ERR_…) at this certificate (an X509*, may be
/// null); `host`: what was looked for in it.
std::string verification_text(int code, void* certificate, const std::string& host);

}  // namespace penumbra
