#include "scenes/mitsuba/written_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/scene_bounds.h"

namespace penumbra::mitsuba {
namespace {

/// How often an interval between two keys may be halved.
constexpr int kMostHalvings = 6;

/// The largest difference of two numbers of the matrices, of the size of the largest one.
double difference(const glm::dmat4& a, const glm::dmat4& b) {
  double most = 0.0, size = 0.0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 3; ++j) {
      most = std::max(most, std::abs(a[i][j] - b[i][j]));
      size = std::max(size, std::abs(b[i][j]));
    }
  return most / size;
}

/// Where a path between two keys is, and where it should be: at these shares of their time.
constexpr std::array kParts{0.25, 0.5, 0.75};
template <typename Key>
double time_between(const Key& a, const Key& b, double part) {
  return a.time + part * (b.time - a.time);
}

/// A transform over time.
struct TransformPath {
  using Key = TransformKey;
  const std::function<glm::dmat4(double)>& at;

  [[nodiscard]] Key key_at(double time) const { return {time, affine(at(time))}; }
  /// How far the path between two keys is from where it should be.
  [[nodiscard]] Expected<double> gap(const Key& from, const Key& to) const {
    const std::array pair{from, to};
    const auto between = keyed_transform(pair);
    if (!between) return std::unexpected(between.error());
    double most = 0.0;
    for (const double part : kParts) {
      const double time = time_between(from, to, part);
      most = std::max(most, difference(transform_at(*between, time), at(time)));
    }
    return most;
  }
};

/// The vertices of a mesh over time.
struct MeshPath {
  using Key = MeshKey;
  const SceneMotion& motion;
  const MovingShape& moving;

  [[nodiscard]] Key key_at(double time) const {
    Key key{time, std::get<Mesh>(moving.rest)};
    deform(*moving.deformation, time, nodes_to_world(motion, time), key.mesh);
    return key;
  }
  [[nodiscard]] Expected<double> gap(const Key& from, const Key& to) const {
    double most = 0.0;
    for (const double part : kParts) {
      const std::vector<glm::dvec3> there = key_at(time_between(from, to, part)).mesh.positions;
      SceneBounds bounds;
      double off = 0.0;
      for (std::size_t i = 0; i < there.size(); ++i) {
        bounds.include(there[i]);
        off = std::max(off,
                       glm::distance(glm::mix(from.mesh.positions[i], to.mesh.positions[i], part), there[i]));
      }
      if (off > 0.0) most = std::max(most, off / glm::length(bounds.high - bounds.low));
    }
    return most;
  }
};

template <typename Path>
class Keys {
 public:
  using Key = typename Path::Key;
  explicit Keys(const Path& path) : path_(path) {}

  Expected<void> run(std::span<const double> times) {
    for (const double time : times) {
      const Key key = path_.key_at(time);
      if (keys.empty())
        keys.push_back(key);
      else if (auto done = add(Key(keys.back()), key, kMostHalvings); !done)
        return done;
    }
    return {};
  }

  std::vector<Key> keys;
  bool exact = true;

 private:
  /// Adds the keys after `from` up to `to`.
  Expected<void> add(const Key& from, const Key& to, int halvings) {
    const auto most = path_.gap(from, to);
    if (!most) return std::unexpected(most.error());
    if (!(*most <= kSameTransform)) exact = false;
    const double half = 0.5 * (from.time + to.time);
    if (*most <= kNearTransform || halvings == 0 || !(half > from.time && half < to.time)) {
      keys.push_back(to);
      return {};
    }
    const Key middle = path_.key_at(half);
    if (auto done = add(from, middle, halvings - 1); !done) return done;
    return add(middle, to, halvings - 1);
  }

  const Path& path_;
};

}  // namespace

glm::dmat4 affine(glm::dmat4 m) {
  for (int i = 0; i < 4; ++i) m[i][3] = i == 3 ? 1.0 : 0.0;
  return m;
}

glm::dmat4 Course::at(const SceneMotion& motion, double time) const {
  glm::dmat4 result(1.0);
  for (const NodePlace& step : steps) {
    glm::dmat4 place = step.to_node;
    for (int i = step.node; i >= 0; i = motion.nodes[std::size_t(i)].parent) {
      const MovingNode& node = motion.nodes[std::size_t(i)];
      place = (node.keys ? transform_at(*node.keys, time) : node.to_parent) * place;
    }
    result = result * place;
  }
  return result;
}

std::vector<double> Course::times(const SceneMotion& motion) const {
  std::vector<double> all;
  const auto add = [&](const auto& keys) {
    if (keys.varies()) all.insert(all.end(), keys.times.begin(), keys.times.end());
  };
  for (const NodePlace& step : steps)
    for (int node = step.node; node >= 0; node = motion.nodes[std::size_t(node)].parent)
      if (const auto& keys = motion.nodes[std::size_t(node)].keys) {
        add(keys->translation);
        add(keys->rotation);
        add(keys->stretch);
      }
  std::ranges::sort(all);
  all.erase(std::ranges::unique(all).begin(), all.end());
  return all;
}

glm::dmat4 Course::take_end() {
  glm::dmat4 end(1.0);
  while (!steps.empty()) {
    end = std::exchange(steps.back().to_node, glm::dmat4(1.0)) * end;
    if (steps.back().node >= 0) break;
    steps.pop_back();
  }
  return end;
}

Expected<WrittenKeys> written_keys(const std::function<glm::dmat4(double)>& at,
                                   std::span<const double> times) {
  const TransformPath path{at};
  Keys keys(path);
  if (auto done = keys.run(times); !done) return std::unexpected(done.error());
  return WrittenKeys{std::move(keys.keys), keys.exact};
}

WrittenMeshes written_meshes(const SceneMotion& motion, const MovingShape& moving, double from, double to) {
  const MeshDeformation& deformation = *moving.deformation;
  std::vector<double> times;
  if (!deformation.targets.empty()) times = deformation.weights.times;
  for (const int joint : deformation.skin.joints)
    for (const double time : Course{{{joint, glm::dmat4(1.0)}}}.times(motion)) times.push_back(time);
  std::erase_if(times, [&](double time) { return !(time > from && time < to); });
  times.insert(times.end(), {from, to});
  std::ranges::sort(times);
  times.erase(std::ranges::unique(times).begin(), times.end());
  const MeshPath path{motion, moving};
  Keys keys(path);
  static_cast<void>(keys.run(times));  // meshes have no errors
  return {std::move(keys.keys), keys.exact};
}

}  // namespace penumbra::mitsuba
