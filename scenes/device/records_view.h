// A scene that is being built as kernels see it, without a copy of its tables. For sources that include
// kernels; after those.
#pragma once

#include <vector>

#include "kernels/scene.h"
#include "scenes/device/scene_records.h"

namespace penumbra {

/// Lives no longer than the records, which stay as they are.
class RecordsView {
 public:
  explicit RecordsView(const SceneRecords& records, const SceneHeader& header = {}) {
    scene_.header = header;
#define POINT_TO_RECORDS(_, name, record, least, what)         \
  scene_.name = pointer_to(records.name, least, padded_.name); \
  scene_.header.tables.name.count = int(records.name.size());
    SCENE_TABLES(POINT_TO_RECORDS, _)
#undef POINT_TO_RECORDS
  }
  RecordsView(const RecordsView&) = delete;
  RecordsView& operator=(const RecordsView&) = delete;

  [[nodiscard]] const Scene& scene() const { return scene_; }

 private:
  /// Where kernels read more records than there are, zeros follow them.
  template <typename Record>
  static const Record* pointer_to(const std::vector<Record>& records, std::size_t least,
                                  std::vector<Record>& padded) {
    if (records.size() >= least) return records.data();
    padded = records;
    padded.resize(least);
    return padded.data();
  }

  SceneRecords padded_;
  Scene scene_{};
};

}  // namespace penumbra
