// The closed form of polygon lights, drawn by OpenGL 3.3 from the same source as the kernels, in single
// precision.
#pragma once

#include <memory>
#include <vector>

#include "gl/analytic_tables.h"

namespace penumbra {

/// Draws primitives' numbers with their depth, and from them one more frame that is averaged into two
/// textures. All of it belongs to the context that was current at its creation. Calls keep the framebuffers
/// and the viewport that are bound, leave no program, vertex array or blending behind, depth tests off, and
/// textures bound to units 0 to 7.
class AnalyticPass {
 public:
  /// Uploads the scene's tables. An error says which table is larger than a texture buffer may be, or holds
  /// the log of the driver's compiler.
  static Expected<std::unique_ptr<AnalyticPass>> create(const DeviceScene& scene);

  /// A new view of the scene in a picture of that size: its camera, clipping planes, film filter and
  /// hide_emitters. The camera is relative to the scene's centre, as the tables are. Forgets earlier frames.
  /// An error if this OpenGL cannot draw such a picture.
  Expected<void> begin(const SceneHeader& view, int width, int height);

  /// Draws one more frame and averages it in; the first goes through the pixels' centres, later ones are
  /// displaced as the film's filter says, so that the mean converges to the filter's. Does nothing before
  /// begin().
  void add_frame();
  [[nodiscard]] int frames() const { return frames_; }

  /// RGBA32F, row 0 the film's top, columns from its left; 0 before begin(). The mean of G, the
  /// unshadowed radiance from polygon lights towards the viewer, as unshadowed_lights of
  /// kernels/light/light_unshadowed.h, except that no light shines on itself; alpha 1.
  [[nodiscard]] GLuint closed_form() const { return closed_form_.name(); }
  /// Likewise: the mean of the radiance that is seen directly, of emitters of all kinds and the environment.
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
  double weights_ = 0;  ///< the sum of the frames'
  Texture ids_, depth_, closed_form_, emission_;
  Framebuffer id_target_, mean_target_;
};

}  // namespace penumbra
