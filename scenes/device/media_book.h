// The tables of participating media, of interiors of materials, and of the surfaces that bound them.
#pragma once

#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "scenes/device/scene_records.h"
#include "scenes/instances.h"
#include "scenes/interiors.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// The names of shapes that bound media, by the number of the boundary: first of the scene's own shapes, then
/// of each group's.
std::map<int, std::string> boundary_names(const SceneDescription& scene);

class MediaBook {
 public:
  /// The book is empty unless the scene's integrator supports media, and one of these holds: the camera is in
  /// a medium; a shape of the scene or of a placed group bounds one; a BSDF is a thin pane. Integrators that
  /// follow paths also see the interiors of materials, if a shape has one. Shapes whose material has an
  /// interior bound that, whatever medium they name.
  MediaBook(const SceneDescription& scene, const std::vector<PlacedGroup>& placed);

  [[nodiscard]] bool empty() const { return empty_; }

  /// Whether a shape bounds the interior of a material.
  [[nodiscard]] bool has_interiors() const { return !empty_ && has_interiors_; }

  /// Whether the integrator sees interiors of materials.
  [[nodiscard]] bool sees_interiors() const { return penumbra::sees_interiors(scene_.integrator); }

  /// Whether any declared medium is homogeneous and scatters.
  [[nodiscard]] bool has_homogeneous() const;

  /// The number of the boundary that the scene's shape of that index is, or -1. The other overload takes a
  /// group's shape.
  [[nodiscard]] int of_shape(std::size_t index) const;
  [[nodiscard]] int of_group(int group, std::size_t index) const;

  /// The index of the record of a medium, given by its index in the scene or as kNoMedium (vacuum).
  /// Vacuum, too, stands for media that the integrator does not see.
  [[nodiscard]] int record_of(int medium) const {
    return medium == kNoMedium || records_.empty() ? 0 : records_[std::size_t(medium)];
  }

  /// Fills the tables of media, phase functions and boundaries, and appends a material for each phase
  /// function, and for what leaves walks. Does nothing if the book is empty. `center`: the centre of the
  /// scene, which is the origin of the kernels' coordinates.
  Expected<void> fill(const glm::dvec3& center, SceneRecords& records);

 private:
  /// What becomes a record.
  struct Entry {
    const ParticipatingMedium* medium;
    const Interior* interior;  ///< null: a declared medium
  };

  void add(const Shape& shape, std::size_t number);
  void find_equal_media();
  void find_interiors();
  int record(const Entry& entry);

  const SceneDescription& scene_;
  bool empty_ = true, has_interiors_ = false;
  std::vector<Entry> entries_;  ///< all different; record 0 is vacuum, entry k is record k + 1
  /// For each medium of the scene its record's number; equal media share one. Vacuum for media that are not
  /// seen.
  std::vector<int> records_;
  std::deque<Interior> interiors_;
  std::vector<int> interior_records_;  ///< for each BSDF its interior's record, or 0
  /// For each group the number of its first shape, counted after the scene's shapes.
  std::vector<std::size_t> firsts_;
  std::vector<Boundary> boundaries_;
  std::map<std::size_t, int> numbers_;  ///< boundary numbers, keyed by the numbers of shapes
};

}  // namespace penumbra
