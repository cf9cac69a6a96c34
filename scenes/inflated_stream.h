// Reads the decompressed bytes of zlib's and gzip's data in order.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace penumbra {

class InflatedStream {
 public:
  enum class Format { kZlib, kGzip };
  /// Why there are no further bytes; kMore: there may be some.
  enum class State { kMore, kEnd, kCutOff, kDamaged, kNoMemory };

  /// The packed data must outlive the stream.
  InflatedStream(std::string_view packed, Format format)
      : left_(packed.size()), has_members_(format == Format::kGzip) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    if (inflateInit2(&stream_, MAX_WBITS + (has_members_ ? 16 : 0)) != Z_OK) state_ = State::kNoMemory;
  }
  ~InflatedStream() { inflateEnd(&stream_); }
  InflatedStream(const InflatedStream&) = delete;
  InflatedStream& operator=(const InflatedStream&) = delete;

  /// Reads up to `bytes` bytes and returns how many it read. If they are fewer, state() says why.
  std::size_t read(void* to, std::size_t bytes) {
    constexpr std::size_t kMost = std::size_t{1} << 30;  // zlib counts in 32 bits
    std::size_t made = 0;
    while (made < bytes && state_ == State::kMore) {
      if (stream_.avail_in == 0) {
        stream_.avail_in = uInt(std::min(left_, kMost));
        left_ -= stream_.avail_in;
      }
      const auto room = uInt(std::min(bytes - made, kMost));
      stream_.next_out = static_cast<Bytef*>(to) + made;
      stream_.avail_out = room;
      const int result = inflate(&stream_, Z_NO_FLUSH);
      made += room - stream_.avail_out;
      state_ = state_after(result);
    }
    return made;
  }
  [[nodiscard]] State state() const { return state_; }

 private:
  State state_after(int result) {
    const bool has_input = stream_.avail_in > 0 || left_ > 0;
    // A gzip file may consist of several members.
    if (result == Z_STREAM_END && has_members_ && has_input) result = inflateReset(&stream_);
    if (result == Z_STREAM_END) return State::kEnd;
    if (result == Z_BUF_ERROR) return has_input ? State::kMore : State::kCutOff;
    return result == Z_OK ? State::kMore : State::kDamaged;
  }

  z_stream stream_{};
  std::size_t left_;  ///< packed bytes that zlib has not got yet
  bool has_members_;
  State state_ = State::kMore;
};

}  // namespace penumbra
