// Finished cells of a report on disk: an image and what was measured of it. A cell is there once its JSON is,
// which is written last, so an interrupted report goes on where it was.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "kernels/host/error.h"
#include "scheduler/image/image.h"
#include "scheduler/report/report_data.h"

namespace penumbra {

/// What a cell's image and times depend on: any text, hashed into the cell's name.
struct CellId {
  std::string name;  ///< for people: scene, method, budget, seed
  std::string key;   ///< 16 hexadecimal digits
};

/// `settings` is everything that the cell depends on; its hash is the key. Characters of `name` that are not
/// for file names become '_'.
CellId make_cell_id(const std::string& name, const nlohmann::ordered_json& settings);

class CellStore {
 public:
  /// The folder is made with its first cell. Error: it could not be written to.
  static Expected<CellStore> open(const std::filesystem::path& folder);

  [[nodiscard]] std::filesystem::path image_path(const CellId& id) const;
  /// The cell if it is finished and all of it is as it was stored. `damage`, if given, becomes what is wrong
  /// with one that is there all the same; it counts as not there.
  [[nodiscard]] std::optional<ImageResult> find(const CellId& id, std::string* damage = nullptr) const;
  /// Writes the image's R, G, B, then the JSON. `settings` as for make_cell_id.
  Expected<void> save(const CellId& id, const Image& image, const ImageResult& result,
                      const nlohmann::ordered_json& settings) const;

 private:
  explicit CellStore(std::filesystem::path folder) : folder_(std::move(folder)) {}
  [[nodiscard]] std::filesystem::path json_path(const CellId& id) const;
  std::filesystem::path folder_;
};

/// The channels R, G, B alone: what a report compares.
Image beauty_only(const Image& image);

}  // namespace penumbra
