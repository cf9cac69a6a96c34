#include "kernels/host/media_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "kernels/host/kernel_needs.h"
#include "kernels/host/record_check.h"
#include "kernels/medium/majorant_grid.h"

namespace penumbra {
namespace {

class MediaChecker : public RecordCheck {
 public:
  using RecordCheck::RecordCheck;

  /// Checks media and boundaries, and that media refer to existing phase functions.
  void check_media() {
    const TableSpans& t = h_.tables;
    const auto materials = table<Material>(scene_, t.materials);
    const bool phases = t.phase_lobes.count > 0;
    for (const Material& m : materials)
      require((!phases && m.family != FAMILY_PHASE) || in(m.first_lobe, 0, t.phase_lobes.count - PHASE_LOBES),
              "a phase function names lobes that are not there");
    if (!has(FEATURE_MEDIA)) {
      require(t.media.count == 0 && t.phase_lobes.count == 0 && t.boundaries.count == 0 &&
                  t.primitive_boundaries.count == 0 && t.volumes.count == 0 && t.flight_centres.count == 0 &&
                  t.glows.count == 0 && !has(FEATURE_INTERIORS) && h_.camera_medium == 0 &&
                  (h_.families & families_with(FREE)) == 0,
              "media without their feature bit");
      return;
    }
    require(!has(FEATURE_INTERIORS) || t.boundaries.count > 0, "interiors of materials without boundaries");
    require(has(FEATURE_PATH) && has(FEATURE_NESTED), "media without the feature bits of their paths");
    require(in(t.media.count, 1, MAX_MEDIA), "an implausible number of media");
    require(in(h_.camera_medium, 0, t.media.count - 1), "the camera is in a medium that is not there");
    require(t.primitive_boundaries.count == std::int64_t{t.triangles.count} + t.quadrics.count,
            "boundaries do not match the primitives");
    if (!problem_.empty()) return;
    for (const int boundary : table<int>(scene_, t.primitive_boundaries))
      require(in(boundary, -1, t.boundaries.count - 1), "a primitive names a boundary that is not there");
    const auto within = [](const vec3& v, float high) {
      return v.x >= 0 && v.x <= high && v.y >= 0 && v.y <= high && v.z >= 0 && v.z <= high;
    };
    const auto media = table<Medium>(scene_, t.media);
    for (std::size_t i = 0; i < media.size(); ++i) {
      require(within(media[i].extinction, i == 0 ? 0.0f : std::numeric_limits<float>::max()),
              "a medium of implausible extinction");
      require(within(media[i].albedo, 1), "a medium whose albedo is not in [0, 1]");
      require(i == 0 || (in(media[i].material, 0, t.materials.count - 1) &&
                         materials[std::size_t(media[i].material)].family == FAMILY_PHASE),
              "a medium without a phase function");
      require(in(media[i].interior, 0, has(FEATURE_INTERIORS) ? 1 : 0) &&
                  in(media[i].exit, -1, media[i].interior != 0 ? t.materials.count - 1 : -1),
              "an implausible interior of a material");
      require(
          in(media[i].albedo_curve, -1,
             media[i].interior != 0 && t.curves.count >= CURVE_STRIDE ? t.curves.count - CURVE_STRIDE : -1),
          "a medium names a curve that is not there");
      const bool emits = max_component(media[i].emission) > 0;
      require(within(media[i].emission,
                     i == 0 || !has(FEATURE_EMITTING_MEDIA) ? 0.0f : std::numeric_limits<float>::max()),
              "a medium of implausible emission");
      require(in(media[i].emission_by_density,
                 emits && media[i].density >= 0 && media[i].emission_grid < 0 ? 1 : 0,
                 media[i].density >= 0 ? 1 : 0),
              "a medium whose emission is nowhere");
      require(t.lights.count == 0 || media[i].light < 0 || is_glow_of(media[i].light, int(i)),
              "a medium names a light that is not its own");
    }
    check_volumes();
    check_glows();
    for (const PhaseLobe& lobe : table<PhaseLobe>(scene_, t.phase_lobes))
      require(in(lobe.kind, PHASE_HG, PHASE_RAYLEIGH) && std::abs(lobe.g) < 1 && lobe.weight >= 0 &&
                  lobe.weight <= 1 + 1e-5f,
              "a phase function of implausible lobes");
  }

 private:
  /// Whether that light samples the emission of that medium.
  [[nodiscard]] bool is_glow_of(int light, int medium) const {
    const auto lights = table<Light>(scene_, h_.tables.lights);
    if (!in(light, 0, h_.tables.lights.count - 1) || lights[std::size_t(light)].kind != LIGHT_MEDIUM)
      return false;
    const int glow = lights[std::size_t(light)].beam;
    return in(glow, 0, h_.tables.glows.count - 1) &&
           table<Glow>(scene_, h_.tables.glows)[std::size_t(glow)].medium == medium;
  }

  /// Checks the media that are lights, and their blocks.
  void check_glows() {
    const TableSpans& t = h_.tables;
    if (t.glows.count == 0) return require(t.glow_blocks.count == 0, "blocks of media that are no lights");
    require(has(FEATURE_EMITTING_MEDIA), "media that are lights without their feature bit");
    if (!problem_.empty()) return;
    const auto blocks = table<GlowBlock>(scene_, t.glow_blocks);
    for (const Glow& g : table<Glow>(scene_, t.glows)) {
      const Medium& medium = table<Medium>(scene_, t.media)[std::size_t(g.medium)];
      const int volume = medium.emission_grid >= 0 || medium.emission_by_density == 0 ? medium.emission_grid
                                                                                      : medium.density;
      require(volume < 0 || g.volume == volume,
              "a light of a medium names a volume by which that does not emit");
      require(is_finite3(g.cell_x) && is_finite3(g.cell_y) && is_finite3(g.cell_z) && g.by_area >= 0 &&
                  std::isfinite(g.by_area),
              "a light of a medium has cells of implausible size");
      const bool there = in(g.side, 1, 2 * MAX_VOLUME_CELLS) &&
                         in(g.first_block, 0, t.glow_blocks.count - 1) &&
                         in(g.blocks, 1, t.glow_blocks.count - g.first_block);
      require(there, "a light of a medium names blocks that are not there");
      if (!problem_.empty()) return;
      const Volume& v = table<Volume>(scene_, t.volumes)[std::size_t(g.volume)];
      float below = 0;
      for (const GlowBlock& block : blocks.subspan(std::size_t(g.first_block), std::size_t(g.blocks))) {
        require(in(block.x, 0, (v.nx - 1) / g.side) && in(block.y, 0, (v.ny - 1) / g.side) &&
                    in(block.z, 0, (v.nz - 1) / g.side),
                "a block of a light's medium is outside of its volume");
        require(block.below >= below && block.below < 1, "blocks of a light's medium are not in order");
        below = block.below;
      }
      require(blocks[std::size_t(g.first_block)].below == 0, "blocks of a light's medium do not begin at 0");
    }
  }

  /// Checks that volumes have valid numbers and majorants.
  void check_volumes() {
    const TableSpans& t = h_.tables;
    const auto usable = [](float value) { return value >= 0 && value <= std::numeric_limits<float>::max(); };
    for (const Volume& v : table<Volume>(scene_, t.volumes)) {
      if (!in(v.nx, 1, MAX_VOLUME_CELLS) || !in(v.ny, 1, MAX_VOLUME_CELLS) ||
          !in(v.nz, 1, MAX_VOLUME_CELLS) || (v.channels != 1 && v.channels != 3))
        return require(false, "a volume of implausible size");
      const std::int64_t plane = std::int64_t{v.nx} * v.ny,
                         coarse_plane = std::int64_t{majorant_cells(v.nx)} * majorant_cells(v.ny);
      require(v.first_value >= 0 && plane <= t.volume_values.count &&
                  plane * v.nz * v.channels <= std::int64_t{t.volume_values.count} - v.first_value,
              "a volume names numbers that are not there");
      require(v.first_majorant >= 0 && coarse_plane <= t.majorants.count &&
                  coarse_plane * majorant_cells(v.nz) <= std::int64_t{t.majorants.count} - v.first_majorant,
              "a volume names majorants that are not there");
      for (const vec3& row : {v.corner, v.row_x, v.row_y, v.row_z})
        require(is_finite3(row), "a volume that is nowhere");
    }
    const auto values = table<float>(scene_, t.volume_values), majorants = table<float>(scene_, t.majorants);
    require(std::ranges::all_of(values, usable) && std::ranges::all_of(majorants, usable),
            "a volume of implausible numbers");
  }
};

}  // namespace

std::string media_problem(const DeviceScene& scene) {
  MediaChecker checker(scene);
  checker.check_media();
  return checker.problem();
}

}  // namespace penumbra
