// Pictures of our own scenes by the programs that the scenes' formats belong to.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/scene_description.h"
#include "tests/support/render_scene.h"

namespace penumbra {

/// How well a render agrees with another program's picture, in blocks of kPictureBlock x kPictureBlock
/// pixels. Both have noise. Our variance of one sample is known for each pixel; the other program traces the
/// same paths with the same kinds of samples, so that the variance of one of its samples is taken to be the
/// same. The standard error of a difference is then sqrt(variance (1 / n_ours + 1 / n_theirs) / pixels).
/// Within-pixel variances are upper bounds for stratified samples.
struct PictureAgreement {
  double mean = 0;            ///< ours by theirs, of all pixels and channels
  double mean_tolerance = 0;  ///< of |mean - 1|: kPictureMean and kPictureDeviates standard errors
  double accepted = 0;        ///< the share of blocks and channels inside their limits
  double worst = 0;           ///< the largest difference by its limit ...
  int worst_x = 0, worst_y = 0, worst_channel = 0;  ///< ... in the block that begins at this pixel

  [[nodiscard]] bool passed() const;
  [[nodiscard]] std::string summary() const;
};

constexpr int kPictureBlock = 4;           ///< pixels of a block's side; a rest at the edges is left out
constexpr double kPictureMean = 0.01;      ///< relative difference of the means that is no error
constexpr double kPictureLevel = 0.02;     ///< relative difference of a block that is no error
constexpr double kPictureDark = 0.02;      ///< blocks below this share of the mean are compared with that
constexpr double kPictureDeviates = 4.0;   ///< standard errors
constexpr double kPictureAccepted = 0.99;  ///< of the blocks and channels

/// The names of the scenes of a folder of the references, e.g. "cycles": each NAME with NAME.`extension` and
/// NAME_ref.exr, sorted. Empty where the folder is not there.
std::vector<std::string> picture_names(const std::string& folder, const std::string& extension);

/// Renders a scene with `samples` samples a pixel, and compares it with another program's picture of
/// `reference_samples`. Throws std::runtime_error: no such picture; one of another size.
PictureAgreement compare_with_picture(SceneDescription scene, const std::filesystem::path& reference,
                                      std::uint32_t reference_samples, std::uint32_t samples,
                                      const TestDevice& device = native_device());

/// A picture that cannot agree, by name, and why.
struct PictureException {
  std::string_view name, reason;
};

/// Expects that they agree; or, if the name is among the exceptions, that they do not, so that the list stays
/// true. For tests of GoogleTest.
void expect_agreement(const PictureAgreement& agreement, std::string_view name,
                      std::span<const PictureException> exceptions);

}  // namespace penumbra
