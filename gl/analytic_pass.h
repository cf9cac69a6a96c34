// Draws the closed form of polygon lights with OpenGL 3.3, from the same source as the kernels, in single
// precision.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "gl/analytic_tables.h"
#include "worker/embedded_kernels.h"

namespace penumbra {

/// Its preprocessed shaders, by names like "triangles.vert".
std::span<const EmbeddedFile> analytic_shaders();

/// Draws primitive IDs and depth, and from them one more frame, which is averaged into two textures. All
/// objects belong to the context that is current when it is created. Calls keep the bound framebuffers and
/// the viewport. They leave no program, vertex array or blending enabled, disable depth tests, and bind
/// textures to units 0 to 7.
class AnalyticPass {
 public:
  /// Uploads the scene's tables. Errors: a table is larger than the limit of texture buffers; a shader does
  /// not compile (with the driver's log).
  static Expected<std::unique_ptr<AnalyticPass>> create(const DeviceScene& scene);

  /// Starts a new view of the scene with that size in pixels: its camera, clipping planes, film filter and
  /// hide_emitters. Like the tables, the camera is relative to the scene's centre. Discards earlier frames.
  /// Errors: this OpenGL cannot draw such a size.
  Expected<void> begin(const SceneHeader& view, int width, int height);

  /// Draws one more frame and averages it in. The first goes through the pixels' centres; later ones are
  /// offset by the film's filter, so that the mean converges to the filtered image. Does nothing before
  /// begin().
  void add_frame();
  [[nodiscard]] int frames() const { return frames_; }

  /// RGBA32F, row 0 is the film's top, columns from the left; 0 before begin(). The mean of G, the unshadowed
  /// radiance from polygon lights reflected towards the camera, as computed by unshadowed_lights of
  /// kernels/light/light_unshadowed.h, except that no light illuminates itself; alpha is 1.
  [[nodiscard]] GLuint closed_form() const { return closed_form_.name(); }
  /// Likewise: the mean of the radiance that the camera sees directly, from emitters of all kinds and the
  /// environment; alpha is the share of the pixel that they cover, by the film's filter.
  [[nodiscard]] GLuint emission() const { return emission_.name(); }

 private:
  explicit AnalyticPass(const DeviceScene& scene);
  void draw_ids(float dx, float dy);
  void shade(float dx, float dy);
  void set_camera(const Program& program, float dx, float dy) const;

  SceneHeader scene_;
  std::vector<float> filter_table_;
  AnalyticTables tables_;
  Program triangles_, quadrics_, shade_;
  VertexArray vertices_;  ///< without attributes

  SceneHeader view_{};
  int width_ = 0, height_ = 0;
  int frames_ = 0;
  double weights_ = 0;  ///< sum of the frames' weights
  Texture ids_, depth_, closed_form_, emission_;
  Framebuffer id_target_, mean_target_;
};

}  // namespace penumbra
