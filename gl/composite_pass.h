// Composes the picture: from workers' tiles and the closed form to linear values, and from those to the
// screen.
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

/// Two RGBA32F textures of the film's size, rows as in FilmTextures; both 0 if there is no closed form.
struct AnalyticTextures {
  GLuint closed_form = 0;  ///< G
  GLuint emission = 0;     ///< E, the emission that the camera sees
};

/// Where the picture is drawn: a framebuffer with its size in pixels, and the area for the picture.
struct DisplayTarget {
  GLuint framebuffer = 0;
  int width = 0, height = 0;
  PixelRectangle area;
  float scale = 1;  ///< pixels per pixel of a plain display, for outlines and checkerboards
};

/// Linear values, by DisplaySettings::layer:
///   kComposite   with a closed form alpha G + D + E where there are samples, else G + E; without: radiance
///   kAnalytic    G + E
///   kDifference  D
///   kError       the standard error, in all channels, from two samples on
///
/// On the screen, where x is the linear value times 2^exposure and sRGB() the transfer function of IEC
/// 61966-2-1 after clamping to [0, 1]:
///   kComposite, kAnalytic  sRGB(T(max(x, 0))) with T by DisplaySettings::tone_map:
///     kClamp     x
///     kReinhard  x / (1 + L), L the luminance of Rec. 709 (Reinhard et al. 2002, equation 3)
///     kFilmic    x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14)
///                (Narkowicz 2015, ACES Filmic Tone Mapping Curve)
///   kDifference  0.5 + 0.5 sign(x) sRGB(|x|): 0 is mid grey, −1 is black and 1 is white
///   kError       heat_color (scheduler/image/metrics/color_map.h) of log10 of the standard error over the
///                range of error_scale.h; relative: over the root mean square of the radiance's channels
/// NaN and infinities are magenta; pixels without a value are a dim checkerboard. A magnified picture shows
/// film pixels unfiltered. A reduced one shows the area-weighted mean of the linear values below each screen
/// pixel, without pixels that have no value.
class CompositePass {
 public:
  static Expected<CompositePass> create();

  /// Draws the linear values of `settings.layer`. Closed-form textures of another size than the film's are
  /// ignored. Errors: not enough memory for a target of this size.
  Expected<void> compose(const FilmTextures& film, const AnalyticTextures& analytic,
                         const DisplaySettings& settings);

  /// Replaces the composed values of a rectangle of the film: red, green and blue, row by row from the top.
  void replace_values(const PixelRectangle& area, std::span<const float> values);

  /// Draws the last composed values into `target`, letterboxed, and outlines of the workers' tiles if the
  /// settings want them. Returns where the film is.
  PixelRectangle show(const FilmTextures& film, const DisplaySettings& settings,
                      std::span<const WorkerView> workers, const DisplayTarget& target);

  /// The last composed values: red, green and blue, row by row from the top. Empty before the first
  /// compose().
  [[nodiscard]] std::vector<float> read_linear() const;

  /// The last composed values as `show` would draw them, at one pixel per film pixel and without outlines: 8
  /// bits of red, green and blue, row by row from the top. Errors: not enough memory for a target of this
  /// size.
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
