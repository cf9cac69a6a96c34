#include "tests/acceptance/embree_differences.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "kernels/host/device_scene.h"
#include "kernels/host/native_kernels.h"
#include "kernels/intersect/quadric.h"
#include "kernels/intersect/triangle.h"
#include "scheduler/stress/truth/quad.h"
#include "tests/support/native_blocks.h"
#include "worker/embree_tracer.h"

namespace penumbra {
namespace {

using stress::abs_q;
using stress::Quad;
using stress::Quad3;

// Edge functions in single precision, for the edge from a to b relative to the ray's origin. Ours is the
// difference of two products of sheared vertices: six roundings of 2^-24 on terms of the size |a| |b|, twice.
// Embree's is the cross product of (b - a) and (a + b), as long, which is larger where one of them is close
// to the origin. 32 is more than twice these, for directions that are not along an axis.
constexpr double kRounding = 32.0 / (1 << 24);

Quad3 quad(const vec3& v) { return {v.x, v.y, v.z}; }

/// Where a ray meets a primitive, and how sure that is.
struct Meeting {
  Quad t = 0;           ///< distance, exact
  Quad t_error = 0;     ///< what single precision may err by
  bool inside = false;  ///< of the triangle, exactly
  bool edge = false;    ///< within rounding of one of its edges
};

struct Ray3 {
  vec3 origin, direction;
  float tmax;
  int skip;
};

class PortableIntersector {
 public:
  explicit PortableIntersector(const DeviceScene& scene)
      : triangles_(table<Triangle>(scene, scene.header.tables.triangles)),
        quadrics_(table<Quadric>(scene, scene.header.tables.quadrics)) {}

  [[nodiscard]] int primitives() const { return int(triangles_.size() + quadrics_.size()); }

  /// The nearest primitive, the first of equally near ones, or -1: what intersect_brute_force and the
  /// hierarchy find.
  [[nodiscard]] int nearest(const Ray3& ray) const {
    const Shear shear = make_shear(ray.direction);
    float tmax = ray.tmax;
    int hit = -1;
    for (int k = 0; k < primitives(); ++k) {
      const float t = distance(ray, shear, k);
      if (t > 0.0f && t < tmax && (k != ray.skip || is_quadric(k))) {
        tmax = t;
        hit = k;
      }
    }
    return hit;
  }

  /// What single precision says; negative for a miss.
  [[nodiscard]] float distance(const Ray3& ray, const Shear& shear, int k) const {
    if (is_quadric(k))
      return intersect_quadric(quadrics_[std::size_t(k) - triangles_.size()], ray.origin, ray.direction);
    const Triangle& t = triangles_[std::size_t(k)];
    const TriangleHit h = intersect_sheared(shear_point(shear, sub(t.p0, ray.origin)),
                                            shear_point(shear, sub(t.p1, ray.origin)),
                                            shear_point(shear, sub(t.p2, ray.origin)));
    return h.inside ? h.t : -1.0f;
  }

  [[nodiscard]] Meeting meet(const Ray3& ray, int primitive) const {
    return is_quadric(primitive) ? meet_quadric(ray, primitive) : meet_triangle(ray, primitive);
  }

  [[nodiscard]] bool is_quadric(int k) const { return k >= int(triangles_.size()); }

 private:
  [[nodiscard]] Meeting meet_triangle(const Ray3& ray, int primitive) const {
    const Triangle& t = triangles_[std::size_t(primitive)];
    const Quad3 d = quad(ray.direction), o = quad(ray.origin);
    const Quad3 p[3] = {quad(t.p0) - o, quad(t.p1) - o, quad(t.p2) - o};
    const Quad3 n = cross(p[1] - p[0], p[2] - p[0]);
    Meeting m;
    m.t = dot(n, p[0]) / dot(n, d);
    // t is the mean of the vertices' distances along the ray, weighed by the edge functions, so an error of
    // these counts by how far the vertices' distances are from t. In front of that the triangle's plane has
    // the error of its vertices.
    const Quad longest = std::max({length(p[0]), length(p[1]), length(p[2])});
    m.t_error = Quad(kRounding) * longest * length(n) / abs_q(dot(n, d));
    Quad edge[3];
    for (int i = 0; i < 3; ++i) {
      const Quad3 &a = p[i], &b = p[(i + 1) % 3], &opposite = p[(i + 2) % 3];
      edge[i] = dot(d, cross(a, b));
      const Quad error = Quad(kRounding) * std::max(length(a) * length(b), length(b - a) * length(a + b));
      m.edge = m.edge || abs_q(edge[i]) <= error;
      m.t_error = m.t_error + error * abs_q(along(opposite, d) - m.t) / abs_q(dot(n, d));
    }
    m.inside =
        (edge[0] >= 0 && edge[1] >= 0 && edge[2] >= 0) || (edge[0] <= 0 && edge[1] <= 0 && edge[2] <= 0);
    return m;
  }

  /// The distance at which the ray has the point's coordinate along its largest one.
  static Quad along(const Quad3& point, const Quad3& d) {
    const Quad x = abs_q(d.x), y = abs_q(d.y), z = abs_q(d.z);
    return x > y && x > z ? point.x / d.x : y > z ? point.y / d.y : point.z / d.z;
  }

  /// Both intersectors call the same function here.
  [[nodiscard]] Meeting meet_quadric(const Ray3& ray, int primitive) const {
    const Quadric& q = quadrics_[std::size_t(primitive) - triangles_.size()];
    Meeting m;
    m.t = intersect_quadric(q, ray.origin, ray.direction);
    m.t_error = Quad(kRounding) * abs_q(m.t);
    m.inside = m.t > 0;
    return m;
  }

  std::span<const Triangle> triangles_;
  std::span<const Quadric> quadrics_;
};

bool near(Quad a, Quad b, Quad error) { return abs_q(a - b) <= error; }

/// Embree's tracer with the portable one beside it.
class Comparison {
 public:
  Comparison(const DeviceScene& scene, const Tracer& embree, EmbreeDifferences& out)
      : portable_(scene), embree_(embree), out_(out) {}

  [[nodiscard]] Tracer tracer() const { return {this, &Comparison::intersect, &Comparison::occlude}; }

  NativeBlock block;  ///< under way
  int width = 1;      ///< of the film

 private:
  static void intersect(const void* self_, const PathState* paths, int count) {
    const auto& self = *static_cast<const Comparison*>(self_);
    self.embree_.intersect(self.embree_.context, paths, count);
    self.compare(paths, count, false);
  }
  static void occlude(const void* self_, const PathState* paths, int count) {
    const auto& self = *static_cast<const Comparison*>(self_);
    self.embree_.occlude(self.embree_.context, paths, count);
    self.compare(paths, count, true);
  }

  /// With `any` of the shadow rays, of which it is known only whether they are blocked.
  void compare(const PathState* paths, int count, bool any) const {
    for (int i = 0; i < count; ++i) {
      const Ray3 ray = any ? Ray3{get_shadow_origin(paths, i), get_shadow_direction(paths, i),
                                  get_shadow_tmax(paths, i), get_shadow_skip(paths, i)}
                           : Ray3{get_ray_origin(paths, i), get_ray_direction(paths, i),
                                  get_ray_tmax(paths, i), get_ray_skip(paths, i)};
      if (!(ray.tmax > 0)) continue;
      ++out_.rays;
      const int blocked = get_shadow_transmittance(paths, i) > 0 ? -1 : 0;
      const int theirs = any ? blocked : get_hit(paths, i), ours = portable_.nearest(ray);
      if (any ? (theirs >= 0) == (ours >= 0) : theirs == ours) continue;
      const DifferenceCause cause = any ? why_blocked(ray) : why(ray, theirs, ours);
      if (out_.by_cause[std::size_t(cause)]++ == 0)
        out_.examples.push_back(example(ray, cause, theirs, ours, any));
      const int pixel = block.first_pixel + get_slot(paths, i) % block.row;
      out_.pixels.emplace(pixel % width, pixel / width);
    }
  }

  [[nodiscard]] DifferenceCause why(const Ray3& ray, int theirs, int ours) const {
    const Meeting e = theirs >= 0 ? portable_.meet(ray, theirs) : Meeting{};
    const Meeting p = ours >= 0 ? portable_.meet(ray, ours) : Meeting{};
    const bool edge = (theirs >= 0 && e.edge) || (ours >= 0 && p.edge);
    if (theirs >= 0 && ours >= 0 && near(e.t, p.t, e.t_error + p.t_error))
      return edge ? DifferenceCause::kSharedEdge : DifferenceCause::kCoincident;
    if (edge) return DifferenceCause::kSilhouette;
    if ((theirs >= 0 && at_an_end(ray, e)) || (ours >= 0 && at_an_end(ray, p)))
      return DifferenceCause::kRayEnd;
    return DifferenceCause::kUnexplained;
  }

  /// A shadow ray that one of them lets through: some primitive must be in doubt. Embree does not say which
  /// one it hit.
  [[nodiscard]] DifferenceCause why_blocked(const Ray3& ray) const {
    bool edge = false, end = false;
    for (int k = 0; k < portable_.primitives(); ++k) {
      const Meeting m = portable_.meet(ray, k);
      const bool on_the_ray = m.t > -m.t_error && m.t < Quad(ray.tmax) + m.t_error;
      if (!on_the_ray || !(m.inside || m.edge)) continue;
      if (k == ray.skip && !portable_.is_quadric(k)) continue;  // neither may hit it
      edge = edge || m.edge;
      end = end || at_an_end(ray, m);
    }
    return edge  ? DifferenceCause::kSilhouette
           : end ? DifferenceCause::kRayEnd
                 : DifferenceCause::kUnexplained;
  }

  static bool at_an_end(const Ray3& ray, const Meeting& m) {
    return near(m.t, ray.tmax, m.t_error) || near(m.t, 0, m.t_error);
  }

  [[nodiscard]] std::string example(const Ray3& ray, DifferenceCause cause, int theirs, int ours,
                                    bool any) const {
    const auto hit = [&](int primitive) {
      if (primitive < 0) return std::string("nothing");
      if (any) return std::string("something");
      const Meeting m = portable_.meet(ray, primitive);
      const float t = portable_.distance(ray, make_shear(ray.direction), primitive);
      return fmt::format("primitive {} at {:.9g} ± {:.1g}{} (in single precision {:.9g})", primitive,
                         double(m.t), double(m.t_error), m.edge ? " on its edge" : "", t);
    };
    return fmt::format(
        "{}: {} from ({:.9g}, {:.9g}, {:.9g}) along ({:.9g}, {:.9g}, {:.9g}) to {:.9g}, leaving primitive "
        "{}: Embree hits {}, we {}",
        cause_name(cause), any ? "shadow ray" : "ray", ray.origin.x, ray.origin.y, ray.origin.z,
        ray.direction.x, ray.direction.y, ray.direction.z, ray.tmax, ray.skip, hit(theirs), hit(ours));
  }

  PortableIntersector portable_;
  Tracer embree_;
  EmbreeDifferences& out_;
};

}  // namespace

std::string_view cause_name(DifferenceCause cause) {
  constexpr std::string_view kNames[kDifferenceCauses] = {"shared edge", "coincident", "silhouette",
                                                          "ray's end", "unexplained"};
  return kNames[std::size_t(cause)];
}

std::uint64_t EmbreeDifferences::total() const {
  std::uint64_t sum = 0;
  for (const std::uint64_t count : by_cause) sum += count;
  return sum;
}

EmbreeDifferences find_embree_differences(const DeviceScene& scene, Isa isa) {
  DeviceOptions options;
  options.isa = isa;
  const auto embree = EmbreeTracer::make(scene, options);
  if (!embree) throw std::runtime_error(embree.error().message);
  const NativeKernel* kernel = find_native_kernel(isa);
  const SceneHeader& h = scene.header;
  EmbreeDifferences differences;
  Comparison comparison(scene, (*embree)->tracer(), differences);
  comparison.width = h.film.width;
  constexpr int kPaths = 4096;
  render_native_blocks(
      *kernel, scene,
      {.width = h.film.width, .height = h.film.height, .first_sample = 0, .sample_count = h.sampler.spp},
      kPaths, comparison.tracer(), [&](const NativeBlock& block) { comparison.block = block; });
  return differences;
}

}  // namespace penumbra
