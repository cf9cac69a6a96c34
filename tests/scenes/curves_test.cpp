// Curves: their files, and their triangles against the formula of the surface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtx/norm.hpp>
#include <numbers>

#include "scenes/curve_mesh.h"
#include "scenes/curve_reader.h"
#include "tests/scenes/mitsuba_text.h"

namespace penumbra {
namespace {

class CurveFiles : public SceneText {
 protected:
  static std::string shape(std::string_view type, std::string_view more = "") {
    return in("shape", type, "<string name='filename' value='c.txt'/>" + std::string(more));
  }
  Mesh mesh(std::string_view type, std::string_view text, std::string_view more = "") {
    write("c.txt", text);
    const SceneDescription s = good(shape(type, more));
    if (s.shapes.size() != 1) return {};
    const auto made = curve_mesh(std::get<Curves>(s.shapes[0].geometry));
    EXPECT_TRUE(made);
    return made->mesh;
  }
  std::string wrong(std::string_view type, std::string_view text) {
    write("c.txt", text);
    return error(scene(shape(type)));
  }
};

/// Each triangle's corners lie counterclockwise about their mean normal.
void expect_wound_outwards(const Mesh& mesh) {
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
    const glm::dvec3 normal(mesh.normals[t.x] + mesh.normals[t.y] + mesh.normals[t.z]);
    EXPECT_GT(glm::dot(glm::cross(b - a, c - a), normal), 0);
  }
}

/// Area and enclosed volume (of an open tube, that of the cone from the origin over it).
std::pair<double, double> area_and_volume(const Mesh& mesh) {
  double area = 0, volume = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
    area += glm::length(glm::cross(b - a, c - a)) / 2;
    volume += glm::dot(a, glm::cross(b, c)) / 6;
  }
  return {area, volume};
}

constexpr std::string_view kStraight = "-1 0 0 0.25\n0 0 0 0.25\n1 0 0 0.25\n2 0 0 0.25\n3 0 0 0.25\n";

TEST_F(CurveFiles, AStraightSplineIsATube) {
  // From the second point to the last but one.
  const Mesh m = mesh("bsplinecurve", kStraight);
  expect_wound_outwards(m);
  double low = 1e9, high = -1e9;
  for (std::size_t i = 0; i < m.positions.size(); ++i) {
    const glm::dvec3 p = m.positions[i];
    low = std::min(low, p.x), high = std::max(high, p.x);
    const double out = std::hypot(p.y, p.z);
    EXPECT_NEAR(out, 0.25, 0.00161 * 0.25 + 1e-6);
    EXPECT_NEAR(m.normals[i].x, 0, 1e-6);
    EXPECT_NEAR(m.normals[i].y, p.y / out, 1e-6);
    // u from +y on, towards +z; v along the curve.
    const double u = std::fmod(std::atan2(p.z, p.y) / (2 * std::numbers::pi) + 1, 1.0);
    EXPECT_NEAR(std::remainder(double(m.texcoords[i].x) - u, 1.0), 0, 1e-6);
    EXPECT_NEAR(m.texcoords[i].y, p.x / 2, 1e-6);
  }
  EXPECT_NEAR(low, 0, 1e-9);
  EXPECT_NEAR(high, 2, 1e-9);
  // As wide as the circle on average, so of its area.
  EXPECT_NEAR(area_and_volume(m).first, 2 * 2 * std::numbers::pi * 0.25, 1e-6);
}

TEST_F(CurveFiles, ThicknessIsNotScaled) {
  const Mesh m =
      mesh("bsplinecurve", kStraight, to_world("<scale x='3' y='5' z='7'/><rotate z='1' angle='90'/>"));
  double high = 0, out = 0;
  for (const glm::dvec3& p : m.positions)
    high = std::max(high, p.y), out = std::max(out, std::hypot(p.x, p.z));
  EXPECT_NEAR(high, 6, 1e-9);
  EXPECT_NEAR(out, 0.25, 0.0005);
}

/// Of a spline by its four points: position and derivatives, from the definition by differences.
struct Frenet {
  glm::dvec3 at, first;
  double radius;
};
Frenet spline(const Curve& p, double t) {
  const auto basis = [](double x) {  // the cubic B-spline of knots -2 .. 2
    x = std::abs(x);
    return x < 1 ? (4 - 6 * x * x + 3 * x * x * x) / 6 : x < 2 ? std::pow(2 - x, 3) / 6 : 0.0;
  };
  Frenet result{glm::dvec3(0), glm::dvec3(0), 0};
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double x = 1 + t - double(i), h = 1e-5;
    result.at += basis(x) * p[i].position;
    result.radius += basis(x) * p[i].radius;
    result.first += (basis(x + h) - basis(x - h)) / (2 * h) * p[i].position;
  }
  return result;
}

TEST_F(CurveFiles, ABentSplineIsWhereItsFormulaSays) {
  const Curve curve = {
      {{0, 0, 0}, 0.1}, {{1, 0, 0}, 0.2}, {{1, 1, 0.5}, 0.15}, {{0, 1, 1.5}, 0.1}, {{0, 0, 3}, 0.05}};
  const auto made = bspline_curve_mesh(std::vector<Curve>{curve});
  ASSERT_TRUE(made);
  EXPECT_EQ(made->sides, 32);
  const Mesh& m = made->mesh;
  expect_wound_outwards(m);
  // All points of triangles, not the corners alone, are at the radius from the nearest point of the curve,
  // within the bound.
  double worst = 0;
  for (std::size_t i = 0; i < m.triangles.size(); i += 7) {
    const glm::uvec3 t = m.triangles[i];
    const glm::dvec3 p = (m.positions[t.x] + m.positions[t.y] + m.positions[t.z]) / 3.0;
    const double v = double(m.texcoords[t.x].y + m.texcoords[t.y].y + m.texcoords[t.z].y) / 3 * 2;
    double best = 1e9, radius = 0;
    // The circle that holds it is across the tangent.
    for (double s = std::max(0.0, v - 0.3); s <= std::min(2.0, v + 0.3); s += 1e-3) {
      const Frenet f = spline(curve, s);
      const double off = std::abs(glm::dot(p - f.at, glm::normalize(f.first)));
      if (off < best) best = off, radius = glm::length(p - f.at) / f.radius;
    }
    worst = std::max(worst, std::abs(radius - 1));
  }
  EXPECT_LT(worst, made->error);
  EXPECT_GT(worst, 0.0005);  // it is made of triangles
  // Normals are those of the surface: across it in both directions, by differences of neighbours.
  for (std::size_t ring = 1; ring + 1 < m.positions.size() / 33; ++ring)
    for (std::size_t k = 0; k < 32; k += 5) {
      const std::size_t i = ring * 33 + k;
      const glm::dvec3 n(m.normals[i]);
      const glm::dvec3 around = glm::normalize(m.positions[i + 1] - m.positions[ring * 33 + (k + 31) % 32]);
      EXPECT_NEAR(glm::dot(n, around), 0, 0.02);
      const glm::dvec3 along = glm::normalize(m.positions[i + 33] - m.positions[i - 33]);
      EXPECT_NEAR(glm::dot(n, along), 0, 0.12);
    }
}

TEST_F(CurveFiles, ALinearOneIsOfConesAndSpheres) {
  // A capsule of radius 1 and length 3 with two balls as ends.
  const Mesh m = mesh("linearcurve", "0 0 0 1\n0 0 3 1\n");
  expect_wound_outwards(m);
  for (const glm::dvec3& p : m.positions) {
    const double z = std::clamp(p.z, 0.0, 3.0);
    EXPECT_LT(glm::length(p - glm::dvec3(0, 0, z)), 1.00161 + 1e-9);
  }
  // Both balls whole, and the cylinder.
  const double pi = std::numbers::pi;
  EXPECT_NEAR(area_and_volume(m).first, 2 * 4 * pi + 3 * 2 * pi, 0.01 * 14 * pi);

  // A cone touches its balls: the distance to the nearest of the balls between, by the radius there.
  const Curve cone = {{{0, 0, 0}, 1}, {{4, 0, 0}, 0.25}};
  const auto made = linear_curve_mesh(std::vector<Curve>{cone});
  ASSERT_TRUE(made);
  for (const glm::dvec3& p : made->mesh.positions) {
    double least = 1e9;
    for (int i = 0; i <= 1000; ++i) {
      const double s = i / 1000.0;
      least = std::min(least, glm::length(p - glm::dvec3(4 * s, 0, 0)) - (1 - 0.75 * s));
    }
    EXPECT_LT(least, 0.0017);
  }
}

TEST_F(CurveFiles, TheBallOfABendTurnsAsTheSegmentBeforeIt) {
  // As in Mitsuba 3, where a segment and the ball at its end are one.
  const auto made = linear_curve_mesh(std::vector<Curve>{{{{0, 0, 0}, 1}, {{4, 0, 0}, 1}, {{4, 4, 0}, 1}}});
  ASSERT_TRUE(made);
  int outside = 0;
  for (std::size_t i = 0; i < made->mesh.positions.size(); ++i) {
    const glm::dvec3 p = made->mesh.positions[i];
    if (p.x < 4.1 || p.y > -0.1) continue;
    ++outside;
    const double u = std::atan2(p.z, p.y) / (2 * std::numbers::pi);
    EXPECT_NEAR(std::remainder(double(made->mesh.texcoords[i].x) - u, 1.0), 0, 1e-6);
    EXPECT_EQ(made->mesh.texcoords[i].y, 0.5f);
  }
  EXPECT_GT(outside, 50);
}

TEST_F(CurveFiles, SeveralShareTheCoordinateAlong) {
  const auto made = bspline_curve_mesh(
      std::vector<Curve>{{{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{2, 0, 0}, 1}, {{3, 0, 0}, 1}, {{4, 0, 0}, 1}},
                         {{{0, 9, 0}, 1}, {{1, 9, 0}, 1}, {{2, 9, 0}, 1}, {{3, 9, 0}, 1}}});
  ASSERT_TRUE(made);
  for (std::size_t i = 0; i < made->mesh.positions.size(); ++i) {
    const glm::dvec3 p = made->mesh.positions[i];
    EXPECT_NEAR(made->mesh.texcoords[i].y, (p.x - 1 + (p.y > 5 ? 2 : 0)) / 3, 1e-6);
  }
}

TEST_F(CurveFiles, TangentsThroughTheZenithTwistNothing) {
  // An arch over z: where the tangent passes -z and z the direction of u = 0 jumps, and circles are joined
  // all the same.
  Curve arch;
  for (int i = 0; i < 12; ++i) {
    const double angle = i * std::numbers::pi / 4;
    arch.push_back({{2 * std::cos(angle), 0, 2 * std::sin(angle)}, 0.2});
  }
  const auto made = bspline_curve_mesh(std::vector<Curve>{arch});
  ASSERT_TRUE(made);
  expect_wound_outwards(made->mesh);
  for (const glm::uvec3& t : made->mesh.triangles) {
    const glm::dvec3 a = made->mesh.positions[t.x], b = made->mesh.positions[t.y],
                     c = made->mesh.positions[t.z];
    // No side leads across the tube.
    EXPECT_LT(std::max({glm::length(a - b), glm::length(b - c), glm::length(c - a)}), 0.85);
    const double out = std::abs(glm::length((a + b + c) / 3.0));
    EXPECT_GT(out, 1.5);
  }
}

TEST_F(CurveFiles, ThatEmitMoveOrBoundMediaAreTriangles) {
  write("c.txt", kStraight);
  const auto is_mesh = [&](std::string_view more) {
    return std::holds_alternative<Mesh>(good(shape("bsplinecurve", more)).shapes.at(0).geometry);
  };
  EXPECT_FALSE(is_mesh(""));
  EXPECT_FALSE(is_mesh("<bsdf type='hair'/>"));
  EXPECT_TRUE(is_mesh("<emitter type='area'/>"));
  EXPECT_TRUE(is_mesh("<medium name='interior' type='homogeneous'/>"));
}

TEST_F(CurveFiles, ManyHaveFewerSides) {
  std::vector<Curve> hair(130'000,
                          Curve{{{0, 0, 0}, .1}, {{1, 0, 0}, .1}, {{2, 0, 0}, .1}, {{3, 0, 0}, 0.0}});
  const auto made = bspline_curve_mesh(hair);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->sides, 8);
  EXPECT_LT(made->error, 0.26);
  EXPECT_GT(made->error, 0.05);
}

TEST_F(CurveFiles, TheirFilesAreReadAsTheyAreWritten) {
  write("c.txt",
        "0 0.1 0 0.25\n0 0 1.7 0.25\n1 0 0 0\n2 0 0 0.125\n\n"
        "3 0 0 1\n4 0 1e-7 1\n5 0 0 1\n6 0 0 1\n7 1 0 0.3333333333333333\n");
  const auto read = [&](std::string_view type, std::string_view more) {
    return std::get<Curves>(good(shape(type, more)).shapes.at(0).geometry);
  };
  const auto expect_same = [&](const Curves& a, const Curves& b) {
    EXPECT_EQ(a.form, b.form);
    EXPECT_EQ(a.ranges, b.ranges);
    ASSERT_EQ(a.curves.size(), b.curves.size());
    for (std::size_t i = 0; i < a.curves.size(); ++i) {
      ASSERT_EQ(a.curves[i].size(), b.curves[i].size());
      for (std::size_t k = 0; k < a.curves[i].size(); ++k) {
        EXPECT_EQ(a.curves[i][k].position, b.curves[i][k].position);
        EXPECT_EQ(a.curves[i][k].radius, b.curves[i][k].radius);
      }
    }
  };
  for (const char* type : {"bsplinecurve", "linearcurve"}) {
    write("c.txt",
          "0 0.1 0 0.25\n0 0 1.7 0.25\n1 0 0 0\n2 0 0 0.125\n\n"
          "3 0 0 1\n4 0 1e-7 1\n5 0 0 1\n6 0 0 1\n7 1 0 0.3333333333333333\n");
    const Curves first = read(type, "");
    EXPECT_EQ(first.curves.size(), 2u);
    write("c.txt", text_of(first));
    expect_same(read(type, ""), first);
  }
  // Ribbons have parameters of their own, and control points of splines that end in a point.
  write("c.txt", "0 0.5\n0 0 0 2\n0 0 1 1\n0 0 2 0\n0 0 3 -1\n\n\n0.1 1\n0 0 0 1\n1 0 0 1\n2 0 0 1\n3 0 0 1");
  const Curves ribbons = read("bsplinecurve", "<string name='form' value='flat'/>");
  EXPECT_EQ(ribbons.form, CurveForm::kFlat);
  ASSERT_EQ(ribbons.ranges.size(), 2u);
  EXPECT_EQ(ribbons.ranges[1], glm::vec2(0.1f, 1.0f));
  EXPECT_EQ(ribbons.curves[0][3].radius, -1.0);
  write("c.txt", text_of(ribbons));
  expect_same(read("bsplinecurve", "<string name='form' value='flat'/>"), ribbons);
}

TEST_F(CurveFiles, HairTakesItsOffsetFromNormalsOnTubesAndFromVOnRibbons) {
  write("c.txt", kStraight);
  const auto offset = [&](std::string_view form) {
    const SceneDescription s = good(
        shape("bsplinecurve", std::string(form) + in("bsdf", "hair", "<string name='offset' value='v'/>")));
    return std::get<HairBsdf>(s.bsdfs.at(std::size_t(s.shapes.at(0).front_bsdf)).model).offset;
  };
  EXPECT_EQ(offset(""), HairBsdf::kFromNormal);
  EXPECT_EQ(offset("<string name='form' value='flat'/>"), HairBsdf::kFromV);
  EXPECT_EQ(offset("<string name='form' value='cylinder'/>"), HairBsdf::kFromV);
}

TEST_F(CurveFiles, FilesThatAreWrongSaySoWithTheLine) {
  EXPECT_THAT(wrong("bsplinecurve", "1 0.5\n0 0 0 1\n1 0 0 1\n2 0 0 1\n3 0 0 1\n"),
              AllOf(HasSubstr("c.txt:1:"), HasSubstr("must grow from its beginning to its end")));
  EXPECT_THAT(wrong("linearcurve", "0 1\n0 0 0 1\n1 0 0 1\n\n0 0 0 1\n1 0 0 1\n"),
              AllOf(HasSubstr("c.txt:6:"), HasSubstr("a curve without a parameter")));
  EXPECT_THAT(wrong("linearcurve", "0 1\n0 1\n0 0 0 1\n1 0 0 1\n"),
              AllOf(HasSubstr("c.txt:2:"), HasSubstr("four numbers")));
  EXPECT_THAT(wrong("linearcurve", "0 1\n\n0 0 0 1\n1 0 0 1\n"), HasSubstr("at least 2 control points"));
  EXPECT_THAT(wrong("bsplinecurve", "0 0 0 1\n1 0 0 1\n2 0 0 1\n\n"),
              AllOf(HasSubstr("c.txt:3:"), HasSubstr("at least 4 control points; this one ends after 3")));
  EXPECT_THAT(wrong("linearcurve", "0 0 0 1\n"), HasSubstr("at least 2 control points"));
  EXPECT_THAT(wrong("linearcurve", "0 0 0 1\n1 0 0\n"),
              AllOf(HasSubstr("c.txt:2:"), HasSubstr("four numbers")));
  EXPECT_THAT(wrong("linearcurve", "0 0 0 1\n1 0 0 -1\n"),
              AllOf(HasSubstr("c.txt:2:"), HasSubstr("below 0")));
  EXPECT_THAT(wrong("linearcurve", "0 0 0 1\n1 nan 0 1\n"), HasSubstr("c.txt:2:"));
  EXPECT_THAT(wrong("linearcurve", "\n \n"), HasSubstr("no curves"));
  // Carriage returns, commas, spaces at ends, and several empty lines are no matter.
  EXPECT_EQ(mesh("linearcurve", "0, 0, 0, 1\r\n 1 0 0 1 \r\n\r\n\r\n0 5 0 1\r\n1 5 0 1").positions.size(),
            2 * mesh("linearcurve", "0 0 0 1\n1 0 0 1\n").positions.size());
}

}  // namespace
}  // namespace penumbra
