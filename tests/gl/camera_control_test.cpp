#include "gl/camera_control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "kernels/camera/camera.h"

namespace penumbra {
namespace {

using glm::dvec3;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kFloatUnit = 0x1p-24;  // of rounding to single precision, relative
constexpr double kDoubleUnit = 0x1p-53;
// Axes come from a few operations in double, each with a relative error of a few units.
constexpr double kAxisTolerance = 32 * kDoubleUnit;
// Lengths and angles of vectors rounded to single precision once, component by component.
constexpr double kFilmTolerance = 4 * kFloatUnit;

dvec3 wide(const vec3& v) { return {v.x, v.y, v.z}; }
vec3 narrow(const dvec3& v) { return make_vec3(float(v.x), float(v.y), float(v.z)); }

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  dvec3 direction() {
    std::normal_distribution<double> normal;
    return glm::normalize(dvec3(normal(engine_), normal(engine_), normal(engine_)));
  }
  int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(engine_); }

 private:
  std::mt19937_64 engine_;
};

/// A camera as the device scene builder makes it: left, up, forward.
SceneHeader header_of(const dvec3& eye, const dvec3& at, const dvec3& up, double tan_x, double tan_y,
                      bool mirrored = false) {
  SceneHeader h{};
  h.film.width = 101;
  h.film.height = 51;
  h.camera.far_clip = 1e30f;
  const dvec3 z = glm::normalize(at - eye);
  const dvec3 x = glm::normalize(glm::cross(up, z));
  const dvec3 y = glm::cross(z, x);
  h.camera.origin = narrow(eye);
  h.camera.x = narrow((mirrored ? -tan_x : tan_x) * x);
  h.camera.y = narrow(tan_y * y);
  h.camera.z = narrow(z);
  return h;
}

void expect_near(const dvec3& a, const dvec3& b, double tolerance, std::string_view what) {
  EXPECT_LE(glm::distance(a, b), tolerance) << what << ": (" << a.x << ", " << a.y << ", " << a.z
                                            << ") against (" << b.x << ", " << b.y << ", " << b.z << ")";
}

void expect_orthonormal(const ViewFrame& f) {
  for (const dvec3& axis : {f.right, f.up, f.forward}) EXPECT_NEAR(glm::length(axis), 1, kAxisTolerance);
  EXPECT_NEAR(glm::dot(f.right, f.up), 0, kAxisTolerance);
  EXPECT_NEAR(glm::dot(f.up, f.forward), 0, kAxisTolerance);
  EXPECT_NEAR(glm::dot(f.forward, f.right), 0, kAxisTolerance);
  EXPECT_NEAR(glm::dot(glm::cross(f.right, f.up), -f.forward), 1,
              kAxisTolerance);  // right-handed, view along -z
}

double elevation_of(const CameraPose& pose) {
  const dvec3 offset = pose.eye - pose.at;
  return std::asin(std::clamp(glm::dot(offset, pose.up) / glm::length(offset), -1.0, 1.0));
}

/// One of everything that a person can do, in a scene of this size.
CameraPose random_action(const CameraPose& pose, Random& random, double scale) {
  switch (random.below(3)) {
    case 0: {
      const double yaw = random.between(-1, 1);
      return orbit(pose, yaw, random.between(-1, 1));
    }
    case 1: {
      const double right = random.between(-scale, scale), up = random.between(-scale, scale);
      return move(pose, right, up, random.between(-scale, scale));
    }
    default:
      return dolly(pose, std::exp2(random.between(-1, 1)));
  }
}

TEST(CameraControl, TenThousandActionsLeaveTheFilmAsItWas) {
  for (const bool mirrored : {false, true}) {
    const SceneHeader original = header_of({3, 2, 5}, {0, 1, 0}, {0, 1, 0}, 0.7, 0.35, mirrored);
    CameraPose pose = pose_of(original, 5);
    const dvec3 up = pose.up;
    Random random(1);
    for (int i = 0; i < 10000 && !HasFailure(); ++i) {
      pose = random_action(pose, random, 1);
      EXPECT_EQ(pose.up, up);
      const ViewFrame frame = view_frame(pose);
      expect_orthonormal(frame);
      EXPECT_NEAR(glm::dot(frame.right, up), 0, kAxisTolerance) << "rolled";
      EXPECT_LE(std::abs(elevation_of(pose)), 89.9 * kDegree + 1e-9);
      SceneHeader h = original;
      set_camera(pose, h);
      const dvec3 x = wide(h.camera.x), y = wide(h.camera.y), z = wide(h.camera.z);
      EXPECT_NEAR(glm::length(x), 0.7, 0.7 * 2 * kFilmTolerance);  // rounded in the original and here
      EXPECT_NEAR(glm::length(y), 0.35, 0.35 * 2 * kFilmTolerance);
      EXPECT_NEAR(glm::length(z), 1, kFilmTolerance);
      EXPECT_NEAR(glm::dot(x, y), 0, 0.7 * 0.35 * 2 * kFilmTolerance);
      EXPECT_NEAR(glm::dot(y, z), 0, 0.35 * 2 * kFilmTolerance);
      EXPECT_NEAR(glm::dot(z, x), 0, 0.7 * 2 * kFilmTolerance);
      EXPECT_EQ(film_is_mirrored(h), mirrored);
      expect_near(wide(h.camera.origin), pose.eye, glm::length(pose.eye) * kFilmTolerance, "eye");
    }
  }
}

TEST(CameraControl, WhatIsSetIsWhatIsSeen) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const bool mirrored = i % 2 == 1;
    SceneHeader h = header_of({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.5, 0.25, mirrored);
    const dvec3 eye = 3.0 * random.direction(), at = eye + 2.0 * random.direction();
    const CameraPose pose{eye, at, random.direction()};
    const ViewFrame frame = view_frame(pose);
    set_camera(pose, h);
    const auto direction = [&](int x, int y) {
      return wide(camera_ray(h.camera, h.film, x, y, 0, 0).direction);
    };
    // The middle of the film shows the target; its right edge what is to the right.
    expect_near(direction(50, 25), glm::normalize(at - eye), 8 * kFloatUnit, "middle");
    const double side = glm::dot(direction(100, 25), frame.right);
    EXPECT_GT(mirrored ? -side : side, 0.4);
    EXPECT_GT(glm::dot(direction(50, 0), frame.up), 0.2);
  }
}

TEST(CameraControl, AHeadersPoseGivesTheHeaderBack) {
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const double scale = std::pow(10, random.between(-4, 5));
    const dvec3 eye = scale * random.between(0, 3) * random.direction();
    const dvec3 axis = i % 3 == 0 ? dvec3(0, 1, 0) : i % 3 == 1 ? dvec3(0, 0, 1) : random.direction();
    SceneHeader h = header_of(eye, eye + random.direction(), axis, random.between(0.01, 10),
                              random.between(0.01, 10), i % 2 == 1);
    if (i % 7 == 0) h.camera.x = add_scaled(h.camera.x, 0.1f, h.camera.y);  // a sheared film
    SceneHeader again = h;
    set_camera(pose_of(h, scale * random.between(0.1, 3)), again);
    EXPECT_EQ(std::memcmp(&h.camera.origin, &again.camera.origin, sizeof(vec3)), 0);
    // The new axes are rounded to single precision, as the old ones are, which alone leaves them a unit or
    // two short of unit length.
    expect_near(wide(again.camera.x), wide(h.camera.x), length3(h.camera.x) * kFilmTolerance, "x");
    expect_near(wide(again.camera.y), wide(h.camera.y), length3(h.camera.y) * kFilmTolerance, "y");
    expect_near(wide(again.camera.z), wide(h.camera.z), kFilmTolerance, "z");
  }
}

TEST(CameraControl, NothingButTheCameraChanges) {
  SceneHeader h = header_of({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.5, 0.25), expected = h;
  set_camera({{1, 2, 3}, {0, 0, 0}, {0, 1, 0}}, h);
  expected.camera.origin = h.camera.origin;
  expected.camera.x = h.camera.x;
  expected.camera.y = h.camera.y;
  expected.camera.z = h.camera.z;
  EXPECT_EQ(std::memcmp(&h, &expected, sizeof h), 0);
}

TEST(CameraControl, ThePoseKnowsWhichAxisIsUp) {
  Random random(4);
  for (const dvec3& axis : {dvec3(0, 1, 0), dvec3(0, 0, 1), dvec3(0, -1, 0), dvec3(1, 0, 0)}) {
    for (int i = 0; i < 100; ++i) {
      dvec3 view = random.direction();
      if (std::abs(glm::dot(view, axis)) > 0.7) continue;  // so steep that another axis may be meant
      const CameraPose pose = pose_of(header_of({1, 2, 3}, dvec3(1, 2, 3) + view, axis, 0.5, 0.5), 2);
      // The film's axes are rounded, and so is the angle between them and the axis that is left out of the
      // rounding.
      expect_near(pose.up, axis, 16 * kFloatUnit, "up");
    }
  }
}

TEST(CameraControl, AFilmThatIsNearlyUprightCountsAsUprightAndATiltedOneDoesNot) {
  const auto rolled = [](double degrees) {
    const dvec3 up(std::sin(degrees * kDegree), std::cos(degrees * kDegree), 0);
    return pose_of(header_of({0, 0, 5}, {0, -2, 0}, up, 0.5, 0.5), 5).up;
  };
  const double slightly = std::acos(rolled(0.3).y) / kDegree;
  EXPECT_GT(slightly, 0.1);
  EXPECT_LT(slightly, 0.5);
  const SceneHeader tilted =
      header_of({0, 0, 5}, {0, -2, 0}, {std::sin(20 * kDegree), std::cos(20 * kDegree), 0}, 1, 1);
  expect_near(pose_of(tilted, 5).up, glm::normalize(wide(tilted.camera.y)), kFilmTolerance,
              "the film's axis");
}

TEST(CameraControl, ActionsAreTheSameInScenesOfAnySize) {
  // A scene scaled by a power of two has the same roundings, so the same bits: from 6e-5 to 1.3e5.
  for (const double scale : {0x1p-14, 0x1p-7, 0x1p10, 0x1p17}) {
    CameraPose one{{3, 2, 5}, {0, 1, 0}, {0, 1, 0}};
    CameraPose other{scale * one.eye, scale * one.at, one.up};
    Random first(5), second(5);
    for (int i = 0; i < 1000; ++i) {
      one = random_action(one, first, 1);
      other = random_action(other, second, scale);
      ASSERT_EQ(other.eye, scale * one.eye) << scale << ", action " << i;
      ASSERT_EQ(other.at, scale * one.at) << scale << ", action " << i;
    }
  }
}

TEST(CameraControl, InverseActionsReturn) {
  Random random(6);
  for (int i = 0; i < 2000; ++i) {
    const double scale = std::pow(10, random.between(-4, 5));
    CameraPose pose{scale * random.direction(), {0, 0, 0}, random.direction()};
    pose.at = scale * random.between(0, 2) * random.direction();
    if (std::abs(elevation_of(pose)) > 80 * kDegree) continue;
    const double size = glm::length(pose.eye) + glm::length(pose.at);
    const double tolerance = 1e-13 * size;  // some hundred operations in double
    const double yaw = random.between(-4, 4), pitch = random.between(-5 * kDegree, 5 * kDegree);
    expect_near(orbit(orbit(pose, yaw, pitch), -yaw, -pitch).eye, pose.eye, tolerance, "orbit");
    const double a = scale * random.between(-1, 1), b = scale * random.between(-1, 1),
                 c = scale * random.between(-1, 1);
    const CameraPose back = move(move(pose, a, b, c), -a, -b, -c);
    // Rounding of the moved points turns the axes by it over the distance.
    const double lever = 1 + scale / glm::distance(pose.eye, pose.at);
    expect_near(back.eye, pose.eye, tolerance * lever, "move");
    expect_near(back.at, pose.at, tolerance * lever, "move");
    const double factor = std::exp2(random.between(-3, 3));
    expect_near(dolly(dolly(pose, factor), 1 / factor).eye, pose.eye, tolerance, "dolly");
  }
}

TEST(CameraControl, MovesGoWhereTheyAreSaidToGo) {
  // From +z at the origin with y up: right is +x.
  const CameraPose pose{{0, 0, 4}, {0, 0, 0}, {0, 1, 0}};
  expect_near(move(pose, 1, 0, 0).eye, {1, 0, 4}, 1e-15, "right");
  expect_near(move(pose, 0, 1, 0).at, {0, 1, 0}, 1e-15, "up");
  const CameraPose looking_down{{0, 3, 4}, {0, 0, 0}, {0, 1, 0}};
  expect_near(move(looking_down, 0, 1, 0).at, {0, 1, 0}, 1e-15, "up is the world's");
  expect_near(move(looking_down, 0, 0, 5).eye, {0, 0, 0}, 1e-14, "forward is the view's");
  expect_near(move(pose, 0, 0, 1).eye, {0, 0, 3}, 1e-15, "forward");
  expect_near(move(pose, 0, 0, 1).at, {0, 0, -1}, 1e-15, "forward");
  expect_near(dolly(pose, 0.25).eye, {0, 0, 1}, 1e-15, "dolly");
  expect_near(orbit(pose, 90 * kDegree, 0).eye, {4, 0, 0}, 1e-14, "to the right");
  expect_near(orbit(pose, 0, 30 * kDegree).eye, {0, 2, 2 * std::sqrt(3)}, 1e-14, "upwards");
  expect_near(orbit(pose, std::numbers::pi, 0).eye, {0, 0, -4}, 1e-14, "to the other side");
  EXPECT_EQ(orbit(pose, 1, 0.5).at, pose.at);
}

TEST(CameraControl, ThePolesAreNotReached) {
  for (const double sign : {1.0, -1.0}) {
    CameraPose pose{{1, 0.5, 4}, {0, 0, 0}, {0, 1, 0}};
    const double distance = glm::length(pose.eye);
    const double azimuth = std::atan2(pose.eye.x, pose.eye.z);
    for (int i = 0; i < 100; ++i) pose = orbit(pose, 0, sign * 0.3);
    EXPECT_NEAR(elevation_of(pose), sign * 89.9 * kDegree, 1e-9);
    EXPECT_NEAR(glm::length(pose.eye), distance, 1e-13);
    EXPECT_NEAR(std::atan2(pose.eye.x, pose.eye.z), azimuth, 1e-10) << "turned over the pole";
    expect_orthonormal(view_frame(pose));
    pose = orbit(pose, 1, 0);
    EXPECT_NEAR(std::atan2(pose.eye.x, pose.eye.z), azimuth + 1, 1e-10);
    pose = orbit(pose, 0, -sign * 89.9 * kDegree);
    EXPECT_NEAR(pose.eye.y, 0, 1e-10);
  }
}

TEST(CameraControl, DegenerateViewsHaveAxesAllTheSame) {
  const CameraPose above{{0, 5, 0}, {0, 0, 0}, {0, 1, 0}};
  for (const CameraPose& pose :
       {above, CameraPose{{1, 1, 1}, {1, 1, 1}, {0, 1, 0}}, CameraPose{{0, 0, 1}, {0, 0, 0}, {0, 0, 0}},
        CameraPose{{1e-200, 0, 0}, {0, 0, 0}, {0, 1e-200, 0}},
        CameraPose{{1e200, 0, 0}, {0, 0, 0}, {0, 1e200, 0}}}) {
    expect_orthonormal(view_frame(pose));
  }
  // Out of the pole by any turn.
  const CameraPose turned = orbit(above, 0.5, -0.5);
  EXPECT_NEAR(glm::length(turned.eye), 5, 1e-13);
  EXPECT_NEAR(elevation_of(turned), 90 * kDegree - 0.5, 1e-9);
  const CameraPose nowhere{{1, 1, 1}, {1, 1, 1}, {0, 1, 0}};
  EXPECT_EQ(orbit(nowhere, 1, 1).eye, nowhere.eye);
  EXPECT_EQ(dolly(nowhere, 2).eye, nowhere.eye);
}

TEST(CameraControl, TheWheelNeverReachesTheTarget) {
  for (const dvec3& at : {dvec3(0), dvec3(100, -3, 7)}) {
    const CameraPose start{at + dvec3(1, 2, 2), at, {0, 1, 0}};
    CameraPose pose = start;
    for (int i = 0; i < 1000; ++i) pose = dolly(pose, 0.5);
    EXPECT_GT(glm::distance(pose.eye, at), 0);
    // 1e-6 of 100 is held to 1e-14 of them.
    expect_near(view_frame(pose).forward, view_frame(start).forward, 1e-9, "direction");
    for (int i = 0; i < 1000; ++i) pose = dolly(pose, 2);
    EXPECT_LT(glm::distance(pose.eye, at), 1.1e15);
    expect_near(view_frame(pose).forward, view_frame(start).forward, 1e-9, "direction");
  }
  const CameraPose pose{{0, 0, 4}, {0, 0, 0}, {0, 1, 0}};
  for (const double factor : {0.0, -1.0, std::nan(""), -double(INFINITY)})
    EXPECT_EQ(dolly(pose, factor).eye, pose.eye);
  EXPECT_EQ(move(pose, INFINITY, 0, 0).eye, pose.eye);
  EXPECT_EQ(move(pose, std::nan(""), 0, 0).eye, pose.eye);
  EXPECT_EQ(orbit(pose, std::nan(""), 0).eye, pose.eye);
}

/// A scene of nothing but surfaces, seen from +z towards the origin.
struct SceneOf {
  std::vector<Triangle> triangles;
  std::vector<Quadric> quadrics;
  double scale = 1;
  double eye = 10;

  SceneOf& triangle(double z, double half) {
    Triangle t{};
    t.p0 = narrow(scale * dvec3(-half, -half, z));
    t.p1 = narrow(scale * dvec3(3 * half, -half, z));
    t.p2 = narrow(scale * dvec3(-half, 3 * half, z));
    triangles.push_back(t);
    return *this;
  }
  SceneOf& quadric(int kind, const dvec3& center, double radius) {
    Quadric q{};
    q.kind = kind;
    q.center = narrow(scale * center);
    q.normal = make_vec3(0, 0, -1);
    q.radius = float(scale * radius);
    quadrics.push_back(q);
    return *this;
  }
  [[nodiscard]] DeviceScene scene() const {
    DeviceScene s;
    s.header = header_of({0, 0, scale * eye}, {0, 0, 0}, {0, 1, 0}, 0.5, 0.5);
    const auto add = [&](const auto& records, TableSpan& span) {
      span = {int(records.size()), uint(s.words.size())};
      const std::size_t words = records.size() * sizeof(records[0]) / 4;
      s.words.resize(s.words.size() + words);
      if (words > 0) std::memcpy(s.words.data() + span.offset, records.data(), 4 * words);
    };
    add(triangles, s.header.tables.triangles);
    add(quadrics, s.header.tables.quadrics);
    return s;
  }
  [[nodiscard]] double distance() const { return default_distance(scene()) / scale; }
};

TEST(DefaultDistance, TheFirstSurfaceInFrontOfTheEye) {
  for (const double scale : {1e-4, 1.0, 1e5}) {
    const auto with = [&] { return SceneOf{{}, {}, scale}; };
    const double tolerance = 1e-6;  // positions are single-precision numbers
    EXPECT_NEAR(with().triangle(0, 1).distance(), 10, tolerance);
    EXPECT_NEAR(with().triangle(-5, 1).triangle(2, 1).triangle(12, 1).distance(), 8, tolerance);
    EXPECT_NEAR(with().quadric(QUADRIC_SPHERE, {0, 0, 1}, 2).distance(), 7, tolerance);
    EXPECT_NEAR(with().quadric(QUADRIC_SPHERE, {1, 0, 0}, std::sqrt(2)).distance(), 9, tolerance);
    EXPECT_NEAR(with().quadric(QUADRIC_SPHERE, {0, 0, 9}, 4).distance(), 5, tolerance) << "from inside";
    EXPECT_NEAR(with().quadric(QUADRIC_DISK, {1, 0, 3}, 1.5).distance(), 7, tolerance);
    EXPECT_NEAR(with().quadric(QUADRIC_DISK, {1, 0, 3}, 0.5).triangle(-1, 2).distance(), 11, tolerance)
        << "beside";
    EXPECT_NEAR(with().quadric(QUADRIC_SPHERE, {0, 0, 20}, 3).triangle(-1, 2).distance(), 11, tolerance)
        << "behind";
  }
}

TEST(DefaultDistance, TheExtentWhereThereIsNothingToSee) {
  // Beside the view: 3 wide, 4 high, flat.
  SceneOf beside;
  Triangle t{};
  t.p0 = make_vec3(5, 5, 1);
  t.p1 = make_vec3(8, 5, 1);
  t.p2 = make_vec3(5, 9, 1);
  beside.triangles.push_back(t);
  EXPECT_NEAR(scene_extent(beside.scene()), 5, 1e-6);
  EXPECT_NEAR(beside.distance(), 5, 1e-6);
  // Past the edge that is across from the first vertex.
  SceneOf past;
  t.p0 = make_vec3(-1, -1, 0);
  t.p1 = make_vec3(0.5f, -1, 0);
  t.p2 = make_vec3(-1, 0.5f, 0);
  past.triangles.push_back(t);
  EXPECT_NEAR(past.distance(), 1.5 * std::sqrt(2), 1e-6);
  // The view within the triangle's plane.
  SceneOf edge_on;
  t.p0 = make_vec3(0, -1, 0);
  t.p1 = make_vec3(0, 1, 0);
  t.p2 = make_vec3(0, 0, -1);
  edge_on.triangles.push_back(t);
  EXPECT_NEAR(edge_on.distance(), std::sqrt(5), 1e-6);
  EXPECT_EQ(default_distance(SceneOf{}.scene()), 1);
  EXPECT_EQ(scene_extent(SceneOf{}.scene()), 1);
}

TEST(DefaultDistance, NotBeforeTheNearPlaneAndNotNothing) {
  DeviceScene scene = SceneOf{}.triangle(8, 1).triangle(0, 1).scene();
  EXPECT_NEAR(default_distance(scene), 2, 1e-6);
  scene.header.camera.near_clip = 3;
  EXPECT_NEAR(default_distance(scene), 10, 1e-6);
  // A camera that all but touches what it sees turns about something that is not in its own eye.
  SceneOf touching;
  touching.eye = 1e-12;
  EXPECT_NEAR(touching.triangle(0, 1).distance(), 4e-6 * std::sqrt(2), 1e-11);
}

TEST(StepLength, FollowsTheDistanceWithinTheScenesMeasure) {
  for (const double scale : {1e-4, 1.0, 1e5}) {
    const auto step = [&](double distance) {
      return step_length({{0, 0, scale * distance}, {0, 0, 0}, {0, 1, 0}}, 10 * scale) / scale;
    };
    EXPECT_NEAR(step(4), 0.2, 1e-12);
    EXPECT_NEAR(step(1e-6), 1e-3, 1e-12);
    EXPECT_NEAR(step(1e6), 1, 1e-12);
  }
}

}  // namespace
}  // namespace penumbra
