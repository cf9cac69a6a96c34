#include "tests/support/extra_families/extra_family_kernels.h"

#include <bit>
#include <cstring>
#include <vector>

#include "scenes/device/ltc/ltc_table.h"

namespace penumbra {

NativeRenderBlock render_extra_families_one_lane, render_extra_families_sse2;
NativeTracePhotons trace_extra_families_one_lane, trace_extra_families_sse2;

const NativeKernel& extra_family_kernel(bool one_lane) {
  static constexpr NativeKernel kOneLane{Isa::kSse2, 1, render_extra_families_one_lane,
                                         trace_extra_families_one_lane};
  static constexpr NativeKernel kLanes{Isa::kSse2, 16, render_extra_families_sse2, trace_extra_families_sse2};
  return one_lane ? kOneLane : kLanes;
}

std::vector<NativeKernel> one_lane_and_native_kernels() {
  std::vector<NativeKernel> kernels{extra_family_kernel(true)};
  for (const NativeKernel& kernel : native_kernels())
    if (machine_has(kernel.isa)) kernels.push_back(kernel);
  return kernels;
}

void put_extra_families(DeviceScene& scene, std::span<const ExtraFamily> extra_families) {
  const TableSpan span = scene.header.tables.materials;
  auto* materials = reinterpret_cast<Material*>(scene.words.data() + span.offset);
  for (const ExtraFamily& each : extra_families) {
    Material& m = materials[each.material];
    m.family = each.family;
    if (each.specular >= 0) m.specular = {each.specular, each.specular, each.specular};
    if (each.exponent >= 0) m.exponent = each.exponent;
  }
  scene.header.families = 0;
  for (int i = 1; i < span.count; ++i) scene.header.families |= std::uint64_t{1} << materials[i].family;
  // What the builder does for families that the renderer has.
  std::uint64_t& features = scene.header.features;
  features &= ~std::uint64_t(FEATURE_TRANSMISSION | FEATURE_MIXED_FAMILIES);
  if ((scene.header.families & families_with(TRANSMITS)) != 0) features |= FEATURE_TRANSMISSION;
  if (std::popcount(scene.header.families) > 1) features |= FEATURE_MIXED_FAMILIES;
  if ((features & (FEATURE_POLYGONS | FEATURE_PROJECTED)) == 0 ||
      (scene.header.families & ltc_families()) == 0)
    return;
  features |= FEATURE_LTC;
  const std::vector<LtcCell> cells = ltc_table();
  scene.header.tables.ltc_cells = {int(cells.size()), std::uint32_t(scene.words.size())};
  scene.words.resize(scene.words.size() + cells.size() * sizeof(LtcCell) / 4);
  std::memcpy(scene.words.data() + scene.header.tables.ltc_cells.offset, cells.data(),
              cells.size() * sizeof(LtcCell));
}

}  // namespace penumbra
