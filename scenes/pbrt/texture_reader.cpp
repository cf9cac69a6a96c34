#include "scenes/pbrt/texture_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/packing.hpp>

#include "scenes/image/bitmap_values.h"
#include "scenes/names.h"
#include "scenes/number.h"
#include "scenes/pbrt/light_strength.h"
#include "scenes/transform.h"

namespace penumbra::pbrt {
namespace {

/// v counts from the bottom of pbrt's images, but from the top of ours.
const glm::dmat3 kFlip(glm::dvec3(1, 0, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 1, 1));

}  // namespace

int TextureReader::add(std::string name, TextureModel model, const glm::dmat3& to_uv) {
  context_.scene.textures.push_back({std::move(name), std::move(model), to_uv});
  return int(context_.scene.textures.size()) - 1;
}

int TextureReader::add_mapped(TextureModel model, const glm::dmat3& to_uv) {
  const int texture = add(name_, std::move(model), to_uv);
  if (mapping_) mappings_[texture] = *mapping_;
  return texture;
}

const TextureMapping* TextureReader::mapping_of(int texture) const {
  const auto found = mappings_.find(texture);
  return found == mappings_.end() ? nullptr : &found->second;
}

TextureValue TextureReader::placeholder(SourceLocation location, const std::string& message) {
  context_.report.unsupported(location, message, "a magenta checkerboard stands in for it");
  CheckerboardTexture board;
  board.color0 = kUnreadColour;
  return {glm::vec3(1.0f), add(name_, board)};
}

void TextureReader::read(const std::string& name, const std::string& kind, const std::string& type,
                         Parameters parameters, const glm::dmat4& ctm, SourceLocation location) {
  name_ = name;
  ctm_ = ctm;
  mapping_.reset();
  of_ = kind == "float" ? Of::kNumbers : Of::kColours;
  if (textures_.contains({name, of_}))
    context_.report.error(location, fmt::format("the {} texture '{}' is there twice", kind, name));
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
                                        {"directionmix", &TextureReader::direction_mix},
                                        {"checkerboard", &TextureReader::checkerboard},
                                        {"dots", &TextureReader::dots},
                                        {"bilerp", &TextureReader::bilerp},
                                        {"fbm", &TextureReader::fbm},
                                        {"wrinkled", &TextureReader::fbm},
                                        {"windy", &TextureReader::fbm}};
  for (const Reader& each : kReaders) {
    if (type != each.type) continue;
    textures_[{name, of_}] = (this->*each.read)(parameters, location);
    parameters.finish(fmt::format("the texture '{}'", name), context_.report);
    return;
  }
  if (type == "constant") {
    textures_[{name, of_}] = value(parameters, "value", 1.0);
    parameters.finish(fmt::format("the texture '{}'", name), context_.report);
    return;
  }
  std::vector<std::string> known = {"constant"};
  for (const Reader& each : kReaders) known.emplace_back(each.type);
  textures_[{name, of_}] =
      placeholder(location, fmt::format("the texture '{}' of type '{}' is not read; those that are: {}", name,
                                        type, list_names(known)));
}

glm::dmat3 TextureReader::mapping(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  const std::string kind = parameters.text("mapping", "uv", report);
  if (kind == "spherical" || kind == "cylindrical" || kind == "planar") {
    if (is_singular(ctm_)) {
      report.error(location, "the transform of this texture flattens it");
      return glm::dmat3(1.0);
    }
    mapping_ = {.kind = kind == "planar"        ? MappingKind::kPlanar
                        : kind == "cylindrical" ? MappingKind::kCylindrical
                                                : MappingKind::kSpherical,
                .to_texture = glm::inverse(ctm_)};
    if (kind != "planar") return glm::dmat3(1.0);
    mapping_->u_axis = parameters.point("v1", mapping_->u_axis, report);
    mapping_->v_axis = parameters.point("v2", mapping_->v_axis, report);
    mapping_->offset = {parameters.number("udelta", 0.0, report), parameters.number("vdelta", 0.0, report)};
    return glm::dmat3(1.0);
  }
  if (kind != "uv")
    report.unsupported(parameters.location("mapping", location),
                       fmt::format("the mapping '{}' is none of uv, spherical, cylindrical, planar", kind),
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
    context_.report.unsupported(location, entry.error().message, "a placeholder is shown");
    return std::nullopt;
  }
  for (const std::string& finding : describe(entry->findings, file, false))
    context_.report.warn(location, finding);
  return entry->bitmap;
}

std::optional<int> TextureReader::alpha_of(const std::string& file) {
  // pbrt drops the alpha of other files.
  if (const std::string kind = extension_of(file); kind != ".png" && kind != ".exr") return std::nullopt;
  const std::array<std::filesystem::path, 1> folders = {context_.folder};
  const auto path = context_.files.find(file, folders);
  if (!path) return std::nullopt;
  const auto entry = bitmaps_.read(*path, BitmapChannels::kAlpha);
  if (!entry) return std::nullopt;
  const Bitmap& alpha = bitmaps_.bitmap(entry->bitmap);
  const BitmapValues values(alpha, 1.0f);
  const std::size_t count = std::size_t(alpha.width) * std::size_t(alpha.height);
  for (std::size_t i = 0; i < count; ++i)
    if (values[i] != 1.0f) return entry->bitmap;
  return std::nullopt;
}

std::optional<int> TextureReader::mean_of(int bitmap, float gamma) {
  const auto [known, is_new] = means_.try_emplace({bitmap, gamma});
  if (!is_new) return known->second;
  const Bitmap& image = bitmaps_.bitmap(bitmap);
  const BitmapValues values(image, gamma);
  const std::size_t texels = std::size_t(image.width) * std::size_t(image.height);
  bool grey = true;
  for (std::size_t i = 0; i < 3 * texels && grey; i += 3)
    grey = values[i] == values[i + 1] && values[i] == values[i + 2];
  if (!grey) known->second = bitmaps_.add(channel_mean(image, gamma));
  return known->second;
}

std::optional<int> TextureReader::of_texels(int texture,
                                            const std::function<glm::dvec3(const glm::dvec3&)>& of) {
  name_ = context_.scene.textures[std::size_t(texture)].name;
  of_ = Of::kColours;
  const auto made = combined({TextureValue{glm::vec3(1.0f), texture}},
                             [&](std::span<const glm::dvec3> v) { return of(v[0]); });
  return made ? std::optional(made->texture) : std::nullopt;
}

int TextureReader::balanced(int light_image) {
  if (context_.balance == glm::dmat3(1.0)) return light_image;
  return of_texels(light_image,
                   [&](const glm::dvec3& texel) { return penumbra::pbrt::balanced(context_, texel); })
      .value_or(light_image);
}

std::optional<int> TextureReader::product(int light_image, int alpha) {
  if (light_image == kNoTexture) return alpha;
  const auto [known, is_new] = products_.try_emplace({light_image, alpha});
  if (!is_new) return known->second;
  name_ = context_.scene.textures[std::size_t(alpha)].name;
  of_ = Of::kColours;
  const auto made = combined(
      {TextureValue{glm::vec3(1.0f), light_image}, TextureValue{glm::vec3(1.0f), alpha}},
      [](std::span<const glm::dvec3> v) { return v[0] * glm::clamp(v[1], 0.0, 1.0); }, true);
  if (made) known->second = made->texture;
  return known->second;
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
  // In pbrt the directive's encoding is that of PNG files alone. Other files of bytes have sRGB values.
  const std::string extension = extension_of(model.filename);
  const bool has_floats = extension == ".exr" || extension == ".pfm" || extension == ".hdr";
  const SourceLocation encoding_at = parameters.location("encoding", location);
  const bool is_ignored = parameters.has("encoding") && extension != ".png";
  const std::string given = parameters.text("encoding", "sRGB", report);
  const std::string own = has_floats ? "linear" : "sRGB", encoding = extension == ".png" ? given : own;
  if (is_ignored && given != own)
    report.warn(encoding_at, fmt::format("the encoding '{}' is ignored, as in pbrt: that of {} files is {}",
                                         given, extension, own));
  if (encoding == "linear") {
    model.gamma = 1.0f;
    model.raw = true;
  } else if (encoding.starts_with("gamma ")) {
    const auto gamma = parse_number(std::string_view(encoding).substr(6));
    if (gamma && *gamma > 0.0 && *gamma < 100.0)
      model.gamma = float(*gamma);
    else
      report.error(encoding_at, fmt::format("'{}' is no gamma", encoding));
  } else if (encoding != "sRGB") {
    report.error(encoding_at, fmt::format("the encoding '{}' is none of sRGB, linear, gamma x", encoding));
  }
  if (parameters.text("filter", "bilinear", report) == "point") model.filter = BitmapFilter::kNearest;
  parameters.accept({"maxanisotropy"});
  const bool inverted = parameters.boolean("invert", false, report);
  const double scale = parameters.number("scale", 1.0, report);
  if (!(std::abs(scale) < 1e30)) report.error(location, "a scale must be finite");
  if (model.filename.empty()) {
    report.error(location, "an imagemap needs a \"string filename\"");
    return {};
  }
  const auto index = bitmap(model.filename, parameters.location("filename", location));
  if (!index) return {glm::vec3(0.5f)};
  model.bitmap = *index;
  if (of_ == Of::kNumbers && bitmaps_.bitmap(*index).channels == 3) {
    if (const auto alpha = alpha_of(model.filename)) {
      model.bitmap = *alpha;
    } else if (const auto mean = mean_of(*index, model.gamma)) {
      model.bitmap = *mean;
      model.gamma = 1.0f;
      model.raw = true;
    }
  }
  const TextureValue image{glm::vec3(1.0f), add_mapped(model, to_uv)};
  if (inverted)
    return combined({image}, [&](std::span<const glm::dvec3> v) { return glm::max(1.0 - scale * v[0], 0.0); })
        .value();
  return scale == 1.0 ? image : TextureValue{glm::vec3(1.0f), scaled(image.texture, glm::vec3(float(scale)))};
}

TextureValue TextureReader::value(Parameters& parameters, std::string_view name, double fallback, Of of) {
  Parameter* parameter = parameters.take(name);
  if (parameter == nullptr) return {glm::vec3(float(fallback))};
  ReaderReport& report = context_.report;
  if (parameter->type == "texture") {
    const std::string wanted = parameter->texts.empty() ? "" : parameter->texts[0];
    for (const Of kind : {of, of == Of::kNumbers ? Of::kColours : Of::kNumbers})
      if (const auto found = textures_.find({wanted, kind}); found != textures_.end()) return found->second;
    std::vector<std::string> known;
    for (const auto& [each, ignored] : textures_) known.push_back(each.first);
    report.error(parameter->location,
                 fmt::format("there is no texture '{}'{}", wanted, known_names(wanted, known, "There are")));
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

int TextureReader::scaled(int texture, const glm::vec3& factor) {
  return add(context_.scene.textures[std::size_t(texture)].name, ScaleTexture{factor, texture});
}

TextureValue TextureReader::scale(Parameters& parameters, SourceLocation location) {
  const TextureValue a = value(parameters, "tex", 1.0), b = value(parameters, "scale", 1.0, Of::kNumbers);
  if (a.texture == kNoTexture && b.texture == kNoTexture) return {a.value * b.value};
  if (a.texture != kNoTexture && b.texture != kNoTexture) {
    if (const auto product = combined({a, b}, [](std::span<const glm::dvec3> v) { return v[0] * v[1]; }))
      return *product;
    context_.report.unsupported(
        location, "the product of two textures that are no images, or mapped otherwise, is not read",
        "the first stands for it");
    return a;
  }
  const glm::vec3 factor = a.texture == kNoTexture ? a.value : b.value;
  return {glm::vec3(1.0f), scaled(a.texture == kNoTexture ? b.texture : a.texture, factor)};
}

TextureValue TextureReader::mix(Parameters& parameters, SourceLocation location) {
  const TextureValue a = value(parameters, "tex1", 0.0), b = value(parameters, "tex2", 1.0);
  const TextureValue amount = value(parameters, "amount", 0.5, Of::kNumbers);
  if (amount.texture == kNoTexture && amount.value.x == 0.0f) return a;
  if (amount.texture == kNoTexture && amount.value.x == 1.0f) return b;
  if (const auto mixture = combined({a, b, amount}, [](std::span<const glm::dvec3> v) {
        const double share = (v[2].x + v[2].y + v[2].z) / 3;
        return glm::mix(v[0], v[1], share);
      }))
    return *mixture;
  context_.report.unsupported(location,
                              "a mixture of textures that are no images, or mapped otherwise, is not read",
                              "the first stands for it");
  return a;
}

TextureValue TextureReader::direction_mix(Parameters& parameters, SourceLocation location) {
  const TextureValue a = value(parameters, "tex1", 0.0), b = value(parameters, "tex2", 1.0);
  parameters.accept({"dir"});
  context_.report.unsupported(location, "textures that are mixed by directions are not read",
                              "the second stands for it");
  return a.texture == kNoTexture && a.value == b.value ? a : b;
}

TextureValue TextureReader::dots(Parameters& parameters, SourceLocation location) {
  const TextureValue inside = value(parameters, "inside", 1.0), outside = value(parameters, "outside", 0.0);
  static_cast<void>(mapping(parameters, location));
  context_.report.unsupported(location, "textures of dots are not read", "what is outside of them is shown");
  return inside.texture == kNoTexture && inside.value == outside.value ? inside : outside;
}

/// An image that is linear between its four corners.
TextureValue TextureReader::bilerp(Parameters& parameters, SourceLocation location) {
  const TextureValue corners[] = {value(parameters, "v00", 0.0), value(parameters, "v01", 1.0),
                                  value(parameters, "v10", 0.0), value(parameters, "v11", 1.0)};
  constexpr int kSide = 64;
  std::vector<float> values;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const float u = float(x) / (kSide - 1), v = 1.0f - float(y) / (kSide - 1);
      const glm::vec3 at = glm::mix(glm::mix(corners[0].value, corners[2].value, u),
                                    glm::mix(corners[1].value, corners[3].value, u), v);
      for (int c = 0; c < 3; ++c) values.push_back(at[c]);
    }
  for (const TextureValue& corner : corners)
    if (corner.texture != kNoTexture)
      context_.report.error(location, "the corners of a bilerp are no textures");
  const int image = made_image(name_, float_bitmap(name_, kSide, kSide, 3, values));
  context_.scene.textures[std::size_t(image)].to_uv = kFlip * mapping(parameters, location);
  if (mapping_) mappings_[image] = *mapping_;
  return {glm::vec3(1.0f), image};
}

/// pbrt's noise is a function of positions, ours of texture coordinates.
TextureValue TextureReader::fbm(Parameters& parameters, SourceLocation location) {
  context_.report.unsupported(location, "noise in space is not read", "its mean stands for it");
  parameters.accept({"octaves", "roughness"});
  return {glm::vec3(0.5f)};
}

TextureValue TextureReader::checkerboard(Parameters& parameters, SourceLocation location) {
  if (parameters.integer("dimension", 2, context_.report) != 2)
    return placeholder(location, "checkerboards in space are not read");
  const TextureValue a = value(parameters, "tex1", 1.0), b = value(parameters, "tex2", 0.0);
  CheckerboardTexture board;
  board.color0 = TexturedColour(a.value);
  board.color0.texture = a.texture;
  board.color1 = TexturedColour(b.value);
  board.color1.texture = b.texture;
  // pbrt's squares have unit size, ours half of it.
  const glm::dmat3 half(glm::dvec3(0.5, 0, 0), glm::dvec3(0, 0.5, 0), glm::dvec3(0, 0, 1));
  return {glm::vec3(1.0f), add_mapped(board, half * mapping(parameters, location))};
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
  const TextureValue found = value(parameters, name, 1.0, Of::kColours);
  TexturedColour colour(use == ColourOf::kReflectance ? glm::clamp(found.value, 0.0f, 1.0f) : found.value);
  colour.texture = found.texture;
  return colour;
}

TexturedNumber TextureReader::number(Parameters& parameters, std::string_view name, double fallback,
                                     double low, double high) {
  const TextureValue found = value(parameters, name, fallback, Of::kNumbers);
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

std::optional<int> TextureReader::light_image(const std::string& file, SourceLocation location) {
  BitmapTexture model;
  model.filename = file;
  const auto index = bitmap(file, location);
  if (!index) return std::nullopt;
  model.bitmap = *index;
  model.wrap = model.wrap_u = model.wrap_v = WRAP_CLAMP;
  return add(file, model, kFlip);
}

int TextureReader::made_image(const std::string& name, Bitmap bitmap) {
  BitmapTexture model;
  model.filename = name;
  model.gamma = 1.0f;
  model.wrap = model.wrap_u = model.wrap_v = WRAP_CLAMP;
  model.bitmap = bitmaps_.add(std::move(bitmap));
  return add(name, model);
}

const Bitmap& TextureReader::bitmap_of(int texture) const {
  return bitmaps_.bitmap(std::get<BitmapTexture>(context_.scene.textures[std::size_t(texture)].model).bitmap);
}

std::optional<TextureValue> TextureReader::combined(
    std::initializer_list<TextureValue> values,
    const std::function<glm::dvec3(std::span<const glm::dvec3>)>& of, bool any_wrap) {
  struct Source {
    glm::dvec3 factor;
    std::optional<BitmapValues> texels = std::nullopt;
    int width = 1, height = 1, channels = 0;
  };
  std::vector<Source> sources;
  const BitmapTexture* first = nullptr;
  const TextureMapping* mapping = nullptr;
  glm::dmat3 to_uv(1.0);
  int width = 1, height = 1;
  for (const TextureValue& value : values) {
    Source source{glm::dvec3(value.value)};
    int texture = value.texture;
    while (texture != kNoTexture) {
      const SceneTexture& each = context_.scene.textures[std::size_t(texture)];
      if (const auto* scale = std::get_if<ScaleTexture>(&each.model)) {
        source.factor *= glm::dvec3(scale->scale.value);
        texture = scale->texture;
        continue;
      }
      const auto* image = std::get_if<BitmapTexture>(&each.model);
      if (image == nullptr) return std::nullopt;
      const TextureMapping* own = mapping_of(texture);
      const bool alike = mapping == own || (mapping != nullptr && own != nullptr && *mapping == *own);
      if (first != nullptr && (each.to_uv != to_uv || (!any_wrap && image->wrap != first->wrap) || !alike))
        return std::nullopt;
      first = image;
      mapping = own;
      to_uv = each.to_uv;
      const Bitmap& bitmap = bitmaps_.bitmap(image->bitmap);
      source.texels.emplace(bitmap, image->gamma);
      source.width = bitmap.width;
      source.height = bitmap.height;
      source.channels = bitmap.channels;
      width = std::max(width, bitmap.width);
      height = std::max(height, bitmap.height);
      break;
    }
    sources.push_back(std::move(source));
  }
  std::vector<glm::dvec3> at(sources.size());
  const auto read = [&](int x, int y) {
    for (std::size_t i = 0; i < sources.size(); ++i) {
      const Source& source = sources[i];
      at[i] = source.factor;
      if (!source.texels) continue;
      // The texel nearest to the centre of this one.
      const auto column = std::size_t((2 * std::int64_t(x) + 1) * source.width / (2 * width)),
                 row = std::size_t((2 * std::int64_t(y) + 1) * source.height / (2 * height));
      const std::size_t texel = (row * std::size_t(source.width) + column) * std::size_t(source.channels);
      for (int c = 0; c < 3; ++c)
        at[i][c] *= double((*source.texels)[texel + std::size_t(std::min(c, source.channels - 1))]);
    }
    return of(at);
  };
  if (first == nullptr) return TextureValue{glm::vec3(read(0, 0))};
  const int channels = of_ == Of::kNumbers ? 1 : 3;
  Bitmap bitmap{name_, width, height, channels, TexelType::kHalf, {}};
  const std::size_t count = std::size_t(width) * std::size_t(height) * std::size_t(channels);
  bitmap.words.resize((count + 1) / 2);
  std::size_t k = 0;
  const auto put = [&](double value) {
    bitmap.words[k / 2] |= std::uint32_t(glm::packHalf1x16(float(std::min(value, 65504.0)))) << (k % 2 * 16);
    ++k;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::dvec3 value = read(x, y);
      if (channels == 1)
        put((value.x + value.y + value.z) / 3);
      else
        for (int c = 0; c < 3; ++c) put(value[c]);
    }
  BitmapTexture model = *first;
  model.gamma = 1.0f;
  model.bitmap = bitmaps_.add(std::move(bitmap));
  const TextureValue result{glm::vec3(1.0f), add(name_, model, to_uv)};
  if (mapping != nullptr) mappings_[result.texture] = TextureMapping(*mapping);
  return result;
}

std::optional<int> TextureReader::square_root(int texture) {
  const auto [known, is_new] = square_roots_.try_emplace(texture);
  if (!is_new) return known->second;
  name_ = context_.scene.textures[std::size_t(texture)].name;
  of_ = Of::kNumbers;
  if (const auto root = combined({TextureValue{glm::vec3(1.0f), texture}}, [](std::span<const glm::dvec3> v) {
        return glm::dvec3(std::sqrt(std::max(0.0, (v[0].x + v[0].y + v[0].z) / 3)));
      }))
    return known->second = root->texture;
  const SceneTexture& given = context_.scene.textures[std::size_t(texture)];
  const auto* board = std::get_if<CheckerboardTexture>(&given.model);
  if (board == nullptr || board->color0.texture != kNoTexture || board->color1.texture != kNoTexture)
    return std::nullopt;
  CheckerboardTexture root = *board;
  root.color0.value = glm::sqrt(board->color0.value);
  root.color1.value = glm::sqrt(board->color1.value);
  const TextureMapping* mapping = mapping_of(texture);
  known->second = add(name_, root, glm::dmat3(given.to_uv));
  if (mapping != nullptr) mappings_[*known->second] = TextureMapping(*mapping);
  return known->second;
}

}  // namespace penumbra::pbrt
