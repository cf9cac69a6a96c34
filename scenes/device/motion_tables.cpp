#include "scenes/device/motion_tables.h"

#include <algorithm>
#include <cmath>

#include "scenes/device/beam_lights.h"
#include "scenes/device/camera_builder.h"
#include "scenes/device/quadric_record.h"
#include "scenes/device/to_vec3.h"
#include "scenes/transform.h"

namespace penumbra {
namespace {

/// A singular matrix has no inverse. With a small share of that of the middle it has.
constexpr double kShareOfMiddle = 1e-6;
/// Of a quadric that is not there at a time; and its length.
constexpr float kNoRadius = 1e-15f;

glm::dmat4 regular(glm::dmat4 matrix, const glm::dmat4& middle) {
  if (!is_singular(matrix)) return matrix;
  for (int column = 0; column < 3; ++column) matrix[column] += kShareOfMiddle * middle[column];
  return matrix;
}

std::vector<bool> shapes_with_states(const SceneDescription& scene, const ExposedMotion& motion) {
  std::vector<bool> have(motion.shapes.size(), false);
  for (std::size_t i = 0; i < have.size(); ++i)
    have[i] = motion.shapes[i].steps > 0 && !moves_rigidly(scene, scene.motion->shapes[i]);
  return have;
}

}  // namespace

MotionTables::MotionTables(const SceneDescription& scene, const ExposedMotion& motion)
    : scene_(scene), motion_(motion), posed_(scene, shapes_with_states(scene, motion)) {
  rigid_.assign(scene.shapes.size(), -1);
  own_ = rigid_;
  instances_.assign(scene.instances.size(), -1);
  for (const ShapeGroup& group : scene.groups) in_groups_.emplace_back(group.shapes.size(), -1);
  if (scene.motion == nullptr) return;
  const SceneMotion& all = *scene.motion;
  for (std::size_t i = 0; i < all.shapes.size(); ++i) {
    const MovingShape& moving = all.shapes[i];
    middle_.emplace_back(1.0);
    if (motion.shapes[i].steps == 0) continue;
    middle_.back() = matrix_at(all, moving.place, motion.shapes[i].shown_at);
    Paths& paths = moving.group >= 0              ? in_groups_[std::size_t(moving.group)]
                   : moves_rigidly(scene, moving) ? rigid_
                                                  : own_;
    paths[moving.shape] = int(i);
  }
  for (std::size_t i = 0; i < all.instances.size(); ++i)
    if (motion.instances[i].steps > 0) instances_[all.instances[i].instance] = int(i);
}

vec3 MotionTables::local(const glm::dvec3& p) const { return to_vec3(p - origin_); }

const ExposedPath* MotionTables::path_of_shape(int group, std::size_t shape) const {
  const int path = path_of(group < 0 ? own_ : in_groups_[std::size_t(group)], shape);
  return path < 0 ? nullptr : &motion_.shapes[std::size_t(path)];
}

glm::dmat4 MotionTables::placed_at(const PlacedGroup& place, std::size_t k) const {
  const int path = path_of(instances_, place.instance);
  if (path < 0) return place.to_world;
  const glm::dmat4& middle = scene_.instances[place.instance].to_world;
  const ExposedPath& moving = motion_.instances[std::size_t(path)];
  const auto at = [&](std::size_t state) {
    return regular(moving.to_world[state], middle) * glm::inverse(middle) * place.to_world;
  };
  if (const int state = ExposedMotion::state_at(k, moving.steps); state >= 0) return at(std::size_t(state));
  const double where = double(k) * moving.steps / kFinestSteps;
  const auto before = std::size_t(where);
  const glm::dmat4 from = at(before), to = at(before + 1);
  return from + (where - double(before)) * (to - from);
}

double MotionTables::radius_about(const glm::dvec3& origin, std::span<const PlacedGroup> placed) const {
  double radius = 0;
  const auto include = [&](const SceneBounds& bounds) {
    if (!bounds.empty())
      radius = std::max(radius, glm::length(glm::max(bounds.high - origin, origin - bounds.low)));
  };
  for (std::size_t i = 0; i < scene_.shapes.size(); ++i) {
    if (const ExposedPath* path = path_of_shape(-1, i)) include(path->swept);
    const int rigid = path_of(rigid_, i);
    if (rigid < 0) continue;
    const SceneBounds middle = bounds_of(std::span(&scene_.shapes[i], 1));
    const glm::dmat4& from = middle_[std::size_t(rigid)];
    if (is_singular(from)) continue;
    for (const glm::dmat4& matrix : motion_.shapes[std::size_t(rigid)].to_world)
      include(bounds_of(middle, matrix * glm::inverse(from)));
  }
  std::vector<SceneBounds> groups;
  for (std::size_t g = 0; g < scene_.groups.size(); ++g) {
    groups.push_back(bounds_of(scene_.groups[g].shapes));
    for (std::size_t i = 0; i < scene_.groups[g].shapes.size(); ++i)
      if (const ExposedPath* path = path_of_shape(int(g), i)) groups.back().include(path->swept);
  }
  for (const PlacedGroup& place : placed) {
    const std::size_t times = moves(place.instance) ? motion_.times.size() : 1;
    for (std::size_t k = 0; k < times; ++k)
      include(bounds_of(groups[std::size_t(place.group)], placed_at(place, k)));
  }
  return radius;
}

void MotionTables::begin_primitives(const SceneRecords& records) {
  still_triangles_ = int(records.triangles.size());
  still_quadrics_ = int(records.quadrics.size());
}

void MotionTables::begin_shape(int group, std::size_t shape, const PlacedGroup* place,
                               const SceneRecords& records) {
  Source source{.group = group, .shape = shape};
  if (const ExposedPath* path = path_of_shape(group, shape)) source.steps = path->steps;
  if (place != nullptr) {
    source.place = *place;
    if (const int path = path_of(instances_, place->instance); path >= 0)
      source.steps = std::max(source.steps, motion_.instances[std::size_t(path)].steps);
  }
  source.first_triangle = int(records.triangles.size());
  source.first_quadric = int(records.quadrics.size());
  sources_.push_back(std::move(source));
  in_shape_ = true;
}

void MotionTables::end_shape(const SceneRecords& records) {
  Source& source = sources_.back();
  source.triangles = int(records.triangles.size()) - source.first_triangle;
  source.quadrics = int(records.quadrics.size()) - source.first_quadric;
  in_shape_ = false;
}

void MotionTables::add_instance(const PlacedGroup& place, const glm::dvec3& center) {
  Placement placement{.center = center};
  placement.steps = motion_.instances[std::size_t(path_of(instances_, place.instance))].steps;
  for (std::size_t k = 0; k < motion_.times.size(); ++k)
    if (ExposedMotion::state_at(k, placement.steps) >= 0) placement.states.push_back(placed_at(place, k));
  placements_.push_back(std::move(placement));
}

void MotionTables::add_rigid(std::size_t shape, const glm::dvec3& center) {
  const auto path = std::size_t(path_of(rigid_, shape));
  Placement placement{.center = center, .steps = motion_.shapes[path].steps};
  for (const glm::dmat4& matrix : motion_.shapes[path].to_world)
    placement.states.push_back(regular(matrix, middle_[path]) * glm::inverse(middle_[path]));
  placements_.push_back(std::move(placement));
}

Expected<void> MotionTables::fill(const glm::dvec3& origin, SceneRecords& records, LightBuilder& lights) {
  origin_ = origin;
  const Exposure& exposure = motion_.exposure;
  Shutter shutter{};
  shutter.still_triangles = still_triangles_;
  shutter.still_quadrics = still_quadrics_;
  shutter.still_instances = still_instances_;
  shutter.camera_steps = motion_.camera.steps;
  shutter.exposure = float(exposure.exposure);
  shutter.rolling = float(exposure.rolling);
  shutter.curve_knots = int(exposure.curve.size());
  records.shutter = {shutter};
  // The curve as a density over the exposure, and its integral up to each knot.
  std::vector<double> sums{0.0};
  for (std::size_t i = 1; i < exposure.curve.size(); ++i)
    sums.push_back(sums.back() + 0.5 * (exposure.curve[i - 1] + exposure.curve[i]));
  const double pieces = double(exposure.curve.size() - 1);
  for (const double value : exposure.curve)
    records.shutter_curve.push_back(float(value * pieces / sums.back()));
  for (const double sum : sums) records.shutter_curve.push_back(float(sum / sums.back()));

  for (Source& source : sources_) {
    source.triangle_states = {int(records.triangle_states.size()), source.triangles, source.steps};
    source.quadric_states = {int(records.quadric_states.size()), source.quadrics, source.steps};
    const auto states = std::size_t(states_of(source.steps));
    records.triangle_states.resize(records.triangle_states.size() + states * std::size_t(source.triangles));
    records.quadric_states.resize(records.quadric_states.size() + states * std::size_t(source.quadrics));
    for (int i = 0; i < source.triangles; ++i)
      records.triangle_motions.push_back({source.triangle_states.first + i, source.triangles, source.steps});
    for (int i = 0; i < source.quadrics; ++i)
      records.quadric_motions.push_back({source.quadric_states.first + i, source.quadrics, source.steps});
  }
  for (const Placement& placement : placements_) {
    records.instance_motions.push_back({int(records.instance_states.size()), 1, placement.steps});
    records.instance_states.resize(records.instance_states.size() + std::size_t(states_of(placement.steps)));
  }
  if (motion_.camera.steps > 0) records.camera_states.resize(std::size_t(states_of(motion_.camera.steps)));
  std::vector<Motion> of_lights(records.lights.size());
  bool lights_move = false;
  // Makes room for a light's states. Triangles that repeat each other share a light.
  const auto reserve = [&](int light, int steps) {
    if (light < 0 || steps == 0 || of_lights[std::size_t(light)].steps > 0) return;
    of_lights[std::size_t(light)] = {int(records.light_states.size()), 1, steps};
    records.light_states.resize(records.light_states.size() + std::size_t(states_of(steps)));
    lights_move = true;
  };
  for (const MovingLight& moving : emitters_) reserve(moving.light, motion_.emitters[moving.emitter].steps);
  for (const Source& source : sources_) {
    for (int i = 0; i < source.triangles; ++i)
      reserve(records.triangles[std::size_t(source.first_triangle + i)].light, source.steps);
    for (int i = 0; i < source.quadrics; ++i)
      reserve(records.quadrics[std::size_t(source.first_quadric + i)].light, source.steps);
  }
  if (lights_move) records.light_motions = std::move(of_lights);
  for (std::size_t k = 0; k < motion_.times.size(); ++k)
    if (auto done = add_states(k, records); !done) return done;
  if (lights_move) add_light_states(records, lights);
  return {};
}

Expected<void> MotionTables::add_states(std::size_t k, SceneRecords& records) {
  const bool poses =
      std::ranges::any_of(sources_,
                          [&](const Source& s) { return ExposedMotion::state_at(k, s.steps) >= 0; }) ||
      ExposedMotion::state_at(k, motion_.camera.steps) >= 0 ||
      std::ranges::any_of(emitters_, [&](const MovingLight& moving) {
        return ExposedMotion::state_at(k, motion_.emitters[moving.emitter].steps) >= 0;
      });
  if (poses) {
    if (auto done = posed_.set_time(motion_.times[k]); !done) return done;
    for (const Source& source : sources_)
      if (const int state = ExposedMotion::state_at(k, source.steps); state >= 0)
        if (auto done = add_states(source, k, state, records); !done) return done;
    if (const int state = ExposedMotion::state_at(k, motion_.camera.steps); state >= 0) {
      const CameraSettings& camera = posed_.parts().camera;
      records.camera_states[std::size_t(state)] =
          build_camera(camera, scene_.film, local(glm::dvec3(camera.to_world[3])));
    }
    for (const MovingLight& moving : emitters_) add_states_of_emitter(moving, k, records);
  }
  for (std::size_t i = 0; i < placements_.size(); ++i) {
    const Placement& placement = placements_[i];
    const int state = ExposedMotion::state_at(k, placement.steps);
    if (state < 0) continue;
    const glm::dmat4& matrix = placement.states[std::size_t(state)];
    records.instance_states[std::size_t(records.instance_motions[i].first + state)] = {
        to_vec3(glm::dvec3(matrix[0])), to_vec3(glm::dvec3(matrix[1])), to_vec3(glm::dvec3(matrix[2])),
        local(transform_point(matrix, placement.center))};
  }
  return {};
}

Expected<void> MotionTables::add_states(const Source& source, std::size_t k, int state,
                                        SceneRecords& records) {
  const Shape& still = source.group < 0 ? scene_.shapes[source.shape]
                                        : scene_.groups[std::size_t(source.group)].shapes[source.shape];
  const bool changes = path_of_shape(source.group, source.shape) != nullptr;
  const SceneDescription& parts = posed_.parts();
  const Shape& now = !changes           ? still
                     : source.group < 0 ? parts.shapes[source.shape]
                                        : parts.groups[std::size_t(source.group)].shapes[source.shape];
  Shape copy;
  const Shape* shape = &now;
  if (source.place) {
    auto placed = placed_shape(now, placed_at(*source.place, k));
    if (!placed) return std::unexpected(placed.error());
    copy = std::move(*placed);
    shape = &copy;
  }
  const auto* mesh = std::get_if<Mesh>(&shape->geometry);
  const float sign = shape->flip_normals ? -1.0f : 1.0f;
  for (int i = 0; i < source.triangles; ++i) {
    TriangleState& to =
        records.triangle_states[std::size_t(source.triangle_states.first + state * source.triangles + i)];
    const glm::uvec3 c = source.corners[std::size_t(i)];
    to.p0 = local(mesh->positions[c.x]);
    to.p1 = local(mesh->positions[c.y]);
    to.p2 = local(mesh->positions[c.z]);
    if (mesh->normals.empty()) continue;
    to.n0 = to_vec3(sign * mesh->normals[c.x]);
    to.n1 = to_vec3(sign * mesh->normals[c.y]);
    to.n2 = to_vec3(sign * mesh->normals[c.z]);
  }
  for (int i = 0; i < source.quadrics; ++i) {
    Quadric& to =
        records.quadric_states[std::size_t(source.quadric_states.first + state * source.quadrics + i)];
    const Quadric& record = records.quadrics[std::size_t(source.first_quadric + i)];
    to = quadric_record(*shape, [&](const glm::dvec3& p, double) { return local(p); }).value();
    to.radius = std::max(to.radius, kNoRadius);
    to.length = std::max(to.length, kNoRadius);
    to.front = record.front;
    to.back = record.back;
    to.light = record.light;
  }
  return {};
}

void MotionTables::add_states_of_emitter(const MovingLight& moving, std::size_t k, SceneRecords& records) {
  const int state = ExposedMotion::state_at(k, motion_.emitters[moving.emitter].steps);
  if (state < 0) return;
  const std::size_t emitter = scene_.motion->emitters[moving.emitter].emitter;
  const Light& light = records.lights[std::size_t(moving.light)];
  LightState to{light.p0, light.p1, light.p2, {}, {}, {}};
  set_light_state(
      posed_.parts().emitters[emitter], [&](const glm::dvec3& p) { return local(p); }, to);
  records.light_states[std::size_t(records.light_motions[std::size_t(moving.light)].first + state)] = to;
}

/// The states of lights that are shapes are those of their primitives.
void MotionTables::add_light_states(SceneRecords& records, LightBuilder& lights) {
  for (const Source& source : sources_) {
    const int states = states_of(source.steps);
    for (int i = 0; i < source.triangles; ++i) {
      const int light = records.triangles[std::size_t(source.first_triangle + i)].light;
      if (light < 0) continue;
      const int first = records.light_motions[std::size_t(light)].first;
      for (int s = 0; s < states; ++s) {
        const TriangleState& from =
            records.triangle_states[std::size_t(source.triangle_states.first + s * source.triangles + i)];
        records.light_states[std::size_t(first + s)] = {from.p0, from.p1, from.p2, {}, {}, {}};
      }
    }
    for (int i = 0; i < source.quadrics; ++i) {
      const Quadric& record = records.quadrics[std::size_t(source.first_quadric + i)];
      if (record.light < 0) continue;
      const int first = records.light_motions[std::size_t(record.light)].first;
      for (int s = 0; s < states; ++s) {
        const Quadric& q =
            records.quadric_states[std::size_t(source.quadric_states.first + s * source.quadrics + i)];
        const Light light = light_of_quadric(q);
        records.light_states[std::size_t(first + s)] = {light.p0, light.p1, light.p2, {}, {}, {}};
      }
    }
  }
  for (std::size_t i = 0; i < records.lights.size(); ++i) {
    const Motion& motion = records.light_motions[i];
    if (motion.steps == 0) continue;
    lights.cover(
        int(i),
        std::span(records.light_states).subspan(std::size_t(motion.first), std::size_t(motion.steps) + 1));
  }
}

}  // namespace penumbra
