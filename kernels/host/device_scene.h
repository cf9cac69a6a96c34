// The device scene, which kernels read: one header and one flat array of 32-bit words. The scheduler builds
// it once from a scene description and sends it unchanged to every worker, so that all of them trace the same
// bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kernels/host/cache_aligned.h"
#include "kernels/host/error.h"
#include "kernels/scene_types.h"

namespace penumbra {

/// Paths that a CPU thread has under way at once: enough that few lanes are idle after compaction, and few
/// enough that their state fits a 1 MiB L2 cache together with the scene. 512 are 20 % slower, 8192 some 5 %.
constexpr int kBlockPaths = 2048;
constexpr std::uint32_t kMaxSamplesPerUnit = 4096;  ///< a block holds all samples of a pixel at once

/// In a scene with motion: how many records at the beginning of these tables belong to what never moves. The
/// tree over them needs no change in another frame.
struct StillRecords {
  int triangles = 0, quadrics = 0;                         ///< those of still groups and of the scene itself
  int groups = 0, instances = 0;                           ///< the scene itself is the first group
  int nodes = 0, triangle_leaves = 0, quadric_leaves = 0;  ///< 0: not built
  int root_children = 0;                                   ///< the first ones of node 0
  double extent = 0;  ///< of the whole scene, for which the instances' bounds have margins
};

struct DeviceScene {
  SceneHeader header{};
  AlignedVector<std::uint32_t> words;  ///< the tables, at the offsets in the header
  StillRecords still{};                ///< for the builder of another frame; not serialised

  /// Serialised form: `head` (magic number, version and header), then `body` (the words), little-endian.
  [[nodiscard]] std::vector<std::uint8_t> serialize() const;
  [[nodiscard]] std::vector<std::uint8_t> head() const;
  [[nodiscard]] std::span<const std::uint8_t> body() const;  ///< the words
  /// Errors: wrong magic number, version or size; an offset, index or count that points outside of the data.
  static Expected<DeviceScene> deserialize(std::span<const std::uint8_t> bytes);
};

/// Deserialises a scene from pieces, so that there are never two copies of it.
class DeviceSceneReader {
 public:
  /// `total`: the number of bytes, if it is known.
  explicit DeviceSceneReader(std::optional<std::size_t> total = {}) : total_(total) {}

  /// Errors: those of DeviceScene::deserialize that the header shows; not enough memory for the announced
  /// size.
  Expected<void> add(std::span<const std::uint8_t> bytes);
  /// Call it after all pieces. Errors: as DeviceScene::deserialize.
  Expected<DeviceScene> finish();

 private:
  Expected<void> begin();

  std::optional<std::size_t> total_;
  std::vector<std::uint8_t> head_;  ///< the head's bytes, until it is complete
  std::size_t received_ = 0, expected_ = 0;
  DeviceScene scene_;
};

/// A row of SCENE_TABLES.
struct SceneTable {
  const char* what;  ///< name for users
  std::size_t record_bytes;
  int least;  ///< records that exist whatever the count
  TableSpan TableSpans::*span;

  [[nodiscard]] std::uint64_t bytes(const TableSpans& tables) const {
    return std::uint64_t((tables.*span).count) * record_bytes;
  }
};

#define LIST_TABLE(_, name, record, least, what) {what, sizeof(record), least, &TableSpans::name},
inline constexpr SceneTable kSceneTables[] = {SCENE_TABLES(LIST_TABLE, _)};
#undef LIST_TABLE

/// The records of a table.
template <typename Record>
std::span<const Record> table(const DeviceScene& scene, TableSpan span) {
  return {reinterpret_cast<const Record*>(scene.words.data() + span.offset), std::size_t(span.count)};
}

/// Checks that every table is inside the words (including the records that kernels read in empty tables),
/// every index is inside its table, and every enumerated value is known.
Expected<void> check_device_scene(const DeviceScene& scene);

/// Whether it has a coat with a normal of its own.
inline bool has_own_coat(const Material& m) {
  return (OPENPBRS_LAYERED >> m.family & 1u) != 0u && (m.variant & OPENPBR_OWN_COAT) != 0;
}

/// The closure of a material without textures.
inline Closure closure_of(const Material& m) {
  Closure c;
#define COPY_FIELD(_, type, name) c.name = m.name;
  CLOSURE_FIELDS(COPY_FIELD, _)
#undef COPY_FIELD
  return c;
}

}  // namespace penumbra
