// Tests `penumbra convert` and the files that it writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/host/atomic_file.h"
#include "scheduler/image/image_files.h"
#include "scheduler/image/picture.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::convert_command_test {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kMesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
constexpr const char* kScene =
    "<scene version='3.0.0'><shape type='obj'><string name='filename' value='a.obj'/></shape>"
    "<shape type='ply'><string name='filename' value='s-1.ply'/></shape><emitter type='constant'/>"
    "<sensor type='perspective'/></scene>";
constexpr const char* kPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

class ConvertCommand : public ::testing::Test {
 protected:
  ConvertCommand() {
    write_text(folder_ / "a.obj", kMesh);
    write_text(folder_ / "s-1.ply", kPly);
    write_text(folder_ / "s.xml", kScene);
  }
  ProgramResult convert(const std::string& output) {
    return run_penumbra(folder_.path(), {"convert", "s.xml", output});
  }
  TemporaryFolder folder_;
};

TEST_F(ConvertCommand, WritesTheSceneAndItsMeshesBesideIt) {
  const ProgramResult done = convert("new/t.xml");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(run_penumbra(folder_ / "new", {"info", "t.xml"}).exit_code, 0);
  EXPECT_THAT(folder_.names(), ElementsAre("a.obj", "new", "s-1.ply", "s.xml"));
}

TEST_F(ConvertCommand, WhatCannotBeWrittenIsSaidAndLeavesNothing) {
  const std::vector<std::string> before = folder_.names();
  for (const auto& [output, why] : {std::pair("out.obj", "'out.obj' does not end in .xml"),
                                    std::pair("new/out", "'new/out' does not end in .xml"),
                                    std::pair("new/", "'new/' does not end in .xml"),
                                    std::pair("a.obj/new/t.xml", "a.obj/new is not a folder")}) {
    const ProgramResult done = convert(output);
    EXPECT_NE(done.exit_code, 0) << output;
    EXPECT_THAT(done.err, HasSubstr(why));
    EXPECT_EQ(folder_.names(), before) << output;
  }
}

TEST_F(ConvertCommand, AWrongOutputIsSaidBeforeTheSceneIsRead) {
  write_text(folder_ / "bad.xml", "<scene");
  for (const auto& [output, why] : {std::pair("a.obj/t.xml", "a.obj is not a folder"),
                                    std::pair("out.obj", "'out.obj' does not end in .xml")}) {
    const ProgramResult done = run_penumbra(folder_.path(), {"convert", "bad.xml", output});
    EXPECT_EQ(done.exit_code, 2);
    EXPECT_THAT(done.err, AllOf(HasSubstr(why), Not(HasSubstr("bad.xml:"))));
  }
  // A scene that cannot be read makes no folder.
  EXPECT_NE(run_penumbra(folder_.path(), {"convert", "bad.xml", "new/t.xml"}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "new"));
}

TEST_F(ConvertCommand, WhatMitsubaCannotReadIsWarnedOfOnce) {
  write_text(
      folder_ / "ours.xml",
      "<scene version='3.0.0'><integrator type='ao'/><sensor type='thinlens'><float name='aperture_radius' "
      "value='0.1'/><float name='distortion_k1' value='0.1'/><sampler type='halton'/></sensor>"
      "<shape type='sphere'><bsdf type='phong'/></shape><shape type='disk'><bsdf type='phong'>"
      "<float name='exponent' value='7'/></bsdf></shape></scene>");
  const ProgramResult done = run_penumbra(folder_.path(), {"convert", "ours.xml", "t.xml"});
  EXPECT_EQ(done.exit_code, 0);
  for (const char* what : {"t.xml: Mitsuba 3 has no integrator 'ao'",
                           "t.xml: Mitsuba 3 has no sampler 'halton'", "t.xml: Mitsuba 3 has no bsdf 'phong'",
                           "t.xml: Mitsuba 3's sensor 'thinlens' has no 'distortion_k1'"})
    EXPECT_THAT(done.err, HasSubstr(what));
  EXPECT_THAT(done.err, Not(ContainsRegex("phong(.|\n)*phong")));
  EXPECT_THAT(convert("t.xml").err, Not(HasSubstr("Mitsuba 3")));
}

TEST_F(ConvertCommand, InputsAreNeverOutputs) {
  std::filesystem::create_symlink("s.xml", folder_ / "link.xml");
  for (const auto& [output, input] : {std::pair("s.xml", "s.xml"), std::pair("link.xml", "link.xml"),
                                      std::pair("./s.XML", "s-1.ply"), std::pair("s.again.xml", "")}) {
    const ProgramResult done = convert(output);
    if (*input == '\0') {  // whose meshes have other names
      EXPECT_EQ(done.exit_code, 0) << done.err;
      continue;
    }
    EXPECT_EQ(done.exit_code, 2);
    EXPECT_THAT(done.err, HasSubstr(std::string(input) + " is an input of this command"));
    EXPECT_EQ(file_contents(folder_ / "s.xml"), kScene);
    EXPECT_EQ(file_contents(folder_ / "s-1.ply"), kPly);
  }
}

TEST_F(ConvertCommand, WhatIsProtectedOrCannotBeWrittenStaysAsItIs) {
  write_text(folder_ / "t.xml", "old");
  chmod((folder_ / "t.xml").c_str(), 0444);
  const ProgramResult protected_file = convert("t.xml");
  EXPECT_EQ(protected_file.exit_code, 2);
  EXPECT_THAT(protected_file.err, HasSubstr("t.xml: it is write-protected"));
  EXPECT_EQ(file_contents(folder_ / "t.xml"), "old");

  // Of two meshes and a scene all are written or none.
  write_text(folder_ / "u.xml", "old");
  std::filesystem::create_directory(folder_ / "u-1.ply");
  EXPECT_EQ(convert("u.xml").exit_code, 2);
  EXPECT_EQ(file_contents(folder_ / "u.xml"), "old");
  EXPECT_THAT(folder_.names(), ElementsAre("a.obj", "s-1.ply", "s.xml", "t.xml", "u-1.ply", "u.xml"));
  EXPECT_EQ(convert("a.obj/t.xml").exit_code, 2) << "no folder can be made there";
}

/// A rectangle with an image.
std::string gltf_with(const std::string& uri) {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0, "name": "a.picture"}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1},
"indices": 2, "material": 0}]}], "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
"metallicFactor": 0}}], "textures": [{"source": 0}], "images": [{"uri": ")" +
         uri +
         R"("}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
{"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
{"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 32},
{"buffer": 0, "byteOffset": 80, "byteLength": 12}], "buffers": [{"byteLength": 92, "uri": "data:application/octet-stream;base64,)"
         "AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgD8AAAAAAAAAAAAAgD8AAIA/"
         "AACAPwAAgD8AAAAAAAAAAAAAAAAAAAEA"
         "AgAAAAIAAwA=\"}]}";
}

/// What is converted may be moved with the images that it names, and read from anywhere.
TEST_F(ConvertCommand, ImagesAreFoundFromTheOutputsFolder) {
  const std::string encoded =
      "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC";
  std::filesystem::create_directory(folder_ / "sub");
  write_text(folder_ / "sub/embedded.gltf", gltf_with("data:image/png;base64," + encoded));
  const auto converted = [&](const std::string& from, const std::string& to) {
    const ProgramResult done = run_penumbra(folder_.path(), {"convert", from, to});
    EXPECT_EQ(done.exit_code, 0) << done.err;
    const std::filesystem::path other = folder_ / "elsewhere";
    std::filesystem::create_directory(other);
    const ProgramResult info = run_penumbra(other, {"info", "../" + to});
    EXPECT_EQ(info.exit_code, 0) << info.err;
    return file_contents(folder_ / to);
  };
  EXPECT_THAT(converted("sub/embedded.gltf", "out/a.xml"),
              AllOf(HasSubstr("value=\"a-0.png\""), HasSubstr("id=\"a_picture\"")));
  std::filesystem::rename(folder_ / "out/a-0.png", folder_ / "sub/red.png");
  write_text(folder_ / "sub/named.gltf", gltf_with("red.png"));
  EXPECT_THAT(converted("sub/named.gltf", "b.xml"), HasSubstr("value=\"sub/red.png\""));
  EXPECT_THAT(converted("sub/named.gltf", "out/c.xml"), HasSubstr("value=\"../sub/red.png\""));
  std::filesystem::rename(folder_.path() / "out", folder_.path() / "moved");
  EXPECT_EQ(run_penumbra(folder_ / "moved", {"info", "c.xml"}).exit_code, 0);
}

/// A crop of 3 x 2 pixels with the layers of a render; one pixel is not finite.
Image small_image() {
  Image image;
  image.data = {1, 1, 3, 2};
  image.display = {0, 0, 5, 4};
  image.channels = {"R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "depth.Z", "samples.Y"};
  for (std::size_t i = 0; i < image.pixels() * image.channels.size(); ++i)
    image.values.push_back(float(i) * 0.07f);
  image.values[8] = std::numeric_limits<float>::infinity();
  image.metadata = {{"penumbra:seed", 3}, {"penumbra:command", std::string("penumbra render s.xml")}};
  image.chromaticities = kRec709;
  return image;
}

class ConvertImage : public ::testing::Test {
 protected:
  ConvertImage() { write(image_, "a.exr"); }
  void write(const Image& image, const std::string& name) {
    ASSERT_TRUE(write_file_atomically(folder_ / name, *encode_exr(image)));
  }
  ProgramResult convert(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "convert");
    return run_penumbra(folder_.path(), arguments);
  }
  Image read(const std::string& name) {
    auto image = read_image(folder_ / name);
    EXPECT_TRUE(image) << image.error().message;
    return image.value_or(Image{});
  }
  Image image_ = small_image();
  TemporaryFolder folder_;
};

TEST_F(ConvertImage, ToPngWithExposureAndToneMap) {
  for (const std::string_view tone : kToneOperatorNames) {
    const ProgramResult done =
        convert({"a.exr", "new/a.png", "--exposure", "-1.5", "--tonemap", std::string(tone)});
    ASSERT_EQ(done.exit_code, 0) << done.err;
    EXPECT_THAT(done.err, HasSubstr("a.exr: 1 pixel is NaN or infinite, magenta in the PNG"));
    const auto at = std::ranges::find(kToneOperatorNames, tone) - kToneOperatorNames.begin();
    const auto expected = picture_of(image_, {.exposure = -1.5, .tone = ToneOperator(at)});
    const Image png = read("new/a.png");
    ASSERT_EQ(png.values.size(), expected->pixels.size());
    for (std::size_t i = 0; i < png.values.size(); ++i)
      EXPECT_EQ(std::lround(255 * png.values[i]), expected->pixels[i]) << tone << ' ' << i;
  }
  convert({"a.exr", "clamp.png"});
  convert({"a.exr", "srgb.png", "--tonemap", "srgb"});
  EXPECT_EQ(file_contents(folder_ / "clamp.png"), file_contents(folder_ / "srgb.png"));
}

TEST_F(ConvertImage, ALayerToPngSaysItsRange) {
  const ProgramResult done = convert({"a.exr", "d.png", "--layer", "depth"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(done.out, "depth from 0.42 (dark) to 3.22 (white); 0 is black\n");
  EXPECT_EQ(done.err, "");
}

TEST_F(ConvertImage, ToExrAllStaysOrOneLayer) {
  const ProgramResult all = convert({"a.exr", "b.exr"});
  ASSERT_EQ(all.exit_code, 0) << all.err;
  EXPECT_THAT(all.err, HasSubstr("1 pixel is NaN or infinite"));
  EXPECT_EQ(file_contents(folder_ / "a.exr"), file_contents(folder_ / "b.exr"));
  ASSERT_EQ(convert({"a.exr", "albedo.exr", "--layer", "albedo"}).exit_code, 0);
  const Image albedo = read("albedo.exr");
  EXPECT_THAT(albedo.channels, ElementsAre("R", "G", "B"));
  EXPECT_EQ(albedo.data, image_.data);
  EXPECT_EQ(albedo.display, image_.display);
  EXPECT_EQ(albedo.attribute("penumbra:command"), MetadataValue("penumbra render s.xml"));
  EXPECT_EQ(albedo.attribute("penumbra:seed"), MetadataValue(3));
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x)
      for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(albedo.at(x, y, c), image_.at(x, y, c + 3));
}

TEST_F(ConvertImage, PngBecomesLinearAndComesBack) {
  image_.values[8] = 0.5f;
  write(image_, "a.exr");
  ASSERT_EQ(convert({"a.exr", "a.png"}).exit_code, 0);
  ASSERT_EQ(convert({"a.png", "linear.exr"}).exit_code, 0);
  ASSERT_EQ(convert({"linear.exr", "again.png"}).exit_code, 0);
  EXPECT_EQ(file_contents(folder_ / "a.png"), file_contents(folder_ / "again.png"));
  // A byte of a PNG is half a byte off at most, where the curve has a slope of 12.92 at most.
  const Image linear = read("linear.exr");
  EXPECT_NEAR(linear.at(1, 0, *linear.channel("R")), 0.5f, 2.3 * 0.5 / 255);
}

TEST_F(ConvertImage, PfmIsReadFromItsBottom) {
  const float rows[2][3] = {{0.25f, 0.5f, 1}, {0, 0, 0.125f}};
  std::string pfm = "PF\n1 2\n-1\n";
  pfm.append(reinterpret_cast<const char*>(rows), sizeof rows);
  write_text(folder_ / "a.pfm", pfm);
  ASSERT_EQ(convert({"a.pfm", "p.exr"}).exit_code, 0);
  const Image image = read("p.exr");
  EXPECT_EQ(image.at(0, 1, *image.channel("G")), 0.5f);
  EXPECT_EQ(image.at(0, 0, *image.channel("B")), 0.125f);
}

TEST_F(ConvertImage, WhatDoesNotFitNamesWhatDoes) {
  write_text(folder_ / "s.xml", kScene);
  const std::vector<std::string> before = folder_.names();
  using Words = std::vector<std::string>;
  for (const auto& [words, why] :
       {std::pair(Words{"s.xml", "s.png"}, "'s.xml' is a scene: `penumbra render s.xml -o s.png`"),
        std::pair(Words{"a.exr", "a.xml"}, "'a.exr' is an image, of which no scene can be made"),
        std::pair(Words{"a.exr", "a.jpg"}, "'a.jpg' does not end in .png or .exr"),
        std::pair(Words{"a.exr", "a.exr"}, "a.exr is an input of this command"),
        std::pair(Words{"a.exr", "b.exr", "--exposure", "1"}, "--exposure: for .png"),
        std::pair(Words{"a.exr", "b.exr", "--tonemap", "aces"}, "--tonemap: for .png"),
        std::pair(Words{"a.exr", "a.png", "--spp", "4", "--lenient"}, "--lenient, --spp: for scenes"),
        std::pair(Words{"s.xml", "t.xml", "--layer", "albedo"}, "--layer: for images"),
        std::pair(Words{"a.exr", "a.png", "--layer", "normal"},
                  "a.exr: has no layer 'normal'; it has beauty"),
        std::pair(Words{"a.exr", "a.png", "--tonemap", "hable"}, "--tonemap: 'hable' is none of clamp"),
        std::pair(Words{"none.exr", "a.png"}, "none.exr: no such file")}) {
    const ProgramResult done = convert(words);
    EXPECT_EQ(done.exit_code, 2) << why;
    EXPECT_THAT(done.err, HasSubstr(why));
    EXPECT_EQ(folder_.names(), before) << why;
  }
}

TEST_F(ConvertCommand, IdsStay) {
  write_text(
      folder_ / "ids.xml",
      "<scene version='3.0.0'><bsdf type='diffuse' id='paint'/><shape type='sphere' id='ball'><ref "
      "id='paint'/></shape>"
      "<shape type='disk' id='plate'><bsdf type='plastic' id='medium-0'/></shape><shape type='sphere'/>"
      "<emitter type='constant'/><sensor type='perspective'/></scene>");
  ASSERT_EQ(run_penumbra(folder_.path(), {"convert", "ids.xml", "t.xml"}).exit_code, 0);
  const std::string text = file_contents(folder_ / "t.xml");
  for (const char* id : {"\"paint\"", "\"ball\"", "\"plate\""}) EXPECT_THAT(text, HasSubstr(id));
  ASSERT_EQ(run_penumbra(folder_.path(), {"convert", "t.xml", "u.xml"}).exit_code, 0);
  EXPECT_EQ(file_contents(folder_ / "u.xml"), text);
}

}  // namespace
}  // namespace penumbra::convert_command_test
