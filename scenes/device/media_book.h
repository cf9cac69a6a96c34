// The tables of participating media and of the surfaces that bound them.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "scenes/device/scene_records.h"
#include "scenes/instances.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// The names of shapes that bound media, by the number of the boundary: first of the scene's own shapes, then
/// of each group's.
std::map<int, std::string> boundary_names(const SceneDescription& scene);

class MediaBook {
 public:
  /// The book is empty unless the scene's integrator supports media, and one of these holds: the camera is in
  /// a medium; a shape of the scene or of a placed group bounds one; a BSDF is a thin pane.
  MediaBook(const SceneDescription& scene, const std::vector<PlacedGroup>& placed);

  [[nodiscard]] bool empty() const { return empty_; }

  /// Whether any medium is homogeneous and scatters.
  [[nodiscard]] bool has_homogeneous() const;

  /// The number of the boundary that the scene's shape of that index is, or -1. The other overload takes a
  /// group's shape.
  [[nodiscard]] int of_shape(std::size_t index) const;
  [[nodiscard]] int of_group(int group, std::size_t index) const;

  /// The index of the record of a medium, given by its index in the scene or as kNoMedium (vacuum).
  [[nodiscard]] int record_of(int medium) const {
    return medium == kNoMedium ? 0 : records_[std::size_t(medium)];
  }

  /// Fills the tables of media, phase functions and boundaries, and appends a material for each phase
  /// function. Does nothing if the book is empty. `center`: the centre of the scene, which is the origin of
  /// the kernels' coordinates.
  Expected<void> fill(const glm::dvec3& center, SceneRecords& records);

 private:
  void add(const Shape& shape, std::size_t number);
  void find_equal_media();

  const SceneDescription& scene_;
  bool empty_ = true;
  /// For each medium of the scene its record's number, from 1 on; equal media share one.
  std::vector<int> records_;
  int count_ = 0;  ///< number of different media
  /// For each group the number of its first shape, counted after the scene's shapes.
  std::vector<std::size_t> firsts_;
  std::vector<Boundary> boundaries_;
  std::map<std::size_t, int> numbers_;  ///< boundary numbers, keyed by the numbers of shapes
};

}  // namespace penumbra
