#include "scenes/pbrt/view_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes/pbrt/colours.h"
#include "scenes/pbrt/state.h"
#include "scenes/settings.h"
#include "scenes/transform.h"

namespace penumbra::pbrt {
namespace {

constexpr const char* kSppm = "sppm";
constexpr const char* kAmbient = "ambientocclusion";

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
  // As in pbrt, a crop window replaces pixelbounds.
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
  // Of the film's effects on radiance, a common factor can be applied to the lights.
  context.sensitivity = parameters.number("iso", 100.0, report) / 100.0;
  if (!(context.sensitivity > 0.0 && context.sensitivity < 1e30)) {
    report.error(parameters.location("iso", location), "iso must be above 0");
    context.sensitivity = 1.0;
  }
  const std::string sensor = parameters.text("sensor", "cie1931", report);
  if (sensor != "cie1931")
    report.warn(parameters.location("sensor", location),
                fmt::format("the sensor '{}' is taken for cie1931: its colours differ", sensor));
  // A sensor that is no standard observer is balanced anyway, as cie1931 is without any balance.
  const double kelvin = parameters.number("whitebalance", 0.0, report);
  if (kelvin != 0.0 && !(kelvin >= 1000.0 && kelvin <= 40000.0)) {
    report.error(parameters.location("whitebalance", location),
                 fmt::format("whitebalance is 1000 to 40000 K, or 0 for none, not {}", kelvin));
  } else if (kelvin != 0.0) {
    report.warn(parameters.location("whitebalance", location),
                "the lights get the film's white balance; colours of coloured surfaces differ a little");
    context.balance = white_balance(kelvin);
  }
  if (parameters.has("maxcomponentvalue"))
    report.warn_counted(parameters.location("maxcomponentvalue", location), "bright samples are not clamped");
  if (type != "rgb") report.warn(location, fmt::format("a film 'rgb' stands in for '{}'", type));
  parameters.accept({"filename", "diagonal", "savefp16", "maxcomponentvalue", "coordinatesystem", "nbuckets",
                     "lambdamin", "lambdamax"});
  parameters.finish("the film", report);
}

void read_shutter(Context& context, CameraDirective& camera) {
  ReaderReport& report = context.report;
  const double open = camera.parameters.number("shutteropen", 0.0, report),
               close = camera.parameters.number("shutterclose", 1.0, report);
  context.shutter_time = std::abs(close - open);  // pbrt swaps them
  context.motion.set_shutter(std::min(open, close), context.shutter_time);
  if (context.shutter_time > 0.0 && context.shutter_time < 1e30) return;
  report.error(
      camera.parameters.location("shutterclose", camera.location),
      fmt::format("the shutter opens at {} and closes at {}, so that no light comes in", open, close));
  context.shutter_time = 1.0;
}

void check_exposure(Context& context, SourceLocation location) {
  if (context.exposure() != 1.0)
    context.report.warn(
        location,
        fmt::format("all lights are {} times as bright, for the camera's shutter and the film's iso",
                    context.exposure()));
}

namespace {

/// What pbrt's camera sees, on the plane at distance 1 of its own space; x to the right and y upwards.
struct Window {
  double x0, x1, y0, y1;
  [[nodiscard]] double width() const { return x1 - x0; }
  [[nodiscard]] double height() const { return y1 - y0; }
  /// The same in other units and about another point.
  [[nodiscard]] Window placed(glm::dvec2 shift, glm::dvec2 scale) const {
    return {(x0 + shift.x) * scale.x, (x1 + shift.x) * scale.x, (y0 + shift.y) * scale.y,
            (y1 + shift.y) * scale.y};
  }
};

/// The rectangle that an angle of 90 degrees, or an orthographic camera, sees. Nothing, and an error, if it
/// is not valid.
std::optional<Window> screen_window(Context& context, CameraDirective& camera, double aspect) {
  ReaderReport& report = context.report;
  const double frame = camera.parameters.number("frameaspectratio", aspect, report);
  if (!(frame > 1e-10 && frame < 1e10)) {
    report.error(camera.parameters.location("frameaspectratio", camera.location),
                 fmt::format("a frameaspectratio must be above 0, not {}", frame));
    return std::nullopt;
  }
  const std::vector<double> given = camera.parameters.numbers("screenwindow", {"float"}, 4, report);
  const double x = std::max(frame, 1.0), y = std::max(1.0 / frame, 1.0);
  if (given.empty()) return Window{-x, x, -y, y};
  const Window window{given[0], given[1], given[2], given[3]};
  if (given.size() == 4 && window.width() > 0.0 && window.height() > 0.0 && window.width() < 1e10 &&
      window.height() < 1e10)
    return window;
  report.error(camera.parameters.location("screenwindow", camera.location),
               "a screenwindow is x0 < x1, y0 < y1");
  return std::nullopt;
}

/// pbrt's axes of camera space in the world, after its transform: x to the right, y upwards, z along the
/// view.
struct CameraAxes {
  glm::dvec3 x, y, z, origin;
};

/// A camera at right angles, ours, whose rays are those of pbrt's, and the window that it has.
struct StraightCamera {
  glm::dmat4 to_world;
  Window window;
  double depth = 1.0;  ///< by which distances along the view are longer
};

/// A transform may scale the camera's axes. It may also tilt the view against the film. A pinhole camera sees
/// the same if its film stays where it is and the window moves; parallel rays are the same if the film is
/// turned to face them. `tangent`: the window's unit at distance 1. Nothing where the film is no rectangle.
std::optional<StraightCamera> straightened(const CameraAxes& axes, const Window& window, bool parallel,
                                           double tangent) {
  glm::dvec3 x = axes.x, y = axes.y;
  glm::dvec3 normal = glm::normalize(parallel ? axes.z : glm::cross(x, y));
  if (glm::dot(normal, axes.z) < 0.0) normal = -normal;
  if (parallel) {
    x -= glm::dot(x, normal) * normal;
    y -= glm::dot(y, normal) * normal;
  }
  const double right = glm::length(x), up = glm::length(y);
  if (!(right > 0.0 && up > 0.0) || std::abs(glm::dot(x, y)) > 1e-6 * right * up) return std::nullopt;
  const double depth = glm::dot(axes.z, normal);
  StraightCamera result{glm::dmat4(glm::dvec4(-x / right, 0.0), glm::dvec4(y / up, 0.0),
                                   glm::dvec4(normal, 0.0), glm::dvec4(axes.origin, 1.0)),
                        window.placed(glm::dvec2(0.0), glm::dvec2(right, up)), depth};
  if (parallel) return result;
  const glm::dvec2 tilt(glm::dot(axes.z, x) / (right * right), glm::dot(axes.z, y) / (up * up));
  result.window = window.placed(tilt / tangent, tangent / depth * glm::dvec2(right, up));
  return result;
}

/// Makes the camera, as it was read, move. A stretch that grows changes lens, focus and an orthographic view
/// as linearly. `to_pbrt`: from our camera space to pbrt's.
void move_camera(Context& context, const TransformPair& keys, int node, const glm::dmat4& to_pbrt,
                 SourceLocation location) {
  const CameraSettings& shown = context.scene.camera;
  const auto wrong = [&](const char* message) { context.report.error(location, message); };
  MovingCamera moving{{node, to_pbrt}};
  glm::dvec3 sizes[2];
  for (int i = 0; i < 2; ++i) {
    const glm::dmat4& key = i == 0 ? keys.start : keys.end;
    if (!without_scale(key)) return wrong("the transform of a camera that moves must not shear its film");
    for (int axis = 0; axis < 3; ++axis) sizes[i][axis] = glm::length(glm::dvec3(key[axis]));
  }
  const bool parallel = shown.projection == Projection::kOrthographic;
  const auto same = [](double a, double b) { return std::abs(a - b) <= 1e-6 * std::abs(a); };
  if (!parallel && !(same(sizes[0].x / sizes[0].z, sizes[1].x / sizes[1].z) &&
                     same(sizes[0].y / sizes[0].z, sizes[1].y / sizes[1].z)))
    return wrong("the transform of a camera that moves must not change its angle of view");
  const auto& node_keys = context.motion.motion.nodes[std::size_t(node)].keys;
  const glm::dmat4 now = transform_at(*node_keys, context.motion.motion.default_time);
  const auto scaled = [&](double value, int axis, std::optional<KeyedValue<double>>& to) {
    if (same(sizes[0][axis], sizes[1][axis])) return;
    const double one = value / glm::length(glm::dvec3(now[axis]));
    to = KeyedValue<double>{.times = node_keys->translation.times,
                            .values = {one * sizes[0][axis], one * sizes[1][axis]}};
  };
  scaled(shown.aperture_radius, 0, moving.aperture_radius);
  scaled(shown.focus_distance, 2, moving.focus_distance);
  if (parallel) {
    scaled(shown.scale_x, 0, moving.scale_x);
    scaled(shown.scale_y, 1, moving.scale_y);
  }
  context.motion.motion.camera = std::move(moving);
}

/// A spherical camera, which sees all directions (SphericalCamera::GenerateRay in src/pbrt/cameras.cpp of
/// pbrt-v4). With x to the right, y up and z forwards, the left edge of its equirectangular image looks along
/// +x and the next quarter along +z, so that it is mirrored against a perspective one; the middle of its
/// equal-area image looks up, the right edge along +x and the lower edge along +z.
void read_spherical(Context& context, CameraDirective& camera, const TransformPair& keys,
                    const Placement& placed) {
  ReaderReport& report = context.report;
  Parameters& parameters = camera.parameters;
  CameraSettings& ours = context.scene.camera;
  const std::string mapping = parameters.text("mapping", "equalarea", report);
  if (mapping != "equalarea" && mapping != "equirectangular")
    return report.error(parameters.location("mapping", camera.location),
                        fmt::format("mapping must be equalarea or equirectangular, not '{}'", mapping));
  for (const glm::dmat4* key : {&keys.start, &keys.end, &placed.shown})
    if (!uniform_scale(*key))
      return report.error(camera.location, "the transform of a spherical camera must scale all axes alike");
  const bool angles = mapping == "equirectangular";
  ours.projection = angles ? Projection::kEquirectangular : Projection::kEqualArea;
  const glm::dmat4 to_pbrt(angles ? glm::dmat3(0, 0, 1, 0, 1, 0, -1, 0, 0)
                                  : glm::dmat3(-1, 0, 0, 0, 0, -1, 0, 1, 0));
  const auto frame = without_scale(placed.shown * to_pbrt);
  if (!frame) return report.error(camera.location, frame.error().message);
  ours.to_world = *frame;
  if (placed.node >= 0) move_camera(context, keys, placed.node, to_pbrt, camera.location);
  // pbrt reads these and has no use for them.
  parameters.accept({"lensradius", "focaldistance", "frameaspectratio", "screenwindow"});
  parameters.finish("the camera", report);
}

}  // namespace

void read_camera(Context& context, CameraDirective& camera) {
  ReaderReport& report = context.report;
  CameraSettings& ours = context.scene.camera;
  Parameters& parameters = camera.parameters;
  const SourceLocation location = camera.location;
  const auto& [at_start, at_end] = camera.camera_from_world;
  if (is_singular(at_start) || is_singular(at_end))
    return report.error(location, "the camera's transform flattens everything");
  const TransformPair keys{glm::inverse(at_start), glm::inverse(at_end)};
  const auto placed = context.motion.place(keys, location, report);
  if (!placed) return;
  ours.near_clip = 1e-2;
  ours.far_clip = 1e30;
  if (camera.type == "spherical") return read_spherical(context, camera, keys, *placed);
  const bool orthographic = camera.type == "orthographic";
  if (!orthographic && camera.type != "perspective")
    return report.unsupported(
        location,
        fmt::format("camera '{}' is not read; perspective, orthographic and spherical are", camera.type),
        "a perspective one stands in for it");
  const double fov = orthographic ? 90.0 : parameters.number("fov", 90.0, report);
  if (!(fov > 0.0 && fov < 180.0))
    return report.error(location, fmt::format("fov must be between 0 and 180, not {}", fov));
  const double lens = parameters.number("lensradius", 0.0, report),
               focus = parameters.number("focaldistance", 1e6, report);
  if (!(lens >= 0.0 && lens < 1e30 && focus > 0.0 && focus < 1e30))
    return report.error(parameters.location("lensradius", location),
                        "a lensradius is at least 0, a focaldistance above 0, and both are finite");
  const double pixels_aspect = double(context.scene.film.width) / context.scene.film.height;
  const auto window = screen_window(context, camera, pixels_aspect);
  if (!window) return;
  // The rays of pbrt's orthographic camera with a lens start from a lens at its origin, wherever they go
  // through the film: it is a perspective camera whose window is in the plane of focus.
  const bool parallel = orthographic && lens == 0.0;
  const double tangent = orthographic ? 1.0 / focus : std::tan(fov * std::numbers::pi / 360.0);
  const glm::dmat4& to_world = placed->shown;
  const CameraAxes axes{glm::dvec3(to_world[0]), glm::dvec3(to_world[1]), glm::dvec3(to_world[2]),
                        glm::dvec3(to_world[3])};
  const auto straight = straightened(axes, *window, parallel, tangent);
  if (!straight) return report.error(location, "the transform shears the camera's film");
  // pbrt's +x points to the right of the image.
  const glm::dmat4 to_pbrt = scaling(glm::dvec3(-1.0, 1.0, 1.0));
  const auto frame = without_scale(to_world * to_pbrt);
  ours.to_world = frame ? *frame : straight->to_world;
  const Window& seen = straight->window;
  const bool plain = !orthographic && !parameters.has("screenwindow") &&
                     !parameters.has("frameaspectratio") && uniform_scale(to_world);
  if (!plain) {
    // The distance of the film's centre from the optical axis.
    ours.principal_point_offset_x = 0.5 * (seen.x0 + seen.x1) / seen.width();
    ours.principal_point_offset_y = -0.5 * (seen.y0 + seen.y1) / seen.height();
  }
  const double pixel_aspect = seen.height() / seen.width() * pixels_aspect;
  if (plain) {
    ours.fov = fov;
    ours.fov_axis = FovAxis::kSmaller;
  } else if (parallel) {
    ours.projection = Projection::kOrthographic;
    ours.scale_x = 0.5 * seen.width();
    ours.scale_y = 0.5 * seen.width() * pixel_aspect;
  } else {
    ours.fov = 2 * std::atan(0.5 * seen.width()) * 180.0 / std::numbers::pi;
    ours.fov_axis = FovAxis::kX;
    ours.pixel_aspect = pixel_aspect;
  }
  const double right = glm::length(axes.x), up = glm::length(axes.y);
  if (lens > 0.0 && std::abs(right - up) > 1e-6 * right)
    report.warn(location, "the transform makes the lens an ellipse; it is a disk as wide");
  ours.aperture_radius = lens * right;
  ours.focus_distance = focus * straight->depth;
  if (placed->node >= 0) move_camera(context, keys, placed->node, to_pbrt, location);
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

/// pbrt's ambient occlusion: white where nothing is near, black where the camera sees nothing.
void read_ambient_occlusion(Context& context, Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context.report;
  const double farthest = parameters.number("maxdistance", 0.0, report);
  if (!(farthest > 0.0 || !parameters.has("maxdistance")))
    return report.error(parameters.location("maxdistance", location), "maxdistance must be above 0");
  set(context, "integrator.ray_length", farthest, location);
  set(context, "integrator.background", 0.0, location);
  set(context, "integrator.occlusion_sampling",
      parameters.boolean("cossample", true, report) ? "cosine" : "hemisphere", location);
  if (context.exposure() != 1.0)
    report.warn(location, "ambient occlusion is as if the shutter were open for 1, and iso 100");
  parameters.finish("the integrator", report);
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
                                  {"lightpath", false},    {"randomwalk", false}, {kSppm, true, "ppm"},
                                  {kAmbient, true, "ao"}};
  ReaderReport& report = context.report;
  const auto* row = find_row(kRows, type, "integrator", "path stands in for it", location, report);
  set(context, "integrator.type", row != nullptr ? row->ours : "path_mis", location);
  if (row != nullptr && !row->same)
    report.warn(location, fmt::format("path stands in for the integrator '{}'", type));
  if (type == kAmbient) return read_ambient_occlusion(context, parameters, location);
  // pbrt counts the surfaces between light and camera; here it is the edges of the path.
  const std::int64_t depth = parameters.integer("maxdepth", 5, report);
  if (depth < 0)
    return report.error(parameters.location("maxdepth", location), "maxdepth must be at least 0");
  set(context, "integrator.max_depth", depth + 1, location);
  if (type == kSppm) read_progressive_photons(context, parameters, location);
  if (parameters.boolean("regularize", false, report))
    report.warn(parameters.location("regularize", location),
                "regularize is ignored: mirrors stay sharp after diffuse surfaces");
  parameters.accept({"lightsampler", "rrthreshold", "samplebsdf", "samplelights", "usemis",
                     "visualizestrategies", "visualizeweights", "bootstrapsamples", "chains",
                     "mutationsperpixel", "largestepprobability", "sigma"});
  parameters.finish("the integrator", report);
}

}  // namespace penumbra::pbrt
