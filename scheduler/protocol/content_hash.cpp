#include "scheduler/protocol/content_hash.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/evp.h>

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "scheduler/keys/openssl_object.h"

namespace penumbra {

ContentDigest content_digest(std::initializer_list<std::span<const std::uint8_t>> parts) {
  const std::unique_ptr<EVP_MD_CTX, Freed<EVP_MD_CTX_free>> state(EVP_MD_CTX_new());
  bool is_good = state != nullptr && EVP_DigestInit_ex(state.get(), EVP_sha256(), nullptr) == 1;
  for (const auto part : parts)
    is_good = is_good && EVP_DigestUpdate(state.get(), part.data(), part.size()) == 1;
  ContentDigest digest;
  // This fails only if there is no memory, or if the system forbids SHA-256.
  if (!is_good || EVP_DigestFinal_ex(state.get(), digest.data(), nullptr) != 1)
    throw std::runtime_error("OpenSSL cannot compute SHA-256");
  return digest;
}

std::string content_hash(std::span<const std::uint8_t> bytes) {
  return fmt::format("{:02x}", fmt::join(content_digest({bytes}), ""));
}

bool is_content_hash(std::string_view text) {
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  return text.size() == 2 * sizeof(ContentDigest) && std::ranges::all_of(text, is_digit);
}

}  // namespace penumbra
