// Sampling triangles and rectangles by solid angle.
#include <fmt/format.h>

#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/inputs.h"
#include "scheduler/stress/quantity_list.h"
#include "scheduler/stress/truth/polygon.h"
#include "scheduler/stress/truth/spherical.h"

namespace penumbra::stress {
namespace solid_angle_cases {
namespace {

// Vertices are normalised in float: each component of them is off by up to two roundings of its length.
constexpr double kVertexRounding = 2 * kUlp;
// The documented error of a solid angle whose vertices are exact; and of the functions that make a direction
// out of the numbers.
constexpr double kFunctions = 1e-6;

struct Light {
  const char *name, *stiff;
  Point a, b, c;  ///< of a rectangle: corner, next, previous
};

const Light kTriangles[] = {
    {"octant", "nothing: an octant", {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    {"small-3e-2", "a triangle of 4e-4 steradians", {.3, .2, 1}, {.331, .2, 1}, {.3, .231, 1}},
    {"sliver-1e5", "a triangle 1e5 times as long as wide", {-1, 0, 1}, {1, 0, 1}, {0, 2e-5, 1}},
    {"antipodal", "an edge 2e-3 short of opposite directions", {-1, 0, 1e-3}, {1, 0, 1e-3}, {0, 1, 1}},
    {"hemisphere", "1e-3 below the middle of the triangle", {-1, -1, 1e-3}, {1, -1, 1e-3}, {0, 1, 1e-3}},
    {"far-1e5", "at a distance of 1e5", {1e5, 0, 1e5}, {0, 1e5, 1e5}, {-1e5, -1e5, 1e5}},
    {"tiny-1e-4", "of 1e-4 units", {1e-4, 0, 1e-4}, {0, 1e-4, 1e-4}, {-1e-4, -1e-4, 1e-4}},
};

const Light kRectangles[] = {
    {"overhead", "nothing: a square as large as its distance", {-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}},
    {"small-4e-2", "a rectangle of 1.6e-3 steradians", {.3, .2, 1}, {.34, .2, 1}, {.3, .24, 1}},
    {"strip-1e3", "a strip 1e3 times as long as wide", {-1, -1e-3, 1}, {1, -1e-3, 1}, {-1, 1e-3, 1}},
    {"close-1e-4", "1e-4 below the middle of the rectangle", {-1, -1, 1e-4}, {1, -1, 1e-4}, {-1, 1, 1e-4}},
    {"edge-1e-4", "1e-4 below an edge of the rectangle", {0, -1, 1e-4}, {1, -1, 1e-4}, {0, 1, 1e-4}},
    {"corner-1e-4", "1e-4 below a corner of the rectangle", {0, 0, 1e-4}, {1, 0, 1e-4}, {0, 1, 1e-4}},
    {"grazing", "a rectangle almost seen edge-on", {1, -1, 1e-2}, {3, -1, 1e-2}, {1, 1, 1e-2}},
    {"huge-1e4", "all of the sky but 1e-4 of it", {-1e4, -1e4, 1}, {1e4, -1e4, 1}, {-1e4, 1e4, 1}},
    {"tiny-1e-4", "of 1e-4 units", {-1e-4, -1e-4, 1e-4}, {1e-4, -1e-4, 1e-4}, {-1e-4, 1e-4, 1e-4}},
};

constexpr struct {
  const char* name;
  double u, v;
} kNumbers[] = {{"u0-v0", 0, 0},    {"u0-v1", 0, kBelow1}, {"u1-v0", kBelow1, 0}, {"u1-v1", kBelow1, kBelow1},
                {"middle", .5, .5}, {"u-2^-24", kUlp, .3}, {"v-2^-24", .3, kUlp}, {"v-1e-3", .3, 1e-3}};

struct Kind {
  const char* group;
  int quantity;
  QuadFunction solid_angle, sample;
};

const std::string kWhy = "vertices off by 2^-23; 1e-6 for the functions";

/// u and v are kept to their own rounding, but that a rectangle adds u times its solid angle to an angle of
/// up to pi (see SMALL_RECTANGLE_SOLID_ANGLE).
std::vector<double> sample_rounding(const Quads& in, bool rectangle) {
  std::vector<double> deltas = rounding(in, 3, kVertexRounding);
  const Quad angle = rectangle_solid_angle(quad(in, 0), quad(in, 3), quad(in, 6));
  deltas[9] = 2 * kUlp * double(rectangle ? kQuadPi / angle : in[9]);
  deltas[10] = 2 * kUlp * double(in[10]);
  return deltas;
}

void add(std::vector<Case>& cases, const Kind& kind, const Light& light) {
  const Points points{light.a, light.b, light.c};
  const Numbers vertices = floats(points);
  Numbers inputs = vertices;
  inputs.insert(inputs.end(), {.5, .5});
  cases.push_back({fmt::format("{}/{}", kind.group, light.name), light.stiff, "solid angle, sr",
                   KernelMeasurement{kind.quantity, inputs, outputs(3, 1)},
                   truth_of(kind.solid_angle, vertices, "Van Oosterom and Strackee in 113 bits"),
                   conditioned(kind.solid_angle, vertices, 3, kVertexRounding, relative(kFunctions, kWhy))});
  for (const auto& number : kNumbers) {
    const Numbers with = floats(points, {number.u, number.v});
    const bool is_rectangle = kind.quantity == QUANTITY_SPHERICAL_RECTANGLE;
    Allowed allowed = absolute(kFunctions, is_rectangle ? kWhy + "; u by 2^-23 pi / solid angle" : kWhy);
    allowed.computed = [f = kind.sample, at = quads(with), is_rectangle] {
      return sensitivity(f, at, sample_rounding(at, is_rectangle));
    };
    cases.push_back({fmt::format("{}/{}-{}", kind.group, light.name, number.name),
                     fmt::format("{}, u = {:.9g}, v = {:.9g}", light.stiff, number.u, number.v),
                     "sampled direction", KernelMeasurement{kind.quantity, with, outputs(0, 3)},
                     truth_of(kind.sample, with, "bisection of the solid angle in 113 bits"), allowed});
  }
}

}  // namespace

void add(std::vector<Case>& cases) {
  const Kind triangle{
      "triangle", QUANTITY_SPHERICAL_TRIANGLE,
      [](const Quads& in) { return Quads{solid_angle(quad(in, 0), quad(in, 3), quad(in, 6))}; },
      [](const Quads& in) {
        return quads(sample_triangle(quad(in, 0), quad(in, 3), quad(in, 6), in[9], in[10]));
      }};
  for (const Light& light : kTriangles) add(cases, triangle, light);
  const Kind rectangle{
      "rectangle", QUANTITY_SPHERICAL_RECTANGLE,
      [](const Quads& in) { return Quads{rectangle_solid_angle(quad(in, 0), quad(in, 3), quad(in, 6))}; },
      [](const Quads& in) {
        return quads(sample_rectangle(quad(in, 0), quad(in, 3), quad(in, 6), in[9], in[10]));
      }};
  for (const Light& light : kRectangles) add(cases, rectangle, light);
}

}  // namespace solid_angle_cases

void add_solid_angle_cases(std::vector<Case>& cases) { solid_angle_cases::add(cases); }

}  // namespace penumbra::stress
