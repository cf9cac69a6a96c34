// What the window shows, as files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "gl/composite_pass.h"
#include "gl/view_model.h"
#include "kernels/host/error.h"
#include "scheduler/image/image.h"

namespace penumbra {

/// Row by row from the top. What has no numbers is left out of the files.
struct Picture {
  int width = 0, height = 0;
  std::vector<float> linear;          ///< of Layer::kComposite, three a pixel; 0 where there is no sample yet
  std::vector<float> difference;      ///< D, three a pixel
  std::vector<float> analytic;        ///< G, three a pixel
  std::vector<float> standard_error;  ///< one a pixel, NaN below two samples
  std::vector<float> samples;         ///< one a pixel
  std::vector<std::uint8_t> display;  ///< of the layer that is shown, as it is shown: 8 bits, three a pixel
  std::vector<std::pair<std::string, MetadataValue>> metadata;  ///< of the EXR
};

/// All that can be saved of the present view. Leaves the layer of `settings` composed. What workers sent is
/// taken from where it came in, not through OpenGL. Errors: those of CompositePass.
Expected<Picture> capture_picture(CompositePass& pass, const FilmTextures& film,
                                  const AnalyticTextures& analytic, const DisplaySettings& settings,
                                  const ViewStatus& status);

/// By the extension of `path`, in either case:
///   .exr  `linear` as R, G, B; difference.R/G/B, analytic.R/G/B, standard_error.Y, samples.Y; metadata
///   .png  `display`
/// Errors: another extension, arrays of another length than the size says, a file that cannot be written.
Expected<void> save_picture(const std::filesystem::path& path, const Picture& picture);

}  // namespace penumbra
