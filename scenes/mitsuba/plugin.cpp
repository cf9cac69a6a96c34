#include "scenes/mitsuba/plugin.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/mitsuba/spectrum_reader.h"
#include "scenes/mitsuba/texture_reader.h"
#include "scenes/mitsuba/volume_reader.h"
#include "scenes/names.h"
#include "scenes/settings.h"
#include "scenes/transform.h"

namespace penumbra::mitsuba {

namespace {

ColourRole role_of(const ColourWithin& values) {
  return values.high <= 1.0f ? ColourRole::kReflectance : ColourRole::kEmission;
}

}  // namespace

Object* Context::resolve(const Child& child) const {
  if (child.object != nullptr) return child.object;
  const auto found = tree.by_id.find(child.reference);
  if (found != tree.by_id.end()) return found->second;
  if (diagnostics.full()) return nullptr;
  std::vector<std::string> known;
  for (const auto& [id, object] : tree.by_id) known.push_back(id);
  const std::string hint = suggestion(child.reference, known);
  diagnostics.error(child.location,
                    fmt::format("there is no object with the id '{}'{}", child.reference, hint));
  return nullptr;
}

void Context::unknown_plugin(const Object& object, std::span<const std::string> known,
                             std::string_view instead) const {
  const std::string what =
      fmt::format("{} type '{}' is not one that Penumbra reads", object.tag, object.type);
  const std::string hint = suggestion(object.type, known);
  const std::string reads = fmt::format("{} it reads: {}", hint.empty() ? ";" : hint, list_names(known));
  if (lenient) {
    diagnostics.warn(object.type_location, fmt::format("{}; {}", what, instead));
  } else {
    diagnostics.error(object.type_location, what + reads);
  }
}

void Context::unsupported(SourceLocation location, std::string_view what, std::string_view instead) const {
  if (lenient)
    diagnostics.warn(location, fmt::format("{}; {}", what, instead));
  else
    diagnostics.error(location, what);
}

void Context::tolerable(SourceLocation location, std::string_view what, std::string_view instead,
                        std::string_view hint) const {
  if (is_tolerant())
    diagnostics.warn_counted(location, fmt::format("{}; {}", what, instead));
  else
    diagnostics.error(location, fmt::format("{}{}", what, hint));
}

bool Context::is_replaced(std::string_view key) const {
  return std::ranges::any_of(settings, [&](const auto& each) { return to_snake_case(each.first) == key; });
}

std::vector<std::filesystem::path> Context::folders(const Object& object) const {
  std::vector<std::filesystem::path> result = {object.location.file->path.parent_path()};
  result.insert(result.end(), tree.folders.begin(), tree.folders.end());
  return result;
}

PluginReader::PluginReader(const Context& context, const Object& object)
    : context_(context), object_(object), taken_(object.parameters.size(), false) {
  for (const Child& child : object.children) {
    if (const Object* nested = context.resolve(child)) {
      nested_.push_back({nested, child.name, child.location});
    }
  }
}

std::string PluginReader::title() const {
  return object_.tag == "scene" ? "the scene" : fmt::format("{} '{}'", object_.tag, object_.type);
}

bool PluginReader::has(std::string_view name) const {
  return std::any_of(object_.parameters.begin(), object_.parameters.end(),
                     [&](const Parameter& p) { return p.name == name; });
}

bool PluginReader::has_nested(std::string_view name) const {
  return std::any_of(nested_.begin(), nested_.end(), [&](const Nested& n) { return n.name == name; });
}

const Parameter* PluginReader::take(std::string_view name) {
  known_.emplace_back(name);
  for (std::size_t i = 0; i < object_.parameters.size(); ++i) {
    if (object_.parameters[i].name == name) {
      taken_[i] = true;
      return &object_.parameters[i];
    }
  }
  return nullptr;
}

void PluginReader::wrong_kind(const Parameter& parameter, std::string_view wanted) const {
  context_.diagnostics.error(parameter.location,
                             fmt::format("the parameter '{}' of {} must be a {}, not a <{}>", parameter.name,
                                         title(), wanted, parameter.tag));
}

template <typename T>
const T* PluginReader::take_as(std::string_view name, std::string_view wanted) {
  const Parameter* parameter = take(name);
  if (parameter == nullptr) return nullptr;
  const T* value = std::get_if<T>(&parameter->value);
  if (value == nullptr) wrong_kind(*parameter, wanted);
  return value;
}

double PluginReader::number(std::string_view name, double fallback) {
  const Parameter* parameter = take(name);
  if (parameter == nullptr) return fallback;
  if (const auto* value = std::get_if<double>(&parameter->value)) return *value;
  if (const auto* value = std::get_if<std::int64_t>(&parameter->value)) return double(*value);
  wrong_kind(*parameter, "<float>");
  return fallback;
}

bool PluginReader::boolean(std::string_view name, bool fallback) {
  const bool* value = take_as<bool>(name, "<boolean>");
  return value != nullptr ? *value : fallback;
}

std::string PluginReader::text(std::string_view name, std::string_view fallback) {
  const std::string* value = take_as<std::string>(name, "<string>");
  return value != nullptr ? *value : std::string(fallback);
}

std::optional<glm::dvec3> PluginReader::point(std::string_view name) {
  const glm::dvec3* value = take_as<glm::dvec3>(name, "<point>");
  return value != nullptr ? std::optional(*value) : std::nullopt;
}

glm::dmat4 PluginReader::transform(std::string_view name) {
  const glm::dmat4* value = take_as<glm::dmat4>(name, "<transform>");
  return value != nullptr ? *value : glm::dmat4(1.0);
}

const Object* PluginReader::colour_plugin(std::string_view name) {
  for (Nested& each : nested_) {
    const std::string& tag = each.object->tag;
    if (each.name != name || (tag != "texture" && tag != "spectrum" && tag != "blackbody")) continue;
    each.taken = true;
    return each.object;
  }
  return nullptr;
}

std::optional<glm::vec3> PluginReader::colour_of(const Parameter& parameter, ColourRole role) const {
  if (const auto* rgb = std::get_if<RgbValue>(&parameter.value)) return rgb->rgb;
  if (const auto* grey = std::get_if<double>(&parameter.value)) return glm::vec3(*grey);
  if (const auto* grey = std::get_if<std::int64_t>(&parameter.value)) return glm::vec3(float(*grey));
  const auto* spectrum = std::get_if<SpectrumValue>(&parameter.value);
  if (spectrum == nullptr) {
    wrong_kind(parameter, "colour, such as <rgb>");
    return std::nullopt;
  }
  if (spectrum->samples.empty() && spectrum->filename.empty())
    return role == ColourRole::kEmission ? emission_to_rgb(spectrum->constant)
                                         : glm::vec3(float(spectrum->constant));
  std::vector<SpectrumSample> samples = spectrum->samples;
  if (!spectrum->filename.empty()) {
    auto read = spectrum_of_file(parameter, spectrum->filename);
    if (!read) return std::nullopt;
    samples = std::move(*read);
  }
  const Expected<glm::vec3> rgb = table_to_rgb(samples, role);
  if (rgb) return *rgb;
  wrong(parameter.name, rgb.error().message);
  return std::nullopt;
}

std::optional<std::vector<SpectrumSample>> PluginReader::spectrum_of_file(const Parameter& parameter,
                                                                          const std::string& filename) const {
  const auto wrong_file = [&](const std::string& message) {
    wrong(parameter.name, message);
    return std::nullopt;
  };
  if (context_.files == nullptr) return wrong_file("no files are read here");
  const auto path = context_.files->find(filename, context_.folders(object_));
  if (!path) return wrong_file(path.error().message);
  const auto file = context_.files->read(*path, kMaxSpectrumFileBytes);
  if (!file) return wrong_file(file.error().message);
  auto samples = read_spectrum_file(**file);
  if (samples) return *samples;
  context_.diagnostics.error_text(
      fmt::format("{}\n  (which is named at {})", samples.error().message, describe(parameter.location)));
  return std::nullopt;
}

std::optional<float> PluginReader::number_of_colour(std::string_view name) {
  bool there = false;
  for (const Nested& each : nested_) there = there || (each.name == name && each.object->tag == "spectrum");
  for (const Parameter& each : object_.parameters)
    if (each.name == name)
      there = there || std::holds_alternative<RgbValue>(each.value) ||
              std::holds_alternative<SpectrumValue>(each.value);
  if (!there) return std::nullopt;
  glm::vec3 rgb(0.0f);
  read_colour(name, rgb, ColourRole::kIndex);
  return (rgb.x + rgb.y + rgb.z) / 3.0f;
}

void PluginReader::read_colour(std::string_view name, glm::vec3& colour, ColourRole role) {
  const Parameter* parameter = take(name);
  if (const Object* plugin = colour_plugin(name)) {
    if (parameter != nullptr)
      wrong(name, fmt::format("'{}' is there twice, once as <{}>", name, plugin->tag));
    if (plugin->tag == "texture") {
      const std::string what = fmt::format("'{}' of {} takes no texture", name, title());
      if (context_.lenient)
        context_.diagnostics.warn(plugin->location, what + "; a plain magenta stands in for it");
      else
        context_.diagnostics.error(plugin->location, what + ", only a colour: rgb, srgb, spectrum");
    } else if (const auto rgb = read_spectrum_plugin(context_, *plugin, role)) {
      return set_colour(name, *rgb, colour, role);
    }
    colour = kPlaceholderColour;
    return;
  }
  if (parameter == nullptr) return;
  if (const auto rgb = colour_of(*parameter, role)) set_colour(name, *rgb, colour, role);
}

/// Corrects invalid colours as Mitsuba 0.x does: reflectances above 1 are scaled down, and negative numbers
/// become 0.
glm::vec3 PluginReader::tolerated(std::string_view name, glm::vec3 rgb, ColourRole role) const {
  if (!context_.is_tolerant() || !(std::isfinite(rgb.x) && std::isfinite(rgb.y) && std::isfinite(rgb.z)))
    return rgb;
  if (std::min({rgb.x, rgb.y, rgb.z}) < 0.0f) {
    context_.tolerable(location_of(name), fmt::format("{} of {} is negative", name, title()),
                       "0 stands in for it");
    rgb = glm::max(rgb, 0.0f);
  }
  if (const float most = std::max({rgb.x, rgb.y, rgb.z}); role == ColourRole::kReflectance && most > 1.0f) {
    context_.tolerable(location_of(name), fmt::format("{} of {} is above 1", name, title()),
                       "it is scaled down to that");
    rgb /= most;
  }
  return rgb;
}

void PluginReader::set_colour(std::string_view name, const glm::vec3& given, glm::vec3& colour,
                              ColourRole role) const {
  const glm::vec3 rgb = tolerated(name, given, role);
  for (int i = 0; i < 3; ++i) {
    const float value = rgb[i];
    if (role == ColourRole::kReflectance && !(value >= 0.0f && value <= 1.0f)) {
      return wrong_value(name, fmt::format("a reflectance must be between 0 and 1, not {}", value));
    }
    if (role == ColourRole::kEmission && !(value >= 0.0f && std::isfinite(value))) {
      return wrong_value(name, fmt::format("an emission must be 0 or more and finite, not {}", value));
    }
  }
  colour = rgb;
}

std::shared_ptr<const Bitmap> PluginReader::read_image(const std::string& filename) {
  return context_.textures != nullptr ? context_.textures->read_image(*this, filename) : nullptr;
}

PluginReader::TakenTexture PluginReader::take_texture(std::string_view name, TextureUse use) {
  for (Nested& each : nested_) {
    if (each.name != name || each.object->tag != "texture") continue;
    each.taken = true;
    if (has(name)) wrong(name, fmt::format("'{}' is there twice, once as <texture>", name));
    return {true, context_.textures != nullptr ? context_.textures->read(*each.object, use) : std::nullopt};
  }
  return {};
}

void PluginReader::read_textured(std::string_view name, TexturedColour& colour, ColourRole role,
                                 const auto& values) {
  if (const TakenTexture texture = take_texture(name, TextureUse::kColour); texture.there) {
    skip_parameter(name);
    colour = glm::vec3(1.0f);
    colour.texture = texture.index.value_or(kNoTexture);
    return;
  }
  read_plain(name, colour.value, role, values);
}

void PluginReader::read_plain(std::string_view name, glm::vec3& colour, ColourRole role, const auto& values) {
  glm::vec3 rgb = colour;
  read_colour(name, rgb, role);
  for (int i = 0; i < 3; ++i)
    if (!values.contains(rgb[i]))
      return wrong_value(name, fmt::format("{} must be a {}, not {}", name, values.values(), rgb[i]));
  colour = rgb;
}

void PluginReader::read(std::string_view name, glm::vec3& colour, const ColourWithin& values) {
  read_plain(name, colour, role_of(values), values);
}

void PluginReader::read(std::string_view name, glm::vec3& colour, const VolumeColour& values) {
  read_volume(name, colour, nullptr, values);
}

void PluginReader::read(std::string_view name, GriddedColour& colour, const VolumeColour& values) {
  read_volume(name, colour.value, &colour, values);
}

void PluginReader::read_volume(std::string_view name, glm::vec3& colour, GriddedColour* grid,
                               const VolumeColour& values) {
  const ColourRole role = values.is_emission    ? ColourRole::kEmission
                          : values.high <= 1.0f ? ColourRole::kReflectance
                                                : ColourRole::kIndex;
  static const std::vector<std::string> kVolumes = {"constvolume", GridVolumeParameters::kPlugin};
  for (Nested& each : nested_) {
    if (each.name != name || each.object->tag != "volume") continue;
    each.taken = true;
    skip_parameter(name);
    if (has(name)) wrong(name, fmt::format("'{}' is there twice, once as <volume>", name));
    if (each.object->type == kVolumes[1]) {
      if (grid == nullptr)
        return context_.unsupported(
            each.location, fmt::format("'{}' of {} takes no grid, only a constvolume", name, title()),
            "a default stands in for it");
      colour = glm::vec3(1.0f);
      grid->grid = context_.volumes->read(context_, *each.object, name, values);
      return;
    }
    if (each.object->type != kVolumes[0])
      return context_.unknown_plugin(*each.object, kVolumes, "a default stands in for it");
    PluginReader volume(context_, *each.object);
    colour = glm::vec3(1.0f);
    volume.read_plain("value", colour, role, values);
    if (grid != nullptr) grid->to_world = volume.transform("to_world");
    volume.accept({"to_world"});
    return volume.finish();
  }
  read_plain(name, colour, role, values);
}

void PluginReader::read(std::string_view name, glm::dvec3& value, AnyPoint) {
  value = point(name).value_or(value);
}

void PluginReader::read(std::string_view name, std::string& value, AnyText) { value = text(name, value); }

void PluginReader::read(std::string_view name, double& value, AnyNumber) { value = number(name, value); }

void PluginReader::read(std::string_view name, glm::dmat4& value, AnyTransform) {
  if (has(name))
    value = transform(name);
  else
    skip_parameter(name);
}

void PluginReader::read(std::string_view name, TexturedColour& colour, const ColourWithin& values) {
  read_textured(name, colour, role_of(values), values);
}

void PluginReader::read(std::string_view name, TexturedColour& colour, const IndexColour& values) {
  read_textured(name, colour, ColourRole::kIndex, values);
}

void PluginReader::read(std::string_view name, float& index, const RefractiveIndex& values) {
  const Parameter* parameter = take(name);
  if (parameter == nullptr) return;
  if (std::holds_alternative<std::string>(parameter->value)) {
    const Expected<float> known = values.parse(std::get<std::string>(parameter->value));
    if (known) index = *known;
    if (!known) wrong(name, fmt::format("{}: {}", name, known.error().message));
    return;
  }
  const auto value = float(number(name, double(index)));
  if (!values.contains(value))
    return wrong_value(name, fmt::format("{} must be a {}, not {}", name, values.values(), value));
  index = value;
}

void PluginReader::read(std::string_view name, TexturedNumber& number, const NumberWithin& values) {
  if (const TakenTexture texture = take_texture(name, TextureUse::kNumber); texture.there) {
    skip_parameter(name);
    number = 1.0f;
    number.texture = texture.index.value_or(kNoTexture);
    return;
  }
  const auto grey = number_of_colour(name);
  if (!grey) return read(name, number.value, values);
  if (!values.contains(*grey))
    return wrong_value(name, fmt::format("{} must be a {}, not {}", name, values.values(), *grey));
  number = *grey;
}

void PluginReader::read(std::string_view name, float& number, const NumberWithin& values) {
  const auto value = float(this->number(name, double(number)));
  if (!values.contains(value))
    return wrong_value(name, fmt::format("{} must be a {}, not {}", name, values.values(), value));
  number = value;
}

void PluginReader::read(std::string_view name, bool& value, const TrueOrFalse&) {
  value = boolean(name, value);
}

void PluginReader::read(std::string_view name, std::string& value, FileName) { value = text(name, value); }

void PluginReader::read(std::string_view name, std::int64_t& value, const WholeNumber& values) {
  const auto* given = take_as<std::int64_t>(name, "<integer>");
  if (given == nullptr) return;
  if (*given < values.low || *given > values.high)
    return wrong_value(name, fmt::format("{} must be a {}, not {}", name, values.values(), *given));
  value = *given;
}

void PluginReader::report(const Findings& findings) const {
  for (const Finding& finding : findings) {
    if (finding.is_warning)
      warn(finding.message);
    else if (finding.parameter.empty())
      wrong(finding.message);
    else
      wrong(finding.parameter, finding.message);
  }
}

void PluginReader::settings(SceneDescription& scene, std::string_view group,
                            std::span<const std::string> names, std::string_view prefix) {
  for (const Setting& setting : all_settings()) {
    for (const std::string& name : names) {
      if (setting.key != fmt::format("{}.{}{}", group, prefix, name)) continue;
      const Parameter* parameter = take(name);
      if (parameter == nullptr || context_.is_replaced(setting.key)) continue;
      const bool is_integer = std::holds_alternative<std::int64_t>(parameter->value);
      const bool is_number = is_integer || std::holds_alternative<double>(parameter->value);
      const bool is_text = std::holds_alternative<std::string>(parameter->value);
      switch (setting.kind) {
        case SettingKind::kInteger:
          if (!is_integer) return wrong_kind(*parameter, "<integer>");
          break;
        case SettingKind::kNumber:
          if (!is_number) return wrong_kind(*parameter, "<float>");
          break;
        case SettingKind::kBoolean:
          if (!std::holds_alternative<bool>(parameter->value)) return wrong_kind(*parameter, "<boolean>");
          break;
        case SettingKind::kText:
          if (!is_text) return wrong_kind(*parameter, "<string>");
          break;
        case SettingKind::kNumberOrText:
          if (!is_number && !is_text) return wrong_kind(*parameter, "<float> or <string>");
          break;
      }
      if (const auto done = setting.apply(scene, parameter->text); !done) {
        wrong_value(name, fmt::format("{}: {}", name, done.error().message));
      }
    }
  }
}

void PluginReader::accept(std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) take(name);
}

std::vector<const Object*> PluginReader::nested(std::string_view tag) {
  std::vector<const Object*> found;
  for (Nested& each : nested_) {
    if (each.object->tag != tag) continue;
    each.taken = true;
    found.push_back(each.object);
  }
  return found;
}

std::vector<std::pair<std::string, const Object*>> PluginReader::named(std::string_view tag) {
  std::vector<std::pair<std::string, const Object*>> found;
  for (Nested& each : nested_) {
    if (each.object->tag != tag) continue;
    each.taken = true;
    found.emplace_back(each.name, each.object);
  }
  return found;
}

const Object* PluginReader::only_nested(std::string_view tag) {
  const std::vector<const Object*> found = nested(tag);
  if (found.size() > 1) {
    const auto second =
        std::find_if(nested_.begin(), nested_.end(), [&](const Nested& n) { return n.object == found[1]; });
    context_.unsupported(second->location,
                         fmt::format("{} has {} of <{}>; it takes one", title(), found.size(), tag),
                         "the first counts");
  }
  return found.empty() ? nullptr : found.front();
}

void PluginReader::finish() {
  if (finished_) return;
  finished_ = true;
  for (std::size_t i = 0; i < object_.parameters.size(); ++i) {
    if (taken_[i]) continue;
    const Parameter& parameter = object_.parameters[i];
    context_.tolerable(parameter.location, fmt::format("{} has no parameter '{}'", title(), parameter.name),
                       "it is ignored", known_names(parameter.name, known_, "It has"));
  }
  for (const Nested& each : nested_) {
    if (each.taken) continue;
    context_.tolerable(
        each.location,
        fmt::format("{} cannot hold {} <{}> of type '{}'{}", title(),
                    each.object->tag == "emitter" || each.object->tag == "integrator" ? "an" : "a",
                    each.object->tag, each.object->type,
                    each.name.empty() ? "" : fmt::format(" named '{}'", each.name)),
        "it is ignored");
  }
}

SourceLocation PluginReader::location_of(std::string_view parameter) const {
  const auto found = std::ranges::find(object_.parameters, parameter, &Parameter::name);
  return found != object_.parameters.end() ? found->value_location : object_.location;
}

void PluginReader::wrong(std::string_view parameter, std::string_view message) const {
  context_.diagnostics.error(location_of(parameter), message);
}

void PluginReader::wrong_value(std::string_view name, std::string_view message) const {
  context_.unsupported(location_of(name), message, "its default stands in for it");
}

std::string name_of(const Object& object) {
  return object.id.empty() ? fmt::format("{} at {}", object.type, describe(object.location)) : object.id;
}

void PluginReader::wrong(std::string_view message) const {
  context_.diagnostics.error(object_.location, message);
}

void PluginReader::warn(std::string_view message) const {
  context_.diagnostics.warn(object_.location, fmt::format("{}: {}", title(), message));
}

}  // namespace penumbra::mitsuba
