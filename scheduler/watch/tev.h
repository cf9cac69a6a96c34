// A client of the image viewer tev (https://github.com/Tom94/tev), which shows an image tile by tile. The
// protocol is that of tev's README and IPC code: packets over TCP, each with its length in bytes (including
// the length itself), an operation and its arguments. Integers are little-endian, texts end with a 0 byte,
// and there are no answers.
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

/// Parses "HOST", "HOST:PORT", "[IPV6]:PORT", "IPV6", ":PORT" or an empty text. Missing parts are tev's
/// defaults.
Expected<TevAddress> parse_tev_address(std::string_view host_and_port);

/// The memory layout of a tile: pixels row by row with all channels of a pixel adjacent, or one channel after
/// the other.
enum class TevLayout { kInterleaved, kPlanar };

/// A rectangle in pixels; its corner is relative to the image's top left corner.
struct TevTile {
  std::int32_t x = 0, y = 0, width = 0, height = 0;
};

using TevPacket = std::vector<std::uint8_t>;

/// A packet that creates a blank image; tev replaces one of the same name. Channels R, G, B, A are shown as a
/// colour. A dot separates a layer from its channel ("difference.R"). Errors: an empty image, no channels,
/// texts that are empty or contain a 0 byte.
Expected<TevPacket> encode_create_image(std::string_view name, std::int32_t width, std::int32_t height,
                                        std::span<const std::string> channels, bool grab_focus = true);

/// A packet with new values of a tile (the third version of the operation, with offset and stride for each
/// channel). Errors: those above; a negative corner; not width * height * channels values; 4 GiB or more.
Expected<TevPacket> encode_update_tile(std::string_view name, TevTile tile,
                                       std::span<const std::string> channels, std::span<const float> values,
                                       TevLayout layout, bool grab_focus = false);

Expected<TevPacket> encode_close_image(std::string_view name);

/// A connection to tev. Errors contain its address. If sending a packet fails, the connection is closed, and
/// all later calls fail at once. A packet that cannot be encoded has no effect. Not thread-safe.
class TevClient {
 public:
  /// `timeout` applies to the name lookup, to the connection to each address of the host, and later to every
  /// wait until tev accepts a further byte. A stop request ends all waiting soon, with an error. Never raises
  /// SIGPIPE.
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
  /// `values`: width * height * channels numbers. The image must have been created with at least these
  /// channels.
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
