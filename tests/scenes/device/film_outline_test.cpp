// Outlines on the film: which edges remain, and fractions of pixels by quadrature of the filters.
#include "scenes/device/film_outline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "scenes/device/filter_table.h"

namespace penumbra::film_outline_test {
namespace {

using glm::dvec2;
using testing::SizeIs;

constexpr int kSide = 16;

/// From -1 to 1 at distance 1, either way, along z; x to the left. Film position p is (1 - p / 8) there.
Camera camera_at_origin() {
  Camera camera{};
  camera.x = make_vec3(1, 0, 0);
  camera.y = make_vec3(0, 1, 0);
  camera.z = make_vec3(0, 0, 1);
  camera.near_clip = 1e-3f;
  camera.far_clip = 1e3f;
  return camera;
}

FilmParameters film_of(int filter, float radius) {
  FilmParameters film{};
  film.width = film.height = kSide;
  film.filter = filter;
  film.filter_radius = radius;
  return film;
}

/// The place at depth z that film position (x, y) shows.
vec3 place(double x, double y, double z) {
  const double half = kSide / 2.0;
  return make_vec3(float(z * (1 - x / half)), float(z * (1 - y / half)), float(z));
}

using Triangles = std::vector<std::array<vec3, 3>>;

/// Of a convex polygon on the film, given against the clock with y down, as the camera sees it.
Triangles fan(const std::vector<dvec2>& polygon, double z = 4) {
  Triangles fan;
  const auto at = [&](std::size_t k) { return place(polygon[k].x, polygon[k].y, z); };
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) fan.push_back({at(0), at(k), at(k + 1)});
  return fan;
}

const std::vector<dvec2> kPentagon{{3.3, 4.1}, {2.7, 9.8}, {8.2, 13.4}, {12.9, 8.6}, {9.1, 2.2}};

double doubled_area(const std::vector<FilmEdge>& edges) {
  double sum = 0;
  for (const FilmEdge& e : edges) sum += e.from.x * e.to.y - e.from.y * e.to.x;
  return sum;
}

TEST(FilmOutline, HasNoInnerEdges) {
  const auto edges = outline_on_film(camera_at_origin(), film_of(FILTER_BOX, 0.5f), fan(kPentagon));
  EXPECT_THAT(edges, SizeIs(5));
  for (const FilmEdge& e : edges)
    EXPECT_TRUE(
        std::ranges::any_of(kPentagon, [&](const dvec2& p) { return glm::distance(p, e.from) < 1e-5; }));
  // The inside is at smaller x of edges that lead down.
  double area = 0;
  for (std::size_t k = 0; k < kPentagon.size(); ++k) {
    const dvec2 a = kPentagon[k], b = kPentagon[(k + 1) % kPentagon.size()];
    area += a.x * b.y - a.y * b.x;
  }
  EXPECT_NEAR(doubled_area(edges), std::abs(area), 1e-4);
}

TEST(FilmOutline, KeepsTheInsideInAMirroredCamera) {
  Camera mirrored = camera_at_origin();
  mirrored.x.x = -1;
  Triangles turned = fan(kPentagon);
  for (auto& t : turned) std::swap(t[1], t[2]);  // of which the camera sees the front
  for (auto& t : turned)
    for (vec3& p : t) p.x = -p.x;
  const auto edges = outline_on_film(mirrored, film_of(FILTER_BOX, 0.5f), turned);
  EXPECT_THAT(edges, SizeIs(5));
  EXPECT_GT(doubled_area(edges), 0);
}

TEST(FilmOutline, EndsAtTheClippingPlanes) {
  // A strip that leads from behind the camera to far away, as high as wide.
  Camera camera = camera_at_origin();
  camera.near_clip = 1;
  camera.far_clip = 10;
  const vec3 a = make_vec3(-0.5f, -1, -5), b = make_vec3(0.5f, -1, -5), c = make_vec3(0.5f, -1, 50),
             d = make_vec3(-0.5f, -1, 50);
  const auto edges = outline_on_film(camera, film_of(FILTER_BOX, 0.5f), Triangles{{a, d, c}, {a, c, b}});
  // At depth 1 it is on the film's lower edge and half as wide, at depth 10 a tenth of both from the middle.
  double low = kSide, high = 0, left = kSide, right = 0;
  for (const FilmEdge& e : edges) {
    low = std::min(low, e.from.y);
    high = std::max(high, e.from.y);
    left = std::min(left, e.from.x);
    right = std::max(right, e.from.x);
  }
  EXPECT_NEAR(high, 16, 1e-9);
  EXPECT_NEAR(low, 8.8, 1e-9);
  EXPECT_NEAR(left, 4, 1e-9);
  EXPECT_NEAR(right, 12, 1e-9);
  EXPECT_NEAR(std::abs(doubled_area(edges)), (8 + 0.8) * 7.2, 1e-9);
}

TEST(FilmOutline, PixelsAreThoseThatEdgesCross) {
  const FilmParameters film = film_of(FILTER_BOX, 0.5f);
  const auto pixels = outline_pixels(outline_on_film(camera_at_origin(), film, fan(kPentagon)), film);
  const FilterMass box(FILTER_BOX, filter_table({}));
  std::map<std::pair<int, int>, double> shares;
  for (const OutlinePixel& p : pixels) {
    EXPECT_FALSE(p.inside.empty());
    EXPECT_TRUE(shares.emplace(std::pair(p.y, p.x), p.share(box)).second);
  }
  EXPECT_TRUE(std::ranges::is_sorted(pixels, {}, [](const OutlinePixel& p) { return std::pair(p.y, p.x); }));
  // Points of all others are on one side.
  const OutlinePixel* any = pixels.data();
  ASSERT_NE(any, nullptr);
  const auto within = [](dvec2 p) {
    for (std::size_t k = 0; k < kPentagon.size(); ++k) {
      const dvec2 a = kPentagon[k], e = kPentagon[(k + 1) % kPentagon.size()] - a;
      if (e.x * (p.y - a.y) - e.y * (p.x - a.x) > 0) return false;
    }
    return true;
  };
  constexpr int kSteps = 50;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      int count = 0;
      for (int i = 0; i < kSteps * kSteps; ++i)
        count += within(dvec2(x, y) + (dvec2(i % kSteps, i / kSteps) + 0.5) / double(kSteps)) ? 1 : 0;
      const auto found = shares.find({y, x});
      const double share = double(count) / (kSteps * kSteps);
      if (found == shares.end())
        EXPECT_TRUE(count == 0 || count == kSteps * kSteps) << x << ", " << y;
      else
        // Of kSteps rows at most two ends of each are off by half a step.
        EXPECT_NEAR(found->second, share, 1.0 / kSteps) << x << ", " << y;
    }
}

struct FilterCase {
  const char* name;
  FilterKind kind;
  int filter;
  float radius;
};

TEST(FilmOutline, SharesAreThoseOfTheFilters) {
  for (const FilterCase& one : {FilterCase{"box", FilterKind::kBox, FILTER_BOX, 0.5f},
                                FilterCase{"tent", FilterKind::kTent, FILTER_TENT, 1},
                                FilterCase{"gaussian", FilterKind::kGaussian, FILTER_TABULATED, 2},
                                FilterCase{"mitchell", FilterKind::kMitchell, FILTER_TABULATED, 2},
                                FilterCase{"lanczos", FilterKind::kLanczos, FILTER_TABULATED, 3}}) {
    Film description;
    description.filter = one.kind;
    description.filter_radius = one.radius;
    const std::vector<float> table = filter_table(description);
    const FilterMass mass(one.filter, table);
    const FilmParameters film = film_of(one.filter, one.radius);
    // Of each pixel by the midpoint rule in both directions.
    constexpr int kSteps = 400;
    std::vector<double> values;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      values.push_back(filter_value(description, (i + 0.5) / kSteps * 2 - 1));
      sum += values.back();
    }
    for (const OutlinePixel& pixel :
         outline_pixels(outline_on_film(camera_at_origin(), film, fan(kPentagon)), film)) {
      double expected = 0;
      for (int i = 0; i < kSteps * kSteps; ++i) {
        const dvec2 p = (dvec2(i % kSteps, i / kSteps) + 0.5) * (2.0 / kSteps) - 1.0;
        if (pixel.winding(p) != 0)
          expected += values[std::size_t(i % kSteps)] * values[std::size_t(i / kSteps)] / (sum * sum);
      }
      // The rule's ends of rows are off by half a step, whose mass is at most 2 / kSteps of that of a row of
      // the tallest filter (3 times its mean); errors of rows cancel but along an axis. Filters as sampled
      // differ from their values by their cells (sampler/filter_test.cpp: 2^-8 of a cell's mass).
      ASSERT_NEAR(pixel.share(mass), expected, 3.0 / kSteps) << one.name << " " << pixel.x << ", " << pixel.y;
    }
  }
}

}  // namespace
}  // namespace penumbra::film_outline_test
