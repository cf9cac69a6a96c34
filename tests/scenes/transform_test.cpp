#include "scenes/transform.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace penumbra::transform_test {
namespace {

constexpr double kRounding = 1e-14;

void expect_near(glm::dvec3 a, glm::dvec3 b, double tolerance = kRounding) {
  EXPECT_LE(glm::distance(a, b), tolerance)
      << a.x << ' ' << a.y << ' ' << a.z << " against " << b.x << ' ' << b.y << ' ' << b.z;
}

TEST(Transform, TranslatesScalesRotates) {
  expect_near(transform_point(translation({1, 2, 3}), {4, 5, 6}), {5, 7, 9});
  expect_near(transform_vector(translation({1, 2, 3}), {4, 5, 6}), {4, 5, 6});
  expect_near(transform_point(scaling({2, 3, -4}), {1, 1, 1}), {2, 3, -4});
  const double s = std::sqrt(0.5);
  expect_near(transform_point(rotation({0, 0, 5}, 45), {1, 0, 0}), {s, s, 0});
  // A third of a turn about the space diagonal takes x to y, y to z, z to x.
  expect_near(transform_point(rotation({1, 1, 1}, 120), {1, 2, 3}), {3, 1, 2});
}

TEST(Transform, QuarterTurnsAreExact) {
  EXPECT_EQ(transform_point(rotation({1, 0, 0}, -90), {0, 0, 1}), glm::dvec3(0, 1, 0));
  EXPECT_EQ(transform_point(rotation({0, 1, 0}, 450), {0, 0, 1}), glm::dvec3(1, 0, 0));
  EXPECT_EQ(transform_point(rotation({0, 1, 0}, 180), {0, 0, 1}), glm::dvec3(0, 0, -1));
}

TEST(LookAt, IsMitsubasFrame) {
  // Values of Mitsuba 3.9, of the same arguments.
  const glm::dmat4 m = look_at({1, 2, 3}, {0, 0, 1}, glm::dvec3(0, 1, 0)).value();
  expect_near(glm::dvec3(m[0]), {-0.894427, 0, 0.447214}, 2e-6);
  expect_near(glm::dvec3(m[1]), {-0.298142, 0.745356, -0.596285}, 2e-6);
  expect_near(glm::dvec3(m[2]), {-0.333333, -0.666667, -0.666667}, 2e-6);
  EXPECT_EQ(glm::dvec3(m[3]), glm::dvec3(1, 2, 3));
  EXPECT_FALSE(is_mirror(m));
}

TEST(LookAt, NeedsAView) {
  EXPECT_FALSE(look_at({1, 2, 3}, {1, 2, 3}, glm::dvec3(0, 1, 0)));
  EXPECT_FALSE(look_at({0, 0, 0}, {0, 5, 0}, glm::dvec3(0, 1, 0)));
  EXPECT_FALSE(look_at({0, 0, 0}, {0, 5, 0}, glm::dvec3(0, 0, 0)));
  const auto free = look_at({0, 0, 0}, {0, 5, 0}, std::nullopt);
  ASSERT_TRUE(free);
  EXPECT_NEAR(glm::determinant(glm::dmat3(*free)), 1.0, kRounding);
}

TEST(Matrix, IsReadRowByRow) {
  const std::vector<double> rows = {1, 2, 3, 10, 4, 5, 6, 20, 7, 8, 10, 30, 0, 0, 0, 1};
  const glm::dmat4 m = matrix_from_rows(rows).value();
  EXPECT_EQ(transform_point(m, {1, 0, 0}), glm::dvec3(11, 24, 37));
  const std::vector<double> three = {1, 2, 3, 4, 5, 6, 7, 8, 10};
  EXPECT_EQ(transform_point(matrix_from_rows(three).value(), {0, 1, 0}), glm::dvec3(2, 5, 8));
  EXPECT_FALSE(matrix_from_rows(std::vector<double>(12, 1.0)));
  std::vector<double> projective = rows;
  projective[14] = 1;
  EXPECT_FALSE(matrix_from_rows(projective));
}

TEST(Transform, KnowsSingularOnes) {
  EXPECT_TRUE(is_singular(scaling({1, 0, 1})));
  EXPECT_FALSE(is_singular(scaling({1e-30, 1, 1e30})));
  EXPECT_TRUE(is_singular(scaling({1, HUGE_VAL, 1})));
  EXPECT_TRUE(is_singular(scaling({1, NAN, 1})));
  glm::dmat4 parallel(1.0);
  parallel[1] = parallel[0] * 3.0;
  EXPECT_TRUE(is_singular(parallel));
}

TEST(Transform, KnowsMirrorsAndSimilarities) {
  EXPECT_TRUE(is_mirror(scaling({-1, 1, 1})));
  EXPECT_FALSE(is_mirror(scaling({-1, -2, 1})));
  EXPECT_NEAR(uniform_scale(rotation({1, 2, 3}, 77) * scaling(glm::dvec3(-3.0))).value(), 3.0, 1e-12);
  EXPECT_FALSE(uniform_scale(scaling({1, 1, 1.01})));
  EXPECT_EQ(uniform_scale(scaling({2, 2, 9}), 2), 2.0);
  glm::dmat4 shear(1.0);
  shear[1][0] = 0.5;
  EXPECT_FALSE(uniform_scale(shear));
  EXPECT_FALSE(without_scale(shear));
  EXPECT_TRUE(uniform_scale(without_scale(scaling({2, -3, 4})).value()));
  EXPECT_TRUE(is_mirror(without_scale(scaling({2, -3, 4})).value()));
}

TEST(Transform, FramesOfCamerasKeepTheirView) {
  const glm::dmat4 rigid = translation({5, 6, 7}) * rotation({1, 2, 3}, 40);
  for (int axis = 0; axis < 4; ++axis)
    expect_near(glm::dvec3(camera_frame(rigid * scaling({2, 3, 4})).value()[axis]), glm::dvec3(rigid[axis]));
  glm::dmat4 shear = rigid;
  shear[1] += 0.5 * rigid[2] + 0.25 * rigid[0];
  const glm::dmat4 frame = camera_frame(shear).value();
  expect_near(glm::dvec3(frame[2]), glm::dvec3(rigid[2]));
  EXPECT_TRUE(uniform_scale(frame));
  EXPECT_NEAR(glm::dot(glm::dvec3(frame[0]), glm::dvec3(shear[1])), 0.0, 1e-12);
  EXPECT_GT(glm::dot(glm::dvec3(frame[1]), glm::dvec3(shear[1])), 0.0);
  EXPECT_FALSE(camera_frame(scaling({1, 0, 1})));
}

TEST(NormalMatrix, IsTheInverseTranspose) {
  const glm::dmat4 m = translation({5, 6, 7}) * rotation({1, 2, 3}, 40) * scaling({2, -3, 0.5});
  const glm::dvec3 n(0.3, -0.5, 0.8);
  const glm::dvec3 expected = glm::normalize(glm::transpose(glm::inverse(glm::dmat3(m))) * n);
  expect_near(glm::normalize(normal_matrix(m) * n), expected, 1e-13);
  // Where the inverse's entries leave the range of a double.
  expect_near(glm::normalize(normal_matrix(scaling(glm::dvec3(1e-150))) * n), glm::normalize(n));
}

}  // namespace
}  // namespace penumbra::transform_test
