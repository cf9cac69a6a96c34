#include "scenes/motion/exposed_motion.h"

#include <algorithm>
#include <cmath>

#include "scenes/instances.h"

namespace penumbra {
namespace {

constexpr int kFixedSteps = 8;

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
bool same(const Geometry& a, const Geometry& b) {
  return a.index() == b.index() &&
         std::visit([&](const auto& one) { return same(one, std::get<std::decay_t<decltype(one)>>(b)); }, a);
}
bool same(const CameraSettings& a, const CameraSettings& b) {
  return a.to_world == b.to_world && a.fov == b.fov && a.focus_distance == b.focus_distance &&
         a.aperture_radius == b.aperture_radius && a.scale_x == b.scale_x && a.scale_y == b.scale_y;
}

glm::dmat4 matrix_of(const NodePlace& place, const std::vector<glm::dmat4>& nodes) {
  return place.node < 0 ? place.to_node : nodes[std::size_t(place.node)] * place.to_node;
}

/// Irregular times, at which a motion that repeats itself with the steps is seen all the same: one in each of
/// 2 kFinestSteps intervals.
std::vector<double> between_times(const Exposure& exposure) {
  constexpr double kGoldenRatio = 0.61803398874989485;
  std::vector<double> times;
  for (int i = 0; i < 2 * kFinestSteps; ++i) {
    const double within = std::fmod((i + 1) * kGoldenRatio, 1.0);
    times.push_back(exposure.open + (exposure.close - exposure.open) * (i + within) / (2.0 * kFinestSteps));
  }
  return times;
}

/// Finds what moves.
class Tracker {
 public:
  explicit Tracker(const SceneDescription& scene) : scene_(scene), motion_(*scene.motion), posed_(scene) {
    out_.exposure = exposure_of(scene);
    out_.has_layer = std::ranges::find(scene.film.layers, AskedLayer::kMotion) != scene.film.layers.end();
    const Exposure& e = out_.exposure;
    for (int k = 0; k <= kFinestSteps; ++k)
      out_.times.push_back(e.open + (e.close - e.open) * k / double(kFinestSteps));
    if (out_.has_layer) out_.times.insert(out_.times.end(), {e.before, e.after});
    out_.shapes.resize(motion_.shapes.size());
    out_.instances.resize(motion_.instances.size());
    out_.emitters.resize(motion_.emitters.size());
  }

  Expected<ExposedMotion> run() {
    if (!(out_.exposure.close > out_.exposure.open) && !out_.has_layer) return std::move(out_);
    std::vector<double> all = out_.times;
    if (out_.exposure.close > out_.exposure.open) {
      const std::vector<double> between = between_times(out_.exposure);
      all.insert(all.end(), between.begin(), between.end());
    }
    for (std::size_t k = 0; k < all.size(); ++k)
      if (auto done = look(all[k], k < out_.times.size(), k == 0); !done)
        return std::unexpected(done.error());
    const auto forget_still = [](std::vector<ExposedPath>& paths) {
      for (ExposedPath& path : paths)
        if (path.steps == 0) path.to_world = {};
    };
    forget_still(out_.shapes);
    forget_still(out_.instances);
    forget_still(out_.emitters);
    return std::move(out_);
  }

 private:
  Expected<void> look(double time, bool is_state, bool is_first) {
    const std::vector<glm::dmat4> nodes = nodes_to_world(motion_, time);
    const auto follow = [&](ExposedPath& path, const NodePlace& place) {
      const glm::dmat4 matrix = matrix_of(place, nodes);
      if (!is_first && matrix != path.to_world.front()) path.steps = kFixedSteps;
      if (is_state) path.to_world.push_back(matrix);
    };
    for (std::size_t i = 0; i < motion_.instances.size(); ++i)
      follow(out_.instances[i], motion_.instances[i].place);
    for (std::size_t i = 0; i < motion_.emitters.size(); ++i)
      follow(out_.emitters[i], motion_.emitters[i].place);
    if (auto done = posed_.set_time(time); !done) return done;
    if (is_first) first_shapes_.resize(motion_.shapes.size());
    for (std::size_t i = 0; i < motion_.shapes.size(); ++i) {
      const MovingShape& moving = motion_.shapes[i];
      ExposedPath& path = out_.shapes[i];
      if (moves_rigidly(scene_, moving)) {
        follow(path, moving.place);
        continue;
      }
      const Shape& shape = posed_.shape(moving);
      path.swept.include(bounds_of(std::span(&shape, 1)));
      if (is_first)
        first_shapes_[i] = shape.geometry;
      else if (path.steps == 0 && !same(first_shapes_[i], shape.geometry))
        path.steps = kFixedSteps;
    }
    const CameraSettings& camera = posed_.parts().camera;
    if (is_first)
      first_camera_ = camera;
    else if (!same(first_camera_, camera))
      out_.camera.steps = kFixedSteps;
    return {};
  }

  const SceneDescription& scene_;
  const SceneMotion& motion_;
  PosedParts posed_;
  std::vector<Geometry> first_shapes_;
  CameraSettings first_camera_;
  ExposedMotion out_;
};

}  // namespace

bool moves_rigidly(const SceneDescription& scene, const MovingShape& moving) {
  return moving.group < 0 && moving.deformation == nullptr && !emits(scene.shapes.at(moving.shape));
}

bool ExposedMotion::any() const {
  const auto moves = [](const std::vector<ExposedPath>& paths) {
    return std::ranges::any_of(paths, [](const ExposedPath& path) { return path.steps > 0; });
  };
  return camera.steps > 0 || moves(shapes) || moves(instances) || moves(emitters);
}

PosedParts::PosedParts(const SceneDescription& scene) {
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
  auto motion = std::make_shared<SceneMotion>(*scene.motion);
  std::erase_if(motion->shapes, [&](const MovingShape& moving) { return moves_rigidly(scene, moving); });
  for (const MovingShape& moving : motion->shapes) {
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
  return Tracker(scene).run();
}

}  // namespace penumbra
