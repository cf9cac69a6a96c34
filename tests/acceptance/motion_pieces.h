// Scenes in which something moves, and their images by other means.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "scenes/motion/scene_motion.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/render_scene.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::motion_pieces {

constexpr int kSide = 24;  ///< of the film of scene_of
constexpr int kStills = 64;
constexpr int kBatches = 10;
constexpr int kBlock = 3;
constexpr double kSignificance = 1e-3;  ///< of each scene; the seeds are fixed

/// A floor and a lamp above it. `rest` comes after them, `integrator` is the plugin's name and parameters.
inline SceneDescription scene_of(const std::string& rest,
                                 const std::string& integrator = "<integrator type='path'/>",
                                 bool lamp = true) {
  const std::string light =
      "<shape type='rectangle'><transform name='to_world'><scale value='1.2'/><rotate x='1' angle='90'/>"
      "<translate y='3' x='1'/></transform><emitter type='area'><rgb name='radiance' value='9 8 "
      "7'/></emitter>"
      "</shape>";
  const std::string text =
      "<scene version='3.0.0'>" + integrator +
      "<sensor type='perspective'><float name='fov' value='40'/><transform name='to_world'>"
      "<lookat origin='0.3, 1.2, -5' target='0, 0, 0' up='0, 1, 0'/></transform>"
      "<film type='hdrfilm'><integer name='width' value='24'/><integer name='height' value='24'/>"
      "<rfilter type='box'/></film><sampler type='independent'/></sensor>"
      "<shape type='rectangle'><transform name='to_world'><scale value='6'/><rotate x='1' angle='-90'/>"
      "<translate y='-1'/></transform><bsdf type='diffuse'/></shape>" +
      (lamp ? light : "") + rest + "</scene>";
  const TemporaryFolder folder;
  write_text(folder.path() / "scene.xml", text);
  SceneDescription scene = read_or_throw(folder.path() / "scene.xml");
  scene.camera.shutter = 1.0f;
  scene.frame_duration = 1.0;
  return scene;
}

/// For scene_of: a cube of half side 0.6.
inline std::string cube(const std::string& bsdf, const std::string& place = "") {
  return "<shape type='cube'><transform name='to_world'><scale value='0.6'/>" + place + "</transform>" +
         bsdf + "</shape>";
}
inline const std::string kGrey = "<bsdf type='diffuse'><rgb name='reflectance' value='0.7 0.4 0.2'/></bsdf>";

/// Builds the motion of a scene whose shutter is open from 0 to 1.
class Mover {
 public:
  explicit Mover(SceneDescription& scene) : scene_(scene) {}
  ~Mover() { scene_.motion = std::make_shared<const SceneMotion>(std::move(motion_)); }
  Mover(const Mover&) = delete;
  Mover& operator=(const Mover&) = delete;

  /// A node that turns about an axis through `center`, by `degrees`, and then moves by `way`.
  int node(const glm::dvec3& way, double degrees = 0, const glm::dvec3& axis = {0, 1, 0},
           const glm::dvec3& center = glm::dvec3(0), double size = 1) {
    std::vector<TransformKey> keys;
    // Between keys, translations go straight on, so many keep the centre where it is.
    const int count = std::max(8, int(std::ceil(std::abs(degrees) / 3)));
    for (int k = 0; k <= count; ++k) {
      const double t = double(k) / count;
      glm::dmat4 m = glm::translate(glm::dmat4(1), center + t * way);
      m = glm::rotate(m, glm::radians(t * degrees), axis);
      m = glm::scale(m, glm::dvec3(1 + t * (size - 1)));
      keys.push_back({t, glm::translate(m, -center)});
    }
    return node(keys);
  }
  int node(const std::vector<TransformKey>& keys) { return node(keyed_transform(keys).value()); }
  int node(KeyedTransform keys) {
    motion_.nodes.push_back({.keys = std::move(keys)});
    return int(motion_.nodes.size()) - 1;
  }
  void shape(std::size_t index, int node) {
    motion_.shapes.push_back({.shape = index, .rest = scene_.shapes.at(index).geometry, .place = {node}});
  }
  void last_shape(int node) { shape(scene_.shapes.size() - 1, node); }
  void instance(std::size_t index, int node) {
    motion_.instances.push_back({index, {node, scene_.instances.at(index).to_world}});
  }
  void emitter(std::size_t index, int node) {
    motion_.emitters.push_back({.emitter = index, .rest = scene_.emitters.at(index), .place = {node}});
  }
  MovingCamera& camera(int node) {
    motion_.camera = MovingCamera{.place = {node, scene_.camera.to_world}};
    return *motion_.camera;
  }
  /// The mesh's positions grow by `change` from the time `first` to `last`.
  void deform(std::size_t index, const std::function<glm::dvec3(const glm::dvec3&)>& change, double first = 0,
              double last = 1) {
    auto deformation = std::make_shared<MeshDeformation>();
    MorphTarget target;
    for (const glm::dvec3& p : std::get<Mesh>(scene_.shapes.at(index).geometry).positions)
      target.positions.push_back(change(p));
    deformation->targets.push_back(std::move(target));
    deformation->weights = {.times = {first, last}, .values = {{0}, {1}}};
    motion_.shapes.push_back(
        {.shape = index, .rest = scene_.shapes.at(index).geometry, .deformation = std::move(deformation)});
  }

 private:
  SceneDescription& scene_;
  SceneMotion motion_;
};

/// Means of batches of stills, one at a random time in each of kStills equal parts of the exposure.
inline statistics::Estimate of_stills(SceneDescription scene, const TestDevice& device = native_device()) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> within(0, 1);
  scene.camera.shutter = 0.0f;
  scene.sampler.spp = 1;
  std::vector<statistics::Image> batches;
  for (int b = 0; b < kBatches; ++b) {
    statistics::Image sum(scene.film.width, scene.film.height, 3);
    for (int k = 0; k < kStills; ++k) {
      if (auto done = set_time(scene, (k + within(random)) / kStills); !done)
        throw std::runtime_error(done.error().message);
      scene.sampler.seed = std::uint32_t(1000 + b * kStills + k);
      const statistics::Image still = mean_image(render_or_throw(scene, device));
      for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += still.values[i] / kStills;
    }
    batches.push_back(statistics::block_average(sum, kBlock));
  }
  return statistics::estimate_from_batches(batches);
}

/// A z-test at kSignificance that the blurred image is the mean of stills.
inline void expect_mean_of_stills(SceneDescription scene, const TestDevice& device = native_device()) {
  ASSERT_TRUE(set_time(scene, 0));
  ASSERT_NE(build_or_throw(scene).header.features & FEATURE_MOTION, 0u);
  const statistics::Estimate stills = of_stills(scene, device);
  scene.sampler.spp = kStills;
  const statistics::Estimate blurred = block_estimate(scene, kBatches, 1, kBlock, device);
  const auto result = statistics::z_test(blurred, stills, {.significance = kSignificance});
  EXPECT_TRUE(result.passed) << result.summary();
  testing::Test::RecordProperty("z", result.summary());
}

/// The shutter is open from 0 to 1. A unit is a pixel: the camera shows the point (x, y, z) at the film's
/// position (x, y), and looks along z from far away.
inline SceneDescription pixel_world(int width, int height, std::uint32_t spp, std::uint32_t seed = 1) {
  SceneDescription scene = empty_scene(width, height, spp, seed);
  scene.camera.projection = Projection::kOrthographic;
  scene.camera.scale_x = scene.camera.scale_y = 0.5 * width;
  scene.camera.to_world = glm::dmat4(glm::dvec4(-1, 0, 0, 0), glm::dvec4(0, -1, 0, 0), glm::dvec4(0, 0, 1, 0),
                                     glm::dvec4(0.5 * width, 0.5 * height, -10, 1));
  scene.camera.shutter = 1.0f;
  scene.frame_duration = 1.0;
  scene.film.alpha = true;
  scene.integrator = direct_integrator(1, 0);
  return scene;
}

/// A rectangle of pixel_world that faces the camera.
inline Shape rectangle(glm::dvec3 corner, double width, double height, int bsdf = kBlackBsdf,
                       std::optional<float> radiance = std::nullopt) {
  return parallelogram(corner, {0, height, 0}, {width, 0, 0}, bsdf, radiance);
}

/// What the mean of a pixel's samples should be.
struct Moments {
  double mean = 0, variance = 0;  ///< of one sample
  double allowance = 0;           ///< for a systematic deviation
};

/// Relative openness of the shutter at a time.
using Curve = std::function<double(double)>;
inline double box_curve(double) { return 1; }

constexpr int kPoints = 1 << 12;
/// Of means of indicators over kPoints points of low discrepancy in three dimensions, N^(-2/3) and a factor.
const double kQuadrature = 3 * std::pow(double(kPoints), -2.0 / 3);

/// Moments over the pixel and the exposure of value(x, y, time). Points: Roberts's sequence R3. What moves
/// may be `deviation` pixels off its path; that matters while something in the pixel has an edge, whose
/// length is at most the pixel's diagonal: while the value differs within it. `range`: of the values.
inline Moments moments(int x, int y, const std::function<double(double, double, double)>& value,
                       double deviation = 0, double range = 1, const Curve& curve = box_curve) {
  constexpr double kRoot = 1.2207440846057596;  // of r^4 = r + 1
  constexpr double a = 1 / kRoot, b = a * a, c = b * a;
  double weights = 0, sum = 0, squares = 0;
  for (int i = 1; i <= kPoints; ++i) {
    const double u = std::fmod(0.5 + i * a, 1.0), v = std::fmod(0.5 + i * b, 1.0),
                 t = std::fmod(0.5 + i * c, 1.0);
    const double w = curve(t), f = value(x + u, y + v, t);
    weights += w, sum += w * f, squares += w * f * f;
  }
  Moments m{.mean = sum / weights, .allowance = range * kQuadrature};
  m.variance = std::max(0.0, squares / weights - m.mean * m.mean);
  if (deviation > 0) {
    constexpr int kTimes = 64, kGrid = 4;
    double mixed = 0, all = 0;
    for (int i = 0; i < kTimes; ++i) {
      const double t = (i + 0.5) / kTimes, first = value(x, y, t);
      bool differs = false;
      for (int k = 0; k < (kGrid + 1) * (kGrid + 1) && !differs; ++k)
        differs = value(x + double(k % (kGrid + 1)) / kGrid, y + double(k / (kGrid + 1)) / kGrid, t) != first;
      all += curve(t);
      if (differs) mixed += curve(t);
    }
    m.allowance += range * deviation * std::sqrt(2.0) * mixed / all;
  }
  return m;
}

/// The same of a smooth value, by the midpoint rule: its error is a thousandth of the change within a pixel.
inline Moments moments_of_smooth(int x, int y, const std::function<double(double, double, double)>& value) {
  constexpr int kGrid = 4, kTimes = 8, kAll = kGrid * kGrid * kTimes;
  double sum = 0, squares = 0, least = 0, most = 0;
  for (int i = 0; i < kAll; ++i) {
    const double f = value(x + (i % kGrid + 0.5) / kGrid, y + (i / kGrid % kGrid + 0.5) / kGrid,
                           (i / kGrid / kGrid + 0.5) / kTimes);
    least = i == 0 ? f : std::min(least, f), most = i == 0 ? f : std::max(most, f);
    sum += f / kAll, squares += f * f / kAll;
  }
  return {sum, std::max(0.0, squares - sum * sum), 1e-3 * (most - least)};
}

/// By how much a mean of `count` samples with these moments and this range may be off with probability
/// `significance`: Bernstein's inequality. Samples that depend less on chance than independent ones are off
/// by less.
inline double bernstein(const Moments& m, double range, double count, double significance) {
  const double l = std::log(2 / significance), third = range * l / 3;
  return (third + std::sqrt(third * third + 2 * l * count * m.variance)) / count;
}

}  // namespace penumbra::motion_pieces
