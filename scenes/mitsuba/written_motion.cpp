#include "scenes/mitsuba/written_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

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

class Keys {
 public:
  explicit Keys(const std::function<glm::dmat4(double)>& at) : at_(at) {}

  /// Adds the keys after `from` up to `to`.
  Expected<void> add(const TransformKey& from, const TransformKey& to, int halvings) {
    const std::array pair{from, to};
    const auto between = keyed_transform(pair);
    if (!between) return std::unexpected(between.error());
    double most = 0.0;
    for (const double part : {0.25, 0.5, 0.75}) {
      const double time = from.time + part * (to.time - from.time);
      most = std::max(most, difference(transform_at(*between, time), at_(time)));
    }
    if (!(most <= kSameTransform)) made_.exact = false;
    const double half = 0.5 * (from.time + to.time);
    if (most <= kNearTransform || halvings == 0 || !(half > from.time && half < to.time)) {
      made_.keys.push_back(to);
      return {};
    }
    const TransformKey middle = key_at(half);
    if (auto done = add(from, middle, halvings - 1); !done) return done;
    return add(middle, to, halvings - 1);
  }

  Expected<WrittenKeys> run(std::span<const double> times) {
    for (const double time : times) {
      const TransformKey key = key_at(time);
      if (made_.keys.empty()) {
        made_.keys.push_back(key);
      } else if (auto done = add(TransformKey(made_.keys.back()), key, kMostHalvings); !done) {
        return std::unexpected(done.error());
      }
    }
    return std::move(made_);
  }

 private:
  [[nodiscard]] TransformKey key_at(double time) const { return {time, affine(at_(time))}; }

  const std::function<glm::dmat4(double)>& at_;
  WrittenKeys made_;
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
  return Keys(at).run(times);
}

}  // namespace penumbra::mitsuba
