// The picture: from what workers sent and what is drawn here to linear values, and from those to the screen.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gl/film_textures.h"
#include "gl/gl_objects.h"
#include "gl/tile_outlines.h"
#include "gl/view_model.h"
#include "kernels/host/error.h"

namespace penumbra {

/// Two RGBA32F textures of the film's size, rows as in FilmTextures; 0 and 0 where there is no closed form.
struct AnalyticTextures {
  GLuint closed_form = 0;  ///< G
  GLuint emission = 0;     ///< E, what the camera sees of the lights
};

/// Where the picture goes: a framebuffer with its size in pixels, and what of it is free for the picture.
struct DisplayTarget {
  GLuint framebuffer = 0;
  int width = 0, height = 0;
  PixelRectangle area;
  float scale = 1;  ///< pixels for what is one on a plain display: of outlines and of checks
};

/// Linear values, by DisplaySettings::layer:
///   kComposite   with a closed form alpha G + D + E where there are samples, else G + E; without: radiance
///   kAnalytic    G + E
///   kDifference  D
///   kError       the standard error itself, in all channels, from two samples on
///
/// On the screen, where x is the linear value times 2^exposure and sRGB() the transfer function of
/// IEC 61966-2-1 after a clamp to [0, 1]:
///   kComposite, kAnalytic  sRGB(T(max(x, 0))) with T by DisplaySettings::tone_map:
///     kClamp     x
///     kReinhard  x / (1 + L), L the luminance of Rec. 709 (Reinhard et al. 2002, equation 3)
///     kFilmic    x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14) (Narkowicz 2015, ACES Filmic Tone Mapping
///     Curve)
///   kDifference  0.5 + 0.5 sign(x) sRGB(|x|): 0 is mid grey, black and white are −1 and 1
///   kError       heat_color (scheduler/image/metrics/color_map.h) of log10 of the standard error over the
///   range of
///                error_scale.h; relative: over the root mean square of the radiance's channels
/// NaN and infinities are magenta, pixels without a value a dim checkerboard. A picture that is magnified
/// shows film pixels as they are; one that is made smaller shows the mean, weighted by area, of the linear
/// values below each pixel of the screen, those without a value left out.
class CompositePass {
 public:
  static Expected<CompositePass> create();

  /// Draws the linear values of `settings.layer`. Textures of the closed form that are not of the film's size
  /// count as none. Errors: no memory for a target of this size.
  Expected<void> compose(const FilmTextures& film, const AnalyticTextures& analytic,
                         const DisplaySettings& settings);

  /// Draws what was composed last into `target`, letterboxed, and outlines of the workers' tiles if the
  /// settings want them. Returns where the film is.
  PixelRectangle show(const FilmTextures& film, const DisplaySettings& settings,
                      std::span<const WorkerView> workers, const DisplayTarget& target);

  /// What was composed last, red, green and blue, row by row from the top. Empty before the first.
  [[nodiscard]] std::vector<float> read_linear() const;

  /// What was composed last as `show` would draw it, film pixel by film pixel and without outlines: 8 bits of
  /// red, green and blue, row by row from the top. Errors: no memory for a target of this size.
  Expected<std::vector<std::uint8_t>> read_display(const FilmTextures& film, const DisplaySettings& settings);

 private:
  CompositePass() = default;
  void draw_picture(const FilmTextures& film, const DisplaySettings& settings, const PixelRectangle& place,
                    int target_height, float scale);
  void draw_outlines(const std::vector<OutlineVertex>& vertices, int target_width, int target_height);

  Program linear_, display_, outline_;
  VertexArray nothing_, outline_array_;
  Buffer outline_buffer_;
  Texture heat_, values_;
  Framebuffer values_target_;
  int width_ = 0, height_ = 0;
};

}  // namespace penumbra
