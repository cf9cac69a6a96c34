// A scene that is being built as kernels see it, without a copy of its tables. For sources that include
// kernels; after those.
#pragma once

#include <algorithm>

#include "kernels/scene.h"
#include "scenes/device/scene_records.h"

namespace penumbra {

/// Lives no longer than the records, which stay as they are.
class RecordsView {
 public:
  explicit RecordsView(const SceneRecords& records, const SceneHeader& header = {}) {
    scene_.header = header;
#define POINT_TO_RECORDS(_, name, record, least, what)                               \
  scene_.name = records.name.data();                                                 \
  scene_.header.tables.name.count = int(records.name.size());                        \
  if (records.name.size() < std::size_t(least)) { /* zeros follow those there are */ \
    padded_.name = records.name;                                                     \
    padded_.name.resize(std::size_t(least));                                         \
    scene_.name = padded_.name.data();                                               \
  }
    SCENE_TABLES(POINT_TO_RECORDS, _)
#undef POINT_TO_RECORDS
  }
  RecordsView(const RecordsView&) = delete;
  RecordsView& operator=(const RecordsView&) = delete;

  [[nodiscard]] const Scene& scene() const { return scene_; }

 private:
  SceneRecords padded_;
  Scene scene_{};
};

}  // namespace penumbra
