#include "scenes/device/scene_records.h"

#include <algorithm>
#include <cstring>

namespace penumbra {
namespace {

constexpr std::size_t kLineWords = kCacheLine / 4;

std::size_t next_line(std::size_t words) { return (words + kLineWords - 1) / kLineWords * kLineWords; }

template <typename Record>
std::size_t words_of(std::span<const Record> records, int least) {
  return std::max(records.size(), std::size_t(least)) * (sizeof(Record) / 4);
}

/// Reserves the memory once, because the largest scenes fill most of it.
void reserve(const SceneRecords& records, AlignedVector<std::uint32_t>& words) {
  std::size_t total = words.size();
#define COUNT_TABLE(_, name, record, least, what) \
  total = next_line(total) + words_of(records_of(records, records.name), least);
  SCENE_TABLES(COUNT_TABLE, _)
#undef COUNT_TABLE
  words.reserve(total);
}

template <typename Record>
TableSpan append(std::span<const Record> records, int least, AlignedVector<std::uint32_t>& words) {
  const std::size_t offset = next_line(words.size());
  words.resize(offset);
  const auto* from = reinterpret_cast<const std::uint32_t*>(records.data());
  words.insert(words.end(), from, from + records.size() * (sizeof(Record) / 4));
  words.resize(offset + words_of(records, least));
  return {int(records.size()), std::uint32_t(offset)};
}

/// Kernels read the first triangle even for rays that hit nothing. If the scene has none, this adds one that
/// has an area, so that its normal is finite.
void put_placeholder_triangle(DeviceScene& scene) {
  const TableSpan span = scene.header.tables.triangles;
  if (span.count > 0) return;
  Triangle triangle{};
  triangle.p1.x = triangle.p2.y = 1.0f;
  triangle.light = triangle.normals = -1;
  std::memcpy(scene.words.data() + span.offset, &triangle, sizeof triangle);
}

}  // namespace

void store(SceneRecords&& records, DeviceScene& scene) {
  reserve(records, scene.words);
#define MOVE_TABLE(_, name, record, least, what)                                            \
  scene.header.tables.name = append(records_of(records, records.name), least, scene.words); \
  std::vector<record>().swap(records.name);
  SCENE_TABLES(MOVE_TABLE, _)
#undef MOVE_TABLE
  put_placeholder_triangle(scene);
}

}  // namespace penumbra
