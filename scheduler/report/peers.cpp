#include "scheduler/report/peers.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "scheduler/image/image.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnding = "-seconds.exr";

bool is_hidden(const fs::path& path) { return path.filename().string().starts_with("."); }

Expected<void> check_size(const fs::path& file, int width, int height) {
  const auto image = read_image(file);
  if (!image) return std::unexpected(image.error());
  if (image->data.width == width && image->data.height == height) return {};
  return fail(fmt::format("{} has {} x {} pixels, the scene {} x {}", file.string(), image->data.width,
                          image->data.height, width, height));
}

Expected<Peer> read_peer(const fs::path& folder, int width, int height) {
  Peer peer{folder.filename().string(), {}};
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (is_hidden(entry.path())) continue;
    const auto seconds = peer_seconds(entry.path().filename().string());
    if (!seconds) {
      return fail(
          fmt::format("{} is not named SECONDS{}, as in 0.35{}", entry.path().string(), kEnding, kEnding));
    }
    if (auto sized = check_size(entry.path(), width, height); !sized) return std::unexpected(sized.error());
    peer.images.push_back({entry.path(), *seconds});
  }
  if (error) return fail(fmt::format("cannot read {}: {}", folder.string(), error.message()));
  std::ranges::sort(peer.images, {}, &PeerImage::seconds);
  const auto twice = std::ranges::adjacent_find(peer.images, {}, &PeerImage::seconds);
  if (twice != peer.images.end()) {
    return fail(
        fmt::format("{} and {} give the same time", twice->file.string(), (twice + 1)->file.string()));
  }
  if (peer.images.empty()) return fail(fmt::format("{} holds no images SECONDS{}", folder.string(), kEnding));
  return peer;
}

}  // namespace

std::optional<double> peer_seconds(std::string_view file_name) {
  if (!file_name.ends_with(kEnding)) return std::nullopt;
  file_name.remove_suffix(kEnding.size());
  double seconds = 0;
  const char* end = file_name.data() + file_name.size();
  const auto [at, error] = std::from_chars(file_name.data(), end, seconds, std::chars_format::fixed);
  if (error != std::errc() || at != end || !(seconds > 0) || !std::isfinite(seconds)) return std::nullopt;
  return seconds;
}

Expected<std::vector<Peer>> find_peers(const fs::path& folder, int width, int height) {
  std::error_code error;
  std::vector<Peer> peers;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (is_hidden(entry.path())) continue;
    if (!entry.is_directory()) {
      return fail(fmt::format("{} is no folder: images of a peer are named {}/NAME/SECONDS{}",
                              entry.path().string(), folder.string(), kEnding));
    }
    auto peer = read_peer(entry.path(), width, height);
    if (!peer) return std::unexpected(peer.error());
    peers.push_back(std::move(*peer));
  }
  if (error) return fail(fmt::format("cannot read {}: {}", folder.string(), error.message()));
  if (peers.empty())
    return fail(fmt::format("{0} holds no folders: images of a peer are named {0}/NAME/SECONDS{1}",
                            folder.string(), kEnding));
  std::ranges::sort(peers, {}, &Peer::name);
  return peers;
}

}  // namespace penumbra
