// Presents a scene under construction to kernel code without copying its tables. Include it after the
// kernels' headers.
#pragma once

#include <vector>

#include "kernels/scene.h"
#include "scenes/device/scene_records.h"

namespace penumbra {

/// The records must outlive the view and must not change meanwhile.
class RecordsView {
 public:
  explicit RecordsView(const SceneRecords& records, const SceneHeader& header = {}) {
    scene_.header = header;
#define POINT_TO_RECORDS(_, name, record, least, what)                              \
  scene_.name = pointer_to(records_of(records, records.name), least, padded_.name); \
  scene_.header.tables.name.count = int(records_of(records, records.name).size());
    SCENE_TABLES(POINT_TO_RECORDS, _)
#undef POINT_TO_RECORDS
  }
  RecordsView(const RecordsView&) = delete;
  RecordsView& operator=(const RecordsView&) = delete;

  [[nodiscard]] const Scene& scene() const { return scene_; }

 private:
  /// Pads a table with zeros if kernels read more records than it has.
  template <typename Record>
  static const Record* pointer_to(std::span<const Record> records, std::size_t least,
                                  std::vector<Record>& padded) {
    if (records.size() >= least) return records.data();
    padded.assign(records.begin(), records.end());
    padded.resize(least);
    return padded.data();
  }

  SceneRecords padded_;
  Scene scene_{};
};

}  // namespace penumbra
