// Composes the picture: from workers' tiles and the closed form to linear values, and from those to the
// screen.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gl/film_textures.h"
#include "gl/gl_objects.h"
#include "gl/picture_layers.h"
#include "gl/shown_as.h"
#include "gl/tile_outlines.h"
#include "gl/view_model.h"
#include "kernels/host/error.h"
#include "worker/embedded_kernels.h"

namespace penumbra {

/// The sources of gl/shaders/composite*, by their paths.
std::span<const EmbeddedFile> composite_shaders();

/// Two RGBA32F textures of the film's size, rows as in FilmTextures; both 0 if there is no closed form.
struct AnalyticTextures {
  GLuint closed_form = 0;  ///< G
  GLuint emission = 0;     ///< E, the emission that the camera sees, and its coverage
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
///   kNamed       the layer of that name
///
/// On the screen, where x is the linear value times 2^exposure and sRGB() the transfer function of IEC
/// 61966-2-1, by ShownAs::display:
///   kColor     sRGB(T(x)) with T by DisplaySettings::tone_map, see scheduler/image/tone_map.h. Where
///   emission
///              covers a share c of the pixel: sRGB(c T(E / c) + (1 - c) T((x - E) / (1 - c)))
///   kSigned    0.5 + 0.5 sign(x) sRGB(|x|): 0 is mid grey, -1 is black and 1 is white
///   kHeat      heat_color (scheduler/image/metrics/color_map.h) of log10 of the luminance without exposure
///   kNormal    0.5 + 0.5 n
///   kIdentity  a colour for each number
/// NaN and infinities are magenta; pixels without a value are a dim checkerboard. A magnified picture shows
/// film pixels unfiltered. A reduced one shows the area-weighted mean of the linear values below each screen
/// pixel, without pixels that have no value.
class CompositePass {
 public:
  static Expected<CompositePass> create();

  /// Draws the linear values of `settings.layer`. Closed-form textures of another size than the film's are
  /// ignored; so is a picture with layers. Errors: not enough memory for a target of this size.
  Expected<void> compose(const FilmTextures& film, const AnalyticTextures& analytic,
                         const DisplaySettings& settings, const LayeredPicture* layers = nullptr);

  /// Replaces the composed values by what `comparison` shows of them and a reference of that area of the
  /// film. kRelativeError: the root mean square of the channels' difference over that of the reference plus
  /// 0.01. Pixels without a value, or outside of the area, keep what they have.
  Difference compare(const PictureLayer& reference, const PixelRectangle& area, ShownComparison comparison);

  /// Replaces the composed values of a rectangle of the film: red, green and blue, row by row from the top.
  void replace_values(const PixelRectangle& area, std::span<const float> values);

  /// Draws the last composed values into the target's area as `settings.view` says, and outlines of the
  /// workers' tiles if the settings want them. Returns where the film is, which may be larger than the area.
  PixelRectangle show(const FilmTextures& film, const DisplaySettings& settings,
                      std::span<const WorkerView> workers, const DisplayTarget& target);

  /// The last composed values: red, green and blue, row by row from the top. Empty before the first
  /// compose().
  [[nodiscard]] std::vector<float> read_linear() const;
  /// Likewise of one pixel; nothing if it has no value.
  [[nodiscard]] std::optional<std::array<float, 3>> read_pixel(int x, int y) const;
  /// How the last composed values are shown.
  [[nodiscard]] const ShownAs& shown() const { return shown_; }

  /// The last composed values as `show` would draw them, at one pixel per film pixel and without outlines: 8
  /// bits of red, green and blue, row by row from the top. Errors: not enough memory for a target of this
  /// size.
  Expected<std::vector<std::uint8_t>> read_display(const FilmTextures& film, const DisplaySettings& settings);

 private:
  CompositePass() = default;
  Expected<void> make_targets(int width, int height);
  [[nodiscard]] bool is_on_film(const PixelRectangle& area) const;
  void clear_lights();
  void show_layer(const PictureLayer* layer, const PixelRectangle& area);
  void draw_picture(const FilmTextures& film, const DisplaySettings& settings, const PixelRectangle& place,
                    const PixelRectangle& visible, int target_height, float scale);
  void draw_outlines(const std::vector<OutlineVertex>& vertices, int target_width, int target_height);

  Program linear_, display_, outline_;
  VertexArray nothing_, outline_array_;
  Buffer outline_buffer_;
  Texture heat_, values_, lights_;
  Framebuffer values_target_;
  ShownAs shown_;
  int width_ = 0, height_ = 0;
};

}  // namespace penumbra
