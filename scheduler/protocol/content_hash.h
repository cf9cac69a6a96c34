// Names of data by its content. They hold between people who do not trust each other: nobody can make two
// contents of the same hash, so whoever has checked the hash has what was meant. Checksums against accidents
// within one program's own files are XXH3, where they are taken.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

namespace penumbra {

using ContentDigest = std::array<std::uint8_t, 32>;

/// SHA-256 (FIPS 180-4) of the parts, one after the other.
ContentDigest content_digest(std::initializer_list<std::span<const std::uint8_t>> parts);

/// SHA-256 of the bytes as 64 hexadecimal digits.
std::string content_hash(std::span<const std::uint8_t> bytes);

/// Whether a text looks like one: nothing else may become a part of a file's name.
bool is_content_hash(std::string_view text);

}  // namespace penumbra
