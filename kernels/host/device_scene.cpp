#include "kernels/host/device_scene.h"

#include <cstring>

#include "kernels/host/device_scene_check.h"

namespace penumbra {
namespace {

constexpr std::uint32_t kMagic = 0x53424e50;  // "PNBS"
constexpr std::uint32_t kVersion = 2;

struct Preamble {
  std::uint32_t magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t header_bytes = sizeof(SceneHeader);
  std::uint32_t word_count = 0;
};

}  // namespace

std::vector<std::uint8_t> DeviceScene::serialize() const {
  Preamble preamble;
  preamble.word_count = std::uint32_t(words.size());
  std::vector<std::uint8_t> bytes(sizeof preamble + sizeof header + words.size() * 4);
  std::memcpy(bytes.data(), &preamble, sizeof preamble);
  std::memcpy(bytes.data() + sizeof preamble, &header, sizeof header);
  if (!words.empty())
    std::memcpy(bytes.data() + sizeof preamble + sizeof header, words.data(), words.size() * 4);
  return bytes;
}

Expected<DeviceScene> DeviceScene::deserialize(std::span<const std::uint8_t> bytes) {
  Preamble preamble;
  if (bytes.size() < sizeof preamble + sizeof(SceneHeader))
    return fail("device scene: truncated before its header ends");
  std::memcpy(&preamble, bytes.data(), sizeof preamble);
  if (preamble.magic != kMagic) return fail("device scene: not one (wrong magic number)");
  if (preamble.version != kVersion || preamble.header_bytes != sizeof(SceneHeader))
    return fail(
        "device scene: made by another version of Penumbra; scheduler and worker must be the same version");
  const std::size_t expected = sizeof preamble + sizeof(SceneHeader) + std::size_t(preamble.word_count) * 4;
  if (bytes.size() != expected)
    return fail("device scene: " + std::to_string(bytes.size()) + " bytes where " + std::to_string(expected) +
                " were announced");
  DeviceScene scene;
  std::memcpy(&scene.header, bytes.data() + sizeof preamble, sizeof(SceneHeader));
  scene.words.resize(preamble.word_count);
  if (preamble.word_count > 0)
    std::memcpy(scene.words.data(), bytes.data() + sizeof preamble + sizeof(SceneHeader),
                scene.words.size() * 4);
  if (Expected<void> checked = check_device_scene(scene); !checked) return std::unexpected(checked.error());
  return scene;
}

}  // namespace penumbra
