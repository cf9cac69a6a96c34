#include "scenes/plugin_reference.h"

#include <fmt/format.h>

#include <type_traits>
#include <variant>

#include "scenes/bsdfs/coating.h"
#include "scenes/mitsuba/shape_parameters.h"
#include "scenes/scene_description.h"
#include "scenes/sky/sky_parameters.h"

namespace penumbra {
namespace {

/// What plugins say of themselves.
template <typename Model>
std::string text_of() {
  if constexpr (requires { Model::kText; }) return fmt::format("{}\n\n", Model::kText);
  return "";
}

template <typename Values, typename T>
std::string default_of(const Values& values, const T& value) {
  if constexpr (requires { values.print(value); })
    return values.print(value);
  else
    return print_default(value);
}

template <typename Model>
void describe(std::string& out) {
  const Model model;
  out += fmt::format("### `{}`\n\n{}", Model::kPlugin, text_of<Model>());
  std::string rows;
  Model::parameters([&](const char* name, auto member, const auto& values, const char* text) {
    using T = std::remove_cvref_t<decltype(model.*member)>;
    rows += fmt::format("| `{}` | {}{} | {} | {} |\n", name, values.values(),
                        kMayBeTexture<T>                   ? ", or a texture"
                        : std::is_same_v<T, GriddedColour> ? ", or a gridvolume"
                                                           : "",
                        default_of(values, model.*member), text);
  });
  if (!rows.empty())
    out += "| parameter | values | default | what it is |\n|---|---|---|---|\n" + rows + "\n";
}

template <typename... Models>
void describe_all(std::string& out, const char* heading, const std::variant<Models...>*) {
  out += fmt::format("## {}\n\n", heading);
  (describe<Models>(out), ...);
}

}  // namespace

std::string plugin_reference() {
  std::string out =
      "Anything else is an error, which names what there is. With --lenient a plugin that is not here has a "
      "placeholder, and a warning.\n\n";
  describe_all(out, "BSDFs", static_cast<const BsdfModel*>(nullptr));
  describe_all(out, "BSDFs that hold others", static_cast<const HolderParameters*>(nullptr));
  describe_all(out, "BSDFs that coat others", static_cast<const CoatingPlugins*>(nullptr));
  describe_all(out, "Textures", static_cast<const TextureModel*>(nullptr));
  describe_all(out, "Emitters", static_cast<const Emitter*>(nullptr));
  describe<AreaLightParameters>(out);
  describe_all(out, "Skies", static_cast<const SkyModels*>(nullptr));
  describe_all(out, "Media and their phase functions", static_cast<const MediumPlugins*>(nullptr));
  describe_all(out, "Shapes", static_cast<const mitsuba::ShapeParameters*>(nullptr));
  return out;
}

}  // namespace penumbra
