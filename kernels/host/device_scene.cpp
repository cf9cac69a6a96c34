#include "kernels/host/device_scene.h"

#include <algorithm>
#include <cstring>
#include <new>

namespace penumbra {
namespace {

constexpr std::uint32_t kMagic = 0x53424e50;  // "PNBS"
constexpr std::uint32_t kVersion = 15;

struct Preamble {
  std::uint32_t magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t header_bytes = sizeof(SceneHeader);
  std::uint32_t word_count = 0;
};

#define FIELD_SIZE(type, name) +sizeof(type)
static_assert(sizeof(SceneHeader) == 0 SCENE_HEADER_FIELDS(FIELD_SIZE), "padding has no value to ship");
#undef FIELD_SIZE

constexpr std::size_t kHeadBytes = sizeof(Preamble) + sizeof(SceneHeader);

std::unexpected<Error> wrong_size(std::size_t bytes, std::size_t expected) {
  return fail("device scene: " + std::to_string(bytes) + " bytes where " + std::to_string(expected) +
              " were announced");
}

}  // namespace

std::vector<std::uint8_t> DeviceScene::head() const {
  Preamble preamble;
  preamble.word_count = std::uint32_t(words.size());
  std::vector<std::uint8_t> bytes(kHeadBytes);
  std::memcpy(bytes.data(), &preamble, sizeof preamble);
  std::memcpy(bytes.data() + sizeof preamble, &header, sizeof header);
  return bytes;
}

std::span<const std::uint8_t> DeviceScene::body() const {
  return {reinterpret_cast<const std::uint8_t*>(words.data()), words.size() * 4};
}

std::vector<std::uint8_t> DeviceScene::serialize() const {
  std::vector<std::uint8_t> bytes = head();
  const std::span<const std::uint8_t> rest = body();
  bytes.reserve(bytes.size() + rest.size());
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  return bytes;
}

Expected<DeviceScene> DeviceScene::deserialize(std::span<const std::uint8_t> bytes) {
  DeviceSceneReader reader(bytes.size());
  if (Expected<void> added = reader.add(bytes); !added) return std::unexpected(added.error());
  return reader.finish();
}

Expected<void> DeviceSceneReader::begin() {
  Preamble preamble;
  std::memcpy(&preamble, head_.data(), sizeof preamble);
  if (preamble.magic != kMagic) return fail("device scene: not one (wrong magic number)");
  if (preamble.version != kVersion || preamble.header_bytes != sizeof(SceneHeader))
    return fail(
        "device scene: made by another version of Penumbra; scheduler and worker must be the same version");
  expected_ = kHeadBytes + std::size_t(preamble.word_count) * 4;
  if (total_ && *total_ != expected_) return wrong_size(*total_, expected_);
  std::memcpy(&scene_.header, head_.data() + sizeof preamble, sizeof(SceneHeader));
  try {
    scene_.words.reserve(preamble.word_count);
  } catch (const std::bad_alloc&) {
    return fail("device scene: no memory for its " + std::to_string(expected_) + " bytes");
  }
  return {};
}

Expected<void> DeviceSceneReader::add(std::span<const std::uint8_t> bytes) {
  if (received_ < kHeadBytes) {
    const std::size_t of_head = std::min(kHeadBytes - received_, bytes.size());
    head_.insert(head_.end(), bytes.begin(), bytes.begin() + std::ptrdiff_t(of_head));
    received_ += of_head;
    bytes = bytes.subspan(of_head);
    if (received_ < kHeadBytes) return {};
    if (Expected<void> begun = begin(); !begun) return begun;
  }
  if (bytes.size() > expected_ - received_) return wrong_size(received_ + bytes.size(), expected_);
  if (bytes.empty()) return {};
  const std::size_t at = received_ - kHeadBytes;
  scene_.words.resize((at + bytes.size() + 3) / 4);
  std::memcpy(reinterpret_cast<std::uint8_t*>(scene_.words.data()) + at, bytes.data(), bytes.size());
  received_ += bytes.size();
  return {};
}

Expected<DeviceScene> DeviceSceneReader::finish() {
  if (received_ < kHeadBytes) return fail("device scene: truncated before its header ends");
  if (received_ != expected_) return wrong_size(received_, expected_);
  if (Expected<void> checked = check_device_scene(scene_); !checked) return std::unexpected(checked.error());
  return std::move(scene_);
}

}  // namespace penumbra
