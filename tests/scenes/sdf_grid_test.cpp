// SDF grids: their files, and their conversion to triangles.
#include "scenes/sdf_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "tests/scenes/mitsuba_text.h"
#include "tests/scenes/sdf_writer.h"

namespace penumbra {
namespace {

class SdfGrids : public SceneText {
 protected:
  std::string wrong(const std::string& file) {
    write("g.vol", file);
    return error(scene(in("shape", "sdfgrid", "<string name='filename' value='g.vol'/>")));
  }
};

TEST_F(SdfGrids, ABallIsClosedAndWhereItIs) {
  write("g.vol", sdf_file(ball_of_distances(24, 0.3)));
  const SceneDescription s =
      good(in("shape", "sdfgrid",
              "<string name='filename' value='g.vol'/>" + to_world("<scale value='2'/><translate x='5'/>")));
  ASSERT_EQ(s.shapes.size(), 1u);
  const Mesh& m = std::get<Mesh>(s.shapes[0].geometry);
  const glm::dvec3 center(6, 1, 1);
  // Between points the distance is linear along each axis, so off by h^2 / 8 of its second derivatives, of
  // which a ball's sum to 2 / r, where r may be a cell's diagonal less; corners are on that surface.
  const double h = 2.0 / 23, bound = h * h / 8 * 2 / (0.6 - std::sqrt(3.0) * h);
  for (std::size_t i = 0; i < m.positions.size(); ++i) {
    EXPECT_NEAR(glm::distance(m.positions[i], center), 0.6, bound);
    EXPECT_GT(glm::dot(glm::dvec3(m.normals[i]), glm::normalize(m.positions[i] - center)), 0.9995);
  }
  double volume = 0;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const glm::uvec3& t : m.triangles) {
    volume += glm::dot(m.positions[t.x] - center,
                       glm::cross(m.positions[t.y] - center, m.positions[t.z] - center)) /
              6;
    for (const auto& [a, b] : {std::pair(t.x, t.y), std::pair(t.y, t.z), std::pair(t.z, t.x)}) {
      ++edges[{a, b}];
      --edges[{b, a}];
    }
  }
  EXPECT_NEAR(volume, 4 * std::numbers::pi / 3 * 0.216, 0.01);
  // Each edge is that of two triangles, once each way.
  for (const auto& [edge, count] : edges) EXPECT_EQ(count, 0);
}

TEST_F(SdfGrids, APlaneIsExact) {
  SdfGrid grid{{3, 2, 2}, {}};
  for (int i = 0; i < 4; ++i)
    for (const float x : {0.0f, 0.5f, 1.0f}) grid.values.push_back(x - 0.3f);
  const Mesh m = sdf_mesh(grid);
  ASSERT_FALSE(m.triangles.empty());
  for (std::size_t i = 0; i < m.positions.size(); ++i) {
    EXPECT_NEAR(m.positions[i].x, 0.3, 1e-7);
    EXPECT_NEAR(m.normals[i].x, 1, 1e-6);
    EXPECT_EQ(m.texcoords.at(i), glm::vec2(0)) << "Mitsuba 3: 'does not emit UV coordinates'; they are 0";
  }
  double area = 0;
  for (const glm::uvec3& t : m.triangles)
    area +=
        glm::length(glm::cross(m.positions[t.y] - m.positions[t.x], m.positions[t.z] - m.positions[t.x])) / 2;
  EXPECT_NEAR(area, 1, 1e-6);
}

TEST_F(SdfGrids, FilesThatAreWrongSaySo) {
  const std::string good = sdf_file(ball_of_distances(4, 0.3));
  EXPECT_THAT(wrong("VOL"), HasSubstr("no volume file"));
  EXPECT_THAT(wrong("VOX" + good.substr(3)), HasSubstr("no volume file"));
  EXPECT_THAT(wrong(good + "x"), HasSubstr("64 numbers take 256 bytes"));
  EXPECT_THAT(wrong(good.substr(0, 100)), HasSubstr("64 numbers take 256 bytes"));
  const auto with = [&](std::size_t at, std::int32_t value) {
    std::string bytes = good;
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return wrong(bytes);
  };
  EXPECT_THAT(with(4, 2), HasSubstr("encoding 2"));
  EXPECT_THAT(with(12, -5), HasSubstr("-5 points"));
  EXPECT_THAT(with(16, 1 << 30), HasSubstr("there are 256"));
  EXPECT_THAT(with(48, 0x7fc00000), HasSubstr("not finite"));
  const auto grid = [](int nx, int channels) {
    return vol_of({nx, 2, 2, channels, std::vector<float>(std::size_t(nx * 4 * channels), -1.0f)});
  };
  EXPECT_THAT(wrong(grid(1, 1)), HasSubstr("1 points along an axis; 2 to 2048 are read"));
  EXPECT_THAT(wrong(grid(2049, 1)), HasSubstr("2049 points"));
  EXPECT_THAT(wrong(grid(2, 3)), HasSubstr("one channel, not 3"));
}

}  // namespace
}  // namespace penumbra
