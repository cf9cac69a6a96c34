#include "scenes/device/scene_records.h"

#include <algorithm>
#include <cstring>

namespace penumbra {
namespace {

constexpr std::size_t kLineWords = kCacheLine / 4;

template <typename Record>
TableSpan append(const std::vector<Record>& records, int least, AlignedVector<std::uint32_t>& words) {
  const std::size_t offset = (words.size() + kLineWords - 1) / kLineWords * kLineWords;
  words.resize(offset + std::max(records.size(), std::size_t(least)) * (sizeof(Record) / 4));
  if (!records.empty()) std::memcpy(words.data() + offset, records.data(), records.size() * sizeof(Record));
  return {int(records.size()), std::uint32_t(offset)};
}

}  // namespace

void store(const SceneRecords& records, DeviceScene& scene) {
#define STORE_TABLE(_, name, record, least, what) \
  scene.header.tables.name = append(records.name, least, scene.words);
  SCENE_TABLES(STORE_TABLE, _)
#undef STORE_TABLE
}

}  // namespace penumbra
