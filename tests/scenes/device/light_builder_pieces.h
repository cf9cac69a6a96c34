// Emitting meshes for tests of the light builder, and checks that hold for all of its results.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <set>
#include <utility>
#include <vector>

#include "scenes/device/light_builder.h"
#include "scenes/device/to_vec3.h"
#include "tests/kernels/exact_vector.h"

namespace penumbra {

inline SceneRecords records;
inline const EmitterPlace kPlace{[](const glm::dvec3& p) { return to_vec3(p); }, 10, records};

inline constexpr EmitterSampling kSamplings[] = {EmitterSampling::kAuto, EmitterSampling::kArea,
                                                 EmitterSampling::kSolidAngle, EmitterSampling::kProjected};
inline constexpr double kFloat = 1.0 / (1 << 24);  ///< half an ulp, relative

using Triangles = std::vector<LightTriangle>;
using Point = std::array<float, 3>;
inline Point point(const vec3& p) { return {p.x, p.y, p.z}; }
inline std::set<Point> vertices(const Light& light) {
  return {point(light.p0), point(light.p1), point(light.p2)};
}
inline std::set<Point> vertices(const LightTriangle& t) { return {point(t.p0), point(t.p1), point(t.p2)}; }

inline Shape emitter(glm::vec3 radiance = glm::vec3(1), EmitterSampling sampling = EmitterSampling::kAuto,
                     bool two_sided = false) {
  Shape shape;
  shape.name = "emitter";
  shape.radiance = radiance;
  shape.sampling = sampling;
  shape.two_sided_emission = two_sided;
  return shape;
}

inline vec3 flat(float x, float y) { return make_vec3(x, y, 0); }

/// The parallelogram with three corners and p1 + p2 - p0, facing (p1 - p0) x (p2 - p0).
inline Triangles parallelogram(const vec3& p0, const vec3& p1, const vec3& p2) {
  const vec3 p3 = sub(add(p1, p2), p0);
  return {{p0, p1, p3}, {p0, p3, p2}};
}
inline Triangles rectangle(float x = 0, float width = 3, float height = 2) {
  return parallelogram(flat(x, 0), flat(x + width, 0), flat(x, height));
}

/// Cells of a grid of 1 x 1 cells where the mask has an 'x', its first row the uppermost one.
inline Triangles cells(const std::vector<const char*>& mask,
                       const std::function<vec3(float, float)>& place = flat) {
  Triangles out;
  for (std::size_t j = 0; j < mask.size(); ++j)
    for (std::size_t i = 0; mask[j][i] != 0; ++i) {
      if (mask[j][i] != 'x') continue;
      const auto x = float(i), y = float(mask.size() - 1 - j);
      const vec3 a = place(x, y), b = place(x + 1, y), c = place(x + 1, y + 1), d = place(x, y + 1);
      out.insert(out.end(), {{a, b, c}, {a, c, d}});
    }
  return out;
}

inline Triangles turned(Triangles triangles) {
  for (LightTriangle& t : triangles) std::swap(t.p1, t.p2);
  return triangles;
}

inline Triangles together(Triangles a, const Triangles& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Tilted: nothing about it is along an axis, and all of its points are rounded.
inline vec3 tilted(float x, float y) {
  const Exact3 u = normalize(Exact3{2, 1, -1}), v = normalize(cross(Exact3{1, -1, 1}, u));
  return rounded(Exact3{-4, 3, 7} + (long double)x * u + (long double)y * v);
}

inline LightBuilder build(const Triangles& triangles, const Shape& shape, bool polygons,
                          EmitterSampling by_default = EmitterSampling::kAuto) {
  LightBuilder builder(by_default, polygons);
  builder.add_triangles(triangles, shape);
  builder.finish();
  return builder;
}

/// Half the sum of the cross products of consecutive corners: the shoelace formula in space. Its length is
/// the area that the loops enclose, and it points to where the front faces.
inline Exact3 enclosed(const LightBuilder& builder, const Polygon& polygon) {
  Exact3 sum;
  for (int k = 1; k < polygon.corner_count; ++k) {
    const PolygonCorner& to = builder.corners()[std::size_t(polygon.first_corner + k)];
    const PolygonCorner& from = builder.corners()[std::size_t(polygon.first_corner + k - 1)];
    const Exact3 middle = exact(builder.corners()[std::size_t(polygon.first_corner)].p);
    if (to.starts == 0) sum = sum + 0.5L * cross(exact(from.p) - middle, exact(to.p) - middle);
  }
  return sum;
}

inline Exact3 area_of(const Triangles& triangles) {
  Exact3 sum;
  for (const LightTriangle& t : triangles)
    sum = sum + 0.5L * cross(exact(t.p1) - exact(t.p0), exact(t.p2) - exact(t.p0));
  return sum;
}

inline std::vector<std::vector<vec3>> loops_of(const LightBuilder& builder, const Polygon& polygon) {
  std::vector<std::vector<vec3>> loops;
  for (int k = 0; k < polygon.corner_count; ++k) {
    const PolygonCorner& corner = builder.corners()[std::size_t(polygon.first_corner + k)];
    if (corner.starts != 0) loops.emplace_back();
    loops.back().push_back(corner.p);
  }
  return loops;
}

/// What holds for every result.
inline void check(const LightBuilder& builder, const Triangles& triangles, const std::vector<int>& index) {
  ASSERT_THAT(index, ::testing::SizeIs(triangles.size()));
  int next_light = 0, next_corner = 0;
  for (std::size_t k = 0; k < builder.polygons().size(); ++k) {
    const Polygon& polygon = builder.polygons()[k];
    EXPECT_EQ(polygon.first_light, next_light);
    EXPECT_EQ(polygon.first_corner, next_corner);
    ASSERT_GE(polygon.light_count, 1);
    ASSERT_GE(polygon.corner_count, 4);
    next_light += polygon.light_count;
    next_corner += polygon.corner_count;
    double parts = 0;
    for (int i = 0; i < polygon.light_count; ++i) {
      const Light& light = builder.lights().at(std::size_t(polygon.first_light + i));
      EXPECT_EQ(light.polygon, int(k));
      EXPECT_EQ(light.two_sided, polygon.two_sided);
      EXPECT_EQ(point(light.radiance), point(polygon.radiance));
      parts += light.area;
    }
    EXPECT_NEAR(parts, polygon.area, (polygon.light_count + 1) * kFloat * polygon.area);
    float widest = 0;
    ASSERT_EQ(builder.corners().at(std::size_t(polygon.first_corner)).starts, 1);
    for (const std::vector<vec3>& loop : loops_of(builder, polygon)) {
      ASSERT_GE(loop.size(), 4u);
      EXPECT_EQ(point(loop.front()), point(loop.back())) << "a loop ends where it starts";
      for (const vec3& a : loop)
        for (const vec3& b : loop) widest = std::max(widest, length3(sub(a, b)));
    }
    EXPECT_GE(polygon.size, widest);
    EXPECT_LE(polygon.size, 2 * widest);
  }
  if (!builder.polygons().empty()) {
    EXPECT_EQ(next_light, int(builder.lights().size()));
    EXPECT_EQ(next_corner, int(builder.corners().size()));
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    ASSERT_GE(index[t], 0);
    ASSERT_LT(index[t], int(builder.lights().size()));
    const Light& light = builder.lights()[std::size_t(index[t])];
    if (light.kind == LIGHT_TRIANGLE) {
      EXPECT_EQ(vertices(light), vertices(triangles[t]));
    }
  }
}

}  // namespace penumbra
