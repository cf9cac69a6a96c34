// The film that is being watched: what workers sent, as textures to draw and as numbers to save.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gl/gl_objects.h"
#include "kernels/host/error.h"
#include "scheduler/watch/tile_snapshot.h"

namespace penumbra {

/// Rows from the top of the film, the first at texture coordinate 0; pixels row by row.
class FilmTextures {
 public:
  /// Of 1×1 pixels or more. Errors: larger than GL_MAX_TEXTURE_SIZE, or more than the device has memory for.
  static Expected<FilmTextures> create(int width, int height);

  /// Forgets all samples; from now on tiles of earlier views are left out.
  void clear(std::uint32_t view);

  /// Takes a tile over. False, and nothing changes, if it belongs to an earlier view, is not within the film
  /// or its arrays have other lengths than its size says. A tile of a later view clears the film first.
  bool apply(const TileSnapshot& tile);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::uint32_t view() const { return view_; }
  /// Whether a tile of this view had a difference.
  [[nodiscard]] bool has_difference() const { return has_difference_; }

  /// RGBA32F: mean radiance, and the number of samples, which is 0 where there is none yet.
  [[nodiscard]] GLuint radiance_texture() const { return radiance_texture_.name(); }
  /// RGB32F; 0 where there is none.
  [[nodiscard]] GLuint difference_texture() const { return difference_texture_.name(); }
  /// R32F; NaN below two samples.
  [[nodiscard]] GLuint standard_error_texture() const { return standard_error_texture_.name(); }

  /// What the textures hold, bit for bit what came: four, three and one numbers a pixel.
  [[nodiscard]] std::span<const float> radiance() const { return radiance_; }
  [[nodiscard]] std::span<const float> difference() const { return difference_; }
  [[nodiscard]] std::span<const float> standard_error() const { return standard_error_; }

 private:
  FilmTextures(int width, int height);
  void upload(int x, int y, int width, int height) const;

  int width_, height_;
  std::uint32_t view_ = 0;
  bool has_difference_ = false;
  Texture radiance_texture_, difference_texture_, standard_error_texture_;
  std::vector<float> radiance_, difference_, standard_error_;
};

}  // namespace penumbra
