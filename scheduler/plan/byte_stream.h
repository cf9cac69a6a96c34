// Serialises numbers and texts as little-endian bytes on any machine, and reads them back from untrusted
// data.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace penumbra {

/// Types of which arrays are stored as they are in memory: 8-byte numbers without padding.
template <typename T>
concept Words = std::is_trivially_copyable_v<T> && sizeof(T) % 8 == 0 && alignof(T) == 8;

inline void swap_words_where_big_endian(std::uint8_t* bytes, std::size_t count) {
  if constexpr (std::endian::native == std::endian::big)
    for (std::size_t i = 0; i < count; i += 8)
      for (std::size_t k = 0; k < 4; ++k) std::swap(bytes[i + k], bytes[i + 7 - k]);
}

class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

  void u64(std::uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) bytes_.push_back(std::uint8_t(value >> shift));
  }
  void i64(std::int64_t value) { u64(std::uint64_t(value)); }
  void f64(double value) { u64(std::bit_cast<std::uint64_t>(value)); }
  void text(std::string_view text) {
    u64(text.size());
    bytes_.insert(bytes_.end(), text.begin(), text.end());
  }
  template <Words T>
  void row(const std::vector<T>& values) {
    const std::size_t begin = bytes_.size(), count = values.size() * sizeof(T);
    const auto* first = reinterpret_cast<const std::uint8_t*>(values.data());
    bytes_.insert(bytes_.end(), first, first + count);
    swap_words_where_big_endian(bytes_.data() + begin, count);
  }

 private:
  std::vector<std::uint8_t>& bytes_;
};

/// A reader. Beyond the end it reads 0 and empty texts, and has then failed.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::uint64_t u64() {
    const auto taken = take(8);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < taken.size(); ++i) value |= std::uint64_t(taken[i]) << (8 * i);
    return value;
  }
  std::int64_t i64() { return std::int64_t(u64()); }
  double f64() { return std::bit_cast<double>(u64()); }
  std::string text() {
    const auto taken = take(u64());
    return {taken.begin(), taken.end()};
  }
  /// Fills all of `values`. Returns whether there were enough bytes.
  template <Words T>
  bool row(std::vector<T>& values) {
    const auto taken = take(std::uint64_t(values.size()) * sizeof(T));
    if (failed_) return false;
    if (taken.empty()) return true;
    std::memcpy(values.data(), taken.data(), taken.size());
    swap_words_where_big_endian(reinterpret_cast<std::uint8_t*>(values.data()), taken.size());
    return true;
  }

  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size(); }

 private:
  std::span<const std::uint8_t> take(std::uint64_t count) {
    if (failed_ || count > bytes_.size()) {
      failed_ = true;
      return {};
    }
    const auto taken = bytes_.first(std::size_t(count));
    bytes_ = bytes_.subspan(std::size_t(count));
    return taken;
  }

  std::span<const std::uint8_t> bytes_;
  bool failed_ = false;
};

}  // namespace penumbra
