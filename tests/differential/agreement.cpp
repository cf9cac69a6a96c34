#include "tests/differential/agreement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "scenes/settings.h"
#include "tests/support/render_scene.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::differential {
namespace {

namespace fs = std::filesystem;
using statistics::Estimate;
using statistics::Image;

constexpr int kBatches = 32, kSpp = 128;
constexpr double kSignificance = 0.01;
// The test has two stages. The first one flags a scene at a significance of 5 %. A flagged scene is rendered
// anew, with other seeds and more samples, and the second stage alone decides. So its significance holds
// whatever the outcome of the first stage.
constexpr double kSuspicion = 0.05;
constexpr int kSecondLook = 8;
constexpr std::uint32_t kFirstSeed = 1000, kSecondSeed = 100000;

Image whole_mean(const Image& image) {
  Image mean(1, 1, 3);
  for (int c = 0; c < 3; ++c) mean.at(0, 0, c) = channel_mean(image, c);
  return mean;
}

struct Estimates {
  Estimate blocks, whole;
};

Estimates estimates_of(std::span<const Image> batches, int block) {
  std::vector<Image> blocks, wholes;
  for (const Image& batch : batches) {
    blocks.push_back(block_average(batch, block));
    wholes.push_back(whole_mean(batch));
  }
  return {estimate_from_batches(blocks), estimate_from_batches(wholes)};
}

/// What is inside the film's crop window.
Image cropped(const Image& image, const Film& film) {
  Image result(film.crop_width, film.crop_height, image.channels);
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x)
      for (int c = 0; c < result.channels; ++c)
        result.at(x, y, c) = image.at(film.crop_x + x, film.crop_y + y, c);
  return result;
}

std::vector<Image> our_batches(const SceneText& scene, const fs::path& folder, int spp, std::uint32_t seed) {
  SceneDescription description = read_or_throw(folder / scene.our_file());
  for (const auto& [key, value] : scene.settings)
    if (const auto done = apply_setting(description, key, value); !done)
      throw std::runtime_error(done.error().message);
  description.sampler.spp = std::uint32_t(spp);
  DeviceScene device_scene = build_or_throw(description, scene.embree);
  std::vector<Image> batches;
  for (int batch = 0; batch < kBatches; ++batch) {
    device_scene.header.sampler.seed = seed + std::uint32_t(batch);
    batches.push_back(cropped(mean_image(render_or_throw(device_scene)), description.film));
  }
  return batches;
}

MitsubaJob job_of(const fs::path& folder, int spp, std::uint32_t seed) {
  return {folder / "mitsuba.xml", folder / "mitsuba.exr", kBatches, spp, seed};
}

/// Moves our means towards Mitsuba's by what rounding may have done, which is `relative` of a value or of the
/// image's mean: Mitsuba adds up a pixel's samples in single precision, and its filters reach over many
/// pixels. Where everything is of one colour, or black, there is no noise that would hide this.
void allow_for_rounding(Estimate& ours, const Estimate& theirs, const Image& whole, double relative) {
  for (std::size_t i = 0; i < ours.mean.values.size(); ++i) {
    double& value = ours.mean.values[i];
    const double other = theirs.mean.values[i];
    const double largest = std::max({std::abs(value), std::abs(other), std::abs(whole.values[i % 3]), 1e-4});
    value += std::clamp(other - value, -relative * largest, relative * largest);
  }
}

struct Verdict {
  bool passed = false;
  std::string text;
};

std::string describe(std::string_view what, const Estimate& ours, const Estimate& theirs,
                     const statistics::ImageTestResult& result) {
  const int x = result.worst_x, y = result.worst_y, c = result.worst_channel;
  return fmt::format("{}: {}\n  there Penumbra {:.6g} ± {:.2g}, Mitsuba {:.6g} ± {:.2g}\n", what,
                     result.summary(), ours.mean.at(x, y, c), ours.standard_error.at(x, y, c),
                     theirs.mean.at(x, y, c), theirs.standard_error.at(x, y, c));
}

/// Both tests of a scene, each at half the significance. Every value must be inside its limit.
Verdict compare(Estimates ours, const Estimates& theirs, double significance, double rounding) {
  allow_for_rounding(ours.blocks, theirs.blocks, theirs.whole.mean, rounding);
  allow_for_rounding(ours.whole, theirs.whole, theirs.whole.mean, rounding);
  const statistics::ImageTestLimits limits{.significance = 0.5 * significance,
                                           .accepted_fraction = 1,
                                           .mean_square = std::numeric_limits<double>::infinity()};
  const auto blocks = z_test(ours.blocks, theirs.blocks, limits),
             whole = z_test(ours.whole, theirs.whole, limits);
  Verdict verdict;
  verdict.passed = blocks.passed && whole.passed;
  verdict.text = describe("image means", ours.whole, theirs.whole, whole) +
                 describe("block means", ours.blocks, theirs.blocks, blocks);
  return verdict;
}

/// Where a failing scene's files stay.
fs::path kept_folder(const SceneText& scene) {
  const fs::path folder = fs::temp_directory_path() / "penumbra-differential" / scene.name;
  fs::remove_all(folder);
  scene.write(folder);
  return folder;
}

void fail_scene(const SceneText& scene, const std::string& why) {
  ADD_FAILURE() << "scene " << scene.name << ": " << why << "\n  files: " << kept_folder(scene).string()
                << "\n  again: PENUMBRA_DIFFERENTIAL_SCENE=" << scene.name
                << " ./differential_test --gtest_filter='*Differential*'";
}

}  // namespace

void expect_agreement(MitsubaProcess& mitsuba, std::span<const SceneText> scenes, std::size_t all,
                      bool report) {
  const TemporaryFolder folder;
  const auto folder_of = [&](const SceneText& scene) { return folder / scene.name; };
  const double each = statistics::sidak_significance(kSignificance, all);
  const auto spp_of = [](const SceneText& scene, int times) { return int(kSpp * scene.samples) * times; };
  // Mitsuba has all jobs at once, and renders while this process does.
  for (const SceneText& scene : scenes) {
    scene.write(folder_of(scene));
    mitsuba.start(job_of(folder_of(scene), spp_of(scene, 1), kFirstSeed));
  }
  const auto look = [&](const SceneText& scene, int times, std::uint32_t seed,
                        double significance) -> std::optional<Verdict> {
    std::vector<Image> ours;
    std::string problem;
    try {
      ours = our_batches(scene, folder_of(scene), spp_of(scene, times), seed);
    } catch (const std::exception& error) {
      problem = error.what();
    }
    const auto theirs = mitsuba.finish(job_of(folder_of(scene), spp_of(scene, times), seed));
    if (!theirs) problem += theirs.error().message;
    if (problem.empty())
      return compare(estimates_of(ours, scene.block), estimates_of(*theirs, scene.block), significance,
                     spp_of(scene, times) * 0x1p-24 + scene.colour_error);
    fail_scene(scene, problem);
    return std::nullopt;
  };
  std::vector<const SceneText*> suspicious;
  for (const SceneText& scene : scenes) {
    const auto verdict = look(scene, 1, kFirstSeed, kSuspicion);
    if (verdict && !verdict->passed) suspicious.push_back(&scene);
    if (verdict && report) {
      fmt::print("scene {}: at first\n{}  files: {}\n", scene.name, verdict->text,
                 kept_folder(scene).string());
    }
  }
  for (const SceneText* scene : suspicious) {
    mitsuba.start(job_of(folder_of(*scene), spp_of(*scene, kSecondLook), kSecondSeed));
    const auto verdict = look(*scene, kSecondLook, kSecondSeed, each);
    if (verdict && !verdict->passed) fail_scene(*scene, "the images differ\n" + verdict->text);
  }
}

}  // namespace penumbra::differential
