#include "scenes/device/light_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <map>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "kernels/camera/camera.h"
#include "kernels/host/view.h"
#include "kernels/intersect/bvh.h"
#include "kernels/intersect/surface.h"
#include "kernels/math/frame.h"
#include "scenes/device/film_outline.h"
#include "scenes/device/filter_table.h"
#include "scenes/device/records_view.h"
#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

// Beyond these limits there are too many edges, or finding them takes too long, so they are left as they are.
constexpr std::size_t kMostTemporary = 1'000'000;  // triangles of a scene without the portable hierarchy
constexpr std::size_t kMostTriangles = 1 << 18;    // emitting triangles
constexpr std::size_t kMostPixels = 1 << 18;       // pixels with edges
// The distance, in filter radii, at which rays pass an edge on either side.
constexpr double kBeside = 0.01;
// Circles are replaced by polygons whose sides deviate by at most 1/500 of a pixel, which takes pi sqrt(500 r
// / 2) corners for a radius of r pixels. Coverage and inside test use the same polygon, so the mean is right
// whatever the approximation.
constexpr double kCircleCorners = 50;
constexpr int kMostCorners = 4096;

using Radiance = std::array<float, 3>;
using Triangles = std::vector<std::array<vec3, 3>>;

/// The lights of a scene as seen from its camera.
class VisibleLights {
 public:
  explicit VisibleLights(const Scene& scene) : scene_(scene), h_(scene.header) {}

  /// The radiance of a primitive towards the camera, if its edges can be treated.
  [[nodiscard]] std::optional<Radiance> radiance_of(int primitive) const {
    const int index = light_of(primitive);
    if (index < 0) return {};
    const Light& light = scene_.lights[index];
    const SideMaterials sides = side_materials(&scene_, primitive);
    const bool passes = scene_.materials[sides.front].passes != PASSES_NONE ||
                        scene_.materials[sides.back].passes != PASSES_NONE;
    if (light.texture >= 0 || passes || !shines(primitive)) return {};
    return Radiance{light.radiance.x, light.radiance.y, light.radiance.z};
  }

  /// The visible shape of such a primitive, as triangles that the camera sees counter-clockwise.
  [[nodiscard]] Triangles seen_of(int primitive) const {
    if (primitive >= triangle_count()) return seen_of_quadric(quadric(primitive));
    const Triangle& t = scene_.triangles[primitive];
    return {faces(t) ? std::array{t.p0, t.p1, t.p2} : std::array{t.p0, t.p2, t.p1}};
  }

  /// The difference in radiance between the lights and what is beside them, over the pixel's visible edges; 0
  /// for edges that are not visible.
  [[nodiscard]] glm::vec3 contrast(const OutlinePixel& pixel, const Radiance& radiance) const {
    glm::vec3 sum(0);
    double length = 0;
    for (const FilmEdge& e : pixel.inside) {
      const glm::dvec2 way = e.to - e.from, middle = 0.5 * (e.from + e.to);
      const double size = glm::length(way);
      if (!(size > 0)) continue;
      length += size;
      const glm::dvec2 aside = kBeside / size * glm::dvec2(-way.y, way.x);
      if (pixel.winding(middle + aside) != 1 || pixel.winding(middle - aside) != 0) continue;
      const int hit = hit_at(pixel, middle + aside);
      if (hit < 0 || radiance_of(hit) != radiance) continue;
      const std::optional<Radiance> other = beside(hit_at(pixel, middle - aside));
      for (int c = 0; c < 3 && other; ++c)
        sum[c] += float(size) * (radiance[std::size_t(c)] - (*other)[std::size_t(c)]);
    }
    return length > 0 ? sum / float(length) : sum;
  }

 private:
  [[nodiscard]] int triangle_count() const { return h_.tables.triangles.count; }
  [[nodiscard]] const Quadric& quadric(int primitive) const {
    return scene_.quadrics[primitive - triangle_count()];
  }
  [[nodiscard]] int light_of(int primitive) const {
    return primitive < triangle_count() ? scene_.triangles[primitive].light : quadric(primitive).light;
  }

  /// Whether the camera sees its vertices counter-clockwise.
  [[nodiscard]] bool faces(const Triangle& t) const {
    return dot3(cross3(sub(t.p1, t.p0), sub(t.p2, t.p0)), sub(h_.camera.origin, t.p0)) > 0.0f;
  }

  /// Whether the camera sees an emitting side of the primitive, which is a light. For a sphere that is the
  /// outside. Cylinders are not treated here.
  [[nodiscard]] bool shines(int primitive) const {
    const bool two_sided = scene_.lights[light_of(primitive)].two_sided != 0;
    if (primitive < triangle_count()) return two_sided || faces(scene_.triangles[primitive]);
    const Quadric& q = quadric(primitive);
    const vec3 from_center = sub(h_.camera.origin, q.center);
    if (q.kind == QUADRIC_SPHERE) return two_sided || q.orientation > 0.0f;
    return q.kind == QUADRIC_DISK && (two_sided || dot3(q.normal, from_center) > 0.0f);
  }

  /// A disk, or the disk bounded by a sphere's silhouette. Nothing if the camera is inside the sphere, or if
  /// a clipping plane may cut the shape.
  [[nodiscard]] Triangles seen_of_quadric(const Quadric& q) const {
    const glm::dvec3 to_center = to_dvec3(q.center) - to_dvec3(h_.camera.origin);
    glm::dvec3 center = to_dvec3(q.center), toward = to_dvec3(q.normal);
    auto radius = double(q.radius);
    const double distance = glm::length(to_center);
    if (q.kind == QUADRIC_SPHERE) {
      const double depth = glm::dot(to_center, to_dvec3(h_.camera.z)), sine = radius / distance;
      if (!(sine < 1) || depth - radius < double(h_.camera.near_clip) ||
          depth + radius > double(h_.camera.far_clip))
        return {};
      center -= sine * sine * to_center;
      radius *= std::sqrt(1 - sine * sine);
      toward = -to_center;
    } else if (glm::dot(toward, to_center) > 0) {
      toward = -toward;
    }
    const double pixels = radius / distance * h_.film.width / (2 * glm::length(to_dvec3(h_.camera.x)));
    const int corners = int(std::clamp(kCircleCorners * std::sqrt(pixels), 16.0, double(kMostCorners)));
    const vec3 axis = to_vec3(glm::normalize(toward));
    const glm::dvec3 x = to_dvec3(from_frame(axis, 1.0f, 0.0f, 0.0f));
    const glm::dvec3 y = glm::cross(to_dvec3(axis), x);
    const auto corner = [&](int k) {
      const double angle = 2 * std::numbers::pi * k / corners;
      return to_vec3(center + radius * (std::cos(angle) * x + std::sin(angle) * y));
    };
    Triangles fan;
    for (int k = 1; k + 1 < corners; ++k) fan.push_back({corner(0), corner(k), corner(k + 1)});
    return fan;
  }

  /// The primitive hit by a camera ray; negative: none.
  [[nodiscard]] int hit_at(const OutlinePixel& pixel, glm::dvec2 p) const {
    const float radius = h_.film.filter_radius;
    const Ray ray =
        camera_ray(h_.camera, h_.film, pixel.x, pixel.y, radius * float(p.x), radius * float(p.y));
    return intersect_levels(&scene_, ray.origin, ray.direction, ray.tmax, -1, -1,
                            h_.tables.instances.count > 0)
        .primitive;
  }

  /// The radiance emitted towards the camera beside an edge. Nothing if it is not uniform there.
  [[nodiscard]] std::optional<Radiance> beside(int primitive) const {
    const int light = primitive < 0 ? h_.environment : light_of(primitive);
    if (light < 0 || (primitive >= 0 && !shines(primitive))) return Radiance{};
    const Light& l = scene_.lights[light];
    if (l.kind == LIGHT_ENVMAP || l.texture >= 0 || l.spread > 0.0f) return {};
    return Radiance{l.radiance.x, l.radiance.y, l.radiance.z};
  }

  const Scene& scene_;
  const SceneHeader& h_;
};

struct EdgePixel {
  OutlinePixel pixel;
  Radiance radiance;  ///< of the light
};

/// The pixels with edges, ignoring occlusion. Lights of equal radiance are treated together. Empty if there
/// are too many.
std::vector<EdgePixel> find_outlines(const SceneHeader& header, const SceneRecords& records) {
  const RecordsView view(records, header);
  const VisibleLights seen(view.scene());
  std::map<Radiance, Triangles> lights;
  std::size_t count = 0;
  const int primitives = int(records.triangles.size() + records.quadrics.size());
  for (int i = 0; i < primitives; ++i) {
    const std::optional<Radiance> radiance = seen.radiance_of(i);
    if (!radiance) continue;
    const Triangles triangles = seen.seen_of(i);
    if ((count += triangles.size()) > kMostTriangles) return {};
    Triangles& all = lights[*radiance];
    all.insert(all.end(), triangles.begin(), triangles.end());
  }
  std::vector<EdgePixel> pixels;
  for (const auto& [radiance, triangles] : lights)
    for (OutlinePixel& pixel :
         outline_pixels(outline_on_film(header.camera, header.film, triangles), header.film))
      pixels.push_back({std::move(pixel), radiance});
  return pixels;
}

/// The visible outlines, row by row, with their contrast. Empty if there are too many.
using SeenEdges = std::multimap<std::pair<int, int>, std::pair<OutlinePixel, glm::vec3>>;
SeenEdges find_seen(const SceneHeader& header, const SceneRecords& records, std::vector<EdgePixel> outlines) {
  const RecordsView view(records, header);
  const VisibleLights seen(view.scene());
  SeenEdges found;
  for (auto& [pixel, radiance] : outlines) {
    const glm::vec3 contrast = seen.contrast(pixel, radiance);
    if (contrast == glm::vec3(0)) continue;
    if (found.size() == kMostPixels) return {};
    found.insert({{pixel.y, pixel.x}, {std::move(pixel), contrast}});
  }
  return found;
}

void store_edges(const SceneHeader& header, const SeenEdges& edges, SceneRecords& records) {
  const FilterMass filter(header.film.filter, records.filter_table);
  records.light_edge_rows.assign(std::size_t(header.film.height) + 1, 0);
  for (const auto& [place, each] : edges) {
    const auto& [pixel, contrast] = each;
    LightEdgePixel record{};
    record.radiance = make_vec3(contrast.x, contrast.y, contrast.z);
    record.share = float(pixel.share(filter));
    record.x = pixel.x;
    record.first_edge = int(records.light_edges.size());
    record.edge_count = int(pixel.edges.size());
    for (const FilmEdge& e : pixel.edges) {
      const double slope = (e.to.x - e.from.x) / (e.to.y - e.from.y);
      records.light_edges.push_back({float(e.from.x), float(e.from.y), float(e.to.y), float(slope)});
    }
    records.light_edge_pixels.push_back(record);
    ++records.light_edge_rows[std::size_t(pixel.y) + 1];
  }
  for (std::size_t y = 1; y < records.light_edge_rows.size(); ++y)
    records.light_edge_rows[y] += records.light_edge_rows[y - 1];
}

/// Whether edges can be integrated without noise. This requires a pinhole camera that sees lights directly,
/// an integrator that keeps all of their light, no media, no disks of suns, and an image without alpha (alpha
/// is sampled together with the colours).
bool may_have_edges(const SceneHeader& h) {
  const IntegratorParameters& p = h.integrator;
  const bool sees_lights = p.kind == INTEGRATOR_DIRECT ||
                           ((p.kind == INTEGRATOR_PATH || p.kind == INTEGRATOR_WHITTED) && p.max_depth != 0);
  const bool whole =
      (h.features & FEATURE_PARTS) == 0u && p.hide_emitters == HIDE_NOTHING && h.sun_count == 0;
  return sees_lights && whole && (h.features & (FEATURE_CAMERA | FEATURE_MEDIA | FEATURE_COVERAGE)) == 0u;
}

}  // namespace

Expected<void> add_light_edges(SceneHeader& header, SceneRecords& records, TemporaryHierarchy& hierarchy) {
  if (!may_have_edges(header)) return {};
  if (records.nodes.empty() && records.triangles.size() > kMostTemporary) return {};
  std::vector<EdgePixel> outlines = find_outlines(header, records);
  if (outlines.empty()) return {};
  if (Expected<void> done = hierarchy.need(); !done) return done;
  const SeenEdges edges = find_seen(header, records, std::move(outlines));
  if (edges.empty()) return {};
  store_edges(header, edges, records);
  header.features |= FEATURE_LIGHT_EDGES;
  header.own_camera = camera_key(header.camera);
  header.sees_edges = 1;
  return {};
}

}  // namespace penumbra
