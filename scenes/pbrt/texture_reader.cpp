#include "scenes/pbrt/texture_reader.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "scenes/number.h"

namespace penumbra::pbrt {
namespace {

/// v counts from the bottom of pbrt's images and from the top of ours.
const glm::dmat3 kFlip(glm::dvec3(1, 0, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 1, 1));

}  // namespace

int TextureReader::add(std::string name, TextureModel model, const glm::dmat3& to_uv) {
  context_.scene.textures.push_back({std::move(name), std::move(model), to_uv});
  return int(context_.scene.textures.size()) - 1;
}

TextureValue TextureReader::stand_in(SourceLocation location, const std::string& message) {
  context_.report.unsupported(location, message, "a magenta checkerboard stands in for it");
  CheckerboardTexture board;
  board.color0 = kUnreadColour;
  return {glm::vec3(1.0f), add(name_, board)};
}

void TextureReader::read(const std::string& name, const std::string& kind, const std::string& type,
                         Parameters parameters, SourceLocation location) {
  name_ = name;
  if (kind != "float" && kind != "spectrum" && kind != "color")
    context_.report.error(location,
                          fmt::format("a texture is of \"float\" or \"spectrum\", not \"{}\"", kind));
  struct Reader {
    const char* type;
    TextureValue (TextureReader::*read)(Parameters&, SourceLocation);
  };
  static constexpr Reader kReaders[] = {{"imagemap", &TextureReader::imagemap},
                                        {"scale", &TextureReader::scale},
                                        {"mix", &TextureReader::mix},
                                        {"checkerboard", &TextureReader::checkerboard}};
  for (const Reader& each : kReaders) {
    if (type != each.type) continue;
    textures_[name] = (this->*each.read)(parameters, location);
    parameters.finish(fmt::format("the texture '{}'", name), context_.report);
    return;
  }
  if (type == "constant") {
    textures_[name] = value(parameters, "value", 1.0);
    parameters.finish(fmt::format("the texture '{}'", name), context_.report);
    return;
  }
  const std::vector<std::string> known = {"constant", "imagemap", "scale", "mix", "checkerboard"};
  textures_[name] =
      stand_in(location, fmt::format("the texture '{}' of type '{}' is not read; those that are: {}", name,
                                     type, list_names(known)));
}

glm::dmat3 TextureReader::mapping(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  if (const std::string kind = parameters.text("mapping", "uv", report); kind != "uv")
    report.unsupported(parameters.location("mapping", location),
                       fmt::format("textures mapped by '{}' are not read; 'uv' are", kind),
                       "it is mapped by uv");
  const double su = parameters.number("uscale", 1.0, report), sv = parameters.number("vscale", 1.0, report);
  const double du = parameters.number("udelta", 0.0, report), dv = parameters.number("vdelta", 0.0, report);
  for (const double x : {su, sv, du, dv})
    if (!(std::abs(x) < 1e30)) report.error(location, "the mapping is not finite");
  return glm::dmat3(glm::dvec3(su, 0, 0), glm::dvec3(0, sv, 0), glm::dvec3(du, dv, 1));
}

std::optional<int> TextureReader::bitmap(const std::string& file, SourceLocation location) {
  const std::array<std::filesystem::path, 1> folders = {context_.folder};
  const auto path = context_.files.find(file, folders);
  const auto entry = path ? bitmaps_.read(*path, BitmapChannels::kAll) : std::unexpected(path.error());
  if (!entry) {
    context_.report.unsupported(location, entry.error().message, "a stand-in is shown");
    return std::nullopt;
  }
  for (const std::string& finding : describe(entry->findings, file, false))
    context_.report.warn(location, finding);
  return entry->bitmap;
}

std::shared_ptr<const Bitmap> TextureReader::image(const std::string& file, SourceLocation location) {
  const auto index = bitmap(file, location);
  return index ? bitmaps_.shared(*index) : nullptr;
}

TextureValue TextureReader::imagemap(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  BitmapTexture model;
  model.filename = parameters.text("filename", "", report);
  const glm::dmat3 to_uv = kFlip * mapping(parameters, location);
  const std::string wrap = parameters.text("wrap", "repeat", report);
  model.wrap = wrap == "black" ? WRAP_ZERO : wrap == "clamp" ? WRAP_CLAMP : WRAP_REPEAT;
  if (wrap != "black" && wrap != "clamp" && wrap != "repeat")
    report.unsupported(parameters.location("wrap", location),
                       fmt::format("'{}' is no wrap that is read", wrap), "it is repeated");
  model.wrap_u = model.wrap_v = model.wrap;
  const std::string encoding = parameters.text("encoding", "sRGB", report);
  if (encoding == "linear") {
    model.gamma = 1.0f;
    model.raw = true;
  } else if (encoding.starts_with("gamma ")) {
    const auto gamma = parse_number(std::string_view(encoding).substr(6));
    if (gamma && *gamma > 0.0 && *gamma < 100.0)
      model.gamma = float(*gamma);
    else
      report.error(parameters.location("encoding", location), fmt::format("'{}' is no gamma", encoding));
  } else if (encoding != "sRGB") {
    report.error(parameters.location("encoding", location),
                 fmt::format("the encoding '{}' is none of sRGB, linear, gamma x", encoding));
  }
  if (parameters.text("filter", "bilinear", report) == "point") model.filter = BitmapFilter::kNearest;
  parameters.accept({"maxanisotropy"});
  if (parameters.boolean("invert", false, report))
    report.unsupported(parameters.location("invert", location), "inverted textures are not read",
                       "it is not inverted");
  const double scale = parameters.number("scale", 1.0, report);
  if (!(scale >= 0.0 && scale < 1e30)) report.error(location, "a scale must be at least 0");
  if (model.filename.empty()) {
    report.error(location, "an imagemap needs a \"string filename\"");
    return {};
  }
  const auto index = bitmap(model.filename, parameters.location("filename", location));
  if (!index) return {glm::vec3(0.5f)};
  model.bitmap = *index;
  int texture = add(name_, model, to_uv);
  if (scale != 1.0) texture = add(name_, ScaleTexture{glm::vec3(float(scale)), texture});
  return {glm::vec3(1.0f), texture};
}

TextureValue TextureReader::value(Parameters& parameters, std::string_view name, double fallback) {
  Parameter* parameter = parameters.take(name);
  if (parameter == nullptr) return {glm::vec3(float(fallback))};
  ReaderReport& report = context_.report;
  if (parameter->type == "texture") {
    const auto found = parameter->texts.size() == 1 ? textures_.find(parameter->texts[0]) : textures_.end();
    if (found != textures_.end()) return found->second;
    std::vector<std::string> known;
    for (const auto& [each, ignored] : textures_) known.push_back(each);
    const std::string wanted = parameter->texts.empty() ? "" : parameter->texts[0];
    report.error(parameter->location, fmt::format("there is no texture '{}' before this{}", wanted,
                                                  known_names(wanted, known, "There are")));
    return {};
  }
  if (parameter->type == "float") {
    if (parameter->numbers.size() == 1 && std::abs(parameter->numbers[0]) < 1e30)
      return {glm::vec3(float(parameter->numbers[0]))};
    report.error(parameter->location, fmt::format("'{}' is one number", name));
    return {};
  }
  const auto colour = colour_of(*parameter, ColourOf::kIndex, context_.files, context_.folder, report);
  return {colour.value_or(glm::vec3(1.0f))};
}

TextureValue TextureReader::scale(Parameters& parameters, SourceLocation location) {
  const TextureValue a = value(parameters, "tex", 1.0), b = value(parameters, "scale", 1.0);
  if (a.texture != kNoTexture && b.texture != kNoTexture) {
    context_.report.unsupported(location, "the product of two images is not read", "the first stands for it");
    return a;
  }
  const glm::vec3 factor = a.texture == kNoTexture ? a.value : b.value;
  const TextureValue& other = a.texture == kNoTexture ? b : a;
  if (other.texture == kNoTexture) return {a.value * b.value};
  return {glm::vec3(1.0f), add(name_, ScaleTexture{factor, other.texture})};
}

TextureValue TextureReader::mix(Parameters& parameters, SourceLocation location) {
  const TextureValue a = value(parameters, "tex1", 0.0), b = value(parameters, "tex2", 1.0);
  const TextureValue amount = value(parameters, "amount", 0.5);
  if (a.texture == kNoTexture && b.texture == kNoTexture && amount.texture == kNoTexture)
    return {glm::mix(a.value, b.value, amount.value)};
  context_.report.unsupported(location, "mixtures of images are not read; those of colours are",
                              "the first stands for it");
  return a;
}

TextureValue TextureReader::checkerboard(Parameters& parameters, SourceLocation location) {
  if (parameters.integer("dimension", 2, context_.report) != 2)
    return stand_in(location, "checkerboards in space are not read");
  const TextureValue a = value(parameters, "tex1", 1.0), b = value(parameters, "tex2", 0.0);
  CheckerboardTexture board;
  board.color0 = TexturedColour(a.value);
  board.color0.texture = a.texture;
  board.color1 = TexturedColour(b.value);
  board.color1.texture = b.texture;
  // pbrt's squares are of unit size, ours half of it.
  const glm::dmat3 half(glm::dvec3(0.5, 0, 0), glm::dvec3(0, 0.5, 0), glm::dvec3(0, 0, 1));
  return {glm::vec3(1.0f), add(name_, board, half * mapping(parameters, location))};
}

TexturedColour TextureReader::colour(Parameters& parameters, std::string_view name, ColourOf use,
                                     const glm::vec3& fallback) {
  const Parameter* given = parameters.find(name);
  if (given == nullptr) return TexturedColour(fallback);
  if (given->type != "texture") {
    parameters.take(name);
    return TexturedColour(
        colour_of(*given, use, context_.files, context_.folder, context_.report).value_or(fallback));
  }
  const TextureValue found = value(parameters, name, 1.0);
  TexturedColour colour(use == ColourOf::kReflectance ? glm::clamp(found.value, 0.0f, 1.0f) : found.value);
  colour.texture = found.texture;
  return colour;
}

TexturedNumber TextureReader::number(Parameters& parameters, std::string_view name, double fallback,
                                     double low, double high) {
  const TextureValue found = value(parameters, name, fallback);
  const double x = double(found.value.x);
  if (!(x >= low && x <= high))
    context_.report.error(parameters.location(name, {}),
                          fmt::format("'{}' must be in [{}, {}], not {}", name, low, high, x));
  TexturedNumber number(found.value.x);
  number.texture = found.texture;
  return number;
}

std::optional<int> TextureReader::normal_map(const std::string& file, SourceLocation location) {
  BitmapTexture model;
  model.filename = file;
  model.gamma = 1.0f;
  model.raw = true;
  const auto index = bitmap(file, location);
  if (!index) return std::nullopt;
  model.bitmap = *index;
  return add(file, model, kFlip);
}

}  // namespace penumbra::pbrt
