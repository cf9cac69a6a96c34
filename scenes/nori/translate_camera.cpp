#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scenes/nori/translate.h"
#include "scenes/transform.h"

namespace penumbra::nori {

using mitsuba::Child;
using mitsuba::Object;
using mitsuba::Parameter;

namespace {

/// Projections other than perspective.
bool is_another_projection(std::string_view plain) {
  static constexpr std::string_view kOthers[] = {"fisheye",   "panoram", "environment",
                                                 "spherical", "omni",    "equirect"};
  return std::ranges::any_of(kOthers, [&](std::string_view each) { return plain.find(each) != plain.npos; });
}

void settle_lens(Object& camera) {
  const auto radius = take_any(camera, {"lens_radius", "aperture_radius", "aperture", "aperture_size"});
  const auto distance = take_any(
      camera, {"focal_distance", "focus_distance", "focal_dist", "focus_dist", "focal_length", "focus"});
  const double size = radius ? number_of(*radius).value_or(0.0) : 0.0;
  camera.type = size > 0.0 ? "thinlens" : "perspective";
  if (!(size > 0.0)) return;
  set(camera, "aperture_radius", size);
  if (distance) set(camera, "focus_distance", number_of(*distance).value_or(1.0));
}

}  // namespace

void translate_camera(const Translation& t, Object& camera) {
  const std::string plain = plain_name(camera.type);
  if (is_another_projection(plain)) {
    t.report.unsupported(
        camera.type_location,
        fmt::format("camera type '{}' is not one of Nori's that Penumbra reads; it reads perspective, "
                    "thinlens, orthographic",
                    camera.type),
        "a perspective one stands in for it");
    camera.type = "perspective";
  }
  if (plain.find("ortho") != plain.npos)
    camera.type = "orthographic";
  else
    settle_lens(camera);
  if (camera.type != "orthographic") {
    set_default(camera, "fov", 30.0);
    set_default(camera, "fov_axis", std::string("x"));
  }
  set_default(camera, "near_clip", 1e-4);
  set_default(camera, "far_clip", 1e4);
  set_default(camera, "width", std::int64_t(1280));
  set_default(camera, "height", std::int64_t(720));
  if (t.dialect == Dialect::kEth) {
    const Parameter* given = find(camera, "to_world");
    const auto* to_world = given != nullptr ? std::get_if<glm::dmat4>(&given->value) : nullptr;
    const glm::dmat4 mirror = scaling({-1.0, 1.0, 1.0});
    if (given == nullptr || to_world != nullptr)
      set(camera, "to_world", to_world != nullptr ? *to_world * mirror : mirror);
  }
  Object& film = t.new_object("film", "hdrfilm", camera.location);
  for (const char* side : {"width", "height"}) film.parameters.push_back(*take(camera, side));
  if (const Child* filter = find_child(camera, "rfilter")) {
    film.children.push_back(*filter);
    camera.children.erase(camera.children.begin() + (filter - camera.children.data()));
  }
  add_child(camera, film);
}

void translate_sampler(const Translation& t, Object& sampler) {
  static constexpr std::string_view kKnown[] = {"independent", "stratified", "halton",     "sobol",
                                                "hammersley",  "ldsampler",  "multijitter"};
  rename(sampler, {"samples", "spp"}, "sample_count");
  set_default(sampler, "sample_count", std::int64_t(1));
  if (std::ranges::find(kKnown, sampler.type) != std::end(kKnown)) return;
  t.report.warn(sampler.type_location,
                fmt::format("independent stands in for the sampler '{}'; its image is the same on average",
                            sampler.type));
  sampler.type = "independent";
}

void translate_filter(const Translation& t, Object& filter) {
  if (filter.type.find("sinc") != filter.type.npos) filter.type = "lanczos";
  if (filter.type == "gaussian") {
    const auto radius = take(filter, "radius");
    const Parameter* stddev = find(filter, "stddev");
    const double cut = radius ? number_of(*radius).value_or(2.0) : 2.0;
    const double width = stddev != nullptr ? number_of(*stddev).value_or(0.5) : 0.5;
    if (cut != 4.0 * width)
      t.report.warn(filter.location,
                    fmt::format("the filter ends at 4 stddev, {} pixels, not at {}", 4.0 * width, cut));
  }
  if (filter.type == "mitchell") {
    if (const auto radius = take(filter, "radius"); radius && radius->text != "2")
      t.report.warn(radius->location, "the radius of a Mitchell filter is 2");
  }
}

}  // namespace penumbra::nori
