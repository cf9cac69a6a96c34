// Measured BRDFs: errors in their files, and scenes that have them.
#include "scenes/measured_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scenes/device/device_scene_builder.h"
#include "scenes/spectrum.h"
#include "tests/scenes/pbrt_text.h"
#include "tests/support/measured_writer.h"
#include "tests/support/written_scene.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using Floats = std::vector<float>;
using TensorShape = std::vector<std::uint64_t>;

/// A file of the fewest numbers, some of whose fields may be others.
struct SmallFile {
  TensorShape phi_shape{1}, theta_shape{2}, ndf_shape{2, 2}, sigma_shape{2, 2}, vndf_shape{1, 2, 2, 2},
      luminance_shape{1, 2, 2, 2}, rgb_shape{1, 2, 3, 2, 2};
  Floats phi{0}, theta{0, 1.5f}, ndf = Floats(4, 1), sigma = Floats(4, 1), vndf = Floats(8, 1),
                                 luminance = Floats(8, 1), rgb = Floats(24, 0.25f);
  std::string left_out;
  std::uint8_t type_of_ndf = 10;

  [[nodiscard]] std::string bytes() const {
    TensorWriter file;
    const auto add = [&](const char* name, const TensorShape& shape, const Floats& values,
                         std::uint8_t type = 10) {
      if (name != left_out) file.add(name, type, shape, values);
    };
    add("phi_i", phi_shape, phi);
    add("theta_i", theta_shape, theta);
    add("ndf", ndf_shape, ndf, type_of_ndf);
    add("sigma", sigma_shape, sigma);
    add("vndf", vndf_shape, vndf);
    add("luminance", luminance_shape, luminance);
    add("rgb", rgb_shape, rgb);
    if (left_out != "jacobian") file.add("jacobian", 1, {1}, std::vector<std::uint8_t>{1});
    return file.file();
  }
};

std::string wrong(const std::string& bytes) {
  const auto read = read_measured_file("a.bsdf", bytes);
  EXPECT_FALSE(read);
  if (read) return "";
  EXPECT_THAT(read.error().message, StartsWith("a.bsdf: "));
  return read.error().message;
}
std::string wrong(const SmallFile& file) { return wrong(file.bytes()); }

TEST(MeasuredFiles, AreWhatWasWritten) {
  SmallFile file;
  file.vndf[3] = 7, file.rgb[9] = 0.75f, file.rgb[10] = -0.5f;
  const auto read = read_measured_file("a.bsdf", file.bytes());
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->theta, file.theta);
  EXPECT_EQ(read->vndf.values, file.vndf);
  EXPECT_EQ(read->vndf.rows, 2);
  EXPECT_TRUE(read->by_facets);
  EXPECT_TRUE(read->is_isotropic());
  // Channels become neighbours: of channel 2 and knot 1 of the first slice, and of knot 2.
  EXPECT_EQ(read->colours[1 * 3 + 2], 0.75f);
  EXPECT_EQ(read->colours[2 * 3 + 2], 0.0f);
}

TEST(MeasuredFiles, SpectraAreTheirColours) {
  MeasuredFormula formula = isotropic_formula();
  formula.vndf = formula.luminance = formula.facets = 4;
  formula.wavelengths = {390, 500, 555, 600, 720};
  const double spectrum[] = {0.1, 0.7, 0.2, 0.9, 0.4};
  formula.by_facets = false;
  formula.f_cos = [&](const glm::dvec3&, const glm::dvec3&, std::size_t k) { return spectrum[k]; };
  const auto read = read_measured_file("a.bsdf", measured_fields(formula).file());
  ASSERT_TRUE(read) << read.error().message;
  std::vector<SpectrumSample> samples{{300, spectrum[0]}};
  for (std::size_t k = 0; k < 5; ++k) samples.push_back({double(formula.wavelengths[k]), spectrum[k]});
  samples.push_back({900, spectrum[4]});
  const glm::vec3 colour = index_to_rgb(samples);
  int found = 0;
  for (std::size_t i = 0; i < read->colours.size(); i += 3) {
    if (read->colours[i] == 0.0f) continue;  // below the horizon
    ++found;
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(double(read->colours[i + std::size_t(c)]), double(colour[c]), 1e-6);
  }
  EXPECT_GT(found, 10);
}

TEST(MeasuredFiles, ThatAreNoneOrEndSoonerAreErrors) {
  EXPECT_THAT(wrong("VOL\3"), HasSubstr("begins with tensor_file"));
  std::string bytes = SmallFile().bytes();
  for (std::size_t size = 12; size < bytes.size(); ++size)
    EXPECT_THAT(wrong(bytes.substr(0, size)),
                testing::AnyOf(HasSubstr("ends within"), HasSubstr("goes beyond")));
  std::string other = bytes;
  other[12] = 2;
  EXPECT_THAT(wrong(other), HasSubstr("its version is 2.0; 1.0 is read"));
  const auto with = [&](std::size_t at, auto value) {
    std::string changed = bytes;
    std::memcpy(changed.data() + at, &value, sizeof value);
    return changed;
  };
  // The first field: its name's length at 18, 5 letters, dimensions, type, offset, and one size.
  EXPECT_THAT(wrong(with(14, ~std::uint32_t{0})), HasSubstr("field"));  // of what is none
  EXPECT_THAT(wrong(with(25, std::uint16_t{9})), HasSubstr("field 'phi_i' has 9 dimensions; 8 at most"));
  EXPECT_THAT(wrong(with(27, std::uint8_t{12})),
              HasSubstr("field 'phi_i' has the type 12; types are 1 to 11"));
  for (const std::uint64_t far : {std::uint64_t(bytes.size()), ~std::uint64_t{0}, ~std::uint64_t{0} - 3}) {
    EXPECT_THAT(wrong(with(28, far)), HasSubstr("field 'phi_i'"));
    EXPECT_THAT(wrong(with(36, far)), AllOf(HasSubstr("field 'phi_i'"), HasSubstr("goes beyond the file's")));
  }
}

TEST(MeasuredFiles, ErrorsNameTheFieldAndWhatWouldBeRight) {
  for (const char* field : {"phi_i", "theta_i", "ndf", "sigma", "vndf", "luminance", "rgb", "jacobian"}) {
    SmallFile file;
    file.left_out = field;
    EXPECT_THAT(wrong(file), HasSubstr("field '" + std::string(field) + "' is missing"));
  }
  const auto changed = [](const auto& change) {
    SmallFile file;
    change(file);
    return wrong(file);
  };
  EXPECT_THAT(changed([](SmallFile& f) { f.type_of_ndf = 5; }),
              HasSubstr("field 'ndf' has the type 5; it must be 10, single precision"));
  EXPECT_THAT(changed([](SmallFile& f) {
                f.vndf_shape = {2, 1, 2, 2};
              }),
              HasSubstr("field 'vndf' has the shape 2 x 1 x 2 x 2; it must be 1 x 2 x any x any"));
  EXPECT_THAT(changed([](SmallFile& f) { f.ndf_shape = {4}; }),
              HasSubstr("field 'ndf' has the shape 4; it must be any x any"));
  EXPECT_THAT(changed([](SmallFile& f) {
                f.sigma_shape = {1, 4};
              }),
              HasSubstr("field 'sigma' has grids of 1 x 4; they must have 2 to 512 knots"));
  EXPECT_THAT(changed([](SmallFile& f) {
                f.ndf_shape = {2, 600}, f.ndf = Floats(1200, 1);
              }),
              HasSubstr("they must have 2 to 512 knots"));
  EXPECT_THAT(changed([](SmallFile& f) {
                f.rgb_shape = {1, 2, 2, 3, 2};
              }),
              HasSubstr("field 'rgb' has the shape 1 x 2 x 2 x 3 x 2; it must be 1 x 2 x 3 x 2 x 2"));
  EXPECT_THAT(changed([](SmallFile& f) { f.phi_shape = {0}, f.phi = {}; }),
              HasSubstr("field 'phi_i' has the shape 0; it must be any"));
  EXPECT_THAT(changed([](SmallFile& f) {
                f.theta = {1, 1};
              }),
              HasSubstr("field 'theta_i' has 1 before 1; its numbers must ascend"));
  EXPECT_THAT(changed([](SmallFile& f) {
                f.theta = {0, 90};
              }),
              HasSubstr("field 'theta_i' goes from 0 to 90; it must be in [-0.001, 1.572] radians"));
  EXPECT_THAT(changed([](SmallFile& f) {
                f.theta.clear();
                for (int i = 0; i < 200; ++i) f.theta.push_back(0.001f * float(i));
                f.theta_shape = {200};
              }),
              HasSubstr("field 'theta_i' has 200 angles; 128 at most are read"));
  EXPECT_THAT(changed([](SmallFile& f) { f.luminance[3] = -1; }),
              HasSubstr("field 'luminance' has the number -1 at 3; none may be below 0"));
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
    EXPECT_THAT(changed([&](SmallFile& f) { f.rgb[5] = bad; }),
                AllOf(HasSubstr("field 'rgb' has the number"), HasSubstr("at 5; all must be finite")));
}

class MeasuredScenes : public pbrt_test::PbrtText {
 protected:
  void SetUp() override { write("metal.bsdf", SmallFile().bytes()); }
};

TEST_F(MeasuredScenes, AreReadAndWritten) {
  const std::string bsdf = "<bsdf type='measured'><string name='filename' value='metal.bsdf'/></bsdf>";
  const SceneDescription scene =
      good("<shape type='sphere'>" + bsdf + "</shape><shape type='cube'>" + bsdf + "</shape>");
  const auto& measured = std::get<MeasuredBsdf>(scene.bsdfs.at(0).model);
  EXPECT_EQ(measured.brdf, std::get<MeasuredBsdf>(scene.bsdfs.at(1).model).brdf) << "read twice";
  std::filesystem::create_directory(folder_ / "below");
  const auto written = write_scene(scene, folder_ / "below" / "written.xml");
  ASSERT_TRUE(written) << written.error().message;
  const auto again = read_scene(folder_ / "below" / "written.xml", {});
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(std::get<MeasuredBsdf>(again->bsdfs.at(0).model).brdf->vndf.values, measured.brdf->vndf.values);
  const auto before = build_device_scene(scene, {}), after = build_device_scene(*again, {});
  EXPECT_EQ(before->words, after->words);
  EXPECT_TRUE(check_device_scene(*before));
}

TEST_F(MeasuredScenes, WithoutAFileAreErrors) {
  EXPECT_THAT(error(scene("<shape type='sphere'><bsdf type='measured'/></shape>")),
              HasSubstr("bsdf 'measured' needs a <string name=\"filename\" …>"));
  EXPECT_THAT(error(scene("<shape type='sphere'><bsdf type='measured'><string name='filename' "
                          "value='none.bsdf'/></bsdf></shape>")),
              HasSubstr("no file 'none.bsdf'"));
  write("bad.bsdf", "tensor_file");
  EXPECT_THAT(error(scene("<shape type='sphere'><bsdf type='measured'><string name='filename' "
                          "value='bad.bsdf'/></bsdf></shape>")),
              HasSubstr("begins with tensor_file"));
  EXPECT_THAT(PbrtText::wrong("Material \"measured\""), HasSubstr("needs a \"string filename\""));
  EXPECT_THAT(PbrtText::wrong("Material \"measured\" \"string filename\" \"none.bsdf\""),
              HasSubstr("no file 'none.bsdf'"));
}

TEST_F(MeasuredScenes, OfPbrtAreTheSameOnBothSides) {
  const SceneDescription scene =
      good_pbrt(std::string("Material \"measured\" \"string filename\" \"metal.bsdf\"\n") + kTriangle);
  EXPECT_TRUE(std::holds_alternative<MeasuredBsdf>(front(scene)));
  EXPECT_EQ(scene.shapes.at(0).front_bsdf, scene.shapes.at(0).back_bsdf);
}

TEST_F(MeasuredScenes, ThatArriveWithAnotherHeaderAreRefused) {
  DeviceScene scene =
      build_device_scene(good("<shape type='sphere'><bsdf type='measured'><string name='filename' "
                              "value='metal.bsdf'/></bsdf></shape>"),
                         {})
          .value();
  for (const float bad : {3.0f, 0.0f, 600.0f, std::numeric_limits<float>::quiet_NaN()}) {
    DeviceScene changed = scene;
    std::memcpy(&changed.words[scene.header.tables.curves.offset], &bad, sizeof bad);
    const auto checked = check_device_scene(changed);
    ASSERT_FALSE(checked) << bad;
    EXPECT_THAT(checked.error().message, HasSubstr("a measured BRDF's table does not match its size"));
  }
}

}  // namespace
}  // namespace penumbra
