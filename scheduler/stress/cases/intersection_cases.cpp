// Intersection, positions on surfaces, cameras and sphere lights.
#include <fmt/format.h>

#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/inputs.h"
#include "scheduler/stress/quantity_list.h"

namespace penumbra::stress {
namespace intersection_cases {
namespace {

constexpr double kRays = 100000;

void add_watertight(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    Point center;
    double size;
    Point origin;
  };
  const Entry entries[] = {
      {"centre", "rays through edges and vertices", {}, 1, {}},
      {"off-centre", "rays through edges and vertices", {}, 1, {.31, -.22, .17}},
      {"shift-1e3", "a mesh shifted by 1e3", {1e3, 1e3, -1e3}, 1, {1000.25, 1000.125, -1000.5}},
      {"shift-1e5", "a mesh shifted by 1e5", {1e5, -1e5, 1e5}, 1, {100000.25, -100000.125, 1e5}},
      {"shift-1e7", "a mesh of ten roundings", {1e7, -1e7, 1e7}, 10, {1e7 + 1, -1e7 - 2, 1e7}},
      {"scale-1e-4", "a mesh of 1e-4 units", {}, 1e-4, {3e-5, 2e-5, 1e-5}},
      {"scale-1e5", "a mesh of 1e5 units", {}, 1e5, {3e4, 2e4, 1e4}},
      {"near-face", "an origin 1e-6 from a face", {}, 1, {.333333, .333333, .333333}}};
  for (const Entry& e : entries)
    cases.push_back(
        {fmt::format("watertight/{}", e.name), e.stiff, "rays of 100000 that slip through a closed mesh",
         KernelMeasurement{QUANTITY_WATERTIGHT,
                           floats({e.center}, {e.size, e.origin.x, e.origin.y, e.origin.z, kRays}),
                           {}},
         known(0, "closed"), absolute(0, "watertight")});
}

void add_surfaces(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    Point a, b, c, origin;
  };
  const Entry entries[] = {
      {"plain", "nothing", {-1, -1, 0}, {1, -1, .3}, {0, 1, .5}, {.3, .2, 3}},
      {"scale-1e-4",
       "a triangle of 1e-4 units",
       {-1e-4, -1e-4, 0},
       {1e-4, -1e-4, 3e-5},
       {0, 1e-4, 5e-5},
       {3e-5, 2e-5, 3e-4}},
      {"scale-1e5",
       "a triangle of 1e5 units",
       {-1e5, -1e5, 0},
       {1e5, -1e5, 3e4},
       {0, 1e5, 5e4},
       {3e4, 2e4, 3e5}},
      {"far-1e4", "a ray of 1e4", {-1, -1, 0}, {1, -1, .3}, {0, 1, .5}, {3e3, 2e3, 1e4}},
      {"off-centre-1e3",
       "1e3 from the scene's centre",
       {999, 999, 1000},
       {1001, 999, 1000.25},
       {1000, 1001, 1000.5},
       {1000, 1000, 1004}},
      {"off-centre-1e6",
       "1e6 from the scene's centre",
       {999990, 999990, 1e6},
       {1000010, 999990, 1000002},
       {1e6, 1000010, 1000004},
       {1e6, 1e6, 1000100}},
      {"grazing-1e-3", "rays under sines of 1e-3", {-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {3, 0, 3e-3}},
      {"grazing-1e-6", "rays under sines of 1e-6", {-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {3, .2, 3e-6}},
      {"tilted-grazing",
       "rays under sines of 1e-3 to a tilted plane",
       {-1, -1, -1},
       {1, -1, 1},
       {0, 1, .5},
       {3, .3, 3.01}},
      {"sliver-1e4",
       "a triangle 1e4 times as long as wide",
       {-1, 0, 0},
       {1, 0, .3},
       {0, 1e-4, .2},
       {.3, .2, 3}},
      {"close", "an origin 1e-5 above the triangle", {-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {.1, .1, 1e-5}},
  };
  const std::string quantity = "of 10000 rays, in units of the error that surfaces state: ";
  for (const Entry& e : entries) {
    const Numbers inputs = floats({e.a, e.b, e.c, e.origin}, {10000});
    cases.push_back({fmt::format("surface/{}", e.name), e.stiff,
                     quantity + "largest distance of positions from the plane",
                     KernelMeasurement{QUANTITY_SURFACE, inputs, outputs(0, 1)},
                     known(0, "the plane in double"), absolute(1, "the stated error itself")});
    cases.push_back({fmt::format("surface/{}-leave", e.name),
                     e.stiff,
                     quantity + "least and greatest height of origins that leave",
                     KernelMeasurement{QUANTITY_SURFACE, inputs,
                                       [](const Numbers& out) {
                                         return Numbers{worst({-out[1], 0.0}), worst({out[2] - 2, 0.0})};
                                       }},
                     {[] {
                        return Quads{0, 0};
                      },
                      "above the plane, by at most twice the stated error"},
                     absolute(0, "below it is inside")});
  }
}

/// Exactly, for the floats as they are: the smaller root ahead.
Quads hit_sphere(const Quads& in) {
  const Quad3 o = quad(in, 0) - quad(in, 6), d = quad(in, 3);
  const Quad a = dot(d, d), b = dot(o, d), c = dot(o, o) - in[9] * in[9];
  const Quad root = sqrt_q(max_q(b * b - a * c, 0));
  const Quad near = (-b - root) / a, far = (-b + root) / a;
  return {near > 0 ? near : far};
}

void add_spheres(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    Point o, d, c;
    double radius;
  };
  const Entry entries[] = {
      {"plain", "nothing", {}, {0, 0, 1}, {.2, .1, 5}, 1},
      {"far-1e5", "a unit sphere at a distance of 1e5", {}, {0, 0, 1}, {.3, 0, 1e5}, 1},
      {"small-1e-4", "a sphere of 1e-4 at a distance of 10", {}, {0, 0, 1}, {3e-5, 0, 10}, 1e-4},
      {"planet-1e6", "one unit above a sphere of 1e6", {}, {0, 0, 1}, {0, 0, 1000001}, 1e6},
      {"inside", "from inside", {.5, 0, 0}, {0, 0, 1}, {}, 1},
      {"inside-1e-6", "1e-6 from the surface, inside", {.999999, 0, 0}, unit(-1, .1, 0), {}, 1},
      {"grazing", "a ray that touches to 1e-3", {}, {0, 0, 1}, {.999, 0, 5}, 1}};
  for (const Entry& e : entries) {
    const Numbers inputs = floats({e.o, e.d, e.c}, {e.radius});
    // Differences of positions are rounded, and so are all terms of the size of the sphere.
    std::vector<double> deltas(10, 0.0);
    const double size = double(length(quad(e.c) - quad(e.o)));
    for (const std::size_t i : {3, 4, 5}) deltas[i] = 4 * kUlp;
    for (const std::size_t i : {6, 7, 8}) deltas[i] = 4 * kUlp * size;
    deltas[9] = 4 * kUlp * e.radius;
    Allowed allowed{0, 8 * kUlp, "inputs off by 2^-22 of their sizes", {}};
    allowed.computed = [inputs, deltas] { return sensitivity(hit_sphere, quads(inputs), deltas); };
    cases.push_back({fmt::format("sphere/{}", e.name), e.stiff, "distance of the hit",
                     KernelMeasurement{QUANTITY_SPHERE, inputs, {}},
                     truth_of(hit_sphere, inputs, "the quadratic equation in 113 bits"), allowed});
  }
}

void add_sphere_lights(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    Point center;
    double radius;
  };
  const Entry entries[] = {{"plain", "nothing", {0, 0, 4}, 1},
                           {"close-1e-3", "1e-3 above a unit sphere", {0, 0, 1.001}, 1},
                           {"close-1e-6", "1e-6 above a unit sphere", {0, 0, 1.000001}, 1},
                           {"far-1e4", "at 1e4 radii", {.6e4, 0, .8e4}, 1},
                           {"tiny-1e-6", "a millionth of its distance", {.6, 0, .8}, 1e-6},
                           {"huge-1e5", "a sphere of 1e5 units", {0, 0, 2e5}, 1e5}};
  const QuadFunction density = [](const Quads& in) {
    const Quad sine2 = in[3] * in[3] / dot(quad(in, 0), quad(in, 0));
    const Quad versine = sine2 / (1 + sqrt_q(1 - sine2));
    return Quads{1 / (2 * kQuadPi * versine)};
  };
  for (const Entry& e : entries) {
    for (const auto& [name, u, v] :
         {std::tuple("u0", 0.0, 0.0), std::tuple("u1", kBelow1, kBelow1), std::tuple("middle", .5, .3)}) {
      const Numbers inputs = floats({e.center}, {e.radius, 0, 0, 0, 0, 0, 1, u, v});
      const Numbers order = floats({e.center}, {e.radius});
      std::vector<double> deltas = rounding(quads(order), 1, 2 * kUlp);
      deltas[3] = 2 * kUlp * e.radius;
      Allowed allowed{0, 8 * kUlp, "inputs off by 2^-23 of their sizes", {}};
      allowed.computed = [density, order, deltas] { return sensitivity(density, quads(order), deltas); };
      const std::string full = fmt::format("sphere-light/{}-{}", e.name, name);
      const std::string stiff = fmt::format("{}, u = {:.9g}, v = {:.9g}", e.stiff, u, v);
      cases.push_back({full + "-pdf", stiff, "density, 1/sr",
                       KernelMeasurement{QUANTITY_SPHERE_LIGHT, inputs, outputs(3, 1)},
                       truth_of(density, order, "closed form in 113 bits"), allowed});
      cases.push_back({full + "-found-pdf", stiff,
                       "density of the same direction, found by another strategy, 1/sr",
                       KernelMeasurement{QUANTITY_SPHERE_LIGHT, inputs, outputs(4, 1)},
                       truth_of(density, order, "closed form in 113 bits"), allowed});
      // Versine of the angle to the centre: uniform, up to that of the cone.
      const QuadFunction versine = [u](const Quads& in) {
        const Quad sine2 = in[3] * in[3] / dot(quad(in, 0), quad(in, 0));
        return Quads{u * sine2 / (1 + sqrt_q(1 - sine2))};
      };
      // Directions are unit vectors in float; the shadow ray starts and ends off the surfaces by their
      // errors, a part 2^-20 of coordinates, which turns it by as much of the distance between them.
      const double distance = double(length(quad(e.center))), gap = distance - e.radius;
      const double sine = std::min(1.0, e.radius / distance);
      const double turn = 16 * kUlp * (distance + 2 * e.radius) / gap + 4 * kUlp;
      cases.push_back({full, stiff, "1 - cos of the angle to the sphere's centre",
                       KernelMeasurement{QUANTITY_SPHERE_LIGHT, inputs,
                                         [e](const Numbers& out) {
                                           const Quad3 d = normalize({out[0], out[1], out[2]});
                                           const Quad3 apart = d - normalize(quad(rounded(e.center)));
                                           return Numbers{double(dot(apart, apart) / 2)};
                                         }},
                       truth_of(versine, order, "closed form in 113 bits"),
                       absolute(std::min(turn * (sine + turn), 1.0) + 4 * kUlp * sine * sine,
                                "the ray's ends are moved off surfaces by 2^-20 of their coordinates")});
    }
  }
}

/// Up to next to where a distortion folds the film: r of d = r (1 + k1 r^2 + k2 r^4) on the part that grows.
void add_distortions(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    double k1, k2, share;  ///< ... of the largest d
  };
  const Entry entries[] = {
      {"folding-barrel", "a barrel distortion, next to where it folds the film", -.3, 0, .9999},
      {"folding-barrel-half", "a barrel distortion that folds farther out", -.3, 0, .5},
      {"folding-moustache", "a pincushion that turns, next to its fold", .5, -.4, .9999},
      {"pincushion-1e3", "a distortion of 1e3 r^3", 1e3, 1e3, 1}};
  for (const Entry& e : entries) {
    const Quad k1 = rounded(e.k1), k2 = rounded(e.k2);
    const auto distorted = [k1, k2](Quad r) { return r * (1 + r * r * (k1 + k2 * r * r)); };
    // The least root of 1 + 3 k1 s + 5 k2 s^2, s = r^2.
    const Quad root = sqrt_q(9 * k1 * k1 - 20 * k2 < 0 ? Quad(0) : 9 * k1 * k1 - 20 * k2);
    const bool folds = e.k1 < 0 || e.k2 < 0;
    const Quad fold = folds ? sqrt_q(2 / (-3 * k1 + root)) : Quad(2);
    const Numbers inputs = floats({}, {e.k1, e.k2, double(fold), e.share * double(distorted(fold))});
    const QuadFunction undistorted = [fold](const Quads& in) {
      Quad low = 0, high = fold;
      for (int k = 0; k < 120; ++k) {
        const Quad r = (low + high) / 2;
        (r * (1 + r * r * (in[0] + in[1] * r * r)) < in[3] ? low : high) = r;
      }
      return Quads{low};
    };
    Allowed allowed{0, 8 * kUlp, "rounding of the distorted distance, a few times", {}};
    allowed.computed = [undistorted, inputs] {
      return sensitivity(undistorted, quads(inputs), {0, 0, 0, 8 * kUlp * inputs[3]});
    };
    cases.push_back({fmt::format("camera/{}", e.name), e.stiff, "distance from the axis without distortion",
                     KernelMeasurement{QUANTITY_UNDISTORT, inputs, outputs(0, 1)},
                     truth_of(undistorted, inputs, "bisection in 113 bits"), allowed});
  }
}

void add_cameras(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    double width, height, tan_x, tan_y, x, y, dx, dy;
  };
  const Entry entries[] = {
      {"32k-left", "the first pixel of 32768", 32768, 1, .5, .5 / 32768, 0, 0, -.5, 0},
      {"32k-middle", "1e-3 pixels off the middle of 32768", 32768, 1, .5, .5 / 32768, 16384, 0, -.499, 0},
      {"32k-right", "the last pixel of 32768", 32768, 1, .5, .5 / 32768, 32767, 0, .499, 0},
      {"1x1", "an image of one pixel", 1, 1, 1, 1, 0, 0, .25, -.25},
      {"fov-1e-6", "a field of view of 1e-6 degrees", 64, 64, 8.726646e-9, 8.726646e-9, 63, 0, .49, -.49},
      {"fov-179.99", "a field of view of 179.99 degrees", 64, 64, 11459.16, 11459.16, 63, 0, .49, -.49}};
  for (const Entry& e : entries) {
    const Numbers inputs = floats({}, {e.width, e.height, e.tan_x, e.tan_y, e.x, e.y, e.dx, e.dy});
    cases.push_back(
        {fmt::format("camera/{}", e.name),
         e.stiff,
         "offset of the direction, x / z and y / z in units of a pixel",
         KernelMeasurement{
             QUANTITY_CAMERA, inputs,
             [inputs](const Numbers& out) {
               const Quad per_x = inputs[0] / (2 * Quad(inputs[2])),
                          per_y = inputs[1] / (2 * Quad(inputs[3]));
               return Numbers{double(out[0] / Quad(out[2]) * per_x), double(out[1] / Quad(out[2]) * per_y)};
             }},
         {[inputs] {
            return Quads{(Quad(inputs[0]) - 1) / 2 - inputs[4] - inputs[6],
                         (Quad(inputs[1]) - 1) / 2 - inputs[5] - inputs[7]};
          },
          "closed form"},
         relative(8 * kUlp, "rounding of unit vectors: half a pixel's position of 32768 keeps 2^-9 of it")});
  }
}

}  // namespace

void add(std::vector<Case>& cases) {
  add_watertight(cases);
  add_surfaces(cases);
  add_spheres(cases);
  add_sphere_lights(cases);
  add_cameras(cases);
  add_distortions(cases);
}

}  // namespace intersection_cases

void add_intersection_cases(std::vector<Case>& cases) { intersection_cases::add(cases); }

}  // namespace penumbra::stress
