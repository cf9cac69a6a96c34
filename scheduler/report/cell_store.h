// Stores the finished cells of a report on disk: an image and its measurements. A cell exists if its JSON
// file does, which is written last. So an interrupted report can be resumed.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "kernels/host/error.h"
#include "scheduler/image/image.h"
#include "scheduler/report/report_data.h"

namespace penumbra {

/// Identifies a cell by everything on which its image and times depend.
struct CellId {
  std::string name;  ///< for display: scene, method, budget, seed
  std::string key;   ///< 16 hexadecimal digits
};

/// `settings` is everything on which the cell depends; its hash is the key. Characters of `name` that are not
/// allowed in file names become '_'.
CellId make_cell_id(const std::string& name, const nlohmann::ordered_json& settings);

class CellStore {
 public:
  /// The folder is created with the first cell. Error: it is not writable.
  static Expected<CellStore> open(const std::filesystem::path& folder);

  [[nodiscard]] std::filesystem::path image_path(const CellId& id) const;
  /// The cell, if it is finished and unchanged. If it exists but is damaged, it is treated as missing, and
  /// `damage`, if not null, is set to the reason.
  [[nodiscard]] std::optional<ImageResult> find(const CellId& id, std::string* damage = nullptr) const;
  /// Writes the image's R, G, B, then the JSON. For `settings` see make_cell_id.
  Expected<void> save(const CellId& id, const Image& image, const ImageResult& result,
                      const nlohmann::ordered_json& settings) const;

 private:
  explicit CellStore(std::filesystem::path folder) : folder_(std::move(folder)) {}
  [[nodiscard]] std::filesystem::path json_path(const CellId& id) const;
  std::filesystem::path folder_;
};

/// Only the channels R, G, B, which a report compares.
Image beauty_only(const Image& image);

}  // namespace penumbra
