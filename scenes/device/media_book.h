// The tables of participating media: what fills space, and which surfaces part what.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "scenes/device/scene_records.h"
#include "scenes/instances.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// The names of the shapes that bound media, by the numbers that boundaries have for them: of the scene's own
/// shapes, then of each group's.
std::map<int, std::string> boundary_names(const SceneDescription& scene);

class MediaBook {
 public:
  /// Empty, unless the scene's integrator sees media and the camera is in one, a shape of the scene or of a
  /// group in a place bounds one, or a thin pane is among its BSDFs.
  MediaBook(const SceneDescription& scene, const std::vector<PlacedGroup>& placed);

  [[nodiscard]] bool empty() const { return empty_; }

  /// Whether a medium is the same everywhere and scatters.
  [[nodiscard]] bool has_homogeneous() const;

  /// The boundary that the scene's shape of that index is, or -1; likewise of a group's.
  [[nodiscard]] int of_shape(std::size_t index) const;
  [[nodiscard]] int of_group(int group, std::size_t index) const;

  /// The number of the record of the scene's medium of that index, or of nothing for kNoMedium.
  [[nodiscard]] int record_of(int medium) const {
    return medium == kNoMedium ? 0 : records_[std::size_t(medium)];
  }

  /// Sets the tables of media, of their phase functions and of boundaries, and appends a material for each
  /// phase function. Nothing if it is empty. `center`: of the scene, where the kernels' coordinates begin.
  Expected<void> fill(const glm::dvec3& center, SceneRecords& records);

 private:
  void add(const Shape& shape, std::size_t number);
  void find_equal_media();

  const SceneDescription& scene_;
  bool empty_ = true;
  std::vector<int> records_;         ///< of each of the scene's media: from 1 on, the same for equal ones
  int count_ = 0;                    ///< of media that differ
  std::vector<std::size_t> firsts_;  ///< of each group: the number of its first shape, after the scene's
  std::vector<Boundary> boundaries_;
  std::map<std::size_t, int> numbers_;  ///< of boundaries, by those of shapes
};

}  // namespace penumbra
