// Assigns the matte IDs of a device scene and collects the names of their objects and materials.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "scenes/instances.h"
#include "scenes/matte_names.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// Names are those of the scene file, as UTF-8; invalid bytes become '?'. An unnamed object is called
/// "shape-N", the N-th of the scene counted from 1, or "instance-N". An unnamed material is called
/// "material-N", the N-th BSDF of the scene; an absorbing one is called "black". All shapes that an instance
/// places form one object, named after the instance, or else after its group.
class MatteBook {
 public:
  explicit MatteBook(const SceneDescription& scene) : scene_(scene) {}

  /// The matte ID, counted from 1, of the scene's shape of that index.
  int of_shape(std::size_t index);
  /// The matte ID of a copy of a group's shape, for shapes that are copied into the scene.
  int of_placed(const PlacedGroup& place, const Shape& shape);
  /// The matte ID of the first shape in the placed group that does not emit. Its other such shapes have the
  /// following IDs.
  int first_of(const PlacedGroup& place);

  [[nodiscard]] MatteNames names() && { return std::move(names_); }

 private:
  using Index = std::map<std::string, std::uint32_t>;
  static std::uint32_t index_of(const std::string& name, std::vector<std::string>& names, Index& index);
  [[nodiscard]] std::string material_name(const Shape& shape) const;
  std::uint32_t material_of(const Shape& shape);
  std::uint32_t object_of(const PlacedGroup& place);
  int number_of(MatteNames::Matte matte);

  const SceneDescription& scene_;
  MatteNames names_;
  Index objects_, materials_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> numbers_;  // keyed by object and material
  std::map<std::pair<std::uint32_t, int>, int> firsts_;             // keyed by object and group
};

}  // namespace penumbra
