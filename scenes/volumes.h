// Volumes as scene files describe them: colours that may vary in space, and the parameters of their plugins,
// one table row for each (see bsdfs.h).
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "scenes/grid_volume.h"
#include "scenes/plugin_values.h"

namespace penumbra {

/// A colour in linear Rec. 709: a constant, or a grid; `value` is 1 if there is a grid.
struct GriddedColour {
  glm::vec3 value{0.0f};
  std::optional<GridVolume> grid{};
  glm::dmat4 to_world{1.0};  ///< of a constant volume: the transform of the unit cube that it fills
  GriddedColour() = default;
  GriddedColour(const glm::vec3& plain) : value(plain) {}
  /// An upper bound of the colour over space.
  [[nodiscard]] glm::vec3 most() const {
    return grid ? glm::vec3(std::ranges::max(grid->grid->values)) : value;
  }
};

inline std::string print_default(const GriddedColour& colour) { return print_default(colour.value); }

struct GridVolumeParameters {
  static constexpr const char* kPlugin = "gridvolume";
  static constexpr const char* kText =
      "values on a grid, from a file; they are at the centres of cells that fill the unit cube of to_world, "
      "and constant beyond the outermost";
  enum Wrap { kClamp, kRepeat, kZero };
  std::string filename;
  glm::dmat4 to_world{1.0};
  bool nearest = false;
  int wrap = kClamp;
  bool use_grid_bbox = false;

  template <typename Row>
  static void parameters(const Row& row) {
    row("filename", &GridVolumeParameters::filename, FileName{}, "the volume file");
    row("to_world", &GridVolumeParameters::to_world, AnyTransform{}, "where the unit cube is");
    row("filter_type", &GridVolumeParameters::nearest, OneOf<bool>{{{"trilinear", false}, {"nearest", true}}},
        "what is between the centres of cells");
    row("wrap_mode", &GridVolumeParameters::wrap,
        OneOf<int>{{{"clamp", kClamp}, {"mirror", kClamp}, {"repeat", kRepeat}, {"zero", kZero}}},
        "what is beyond the outermost centres; repeat is clamp here. zero: a layer of cells of 0 around the "
        "grid, as in OpenVDB's. Not in Mitsuba");
    row("use_grid_bbox", &GridVolumeParameters::use_grid_bbox, TrueOrFalse{},
        "the grid fills the box that its file says instead of the unit cube");
  }
  void complete(Findings& findings) const {
    if (wrap == kRepeat)
      findings.push_back(
          {"",
           "beyond the outermost centres of its cells a grid is constant, so wrap_mode 'repeat' "
           "is 'clamp'; it differs within half a cell of the faces of its box",
           true});
  }
};

}  // namespace penumbra
