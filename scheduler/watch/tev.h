// A client of tev, the image viewer (https://github.com/Tom94/tev): shows an image in it, tile by tile. Its
// protocol, as tev's README and IPC code have it: packets over TCP, each its length in bytes (that of the
// length included), an operation and what belongs to it; integers little-endian, texts ended by a 0 byte, no
// answers.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

inline constexpr std::string_view kTevDefaultHost = "127.0.0.1";
inline constexpr std::uint16_t kTevDefaultPort = 14158;
inline constexpr std::chrono::milliseconds kTevTimeout{5000};

struct TevAddress {
  std::string host;
  std::uint16_t port = kTevDefaultPort;
};

/// "HOST", "HOST:PORT", "[IPV6]:PORT", "IPV6", ":PORT" or nothing; what is left out is tev's default.
Expected<TevAddress> parse_tev_address(std::string_view host_and_port);

/// How a tile's values lie: pixels row by row with all channels of each together, or one channel after the
/// other.
enum class TevLayout { kInterleaved, kPlanar };

/// Pixels of the image, from its top left corner.
struct TevTile {
  std::int32_t x = 0, y = 0, width = 0, height = 0;
};

using TevPacket = std::vector<std::uint8_t>;

/// A blank image; tev replaces one of the same name. Channels R, G, B, A are shown as a colour, a dot
/// separates a layer from its channel ("difference.R"). Errors: no size, no channels, empty texts or ones
/// with a 0 byte in them.
Expected<TevPacket> encode_create_image(std::string_view name, std::int32_t width, std::int32_t height,
                                        std::span<const std::string> channels, bool grab_focus = true);

/// New values of a tile (the third version of the operation, with offset and stride for each channel).
/// Errors: as above, a corner left or above of the image, not width * height * channels values, 4 GiB or
/// more.
Expected<TevPacket> encode_update_tile(std::string_view name, TevTile tile,
                                       std::span<const std::string> channels, std::span<const float> values,
                                       TevLayout layout, bool grab_focus = false);

Expected<TevPacket> encode_close_image(std::string_view name);

/// A connection to tev. Errors name its address. A packet that fails on its way leaves the connection closed,
/// and what is asked of it from then on fails at once; a packet that cannot be encoded does no harm. One
/// thread at a time.
class TevClient {
 public:
  /// `timeout`: for the name service, for each address of the host to answer, and later for tev to take any
  /// further byte of a packet. A stop ends all waiting soon, with an error. Never raises SIGPIPE.
  static Expected<TevClient> connect(const std::string& host_and_port,
                                     std::chrono::milliseconds timeout = kTevTimeout,
                                     std::stop_token stop = {});

  TevClient(TevClient&& other) noexcept;
  TevClient& operator=(TevClient&& other) noexcept;
  TevClient(const TevClient&) = delete;
  TevClient& operator=(const TevClient&) = delete;
  ~TevClient();

  Expected<void> create_image(std::string_view name, int width, int height,
                              std::span<const std::string> channels, bool grab_focus = true);
  /// `values`: width * height * channels. The image is one that was created with these channels and more or
  /// none.
  Expected<void> update_tile(std::string_view name, int x, int y, int width, int height,
                             std::span<const std::string> channels, std::span<const float> values,
                             TevLayout layout = TevLayout::kInterleaved);
  Expected<void> close_image(std::string_view name);

  [[nodiscard]] const std::string& address() const { return address_; }  ///< "host:port"
  [[nodiscard]] bool connected() const { return socket_ >= 0; }

 private:
  TevClient(int socket, std::string address, std::chrono::milliseconds timeout, std::stop_token stop);
  Expected<void> send(const Expected<TevPacket>& packet);
  Expected<void> send_all(std::span<const std::uint8_t> bytes);
  [[nodiscard]] bool closed_by_peer() const;
  void close_socket();

  int socket_ = -1;  ///< non-blocking
  std::string address_;
  std::chrono::milliseconds timeout_{};
  std::stop_token stop_;
};

}  // namespace penumbra
