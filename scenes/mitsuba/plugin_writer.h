// Writes XML for Mitsuba 3: elements, and the parameters of plugins from their rows.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "scenes/mitsuba/texture_reader.h"
#include "scenes/motion/keyed_transform.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

inline std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

inline std::string texture_id(int index) { return fmt::format("texture-{}", index); }

/// XML text: one element per line, indented.
class XmlText {
 public:
  using PutTexture = std::function<void(int, TextureUse, std::string_view)>;
  /// Called for each plugin by tag and type, and for each of its parameters by name.
  using OnUse = std::function<void(std::string_view, std::string_view, std::string_view)>;
  explicit XmlText(PutTexture put_texture, OnUse on_use = {})
      : put_texture_(std::move(put_texture)), on_use_(std::move(on_use)) {}

  void open(std::string_view tag, std::string_view type, std::string_view attributes = "") {
    line(fmt::format("<{} type=\"{}\"{}>", tag, escaped(type), attributes));
    tags_.emplace_back(tag);
    types_.emplace_back(type);
    tell("");
  }
  void close() {
    const std::string tag = std::move(tags_.back());
    tags_.pop_back();
    types_.pop_back();
    line(fmt::format("</{}>", tag));
  }
  void value(std::string_view tag, std::string_view name, std::string_view text) {
    line(fmt::format("<{} name=\"{}\" value=\"{}\"/>", tag, name, escaped(text)));
    tell(name);
  }
  void reference(std::string_view id, std::string_view name = "") {
    line(name.empty() ? fmt::format("<ref id=\"{}\"/>", id)
                      : fmt::format("<ref name=\"{}\" id=\"{}\"/>", name, id));
  }
  /// Writes a texture as the parameter `name`, or as an unnamed nested texture.
  void texture(int index, TextureUse use, std::string_view name = "") {
    tell(name);
    least_texture_ = std::min(least_texture_, index);
    put_texture_(index, use, name);
  }
  /// The smallest index of a texture that was referred to; a large number if there is none.
  [[nodiscard]] int least_texture() const { return least_texture_; }
  void append(const XmlText& other) { text_ += other.text_; }
  void transform(std::string_view name, const glm::dmat4& m) {
    line(fmt::format("<transform name=\"{}\"><matrix value=\"{}\"/></transform>", name, rows_of(m)));
  }
  void animation(std::string_view name, std::span<const TransformKey> keys) {
    line(fmt::format("<animation name=\"{}\">", name));
    for (const auto& [time, m] : keys)
      line(fmt::format("  <transform time=\"{}\"><matrix value=\"{}\"/></transform>", time, rows_of(m)));
    line("</animation>");
  }
  /// Texts by time, in seconds.
  void animation(std::string_view name, std::span<const std::pair<double, std::string>> keys) {
    line(fmt::format("<animation name=\"{}\">", name));
    for (const auto& [time, value] : keys)
      line(fmt::format("  <string time=\"{}\" value=\"{}\"/>", time, escaped(value)));
    line("</animation>");
    tell(name);
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  static std::string rows_of(const glm::dmat4& m) {
    std::string rows;
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 4; ++k) rows += fmt::format("{}{}", rows.empty() ? "" : " ", m[k][i]);
    return rows;
  }
  void tell(std::string_view parameter) const {
    if (on_use_ && !tags_.empty()) on_use_(tags_.back(), types_.back(), parameter);
  }
  void line(std::string_view what) {
    text_ += std::string(2 * (tags_.size() + 1), ' ');
    text_ += what;
    text_ += '\n';
  }

  PutTexture put_texture_;
  OnUse on_use_;
  std::string text_;
  std::vector<std::string> tags_, types_;  ///< of open elements
  int least_texture_ = std::numeric_limits<int>::max();
};

inline std::string colour_text(const glm::vec3& c) { return fmt::format("{}, {}, {}", c.x, c.y, c.z); }

// Writes a parameter's value according to its type.
inline void put(XmlText& xml, std::string_view name, const TexturedColour& colour, const auto&) {
  if (colour.texture != kNoTexture) return xml.texture(colour.texture, TextureUse::kColour, name);
  xml.value("rgb", name, colour_text(colour.value));
}
inline void put(XmlText& xml, std::string_view name, const TexturedNumber& number, const auto&) {
  if (number.texture != kNoTexture) return xml.texture(number.texture, TextureUse::kNumber, name);
  xml.value("float", name, fmt::format("{}", number.value));
}
inline void put(XmlText& xml, std::string_view name, const glm::vec3& colour, const auto&) {
  xml.value("rgb", name, colour_text(colour));
}
inline void put(XmlText& xml, std::string_view name, const glm::dvec3& p, const auto&) {
  xml.value("point", name, fmt::format("{}, {}, {}", p.x, p.y, p.z));
}
inline void put(XmlText& xml, std::string_view name, const glm::dmat4& m, const auto&) {
  xml.transform(name, m);
}
inline void put(XmlText& xml, std::string_view name, const std::string& text, const auto&) {
  xml.value("string", name, text);
}
template <typename T, typename Values>
void put(XmlText& xml, std::string_view name, const T& value, const Values& values) {
  if constexpr (requires { values.choices; })
    xml.value("string", name, values.print(value));
  else if constexpr (std::is_same_v<T, bool>)
    xml.value("boolean", name, value ? "true" : "false");
  else if constexpr (std::is_integral_v<T>)
    xml.value("integer", name, fmt::format("{}", value));
  else
    xml.value("float", name, fmt::format("{}", value));
}

template <typename Model>
constexpr bool kIsRough = requires(const Model& model) {
  model.alpha;
  model.alpha_u;
  model.sample_visible;
};

// Whether a parameter is left out because other parameters determine it and exclude it.
template <typename Model>
bool is_determined_by_others(const Model& model, std::string_view name) {
  bool said = false;
  if constexpr (kIsRough<Model>) {
    const bool alike = model.alpha_u == model.alpha_v;
    said |= alike ? name == "alpha_u" || name == "alpha_v" : name == "alpha";
  }
  if constexpr (std::is_base_of_v<ConductorSurface, Model>) said |= name == "material";
  if constexpr (std::is_same_v<Model, PrincipledBsdf>) said |= name == "specular";
  if constexpr (std::is_same_v<Model, HairBsdf>) {
    using Absorption = HairBsdf::Absorption;
    said |= (name == "eumelanin" || name == "pheomelanin") && model.absorption != Absorption::kPigments;
    said |= name == "sigma_a" && model.absorption != Absorption::kCoefficient;
    said |= name == "reflectance" && model.absorption != Absorption::kColour;
  }
  if constexpr (std::is_same_v<Model, PointLight>) said |= name == "to_world";
  if constexpr (std::is_same_v<Model, BitmapTexture>) {
    const bool alike = model.wrap_u == model.wrap_v;
    said |= alike ? name == "wrap_mode_u" || name == "wrap_mode_v" : name == "wrap_mode";
    said |= name == "gamma" && model.raw;
  }
  return said;
}

// Whether a parameter is written even if it has its default value, because readers want all of a group or
// none, or because they use another default if it is missing.
template <typename Model>
bool is_written_anyway(const Model& model, std::string_view name) {
  bool anyway = false;
  if constexpr (std::is_base_of_v<ConductorSurface, Model>) {
    const Model plain;
    anyway |= (name == "eta" || name == "k") && !(model.eta == plain.eta && model.k == plain.k);
  }
  if constexpr (kIsRough<Model>) anyway |= name == "alpha_u" || name == "alpha_v";
  if constexpr (std::is_same_v<Model, PrincipledBsdf>) anyway |= name == "eta";
  if constexpr (std::is_same_v<Model, HairBsdf>) anyway |= name == "sigma_a" || name == "reflectance";
  return anyway;
}

/// The model with derived values copied back to the parameters from which a reader computes them.
template <typename Model>
Model as_given(Model model) {
  if constexpr (requires {
                  model.alpha_u;
                  model.alpha;
                  model.sample_visible;
                })
    if (model.alpha_u == model.alpha_v) model.alpha = model.alpha_u;
  if constexpr (std::is_same_v<Model, BitmapTexture>)
    if (model.wrap_u == model.wrap_v) model.wrap = model.wrap_u;
  return model;
}

/// Writes all parameters that differ from their defaults.
template <typename Model>
void put_parameters(XmlText& xml, const Model& read) {
  Model plain;
  if constexpr (requires { plain.written_for(3); }) plain.written_for(3);
  const Model model = as_given(read);
  Model::parameters([&](const char* name, auto member, const auto& values, const char*) {
    if (is_determined_by_others(model, name)) return;
    if (model.*member == plain.*member && !is_written_anyway(model, name)) return;
    put(xml, name, model.*member, values);
  });
}

}  // namespace penumbra::mitsuba
