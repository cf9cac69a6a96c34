// A scene with a single polygon light, and the kernels' results for it.
#pragma once

#include <cmath>
#include <numbers>
#include <ostream>
#include <span>
#include <vector>

#include "kernels/polygon/polygon_light.h"
#include "tests/kernels/polygon/polygon_oracle.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra {

struct PolygonLight {
  std::vector<std::vector<vec3>> loops;  ///< for one who sees the front: outer counter-clockwise, holes not
  bool two_sided = true;
};

struct ExactReceiver {
  Exact3 x, n, w{};  ///< rounded to double for the kernel; n and w unit
  double exponent = -1;
  // Of a transformed cosine about the mirror direction w, where the inverse widths are above 0.
  double inverse_x = 0, inverse_y = 0, shift = 0;
};

struct PolygonTerms {
  double irradiance = 0, lobe = 0;
};

/// For messages, all digits.
inline std::ostream& operator<<(std::ostream& out, const ExactReceiver& r) {
  const auto digits = out.precision(17);
  for (const Exact3& v : {r.x, r.n, r.w})
    out << "(" << double(v.x) << ", " << double(v.y) << ", " << double(v.z) << ") ";
  out << "e " << r.exponent;
  out.precision(digits);
  return out;
}
inline std::ostream& operator<<(std::ostream& out, const PolygonLight& light) {
  const auto digits = out.precision(9);
  for (const std::vector<vec3>& loop : light.loops) {
    out << "\nloop";
    for (const vec3& p : loop) out << " (" << p.x << ", " << p.y << ", " << p.z << ")";
  }
  out.precision(digits);
  return out << "\n";
}

/// The same receiver as the kernel gets it.
inline QuadReceiver quad_receiver(const ExactReceiver& r) {
  const auto as_double = [](const Exact3& v) { return Quad3{double(v.x), double(v.y), double(v.z)}; };
  return {as_double(r.x), as_double(r.n), as_double(r.w)};
}

/// polygon_terms for each receiver, LANES of them at a time.
inline std::vector<PolygonTerms> polygon_terms_of(const PolygonLight& light,
                                                  std::span<const ExactReceiver> receivers) {
  std::vector<PolygonCorner> corners;
  for (const std::vector<vec3>& loop : light.loops) {
    for (std::size_t i = 0; i <= loop.size(); ++i) corners.push_back({loop[i % loop.size()], i == 0 ? 1 : 0});
  }
  Polygon polygon{};
  polygon.two_sided = light.two_sided ? 1 : 0;
  polygon.corner_count = int(corners.size());
  Scene scene{};
  scene.header.features = FEATURE_ALL;
  scene.header.tables.ltc_cells.count = 1;  // closed forms read none of them
  scene.polygons = &polygon;
  scene.polygon_corners = corners.data();
  std::vector<PolygonTerms> terms(receivers.size());
  for (std::size_t first = 0; first < receivers.size(); first += LANES) {
    Receivers lanes;
    for (std::size_t j = 0; j < LANES; ++j) {
      const ExactReceiver& r = receivers[std::min(first + j, receivers.size() - 1)];
      lanes.px[j] = double(r.x.x), lanes.py[j] = double(r.x.y), lanes.pz[j] = double(r.x.z);
      lanes.nx[j] = double(r.n.x), lanes.ny[j] = double(r.n.y), lanes.nz[j] = double(r.n.z);
      lanes.wx[j] = double(r.w.x), lanes.wy[j] = double(r.w.y), lanes.wz[j] = double(r.w.z);
      lanes.exponent[j] = r.exponent;
      const Exact3 across = r.w - dot(r.w, r.n) * r.n;
      const bool leans = r.inverse_x > 0;
      const Exact3 t = leans ? normalize(across) : Exact3{1, 0, 0};
      lanes.tx[j] = double(t.x), lanes.ty[j] = double(t.y), lanes.tz[j] = double(t.z);
      lanes.inverse_x[j] = r.inverse_x, lanes.inverse_y[j] = r.inverse_y, lanes.shift[j] = r.shift;
    }
    double irradiance[LANES], lobe[LANES];
    polygon_terms(&scene, &lanes, 0, irradiance, lobe);
    for (std::size_t j = 0; j < LANES && first + j < receivers.size(); ++j)
      terms[first + j] = {irradiance[j], lobe[j]};
  }
  return terms;
}

inline PolygonTerms polygon_terms_of(const PolygonLight& light, const ExactReceiver& receiver) {
  return polygon_terms_of(light, std::span(&receiver, 1))[0];
}

/// A plane with axes of length 1.
struct Plane {
  Exact3 origin, u, v;

  vec3 at(long double a, long double b) const { return rounded(origin + a * u + b * v); }
};

inline Plane random_plane(RandomNumbers& random, const Exact3& origin) {
  const Exact3 u = normalize(random.direction());
  return {origin, u, normalize(cross(u, random.direction()))};
}

/// `corners` points on circles about the origin, of radius `outer` and `inner` by turns; counter-clockwise in
/// the plane's axes, or clockwise.
inline std::vector<vec3> ring(const Plane& plane, int corners, double outer, double inner,
                              bool clockwise = false) {
  std::vector<vec3> loop;
  for (int i = 0; i < corners; ++i) {
    const double angle = (clockwise ? -2 : 2) * std::numbers::pi * i / corners;
    const double radius = i % 2 == 0 ? outer : inner;
    loop.push_back(plane.at(radius * std::cos(angle), radius * std::sin(angle)));
  }
  return loop;
}

/// A triangle, a star of ten corners, or a hexagon with a hole.
inline PolygonLight random_light(RandomNumbers& random, const Plane& plane, double size) {
  switch (random.below(3)) {
    case 0: {
      std::vector<vec3> loop;
      for (int i = 0; i < 3; ++i)
        loop.push_back(plane.at(random.between(-size, size), random.between(-size, size)));
      return {{loop}};
    }
    case 1:
      return {{ring(plane, 10, size, .4 * size)}};
    default:
      return {{ring(plane, 6, size, size), ring(plane, 4, .5 * size, .3 * size, true)}};
  }
}

/// Anywhere about a receiver in the origin, from 0.001 to 10 in size at distance 1, a third of them with the
/// receiver close to their plane.
inline PolygonLight random_light(RandomNumbers& random) {
  const double size = std::pow(10.0, random.between(-3, 1));
  Plane plane = random_plane(random, random.direction());
  if (random.below(3) == 0) {
    const Exact3 up = cross(plane.u, plane.v);
    plane.origin = random.between(-1, 1) * size * plane.u + random.between(-1, 1) * size * plane.v +
                   std::pow(10.0, random.between(-6, 0)) * up;
  }
  return random_light(random, plane, size);
}

}  // namespace penumbra
