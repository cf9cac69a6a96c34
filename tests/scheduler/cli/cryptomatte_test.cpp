// `penumbra render --cryptomatte`: the layers are the same whichever workers render them, and other programs
// can read them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "scheduler/image/image.h"
#include "scheduler/record/cryptomatte.h"
#include "tests/scheduler/cli/killed_render.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using Arguments = std::vector<std::string>;

/// The small scene with names for the floor and what it is made of.
class CryptomatteCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    write_small_scene(folder_ / "s.xml");
    std::string scene = file_contents(folder_ / "s.xml");
    const auto replace = [&](const std::string& what, const std::string& with) {
      scene.replace(scene.find(what), what.size(), with);
    };
    replace("<shape type=\"rectangle\">", "<shape type=\"rectangle\" id=\"the floor\">");
    replace("<bsdf type=\"diffuse\">", "<bsdf type=\"diffuse\" id=\"grey\">");
    write_text(folder_ / "s.xml", scene);
  }

  ProgramResult render(const std::string& out, const Arguments& more = {}) {
    Arguments arguments{"render", "s.xml", "-o", out, "-q", "--cryptomatte"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_penumbra(folder_.path(), arguments);
  }
  void render_well(const std::string& out, const Arguments& more = {}) {
    const ProgramResult result = render(out, more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
  }
  Image image(const std::string& name) {
    auto read = read_image(folder_ / name);
    EXPECT_TRUE(read) << read.error().message;
    return read.value_or(Image{});
  }
  [[nodiscard]] std::string bytes(const std::string& name) const { return file_contents(folder_ / name); }
  ProgramResult shell(const std::string& line) { return run_shell(folder_.path(), line); }

  TemporaryFolder folder_;
};

/// Coverages of a layer's pixel by the bits of their ids.
std::map<std::uint32_t, float> mattes(const Image& image, const std::string& layer, int x, int y) {
  std::map<std::uint32_t, float> result;
  for (int group = 0; group < 3; ++group)
    for (const auto& [id, coverage] : {std::pair("R", "G"), std::pair("B", "A")}) {
      const std::string prefix = layer + "0" + std::to_string(group) + ".";
      const float share = image.at(x, y, image.channel(prefix + coverage).value());
      if (share > 0)
        result[std::bit_cast<std::uint32_t>(image.at(x, y, image.channel(prefix + id).value()))] = share;
    }
  return result;
}

TEST_F(CryptomatteCommand, SaysWhoCoversThePixels) {
  render_well("a.exr", {"--set", "film.pixel_format=rgba"});
  const Image a = image("a.exr");
  const std::uint32_t floor = cryptomatte_hash("the floor"), area_light = cryptomatte_hash("shape-2"),
                      grey = cryptomatte_hash("grey");
  int partly = 0, whole = 0;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 24; ++x) {
      auto objects = mattes(a, "CryptoObject", x, y), materials = mattes(a, "CryptoMaterial", x, y);
      double sum = 0;
      for (const auto& [id, coverage] : objects) {
        EXPECT_TRUE(id == floor || id == area_light);
        sum += double(coverage);
      }
      EXPECT_NEAR(sum, a.at(x, y, a.channel("A").value()), 1e-6) << "all that alpha counts is somebody's";
      EXPECT_EQ(objects[floor], materials[grey]);
      EXPECT_EQ(objects[floor] * 8, std::round(objects[floor] * 8)) << "of 8 samples";
      whole += objects[floor] == 1 ? 1 : 0;
      partly += objects[floor] > 0 && objects[floor] < 1 ? 1 : 0;
    }
  EXPECT_GT(whole, 50);
  EXPECT_GT(partly, 10);
  EXPECT_THAT(std::get<std::string>(a.attribute("penumbra:command").value()), HasSubstr(" --cryptomatte"));
}

TEST_F(CryptomatteCommand, ManifestsNameEveryIdOfTheImage) {
  render_well("a.exr");
  const Image a = image("a.exr");
  for (const std::string layer : {"CryptoObject", "CryptoMaterial"}) {
    char digits[9];
    std::snprintf(digits, sizeof digits, "%08x", cryptomatte_hash(layer));
    const std::string key = "cryptomatte/" + std::string(digits, 7) + "/";
    EXPECT_EQ(a.attribute(key + "name"), MetadataValue(layer));
    const auto manifest = nlohmann::json::parse(std::get<std::string>(a.attribute(key + "manifest").value()));
    std::set<std::uint32_t> named;
    for (const auto& [name, hash] : manifest.items()) {
      named.insert(std::uint32_t(std::stoul(hash.get<std::string>(), nullptr, 16)));
      EXPECT_TRUE(named.contains(cryptomatte_hash(name))) << name;
    }
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 24; ++x)
        for (const auto& [id, coverage] : mattes(a, layer, x, y)) EXPECT_TRUE(named.contains(id)) << layer;
  }
}

TEST_F(CryptomatteCommand, IsTheSameFileFromAnyFarm) {
  render_well("a.exr", {"--workers", "1"});
  render_well("b.exr", {"--workers", "3", "--threads", "1", "--tile", "7"});
  EXPECT_TRUE(bytes("a.exr") == bytes("b.exr"));
  render_well("v.exr", {"--workers", "2", "--threads", "1", "--verify", "1"});
  EXPECT_TRUE(bytes("a.exr") == bytes("v.exr"));
  // Other backends say that it was them, and nothing else.
  render_well("e.exr", {"--intersector", "embree"});
  render_well("o.exr", {"--backend", "opencl"});
  const Image a = image("a.exr"), e = image("e.exr"), o = image("o.exr");
  for (const std::string layer : {"CryptoObject", "CryptoMaterial"})
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 24; ++x) {
        EXPECT_EQ(mattes(a, layer, x, y), mattes(e, layer, x, y)) << "Embree";
        EXPECT_EQ(mattes(a, layer, x, y), mattes(o, layer, x, y)) << "OpenCL";
      }
  EXPECT_EQ(a.attribute("penumbra:film_hash"), o.attribute("penumbra:film_hash"));
}

TEST_F(CryptomatteCommand, ChangesNothingElseOfTheFile) {
  render_well("a.exr");
  ASSERT_EQ(run_penumbra(folder_.path(), {"render", "s.xml", "-o", "b.exr", "-q"}).exit_code, 0);
  const Image a = image("a.exr"), b = image("b.exr");
  EXPECT_EQ(a.channels.size(), b.channels.size() + std::size_t(kCryptomatteChannels));
  for (const std::string& channel : b.channels)
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 24; ++x)
        ASSERT_EQ(a.at(x, y, a.channel(channel).value()), b.at(x, y, b.channel(channel).value())) << channel;
  for (const auto& [name, value] : b.metadata) EXPECT_FALSE(name.starts_with("cryptomatte/"));
}

TEST_F(CryptomatteCommand, OfACropIsThatPartOfTheWhole) {
  render_well("a.exr");
  render_well("c.exr", {"--crop", "3,2,19,15"});
  const Image a = image("a.exr"), c = image("c.exr");
  for (int y = 2; y < 15; ++y)
    for (int x = 3; x < 19; ++x)
      EXPECT_EQ(mattes(c, "CryptoObject", x - 3, y - 2), mattes(a, "CryptoObject", x, y));
}

TEST_F(CryptomatteCommand, SurvivesAnyEndOfTheRender) {
  for (const Arguments& kind :
       {Arguments{}, Arguments{"--sampler", "independent", "--target-error", "0.003"}}) {
    Arguments more{"--spp", "40000"};
    more.insert(more.end(), kManyUnits.begin(), kManyUnits.end());
    more.insert(more.end(), kind.begin(), kind.end());
    render_well("a.exr", more);
    std::filesystem::remove(folder_ / "b.exr");
    Arguments all{"render", "s.xml", "-o", "b.exr", "--cryptomatte", "--resume"};
    all.insert(all.end(), more.begin(), more.end());
    kill_after(folder_.path(), all, "b.exr.checkpoint", std::chrono::milliseconds(100));
    const ProgramResult resumed = run_penumbra(folder_.path(), all);
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_THAT(resumed.err, HasSubstr("going on with b.exr.checkpoint"));
    EXPECT_TRUE(bytes("a.exr") == bytes("b.exr"));
  }
}

TEST_F(CryptomatteCommand, IdsAreWholeWhateverTheFilesFormat) {
  render_well("a.exr");
  const Image exact = image("a.exr");
  if (shell("command -v oiiotool").exit_code != 0) GTEST_SKIP() << "no oiiotool";
  for (const std::string compression : {"none", "zips", "piz", "b44", "b44a", "pxr24", "dwaa", "dwab"}) {
    render_well("h.exr",
                {"--set", "film.component_format=float16", "--set", "film.compression=" + compression});
    // The part that has them, or all of a file with one part.
    const bool lossy = compression == "pxr24" || compression.starts_with("dwa");
    const std::string part = lossy ? " --subimage cryptomatte" : "";
    const ProgramResult taken = shell("oiiotool h.exr" + part + " --compression zip -d float -o part.exr");
    ASSERT_EQ(taken.exit_code, 0) << taken.out << taken.err;
    const Image there = image("part.exr");
    for (const std::string& channel : cryptomatte_channels())
      for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 24; ++x)
          ASSERT_EQ(std::bit_cast<std::uint32_t>(there.at(x, y, there.channel(channel).value())),
                    std::bit_cast<std::uint32_t>(exact.at(x, y, exact.channel(channel).value())))
              << compression << ' ' << channel;
    const ProgramResult info = shell("iinfo -v -a h.exr");
    EXPECT_EQ(info.exit_code, 0);
    EXPECT_THAT(info.out, HasSubstr("/conversion: \"uint32_to_float32\"")) << compression;
  }
}

TEST_F(CryptomatteCommand, OpenImageIoReadsItsNames) {
  if (shell("command -v oiiotool iinfo").exit_code != 0) GTEST_SKIP() << "no oiiotool or no iinfo";
  render_well("a.exr");
  const ProgramResult info = shell("iinfo -v a.exr");
  EXPECT_THAT(info.out, HasSubstr("/hash: \"MurmurHash3_32\""));
  EXPECT_THAT(info.out, HasSubstr("/name: \"CryptoMaterial\""));
  EXPECT_THAT(info.out, HasSubstr("the floor"));
  // Mattes by names; a version of OpenImageIO may lack the command.
  const ProgramResult colors =
      shell("oiiotool a.exr --cryptomatte-colors CryptoObject -o colors.exr 2>&1 && iinfo colors.exr");
  if (colors.exit_code != 0) GTEST_SKIP() << "oiiotool has no --cryptomatte-colors";
  EXPECT_THAT(colors.out, HasSubstr("24 x   20"));
}

TEST_F(CryptomatteCommand, SetsAndJobFilesHaveIt) {
  render_well("a.exr");
  write_text(folder_ / "jobs.toml",
             "[[render]]\nscene = \"s.xml\"\nseed = [0, 1]\ncryptomatte = true\nout = \"out/{seed}.exr\"\n");
  const ProgramResult result = run_penumbra(folder_.path(), {"render", "jobs.toml", "-q"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(bytes("out/0.exr") == bytes("a.exr"));
  EXPECT_TRUE(image("out/1.exr").channel("CryptoMaterial02.A"));
}

TEST_F(CryptomatteCommand, IsNotOfAPreview) {
  const ProgramResult result = run_penumbra(folder_.path(), {"preview", "s.xml", "--cryptomatte"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--cryptomatte"));
}

}  // namespace
}  // namespace penumbra
