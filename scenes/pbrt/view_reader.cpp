#include "scenes/pbrt/view_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes/pbrt/type_rows.h"
#include "scenes/settings.h"
#include "scenes/transform.h"

namespace penumbra::pbrt {
namespace {

constexpr const char* kSppm = "sppm";

/// Sets a setting. Errors are reported at the location.
template <typename T>
void set(Context& context, std::string_view key, const T& value, SourceLocation location) {
  if (const auto done = apply_setting(context.scene, key, fmt::format("{}", value)); !done)
    context.report.error(location, done.error().message);
}

}  // namespace

void use_volumetric_integrator(Context& context, SourceLocation location) {
  const std::string depth = print_setting(context.scene, "integrator.max_depth");
  set(context, "integrator.type", "volpath", location);
  set(context, "integrator.max_depth", depth, location);
}

void read_film(Context& context, const std::string& type, Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context.report;
  SceneDescription& scene = context.scene;
  set(context, "film.width", parameters.integer("xresolution", 1280, report), location);
  set(context, "film.height", parameters.integer("yresolution", 720, report), location);
  Film& film = scene.film;
  const std::vector<double> crop = parameters.numbers("cropwindow", {"float"}, 4, report);
  if (crop.size() == 4) {
    if (!(crop[0] >= 0 && crop[0] < crop[1] && crop[1] <= 1 && crop[2] >= 0 && crop[2] < crop[3] &&
          crop[3] <= 1))
      return report.error(parameters.location("cropwindow", location),
                          "a cropwindow is x0 < x1, y0 < y1 in [0, 1]");
    film.crop_x = int(std::ceil(film.width * crop[0]));
    film.crop_y = int(std::ceil(film.height * crop[2]));
    film.crop_width = int(std::ceil(film.width * crop[1])) - film.crop_x;
    film.crop_height = int(std::ceil(film.height * crop[3])) - film.crop_y;
  }
  const std::vector<double> bounds = parameters.numbers("pixelbounds", {"integer"}, 4, report);
  if (bounds.size() == 4) {
    if (!(bounds[0] >= 0 && bounds[0] < bounds[1] && bounds[1] <= film.width && bounds[2] >= 0 &&
          bounds[2] < bounds[3] && bounds[3] <= film.height))
      return report.error(parameters.location("pixelbounds", location), "pixelbounds lie within the film");
    film.crop_x = int(bounds[0]);
    film.crop_y = int(bounds[2]);
    film.crop_width = int(bounds[1] - bounds[0]);
    film.crop_height = int(bounds[3] - bounds[2]);
  }
  // Of the film's effects on radiance, a common factor can be applied to the lights.
  const double time = parameters.number("exposuretime", 1.0, report),
               iso = parameters.number("iso", 100.0, report);
  context.exposure = time * iso / 100.0;
  if (!(context.exposure > 0.0 && context.exposure < 1e30)) {
    report.error(location, "exposuretime and iso must be above 0");
    context.exposure = 1.0;
  }
  if (context.exposure != 1.0)
    report.warn(location,
                fmt::format("all lights are {} times as bright, for the film's exposuretime and iso",
                            context.exposure));
  const std::string sensor = parameters.text("sensor", "cie1931", report);
  if (sensor != "cie1931")
    report.warn(parameters.location("sensor", location),
                fmt::format("the sensor '{}' is taken for cie1931: its colours differ", sensor));
  if (parameters.number("whitebalance", 0.0, report) != 0.0)
    report.warn(parameters.location("whitebalance", location), "the film's white balance is ignored");
  if (parameters.has("maxcomponentvalue"))
    report.warn_counted(parameters.location("maxcomponentvalue", location), "bright samples are not clamped");
  if (type != "rgb") report.warn(location, fmt::format("a film 'rgb' stands in for '{}'", type));
  parameters.accept({"filename", "diagonal", "savefp16", "maxcomponentvalue", "coordinatesystem", "nbuckets",
                     "lambdamin", "lambdamax"});
  parameters.finish("the film", report);
}

void read_camera(Context& context, CameraDirective& camera) {
  ReaderReport& report = context.report;
  SceneDescription& scene = context.scene;
  Parameters& parameters = camera.parameters;
  const SourceLocation location = camera.location;
  if (is_singular(camera.camera_from_world))
    return report.error(location, "the camera's transform flattens everything");
  // pbrt's +x points to the right of the image.
  const auto frame =
      without_scale(glm::inverse(camera.camera_from_world) * scaling(glm::dvec3(-1.0, 1.0, 1.0)));
  if (!frame) return report.error(location, frame.error().message);
  scene.camera.to_world = *frame;
  scene.camera.near_clip = 1e-2;
  scene.camera.far_clip = 1e30;
  const bool parallel = camera.type == "orthographic";
  if (!parallel && camera.type != "perspective")
    return report.unsupported(
        location, fmt::format("camera '{}' is not read; perspective and orthographic are", camera.type),
        "a perspective one stands in for it");
  const double fov = parallel ? 90.0 : parameters.number("fov", 90.0, report);
  if (!(fov > 0.0 && fov < 180.0))
    return report.error(location, fmt::format("fov must be between 0 and 180, not {}", fov));
  scene.camera.fov = fov;
  scene.camera.fov_axis = FovAxis::kSmaller;
  const double aspect = double(scene.film.width) / scene.film.height;
  const double half = std::tan(fov * std::numbers::pi / 360.0);
  glm::dvec2 seen(std::max(aspect, 1.0), std::max(1.0 / aspect, 1.0));  // half the extent at distance 1
  const double frame_aspect = parameters.number("frameaspectratio", aspect, report);
  std::vector<double> window = parameters.numbers("screenwindow", {"float"}, 4, report);
  if (window.size() == 4) {
    const double width = window[1] - window[0], height = window[3] - window[2];
    if (!(width > 0.0 && height > 0.0 && width < 1e10 && height < 1e10))
      return report.error(parameters.location("screenwindow", location),
                          "a screenwindow is x0 < x1, y0 < y1");
    // The distance of the film's centre from the optical axis.
    scene.camera.principal_point_offset_x = -0.5 * (window[0] + window[1]) / width;
    scene.camera.principal_point_offset_y = 0.5 * (window[2] + window[3]) / height;
    if (std::abs(width / height - aspect) > 1e-4 * aspect)
      report.warn(parameters.location("screenwindow", location),
                  "the screenwindow is not of the film's shape; its height follows from the film");
    seen = 0.5 * glm::dvec2(width, height);
    scene.camera.fov = 2 * std::atan(half * 0.5 * width) * 180.0 / std::numbers::pi;
    scene.camera.fov_axis = FovAxis::kX;
  } else if (std::abs(frame_aspect - aspect) > 1e-4 * aspect) {
    report.warn(parameters.location("frameaspectratio", location),
                "the frameaspectratio is not the film's; pixels are square");
  }
  if (parallel) {
    scene.camera.projection = Projection::kOrthographic;
    scene.camera.scale_x = seen.x;
    scene.camera.scale_y = seen.y * aspect;
  }
  const double lens = parameters.number("lensradius", 0.0, report),
               focus = parameters.number("focaldistance", 1e6, report);
  if (!(lens >= 0.0 && lens < 1e30 && focus > 0.0 && focus < 1e30))
    return report.error(parameters.location("lensradius", location),
                        "a lensradius is at least 0, a focaldistance above 0, and both are finite");
  scene.camera.aperture_radius = lens;
  scene.camera.focus_distance = focus;
  parameters.accept({"shutteropen", "shutterclose"});
  parameters.finish("the camera", report);
}

void read_sampler(Context& context, const std::string& type, Parameters& parameters,
                  SourceLocation location) {
  struct Row {
    const char *type, *ours;
  };
  static constexpr Row kRows[] = {{"halton", "halton"},        {"independent", "independent"},
                                  {"sobol", "sobol"},          {"zsobol", "sobol"},
                                  {"paddedsobol", "sobol"},    {"pmj02bn", "sobol"},
                                  {"stratified", "stratified"}};
  ReaderReport& report = context.report;
  const auto* row = find_row(kRows, type, "sampler", "sobol stands in for it", location, report);
  set(context, "sampler.type", row != nullptr ? row->ours : "sobol", location);
  std::int64_t samples = parameters.integer("pixelsamples", 16, report);
  if (type == "stratified")
    samples = parameters.integer("xsamples", 4, report) * parameters.integer("ysamples", 4, report);
  set(context, "sampler.sample_count", samples, location);
  set(context, "sampler.seed", parameters.integer("seed", 0, report), location);
  parameters.accept({"jitter", "randomization"});
  parameters.finish("the sampler", report);
}

void read_filter(Context& context, const std::string& type, Parameters& parameters, SourceLocation location) {
  struct Row {
    const char *type, *ours;
    double radius;
  };
  static constexpr Row kRows[] = {{"box", "box", 0.5},
                                  {"triangle", "tent", 2.0},
                                  {"gaussian", "gaussian", 1.5},
                                  {"mitchell", "mitchell", 2.0},
                                  {"sinc", "lanczos", 4.0}};
  ReaderReport& report = context.report;
  const auto* row = find_row(kRows, type, "filter", "a gaussian stands in for it", location, report);
  set(context, "film.rfilter", row != nullptr ? row->ours : "gaussian", location);
  if (row == nullptr) return;
  const double x = parameters.number("xradius", row->radius, report);
  if (parameters.number("yradius", row->radius, report) != x)
    report.warn(location, "filters are as high as wide: yradius is ignored");
  if (type == "gaussian") {
    const double sigma = parameters.number("sigma", 0.5, report);
    set(context, "film.rfilter_stddev", sigma, location);
    if (parameters.has("xradius") && x != 4 * sigma)
      report.warn(location, fmt::format("the filter ends at 4 sigma, {} pixels, not at {}", 4 * sigma, x));
  } else {
    set(context, "film.rfilter_radius", x, location);
  }
  if (type == "mitchell") {
    set(context, "film.rfilter_b", parameters.number("B", 1.0 / 3.0, report), location);
    set(context, "film.rfilter_c", parameters.number("C", 1.0 / 3.0, report), location);
  }
  if (type == "sinc" && parameters.number("tau", 3.0, report) != x)
    report.warn(location, "the window of a sinc filter has as many lobes as the filter is wide");
  parameters.finish("the filter", report);
}

/// pbrt's sppm: each sample of a pixel has a new map of photons there too.
void read_progressive_photons(Context& context, Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context.report;
  const Film& film = context.scene.film;
  std::int64_t photons = parameters.integer("photonsperiteration", -1, report);
  if (photons <= 0)
    photons = std::min<std::int64_t>(std::int64_t{film.crop_width} * film.crop_height, MAX_PHOTONS);
  set(context, "integrator.photon_count", photons, parameters.location("photonsperiteration", location));
  set(context, "integrator.initial_radius", parameters.number("radius", 1.0, report),
      parameters.location("radius", location));
  set(context, "integrator.alpha", "auto", location);
  // In version 3 the integrator ignored the sampler.
  for (const char* iterations : {"iterations", "numiterations"})
    if (parameters.has(iterations))
      report.warn(parameters.location(iterations, location),
                  fmt::format("{} is ignored; the sampler's pixelsamples decides how many maps of photons "
                              "there are, as in pbrt-v4",
                              iterations));
  parameters.accept({"iterations", "numiterations", "imagewritefrequency", "seed"});
}

void read_integrator(Context& context, IntegratorDirective& integrator) {
  auto& [type, parameters, location] = integrator;
  struct Row {
    const char* type;
    bool same;  ///< whether without media its expected image is that of ours
    const char* ours = "path_mis";
  };
  static constexpr Row kRows[] = {{"path", true},          {"volpath", true},     {"simplepath", true},
                                  {"simplevolpath", true}, {"bdpt", false},       {"mlt", false},
                                  {"lightpath", false},    {"randomwalk", false}, {kSppm, true, "ppm"}};
  ReaderReport& report = context.report;
  const auto* row = find_row(kRows, type, "integrator", "path stands in for it", location, report);
  set(context, "integrator.type", row != nullptr ? row->ours : "path_mis", location);
  if (row != nullptr && !row->same)
    report.warn(location, fmt::format("path stands in for the integrator '{}'", type));
  // pbrt counts the surfaces between light and camera; here it is the edges of the path.
  const std::int64_t depth = parameters.integer("maxdepth", 5, report);
  if (depth < 0)
    return report.error(parameters.location("maxdepth", location), "maxdepth must be at least 0");
  set(context, "integrator.max_depth", depth + 1, location);
  if (type == kSppm) read_progressive_photons(context, parameters, location);
  parameters.accept({"regularize", "lightsampler", "rrthreshold", "samplebsdf", "samplelights", "usemis",
                     "visualizestrategies", "visualizeweights", "bootstrapsamples", "chains",
                     "mutationsperpixel", "largestepprobability", "sigma"});
  parameters.finish("the integrator", report);
}

}  // namespace penumbra::pbrt
