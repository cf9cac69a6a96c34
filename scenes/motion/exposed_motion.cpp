#include "scenes/motion/exposed_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "kernels/host/parallel.h"
#include "scenes/instances.h"
#include "scenes/panoramas.h"
#include "scenes/transform.h"

namespace penumbra {
namespace {

bool same(const Mesh& a, const Mesh& b) { return a.positions == b.positions && a.normals == b.normals; }
bool same(const Sphere& a, const Sphere& b) {
  return a.center == b.center && a.radius == b.radius && a.x_axis == b.x_axis && a.y_axis == b.y_axis &&
         a.z_axis == b.z_axis;
}
bool same(const Disk& a, const Disk& b) {
  return a.center == b.center && a.normal == b.normal && a.radius == b.radius && a.x_axis == b.x_axis &&
         a.y_axis == b.y_axis;
}
bool same(const Cylinder& a, const Cylinder& b) {
  return a.center == b.center && a.axis == b.axis && a.radius == b.radius && a.length == b.length &&
         a.x_axis == b.x_axis && a.y_axis == b.y_axis;
}
bool same(const Curves&, const Curves&) { return true; }  // they do not move
bool same(const Geometry& a, const Geometry& b) {
  return a.index() == b.index() &&
         std::visit([&](const auto& one) { return same(one, std::get<std::decay_t<decltype(one)>>(b)); }, a);
}
bool same(const CameraSettings& a, const CameraSettings& b) {
  return a.to_world == b.to_world && a.fov == b.fov && a.focus_distance == b.focus_distance &&
         a.aperture_radius == b.aperture_radius && a.scale_x == b.scale_x && a.scale_y == b.scale_y;
}

/// Irregular times, at which a motion that repeats itself with the steps is seen all the same: one in each of
/// 2 kFinestSteps intervals. From 0 to 1.
std::vector<double> between_times() {
  constexpr double kGoldenRatio = 0.61803398874989485;
  std::vector<double> times;
  for (int i = 0; i < 2 * kFinestSteps; ++i)
    times.push_back((i + std::fmod((i + 1) * kGoldenRatio, 1.0)) / (2.0 * kFinestSteps));
  return times;
}

/// Which numbers of steps follow a path closely enough.
class StepChoice {
 public:
  /// `deviation(i, j, f)`: in pixels, at the time that is looked at, if the position is between the finest
  /// states i and j. `at`: the time from 0 to 1.
  void look(double at, const auto& deviation) {
    for (std::size_t c = 0; c < kChoices; ++c) {
      if (worst_[c] > kMostDeviation && c + 1 < kChoices) continue;
      const int steps = 1 << c, stride = kFinestSteps / steps;
      const int step = std::min(int(at * steps), steps - 1);
      worst_[c] = std::max(worst_[c], deviation(step * stride, (step + 1) * stride, at * steps - step));
    }
  }
  /// The choice if the motion is known at all of these times; no more is computed than that takes.
  /// `deviation(k, i, j, f)`: at time k.
  static StepChoice of(std::span<const double> times, const auto& deviation) {
    StepChoice made;
    for (std::size_t c = 0; c < kChoices; ++c) {
      const int steps = 1 << c, stride = kFinestSteps / steps;
      double& worst = made.worst_[c];
      for (std::size_t k = 0; k < times.size() && (worst <= kMostDeviation || c + 1 == kChoices); ++k) {
        const int step = std::min(int(times[k] * steps), steps - 1);
        worst = std::max(worst, deviation(k, step * stride, (step + 1) * stride, times[k] * steps - step));
      }
      if (worst <= kMostDeviation) break;
    }
    return made;
  }

  [[nodiscard]] int steps() const {
    std::size_t c = 0;
    while (c + 1 < kChoices && worst_[c] > kMostDeviation) ++c;
    return 1 << c;
  }
  [[nodiscard]] double worst() const { return worst_.back(); }

 private:
  static constexpr std::size_t kChoices = 7;
  static_assert(1 << (kChoices - 1) == kFinestSteps);
  std::array<double, kChoices> worst_{};
};

/// Points that follow the linear motion of the shape's record.
std::vector<glm::dvec3> points_of(const Shape& shape) {
  if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) return mesh->positions;
  std::vector<glm::dvec3> points;
  const auto add = [&](const glm::dvec3& center, double radius, const glm::dvec3& axis) {
    points = {center, glm::dvec3(radius, 0.0, 0.0), axis};
  };
  const bool textured = shape.radiance_texture != kNoTexture;
  if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
    add(sphere->center, sphere->radius, textured ? sphere->radius * sphere->z_axis : glm::dvec3(0.0));
    if (textured) points.push_back(sphere->radius * sphere->x_axis);
  }
  if (const auto* disk = std::get_if<Disk>(&shape.geometry)) {
    add(disk->center, disk->radius, disk->radius * disk->normal);
    if (textured) points.push_back(disk->radius * disk->x_axis);
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
    add(cylinder->center, cylinder->radius, cylinder->length * cylinder->axis);
    if (textured) points.push_back(cylinder->radius * cylinder->x_axis);
  }
  return points;
}

SceneBounds bounds_of_rest(const Geometry& geometry) {
  SceneBounds bounds;
  if (const auto* mesh = std::get_if<Mesh>(&geometry)) {
    for (const glm::dvec3& p : mesh->positions) bounds.include(p);
    return bounds;
  }
  Shape shape;
  shape.geometry = geometry;
  return bounds_of(std::span(&shape, 1));
}

std::array<glm::dvec3, 8> corners_of(const SceneBounds& box) {
  std::array<glm::dvec3, 8> corners;
  for (unsigned i = 0; i < 8; ++i)
    corners[i] = {(i & 1u) != 0 ? box.high.x : box.low.x, (i & 2u) != 0 ? box.high.y : box.low.y,
                  (i & 4u) != 0 ? box.high.z : box.low.z};
  return corners;
}

glm::dvec3 between(const glm::dvec3& a, const glm::dvec3& b, double f) { return a + f * (b - a); }

/// How the camera of one time sees.
struct Eye {
  glm::dvec3 at{0.0}, x{0.0}, y{0.0}, z{0.0};  ///< see Camera
  double lens = 0.0, focus = 1.0;
  double near_clip = 0.0, pixels = 0.0;  ///< a pixel's number per unit of the image, an upper bound
  bool parallel = false, panorama = false;

  Eye() = default;
  Eye(const CameraSettings& camera, const Film& film) {
    const HalfFilm half = half_film(camera, film);
    const glm::dmat3 axes(camera.to_world);
    at = glm::dvec3(camera.to_world[3]);
    x = glm::normalize(axes[0]) * half.x;
    y = glm::normalize(axes[1]) * half.y;
    z = glm::normalize(axes[2]);
    lens = camera.aperture_radius;
    focus = camera.focus_distance;
    near_clip = camera.near_clip;
    parallel = camera.projection == Projection::kOrthographic;
    panorama = is_panorama(camera.projection);
    if (panorama) {
      pixels = pixels_per_radian(camera, film);
      return;
    }
    pixels = 0.5 * film.width / half.x;
    // Towards the corners, a perspective image is stretched.
    if (!parallel) pixels *= 1.0 + half.x * half.x + half.y * half.y;
  }

  /// In pixels, of something of this length at that point.
  [[nodiscard]] double seen(double length, const glm::dvec3& p) const {
    return length * pixels / (parallel ? 1.0 : std::max(glm::length(p - at), near_clip));
  }
  /// The image of a point in half widths and heights of the film.
  [[nodiscard]] glm::dvec2 image(const glm::dvec3& p) const {
    const glm::dvec3 c = glm::inverse(glm::dmat3(x, y, z)) * (p - at);
    return parallel ? glm::dvec2(c) : glm::dvec2(c) / c.z;
  }
  static Eye between(const Eye& a, const Eye& b, double f) {
    Eye eye = a;
    eye.at = penumbra::between(a.at, b.at, f);
    eye.x = penumbra::between(a.x, b.x, f);
    eye.y = penumbra::between(a.y, b.y, f);
    eye.z = glm::normalize(penumbra::between(a.z, b.z, f));
    eye.lens = a.lens + f * (b.lens - a.lens);
    eye.focus = a.focus + f * (b.focus - a.focus);
    return eye;
  }
};

/// The same of panoramas, which see points in all directions.
double panorama_difference(const Eye& exact, const Eye& other, double distance) {
  double most = 0.0;
  const glm::dmat3 to_other = glm::inverse(glm::dmat3(other.x, other.y, other.z));
  for (const double away : {distance, 1e6 * distance})
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {1.0, -1.0}) {
        glm::dvec3 seen(0.0);
        seen[axis] = side;
        const glm::dvec3 p = exact.at + away * (glm::dmat3(exact.x, exact.y, exact.z) * seen);
        const glm::dvec3 to_point = p - other.at;
        most = std::max(most, glm::length(glm::normalize(to_other * to_point) - seen));
      }
  return exact.pixels * (most + std::abs(exact.lens / exact.focus - other.lens / other.focus));
}

/// By how many pixels images of points at that distance differ, and of those far away.
double difference(const Eye& exact, const Eye& other, double distance, const Film& film) {
  if (exact.panorama) return panorama_difference(exact, other, distance);
  double most = 0.0;
  for (const double away : {distance, 1e6 * distance})
    for (const auto& [u, v] : {std::pair(0.0, 0.0), {-1.0, -1.0}, {1.0, -1.0}, {-1.0, 1.0}, {1.0, 1.0}}) {
      const glm::dvec3 across = u * exact.x + v * exact.y;
      const glm::dvec3 p = exact.at + (exact.parallel ? across + away * exact.z : away * (across + exact.z));
      const glm::dvec2 off = other.image(p) - glm::dvec2(u, v);
      most = std::max(most, 0.5 * std::hypot(off.x * film.width, off.y * film.height));
    }
  // The circle of confusion far away.
  return most + std::abs(exact.lens / exact.focus - other.lens / other.focus) * exact.pixels;
}

template <typename Value>
bool changes(const KeyedValue<Value>& keys, double from, double to) {
  return keys.varies() && keys.times.back() > from && keys.times.front() < to;
}
template <typename Value>
bool changes(const std::optional<KeyedValue<Value>>& keys, double from, double to) {
  return keys && changes(*keys, from, to);
}

/// Finds what moves.
class Tracker {
 public:
  explicit Tracker(const SceneDescription& scene) : scene_(scene), motion_(*scene.motion) {
    out_.exposure = exposure_of(scene);
    out_.has_layer = std::ranges::find(scene.film.layers, AskedLayer::kMotion) != scene.film.layers.end();
    const Exposure& e = out_.exposure;
    is_open_ = e.close > e.open;
    from_ = out_.has_layer ? std::min(e.open, e.before) : e.open;
    to_ = out_.has_layer ? std::max(e.close, e.after) : e.close;
    for (int k = 0; k <= kFinestSteps; ++k) out_.times.push_back(time_at(k / double(kFinestSteps)));
    if (out_.has_layer) out_.times.insert(out_.times.end(), {e.before, e.after});
    out_.shapes.resize(motion_.shapes.size());
    out_.instances.resize(motion_.instances.size());
    out_.emitters.resize(motion_.emitters.size());
    find_moving_nodes();
  }

  Expected<ExposedMotion> run() {
    if (!(to_ > from_)) return std::move(out_);
    if (auto done = follow_camera(); !done) return std::unexpected(done.error());
    follow_matrices();
    if (auto done = follow_shapes(); !done) return std::unexpected(done.error());
    return std::move(out_);
  }

 private:
  [[nodiscard]] double time_at(double share) const {
    const Exposure& e = out_.exposure;
    return e.open + (e.close - e.open) * share;
  }

  /// Nodes that may move in the time that is looked at.
  void find_moving_nodes() {
    for (const MovingNode& node : motion_.nodes) {
      const bool by_itself =
          node.keys && (changes(node.keys->translation, from_, to_) ||
                        changes(node.keys->rotation, from_, to_) || changes(node.keys->stretch, from_, to_));
      moves_.push_back(by_itself || (node.parent >= 0 && moves_[std::size_t(node.parent)]));
    }
  }
  [[nodiscard]] bool moves(const NodePlace& place) const {
    return place.node >= 0 && moves_[std::size_t(place.node)];
  }
  [[nodiscard]] glm::dmat4 matrix_at(const NodePlace& place, double time) const {
    return penumbra::matrix_at(motion_, place, time);
  }

  /// Empty if the steps follow the path.
  static std::string warning(const std::string& what, const StepChoice& choice) {
    if (choice.worst() <= kMostDeviation) return {};
    return fmt::format(
        "{} moves too fast or too irregularly while the shutter is open: {} steps deviate from its path "
        "by up to {:.2g} pixels",
        what, kFinestSteps, choice.worst());
  }
  void warn(std::string text) {
    if (!text.empty()) out_.warnings.push_back(std::move(text));
  }

  Expected<void> follow_camera() {
    PosedParts posed(scene_, std::vector<bool>(motion_.shapes.size(), false));
    std::vector<CameraSettings> cameras;
    const auto pose = [&](double time, std::vector<Eye>& eyes) -> Expected<void> {
      if (auto done = posed.set_time(time); !done) return done;
      eyes.emplace_back(posed.parts().camera, scene_.film);
      if (!cameras.empty() && !same(cameras.front(), posed.parts().camera)) out_.camera.steps = 1;
      if (cameras.empty()) cameras.push_back(posed.parts().camera);
      return {};
    };
    for (const double time : out_.times)
      if (auto done = pose(time, eyes_); !done) return done;
    for (const double share : between_)
      if (auto done = pose(time_at(share), eyes_between_); !done) return done;
    if (out_.camera.steps == 0 || !is_open_) return {};
    const SceneBounds all = bounds_of(scene_.shapes);
    StepChoice choice;
    for (std::size_t i = 0; i < between_.size(); ++i) {
      const Eye& exact = eyes_between_[i];
      double nearest = exact.near_clip;
      if (!all.empty()) {
        const glm::dvec3 outside =
            glm::max(glm::max(all.low - exact.at, exact.at - all.high), glm::dvec3(0.0));
        // Within the scene, things are some way off.
        constexpr double kWithin = 0.05;
        nearest = std::max({nearest, glm::length(outside), kWithin * glm::length(all.high - all.low)});
      }
      choice.look(between_[i], [&](int a, int b, double f) {
        return difference(exact, Eye::between(eyes_[std::size_t(a)], eyes_[std::size_t(b)], f), nearest,
                          scene_.film);
      });
    }
    out_.camera.steps = choice.steps();
    warn(warning("the camera", choice));
    return {};
  }

  /// `points(matrix)`: points or vectors that show how the matrix moves the thing. `is_vector`: they are
  /// directions.
  std::string follow(ExposedPath& path, const NodePlace& place, const std::string& name, const auto& points,
                     bool with_directions) const {
    if (!moves(place)) return {};
    std::vector<glm::dmat4> matrices;
    for (const double time : out_.times) matrices.push_back(matrix_at(place, time));
    std::vector<glm::dmat4> matrices_between;
    if (is_open_)
      for (const double share : between_) matrices_between.push_back(matrix_at(place, time_at(share)));
    const auto differs = [&](const glm::dmat4& matrix) { return matrix != matrices.front(); };
    if (!std::ranges::any_of(matrices, differs) && !std::ranges::any_of(matrices_between, differs)) return {};
    std::vector<decltype(points(matrices.front()))> exact;
    for (const glm::dmat4& matrix : matrices_between) exact.push_back(points(matrix));
    const std::span<const double> times(between_.data(), matrices_between.size());
    const StepChoice choice = StepChoice::of(times, [&](std::size_t k, int a, int b, double f) {
      const glm::dmat4 &from = matrices[std::size_t(a)], &to = matrices[std::size_t(b)];
      const auto there = points(from + f * (to - from));
      const Eye& eye = eyes_between_[k];
      double most = 0.0;
      for (std::size_t p = 0; p < there.size(); ++p) {
        const double off = glm::length(there[p] - exact[k][p]);
        most = std::max(most, with_directions && p > 0 ? off * eye.pixels : eye.seen(off, exact[k][p]));
      }
      return most;
    });
    path.steps = choice.steps();
    for (std::size_t k = 0; k < matrices.size(); ++k)
      if (ExposedMotion::state_at(k, path.steps) >= 0) path.to_world.push_back(matrices[k]);
    return warning(name, choice);
  }

  void follow_matrices() {
    std::vector<SceneBounds> groups;
    for (const ShapeGroup& group : scene_.groups) {
      SceneBounds bounds = bounds_of(group.shapes);
      for (const ShapeInstance& inside : group.instances)
        bounds.include(bounds_of(groups[std::size_t(inside.group)], inside.to_world));
      groups.push_back(bounds);
    }
    const auto follow_box = [&](ExposedPath& path, const NodePlace& place, const std::string& name,
                                const SceneBounds& box) {
      const std::array<glm::dvec3, 8> corners = corners_of(box);
      return follow(
          path, place, name,
          [&](const glm::dmat4& matrix) {
            std::array<glm::dvec3, 8> moved;
            for (std::size_t i = 0; i < 8; ++i) moved[i] = transform_point(matrix, corners[i]);
            return moved;
          },
          false);
    };
    const auto follow_all = [&](std::size_t count, const auto& one) {
      std::vector<std::string> warnings(count);
      in_parallel(count, core_count(), [&](std::size_t i) { warnings[i] = one(i); });
      for (std::string& text : warnings) warn(std::move(text));
    };
    follow_all(motion_.shapes.size(), [&](std::size_t i) {
      const MovingShape& moving = motion_.shapes[i];
      if (!moves_rigidly(scene_, moving) || !moves(moving.place)) return std::string();
      return follow_box(out_.shapes[i], moving.place, "shape '" + scene_.shapes[moving.shape].name + "'",
                        bounds_of_rest(moving.rest));
    });
    follow_all(motion_.instances.size(), [&](std::size_t i) {
      const MovingInstance& moving = motion_.instances[i];
      const ShapeInstance& instance = scene_.instances[moving.instance];
      const SceneBounds& box = groups[std::size_t(instance.group)];
      if (box.empty()) return std::string();
      return follow_box(out_.instances[i], moving.place, "instance '" + instance.name + "'", box);
    });
    for (std::size_t i = 0; i < motion_.emitters.size(); ++i) {
      const MovingEmitter& moving = motion_.emitters[i];
      const bool is_still = std::holds_alternative<ConstantEnvironment>(moving.rest);
      if (!is_still)
        warn(follow(
            out_.emitters[i], moving.place, fmt::format("light {}", moving.emitter + 1),
            [&](const glm::dmat4& matrix) { return place_and_axes(moving.rest, matrix); }, true));
    }
  }

  /// Where the emitter is, and unit vectors that turn with it.
  static std::vector<glm::dvec3> place_and_axes(const Emitter& emitter, const glm::dmat4& matrix) {
    glm::dmat4 own(1.0);
    if (const auto* point = std::get_if<PointLight>(&emitter))
      return {transform_point(matrix, point->position)};
    if (const auto* spot = std::get_if<SpotLight>(&emitter)) own = spot->to_world;
    if (const auto* map = std::get_if<EnvironmentMapLight>(&emitter)) own = map->to_world;
    if (const auto* projector = std::get_if<ProjectorLight>(&emitter)) own = projector->to_world;
    const bool is_somewhere =
        std::holds_alternative<SpotLight>(emitter) || std::holds_alternative<ProjectorLight>(emitter);
    const glm::dmat4 all = matrix * own;
    std::vector<glm::dvec3> result{is_somewhere ? glm::dvec3(all[3]) : glm::dvec3(0.0)};
    const auto add = [&](const glm::dvec3& axis) {
      const double length = glm::length(axis);
      result.push_back(length > 0.0 ? axis / length : axis);
    };
    if (const auto* sun = std::get_if<DirectionalLight>(&emitter)) {
      add(transform_vector(matrix, sun->direction));
      return result;
    }
    for (int i = 0; i < 3; ++i) add(glm::dvec3(all[i]));
    return result;
  }

  /// Whether a shape that is not rigid may change.
  [[nodiscard]] bool may_change(const MovingShape& moving) const {
    if (moves(moving.place)) return true;
    const MeshDeformation* deformation = moving.deformation.get();
    return deformation != nullptr &&
           (changes_weights(*deformation) || std::ranges::any_of(deformation->skin.joints, [&](int joint) {
              return moves_[std::size_t(joint)];
            }));
  }
  [[nodiscard]] bool changes_weights(const MeshDeformation& deformation) const {
    return !deformation.targets.empty() && changes(deformation.weights, from_, to_);
  }

  /// Shapes with states of each primitive: those at the finest states are kept, those between compared.
  Expected<void> follow_shapes() {
    std::vector<bool> wanted(motion_.shapes.size(), false);
    for (std::size_t i = 0; i < wanted.size(); ++i)
      wanted[i] = !moves_rigidly(scene_, motion_.shapes[i]) && may_change(motion_.shapes[i]);
    if (std::ranges::find(wanted, true) == wanted.end()) return {};
    PosedParts posed(scene_, wanted);
    struct Track {
      std::size_t index;
      Geometry first = {};
      glm::dvec3 origin{0.0};
      std::vector<std::vector<glm::vec3>> points = {};
      StepChoice choice = {};
      bool changes = false;
    };
    std::vector<Track> tracks;
    for (std::size_t i = 0; i < wanted.size(); ++i)
      if (wanted[i]) tracks.push_back({.index = i});
    for (std::size_t k = 0; k < out_.times.size(); ++k) {
      if (auto done = posed.set_time(out_.times[k]); !done) return done;
      for (Track& track : tracks) {
        const Shape& shape = posed.shape(motion_.shapes[track.index]);
        const SceneBounds bounds = bounds_of(std::span(&shape, 1));
        if (k == 0) {
          track.first = shape.geometry;
          if (!bounds.empty()) track.origin = bounds.center();
        }
        track.changes = track.changes || !same(track.first, shape.geometry);
        out_.shapes[track.index].swept.include(bounds);
        std::vector<glm::vec3>& points = track.points.emplace_back();
        for (const glm::dvec3& p : points_of(shape)) points.emplace_back(p - track.origin);
      }
    }
    for (std::size_t i = 0; i < between_.size() && is_open_; ++i) {
      if (auto done = posed.set_time(time_at(between_[i])); !done) return done;
      for (Track& track : tracks) {
        const Shape& shape = posed.shape(motion_.shapes[track.index]);
        track.changes = track.changes || !same(track.first, shape.geometry);
        compare(track.points, points_of(shape), track.origin, motion_.shapes[track.index], i, track.choice);
      }
    }
    for (const Track& track : tracks) {
      if (!track.changes) continue;
      out_.shapes[track.index].steps = track.choice.steps();
      warn(warning("shape '" + posed.shape(motion_.shapes[track.index]).name + "'", track.choice));
    }
    return {};
  }

  /// Shapes in groups are compared as if they were not placed, at the distance of the nearest placement.
  void compare(const std::vector<std::vector<glm::vec3>>& states, const std::vector<glm::dvec3>& exact,
               const glm::dvec3& origin, const MovingShape& moving, std::size_t i, StepChoice& choice) {
    const Eye& eye = eyes_between_[i];
    const double pixels = moving.group < 0 ? 0.0 : pixels_of_group(moving.group, eye);
    choice.look(between_[i], [&](int a, int b, double f) {
      const auto &from = states[std::size_t(a)], &to = states[std::size_t(b)];
      double most = 0.0;
      for (std::size_t p = 0; p < exact.size(); ++p) {
        const glm::dvec3 there = origin + between(glm::dvec3(from[p]), glm::dvec3(to[p]), f);
        const double off = glm::length(there - exact[p]);
        most = std::max(most, moving.group < 0 ? eye.seen(off, exact[p]) : off * pixels);
      }
      return most;
    });
  }

  /// The most pixels per unit of length of the group's space.
  double pixels_of_group(int group, const Eye& eye) {
    if (!placed_) {
      auto placed = place_groups(scene_);
      placed_ = placed ? std::move(*placed) : std::vector<PlacedGroup>();
    }
    const SceneBounds box = bounds_of(scene_.groups[std::size_t(group)].shapes);
    double most = 0.0;
    for (const PlacedGroup& place : *placed_) {
      if (place.group != group || box.empty()) continue;
      const SceneBounds there = bounds_of(box, place.to_world);
      double stretch = 0.0;
      for (int axis = 0; axis < 3; ++axis)
        stretch = std::max(stretch, glm::length(glm::dvec3(place.to_world[axis])));
      most = std::max(most, eye.seen(stretch, glm::clamp(eye.at, there.low, there.high)));
    }
    return most;
  }

  const SceneDescription& scene_;
  const SceneMotion& motion_;
  bool is_open_ = false;
  double from_ = 0.0, to_ = 0.0;  ///< the time that is looked at
  std::vector<bool> moves_;       ///< of each node
  std::vector<Eye> eyes_, eyes_between_;
  const std::vector<double> between_ = between_times();
  std::optional<std::vector<PlacedGroup>> placed_;
  ExposedMotion out_;
};

}  // namespace

glm::dmat4 matrix_at(const SceneMotion& motion, const NodePlace& place, double time) {
  glm::dmat4 matrix = place.to_node;
  for (int n = place.node; n >= 0; n = motion.nodes[std::size_t(n)].parent) {
    const MovingNode& node = motion.nodes[std::size_t(n)];
    matrix = (node.keys ? transform_at(*node.keys, time) : node.to_parent) * matrix;
  }
  return matrix;
}

int ExposedMotion::state_at(std::size_t k, int steps) {
  if (steps == 0) return -1;
  if (k > std::size_t(kFinestSteps)) return steps + int(k) - kFinestSteps;
  const int stride = kFinestSteps / steps;
  return int(k) % stride == 0 ? int(k) / stride : -1;
}

bool moves_rigidly(const SceneDescription& scene, const MovingShape& moving) {
  return moving.group < 0 && moving.deformation == nullptr && !emits(scene.shapes.at(moving.shape));
}

bool ExposedMotion::any() const {
  const auto moves = [](const std::vector<ExposedPath>& paths) {
    return std::ranges::any_of(paths, [](const ExposedPath& path) { return path.steps > 0; });
  };
  return camera.steps > 0 || moves(shapes) || moves(instances) || moves(emitters);
}

namespace {

/// The camera's motion without what settings have replaced: the camera that is shown differs from its keys
/// there.
std::optional<MovingCamera> keyed_camera(const SceneDescription& scene) {
  if (!scene.motion->camera) return {};
  MovingCamera moving = *scene.motion->camera;
  const CameraSettings& shown = scene.camera;
  if (moving.place.node >= 0) {
    const auto nodes = nodes_to_world(*scene.motion, scene.time);
    const auto frame = camera_frame(nodes.at(std::size_t(moving.place.node)) * moving.place.to_node);
    if (!frame || *frame != shown.to_world) moving.place = {-1, shown.to_world};
  }
  const auto keep = [&](std::optional<KeyedValue<double>>& keys, double value) {
    if (keys && value_at(*keys, scene.time) != value) keys.reset();
  };
  keep(moving.fov, shown.fov);
  keep(moving.focus_distance, shown.focus_distance);
  keep(moving.aperture_radius, shown.aperture_radius);
  keep(moving.scale_x, shown.scale_x);
  keep(moving.scale_y, shown.scale_y);
  return moving;
}

/// Warns of what the integrator cannot blur.
void add_integrator_warnings(const SceneDescription& scene, ExposedMotion& motion) {
  if (!motion.any() || !has_photons(scene.integrator)) return;
  if (scene.integrator.is<PhotonMapIntegrator>())
    motion.warnings.emplace_back(
        "photonmapper has one map for the image: what moves is as at the middle of the exposure; "
        "ppm blurs it");
  else if (motion.exposure.rolling > 0)
    motion.warnings.emplace_back("ppm has one time for all rows of a pass: the shutter does not roll");
}

}  // namespace

PosedParts::PosedParts(const SceneDescription& scene, const std::vector<bool>& wanted) {
  static_cast<RenderSettings&>(parts_) = scene;
  parts_.source = scene.source;
  parts_.emitters = scene.emitters;
  parts_.instances = scene.instances;
  parts_.shapes.resize(scene.shapes.size());
  for (const ShapeGroup& group : scene.groups) {
    parts_.groups.push_back({group.name, {}, group.instances});
    parts_.groups.back().shapes.resize(group.shapes.size());
  }
  if (scene.motion == nullptr) return;
  const SceneMotion& all = *scene.motion;
  auto motion = std::make_shared<SceneMotion>();
  motion->nodes = all.nodes;
  motion->emitters = all.emitters;
  motion->camera = keyed_camera(scene);
  for (std::size_t i = 0; i < all.shapes.size(); ++i) {
    if (!wanted[i]) continue;
    const MovingShape& moving = all.shapes[i];
    motion->shapes.push_back(moving);
    if (moving.group < 0)
      parts_.shapes[moving.shape] = scene.shapes[moving.shape];
    else
      parts_.groups[std::size_t(moving.group)].shapes[moving.shape] =
          scene.groups[std::size_t(moving.group)].shapes[moving.shape];
  }
  parts_.motion = std::move(motion);
}

Expected<ExposedMotion> exposed_motion(const SceneDescription& scene) {
  if (scene.motion == nullptr) {
    ExposedMotion still;
    still.exposure = exposure_of(scene);
    return still;
  }
  auto motion = Tracker(scene).run();
  if (motion) add_integrator_warnings(scene, *motion);
  return motion;
}

Expected<SceneDescription> at_middle(const SceneDescription& scene, ExposedMotion& motion) {
  SceneDescription middle = scene;
  const double time = motion.exposure.middle();
  PosedParts posed(scene, std::vector<bool>(scene.motion->shapes.size(), false));
  auto done = set_time(middle, time);
  if (done) done = posed.set_time(time);
  if (!done) return std::unexpected(done.error());
  middle.camera = posed.parts().camera;
  const std::vector<MovingInstance>& instances = scene.motion->instances;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    ShapeInstance& instance = middle.instances[instances[i].instance];
    const auto regular = std::ranges::find_if_not(motion.instances[i].to_world, is_singular);
    if (!instance.hidden || regular == motion.instances[i].to_world.end()) continue;
    instance.hidden = false;
    instance.to_world = *regular;
  }
  const std::vector<MovingShape>& shapes = scene.motion->shapes;
  const auto shape_of = [](SceneDescription& of, const MovingShape& moving) -> Shape& {
    return moving.group < 0 ? of.shapes[moving.shape]
                            : of.groups[std::size_t(moving.group)].shapes[moving.shape];
  };
  const auto is_empty = [](const Shape& shape) {
    const auto* mesh = std::get_if<Mesh>(&shape.geometry);
    return mesh != nullptr && mesh->triangles.empty();
  };
  std::vector<std::size_t> empty;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    motion.shapes[i].shown_at = time;
    if (motion.shapes[i].steps > 0 && is_empty(shape_of(middle, shapes[i]))) empty.push_back(i);
  }
  if (empty.empty()) return middle;
  SceneDescription other = scene;
  for (int k = 0; k <= kFinestSteps && !empty.empty(); ++k) {
    const double then = motion.times[std::size_t(k)];
    if (auto taken = set_time(other, then); !taken) return std::unexpected(taken.error());
    std::erase_if(empty, [&](std::size_t i) {
      if (is_empty(shape_of(other, shapes[i]))) return false;
      shape_of(middle, shapes[i]).geometry = shape_of(other, shapes[i]).geometry;
      motion.shapes[i].shown_at = then;
      return true;
    });
  }
  return middle;
}

}  // namespace penumbra
