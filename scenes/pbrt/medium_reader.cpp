#include "scenes/pbrt/medium_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/pbrt/light_strength.h"
#include "scenes/pbrt/medium_grids.h"
#include "scenes/pbrt/state.h"
#include "scenes/scattering.h"
#include "scenes/spectrum.h"
#include "scenes/transform.h"
#include "scenes/volume_file.h"

namespace penumbra::pbrt {
namespace {

constexpr std::size_t kMostCells = std::size_t{1} << 28;

glm::vec3 share_of(const glm::vec3& part, const glm::vec3& whole) {
  glm::vec3 share(0.0f);
  for (int c = 0; c < 3; ++c) share[c] = whole[c] > 0.0f ? part[c] / whole[c] : 0.0f;
  return share;
}

}  // namespace

void MediumReader::make(const std::string& name, Parameters& parameters, const GraphicsState& state,
                        SourceLocation location) {
  ReaderReport& report = context_.report;
  struct Row {
    const char* type;
    Medium (MediumReader::*read)(Parameters&, const GraphicsState&, SourceLocation);
  };
  static constexpr Row kRows[] = {{"homogeneous", &MediumReader::homogeneous},
                                  {"uniformgrid", &MediumReader::uniform_grid},
                                  {"rgbgrid", &MediumReader::rgb_grid},
                                  {"nanovdb", &MediumReader::sparse_grid},
                                  {"cloud", &MediumReader::cloud}};
  const std::string type = parameters.text("type", "", report);
  const auto [entry, is_new] = media_.try_emplace(name);
  if (!is_new) return report.error(location, fmt::format("the medium '{}' is there twice", name));
  if (type.empty())
    return report.error(location, fmt::format("the medium '{}' needs a \"string type\"", name));
  const auto* row = find_row(kRows, type, "medium", "it is left out", location, report);
  if (row == nullptr) return;
  const double g = parameters.number("g", 0.0, report);
  if (!(std::abs(float(g)) < 1.0f))
    report.error(parameters.location("g", location), fmt::format("g must be in (-1, 1), not {}", g));
  Medium medium = (this->*row->read)(parameters, state, location);
  parameters.finish(fmt::format("the medium '{}'", name), report);
  if (!medium) return;
  medium->name = name;
  medium->phase = {{PHASE_HG, float(g), 1.0f}};
  entry->second.medium = std::move(medium);
}

int MediumReader::install(const std::string& name, SourceLocation location) {
  if (name.empty()) return kNoMedium;
  const auto found = media_.find(name);
  if (found == media_.end()) {
    std::vector<std::string> known;
    for (const auto& [each, ignored] : media_) known.push_back(each);
    context_.report.error(
        location, fmt::format("there is no medium '{}'{}", name, known_names(name, known, "There are")));
    return kNoMedium;
  }
  Entry& entry = found->second;
  if (entry.medium && entry.index == kNoMedium) {
    entry.index = int(context_.scene.media.size());
    context_.scene.media.push_back(*entry.medium);
  }
  return entry.index;
}

glm::vec3 MediumReader::coefficient(Parameters& parameters, const char* name, const glm::vec3& fallback) {
  const Parameter* given = parameters.take(name);
  if (given == nullptr) return fallback;
  return colour_of(*given, ColourOf::kIndex, context_.files, context_.folder, context_.report)
      .value_or(fallback);
}

double MediumReader::scale(Parameters& parameters, SourceLocation location) {
  const double scale = parameters.number("scale", 1.0, context_.report);
  if (scale >= 0.0 && scale < 1e30) return scale;
  context_.report.error(parameters.location("scale", location),
                        fmt::format("a medium's scale must be at least 0, not {}", scale));
  return 1.0;
}

/// `scattered` and `absorbed` are the defaults.
glm::vec3 MediumReader::read_coefficients(Parameters& parameters, const glm::vec3& scattered,
                                          const glm::vec3& absorbed, ParticipatingMedium& medium,
                                          SourceLocation location) {
  ReaderReport& report = context_.report;
  glm::vec3 sigma_s = scattered, sigma_a = absorbed;
  const std::string preset = parameters.text("preset", "", report);
  if (const auto known = scattering_of(preset)) {
    sigma_s = known->scattered;
    sigma_a = known->absorbed;
    parameters.accept({"sigma_s", "sigma_a"});
  } else {
    if (!preset.empty())
      report.unsupported(parameters.location("preset", location),
                         fmt::format("'{}' is no material whose scattering is known{}", preset,
                                     known_names(preset, scattering_names(), "Known are")),
                         "its coefficients are used");
    sigma_s = coefficient(parameters, "sigma_s", sigma_s);
    sigma_a = coefficient(parameters, "sigma_a", sigma_a);
  }
  const auto factor = float(scale(parameters, location));
  medium.extinction = factor * (sigma_s + sigma_a);
  medium.albedo = share_of(sigma_s, sigma_s + sigma_a);
  for (int c = 0; c < 3; ++c)
    if (!std::isfinite(medium.extinction[c])) {
      report.error(location, "the extinction of this medium is too large for a number");
      break;
    }
  return factor * sigma_a;
}

/// A colour of emitted light as the film sees it.
glm::vec3 MediumReader::film_colour(const glm::vec3& colour) const {
  return glm::vec3(context_.exposure() * balanced(context_, glm::dvec3(colour)));
}

/// As of lights, spectra and black bodies have luminance 1.
glm::vec3 MediumReader::emitted_radiance(Parameters& parameters) {
  const Parameter* given = parameters.take("Le");
  if (given == nullptr) return glm::vec3(0.0f);
  return film_colour(colour_of(*given, ColourOf::kLight, context_.files, context_.folder, context_.report)
                         .value_or(glm::vec3(0.0f)));
}

double MediumReader::emission_scale(Parameters& parameters, SourceLocation location) {
  double scale = 1.0;
  for (const char* name : {"Lescale", "LeScale"}) {
    if (!parameters.has(name)) continue;
    scale = parameters.number(name, 1.0, context_.report);
    if (scale >= 0.0 && scale < 1e30) continue;
    context_.report.error(parameters.location(name, location),
                          fmt::format("'{}' must be at least 0, not {}", name, scale));
    scale = 1.0;
  }
  return scale;
}

TemperatureScale MediumReader::temperature_scale(Parameters& parameters) {
  // The offset's older name is its default.
  const double cutoff = parameters.number("temperaturecutoff", 0.0, context_.report);
  return {.offset = parameters.number("temperatureoffset", cutoff, context_.report),
          .scale = parameters.number("temperaturescale", 1.0, context_.report)};
}

void MediumReader::set_emission(VolumeGrid colours, const glm::dmat4& place, bool by_density,
                                ParticipatingMedium& medium, SourceLocation location) {
  if (!std::ranges::all_of(colours.values, [](float value) { return std::isfinite(value); }))
    return context_.report.error(location, "the emission of this medium is too large for a number");
  if (std::ranges::all_of(colours.values, [](float value) { return value == 0.0f; })) return;
  medium.emission = glm::vec3(1.0f);
  medium.emission_grid = GridVolume{std::make_shared<const VolumeGrid>(std::move(colours)), place};
  medium.emission_by_density = by_density;
}

void MediumReader::read_emission(Parameters& parameters, const VolumeGrid& size, const glm::dmat4& place,
                                 const glm::vec3& absorbed, ParticipatingMedium& medium) {
  const SourceLocation location = parameters.location("temperature", parameters.location("Le", {}));
  const bool is_hot = parameters.has("temperature");
  if (is_hot && parameters.has("Le"))
    context_.report.error(location, "a uniformgrid has \"Le\" or \"temperature\", not both");
  const TemperatureScale kelvins = temperature_scale(parameters);
  const glm::vec3 radiance = emitted_radiance(parameters);
  // Without numbers, pbrt has a grid of one, which also fades towards the faces of the box.
  VolumeGrid strengths{1, 1, 1, 1, {1.0f}};
  if (parameters.has("Lescale")) {
    auto given = cells(parameters, "Lescale", "float", 1, size);
    if (!given) return;
    strengths = size;
    strengths.values = std::move(*given);
  }
  if (is_hot) {
    VolumeGrid temperatures = size;
    auto given = cells(parameters, "temperature", "float", 1, size);
    if (!given) return;
    temperatures.values = std::move(*given);
    return set_emission(black_body_grid(temperatures, kelvins, strengths, absorbed,
                                        [&](const glm::vec3& colour) { return film_colour(colour); }),
                        place, true, medium, location);
  }
  medium.emission = absorbed * radiance;
  for (int c = 0; c < 3; ++c)
    if (!std::isfinite(medium.emission[c]))
      return context_.report.error(location, "the emission of this medium is too large for a number");
  if (!medium.emits()) return;
  medium.emission_grid = GridVolume{
      .grid = std::make_shared<const VolumeGrid>(std::move(strengths)), .to_world = place, .fades = true};
  medium.emission_by_density = true;
}

MediumReader::Medium MediumReader::homogeneous(Parameters& parameters, const GraphicsState&,
                                               SourceLocation location) {
  ParticipatingMedium medium;
  const glm::vec3 absorbed =
      read_coefficients(parameters, glm::vec3(1.0f), glm::vec3(1.0f), medium, location);
  const SourceLocation place = parameters.location("Le", location);
  const glm::vec3 radiance = emitted_radiance(parameters);
  medium.emission = absorbed * radiance * float(emission_scale(parameters, location));
  for (int c = 0; c < 3; ++c)
    if (!std::isfinite(medium.emission[c]))
      context_.report.error(place, "the emission of this medium is too large for a number");
  return medium;
}

std::optional<VolumeGrid> MediumReader::grid_size(Parameters& parameters, SourceLocation location) {
  VolumeGrid grid;
  const std::array<std::pair<const char*, int*>, 3> sides = {
      {{"nx", &grid.nx}, {"ny", &grid.ny}, {"nz", &grid.nz}}};
  std::size_t cells = 1;
  for (const auto& [name, side] : sides) {
    const std::int64_t given = parameters.integer(name, 1, context_.report);
    if (given < 1 || std::size_t(given) > kMostCells || (cells *= std::size_t(given)) > kMostCells) {
      context_.report.error(parameters.location(name, location),
                            fmt::format("a grid has 1 to {} cells, nx ny nz", kMostCells));
      return std::nullopt;
    }
    *side = int(given);
  }
  return grid;
}

std::optional<glm::dmat4> MediumReader::grid_place(Parameters& parameters, const GraphicsState& state,
                                                   SourceLocation location) {
  const glm::dvec3 a = parameters.point("p0", glm::dvec3(0.0), context_.report),
                   b = parameters.point("p1", glm::dvec3(1.0), context_.report);
  const glm::dvec3 low = glm::min(a, b);
  const glm::dmat4 to_world = state.ctm.start * translation(low) * scaling(glm::max(a, b) - low);
  if (!is_singular(to_world)) return to_world;
  context_.report.error(location, "the box of this grid, from p0 to p1, is flat");
  return std::nullopt;
}

std::optional<std::vector<float>> MediumReader::cells(Parameters& parameters, const char* name,
                                                      const char* type, std::size_t channels,
                                                      const VolumeGrid& size) {
  ReaderReport& report = context_.report;
  const SourceLocation location = parameters.location(name, {});
  const std::vector<double> given = parameters.numbers(name, {type}, channels, report);
  const std::size_t wanted = std::size_t(size.nx) * std::size_t(size.ny) * std::size_t(size.nz) * channels;
  if (given.empty()) return std::nullopt;
  if (given.size() != wanted) {
    report.error(location,
                 fmt::format("'{}' has {} numbers; nx ny nz cells have {}", name, given.size(), wanted));
    return std::nullopt;
  }
  std::vector<float> values;
  values.reserve(given.size());
  for (const double value : given) {
    if (!(value >= 0.0 && value < 1e30)) {
      report.error(location, fmt::format("'{}' holds {}; numbers must be at least 0", name, value));
      return std::nullopt;
    }
    values.push_back(float(value));
  }
  return values;
}

MediumReader::Medium MediumReader::uniform_grid(Parameters& parameters, const GraphicsState& state,
                                                SourceLocation location) {
  ParticipatingMedium medium;
  const glm::vec3 absorbed =
      read_coefficients(parameters, glm::vec3(1.0f), glm::vec3(1.0f), medium, location);
  const auto size = grid_size(parameters, location);
  const auto place = grid_place(parameters, state, location);
  if (!size || !place) return std::nullopt;
  if (!parameters.has("density")) {
    context_.report.error(location, "a uniformgrid needs \"float density\"");
    return std::nullopt;
  }
  auto density = cells(parameters, "density", "float", 1, *size);
  if (!density) return std::nullopt;
  VolumeGrid grid = *size;
  grid.values = std::move(*density);
  medium.density = GridVolume{
      .grid = std::make_shared<const VolumeGrid>(std::move(grid)), .to_world = *place, .fades = true};
  read_emission(parameters, *size, *place, absorbed, medium);
  return medium;
}

/// The extinction and the albedo are separate grids.
MediumReader::Medium MediumReader::rgb_grid(Parameters& parameters, const GraphicsState& state,
                                            SourceLocation location) {
  ParticipatingMedium medium;
  const double factor = scale(parameters, location);
  const auto size = grid_size(parameters, location);
  const auto place = grid_place(parameters, state, location);
  if (!size || !place) return std::nullopt;
  const bool has_scattered = parameters.has("sigma_s"), has_absorbed = parameters.has("sigma_a");
  if (!has_scattered && !has_absorbed) {
    context_.report.error(location, "an rgbgrid needs \"rgb sigma_s\" or \"rgb sigma_a\"");
    return std::nullopt;
  }
  const int finer = refinement_of(*size);
  VolumeGrid extinction{finer * size->nx, finer * size->ny, finer * size->nz, 3, {}};
  const std::size_t count =
      3 * std::size_t(extinction.nx) * std::size_t(extinction.ny) * std::size_t(extinction.nz);
  // Missing coefficients are 1, up to the faces of the box.
  const auto coefficients = [&](const char* name, bool given) -> std::optional<std::vector<float>> {
    if (!given) return std::vector<float>(count, 1.0f);
    const auto coarse = cells(parameters, name, "rgb", 3, *size);
    if (!coarse) return std::nullopt;
    return refined(*coarse, *size, 3, finer);
  };
  const SourceLocation of_emission = parameters.location("Le", location);
  const bool emits = parameters.has("Le");
  if (emits && !has_absorbed)
    context_.report.error(of_emission, "an rgbgrid with \"rgb Le\" needs \"rgb sigma_a\"");
  const double strength = factor * emission_scale(parameters, location);
  const auto scattered = coefficients("sigma_s", has_scattered),
             absorbed = coefficients("sigma_a", has_absorbed), radiance = coefficients("Le", emits);
  if (!scattered || !absorbed || !radiance) return std::nullopt;
  VolumeGrid albedo = extinction;
  for (std::size_t i = 0; i < count; ++i) {
    const float sum = (*scattered)[i] + (*absorbed)[i];
    extinction.values.push_back(sum);
    albedo.values.push_back(sum > 0.0f ? (*scattered)[i] / sum : 0.0f);
  }
  medium.extinction = glm::vec3(float(factor));
  medium.albedo = glm::vec3(1.0f);
  medium.density = GridVolume{std::make_shared<const VolumeGrid>(std::move(extinction)), *place};
  medium.albedo_grid = GridVolume{std::make_shared<const VolumeGrid>(std::move(albedo)), *place};
  if (!emits) return medium;
  // Unlike a light's colour, these are not divided by the luminance of the illuminant that they multiply.
  const auto whole = float(strength * luminance_of_unit_power());
  VolumeGrid emission = *medium.density->grid;
  for (std::size_t i = 0; i < count; i += 3) {
    const glm::vec3 colour = film_colour({(*radiance)[i], (*radiance)[i + 1], (*radiance)[i + 2]});
    for (std::size_t c = 0; c < 3; ++c) emission.values[i + c] = whole * (*absorbed)[i + c] * colour[int(c)];
  }
  set_emission(std::move(emission), *place, false, medium, of_emission);
  return medium;
}

MediumReader::Medium MediumReader::cloud(Parameters& parameters, const GraphicsState& state,
                                         SourceLocation location) {
  ReaderReport& report = context_.report;
  ParticipatingMedium medium;
  read_coefficients(parameters, glm::vec3(1.0f), glm::vec3(1.0f), medium, location);
  const Cloud cloud{parameters.number("density", 1.0, report), parameters.number("wispiness", 1.0, report),
                    parameters.number("frequency", 5.0, report)};
  const glm::dvec3 a = parameters.point("p0", glm::dvec3(0.0), report),
                   b = parameters.point("p1", glm::dvec3(1.0), report);
  const auto place = grid_place(parameters, state, location);
  for (const double x : {cloud.density, cloud.wispiness, cloud.frequency})
    if (!(x >= 0.0 && x < 1e6)) {
      report.error(location, "density, wispiness and frequency of a cloud are at least 0");
      return std::nullopt;
    }
  const glm::dvec3 low = glm::min(a, b), high = glm::max(a, b);
  if (!place || !(std::max({std::abs(low.x), std::abs(low.y), std::abs(low.z), std::abs(high.x),
                            std::abs(high.y), std::abs(high.z)}) < 1e3)) {
    if (place) report.error(location, "the box of a cloud, p0 to p1, is within 1000 of the origin");
    return std::nullopt;
  }
  report.warn_counted(location, "clouds are of a noise of pbrt's kind, but other numbers, on a grid");
  medium.density = GridVolume{std::make_shared<const VolumeGrid>(cloud_grid(cloud, low, high)), *place};
  return medium;
}

/// Reads NanoVDB and OpenVDB files.
MediumReader::Medium MediumReader::sparse_grid(Parameters& parameters, const GraphicsState& state,
                                               SourceLocation location) {
  ReaderReport& report = context_.report;
  ParticipatingMedium medium;
  const glm::vec3 absorbed =
      read_coefficients(parameters, glm::vec3(1.0f), glm::vec3(1.0f), medium, location);
  const std::string name = parameters.text("filename", "", report);
  const std::string grid_name = parameters.text("gridname", "", report),
                    hot_name = parameters.text("temperaturename", "temperature", report);
  const TemperatureScale kelvins = temperature_scale(parameters);
  const double strength = emission_scale(parameters, location);
  const SourceLocation place = parameters.location("filename", location);
  if (name.empty()) {
    report.error(location, "a nanovdb medium needs a \"string filename\"");
    return std::nullopt;
  }
  const std::array<std::filesystem::path, 1> folders = {context_.folder};
  const auto path = context_.files.find(name, folders);
  const auto bytes =
      path ? context_.files.read_bytes(*path, kMaxVolumeFileBytes) : std::unexpected(path.error());
  if (!bytes) {
    report.error(place, bytes.error().message);
    return std::nullopt;
  }
  const auto placeholder = [&](const std::string& message) {
    report.unsupported(place, message, "a magenta fog stands in for it wherever the medium may be");
    medium.albedo = kUnreadColour;
    return medium;
  };
  auto file = grid_name.empty() ? read_volume_file(path->string(), *bytes)
                                : read_volume_grid(path->string(), *bytes, grid_name);
  if (!file) return placeholder(file.error().message);
  if (file->grid.values.empty()) return placeholder(fmt::format("'{}' has no grid '{}'", name, grid_name));
  for (const float value : file->grid.values)
    if (!(value >= 0.0f)) {
      report.error(place, fmt::format("'{}' holds {}; densities must be at least 0", name, value));
      return std::nullopt;
    }
  const auto box_of = [&](const VolumeFile& grid) {
    return state.ctm.start * translation(grid.low) * scaling(grid.high - grid.low);
  };
  if (is_singular(box_of(*file))) {
    report.error(place, fmt::format("the box of '{}' is flat", name));
    return std::nullopt;
  }
  medium.density = GridVolume{std::make_shared<const VolumeGrid>(std::move(file->grid)), box_of(*file)};
  if (strength == 0.0 || hot_name.empty()) return medium;
  const auto hot = read_volume_grid(path->string(), *bytes, hot_name);
  if (!hot) {
    report.unsupported(place, hot.error().message, "the medium does not shine");
    return medium;
  }
  if (hot->grid.values.empty() || hot->grid.channels != 1) {
    if (parameters.has("temperaturename") || !hot->grid.values.empty())
      report.warn(place, fmt::format("'{}' has no grid '{}' of one channel: the medium does not shine", name,
                                     hot_name));
    return medium;
  }
  set_emission(black_body_grid(hot->grid, kelvins, std::nullopt, float(strength) * absorbed,
                               [&](const glm::vec3& colour) { return film_colour(colour); }),
               box_of(*hot), true, medium, place);
  return medium;
}

}  // namespace penumbra::pbrt
