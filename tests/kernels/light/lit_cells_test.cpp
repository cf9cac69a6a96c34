// Cells from which lights are seen whole: points of them, against straight lines to points of the lights.
#include "scenes/device/lit_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "scenes/device/to_vec3.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra::lit_cells_test {
namespace {

using glm::dvec3;

/// A floor under a light, seen from the side by a pinhole, in direct light.
class Place {
 public:
  Place() {
    tables.materials.resize(1);
    tables.materials.front().family = FAMILY_DIFFUSE;
    SceneHeader& h = tables.header;
    h.integrator.kind = INTEGRATOR_DIRECT;
    h.integrator.emitter_samples = 1;
    h.integrator.trace_shadows = 1;
    h.environment = -1;
    h.film = {.width = 240, .height = 180, .filter = FILTER_BOX, .filter_radius = 0.5f, .sky_coverage = 0};
    look({6, -5, 4}, {0, 0, 0});
    add(kFloor, {-4, -4, 0}, {8, 0, 0}, {0, 8, 0});
  }

  void look(const dvec3& from, const dvec3& at) {
    const dvec3 z = glm::normalize(at - from), x = glm::normalize(glm::cross(dvec3(0, 0, 1), z));
    Camera& camera = tables.header.camera;
    camera.origin = to_vec3(from);
    camera.x = to_vec3(0.6 * x);
    camera.y = to_vec3(0.45 * glm::cross(z, x));
    camera.z = to_vec3(z);
  }

  enum Kind { kFloor, kThing, kSmooth };
  void add(Kind kind, const dvec3& corner, const dvec3& u, const dvec3& v) {
    add_triangle(kind, corner, corner + u, corner + u + v);
    add_triangle(kind, corner, corner + u + v, corner + v);
  }
  void add_triangle(Kind kind, const dvec3& a, const dvec3& b, const dvec3& c) {
    tables.add_triangle(to_vec3(a), to_vec3(b), to_vec3(c));
    if (kind == kSmooth) tables.triangles.back().normals = 0;
  }

  /// A convex light that shines to where its corners run counter-clockwise.
  void add_area_light(const std::vector<dvec3>& corners, bool two_sided = false) {
    Polygon polygon{};
    polygon.two_sided = two_sided ? 1 : 0;
    polygon.first_corner = int(tables.polygon_corners.size());
    polygon.corner_count = int(corners.size()) + 1;
    polygon.first_light = int(tables.lights.size());
    polygon.light_count = int(corners.size()) - 2;
    for (std::size_t k = 0; k <= corners.size(); ++k)
      tables.polygon_corners.push_back({to_vec3(corners[k % corners.size()]), k == 0 ? 1 : 0});
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
      add_triangle(kThing, corners[0], corners[k], corners[k + 1]);
      tables.triangles.back().light = int(tables.lights.size());
      Light light{};
      light.polygon = int(tables.polygons.size());
      tables.lights.push_back(light);
    }
    tables.polygons.push_back(polygon);
    area_lights.push_back(corners);
    sided.push_back(two_sided);
  }

  /// Whether the segment meets a triangle, or a sphere, but of its ends' own.
  [[nodiscard]] bool blocked(const dvec3& p, const dvec3& q, int skip, int area_light) const {
    const dvec3 d = q - p;
    for (std::size_t k = 0; k < tables.triangles.size(); ++k) {
      const Triangle& t = tables.triangles[k];
      if (int(k) == skip || (t.light >= 0 && tables.lights[std::size_t(t.light)].polygon == area_light))
        continue;
      const dvec3 a = to_dvec3(t.p0) - p, b = to_dvec3(t.p1) - p, c = to_dvec3(t.p2) - p;
      const double u = glm::dot(glm::cross(b, a), d), v = glm::dot(glm::cross(c, b), d),
                   w = glm::dot(glm::cross(a, c), d);
      if (!((u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0))) continue;
      const dvec3 n = glm::cross(b - a, c - a);
      const double at = glm::dot(n, a) / glm::dot(n, d);
      if (at > 1e-5 && at < 1 - 1e-5) return true;
    }
    for (const Quadric& q2 : tables.quadrics) {
      const dvec3 to_center = to_dvec3(q2.center) - p;
      const double along = std::clamp(glm::dot(to_center, d) / glm::dot(d, d), 0.0, 1.0);
      if (glm::length(to_center - along * d) < q2.radius) return true;
    }
    return false;
  }

  SceneTables tables;
  std::vector<std::vector<dvec3>> area_lights;
  std::vector<bool> sided;
};

struct Seen {
  int points = 0, lit = 0, open = 0;  ///< of them in cells, or in fact seeing all
};

/// Points of what the camera sees of the triangles. Of cells no point may be in any shadow.
Seen look_around(Place& place, int points, bool beneath_counts = true) {
  place.tables.header.features = FEATURE_DIRECT;
  add_lit_cells(place.tables.header, place.tables);
  const Scene scene = place.tables.scene();
  RandomNumbers random(11);
  Seen seen;
  const auto within = [&](const dvec3& a, const dvec3& b, const dvec3& c) {
    const double r = std::sqrt(random.uniform()), s = random.uniform();
    return a + r * (1 - s) * (b - a) + r * s * (c - a);
  };
  for (int k = 0; k < points; ++k) {
    const int index = int(random.below(place.tables.triangles.size()));
    const Triangle& t = place.tables.triangles[std::size_t(index)];
    if (t.light >= 0) continue;
    const dvec3 p = within(to_dvec3(t.p0), to_dvec3(t.p1), to_dvec3(t.p2));
    dvec3 n = glm::normalize(glm::cross(to_dvec3(t.p1) - to_dvec3(t.p0), to_dvec3(t.p2) - to_dvec3(t.p0)));
    const bool front = glm::dot(n, to_dvec3(place.tables.header.camera.origin) - p) > 0;
    if (!front) n = -n;
    Surface s{};
    s.primitive = index;
    s.front = front;
    s.p = to_vec3(p);
    const bool lit = sees_lights_whole(&scene, s);
    s.front = !front;
    EXPECT_FALSE(sees_lights_whole(&scene, s)) << "from behind";
    ++seen.points;
    seen.lit += lit ? 1 : 0;
    bool open = true;
    for (std::size_t area_light = 0; area_light < place.area_lights.size(); ++area_light) {
      const std::vector<dvec3>& corners = place.area_lights[area_light];
      const dvec3 facing = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
      for (int w = 0; w < 24; ++w) {
        const std::size_t part = 1 + random.below(corners.size() - 2);
        const dvec3 q = within(corners[0], corners[part], corners[part + 1]);
        const bool faces = place.sided[area_light] || glm::dot(facing, p - q) > 0;
        const bool above = glm::dot(n, q - p) > 0;
        if (!above && !beneath_counts && faces) open = false;
        open = open && !(faces && above && place.blocked(p, q, index, int(area_light)));
      }
    }
    seen.open += open ? 1 : 0;
    EXPECT_TRUE(open || !lit) << "at " << p.x << ", " << p.y << ", " << p.z << " of " << index;
  }
  return seen;
}

const std::vector<dvec3> kAreaLight{
    {-0.5, -0.4, 3}, {-0.6, 0.3, 3}, {0, 0.6, 3}, {0.6, 0.3, 3}, {0.5, -0.4, 3}};

TEST(LitCells, OfABareFloorAreAllOfIt) {
  Place place;
  place.add_area_light(kAreaLight);
  const Seen seen = look_around(place, 4000);
  EXPECT_EQ(seen.lit, seen.points);
  EXPECT_NE(place.tables.header.features & FEATURE_LIT_CELLS, 0u);
}

TEST(LitCells, HaveNoShadows) {
  Place place;
  place.add_area_light(kAreaLight);
  place.add(Place::kThing, {-1, -1, 0.8}, {1.2, 0.1, 0.2}, {-0.1, 0.9, 0.1});
  place.add(Place::kThing, {1.5, 1, 0}, {0, 0, 1.2}, {0.3, 0.9, 0});  // stands on the floor
  const Seen seen = look_around(place, 40000);
  EXPECT_GT(seen.lit, 0.85 * seen.open);
  EXPECT_LT(seen.open, 0.98 * seen.points);
}

TEST(LitCells, HaveNoShadowsOfSpheres) {
  Place place;
  place.add_area_light(kAreaLight);
  place.tables.add_sphere(make_vec3(0.5f, 0.3f, 1.0f), 0.4f);
  const Seen seen = look_around(place, 20000);
  EXPECT_GT(seen.lit, 0.75 * seen.open);  // of the boxes about them
  EXPECT_LT(seen.open, 0.97 * seen.points);
}

TEST(LitCells, AreOfAllAreaLights) {
  Place place;
  place.add_area_light(kAreaLight);
  place.add_area_light({{-3, -3, 2}, {-3, -2, 2.2}, {-2, -2, 2.1}});
  place.add_area_light({{4, 2, 0.5}, {4, 3, 0.5}, {4, 3, 1.5}, {4, 2, 1.5}}, true);
  place.add(Place::kThing, {-1, -1, 0.8}, {1.2, 0.1, 0.2}, {-0.1, 0.9, 0.1});
  const Seen seen = look_around(place, 40000);
  EXPECT_GT(seen.lit, 0.6 * seen.open);
  EXPECT_LT(seen.open, 0.95 * seen.points);
}

TEST(LitCells, OfAnAreaLightThatStandsOnTheFloorAreBeforeAndBehindIt) {
  for (const bool two_sided : {false, true}) {
    Place place;
    place.add_area_light({{-1, 0, -0.5}, {1, 0.2, -0.5}, {1, 0.2, 1}, {-1, 0, 1}}, two_sided);
    const Seen seen = look_around(place, 20000);
    EXPECT_EQ(seen.open, seen.points);
    // But for cells that both sides shine on.
    EXPECT_GT(seen.lit, (two_sided ? 0.9 : 0.999) * seen.points);
  }
}

TEST(LitCells, OfSmoothSurfacesSeeAreaLightsAboveThem) {
  Place place;
  place.add_area_light(kAreaLight);
  // Walls: the light is above the plane of one in part, beneath that of another, above that of the third.
  place.add(Place::kSmooth, {-3, 0.1, 0}, {0.5, 0, 0}, {0, 0, 1});
  place.add(Place::kSmooth, {-2, -3, 0}, {0, -0.5, 0}, {0.1, 0, 1});
  place.add(Place::kSmooth, {2, 3, 0}, {0.5, 0, 0}, {0, 0.1, 1});
  const Seen seen = look_around(place, 20000, false);
  EXPECT_GT(seen.lit, 0.8 * seen.open);
}

TEST(LitCells, AreNoneWhereOtherThingsCount) {
  const auto has_cells = [](auto change) {
    Place place;
    place.add_area_light(kAreaLight);
    change(place.tables);
    add_lit_cells(place.tables.header, place.tables);
    const bool has = (place.tables.header.features & FEATURE_LIT_CELLS) != 0u;
    EXPECT_EQ(place.tables.lit_faces.empty(), !has);
    return has;
  };
  EXPECT_TRUE(has_cells([](SceneTables&) {}));
  EXPECT_FALSE(has_cells([](SceneTables& t) { t.header.integrator.kind = INTEGRATOR_PATH; }));
  EXPECT_FALSE(has_cells([](SceneTables& t) { t.header.integrator.emitter_samples = 0; }));
  EXPECT_FALSE(has_cells([](SceneTables& t) { t.header.integrator.trace_shadows = 0; }));
  EXPECT_FALSE(has_cells([](SceneTables& t) { t.header.integrator.estimator = ESTIMATOR_ALPHA; }));
  EXPECT_FALSE(has_cells([](SceneTables& t) { t.lights.front().polygon = -1; }));
  EXPECT_FALSE(has_cells([](SceneTables& t) { t.header.features = FEATURE_MEDIA; }));
  EXPECT_FALSE(has_cells([](SceneTables& t) { t.header.features = FEATURE_INSTANCES; }));
  EXPECT_FALSE(has_cells([](SceneTables& t) { t.header.features = FEATURE_BENT; }));
  EXPECT_FALSE(has_cells([](SceneTables& t) { t.materials.front().family = FAMILY_CONDUCTOR; }));
  EXPECT_FALSE(has_cells([](SceneTables& t) { t.materials.front().branches = 1; }));
}

/// Tiles beside the floor, none of which is in another's way, `side` by `side` and each of two triangles:
/// how many of them have cells.
int lit_tiles(int side) {
  Place place;
  place.tables.header.film.width *= 20;
  place.tables.header.film.height *= 20;
  place.add_area_light(kAreaLight);
  const double size = 4.0 / side;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      place.add(Place::kThing, {-8 + x * size, y * size, 0}, {size, 0, 0}, {0, size, 0});
  add_lit_cells(place.tables.header, place.tables);
  return int(std::ranges::count_if(place.tables.lit_faces, [](const LitFace& f) { return f.level >= 0; }));
}

TEST(LitCells, AreFoundWithinBoundsOfTheWork) {
  EXPECT_GT(lit_tiles(10), 2 * 10 * 10 * 3 / 4);
  // Each of 20 000 looks at all others, of which some 2 million are allowed.
  const int lit = lit_tiles(100);
  EXPECT_GT(lit, 0);
  EXPECT_LT(lit, 200);
}

TEST(LitCells, BehindThingsWithoutEndAreRight) {
  // Things without end between the light and the floor: what is found of the floor may be nothing, but is
  // right.
  Place place;
  place.add_area_light(kAreaLight);
  RandomNumbers random(3);
  for (int k = 0; k < 3000; ++k) {
    const dvec3 p(random.between(-3, 3), random.between(-3, 3), random.between(0.2, 2));
    place.add_triangle(Place::kThing, p, p + dvec3(0.02, 0, 0.01), p + dvec3(0, 0.02, 0));
  }
  look_around(place, 300);
}

}  // namespace
}  // namespace penumbra::lit_cells_test
