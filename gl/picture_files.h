// Saves what the window shows to files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "gl/composite_pass.h"
#include "gl/view_model.h"
#include "kernels/host/error.h"
#include "scheduler/image/image.h"

namespace penumbra {

/// Row by row from the top. Empty arrays are left out of the files.
struct Picture {
  int width = 0, height = 0;
  std::vector<float> linear;          ///< of Layer::kComposite, three per pixel; 0 without samples
  std::vector<float> difference;      ///< D, three per pixel
  std::vector<float> analytic;        ///< G, three per pixel
  std::vector<float> standard_error;  ///< one per pixel, NaN below two samples
  std::vector<float> samples;         ///< one per pixel
  std::vector<std::uint8_t> display;  ///< the current layer as it is shown: 8 bits, three per pixel
  std::vector<std::pair<std::string, MetadataValue>> metadata;  ///< of the EXR file
};

/// All that can be saved of the current view. `compose_shown` composes what the window shows, which is also
/// composed afterwards. Workers' values are taken from memory as received, not through OpenGL.
/// Errors: those of CompositePass.
Expected<Picture> capture_picture(CompositePass& pass, const FilmTextures& film,
                                  const AnalyticTextures& analytic,
                                  const std::function<Expected<void>()>& compose_shown,
                                  const DisplaySettings& settings, const ViewStatus& status);

/// Saves by the extension of `path`; case is ignored:
///   .exr  `linear` as R, G, B; difference.R/G/B, analytic.R/G/B, standard_error.Y, samples.Y; metadata
///   .png  `display`
/// Errors: another extension, arrays that do not match the size, a file that cannot be written.
Expected<void> save_picture(const std::filesystem::path& path, const Picture& picture);

}  // namespace penumbra
