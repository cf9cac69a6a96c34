// Mutates valid messages a little, for fuzz tests.
#pragma once

#include <random>
#include <string>
#include <vector>

namespace penumbra {

/// Bytes of one of the seeds with one to four changes: flipped bits, other bytes, pieces cut out, doubled or
/// taken from another seed, ends cut off, numbers and lengths replaced by extreme ones.
class Mutator {
 public:
  Mutator(std::vector<std::string> seeds, std::uint32_t seed) : seeds_(std::move(seeds)), random_(seed) {}

  std::string next() {
    std::string bytes = seeds_[below(seeds_.size())];
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) change(bytes);
    return bytes;
  }

 private:
  std::size_t below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_);
  }

  void change(std::string& bytes) {
    if (bytes.empty()) {
      bytes = std::string(1 + below(8), char(below(256)));
      return;
    }
    // Most of a message's structure is at its ends; samples are in between.
    const std::size_t near_end = std::min<std::size_t>(bytes.size(), 48);
    const std::size_t at = below(3) == 0   ? below(bytes.size())
                           : below(2) == 0 ? below(near_end)
                                           : bytes.size() - 1 - below(near_end);
    const std::size_t length = 1 + below(std::min<std::size_t>(bytes.size() - at, 16));
    switch (below(7)) {
      case 0:
        bytes[at] = char(bytes[at] ^ (1 << below(8)));
        break;
      case 1:
        bytes[at] = char(below(256));
        break;
      case 2:
        bytes.erase(at, length);
        break;
      case 3:
        bytes.insert(at, bytes.substr(at, length));
        break;
      case 4: {
        const std::string& other = seeds_[below(seeds_.size())];
        const std::size_t from = below(other.size());
        bytes.insert(at, other, from, 1 + below(16));
        break;
      }
      case 5:
        bytes.resize(at);
        break;
      default: {
        // As varints, and as bytes of floats: 2^64-1, 2^31, 2^63, infinity, NaN.
        static const std::vector<std::string> kExtremes = {
            std::string(9, '\xff') + '\x01', std::string("\x80\x80\x80\x80\x08"),
            std::string(9, '\x80') + '\x01', std::string("\x00\x00\x80\x7f", 4),
            std::string("\x01\x00\xc0\x7f", 4)};
        bytes.replace(at, length, kExtremes[below(kExtremes.size())]);
      }
    }
  }

  const std::vector<std::string> seeds_;
  std::mt19937 random_;
};

}  // namespace penumbra
