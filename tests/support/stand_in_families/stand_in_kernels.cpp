#include "tests/support/stand_in_families/stand_in_kernels.h"

#include <bit>
#include <cstring>
#include <vector>

#include "kernels/native_variants.h"
#include "scenes/device/ltc/ltc_table.h"

namespace penumbra {

NativeRenderBlock render_stand_ins_scalar_whole, render_stand_ins_scalar_bvh, render_stand_ins_avx2_whole,
    render_stand_ins_avx2_bvh;

namespace {

#define BOTH_SETS(target, name, lanes)                                                              \
  {KernelTarget::target, "whole", NATIVE_FEATURES_whole, lanes, render_stand_ins_##name##_whole}, { \
    KernelTarget::target, "bvh", NATIVE_FEATURES_bvh, lanes, render_stand_ins_##name##_bvh          \
  }
constexpr NativeKernel kKernels[] = {BOTH_SETS(kScalar, scalar, 1), BOTH_SETS(kAvx2, avx2, 16)};

}  // namespace

std::span<const NativeKernel> stand_in_kernels() { return kKernels; }

const NativeKernel* find_stand_in_kernel(KernelTarget target, const DeviceScene& scene) {
  if (!machine_has(target)) return nullptr;
  for (const NativeKernel& kernel : kKernels)
    if (kernel.target == target && ((kernel.features ^ scene.header.features) & FEATURE_BVH) == 0)
      return &kernel;
  return nullptr;
}

void stand_in(DeviceScene& scene, std::span<const StandIn> stand_ins) {
  const TableSpan span = scene.header.tables.materials;
  auto* materials = reinterpret_cast<Material*>(scene.words.data() + span.offset);
  for (const StandIn& each : stand_ins) {
    Material& m = materials[each.material];
    m.family = each.family;
    if (each.specular >= 0) m.specular = {each.specular, each.specular, each.specular};
    if (each.exponent >= 0) m.exponent = each.exponent;
  }
  scene.header.families = 0;
  for (int i = 1; i < span.count; ++i) scene.header.families |= 1u << materials[i].family;
  // What the builder does for families that the renderer has.
  std::uint32_t& features = scene.header.features;
  features &= ~std::uint32_t(FEATURE_TRANSMISSION | FEATURE_MIXED_FAMILIES);
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
