#include "scenes/mitsuba/medium_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "scenes/mitsuba/plugin_writer.h"
#include "scenes/volume_file.h"

namespace penumbra::mitsuba {
namespace {

class MediumWriter {
 public:
  MediumWriter(const SceneDescription& scene, const std::filesystem::path& file, XmlText& xml,
               std::vector<SceneFile>& files)
      : scene_(scene), file_(file), xml_(xml), files_(files) {}

  Expected<void> put_all() {
    for (std::size_t i = 0; i < scene_.media.size(); ++i) {
      const ParticipatingMedium& medium = scene_.media[i];
      const glm::vec3 e = medium.extinction;
      const bool is_box = medium.density && medium.density->grid->values.size() == 1;
      if ((medium.density && !is_box && e != glm::vec3(e.x)) ||
          (medium.albedo_grid && medium.albedo != glm::vec3(1.0f)))
        return fail(
            fmt::format("{} has a colour that multiplies a grid, which Mitsuba has not", medium.name));
      if (medium.density && medium.density->fades)
        return fail(fmt::format("{} has a grid that fades at its faces, which Mitsuba has not", medium.name));
      xml_.open("medium", medium.density ? HeterogeneousMedium::kPlugin : HomogeneousMedium::kPlugin,
                fmt::format(" id=\"medium-{}\"", i));
      float scale = e.x;
      if (is_box) {
        scale = scale_of(e);
        xml_.open("volume", "constvolume", " name=\"sigma_t\"");
        xml_.value("rgb", "value", colour_text(e * medium.density->grid->values[0] / scale));
        xml_.transform("to_world", medium.density->to_world);
        xml_.close();
      } else if (medium.density) {
        if (auto done = put_grid("sigma_t", *medium.density); !done) return done;
      } else {
        scale = scale_of(e);
        xml_.value("rgb", "sigma_t", colour_text(e / scale));
      }
      if (medium.albedo_grid) {
        if (auto done = put_grid("albedo", *medium.albedo_grid); !done) return done;
      } else {
        xml_.value("rgb", "albedo", colour_text(medium.albedo));
      }
      if (scale != 1.0f) xml_.value("float", "scale", fmt::format("{}", scale));
      // The density of a box is in its extinction.
      const bool by_box = is_box && medium.emission_by_density;
      if (auto done = put_emission(medium, by_box ? medium.density->grid->values[0] : 1.0f); !done)
        return done;
      put_phase(medium.phase);
      xml_.close();
    }
    return {};
  }

 private:
  Expected<void> put_emission(const ParticipatingMedium& medium, float density) {
    if (!medium.emits()) return {};
    if (medium.density && medium.emission_by_density) xml_.value("boolean", "emission_by_density", "true");
    if (!medium.emission_grid) {
      xml_.value("rgb", "emission", colour_text(density * medium.emission));
      return {};
    }
    if (density * medium.emission != glm::vec3(1.0f))
      return fail(fmt::format(
          "{} has a colour that multiplies the grid of its emission, which a file cannot say", medium.name));
    if (medium.emission_grid->fades)
      return fail(fmt::format("{} has a grid that fades at its faces, which Mitsuba has not", medium.name));
    return put_grid("emission", *medium.emission_grid);
  }

  /// The power of two by which an extinction above 1 is divided; it is written as `scale`. Mitsuba 3 accepts
  /// no colours above 1 for it.
  static float scale_of(const glm::vec3& extinction) {
    int exponent = 0;
    std::frexp(std::max({extinction.x, extinction.y, extinction.z}), &exponent);
    return std::ldexp(1.0f, std::max(exponent, 0));
  }

  /// Refers to the file of a grid, which is created at its first use.
  Expected<void> put_grid(std::string_view name, const GridVolume& volume) {
    const auto [at, added] =
        grids_.try_emplace(volume.grid.get(), fmt::format("{}-{}.vol", file_.stem().string(), grids_.size()));
    if (added) files_.push_back({file_.parent_path() / at->second, vol_of(*volume.grid)});
    xml_.open("volume", GridVolumeParameters::kPlugin, fmt::format(" name=\"{}\"", name));
    put_parameters(xml_, GridVolumeParameters{
                             .filename = at->second, .to_world = volume.to_world, .nearest = volume.nearest});
    xml_.close();
    return {};
  }

  /// Several lobes are written as nested blends: the last one against all before it.
  void put_phase(std::span<const PhaseLobe> lobes) {
    const PhaseLobe& last = lobes.back();
    if (lobes.size() > 1) {
      double before = 0;
      for (const PhaseLobe& lobe : lobes.first(lobes.size() - 1)) before += lobe.weight;
      xml_.open("phase", BlendPhase::kPlugin);
      xml_.value("float", "weight", fmt::format("{}", last.weight / (before + last.weight)));
      put_phase(lobes.first(lobes.size() - 1));
      put_phase(lobes.last(1));
      return xml_.close();
    }
    const bool rayleigh = last.kind == PHASE_RAYLEIGH;
    xml_.open("phase", rayleigh         ? RayleighPhase::kPlugin
                       : last.g == 0.0f ? IsotropicPhase::kPlugin
                                        : HenyeyGreensteinPhase::kPlugin);
    if (!rayleigh && last.g != 0.0f) xml_.value("float", "g", fmt::format("{}", last.g));
    xml_.close();
  }

  const SceneDescription& scene_;
  const std::filesystem::path& file_;
  XmlText& xml_;
  std::vector<SceneFile>& files_;
  std::map<const VolumeGrid*, std::string> grids_;  ///< file names of grids
};

}  // namespace

Expected<void> write_media(const SceneDescription& scene, const std::filesystem::path& file, XmlText& xml,
                           std::vector<SceneFile>& files) {
  return MediumWriter(scene, file, xml, files).put_all();
}

}  // namespace penumbra::mitsuba
