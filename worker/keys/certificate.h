// X.509 certificates with OpenSSL: making an authority, signing certificates, and explaining what is wrong
// with one.
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

/// A period of validity, relative to now; offsets may be negative.
struct Validity {
  std::chrono::seconds from{-300};  ///< in the past, because clocks differ
  std::chrono::seconds until{};
};

/// The purpose of a certificate. A certificate for one purpose is not valid for the other.
enum class CertificateUse { kServer, kClient };

/// Makes an elliptic curve key (P-256) and a self-signed certificate that may sign other certificates, but
/// not authorities.
Expected<KeyPair> make_authority(const std::string& name, const Validity& validity);
/// Makes a certificate signed by the authority. `names`: host names and addresses at which a server is
/// reached. Error: an invalid name.
Expected<KeyPair> make_certificate(const KeyPair& authority, const std::string& name, CertificateUse use,
                                   const std::vector<std::string>& names, const Validity& validity);

/// Checks a certificate. Errors: unreadable, expired or not valid yet, not signed by this authority, not for
/// this use, not for this key. Texts begin with a verb: "has expired on Jan  1 00:00:00 2026 GMT".
Expected<void> check_certificate(const std::string& authority, const std::string& certificate,
                                 const std::string& key, CertificateUse use);

/// Whether the name is an IPv4 or IPv6 address, or a host name as certificates have them (including
/// "*.farm.example").
bool is_certificate_name(const std::string& name);

/// Whether a server with this certificate may have this host name or address.
bool is_certificate_for(const std::string& certificate, const std::string& host);

/// The host names and addresses of a server's certificate, in its order. Empty if it cannot be read.
std::vector<std::string> certificate_names(const std::string& certificate);

/// Explains an OpenSSL verification error (X509_V_ERR_…) of this certificate (an X509*, may be null). `host`:
/// the name that the certificate had to match.
std::string verification_text(int code, void* certificate, const std::string& host);

}  // namespace penumbra
