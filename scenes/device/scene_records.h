// The records of all tables of a device scene under construction.
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "kernels/host/device_scene.h"

namespace penumbra {

struct SceneRecords {
#define TABLE_RECORDS(_, name, record, least, what) std::vector<record> name;
  SCENE_TABLES(TABLE_RECORDS, _)
#undef TABLE_RECORDS
  /// The texels if they are in another scene, which must outlive the records; `texels` is empty then.
  std::span<const std::uint32_t> earlier_texels = {};
};

/// The records of a table, which is a member of `all`.
template <typename Record>
std::span<const Record> records_of(const SceneRecords& all, const std::vector<Record>& table) {
  if constexpr (std::is_same_v<Record, std::uint32_t>)
    if (&table == &all.texels && !all.earlier_texels.empty()) return all.earlier_texels;
  return table;
}

/// Appends all tables to the scene's words. Each table begins at a cache line and is padded with zeros if
/// kernels read more records than it has. Each table is freed once it is stored.
void store(SceneRecords&& records, DeviceScene& scene);

}  // namespace penumbra
