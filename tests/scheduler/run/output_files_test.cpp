#include "scheduler/run/output_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

RenderOptions options_of(const std::string& out) {
  RenderOptions options;
  options.scene.file = "scenes/cornell/scene.xml";
  options.out = out;
  return options;
}

std::vector<std::string> names(const RenderOptions& options) {
  const auto files = choose_output_files(options);
  if (!files) return {files.error().message};
  std::vector<std::string> result;
  for (const auto& path : files->all()) result.push_back(path.string());
  return result;
}

TEST(OutputFiles, AreNamedAfterTheSceneOrAsAsked) {
  EXPECT_THAT(names(options_of("")), ElementsAre("scene.exr", "scene.png", "scene.json"));
  EXPECT_THAT(names(options_of("out/a.exr")), ElementsAre("out/a.exr", "out/a.png", "out/a.json"));
  EXPECT_THAT(names(options_of("a.b.EXR")), ElementsAre("a.b.EXR", "a.b.png", "a.b.json"));
  EXPECT_THAT(names(options_of("a.png")), ElementsAre("a.png", "a.json"));
  EXPECT_THAT(names(options_of("a.jpg")), ElementsAre(HasSubstr("must end in .exr or .png")));
}

TEST(OutputFiles, GoIntoAFolder) {
  const TemporaryFolder folder;
  const std::string in = folder.path().string() + "/scene";
  EXPECT_THAT(names(options_of(folder.path().string())), ElementsAre(in + ".exr", in + ".png", in + ".json"));
  EXPECT_THAT(names(options_of(folder.path().string() + "/")),
              ElementsAre(in + ".exr", in + ".png", in + ".json"));
}

TEST(OutputFiles, ReportIsOptional) {
  RenderOptions options = options_of("a.exr");
  options.no_statistics = true;
  EXPECT_THAT(names(options), ElementsAre("a.exr", "a.png"));
  options.no_statistics = false;
  options.statistics = "elsewhere/r.json";
  EXPECT_THAT(names(options), ElementsAre("a.exr", "a.png", "elsewhere/r.json"));
  options.statistics = "a.png";
  EXPECT_THAT(names(options), ElementsAre(HasSubstr("the image's own name")));
}

TEST(OutputFiles, OfAPixelAreOnlyThoseAskedFor) {
  RenderOptions options = options_of("");
  options.pixel = PixelPosition{1, 2};
  EXPECT_THAT(names(options), IsEmpty());
  options.statistics = "r.json";
  EXPECT_THAT(names(options), ElementsAre("r.json"));
  options.out = "p.exr";
  EXPECT_THAT(names(options), ElementsAre("p.exr", "p.png", "r.json"));
}

}  // namespace
}  // namespace penumbra
