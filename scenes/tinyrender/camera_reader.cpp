#include "scenes/tinyrender/camera_reader.h"

#include <fmt/format.h>

namespace penumbra::tinyrender {

void read_camera(const Context& context, SceneDescription& scene) {
  Section camera(context, "camera");
  for (const char* key : {"eye", "at", "fov"}) camera.require(key);
  const auto eye = camera.vector("eye"), at = camera.vector("at");
  const auto up = camera.has("up") ? camera.vector("up") : "0 1 0";
  camera.accept("up");
  if (eye && at && up) camera.imply(scene, "camera.lookat", fmt::format("{} {} {}", *eye, *at, *up), "at");
  camera.set(scene, "camera.fov", "fov");
  camera.imply(scene, "camera.fov_axis", "y");
  // TinyRender's camera has no clipping planes.
  camera.imply(scene, "camera.near_clip", "1e-6");
  camera.imply(scene, "camera.far_clip", "1e30");
  camera.finish();
}

void read_film(const Context& context, SceneDescription& scene) {
  Section film(context, "film");
  for (const char* key : {"width", "height"}) film.require(key);
  film.set(scene, "film.width", "width");
  film.set(scene, "film.height", "height");
  film.imply(scene, "film.rfilter", "box");
  film.finish();
}

}  // namespace penumbra::tinyrender
