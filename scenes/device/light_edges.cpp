#include "scenes/device/light_edges.h"

#include <algorithm>
#include <array>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "kernels/host/view.h"
#define FEATURES FEATURE_ALL
#include "kernels/camera/camera.h"
#include "kernels/intersect/bvh.h"
#include "kernels/intersect/surface.h"
#include "scenes/device/film_outline.h"
#include "scenes/device/filter_mass.h"
#include "scenes/device/records_view.h"

namespace penumbra {
namespace {

// Beyond these the edges are so many, or take so long to find, that they are left as they are.
constexpr std::size_t kMostBorrowed = 1'000'000;  // triangles of a scene without the portable hierarchy
constexpr std::size_t kMostTriangles = 1 << 18;   // that emit
constexpr std::size_t kMostPixels = 1 << 20;
// By how many filter radii rays pass an edge on either side.
constexpr double kBeside = 1e-3;

using Radiance = std::array<float, 3>;

/// Finds what is seen beside edges.
class EdgeRays {
 public:
  explicit EdgeRays(const Scene& scene) : scene_(scene) {}

  /// The radiance that a triangle adds to the camera's rays by itself: of those with edges, which face the
  /// camera.
  [[nodiscard]] std::optional<Radiance> radiance_of(int triangle) const {
    const Triangle& t = scene_.triangles[triangle];
    if (t.light < 0) return {};
    const Light& light = scene_.lights[t.light];
    const bool passes =
        scene_.materials[t.front].passes != PASSES_NONE || scene_.materials[t.back].passes != PASSES_NONE;
    if (light.texture >= 0 || passes || !(faces(t) || light.two_sided != 0)) return {};
    return Radiance{light.radiance.x, light.radiance.y, light.radiance.z};
  }

  /// Whether the camera sees its vertices counter-clockwise.
  [[nodiscard]] bool faces(const Triangle& t) const {
    return dot3(cross3(sub(t.p1, t.p0), sub(t.p2, t.p0)), sub(scene_.header.camera.origin, t.p0)) > 0.0f;
  }

  /// By how much lights of this radiance are brighter than what emits beside them, over the pixel's edges
  /// that are seen; 0 for the others.
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
      if (emission(pixel, middle + aside, true) != radiance) continue;
      const std::optional<Radiance> other = emission(pixel, middle - aside, false);
      for (int c = 0; c < 3 && other; ++c)
        sum[c] += float(size) * (radiance[std::size_t(c)] - (*other)[std::size_t(c)]);
    }
    return length > 0 ? sum / float(length) : sum;
  }

 private:
  /// What is emitted towards the camera where a ray ends; nothing if that is not the same everywhere.
  /// `of_edges`: only of what has edges.
  [[nodiscard]] std::optional<Radiance> emission(const OutlinePixel& pixel, glm::dvec2 p,
                                                 bool of_edges) const {
    const SceneHeader& h = scene_.header;
    const Ray ray = camera_ray(h.camera, h.film, pixel.x, pixel.y, h.film.filter_radius * float(p.x),
                               h.film.filter_radius * float(p.y));
    const Hit hit =
        intersect_levels(&scene_, ray.origin, ray.direction, ray.tmax, -1, -1, h.tables.instances.count > 0);
    int light = hit.primitive < 0 ? h.environment : -1;
    if (hit.primitive >= h.tables.triangles.count)
      light = scene_.quadrics[hit.primitive - h.tables.triangles.count].light;
    else if (hit.primitive >= 0)
      light = scene_.triangles[hit.primitive].light;
    const bool triangle = hit.primitive >= 0 && hit.primitive < h.tables.triangles.count;
    if (of_edges) return triangle ? radiance_of(hit.primitive) : std::nullopt;
    if (light < 0) return Radiance{};
    const Light& l = scene_.lights[light];
    if (l.kind == LIGHT_ENVMAP || l.texture >= 0) return {};
    if (triangle && !faces(scene_.triangles[hit.primitive]) && l.two_sided == 0) return Radiance{};
    return Radiance{l.radiance.x, l.radiance.y, l.radiance.z};
  }

  const Scene& scene_;
};

/// Edges of lights of equal radiance are those of all of them together.
void find_edges(const SceneHeader& header, SceneRecords& records) {
  const RecordsView view(records, header);
  const EdgeRays rays(view.scene());
  std::map<Radiance, std::vector<std::array<vec3, 3>>> lights;
  std::size_t count = 0;
  for (std::size_t i = 0; i < records.triangles.size(); ++i) {
    const Triangle& t = records.triangles[i];
    const std::optional<Radiance> radiance = rays.radiance_of(int(i));
    if (!radiance) continue;
    if (++count > kMostTriangles) return;
    lights[*radiance].push_back(rays.faces(t) ? std::array{t.p0, t.p1, t.p2} : std::array{t.p0, t.p2, t.p1});
  }
  struct Found {
    OutlinePixel pixel;
    glm::vec3 radiance;
  };
  std::multimap<std::pair<int, int>, Found> found;  // by rows
  for (const auto& [radiance, triangles] : lights)
    for (const OutlinePixel& pixel :
         outline_pixels(outline_on_film(header.camera, header.film, triangles), header.film)) {
      const glm::vec3 contrast = rays.contrast(pixel, radiance);
      if (contrast == glm::vec3(0)) continue;
      if (found.size() == kMostPixels) return;
      found.insert({{pixel.y, pixel.x}, {pixel, contrast}});
    }
  const FilterMass filter(header.film.filter, records.filter_table);
  records.light_edge_rows.assign(std::size_t(header.film.height) + 1, 0);
  for (const auto& [place, each] : found) {
    const auto& [pixel, radiance] = each;
    LightEdgePixel record{};
    record.radiance = make_vec3(radiance.x, radiance.y, radiance.z);
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

}  // namespace

bool may_have_light_edges(const SceneHeader& h) {
  const IntegratorParameters& p = h.integrator;
  const bool sees_lights = p.kind == INTEGRATOR_DIRECT ||
                           ((p.kind == INTEGRATOR_PATH || p.kind == INTEGRATOR_WHITTED) && p.max_depth != 0);
  const bool whole = (h.features & FEATURE_PARTS) == 0u && p.hide_emitters == HIDE_NOTHING;
  return sees_lights && whole && (h.features & (FEATURE_CAMERA | FEATURE_MEDIA)) == 0u;
}

Expected<void> add_light_edges(SceneHeader& header, SceneRecords& records, BorrowedHierarchy& hierarchy) {
  const bool emits = std::ranges::any_of(records.triangles, [](const Triangle& t) { return t.light >= 0; });
  if (!emits || !may_have_light_edges(header)) return {};
  if (records.nodes.empty() && records.triangles.size() > kMostBorrowed) return {};
  if (Expected<void> done = hierarchy.need(); !done) return done;
  find_edges(header, records);
  if (records.light_edge_pixels.empty()) {
    records.light_edge_rows.clear();
    return {};
  }
  header.features |= FEATURE_LIGHT_EDGES;
  header.edges_camera = camera_key(header.camera);
  header.sees_edges = 1;
  return {};
}

}  // namespace penumbra
