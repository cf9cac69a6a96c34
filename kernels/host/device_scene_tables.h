// The tables of a device scene on the host.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kernels/host/device_scene.h"

namespace penumbra {

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

}  // namespace penumbra
