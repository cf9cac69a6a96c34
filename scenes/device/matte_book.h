// The numbers of a device scene's mattes, and the names of their objects and materials.
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

/// Names are those of the file, as UTF-8: other bytes become '?'. Where it has none, an object is "shape-N",
/// the N-th of the scene from 1 on, or "instance-N"; a material is "material-N", the N-th BSDF of the scene,
/// and what absorbs everything "black". All that an instance places is one object: the instance, or else its
/// group.
class MatteBook {
 public:
  explicit MatteBook(const SceneDescription& scene) : scene_(scene) {}

  /// Of a shape of the scene, by its index: a number from 1 on.
  int of_shape(std::size_t index);
  /// Of a group's shape in a place, such as are in the scene themselves.
  int of_placed(const PlacedGroup& place, const Shape& shape);
  /// Of the group's first shape that does not emit in that place; those that follow have the next numbers.
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
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> numbers_;  // of objects with their materials
  std::map<std::pair<std::uint32_t, int>, int> firsts_;             // of objects and their groups
};

}  // namespace penumbra
