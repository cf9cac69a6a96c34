// Bounds of single lights, by which they are chosen: never below the light's irradiance, by formulas and
// quadrature in this file, and 0 only where there is none. Inner nodes: see light_tree_test.cpp.
#include "scenes/device/light_bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "scenes/device/light_tree_builder.h"
#include "scenes/emitters.h"
#include "tests/kernels/light_scenes.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra::light_bounds_test {
namespace {

constexpr double kPi = std::numbers::pi;
// Of a bound some 20 roundings, and those of three products of its cosine.
constexpr double kRounding = 20 * 0x1p-24, kCosineError = 8 * 0x1p-24;

/// As the kernels have it.
glm::dvec3 in_float(const glm::dvec3& v) {
  return {double(float(v.x)), double(float(v.y)), double(float(v.z))};
}

/// Of one light by itself, in W/m^2.
struct Bound {
  LightTree tree;

  explicit Bound(const LightBounds& bounds) : tree(build_light_tree({&bounds, 1}, 1)) {}
  [[nodiscard]] double at(const glm::dvec3& p, const glm::dvec3& facing) const {
    LitPlace place;
    place.p = to_vec3(p);
    place.facing = to_vec3(facing);
    return double(light_importance(tree.nodes.data(), place));
  }
};

template <typename Model>
LightBounds bounds_of_model(const Model& model) {
  SceneTables tables;
  const auto at = [](const glm::dvec3& p) { return to_vec3(p); };
  const EmitterLight made = model.light({at, 2.0, tables});
  return made.bounds ? *made.bounds : bounds_of_light(made.light, made.power);
}

glm::dvec3 direction(RandomNumbers& random) {
  const Exact3 d = random.direction();
  return glm::normalize(glm::dvec3(double(d.x), double(d.y), double(d.z)));
}

/// A rotation and a place.
glm::dmat4 random_frame(RandomNumbers& random) {
  const glm::dvec3 z = direction(random), x = glm::normalize(glm::cross(z, direction(random)));
  const Exact3 p = random.point(1);
  return {glm::dvec4(x, 0), glm::dvec4(glm::cross(z, x), 0), glm::dvec4(z, 0),
          glm::dvec4(double(p.x), double(p.y), double(p.z), 1)};
}

/// Some receivers face any way, light from all directions counts for others (0).
glm::dvec3 random_facing(RandomNumbers& random) {
  return random.below(4) == 0 ? glm::dvec3(0.0) : in_float(direction(random));
}

/// A unit direction at that angle from a frame's z axis.
glm::dvec3 at_angle(const glm::dmat4& frame, double angle, double turn) {
  return glm::dvec3(frame * glm::dvec4(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                                       std::cos(angle), 0));
}

double received(const glm::dvec3& facing, const glm::dvec3& way) {
  return facing == glm::dvec3(0.0) ? 1.0 : std::max(-glm::dot(facing, way), 0.0);
}

struct Checked {
  int arrivals = 0, none = 0;
};

/// `across`: irradiance on a surface across the way of the light. `dark`: none comes near.
void check(const Bound& bound, const glm::dvec3& p, const glm::dvec3& facing, double across, double cosine,
           bool dark, Checked& checked) {
  const double bounded = bound.at(p, facing);
  if (across * cosine > 0) {
    ++checked.arrivals;
    ASSERT_GT(bounded, 0);
  }
  ASSERT_GE(bounded, across * ((1 - kRounding) * cosine - kCosineError));
  if (dark) {
    ++checked.none;
    ASSERT_EQ(bounded, 0);
  }
}

/// Of angles in degrees: the share of the intensity.
double spot_share(const SpotLight& spot, double angle) {
  if (angle <= spot.beam_width) return 1;
  if (angle >= spot.cutoff_angle) return 0;
  const auto cosine = [](double degrees) { return std::cos(degrees * kPi / 180); };
  const double t = spot.falloff == SpotFalloff::kLinear
                       ? (spot.cutoff_angle - angle) / (spot.cutoff_angle - spot.beam_width)
                       : (cosine(angle) - cosine(spot.cutoff_angle)) /
                             (cosine(spot.beam_width) - cosine(spot.cutoff_angle));
  return spot.falloff == SpotFalloff::kLinear    ? t
         : spot.falloff == SpotFalloff::kSquared ? t * t
                                                 : t * t * (3 - 2 * t);
}

// Beyond cones bounds may reach a little, and rounding decides what a receiver sees edge on.
constexpr double kBeyond = 2.5 * kPi / 180, kEdgeOn = 1e-6;

/// From a light at a frame's origin, by the numbers that the kernels have.
struct Way {
  glm::dvec3 p, direction;
  double d, angle, turn;  ///< in the frame
  Way(const glm::dmat4& frame, const glm::dvec3& about) : p(in_float(about)) {
    const glm::dvec3 way = p - in_float(glm::dvec3(frame[3]));
    d = glm::length(way);
    direction = way / d;
    const glm::dvec3 own = glm::transpose(glm::dmat3(frame)) * direction;
    angle = std::atan2(std::hypot(own.x, own.y), own.z);
    turn = std::atan2(own.y, own.x);
  }
};

bool is_behind(const glm::dvec3& facing, const glm::dvec3& way) {
  return facing != glm::dvec3(0.0) && -glm::dot(facing, way) < -kEdgeOn;
}
/// What a receiver gets of light that travels that way; nothing where it is edge on.
double cosine_of(const glm::dvec3& facing, const glm::dvec3& way) {
  const double cosine = received(facing, way);
  return cosine < kEdgeOn ? 0 : cosine;
}

TEST(LightBounds, HoldForSpots) {
  RandomNumbers random(61);
  Checked checked;
  for (int k = 0; k < 400; ++k) {
    SpotLight spot;
    spot.cutoff_angle = k % 4 == 0 ? random.between(90, 180) : std::pow(10.0, random.between(-1, 1.95));
    spot.beam_width = spot.cutoff_angle * random.uniform();
    spot.falloff = SpotFalloff(k % 3);
    spot.intensity = glm::vec3(float(std::pow(10.0, random.between(-3, 3))));
    spot.to_world = random_frame(random);
    const Bound bound(bounds_of_model(spot));
    const double cutoff = spot.cutoff_angle * kPi / 180;
    for (int j = 0; j < 300; ++j) {
      const double about = j % 3 == 0 ? random.between(0, kPi) : 1.3 * cutoff * random.uniform();
      const glm::dvec3 off = at_angle(spot.to_world, std::min(about, kPi), random.between(0, 2 * kPi)),
                       facing = random_facing(random);
      const Way way(spot.to_world,
                    glm::dvec3(spot.to_world[3]) + std::pow(10.0, random.between(-2, 2)) * off);
      const double intensity = double(spot.intensity.x) * spot_share(spot, way.angle * 180 / kPi);
      check(bound, way.p, facing, intensity / (way.d * way.d), cosine_of(facing, way.direction),
            is_behind(facing, way.direction) || way.angle > cutoff + kBeyond, checked);
    }
  }
  EXPECT_GT(checked.arrivals, 20'000);
  EXPECT_GT(checked.none, 20'000);
}

TEST(LightBounds, HoldForProjectors) {
  RandomNumbers random(62);
  Checked checked;
  for (int k = 0; k < 400; ++k) {
    ProjectorLight projector;
    projector.fov = k % 2 == 0 ? random.between(1, 60) : random.between(60, 160);
    projector.scale = float(std::pow(10.0, random.between(-3, 3)));
    projector.to_world = random_frame(random);
    const Bound bound(bounds_of_model(projector));
    const double edge = std::tan(projector.fov * kPi / 360), corner = std::atan(std::sqrt(2.0) * edge);
    for (int j = 0; j < 300; ++j) {
      const double about = j % 3 == 0 ? random.between(0, kPi) : 1.2 * corner * random.uniform();
      const glm::dvec3 off = at_angle(projector.to_world, std::min(about, kPi), random.between(0, 2 * kPi)),
                       facing = random_facing(random);
      const Way way(projector.to_world,
                    glm::dvec3(projector.to_world[3]) + std::pow(10.0, random.between(-2, 2)) * off);
      const double x = std::tan(way.angle) * std::cos(way.turn), y = std::tan(way.angle) * std::sin(way.turn);
      const bool within = way.angle < kPi / 2 && std::max(std::abs(x), std::abs(y)) < edge;
      // pi times the image on a plane at distance 1, which is farther off and seen under a cosine.
      const double intensity = within ? kPi * double(projector.scale) / std::pow(std::cos(way.angle), 3) : 0;
      check(bound, way.p, facing, intensity / (way.d * way.d), cosine_of(facing, way.direction),
            is_behind(facing, way.direction) || way.angle > corner + kBeyond, checked);
    }
  }
  EXPECT_GT(checked.arrivals, 20'000);
  EXPECT_GT(checked.none, 20'000);
}

TEST(LightBounds, HoldForDirectionalLights) {
  RandomNumbers random(63);
  Checked checked;
  for (int k = 0; k < 100; ++k) {
    DirectionalLight sun;
    sun.direction = direction(random);
    LightBounds bounds = bounds_of_model(sun);
    ASSERT_TRUE(bounds.infinite);
    bounds.intensity = 3;  // of infinite lights a matter of the scene
    const Bound bound(bounds);
    for (int j = 0; j < 300; ++j) {
      const glm::dvec3 p = 100.0 * direction(random), facing = random_facing(random);
      check(bound, p, facing, 3, cosine_of(facing, sun.direction), is_behind(facing, sun.direction), checked);
    }
  }
  EXPECT_GT(checked.arrivals, 10'000);
  EXPECT_GT(checked.none, 5'000);
}

/// Some receivers that all of a sun is behind, and no other, get nothing.
TEST(LightBounds, HoldForSuns) {
  RandomNumbers random(65);
  int lit = 0, none = 0;
  for (int k = 0; k < 100; ++k) {
    DirectionalLight sun;
    sun.direction = direction(random);
    sun.angle = 180 * std::pow(10.0, random.between(-3, 0));
    LightBounds bounds = bounds_of_model(sun);
    ASSERT_TRUE(bounds.infinite);
    bounds.intensity = 3;
    const Bound bound(bounds);
    const double half = sun.angle * kPi / 360;
    const glm::dvec3 z = sun.direction, x = glm::normalize(glm::cross(z, direction(random)));
    const glm::dmat4 frame{glm::dvec4(x, 0), glm::dvec4(glm::cross(z, x), 0), glm::dvec4(z, 0), {0, 0, 0, 1}};
    for (int j = 0; j < 300; ++j) {
      const glm::dvec3 p = 100.0 * direction(random), facing = random_facing(random);
      const glm::dvec3 way = at_angle(frame, half * random.between(0, 1), random.between(0, 2 * kPi));
      const double cosine = cosine_of(facing, way);
      if (cosine > 0) {
        ++lit;
        ASSERT_GE(bound.at(p, facing), 3 * ((1 - kRounding) * cosine - kCosineError));
      }
      if (facing != glm::dvec3(0.0) && std::acos(glm::dot(facing, z)) + half + kBeyond < kPi / 2) {
        ++none;
        ASSERT_EQ(bound.at(p, facing), 0);
      }
    }
  }
  EXPECT_GT(lit, 10'000);
  EXPECT_GT(none, 5'000);
}

/// Whatever of a spot light's sphere, or of a disk with a spread, shines on a receiver, the bound is above 0;
/// and not less than the irradiance where the light is small from there.
TEST(LightBounds, HoldForRoundSpotsAndSpreadDisks) {
  RandomNumbers random(66);
  int lit = 0, none = 0;
  for (int k = 0; k < 200; ++k) {
    const bool of_disk = k % 2 == 0;
    const glm::dmat4 frame = random_frame(random);
    const double radius = std::pow(10.0, random.between(-3, 0)), cutoff = random.between(1, 80) * kPi / 180;
    LightBounds bounds;
    if (of_disk) {
      Light light{};
      light.kind = LIGHT_DISK;
      light.p0 = to_vec3(glm::dvec3(frame[3]));
      light.p1 = to_vec3(glm::dvec3(frame[2]));
      light.p2 = make_vec3(float(radius), 1, 0);
      light.spread = float(std::tan(cutoff));
      light.gain = float(1 / (std::tan(cutoff) - cutoff));
      bounds = bounds_of_light(light, kPi * kPi * radius * radius);
    } else {
      SpotLight spot;
      spot.radius = radius;
      spot.cutoff_angle = spot.beam_width = cutoff * 180 / kPi;
      spot.to_world = frame;
      bounds = bounds_of_model(spot);
    }
    const Bound bound(bounds);
    for (int j = 0; j < 200; ++j) {
      const glm::dvec3 out =
          of_disk ? at_angle(frame, kPi / 2, random.between(0, 2 * kPi)) : direction(random);
      const glm::dvec3 from = glm::dvec3(frame[3]) + radius * (of_disk ? random.between(0, 1) : 1) * out;
      const double angle = 1.5 * cutoff * random.between(0, 1);
      const glm::dvec3 w = at_angle(frame, angle, random.between(0, 2 * kPi));
      const glm::dvec3 p = from + radius * std::pow(10.0, random.between(-1, 3)) * w,
                       facing = random_facing(random);
      const glm::dvec3 way = p - glm::dvec3(frame[3]);
      const double d = glm::length(way), cosine = received(facing, w);
      if (!of_disk && d < radius) continue;
      if (angle < cutoff * 0.999 && cosine > kEdgeOn) {
        ++lit;
        ASSERT_GT(bound.at(p, facing), 0);
        if (d > 100 * radius) {
          const double intensity = of_disk ? kPi * radius * radius * std::cos(angle) *
                                                 (std::tan(cutoff) - std::tan(angle)) /
                                                 (std::tan(cutoff) - cutoff)
                                           : 1;
          // The light's points differ from its middle by a hundredth.
          ASSERT_GT(bound.at(p, facing), 0.97 * intensity * (cosine - 0.01) / (d * d));
        }
      }
      const double along = glm::dot(way, glm::dvec3(frame[2])) / d;
      if (std::acos(along) - std::asin(std::min(2 * radius / d, 1.0)) > cutoff + kBeyond && 2 * radius < d) {
        ++none;
        ASSERT_EQ(bound.at(p, facing), 0);
      }
    }
  }
  EXPECT_GT(lit, 5'000);
  EXPECT_GT(none, 500);
}

/// Of a cylinder of radiance 1, whose outside shines if `outward`, else its inside: by the midpoint rule.
double cylinder_irradiance(const glm::dmat4& frame, double radius, double length, bool outward,
                           const glm::dvec3& p, const glm::dvec3& facing) {
  constexpr int kAround = 96, kAlong = 64;
  double sum = 0;
  for (int i = 0; i < kAround; ++i) {
    const double turn = 2 * kPi * (i + 0.5) / kAround;
    const glm::dvec3 out = at_angle(frame, kPi / 2, turn);
    for (int k = 0; k < kAlong; ++k) {
      const double h = length * (k + 0.5) / kAlong;
      const glm::dvec3 from = glm::dvec3(frame[3]) + radius * out + h * glm::normalize(glm::dvec3(frame[2]));
      const glm::dvec3 way = p - from;
      const double d2 = glm::dot(way, way);
      const glm::dvec3 w = way / std::sqrt(d2);
      const double front = std::max((outward ? 1.0 : -1.0) * glm::dot(out, w), 0.0);
      sum += front * received(facing, w) / d2;
    }
  }
  return sum * 2 * kPi * radius * length / (kAround * kAlong);
}

// The bound takes lights to be where the middle of their box is, or as far off as that reaches.
TEST(LightBounds, HoldForCylinders) {
  RandomNumbers random(64);
  Checked checked;
  for (int k = 0; k < 60; ++k) {
    const glm::dmat4 frame = random_frame(random);
    const double radius = std::pow(10.0, random.between(-2, 0)),
                 length = std::pow(10.0, random.between(-2, 0.5));
    const bool outward = k % 3 != 0;
    Light light{};
    light.kind = LIGHT_CYLINDER;
    light.p0 = to_vec3(glm::dvec3(frame[3]));
    light.p1 = to_vec3(glm::dvec3(frame[2]));
    light.p2 = make_vec3(float(radius), outward ? 1.0f : -1.0f, float(length));
    const LightBounds bounds = bounds_of_light(light, kPi * 2 * kPi * radius * length);
    const Bound bound(bounds);
    const glm::dvec3 middle = 0.5 * (bounds.low + bounds.high);
    const double reach = 0.5 * glm::length(bounds.high - bounds.low);
    for (int j = 0; j < 60; ++j) {
      const double d = reach * std::pow(10.0, random.between(-1, 1.5));
      const glm::dvec3 p = in_float(middle + d * direction(random)), facing = random_facing(random);
      const double irradiance = cylinder_irradiance(frame, radius, length, outward, p, facing);
      // What is nearer than the middle counts by as much more; of inner sides that only where all is far off.
      const double nearest = std::max(d - reach, 1e-9), scale = std::pow(std::max(d, reach) / nearest, 2);
      const double expected = d > 1.5 * reach ? irradiance / scale : 0;
      // Beyond the plane of its surface a receiver gets nothing.
      double lowest = 1e30;
      for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 c((corner & 1) != 0 ? bounds.high.x : bounds.low.x,
                           (corner & 2) != 0 ? bounds.high.y : bounds.low.y,
                           (corner & 4) != 0 ? bounds.high.z : bounds.low.z);
        lowest = std::min(lowest, -glm::dot(facing, c - p));
      }
      const bool behind = facing != glm::dvec3(0.0) && lowest > 1e-4 * (d + reach);
      if (irradiance > 1e-6 * radius * length / (d * d)) {
        ASSERT_GT(bound.at(p, facing), 0);
      }
      // The midpoint rule is off by a little at these distances.
      check(bound, p, facing, expected * (1 - 1e-3), 1, behind, checked);
    }
  }
  EXPECT_GT(checked.arrivals, 1000);
  EXPECT_GT(checked.none, 500);
}

}  // namespace
}  // namespace penumbra::light_bounds_test
