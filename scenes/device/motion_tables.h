// Fills the tables of what moves while the shutter is open, see kernels/motion/motion.h.
#pragma once

#include <cstddef>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/device/light_builder.h"
#include "scenes/device/scene_records.h"
#include "scenes/instances.h"
#include "scenes/motion/exposed_motion.h"

namespace penumbra {

/// What is added to the device scene of the middle of the exposure. Everything is called in the order of the
/// records: first what is still is added, then what moves.
class MotionTables {
 public:
  /// `scene`: at the middle of the exposure. Both must outlive this.
  MotionTables(const SceneDescription& scene, const ExposedMotion& motion);

  /// Whether one of the scene's own shapes moves as a rigid body, or another way.
  [[nodiscard]] bool is_rigid(std::size_t shape) const { return path_of(rigid_, shape) >= 0; }
  [[nodiscard]] bool changes(std::size_t shape) const { return path_of(own_, shape) >= 0; }
  /// Whether a shape of a group moves within it.
  [[nodiscard]] bool changes(int group, std::size_t shape) const {
    return path_of(in_groups_[std::size_t(group)], shape) >= 0;
  }
  /// Whether an instance of the scene moves.
  [[nodiscard]] bool moves(std::size_t instance) const { return path_of(instances_, instance) >= 0; }

  /// The radius of a sphere about the origin of the device scene that holds everything that moves, at all
  /// times.
  [[nodiscard]] double radius_about(const glm::dvec3& origin, std::span<const PlacedGroup> placed) const;

  /// What comes now moves.
  void begin_primitives(const SceneRecords& records);
  void begin_instances(const SceneRecords& records) { still_instances_ = int(records.instances.size()); }

  /// The shape that is added next, until `end_shape`. `place`: null if it is one of the scene's own; else it
  /// is copied to there.
  void begin_shape(int group, std::size_t shape, const PlacedGroup* place, const SceneRecords& records);
  void end_shape(const SceneRecords& records);
  /// Whether a shape is being added that moves.
  [[nodiscard]] bool in_shape() const { return in_shape_; }
  /// The corners of a triangle of that shape's mesh, in the order of the record.
  void add_corners(const glm::uvec3& corners) { sources_.back().corners.push_back(corners); }

  /// The instance that is added next, with the centre of its group.
  void add_instance(const PlacedGroup& place, const glm::dvec3& center);
  void add_rigid(std::size_t shape, const glm::dvec3& center);
  void add_emitter(std::size_t emitter, int light) { emitters_.push_back({emitter, light}); }

  /// Fills the tables, and makes the lights' bounds those of the whole time. Lights and primitives must be
  /// complete. `origin`: that of the device scene. Errors: those of set_time and placed_shape.
  Expected<void> fill(const glm::dvec3& origin, SceneRecords& records, LightBuilder& lights);

 private:
  /// Indices into a list of SceneMotion by those of what moves; -1: it is still.
  using Paths = std::vector<int>;
  static int path_of(const Paths& paths, std::size_t index) {
    return index < paths.size() ? paths[index] : -1;
  }

  /// A shape of which each primitive has states.
  struct Source {
    int group = -1;
    std::size_t shape = 0;
    std::optional<PlacedGroup> place = {};
    int steps = 0;
    int first_triangle = 0, triangles = 0, first_quadric = 0, quadrics = 0;
    std::vector<glm::uvec3> corners = {};
    Motion triangle_states{}, quadric_states{};  ///< of the first one
  };
  struct Placement {
    std::vector<glm::dmat4> states = {};  ///< to the world from where the group's record is
    glm::dvec3 center{0.0};
    int steps = 0;
  };
  struct MovingLight {
    std::size_t emitter;
    int light;
  };

  [[nodiscard]] const ExposedPath* path_of_shape(int group, std::size_t shape) const;
  /// Where a moving instance brings the place at times[k]: between its states, linear as kernels have it.
  [[nodiscard]] glm::dmat4 placed_at(const PlacedGroup& place, std::size_t k) const;
  [[nodiscard]] int states_of(int steps) const { return steps + 1 + (motion_.has_layer ? 2 : 0); }
  Expected<void> add_states(std::size_t k, SceneRecords& records);
  Expected<void> add_states(const Source& source, std::size_t k, int state, SceneRecords& records);
  void add_light_states(SceneRecords& records, LightBuilder& lights);
  void add_states_of_emitter(const MovingLight& moving, std::size_t k, SceneRecords& records);
  [[nodiscard]] vec3 local(const glm::dvec3& p) const;

  const SceneDescription& scene_;
  const ExposedMotion& motion_;
  PosedParts posed_;
  Paths rigid_, own_, instances_;
  std::vector<Paths> in_groups_;
  std::vector<glm::dmat4> middle_;  ///< where each moving shape is in the scene, see ExposedPath::shown_at
  glm::dvec3 origin_{0.0};
  int still_triangles_ = 0, still_quadrics_ = 0, still_instances_ = 0;
  bool in_shape_ = false;
  std::vector<Source> sources_;
  std::vector<Placement> placements_;
  std::vector<MovingLight> emitters_;
};

}  // namespace penumbra
