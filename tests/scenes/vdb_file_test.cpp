// OpenVDB files as OpenVDB writes them: what is read, and errors in invalid ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#ifdef PENUMBRA_HAS_NANOVDB
  #include <nanovdb/util/IO.h>
  #include <nanovdb/util/OpenToNanoVDB.h>
#endif

#include <cstring>
#include <limits>
#include <random>
#include <sstream>

// OpenVDB's, of half-precision numbers; another macro has the name.
#undef HALF_EPSILON
#include "scenes/media.h"
#include "scenes/scene_reader.h"
#include "scenes/spectrum.h"
#include "scenes/volume_file.h"
#include "tests/support/temporary_folder.h"

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

TEST(VdbFiles, MayHaveOtherGridsByName) {
  const std::string bytes = vdb_of({density(), density("temperature")});
  const auto hot = read_volume_grid("fire.vdb", bytes, "temperature");
  ASSERT_TRUE(hot) << hot.error().message;
  EXPECT_EQ(hot->grid.nx, 3);
  const auto none = read_volume_grid("fire.vdb", bytes, "flames");
  ASSERT_TRUE(none) << none.error().message;
  EXPECT_TRUE(none->grid.values.empty());
  openvdb::FloatGrid::Ptr empty = openvdb::FloatGrid::create();
  empty->setName("temperature");
  const auto cold = read_volume_grid("fire.vdb", vdb_of({density(), empty}), "temperature");
  ASSERT_TRUE(cold) << cold.error().message;
  EXPECT_TRUE(cold->grid.values.empty());
}

#ifdef PENUMBRA_HAS_NANOVDB
TEST(NanoVdbFiles, AreReadAsThoseOfOpenVdb) {
  using nanovdb::io::Codec;
  const openvdb::GridPtrVec grids = {density(), density("temperature")};
  const auto as_vdb = read_volume_file("smoke.vdb", vdb_of(grids));
  ASSERT_TRUE(as_vdb);
  for (const Codec codec : {Codec::NONE, Codec::ZIP, Codec::BLOSC}) {
    std::vector<nanovdb::GridHandle<>> handles;
    for (const auto& grid : grids)
      handles.push_back(nanovdb::openToNanoVDB(*openvdb::gridPtrCast<openvdb::FloatGrid>(grid)));
    // To a file: writing goes beyond the end, which streams of strings refuse.
    const TemporaryFolder folder;
    const std::string path = (folder / "smoke.nvdb").string();
    nanovdb::io::writeGrids<nanovdb::HostBuffer, std::vector>(path, handles, codec);
    const std::string bytes = file_contents(path);
    const auto read = read_volume_file("smoke.nvdb", bytes);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->grid.values, as_vdb->grid.values);
    EXPECT_EQ(read->low, as_vdb->low);
    EXPECT_EQ(read->high, as_vdb->high);
    const auto hot = read_volume_grid("smoke.nvdb", bytes, "temperature");
    ASSERT_TRUE(hot) << hot.error().message;
    EXPECT_EQ(hot->grid.values, as_vdb->grid.values);
    for (std::size_t length = 8; length < bytes.size(); length += bytes.size() / 5) {
      const auto cut = read_volume_file("smoke.nvdb", bytes.substr(0, length));
      ASSERT_FALSE(cut) << length;
      EXPECT_THAT(cut.error().message, ::testing::StartsWith("smoke.nvdb: "));
    }
  }
}
#endif

/// pbrt's fire: one file for the density and, in its own box, the temperature.
TEST(VdbFiles, AreFireByTheirTemperature) {
  openvdb::FloatGrid::Ptr hot = openvdb::FloatGrid::create();
  hot->setName("temperature");
  hot->denseFill({{-1, -1, 5}, {1, 1, 7}}, 2.0f);
  TemporaryFolder folder;
  write_text(folder / "fire.vdb", vdb_of({density(), hot}));
  write_text(
      folder / "scene.pbrt",
      "Camera \"perspective\"\nWorldBegin\nMakeNamedMedium \"m\" \"string type\" \"nanovdb\" \"string "
      "filename\" \"fire.vdb\" \"float LeScale\" 3 \"float temperaturescale\" 1000 \"rgb sigma_a\" [1 2 "
      "4]\nMaterial \"interface\"\nMediumInterface \"m\" \"\"\nShape \"sphere\"\n");
  const auto scene = read_scene(folder / "scene.pbrt", {});
  ASSERT_TRUE(scene) << scene.error().message;
  const ParticipatingMedium& m = scene->media.at(0);
  ASSERT_TRUE(m.emits() && m.emission_grid && m.emission_by_density);
  const VolumeGrid& grid = *m.emission_grid->grid;
  ASSERT_EQ(grid.nx, 12);
  const glm::vec3 expected = 3.0f * glm::vec3(1, 2, 4) * unit_blackbody_to_rgb(2000);
  const auto at = std::size_t(3 * ((5 * 12 + 5) * 12 + 5));
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(grid.values[at + c], expected[int(c)], 1e-4f * expected[int(c)]);
  EXPECT_EQ(glm::dvec3(m.emission_grid->to_world * glm::dvec4(0, 0, 0, 1)), glm::dvec3(-1.5, -1.5, 4.5));
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

TEST(VdbFiles, OfOtherCompressionsAndSharedTreesAreRead) {
  const openvdb::FloatGrid::Ptr grid = density();
  const auto shared = openvdb::gridPtrCast<openvdb::FloatGrid>(grid->copyGrid());
  shared->setName("other");
  const auto expected = read_volume_file("a.vdb", vdb_of({grid}));
  ASSERT_TRUE(expected);
  const TemporaryFolder folder;
  for (const std::uint32_t compression :
       {std::uint32_t(openvdb::io::COMPRESS_NONE), std::uint32_t(openvdb::io::COMPRESS_ZIP),
        std::uint32_t(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK)}) {
    openvdb::io::File file((folder / "a.vdb").string());
    file.setCompression(compression);
    file.write(openvdb::GridPtrVec{shared, grid});
    file.close();
    const auto read = read_volume_file("a.vdb", file_contents(folder / "a.vdb"));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->grid.values, expected->grid.values) << compression;
    EXPECT_EQ(read->high, expected->high);
  }
}

/// Some of its lengths, counts and numbers are in every part of the file.
std::string to_be_damaged() {
  openvdb::Vec3SGrid::Ptr other = openvdb::Vec3SGrid::create();
  other->setName("velocity");
  other->tree().setValue({0, 0, 0}, {1, 2, 3});
  const openvdb::FloatGrid::Ptr grid = density();
  grid->insertMeta("author", openvdb::StringMetadata("nobody"));
  return vdb_of({other, grid});
}

void expect_error(const std::string& bytes, const std::string& what) {
  const auto read = read_volume_file("smoke.vdb", bytes);
  ASSERT_FALSE(read) << what;
  EXPECT_THAT(read.error().message, ::testing::StartsWith("smoke.vdb: ")) << what;
}

void expect_errors_of_truncations(std::size_t first, std::size_t step) {
  const std::string whole = to_be_damaged();
  for (std::size_t size = first; size < whole.size(); size += step)
    expect_error(whole.substr(0, size), "cut at " + std::to_string(size));
}

TEST(VdbFiles, ThatAreCutOffAreErrors) {
  const std::size_t size = to_be_damaged().size();
  expect_errors_of_truncations(0, size / 40);
  expect_errors_of_truncations(8, size / 7);
}
TEST(VdbFiles, CutOffAnywhereAreErrors) { expect_errors_of_truncations(0, 17); }

/// Four bytes of a damaged file are often a length that is too large.
void expect_mutations_survived(std::uint32_t seed, int count) {
  const std::string whole = to_be_damaged();
  std::mt19937 random(seed);
  for (int i = 0; i < count; ++i) {
    std::string bytes = whole;
    for (std::uint32_t times = 1 + random() % 3; times > 0; --times) {
      // Half of them in what precedes the trees, where most lengths are.
      const std::size_t range = random() % 2 == 0 ? 600 : bytes.size() - 4;
      const std::size_t at = random() % range;
      static constexpr std::uint32_t kNumbers[] = {0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 1'000'000};
      const std::uint32_t number =
          random() % 2 == 0 ? kNumbers[random() % std::size(kNumbers)] : std::uint32_t(random());
      std::memcpy(bytes.data() + at, &number, 1 + random() % sizeof number);
    }
    const auto read = read_volume_file("smoke.vdb", bytes);
    if (!read) continue;
    const VolumeGrid& grid = read->grid;
    EXPECT_EQ(grid.values.size(), std::size_t(grid.nx) * std::size_t(grid.ny) * std::size_t(grid.nz) *
                                      std::size_t(grid.channels));
  }
}

TEST(VdbFiles, DamagedOnesAreReadOrErrors) { expect_mutations_survived(1, 100); }
TEST(VdbFiles, ManyDamagedOnesAreReadOrErrors) { expect_mutations_survived(2, 2000); }

}  // namespace
}  // namespace penumbra
