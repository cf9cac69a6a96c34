// Conversion of Mitsuba's heterogeneous media and volumes.
#include <cmath>

#include "scenes/transform.h"
#include "scenes/volume_file.h"
#include "tests/scenes/mitsuba_text.h"
#include "tests/support/oracles.h"
#include "tests/support/written_scene.h"

namespace penumbra {
namespace {

std::string true_or_false(const std::string& name, bool value) {
  return "<boolean name='" + name + "' value='" + (value ? "true" : "false") + "'/>";
}
std::string word(const std::string& name, const std::string& value) {
  return "<string name='" + name + "' value='" + value + "'/>";
}
std::string float_of(const std::string& name, const std::string& value) {
  return "<float name='" + name + "' value='" + value + "'/>";
}
std::string grid(const std::string& name, const std::string& file, const std::string& more = "") {
  return "<volume type='gridvolume' name='" + name + "'>" + word("filename", file) + more + "</volume>";
}
std::string heterogeneous(const std::string& content) {
  return "<medium type='heterogeneous' name='interior'>" + content + "</medium>";
}
/// A shape of nothing but its medium.
std::string filled(const std::string& medium) { return in("shape", "cube", in("bsdf", "null") + medium); }

class MitsubaGrids : public MitsubaPlugins {
 protected:
  void SetUp() override {
    write("smoke.vol", vol_of(smoke_, {-1, -2, -3}, {1, 2, 4}));
    write("colours.vol", vol_of(colours_));
  }
  static std::string volpath(const std::string& medium) {
    return "<integrator type='volpath'/>" + filled(medium);
  }
  ParticipatingMedium read_medium(const std::string& content, const std::vector<std::string>& warnings = {}) {
    const SceneDescription s = good(volpath(heterogeneous(content)));
    EXPECT_EQ(s.warnings.size(), warnings.size()) << ::testing::PrintToString(s.warnings);
    for (std::size_t i = 0; i < warnings.size() && i < s.warnings.size(); ++i)
      EXPECT_THAT(s.warnings[i], HasSubstr(warnings[i]));
    EXPECT_THAT(s.media, SizeIs(1));
    return s.media.empty() ? ParticipatingMedium{} : s.media[0];
  }
  std::string wrong(const std::string& content) { return error(scene(volpath(heterogeneous(content)))); }
  std::string wrong_grid(const std::string& more) { return wrong(grid("sigma_t", "smoke.vol", more)); }

  static void expect_same(const std::optional<GridVolume>& a, const std::optional<GridVolume>& b) {
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a) return;
    EXPECT_EQ(a->to_world, b->to_world);
    EXPECT_EQ(a->nearest, b->nearest);
    EXPECT_EQ(a->grid->nx, b->grid->nx);
    EXPECT_EQ(a->grid->ny, b->grid->ny);
    EXPECT_EQ(a->grid->nz, b->grid->nz);
    EXPECT_EQ(a->grid->channels, b->grid->channels);
    EXPECT_EQ(a->grid->values, b->grid->values);
  }

  const VolumeGrid smoke_{3, 2, 1, 1, {0, 1, 2, 3, 4, 5}};
  const VolumeGrid colours_{1, 1, 2, 3, {0, 0.25f, 0.5f, 0.75f, 1, 0.125f}};
};

TEST_F(MitsubaGrids, GridsStandForExtinctionAndAlbedo) {
  const ParticipatingMedium m = read_medium(grid("sigma_t", "smoke.vol") + grid("albedo", "colours.vol") +
                                            float_of("scale", "3") + in("phase", "rayleigh"));
  EXPECT_EQ(m.extinction, glm::vec3(3));
  EXPECT_EQ(m.albedo, glm::vec3(1));
  EXPECT_THAT(m.phase, ElementsAre(PhaseLobe{PHASE_RAYLEIGH, 0, 1}));
  expect_same(m.density, GridVolume{std::make_shared<const VolumeGrid>(smoke_)});
  expect_same(m.albedo_grid, GridVolume{std::make_shared<const VolumeGrid>(colours_)});

  const ParticipatingMedium coloured =
      read_medium(grid("sigma_t", "colours.vol") + "<rgb name='albedo' value='.1 .2 .3'/>");
  EXPECT_EQ(coloured.extinction, glm::vec3(1));
  EXPECT_EQ(coloured.albedo, glm::vec3(0.1f, 0.2f, 0.3f));
  expect_same(coloured.density, GridVolume{std::make_shared<const VolumeGrid>(colours_)});
  EXPECT_FALSE(coloured.albedo_grid);
  const ParticipatingMedium constant =
      read_medium(grid("sigma_t", "smoke.vol") + "<volume type='constvolume' name='albedo'>" +
                  float_of("value", ".5") + "</volume>");
  EXPECT_EQ(constant.albedo, glm::vec3(0.5f));
  EXPECT_EQ(read_medium(grid("sigma_t", "smoke.vol")).albedo, glm::vec3(0.75f));
}

/// As in Mitsuba 3.
TEST_F(MitsubaGrids, WithoutAGridTheMediumEndsAtTheUnitCube) {
  const std::string at = to_world("<scale value='2'/><translate x='10'/>");
  const glm::dmat4 place = translation({10, 0, 0}) * scaling({2, 2, 2});
  for (const auto& [content, cube] :
       {std::pair("<rgb name='sigma_t' value='1 2 4'/>" + float_of("scale", "2"), glm::dmat4(1)),
        std::pair(
            "<volume type='constvolume' name='sigma_t'><rgb name='value' value='2 4 8'/>" + at + "</volume>",
            place)}) {
    const ParticipatingMedium m = read_medium(content);
    EXPECT_EQ(m.extinction, glm::vec3(2, 4, 8));
    EXPECT_EQ(m.albedo, glm::vec3(0.75f));
    expect_same(m.density,
                GridVolume{std::make_shared<const VolumeGrid>(VolumeGrid{1, 1, 1, 1, {1.0f}}), cube});
  }
  EXPECT_EQ(read_medium("").extinction, glm::vec3(1));
}

TEST_F(MitsubaGrids, AHomogeneousMediumMayHaveAGridOfAlbedos) {
  const SceneDescription s =
      good(volpath("<medium type='homogeneous' name='interior'>" + float_of("sigma_t", "2") +
                   grid("albedo", "colours.vol") + "</medium>"));
  EXPECT_THAT(s.warnings, IsEmpty());
  ASSERT_THAT(s.media, SizeIs(1));
  EXPECT_EQ(s.media[0].extinction, glm::vec3(2));
  EXPECT_EQ(s.media[0].albedo, glm::vec3(1));
  EXPECT_FALSE(s.media[0].density);
  expect_same(s.media[0].albedo_grid, GridVolume{std::make_shared<const VolumeGrid>(colours_)});
}

TEST_F(MitsubaGrids, FiltersAndPlaces) {
  const auto density = [&](const std::string& more, const std::vector<std::string>& warnings = {}) {
    return read_medium(grid("sigma_t", "smoke.vol", more), warnings).density.value();
  };
  EXPECT_FALSE(density("").nearest);
  EXPECT_FALSE(density(word("filter_type", "trilinear")).nearest);
  EXPECT_TRUE(density(word("filter_type", "nearest")).nearest);
  density(word("wrap_mode", "clamp") + true_or_false("raw", true) + true_or_false("accel", false) +
          float_of("max_value", "5"));
  density(word("wrap_mode", "mirror"));  // the same inside the box
  density(word("wrap_mode", "repeat"), {"differs within half a cell"});
  const glm::dmat4 place = translation({10, 0, 0}) * scaling({2, 2, 2});
  const std::string at = to_world("<scale value='2'/><translate x='10'/>");
  EXPECT_EQ(density("").to_world, glm::dmat4(1));
  EXPECT_EQ(density(at).to_world, place);
  EXPECT_EQ(density(at + true_or_false("use_grid_bbox", false)).to_world, place);
  // As Mitsuba 3.9.1's bbox of the same volume, [8, 12] x [-4, 4] x [-6, 8].
  const glm::dmat4 boxed = density(at + true_or_false("use_grid_bbox", true)).to_world;
  EXPECT_EQ(transform_point(boxed, {0, 0, 0}), glm::dvec3(8, -4, -6));
  EXPECT_EQ(transform_point(boxed, {1, 1, 1}), glm::dvec3(12, 4, 8));
}

TEST_F(MitsubaGrids, FilesAreReadOnceAndCounted) {
  const SceneDescription s =
      good("<integrator type='volpath'/>" +
           filled(heterogeneous(grid("sigma_t", "smoke.vol") + grid("albedo", "colours.vol"))) +
           filled(heterogeneous(grid("sigma_t", "./smoke.vol", word("filter_type", "nearest")))));
  ASSERT_THAT(s.media, SizeIs(2));
  EXPECT_EQ(s.media[0].density->grid, s.media[1].density->grid);
  EXPECT_TRUE(s.media[1].density->nearest);
  EXPECT_THAT(s.files, SizeIs(3));
  const std::uint64_t before = s.contents_hash;
  VolumeGrid other = smoke_;
  other.values[0] = 0.5f;
  write("smoke.vol", vol_of(other));
  EXPECT_NE(read_scene(folder_ / "scene.xml", {})->contents_hash, before);
}

/// A layer of zeros; the numbers stay where they are.
TEST_F(MitsubaGrids, WrapModeZeroSurroundsThem) {
  std::vector<float> values(5 * 4 * 3);
  for (std::size_t i = 0; i < 6; ++i) values[20 + 5 * (1 + i / 3) + 1 + i % 3] = float(i);
  const auto expected = std::make_shared<const VolumeGrid>(VolumeGrid{5, 4, 3, 1, values});
  const std::string zero = word("wrap_mode", "zero");
  const glm::dvec3 low(-1 - 2.0 / 3, -4, -10), high(1 + 2.0 / 3, 4, 11);
  expect_same(read_medium(grid("sigma_t", "smoke.vol", zero + true_or_false("use_grid_bbox", true))).density,
              GridVolume{expected, translation(low) * scaling(high - low)});
  const GridVolume alone = *read_medium(grid("sigma_t", "smoke.vol", zero)).density;
  EXPECT_EQ(alone.grid->values, values);
  const glm::dvec4 corner = alone.to_world * glm::dvec4(1.0 / 5, 3.0 / 4, 2.0 / 3, 1);
  EXPECT_LT(glm::distance(glm::dvec3(corner), glm::dvec3(0, 1, 1)), 1e-12);
}

TEST_F(MitsubaGrids, ErrorsSayWhatIsWrong) {
  EXPECT_THAT(wrong(grid("sigma_t", "fog.vol")), HasSubstr("there is no file 'fog.vol'"));
  EXPECT_THAT(wrong("<volume type='gridvolume' name='sigma_t'/>"),
              HasSubstr("needs a <string name=\"filename\""));
  EXPECT_THAT(wrong_grid(word("filter_type", "cubic")), HasSubstr("trilinear"));
  EXPECT_THAT(wrong_grid(word("wrap_mode", "around")), HasSubstr("clamp"));
  EXPECT_THAT(wrong_grid(word("interpolation", "cubic")), HasSubstr("has no parameter 'interpolation'"));
  EXPECT_THAT(wrong_grid(to_world("<scale x='0'/>")), HasSubstr("the transform is singular"));
  EXPECT_THAT(wrong(grid("sigma_t", "smoke.vol") + float_of("sigma_t", "1")), HasSubstr("is there twice"));
  EXPECT_THAT(
      wrong(grid("albedo", "smoke.vol")),
      AllOf(HasSubstr("smoke.vol: the number at x 2, y 0, z 0 is 2; albedo must be a colour in [0, 1]"),
            HasSubstr("scene.xml:2:")));
  EXPECT_THAT(wrong(grid("sigma_t", "smoke.vol") + float_of("scale", "1e38")), HasSubstr("too large"));
  EXPECT_THAT(wrong(float_of("sigma_s", "1")), HasSubstr("has no parameter 'sigma_s'"));
  EXPECT_THAT(wrong(word("material", "milk")), HasSubstr("has no parameter 'material'"));

  write("cut.vol", vol_of(smoke_).substr(0, 60));
  EXPECT_THAT(wrong(grid("sigma_t", "cut.vol")),
              AllOf(HasSubstr("cut.vol: 6 numbers take 24 bytes after 48 of others; there are 12"),
                    HasSubstr("(which is named at scene.xml:2:")));
  VolumeGrid odd = colours_;
  odd.values[4] = -1.0f;
  write("odd.vol", vol_of(odd));
  EXPECT_THAT(wrong(grid("sigma_t", "odd.vol")),
              HasSubstr("the number at x 0, y 0, z 1, channel 1 is -1; sigma_t must be a colour, 0 or more"));
  write("flat.vol", vol_of(smoke_, {0, 1, 0}, {1, 1, 1}));
  EXPECT_THAT(wrong(grid("sigma_t", "flat.vol", true_or_false("use_grid_bbox", true))),
              HasSubstr("flat.vol: the box that the file says is none: it goes from 1 to 1 along y"));
  read_medium(grid("sigma_t", "flat.vol"));  // which is not asked for
  write("wide.vol", vol_of(smoke_, {0, 0, 0}, {3e38, 3e38, 3e38}));
  const std::string wide = to_world("<scale value='1e120'/>");
  read_medium(grid("sigma_t", "wide.vol", true_or_false("use_grid_bbox", true)));
  EXPECT_THAT(wrong(grid("sigma_t", "wide.vol", true_or_false("use_grid_bbox", true) + wide)),
              HasSubstr("the transform of the box that the file says overflows"));
}

/// The numbers of Mitsuba 0.x are at the corners of cells, from one corner of the file's box to the other:
/// N along an axis are those of N cells that are larger by 1 / (N - 1) in all.
TEST_F(MitsubaGrids, ThoseOfVersion0HaveTheirNumbersAtCorners) {
  write("old.vol", vol_of({3, 2, 2, 1, std::vector<float>(12, 0.5f)}, {-1, -2, -3}, {1, 2, 4}));
  const auto old = [](const std::string& content) {
    return "<scene version='0.6.0'><integrator type='volpath'/>" + filled(heterogeneous(content)) +
           "<sensor type='perspective'/></scene>";
  };
  const auto s =
      read(old(word("method", "woodcock") + grid("density", "old.vol") +
               "<volume type='constvolume' name='albedo'><spectrum name='value' value='.9'/></volume>" +
               float_of("scale", "3") + float_of("stepSize", ".1")));
  ASSERT_TRUE(s) << s.error().message;
  ASSERT_THAT(s->media, SizeIs(1));
  const ParticipatingMedium& medium = s->media[0];
  EXPECT_EQ(medium.extinction, glm::vec3(3.0f));
  EXPECT_EQ(medium.albedo, glm::vec3(0.9f));
  ASSERT_TRUE(medium.density);
  const VolumeGrid& numbers = *medium.density->grid;
  const glm::dvec3 low(-1, -2, -3), high(1, 2, 4), cells(numbers.nx, numbers.ny, numbers.nz);
  const auto centre = [&](const glm::dvec3& cell) {
    return glm::dvec3(medium.density->to_world * glm::dvec4((cell + 0.5) / cells, 1.0));
  };
  EXPECT_LT(glm::length(centre(glm::dvec3(0.0)) - low), 1e-12);
  EXPECT_LT(glm::length(centre(cells - 1.0) - high), 1e-12);
  EXPECT_THAT(warnings(*s), HasSubstr("ends at its outermost numbers"));

  // Between two points instead, and then moved.
  const auto placed =
      read(old(grid("density", "old.vol",
                    "<point name='min' x='0' y='0' z='0'/><point name='max' x='1' y='1' z='1'/>" +
                        to_world("<translate z='7'/>"))));
  ASSERT_TRUE(placed) << placed.error().message;
  const glm::dvec4 middle = placed->media[0].density->to_world * glm::dvec4(0.5, 0.5, 0.5, 1.0);
  EXPECT_LT(glm::length(glm::dvec3(middle) - glm::dvec3(0.5, 0.5, 7.5)), 1e-12);

  // A density that is the same everywhere has no box.
  const auto constant =
      read(old("<volume type='constvolume' name='density'><float name='value' value='2'/></volume>"));
  ASSERT_TRUE(constant) << constant.error().message;
  EXPECT_FALSE(constant->media[0].density);
  EXPECT_EQ(constant->media[0].extinction, glm::vec3(2.0f));
  EXPECT_EQ(constant->media[0].albedo, glm::vec3(1.0f)) << "lajolla's";
  EXPECT_THAT(error(old(grid("desnity", "old.vol"))), HasSubstr("a volume named 'desnity'"));

  write("flat.vol", vol_of({2, 1, 2, 1, std::vector<float>(4, 0.5f)}, {0, 0, 0}, {1, 1, 1}));
  EXPECT_THAT(error(old(grid("density", "flat.vol"))),
              HasSubstr("a grid of 2 x 1 x 2 numbers; of Mitsuba 0.x"));
  EXPECT_THAT(error(old(grid("density", "old.vol") + grid("orientation", "old.vol"))),
              HasSubstr("a medium of fibres, with an orientation, is not read"));
}

TEST_F(MitsubaGrids, WrittenAndReadAgainTheyAreTheSame) {
  const std::string place =
      to_world("<rotate y='1' angle='30'/><scale x='3' y='.1' z='2'/><translate z='7'/>");
  const SceneDescription s =
      good("<integrator type='volpath'/>" +
           filled(heterogeneous(grid("sigma_t", "smoke.vol", place + true_or_false("use_grid_bbox", true)) +
                                grid("albedo", "colours.vol", word("filter_type", "nearest")) +
                                float_of("scale", ".3") + in("phase", "hg", float_of("g", ".25")))) +
           filled(heterogeneous(grid("sigma_t", "smoke.vol") + "<rgb name='albedo' value='.1 .2 .3'/>")) +
           filled("<medium type='homogeneous' name='interior'>" + float_of("sigma_t", "5") +
                  grid("albedo", "colours.vol") + "<rgb name='emission' value='3 2 .1'/></medium>") +
           filled(heterogeneous(grid("sigma_t", "smoke.vol") + grid("emission", "colours.vol", place) +
                                true_or_false("emission_by_density", true))));
  const auto written = write_scene(s, folder_ / "written.xml");
  ASSERT_TRUE(written) << written.error().message;
  const auto again = read_scene(folder_ / "written.xml", {});
  ASSERT_TRUE(again) << again.error().message;
  ASSERT_EQ(s.media.size(), 4u);
  ASSERT_EQ(again->media.size(), 4u);
  EXPECT_EQ(s.media[2].emission, glm::vec3(3, 2, 0.1f));
  EXPECT_TRUE(s.media[3].emission_grid && s.media[3].emission_by_density);
  for (std::size_t i = 0; i < 4; ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(s.media[i].extinction, again->media[i].extinction);
    EXPECT_EQ(s.media[i].albedo, again->media[i].albedo);
    EXPECT_EQ(s.media[i].phase, again->media[i].phase);
    expect_same(s.media[i].density, again->media[i].density);
    expect_same(s.media[i].albedo_grid, again->media[i].albedo_grid);
    EXPECT_EQ(s.media[i].emission, again->media[i].emission);
    expect_same(s.media[i].emission_grid, again->media[i].emission_grid);
    EXPECT_EQ(s.media[i].emission_by_density, again->media[i].emission_by_density);
  }
  // One file a grid, however often it is used.
  EXPECT_TRUE(std::filesystem::exists(folder_ / "written-0.vol"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "written-1.vol"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "written-2.vol"));
  SceneDescription tinted = s;
  tinted.media[0].extinction = {1, 2, 3};
  const auto refused = write_scene(tinted, folder_ / "tinted.xml");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("a colour that multiplies a grid"));
}

TEST_F(MitsubaGrids, OfMitsubasTests) {
  const std::string folder = "mitsuba/tests/scenes/participating_media/textures/";
  PENUMBRA_NEED_ORACLE(folder + "sigmat.vol");
  PENUMBRA_NEED_ORACLE(folder + "albedo.vol");
  const ParticipatingMedium m = read_medium(grid("sigma_t", find_oracle(folder + "sigmat.vol")->string()) +
                                            grid("albedo", find_oracle(folder + "albedo.vol")->string()));
  ASSERT_TRUE(m.density && m.albedo_grid);
  EXPECT_EQ(m.density->grid->channels, 1);
  EXPECT_EQ(std::ranges::max(m.density->grid->values), 5.0f);
  EXPECT_EQ(m.albedo_grid->grid->channels, 3);
  EXPECT_EQ(std::ranges::max(m.albedo_grid->grid->values), 1.0f);
}

}  // namespace
}  // namespace penumbra
