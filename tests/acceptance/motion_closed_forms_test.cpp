// Blurred images against closed forms: means over the pixel and the exposure of what is there.
#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <vector>

#include "kernels/host/flagged_samples.h"
#include "scenes/motion/exposed_motion.h"
#include "tests/acceptance/motion_pieces.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra::motion_closed_forms_test {
namespace {

using namespace motion_pieces;
using glm::dvec2, glm::dvec3;

constexpr double kPi = std::numbers::pi;
constexpr std::uint32_t kSpp = 4096;
constexpr double kSingle = 1e-5;  // single precision of what is about 1

/// Each pixel's moments, of samples from 0 to 1.
using Truth = std::function<Moments(int, int)>;

/// Pixels of the red channel, and of alpha where `alpha` is given.
void expect_film(const SceneDescription& scene, const std::optional<Truth>& red,
                 const std::optional<Truth>& alpha = std::nullopt) {
  const FilmAccumulator film = render_or_throw(scene);
  EXPECT_EQ(non_finite_count(film.flagged()), 0u);
  const int pixels = film.width() * film.height();
  const double each = statistics::sidak_significance(kSignificance, std::size_t(pixels) * 2);
  double worst = 0;
  const auto expect = [&](double found, const Moments& m, const char* what, int x, int y) {
    const double limit = bernstein(m, 1, scene.sampler.spp, each) + m.allowance + kSingle;
    EXPECT_NEAR(found, m.mean, limit) << what << " of pixel " << x << ", " << y;
    worst = std::max(worst, std::abs(found - m.mean) / limit);
  };
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x) {
      if (red) expect(film.at(x, y).mean[0], (*red)(x, y), "red", x, y);
      if (alpha) expect(film.layer(x, y, LAYER_COVERAGE), (*alpha)(x, y), "alpha", x, y);
    }
  testing::Test::RecordProperty("worst", std::to_string(worst) + " of the limit");
}

/// The thing, white and then black: its radiance and its coverage.
void expect_inside(const std::function<SceneDescription(bool emits)>& make,
                   const std::function<bool(dvec2, double)>& inside, double deviation = 0) {
  const SceneDescription white = make(true);
  const auto indicator = [&](double u, double v, double t) { return inside({u, v}, t) ? 1.0 : 0.0; };
  std::vector<Moments> pixels;
  for (int y = 0; y < white.film.height; ++y)
    for (int x = 0; x < white.film.width; ++x) pixels.push_back(moments(x, y, indicator, deviation));
  const Truth truth = [&](int x, int y) { return pixels[std::size_t(y * white.film.width + x)]; };
  {
    SCOPED_TRACE("emits");
    expect_film(white, truth, truth);
  }
  SCOPED_TRACE("is black");
  expect_film(make(false), std::nullopt, truth);
}

std::optional<float> glow(bool emits) { return emits ? std::optional(1.0f) : std::nullopt; }

/// The length that two intervals share.
double common(double a, double b, double c, double d) {
  return std::max(0.0, std::min(b, d) - std::max(a, c));
}

struct ShutterCase {
  std::string name;
  std::vector<double> curve;
};
void PrintTo(const ShutterCase& c, std::ostream* out) { *out << c.name; }
class CrossingSquare : public testing::TestWithParam<ShutterCase> {};

double on_curve(const std::vector<double>& knots, double t) {
  const double at = t * double(knots.size() - 1);
  const std::size_t k = std::min(std::size_t(at), knots.size() - 2);
  return knots[k] + (at - double(k)) * (knots[k + 1] - knots[k]);
}

TEST_P(CrossingSquare, IsTheIntegralOfCoverageTimesCurve) {
  constexpr double kLeft = 1.3, kSize = 2.5, kWay = 8.4, kTop = 0.7;
  const std::vector<double>& knots = GetParam().curve;
  const Truth truth = [&](int x, int y) {
    constexpr int kTimes = 2000;  // the integrand has kinks alone, so the error is below 1e-5
    double sum = 0, all = 0;
    for (int i = 0; i < kTimes; ++i) {
      const double t = (i + 0.5) / kTimes, left = kLeft + kWay * t;
      sum += on_curve(knots, t) * common(x, x + 1, left, left + kSize);
      all += on_curve(knots, t);
    }
    const double mean = sum / all * common(y, y + 1, kTop, kTop + kSize);
    return Moments{.mean = mean, .variance = mean * (1 - mean)};
  };
  for (const bool emits : {true, false}) {
    SceneDescription scene = pixel_world(14, 4, kSpp);
    scene.camera.shutter_curve = knots;
    scene.shapes.push_back(rectangle({kLeft, kTop, 0}, kSize, kSize, kBlackBsdf, glow(emits)));
    {
      Mover move(scene);
      move.last_shape(move.node({kWay, 0, 0}));
    }
    if (emits)
      expect_film(scene, truth, truth);
    else
      expect_film(scene, std::nullopt, truth);
  }
}

INSTANTIATE_TEST_SUITE_P(Curves, CrossingSquare,
                         testing::Values(ShutterCase{"Box", kBoxShutter},
                                         ShutterCase{"Triangle", kTriangleShutter},
                                         ShutterCase{"Table", {0.2, 1, 0, 0.6, 0.6}},
                                         ShutterCase{"OpensLate", {0, 0, 3}}),
                         [](const auto& tested) { return tested.param.name; });

TEST(MotionClosedForm, TrapezoidInTheMiddleOfTheWay) {
  // A pixel in the middle sees the whole square pass: its coverage is the square's width over the way.
  constexpr double kSize = 2, kWay = 12;
  SceneDescription scene = pixel_world(16, 1, 4 * kSpp);
  scene.shapes.push_back(rectangle({1, -1, 0}, kSize, 3, kBlackBsdf, 1.0f));
  {
    Mover move(scene);
    move.last_shape(move.node({kWay, 0, 0}));
  }
  expect_film(scene, [&](int x, int) {
    // The trapezoid from 1 to 15 with a top from 3 to 13, integrated over the pixel.
    const auto integral = [&](double at) {
      const double up = std::clamp(at - 1, 0.0, kSize), top = std::clamp(at - 3, 0.0, kWay - kSize),
                   down = std::clamp(at - 13, 0.0, kSize);
      return (0.5 * up * up + kSize * top + kSize * down - 0.5 * down * down) / kWay;
    };
    const double mean = integral(x + 1) - integral(x);
    return Moments{.mean = mean, .variance = mean * (1 - mean)};
  });
}

/// Half a disk, as a fan of triangles that face the camera.
Shape half_disk(dvec2 center, double radius, std::optional<float> radiance) {
  constexpr int kParts = 48;
  std::vector<dvec3> positions;
  const auto on = [&](int i) {
    const double a = kPi * i / kParts;
    return dvec3(center + radius * dvec2(std::cos(a), std::sin(a)), 0);
  };
  for (int i = 0; i < kParts; ++i) positions.insert(positions.end(), {dvec3(center, 0), on(i + 1), on(i)});
  return triangles(positions, kBlackBsdf, radiance);
}

/// Turned by -`angle` about the centre.
dvec2 turned(dvec2 p, dvec2 center, double angle) {
  const dvec2 d = p - center;
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * d.x + s * d.y, -s * d.x + c * d.y};
}

/// A polygon of 96 corners instead of a circle: the sagitta of a side.
constexpr double kDiskRadius = 5.2;
const double kSagitta = kDiskRadius * (1 - std::cos(kPi / 96));

TEST(MotionClosedForm, DiskHalfWhiteTurns) {
  for (const double degrees : {100.0, 360.0}) {
    SCOPED_TRACE(degrees);
    const dvec2 center(6, 6);
    expect_inside(
        [&](bool emits) {
          SceneDescription scene = pixel_world(12, 12, kSpp);
          scene.shapes.push_back(half_disk(center, kDiskRadius, glow(emits)));
          Mover move(scene);
          move.last_shape(move.node({0, 0, 0}, degrees, {0, 0, 1}, dvec3(center, 0)));
          return scene;
        },
        [&](dvec2 p, double t) {
          const dvec2 q = turned(p, center, glm::radians(degrees) * t);
          return q.y > 0 && glm::length(q) < kDiskRadius;
        },
        kMostDeviation + kSagitta);
  }
}

TEST(MotionClosedForm, CameraMovesBeforeACheckerboard) {
  const dvec2 way(3.7, -2.2);
  constexpr double kSquare = 2.6;
  constexpr int kSquares = 8;
  const dvec2 corner(-4, -4);
  expect_inside(
      [&](bool emits) {
        SceneDescription scene = pixel_world(12, 12, kSpp);
        std::vector<dvec3> positions;
        for (int i = 0; i < kSquares; ++i)
          for (int j = (i & 1); j < kSquares; j += 2) {
            const dvec3 a(corner + kSquare * dvec2(i, j), 3);
            const dvec3 right(kSquare, 0, 0), down(0, kSquare, 0);
            positions.insert(positions.end(),
                             {a, a + down, a + down + right, a, a + down + right, a + right});
          }
        scene.shapes.push_back(triangles(positions, kBlackBsdf, glow(emits)));
        Mover move(scene);
        move.camera(move.node(dvec3(way, 0)));
        return scene;
      },
      [&](dvec2 p, double t) {
        const dvec2 q = glm::floor((p + t * way - corner) / kSquare);
        return q.x >= 0 && q.y >= 0 && q.x < kSquares && q.y < kSquares && (int(q.x) + int(q.y)) % 2 == 0;
      });
}

TEST(MotionClosedForm, SphereShrinks) {
  const dvec2 center(6.2, 5.8);
  constexpr double kFrom = 5, kTo = 1;
  SceneDescription last;
  expect_inside(
      [&](bool emits) {
        SceneDescription scene = pixel_world(12, 12, kSpp);
        Shape sphere;
        sphere.name = "sphere";
        sphere.geometry = Sphere{dvec3(center, 0), kFrom};
        if (emits) sphere.radiance = glm::vec3(1);
        scene.shapes.push_back(sphere);
        {
          Mover move(scene);
          move.last_shape(move.node({0, 0, 0}, 0, {0, 1, 0}, dvec3(center, 0), kTo / kFrom));
        }
        last = scene;
        return scene;
      },
      [&](dvec2 p, double t) { return glm::distance(p, center) < kFrom + t * (kTo - kFrom); });
  // The whole image: the integral of the projected area.
  const FilmAccumulator film = render_or_throw(last);
  double covered = 0;
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x) covered += film.layer(x, y, LAYER_COVERAGE);
  const double area = kPi * (kFrom * kFrom + kFrom * kTo + kTo * kTo) / 3;
  const double pixels = double(film.width()) * film.height(), share = area / pixels;
  const Moments m{.mean = share, .variance = share * (1 - share)};
  EXPECT_NEAR(covered / pixels, share, bernstein(m, 1, pixels * kSpp, kSignificance) + kSingle);
}

TEST(MotionClosedForm, SquareIsSheared) {
  // Keys are decomposed into a rotation by half the shear's angle and a symmetric stretch.
  constexpr double kShear = 1.4;
  const glm::dmat2 shear(1, 0, kShear, 1);  // columns: x' = x + kShear y
  const double angle = std::atan2(shear[0][1] - shear[1][0], shear[0][0] + shear[1][1]);
  const auto rotation = [](double a) {
    return glm::dmat2(std::cos(a), std::sin(a), -std::sin(a), std::cos(a));
  };
  const glm::dmat2 stretch = rotation(-angle) * shear;
  EXPECT_NEAR(stretch[0][1], stretch[1][0], 1e-12) << "the decomposition is symmetric";
  const dvec2 center(6, 6);
  constexpr double kHalf = 2.3;
  expect_inside(
      [&](bool emits) {
        SceneDescription scene = pixel_world(12, 12, kSpp);
        scene.shapes.push_back(rectangle({center - kHalf, 0}, 2 * kHalf, 2 * kHalf, kBlackBsdf, glow(emits)));
        glm::dmat4 m(1);
        m[1][0] = kShear;
        m = glm::translate(glm::dmat4(1), dvec3(center, 0)) * m *
            glm::translate(glm::dmat4(1), -dvec3(center, 0));
        Mover move(scene);
        move.last_shape(move.node(std::vector<TransformKey>{{0, glm::dmat4(1)}, {1, m}}));
        return scene;
      },
      [&](dvec2 p, double t) {
        // The keys' translations are those of the origin: M(t) maps it to that of the shear, linearly.
        const glm::dmat2 now = rotation(t * angle) * ((1 - t) * glm::dmat2(1) + t * stretch);
        const dvec2 origin = t * (center - shear * center);
        const dvec2 q = glm::inverse(now) * (p - origin) - center;
        return std::max(std::abs(q.x), std::abs(q.y)) < kHalf;
      },
      kMostDeviation);
}

TEST(MotionClosedForm, RollingShutterSlantsAnEdge) {
  constexpr int kHeight = 9;
  constexpr double kFrom = 1.4, kSpeed = 6.3;  // pixels a frame
  for (const auto& [exposure, rolling] : {std::pair(0.0, 1.0), {0.5, 0.5}, {0.25, 1.25}}) {
    SCOPED_TRACE(exposure);
    const double whole = exposure + rolling;
    const Truth truth = [&](int x, int y) {
      // Row y is exposed from `from` on.
      const double from = rolling * y / (kHeight - 1);
      constexpr int kTimes = 1024;
      double mean = 0;
      for (int i = 0; i < kTimes; ++i) {
        const double edge = kFrom + kSpeed * (from + exposure * (i + 0.5) / kTimes);
        mean += common(x, x + 1, -1, edge) / kTimes;
      }
      return Moments{.mean = mean, .variance = mean * (1 - mean)};
    };
    for (const bool emits : {true, false}) {
      SceneDescription scene = pixel_world(16, kHeight, kSpp);
      scene.camera.shutter = float(exposure);
      scene.camera.rolling_shutter = rolling;
      scene.shapes.push_back(rectangle({kFrom - 30, -1, 0}, 30, kHeight + 2, kBlackBsdf, glow(emits)));
      {
        Mover move(scene);
        move.last_shape(move.node(std::vector<TransformKey>{
            {0, glm::dmat4(1)}, {whole, glm::translate(glm::dmat4(1), dvec3(kSpeed * whole, 0, 0))}}));
      }
      expect_film(scene, emits ? std::optional(truth) : std::nullopt, truth);
    }
  }
}

constexpr int kFloor = 5;  // pixels
constexpr double kAlbedo = 0.6;
/// A diffuse floor that the camera sees whole.
SceneDescription floor_world(const IntegratorSettings& integrator) {
  SceneDescription scene = pixel_world(kFloor, kFloor, 512);
  scene.integrator = integrator;
  add_diffuse(scene, float(kAlbedo));
  scene.shapes.push_back(rectangle({-40, -40, 0}, 88, 88, 0));
  return scene;
}

/// Irradiance at a point at a time, averaged over the pixel and the exposure by the midpoint rule, whose
/// error for these smooth integrands is below 1e-4 of it.
void expect_floor(const SceneDescription& scene, const std::function<double(dvec2, double)>& irradiance,
                  double deviation = 0) {
  const FilmAccumulator film = render_or_throw(scene);
  const double each = statistics::sidak_significance(kSignificance, std::size_t(kFloor) * kFloor);
  double smallest = 1;
  for (int y = 0; y < kFloor; ++y)
    for (int x = 0; x < kFloor; ++x) {
      constexpr int kGrid = 4, kTimes = 64;
      double sum = 0;
      for (int i = 0; i < kGrid * kGrid; ++i)
        for (int k = 0; k < kTimes; ++k)
          sum +=
              irradiance({x + (i % kGrid + 0.5) / kGrid, y + (i / kGrid + 0.5) / kGrid}, (k + 0.5) / kTimes);
      const double truth = kAlbedo / kPi * sum / (kGrid * kGrid * kTimes);
      const auto test = statistics::t_test(pixel_sample(film, x, y, 0), truth, truth * (2e-4 + deviation));
      EXPECT_GT(test.p, each) << x << ", " << y << ": " << film.at(x, y).mean[0] << " instead of " << truth;
      smallest = std::min(smallest, test.p);
    }
  testing::Test::RecordProperty("p", std::to_string(smallest));
}

TEST(MotionClosedForm, PointLightMovesOverAFloor) {
  const dvec3 from(1, 3, -3), way(6, 1.5, 1);
  constexpr double kIntensity = 7;
  SceneDescription scene = floor_world(direct_integrator(1, 0));
  scene.emitters.push_back(PointLight{.position = from, .intensity = glm::vec3(kIntensity)});
  {
    Mover move(scene);
    move.emitter(0, move.node(way));
  }
  expect_floor(scene, [&](dvec2 p, double t) {
    const dvec3 at = from + t * way, d = at - dvec3(p, 0);
    return kIntensity * -d.z / std::pow(glm::dot(d, d), 1.5);
  });
}

/// Lambert's formula for the irradiance by a polygon of radiance 1 that lies above the floor.
double lambert(const std::vector<dvec3>& corners, dvec3 p) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const dvec3 a = glm::normalize(corners[i] - p), b = glm::normalize(corners[(i + 1) % corners.size()] - p);
    const dvec3 normal = glm::cross(a, b);
    const double length = glm::length(normal);
    if (length > 0) sum += std::atan2(length, glm::dot(a, b)) * normal.z / length;
  }
  return std::abs(0.5 * sum);
}

class AreaLight : public testing::TestWithParam<bool> {};

TEST_P(AreaLight, MovesOverAFloor) {
  const bool turns = GetParam();
  // Beside the film, so the camera does not see it.
  const dvec3 corner(-6, 2, -3), u(2.5, 0, -0.5), v(0, 3, 0), way(2.5, 2, -1);
  constexpr double kDegrees = 50, kRadiance = 4;
  const dvec3 center = corner + 0.5 * (u + v);
  for (const IntegratorSettings& integrator :
       {direct_integrator(1, 0), direct_integrator(1, 1), path_integrator(DirectSampling::kMis),
        integrator_of(IntegratorKind::kPolygonCv)}) {
    SCOPED_TRACE(method_name(integrator.method));
    SceneDescription scene = floor_world(integrator);
    limit_depth(scene.integrator, 2);
    scene.shapes.push_back(parallelogram(corner, u, v, kBlackBsdf, float(kRadiance)));
    {
      Mover move(scene);
      move.last_shape(move.node(way, turns ? kDegrees : 0, {0, 1, 0}, center));
    }
    // Turned, it may be a tenth of a pixel off; irradiance falls with the square of a distance of at least 3.
    const double deviation = turns ? 2 * kMostDeviation / 3 : 0;
    expect_floor(
        scene,
        [&](dvec2 p, double t) {
          const glm::dmat3 turn(
              glm::rotate(glm::dmat4(1), glm::radians(turns ? kDegrees * t : 0), {0, 1, 0}));
          std::vector<dvec3> corners{corner, corner + u, corner + u + v, corner + v};
          for (dvec3& c : corners) c = center + t * way + turn * (c - center);
          return kRadiance * lambert(corners, dvec3(p, 0));
        },
        deviation);
  }
}

INSTANTIATE_TEST_SUITE_P(Ways, AreaLight, testing::Bool(),
                         [](const auto& tested) { return tested.param ? "AndTurns" : "Straight"; });

}  // namespace
}  // namespace penumbra::motion_closed_forms_test
