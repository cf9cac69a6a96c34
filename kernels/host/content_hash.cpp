#include "kernels/host/content_hash.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/evp.h>

#include <algorithm>
#include <stdexcept>

namespace penumbra {

namespace {

/// This fails only if there is no memory, or if the system forbids SHA-256.
void require(bool is_good) {
  if (!is_good) throw std::runtime_error("OpenSSL cannot compute SHA-256");
}

}  // namespace

struct ContentHasher::State {
  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { EVP_MD_CTX_free(context); }
  EVP_MD_CTX* const context = EVP_MD_CTX_new();
};

ContentHasher::ContentHasher() : state_(std::make_unique<State>()) {
  require(state_->context != nullptr && EVP_DigestInit_ex(state_->context, EVP_sha256(), nullptr) == 1);
}

ContentHasher::~ContentHasher() = default;
ContentHasher::ContentHasher(ContentHasher&&) noexcept = default;
ContentHasher& ContentHasher::operator=(ContentHasher&&) noexcept = default;

void ContentHasher::add(std::span<const std::uint8_t> bytes) {
  require(EVP_DigestUpdate(state_->context, bytes.data(), bytes.size()) == 1);
}

ContentDigest ContentHasher::digest() {
  ContentDigest digest;
  require(EVP_DigestFinal_ex(state_->context, digest.data(), nullptr) == 1);
  return digest;
}

ContentDigest content_digest(std::initializer_list<std::span<const std::uint8_t>> parts) {
  ContentHasher hasher;
  for (const auto part : parts) hasher.add(part);
  return hasher.digest();
}

std::string hex_text(const ContentDigest& digest) { return fmt::format("{:02x}", fmt::join(digest, "")); }

std::string content_hash(std::span<const std::uint8_t> bytes) { return hex_text(content_digest({bytes})); }

bool is_content_hash(std::string_view text) {
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  return text.size() == 2 * sizeof(ContentDigest) && std::ranges::all_of(text, is_digit);
}

}  // namespace penumbra
