// OpenVDB files as OpenVDB writes them: what is read, and errors in invalid ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <limits>
#include <sstream>

#include "scenes/volume_file.h"

// OpenVDB 10 does not free what it has read of a file that ends too soon.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:openvdb\n"; }

namespace penumbra {
namespace {

using ::testing::HasSubstr;

std::string vdb_of(const openvdb::GridPtrVec& grids) {
  openvdb::initialize();
  std::ostringstream stream(std::ios::binary);
  openvdb::io::Stream(stream).write(grids);
  return stream.str();
}

float density_at(const openvdb::Coord& at) {
  return float(1 + (at.x() + 2) + 10 * (at.y() + 1) + 100 * (at.z() - 5));
}

/// 3 x 2 x 2 voxels from (-2, -1, 5) on, without the one in the middle, whose value is the background.
openvdb::FloatGrid::Ptr density(const std::string& name = "density") {
  openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(0.25f);
  grid->setName(name);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  auto numbers = grid->getAccessor();
  for (int z = 5; z < 7; ++z)
    for (int y = -1; y < 1; ++y)
      for (int x = -2; x < 1; ++x)
        if (openvdb::Coord(x, y, z) != openvdb::Coord(-1, 0, 5))
          numbers.setValue({x, y, z}, density_at({x, y, z}));
  return grid;
}

std::string wrong_vdb(const openvdb::GridPtrVec& grids) {
  const auto read = read_volume_file("smoke.vdb", vdb_of(grids));
  EXPECT_FALSE(read);
  if (read) return "";
  EXPECT_THAT(read.error().message, ::testing::StartsWith("smoke.vdb: "));
  return read.error().message;
}

TEST(VdbFiles, AreTheBoxOfTheirActiveVoxels) {
  const openvdb::FloatGrid::Ptr grid = density();
  openvdb::Mat4d place = openvdb::Mat4d::identity();
  place.preScale(openvdb::Vec3d(0.5, 1, 2));
  place.postTranslate(openvdb::Vec3d(10, 20, 30));
  grid->setTransform(openvdb::math::Transform::createLinearTransform(place));
  openvdb::Vec3SGrid::Ptr other = openvdb::Vec3SGrid::create();
  other->setName("velocity");
  other->tree().setValue({0, 0, 0}, {1, 2, 3});
  const auto read = read_volume_file("smoke.vdb", vdb_of({other, grid}));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->grid.nx, 3);
  EXPECT_EQ(read->grid.ny, 2);
  EXPECT_EQ(read->grid.nz, 2);
  EXPECT_EQ(read->grid.channels, 1);
  std::size_t i = 0;
  for (int z = 5; z < 7; ++z)
    for (int y = -1; y < 1; ++y)
      for (int x = -2; x < 1; ++x, ++i) {
        const bool middle = openvdb::Coord(x, y, z) == openvdb::Coord(-1, 0, 5);
        EXPECT_EQ(read->grid.values[i], middle ? 0.25f : density_at({x, y, z}));
      }
  EXPECT_EQ(read->low, glm::dvec3(10 - 0.5 * 2.5, 20 - 1.5, 30 + 2 * 4.5));
  EXPECT_EQ(read->high, glm::dvec3(10 + 0.5 * 0.5, 20 + 0.5, 30 + 2 * 6.5));
}

TEST(VdbFiles, OfVectorsHaveThreeChannels) {
  openvdb::Vec3SGrid::Ptr colours = openvdb::Vec3SGrid::create();
  colours->setName("Cd");
  colours->tree().setValue({4, 0, 0}, {0.25f, 0.5f, 0.75f});
  colours->tree().setValue({5, 0, 0}, {1, 2, 3});
  const auto read = read_volume_file("colours.vdb", vdb_of({colours}));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->grid.channels, 3);
  EXPECT_THAT(read->grid.values, ::testing::ElementsAre(0.25f, 0.5f, 0.75f, 1, 2, 3));
}

TEST(VdbFiles, SayWhatIsWrongWithThem) {
  EXPECT_THAT(wrong_vdb({density("a"), density("b")}), HasSubstr("it has the grids 'a', 'b', none of which"));
  openvdb::FloatGrid::Ptr surface = density();
  surface->setGridClass(openvdb::GRID_LEVEL_SET);
  EXPECT_THAT(wrong_vdb({surface}), HasSubstr("'density' is a level set"));
  openvdb::Int32Grid::Ptr numbers = openvdb::Int32Grid::create();
  numbers->tree().setValue({0, 0, 0}, 1);
  EXPECT_THAT(wrong_vdb({numbers}), HasSubstr("none of its 1 grids has single-precision numbers"));
  EXPECT_THAT(wrong_vdb({openvdb::FloatGrid::create()}), HasSubstr("has no active voxel"));
  openvdb::FloatGrid::Ptr turned = density();
  openvdb::Mat4d place = openvdb::Mat4d::identity();
  place.preRotate(openvdb::math::Z_AXIS, 0.5);
  turned->setTransform(openvdb::math::Transform::createLinearTransform(place));
  EXPECT_THAT(wrong_vdb({turned}), HasSubstr("placed by more than a scale and a translation"));
  openvdb::FloatGrid::Ptr wide = density();
  wide->tree().setValue({2'000'000, 2'000'000, 2'000'000}, 1);
  EXPECT_THAT(wrong_vdb({wide}), HasSubstr("larger than 2^28 numbers"));
  openvdb::FloatGrid::Ptr odd = density();
  odd->tree().setValue({0, 0, 6}, std::numeric_limits<float>::infinity());
  EXPECT_THAT(wrong_vdb({odd}), HasSubstr("at voxel 0, 0, 6 is inf, not finite"));
}

TEST(VdbFiles, ThatAreCutOffAreErrors) {
  const std::string whole = vdb_of({density()});
  for (const std::size_t size : {std::size_t{8}, std::size_t{20}, whole.size() / 2, whole.size() * 3 / 4}) {
    const auto read = read_volume_file("smoke.vdb", whole.substr(0, size));
    ASSERT_FALSE(read) << size;
    EXPECT_THAT(read.error().message, ::testing::StartsWith("smoke.vdb: "));
  }
}

}  // namespace
}  // namespace penumbra
