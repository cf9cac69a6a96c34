#include "worker/keys/certificate.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <netinet/in.h>
#include <openssl/bn.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <memory>

#include "worker/keys/openssl_object.h"

namespace penumbra {
namespace {

using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>>;
using Names = std::unique_ptr<GENERAL_NAMES, Freed<GENERAL_NAMES_free>>;
using Number = std::unique_ptr<BIGNUM, Freed<BN_free>>;
using Store = std::unique_ptr<X509_STORE, Freed<X509_STORE_free>>;
using StoreContext = std::unique_ptr<X509_STORE_CTX, Freed<X509_STORE_CTX_free>>;

constexpr int kSerialBits = 159;  // RFC 5280, 4.1.2.2: at most 20 bytes, positive
constexpr long kVersion3 = 2;

std::string library_error() {
  char text[256] = "no reason given";
  if (const unsigned long code = ERR_get_error(); code != 0) ERR_error_string_n(code, text, sizeof text);
  ERR_clear_error();
  return text;
}

std::string text_in(BIO* bio) {
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(bio, &bytes);
  return {bytes, std::size_t(std::max(size, 0L))};
}

Certificate read_certificate(const std::string& pem) {
  Certificate read(PEM_read_bio_X509(pem_reader(pem).get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  return read;
}

/// Reads a private key. A key with a password is an error; the user is not asked for it.
Key read_key(const std::string& pem) {
  char none[] = "";
  Key read(PEM_read_bio_PrivateKey(pem_reader(pem).get(), nullptr, nullptr, none));
  ERR_clear_error();
  return read;
}

std::string time_text(const ASN1_TIME* time) {
  const Bio text(BIO_new(BIO_s_mem()));
  return ASN1_TIME_print(text.get(), time) == 1 ? text_in(text.get()) : "an unreadable date";
}

std::string common_name(const X509_NAME* name) {
  char text[256] = "";
  X509_NAME_get_text_by_NID(const_cast<X509_NAME*>(name), NID_commonName, text, sizeof text);
  return text;
}

std::vector<std::string> names_in(X509* certificate) {
  const Names names(
      static_cast<GENERAL_NAMES*>(X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr)));
  std::vector<std::string> all;
  for (int i = 0; names && i < sk_GENERAL_NAME_num(names.get()); ++i) {
    int kind = 0;
    const auto* value = static_cast<const ASN1_STRING*>(
        GENERAL_NAME_get0_value(sk_GENERAL_NAME_value(names.get(), i), &kind));
    if (kind != GEN_DNS && kind != GEN_IPADD) continue;
    const unsigned char* bytes = ASN1_STRING_get0_data(value);
    const int size = ASN1_STRING_length(value);
    if (kind == GEN_DNS) {
      all.emplace_back(reinterpret_cast<const char*>(bytes), std::size_t(size));
    } else {
      char text[INET6_ADDRSTRLEN] = "";
      if (size == sizeof(in_addr)) inet_ntop(AF_INET, bytes, text, sizeof text);
      if (size == sizeof(in6_addr)) inet_ntop(AF_INET6, bytes, text, sizeof text);
      if (*text != 0) all.emplace_back(text);
    }
  }
  return all;
}

std::string names_text(X509* certificate) {
  const std::vector<std::string> names = names_in(certificate);
  return names.empty() ? "no host at all" : fmt::format("{}", fmt::join(names, ", "));
}

bool add_extension(X509* certificate, X509* issuer, int kind, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  const Extension extension(X509V3_EXT_conf_nid(nullptr, &context, kind, value));
  return extension && X509_add_ext(certificate, extension.get(), -1) == 1;
}

/// Uses the library's types; in its text form a name with commas would be several names.
bool add_names(X509* certificate, const std::vector<std::string>& names) {
  const Names all(sk_GENERAL_NAME_new_null());
  for (const std::string& name : names) {
    GENERAL_NAME* general = GENERAL_NAME_new();
    if (general == nullptr) return false;
    if (ASN1_OCTET_STRING* address = a2i_IPADDRESS(name.c_str())) {
      GENERAL_NAME_set0_value(general, GEN_IPADD, address);
    } else {
      ASN1_IA5STRING* text = ASN1_IA5STRING_new();
      ASN1_STRING_set(text, name.data(), int(name.size()));
      GENERAL_NAME_set0_value(general, GEN_DNS, text);
    }
    sk_GENERAL_NAME_push(all.get(), general);
  }
  return X509_add1_ext_i2d(certificate, NID_subject_alt_name, all.get(), 0, X509V3_ADD_DEFAULT) == 1;
}

bool fill(X509* certificate, X509* issuer, EVP_PKEY* key, const std::string& name, const Validity& validity) {
  const Number serial(BN_new());
  X509_NAME* subject = X509_get_subject_name(certificate);
  return BN_rand(serial.get(), kSerialBits, BN_RAND_TOP_ANY, BN_RAND_BOTTOM_ANY) == 1 &&
         BN_to_ASN1_INTEGER(serial.get(), X509_get_serialNumber(certificate)) != nullptr &&
         X509_set_version(certificate, kVersion3) == 1 &&
         X509_gmtime_adj(X509_getm_notBefore(certificate), long(validity.from.count())) != nullptr &&
         X509_gmtime_adj(X509_getm_notAfter(certificate), long(validity.until.count())) != nullptr &&
         X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_UTF8,
                                    reinterpret_cast<const unsigned char*>(name.data()), int(name.size()), -1,
                                    0) == 1 &&
         X509_set_issuer_name(certificate, X509_get_subject_name(issuer)) == 1 &&
         X509_set_pubkey(certificate, key) == 1;
}

Expected<KeyPair> as_pem(X509* certificate, EVP_PKEY* key) {
  const Bio first(BIO_new(BIO_s_mem())), second(BIO_new(BIO_s_secmem()));
  if (PEM_write_bio_X509(first.get(), certificate) != 1 ||
      PEM_write_bio_PrivateKey(second.get(), key, nullptr, nullptr, 0, nullptr, nullptr) != 1)
    return fail("cannot write a certificate: " + library_error());
  return KeyPair{text_in(first.get()), text_in(second.get())};
}

}  // namespace

Expected<KeyPair> make_authority(const std::string& name, const Validity& validity) {
  const Key key(EVP_EC_gen("P-256"));
  const Certificate made(X509_new());
  X509* authority = made.get();
  if (!key || !made || !fill(authority, authority, key.get(), name, validity) ||
      !add_extension(authority, authority, NID_basic_constraints, "critical,CA:TRUE,pathlen:0") ||
      !add_extension(authority, authority, NID_key_usage, "critical,keyCertSign,cRLSign") ||
      !add_extension(authority, authority, NID_subject_key_identifier, "hash") ||
      X509_sign(authority, key.get(), EVP_sha256()) == 0)
    return fail("cannot make an authority: " + library_error());
  return as_pem(authority, key.get());
}

Expected<KeyPair> make_certificate(const KeyPair& authority, const std::string& name, CertificateUse use,
                                   const std::vector<std::string>& names, const Validity& validity) {
  for (const std::string& host : names)
    if (!is_certificate_name(host))
      return fail(fmt::format("'{}' is neither a host's name nor an address", host));
  const Certificate issuer = read_certificate(authority.certificate);
  const Key issuer_key = read_key(authority.key);
  if (!issuer || !issuer_key) return fail("the authority's certificate or key cannot be read");
  const Key key(EVP_EC_gen("P-256"));
  const Certificate made(X509_new());
  const char* usage = use == CertificateUse::kServer ? "serverAuth" : "clientAuth";
  if (!key || !made || !fill(made.get(), issuer.get(), key.get(), name, validity) ||
      !add_extension(made.get(), issuer.get(), NID_basic_constraints, "critical,CA:FALSE") ||
      !add_extension(made.get(), issuer.get(), NID_key_usage, "critical,digitalSignature") ||
      !add_extension(made.get(), issuer.get(), NID_ext_key_usage, usage) ||
      !add_extension(made.get(), issuer.get(), NID_subject_key_identifier, "hash") ||
      !add_extension(made.get(), issuer.get(), NID_authority_key_identifier, "keyid:always") ||
      (!names.empty() && !add_names(made.get(), names)) ||
      X509_sign(made.get(), issuer_key.get(), EVP_sha256()) == 0)
    return fail("cannot make a certificate: " + library_error());
  return as_pem(made.get(), key.get());
}

bool is_certificate_for(const std::string& certificate, const std::string& host) {
  const Certificate read = read_certificate(certificate);
  return read && (X509_check_host(read.get(), host.data(), host.size(), 0, nullptr) == 1 ||
                  X509_check_ip_asc(read.get(), host.c_str(), 0) == 1);
}

std::vector<std::string> certificate_names(const std::string& certificate) {
  const Certificate read = read_certificate(certificate);
  return read ? names_in(read.get()) : std::vector<std::string>();
}

bool is_certificate_name(const std::string& name) {
  if (ASN1_OCTET_STRING* address = a2i_IPADDRESS(name.c_str())) {
    ASN1_OCTET_STRING_free(address);
    return true;
  }
  ERR_clear_error();
  constexpr std::size_t kLongestHost = 253, kLongestLabel = 63;  // RFC 1035, 2.3.4
  std::string_view rest = name;
  if (rest.starts_with("*.")) rest.remove_prefix(2);
  if (rest.empty() || rest.size() > kLongestHost) return false;
  while (!rest.empty()) {
    const std::size_t dot = rest.find('.');
    const std::string_view label = rest.substr(0, dot);
    const auto is_allowed = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
             c == '_';
    };
    if (label.empty() || label.size() > kLongestLabel || label.starts_with('-') || label.ends_with('-') ||
        !std::ranges::all_of(label, is_allowed))
      return false;
    if (dot == std::string_view::npos) return true;
    rest.remove_prefix(dot + 1);
  }
  return false;
}

std::string verification_text(int code, void* certificate, const std::string& host) {
  X509* x509 = static_cast<X509*>(certificate);
  if (x509 == nullptr) return X509_verify_cert_error_string(code);
  switch (code) {
    case X509_V_ERR_CERT_HAS_EXPIRED:
      return "has expired on " + time_text(X509_get0_notAfter(x509));
    case X509_V_ERR_CERT_NOT_YET_VALID:
      return fmt::format("is valid from {} on only; if that is past, a clock is wrong",
                         time_text(X509_get0_notBefore(x509)));
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT_LOCALLY:
    case X509_V_ERR_UNABLE_TO_VERIFY_LEAF_SIGNATURE:
    case X509_V_ERR_CERT_SIGNATURE_FAILURE:
    case X509_V_ERR_DEPTH_ZERO_SELF_SIGNED_CERT:
    case X509_V_ERR_SELF_SIGNED_CERT_IN_CHAIN:
      return fmt::format("is of another authority ('{}') than these keys",
                         common_name(X509_get_issuer_name(x509)));
    case X509_V_ERR_HOSTNAME_MISMATCH:
    case X509_V_ERR_IP_ADDRESS_MISMATCH:
      return fmt::format("is for {}, and not for {} (penumbra keys --name)", names_text(x509), host);
    case X509_V_ERR_INVALID_PURPOSE:
      return fmt::format(
          "('{}') is not made for this use: schedulers' and clients' cannot stand for each other",
          common_name(X509_get_subject_name(x509)));
    default:
      return fmt::format("is not accepted: {}", X509_verify_cert_error_string(code));
  }
}

Expected<void> check_certificate(const std::string& authority, const std::string& certificate,
                                 const std::string& key, CertificateUse use) {
  const Certificate issuer = read_certificate(authority), own = read_certificate(certificate);
  if (!issuer) return fail("is there, but the authority's is damaged");
  if (!own) return fail("is damaged: it is no certificate in PEM");
  const Key own_key = read_key(key);
  if (!own_key) return fail("is there, but its private key is damaged");
  if (X509_check_private_key(own.get(), own_key.get()) != 1) {
    ERR_clear_error();
    return fail("does not belong to its private key");
  }
  const Store store(X509_STORE_new());
  const StoreContext context(X509_STORE_CTX_new());
  if (!store || !context || X509_STORE_add_cert(store.get(), issuer.get()) != 1 ||
      X509_STORE_CTX_init(context.get(), store.get(), own.get(), nullptr) != 1)
    return fail("cannot be checked: " + library_error());
  X509_STORE_CTX_set_default(context.get(), use == CertificateUse::kServer ? "ssl_server" : "ssl_client");
  if (X509_verify_cert(context.get()) == 1) return {};
  ERR_clear_error();
  return fail(verification_text(X509_STORE_CTX_get_error(context.get()),
                                X509_STORE_CTX_get_current_cert(context.get()), ""));
}

}  // namespace penumbra
