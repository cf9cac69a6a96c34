#include "scenes/gltf/extensions.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra::gltf {
namespace {

/// How the reader handles an extension.
enum class Handling {
  kRead,
  kNoVisibleEffect,  ///< it has no effect on the image at rest
  kLeftOut,          ///< the scene is read without it, and a warning says so
  kRefused           ///< without it the scene would be wrong
};

struct Extension {
  std::string_view name;
  Handling handling;
  std::string_view words{};  ///< what is left out, or what to do instead
};

constexpr Extension kExtensions[] = {
    {"EXT_mesh_gpu_instancing", Handling::kRead},
    {"EXT_meshopt_compression", Handling::kRead},
    {"EXT_texture_webp", Handling::kRead},
    {"KHR_animation_pointer", Handling::kRead},
    {"KHR_draco_mesh_compression", Handling::kRead},
    {"KHR_lights_punctual", Handling::kRead},
    {"KHR_materials_anisotropy", Handling::kRead},
    {"KHR_materials_clearcoat", Handling::kRead},
    {"KHR_materials_diffuse_transmission", Handling::kRead},
    {"KHR_materials_dispersion", Handling::kRead},
    {"KHR_materials_emissive_strength", Handling::kRead},
    {"KHR_materials_ior", Handling::kRead},
    {"KHR_materials_iridescence", Handling::kRead},
    {"KHR_materials_pbrSpecularGlossiness", Handling::kRead},
    {"KHR_materials_sheen", Handling::kRead},
    {"KHR_materials_specular", Handling::kRead},
    {"KHR_materials_transmission", Handling::kRead},
    {"KHR_materials_unlit", Handling::kRead},
    {"KHR_materials_volume", Handling::kRead},
    {"KHR_mesh_quantization", Handling::kRead},
    {"KHR_meshopt_compression", Handling::kRead},
    {"KHR_node_visibility", Handling::kRead},
    {"KHR_texture_transform", Handling::kRead},
    // Textures without another image are reported individually.
    {"KHR_texture_basisu", Handling::kRead},
    {"EXT_texture_avif", Handling::kRead},
    {"MSFT_texture_dds", Handling::kRead},
    {"AGI_articulations", Handling::kNoVisibleEffect},
    {"AGI_stk_metadata", Handling::kNoVisibleEffect},
    {"EXT_mesh_features", Handling::kNoVisibleEffect},
    {"EXT_structural_metadata", Handling::kNoVisibleEffect},
    {"KHR_audio", Handling::kNoVisibleEffect},
    {"KHR_interactivity", Handling::kNoVisibleEffect},
    {"KHR_materials_variants", Handling::kNoVisibleEffect},  // the default material is used
    {"KHR_node_hoverability", Handling::kNoVisibleEffect},
    {"KHR_node_selectability", Handling::kNoVisibleEffect},
    {"KHR_xmp", Handling::kNoVisibleEffect},
    {"KHR_xmp_json_ld", Handling::kNoVisibleEffect},
    {"MSFT_lod", Handling::kNoVisibleEffect},
    {"MSFT_packing_normalRoughnessMetallic", Handling::kNoVisibleEffect},
    {"MSFT_packing_occlusionRoughnessMetallic", Handling::kNoVisibleEffect},
    {"CESIUM_primitive_outline", Handling::kLeftOut, "outlines are left out"},
    {"EXT_lights_ies", Handling::kLeftOut, "lights shine alike in all directions"},
    {"EXT_lights_image_based", Handling::kLeftOut, "the sky that it describes is left out"},
    {"KHR_materials_subsurface", Handling::kLeftOut, "no light is scattered below surfaces"},
    {"KHR_materials_volume_scatter", Handling::kLeftOut, "no light is scattered in volumes"},
    {"KHR_materials_common", Handling::kRefused, "use materials of metal and roughness"},
    {"KHR_technique_webgl", Handling::kRefused,
     "it is shaders in GLSL; use materials of metal and roughness"},
    {"KHR_techniques_webgl", Handling::kRefused,
     "it is shaders in GLSL; use materials of metal and roughness"},
};

const Extension* find(std::string_view name) {
  const auto* const found = std::ranges::find(kExtensions, name, &Extension::name);
  return found == std::end(kExtensions) ? nullptr : found;
}

std::vector<std::string> names_of_read() {
  std::vector<std::string> names;
  for (const Extension& extension : kExtensions)
    if (extension.handling == Handling::kRead && extension.name != "KHR_texture_basisu")
      names.emplace_back(extension.name);
  return names;
}

}  // namespace

void check_extensions(const Asset& asset, ReaderReport& report) {
  const auto& required = asset.model.extensionsRequired;
  const auto& used = asset.model.extensionsUsed;
  for (std::size_t i = 0; i < required.size(); ++i) {
    const Extension* const known = find(required[i]);
    if (known != nullptr && known->handling != Handling::kRefused) continue;
    const std::string message =
        fmt::format("the file requires the extension '{}', which is not read", required[i]);
    report.unsupported(asset.place({"extensionsRequired", i}),
                       known != nullptr
                           ? fmt::format("{}: {}", message, known->words)
                           : fmt::format("{}; those that are: {}", message, list_names(names_of_read())),
                       "what it does is left out");
  }
  const auto leave_out = [&](std::string_view name, SourceLocation location) {
    const Extension* const known = find(name);
    if (known == nullptr || known->handling == Handling::kRefused)
      report.warn(location, fmt::format("the extension '{}' is ignored", name));
    else if (known->handling == Handling::kLeftOut)
      report.warn(location, fmt::format("the extension '{}' is ignored: {}", name, known->words));
  };
  for (std::size_t i = 0; i < used.size(); ++i) {
    const bool is_required = std::ranges::find(required, used[i]) != required.end();
    const Extension* const known = find(used[i]);
    if (!is_required || (known != nullptr && known->handling == Handling::kLeftOut))
      leave_out(used[i], asset.place({"extensionsUsed", i}));
  }
}

}  // namespace penumbra::gltf
