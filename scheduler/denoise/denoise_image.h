// Denoises an image with layers, of Penumbra or of another renderer.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/scene_description.h"
#include "scheduler/denoise/denoise.h"
#include "scheduler/image/image.h"
#include "worker/device.h"

namespace penumbra {

struct DenoiseOptions {
  Denoise method = Denoise::kNfor;  ///< not kOff or kLayers
  NlMeansOptions nl_means;
  DeviceOptions device;  ///< threads 0: all cores. Without effect for kOidn
};

// Metadata.
inline constexpr const char* kDenoisedBy = "penumbra:denoised_by";  ///< denoiser_name()
inline constexpr const char* kFilmHash = "penumbra:film_hash";      ///< of the noisy image

struct DenoiseOutcome {
  /// The image with denoised R, G, B. Its other layers are those of the noisy image, but its variance is now
  /// in noisy_variance.R/G/B. With halves of the samples there is error.R/G/B, see
  /// DenoisedImage::residual_variance.
  Image image;
  std::vector<std::string> remarks;  ///< which layers were missing, and what was used instead
};

/// The name of a method in film.denoise.
std::string method_name(Denoise method);

/// That name, with the options of the method where they are not the default.
std::string denoiser_name(const DenoiseOptions& options);

/// Whether the method can be used here. Error: kOidn without its library.
Expected<void> check_denoiser(Denoise method);

/// Errors: the image has no red, green and blue, or no pixel, or is denoised already; the device's.
Expected<DenoiseOutcome> denoise_image(const Image& noisy, const DenoiseOptions& options);

/// What is known of an image, scaled by a power of two to a brightness of about 1, which `scale` undoes.
/// Layers are found by name, also by those of Blender, Mitsuba and pbrt. `remarks` may be null.
struct ScaledInput {
  DenoiseInput input;
  float scale = 1;
  std::array<std::size_t, 3> channels = {};  ///< of red, green and blue in the image
};
Expected<ScaledInput> denoise_input(const Image& noisy, std::vector<std::string>* remarks);

}  // namespace penumbra
