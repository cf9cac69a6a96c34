#include "scenes/setting_rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "scenes/number.h"
#include "scenes/transform.h"

namespace penumbra {
namespace {

using S = RenderSettings;

// Far beyond any use; it prevents an overflow of the radius.
constexpr float kMaxStddev = 1024.0f;
constexpr float kGaussianRadius = 4.0f;  // in standard deviations
constexpr float kMaxRadius = kGaussianRadius * kMaxStddev;
// Far less than a pixel, but its square does not underflow.
constexpr float kMinRadius = 1e-4f;

/// A crop window that covered the whole film is resized with the film.
void resize(int& size, int& crop_offset, int& crop_size, int new_size) {
  if (crop_offset == 0 && crop_size == size) crop_size = new_size;
  size = new_size;
}

void use_filter(Film& film, FilterKind kind) {
  const float radii[] = {0.5f, 1.0f, kGaussianRadius * film.filter_stddev, 2.0f, 3.0f};
  film.filter = kind;
  film.filter_radius = radii[int(kind)];
}

/// The matrix without its scale; unchanged if it has none.
Expected<glm::dmat4> frame_of(const glm::dmat4& matrix) {
  if (is_singular(matrix)) return fail("the matrix is singular");
  auto rigid = without_scale(matrix);
  if (!rigid) return rigid;
  constexpr double kRounding = 1e-15;
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3 given(matrix[axis]);
    if (std::abs(glm::dot(given, given) - 1.0) < kRounding) (*rigid)[axis] = matrix[axis];
  }
  return rigid;
}

/// Settings of the image file. They are recorded only if they differ from the defaults.
void add_file_rows(std::vector<Setting>& table) {
  using enum ExrCompression;
  const auto add = [&](const char* key, const auto& values, auto member, const char* description) {
    table.push_back(member_row(key, values, &S::film, member, description));
    table.back().matters = [=](const S& s) { return s.film.*member != Film{}.*member; };
  };
  add("film.pixel_format", OneOf<bool>{{{"rgb", false}, {"rgba", true}}}, &Film::alpha,
      "channels of the image; rgba has alpha, the share of a pixel's samples that met a surface or a visible "
      "sky");
  add("film.denoise",
      OneOf<Denoise>{{{"off", Denoise::kOff},
                      {"layers", Denoise::kLayers},
                      {"nlmeans", Denoise::kNlMeans},
                      {"nfor", Denoise::kNfor},
                      {"oidn", Denoise::kOidn}}},
      &Film::denoise,
      "denoised image beside the image, and the layers that this needs; layers: these alone, for penumbra "
      "denoise");
  add("film.layers",
      SomeOf<AskedLayer>{{{"position", AskedLayer::kPosition},
                          {"uv", AskedLayer::kUv},
                          {"geometric_normal", AskedLayer::kGeometricNormal},
                          {"shape", AskedLayer::kShape},
                          {"direct", AskedLayer::kDirect},
                          {"indirect", AskedLayer::kIndirect},
                          {"motion", AskedLayer::kMotion}}},
      &Film::layers,
      "further layers of the image: where camera rays hit, texture coordinates and geometric normal there, "
      "the shape's ID; light of at most one bounce, and all other; how many pixels away the frame before, "
      "and the next one, show what is seen");
  add("film.component_format", OneOf<bool>{{{"float32", false}, {"float16", true}}}, &Film::half,
      "precision of an EXR's colours and normals; variance, depth and counts keep 32 bits");
  add("film.compression",
      OneOf<ExrCompression>{{{"none", kNone},
                             {"rle", kRle},
                             {"zips", kZips},
                             {"zip", kZip},
                             {"piz", kPiz},
                             {"pxr24", kPxr24},
                             {"b44", kB44},
                             {"b44a", kB44a},
                             {"dwaa", kDwaa},
                             {"dwab", kDwab}}},
      &Film::compression, "compression of an EXR; lossy from pxr24 on");
}

/// A setting of several numbers from which `make` computes the camera's frame.
template <typename Make>
Setting frame_row(std::string key, std::size_t count, Make make, std::string description) {
  Setting setting{.key = std::move(key),
                  .kind = SettingKind::kText,
                  .values = fmt::format("{} numbers", count),
                  .description = std::move(description)};
  setting.apply = [=](RenderSettings& settings, std::string_view text) -> Expected<void> {
    const auto numbers = parse_numbers(text);
    if (!numbers) return std::unexpected(numbers.error());
    if (numbers->size() != count)
      return fail(fmt::format("it takes {} numbers, not {}", count, numbers->size()));
    const Expected<glm::dmat4> matrix = make(*numbers);
    if (!matrix) return std::unexpected(matrix.error());
    const auto frame = frame_of(*matrix);
    if (!frame) return std::unexpected(frame.error());
    settings.camera.to_world = *frame;
    return {};
  };
  return setting;
}

std::string print_rows(const glm::dmat4& matrix) {
  std::vector<double> numbers;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k) numbers.push_back(matrix[k][i]);
  return fmt::format("{}", fmt::join(numbers, " "));
}

}  // namespace

Setting setting_of(std::string key, const ValueFormat& format, std::string description) {
  return {.key = std::move(key),
          .kind = format.kind,
          .values = format.values,
          .description = std::move(description),
          .choices = format.choices};
}

Setting stored_row(std::string key, ValueFormat format, std::function<void*(RenderSettings&)> place,
                   std::string description) {
  Setting setting = setting_of(std::move(key), format, std::move(description));
  setting.print = [print = std::move(format.print), place](const RenderSettings& settings) {
    return print(place(const_cast<RenderSettings&>(settings)));  // which print does not change
  };
  setting.apply = [read = std::move(format.read), place = std::move(place)](RenderSettings& settings,
                                                                            std::string_view text) {
    return read(text, place(settings));
  };
  return setting;
}

void add_sampler_rows(std::vector<Setting>& table) {
  using enum SamplerKind;
  const std::size_t first = table.size();
  table.push_back(member_row("sampler.type",
                             OneOf<SamplerKind>{{{"independent", kIndependent},
                                                 {"stratified", kStratified},
                                                 {"halton", kHalton},
                                                 {"sobol", kSobol}}},
                             &S::sampler, &SamplerSettings::kind, "sampler"));
  table.back().option = "sampler";
  table.push_back(member_row("sampler.sample_count", WholeNumber{1, kMaxSamplesPerPixel}, &S::sampler,
                             &SamplerSettings::spp, "samples per pixel"));
  table.back().option = "spp";
  table.push_back(member_row("sampler.seed", WholeNumber{0, kMaxSeed}, &S::sampler, &SamplerSettings::seed,
                             "seed of all random numbers"));
  table.back().option = "seed";
  for (std::size_t i = first; i < table.size(); ++i) table[i].recorded = true;
}

void add_film_rows(std::vector<Setting>& table) {
  using enum FilterKind;
  table.push_back(row(
      "film.width", WholeNumber{1, kMaxFilmSide}, [](const S& s) { return s.film.width; },
      [](S& s, std::int64_t v) { resize(s.film.width, s.film.crop_x, s.film.crop_width, int(v)); },
      "width of the film in pixels; a crop window of the whole film stays so"));
  table.push_back(row(
      "film.height", WholeNumber{1, kMaxFilmSide}, [](const S& s) { return s.film.height; },
      [](S& s, std::int64_t v) { resize(s.film.height, s.film.crop_y, s.film.crop_height, int(v)); },
      "height of the film in pixels"));
  const auto crop = [&](const char* key, int low, int Film::*member, const char* description) {
    table.push_back(member_row(key, WholeNumber{low, kMaxFilmSide}, &S::film, member, description));
  };
  crop("film.crop_offset_x", 0, &Film::crop_x, "left edge of the crop window");
  crop("film.crop_offset_y", 0, &Film::crop_y, "upper edge of the crop window");
  crop("film.crop_width", 1, &Film::crop_width, "width of the crop window");
  crop("film.crop_height", 1, &Film::crop_height, "height of the crop window");

  const std::size_t first = table.size();
  table.push_back(row(
      "film.rfilter",
      OneOf<FilterKind>{{{"box", kBox},
                         {"tent", kTent},
                         {"gaussian", kGaussian},
                         {"mitchell", kMitchell},
                         {"lanczos", kLanczos}}},
      [](const S& s) { return s.film.filter; }, [](S& s, FilterKind kind) { use_filter(s.film, kind); },
      "reconstruction filter, with its own radius"));
  const auto only = [&](FilterKind kind) {
    table.back().matters = [=](const S& s) { return s.film.filter == kind; };
  };
  table.push_back(row(
      "film.rfilter_stddev", Number<float>{LowEnd::kClosed, kMinRadius, kMaxStddev},
      [](const S& s) { return s.film.filter_stddev; },
      [](S& s, float v) {
        s.film.filter_stddev = v;
        if (s.film.filter == kGaussian) use_filter(s.film, kGaussian);
      },
      "standard deviation of the Gaussian filter in pixels; its radius becomes four times that"));
  only(kGaussian);
  table.push_back(member_row("film.rfilter_radius", Number<float>{LowEnd::kClosed, kMinRadius, kMaxRadius},
                             &S::film, &Film::filter_radius, "half-width of the filter in pixels"));
  table.push_back(member_row("film.rfilter_b", Number<float>{LowEnd::kClosed, -10.0f, 10.0f}, &S::film,
                             &Film::filter_b, "B of the Mitchell filter"));
  only(kMitchell);
  table.push_back(member_row("film.rfilter_c", Number<float>{LowEnd::kClosed, -10.0f, 10.0f}, &S::film,
                             &Film::filter_c, "C of the Mitchell filter"));
  only(kMitchell);
  table.push_back(member_row(
      "film.light_edges", OneOf<bool>{{{"closed_form", true}, {"sampled", false}}}, &S::film,
      &Film::closed_light_edges,
      "edges of visible lights; closed_form is without noise where that is possible, and has the same mean"));
  table.back().matters = [](const S& s) { return !s.film.closed_light_edges; };
  add_file_rows(table);
  for (std::size_t i = first; i < table.size(); ++i) table[i].recorded = true;
}

void add_camera_rows(std::vector<Setting>& table) {
  camera_parameters([&](const char* name, auto member, const auto& values, const char* description, auto...) {
    table.push_back(member_row(fmt::format("camera.{}", name), values, &S::camera, member, description));
  });
  table.push_back(frame_row(
      "camera.to_world", 16, [](const std::vector<double>& v) { return matrix_from_rows(v); },
      "camera to world, by rows; its scale has no effect"));
  table.back().print = [](const S& s) { return print_rows(s.camera.to_world); };
  table.push_back(frame_row(
      "camera.lookat", 9,
      [](const std::vector<double>& v) {
        return look_at({v[0], v[1], v[2]}, {v[3], v[4], v[5]}, glm::dvec3(v[6], v[7], v[8]));
      },
      "camera.to_world by origin, target and up"));
}

}  // namespace penumbra
