// Tests the verdict of `penumbra compare` about renders of the sample scenes.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>

#include "kernels/host/atomic_file.h"
#include "scheduler/image/compare.h"
#include "scheduler/image/image_files.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

constexpr int kSeeds = 8;

/// Renders of parts of scenes with diffuse and glossy surfaces, textures and a medium.
class CompareRenders : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    const auto render = [](const char* scene, const char* crop) {
      return fmt::format("[[render]]\nscene = '{}'\ncrop = '{}'\n", source_path(scene), crop);
    };
    write_text(
        *folder_ / "jobs.toml",
        fmt::format("[defaults]\nspp = [4, 16, 64]\nseed = '1..{}'\nout = '{{scene}}-{{spp}}-{{seed}}.exr'\n",
                    kSeeds) +
            render("scenes/cornell-small/cornell-small.xml", "96,150,144,198") +
            render("scenes/star-light/star-light.xml", "300,250,332,282") +
            render("scenes/materials/materials.xml", "300,200,332,232") +
            render("scenes/smoke/smoke.xml", "250,150,274,174"));
    const ProgramResult done =
        run_penumbra(folder_->path(), {"render", "jobs.toml", "-q", "--no-features", "--no-statistics"});
    ASSERT_EQ(done.exit_code, 0) << done.err;
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static Image image(const std::string& scene, int spp, int seed) {
    const auto read = read_image(*folder_ / fmt::format("{}-{}-{}.exr", scene, spp, seed));
    EXPECT_TRUE(read) << read.error().message;
    return read.value_or(Image{});
  }
  static inline std::unique_ptr<TemporaryFolder> folder_;
};

CompareOptions fast() {
  CompareOptions options;
  options.flip = FlipKind::kNone;
  return options;
}

/// The image as it would be with 2 % less light.
Image darker(Image image) {
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    const std::string& channel = image.channels[i % image.channels.size()];
    if (channel.size() == 1) image.values[i] *= 0.98f;
    if (channel.starts_with("variance.")) image.values[i] *= 0.98f * 0.98f;
  }
  return image;
}

// Each of the 80 pairs would be a false alarm with a chance of 1 % if variances were exact and samples
// independent. Estimated variances are raised and the samplers stratify, so there is none.
TEST_F(CompareRenders, OtherSeedsNeverDiffer) {
  for (const char* scene : {"cornell-small", "star-light", "materials", "smoke"}) {
    std::map<Verdict, int> verdicts;
    for (const auto& [n, m] : {std::pair(4, 4), {16, 16}, {64, 64}, {4, 64}, {16, 64}}) {
      for (int seed = 1; seed < kSeeds; seed += 2) {
        const Image a = image(scene, n, seed), b = image(scene, m, seed + 1);
        const Comparison c = compare_images({.image = a, .reference = b}, fast()).value();
        EXPECT_NE(c.verdict, Verdict::kDiffer) << scene << " " << n << " " << m << ": " << c.verdict_reason;
        ++verdicts[c.verdict];
      }
    }
    EXPECT_GT(verdicts[Verdict::kAgree], 0) << scene;
  }
}

TEST_F(CompareRenders, ADarkerImageDiffers) {
  for (int seed = 1; seed < kSeeds; seed += 2) {
    const Image a = image("star-light", 64, seed), b = darker(image("star-light", 64, seed + 1));
    const Comparison c = compare_images({.image = a, .reference = b}, fast()).value();
    EXPECT_EQ(c.verdict, Verdict::kDiffer);
    EXPECT_LT(c.z_test->visible_image_difference, 0.02);
  }
}

}  // namespace
}  // namespace penumbra
