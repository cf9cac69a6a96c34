// Sampling triangles by projected solid angle.
#include <fmt/format.h>

#include <algorithm>

#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/inputs.h"
#include "scheduler/stress/quantity_list.h"
#include "scheduler/stress/truth/polygon.h"

namespace penumbra::stress {
namespace projected_cases {
namespace {

constexpr int kGrid = 64;
constexpr double kVertexRounding = 2 * kUlp;  ///< see solid_angle_cases.cpp
// The documented error of the share of area on either side of a sample's azimuth, times 1 + perimeter / area.
constexpr double kShareError = 1e-5;

/// Vertices in the receiver's frame, counter-clockwise seen from the front; and an axis about
/// which all of the light is less than a right angle away.
struct Light {
  const char *name, *stiff;
  Point a, b, c, w;
};
const Light kLights[] = {
    {"overhead", "nothing: the zenith inside", {-1, -1, 1}, {0, 1.5, 1}, {1, -1, 1}, {0, 0, 1}},
    {"zenith-on-edge", "the zenith on an edge", {-1, 0, 1}, {0, 1, 1}, {1, 0, 1}, {0, 0, 1}},
    {"zenith-on-vertex", "the zenith is a vertex", {0, 0, 1}, {0, 1, 1}, {1, 0, 1}, {0, 0, 1}},
    {"zenith-1e-6-beside",
     "an edge that misses the zenith by 1e-6",
     {-1, 1e-6, 1},
     {0, 1, 1},
     {1, 1e-6, 1},
     {0, 0, 1}},
    {"horizon-crossed", "a light that the horizon cuts", {1, .8, -.5}, {1, -.8, -.5}, {1, .1, .9}, {1, 0, 0}},
    {"horizon-two-below", "one vertex above the horizon", {1, .8, -1}, {1, -.8, -1}, {1, .1, .3}, {1, 0, 0}},
    {"horizon-edge-on-it", "an edge in the horizon", {1, .8, 0}, {1, -.8, 0}, {1, .1, .9}, {1, 0, 0}},
    {"half-sky", "nearly half of the hemisphere", {-1e3, 0, 1e-1}, {0, 1e3, 1e-1}, {1e3, 0, 1e-1}, {0, 1, 0}},
    {"sliver", "a triangle 50 times as long as wide", {.5, -1, 1}, {.5, 1, 1}, {.54, 0, 1}, {.5, 0, 1}},
    {"far-1e5", "at a distance of 1e5", {-1e5, -1e5, 1e5}, {0, 1e5, 1e5}, {1e5, -1e5, 1e5}, {0, 0, 1}},
};

Loop loop(const Quads& in) { return {quad(in, 0), quad(in, 3), quad(in, 6)}; }
Quads area(const Quads& in) { return {abs_q(projected_solid_angle(loop(in), {0, 0, 1}))}; }
/// Mean of w.u over the density n.u / area: an axial moment of order 1 and 1.
Quads mean_height(const Quads& in) {
  const Quad moment = 2 * kQuadPi / 3 * abs_q(lobe({loop(in)}, {}, {0, 0, 1}, quad(in, 9), 1));
  return {moment / area(in)[0]};
}
Quad perimeter(const Quads& in) {
  const Loop above = clip(loop(in), {0, 0, 1});
  Quad sum = 0;
  for (std::size_t i = 0; i < above.size(); ++i)
    sum += angle_between(above[i], above[(i + 1) % above.size()]);
  return sum;
}

/// How far a direction is from being a unit vector of the triangle above the horizon.
double distance_outside(const Numbers& out, const Quads& in) {
  const Quad3 d{out[0], out[1], out[2]};
  Loop t = loop(in);
  if (dot(t[0], cross(t[1], t[2])) < 0) std::swap(t[1], t[2]);
  Quad outside = max_q(abs_q(length(d) - 1), -d.z);
  for (std::size_t i = 0; i < 3; ++i)
    outside = max_q(outside, -dot(normalize(cross(t[i], t[(i + 1) % 3])), d));
  return double(outside);
}

void add(std::vector<Case>& cases, const Light& light) {
  const Point w = rounded(unit(light.w.x, light.w.y, light.w.z));
  const Points points{light.a, light.b, light.c};
  Numbers inputs = floats(points, {.5, .5, w.x, w.y, w.z, kGrid});
  const Numbers vertices = floats(points), with_axis = floats({light.a, light.b, light.c, w});
  const std::string name = fmt::format("projected/{}", light.name);
  cases.push_back({name, light.stiff, "projected solid angle",
                   KernelMeasurement{QUANTITY_PROJECTED_TRIANGLE, inputs, outputs(3, 1)},
                   truth_of(area, vertices, "Lambert's sum in 113 bits"),
                   conditioned(area, vertices, 3, kVertexRounding,
                               {1.5e-7 * double(perimeter(quads(vertices))), 0,
                                "vertices off by 2^-23; documented 1.5e-7 times the perimeter"})});
  const Quads at = quads(vertices);
  const double share = kShareError * double(1 + perimeter(at) / area(at)[0]);
  cases.push_back(
      {name + "-mean", light.stiff, fmt::format("mean of w.u over {0} x {0} samples", kGrid),
       KernelMeasurement{QUANTITY_PROJECTED_TRIANGLE, inputs,
                         [](const Numbers& out) { return Numbers{out[4] + out[5]}; }},
       truth_of(mean_height, with_axis, "Arvo's axial moment in 113 bits"),
       conditioned(mean_height, with_axis, 3, kVertexRounding,
                   absolute(share + 1.0 / (kGrid * kGrid),
                            "shares of area off by 1e-5 (1 + perimeter / area); N^-2 of the grid"))});
  for (const auto& [label, u, v] :
       {std::tuple("u0-v0", 0.0, 0.0), std::tuple("u0-v1", 0.0, kBelow1), std::tuple("u1-v0", kBelow1, 0.0),
        std::tuple("u1-v1", kBelow1, kBelow1), std::tuple("u-2^-24", kUlp, .5)}) {
    cases.push_back(
        {fmt::format("{}-{}", name, label), fmt::format("{}, u = {:.9g}, v = {:.9g}", light.stiff, u, v),
         "distance of the sampled direction from the light",
         KernelMeasurement{QUANTITY_PROJECTED_TRIANGLE, floats(points, {u, v}),
                           [at](const Numbers& out) { return Numbers{distance_outside(out, at)}; }},
         known(0, "the triangle's planes in 113 bits"),
         absolute(64 * kUlp, "some dozen roundings of unit vectors")});
  }
}

}  // namespace

void add(std::vector<Case>& cases) {
  for (const Light& light : kLights) add(cases, light);
  cases.push_back(
      {"projected/too-small", "one vertex 1e-2 above the horizon", "projected solid angle that is sampled",
       KernelMeasurement{QUANTITY_PROJECTED_TRIANGLE,
                         floats({{1, .8, -1}, {1, -.8, -1}, {1, .1, .01}}, {.5, .5}), outputs(3, 1)},
       known(0, "smaller than SMALL_PROJECTED_AREA of the perimeter: left to other samplings"),
       absolute(0, "a decision")});
}

}  // namespace projected_cases

void add_projected_cases(std::vector<Case>& cases) { projected_cases::add(cases); }

}  // namespace penumbra::stress
