// Cryptographic content hashes. Nobody can construct two contents with the same hash, so whoever verifies a
// hash has the intended data, even from an untrusted peer. For accidental errors within one program's files,
// XXH3 checksums are used instead.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace penumbra {

using ContentDigest = std::array<std::uint8_t, 32>;

/// Computes the SHA-256 (FIPS 180-4) of bytes that come one after the other.
class ContentHasher {
 public:
  ContentHasher();
  ~ContentHasher();
  ContentHasher(ContentHasher&&) noexcept;
  ContentHasher& operator=(ContentHasher&&) noexcept;

  void add(std::span<const std::uint8_t> bytes);
  /// The digest of all bytes so far; nothing may be added afterwards.
  [[nodiscard]] ContentDigest digest();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// SHA-256 of the concatenated parts.
ContentDigest content_digest(std::initializer_list<std::span<const std::uint8_t>> parts);

/// A digest as 64 hexadecimal digits.
std::string hex_text(const ContentDigest& digest);

/// SHA-256 of the bytes as 64 hexadecimal digits.
std::string content_hash(std::span<const std::uint8_t> bytes);

/// Whether a text has the form of a content hash. Only such texts may become part of a file name.
bool is_content_hash(std::string_view text);

}  // namespace penumbra
