// Resolving materials to closures, and BSDFs of LANES closures at a time.
#include <gtest/gtest.h>

#include <set>

#include "scenes/bsdfs/diffuse.h"
#include "scenes/bsdfs/material_tables.h"
#include "scenes/bsdfs/measured.h"
#include "scenes/bsdfs/microfacet_diffuse.h"
#include "scenes/bsdfs/openpbr.h"
#include "scenes/bsdfs/phong.h"
#include "scenes/bsdfs/plastic.h"
#include "scenes/bsdfs/ward.h"
#include "tests/kernels/bsdf/bsdf_cases.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/same_value.h"
#include "tests/kernels/scene_tables.h"
#include "tests/support/measured_writer.h"

namespace penumbra {
namespace {

/// Materials of the cases, and material 0, which is black.
SceneTables all_materials() {
  SceneTables tables;
  tables.materials.push_back({});
  for (const BsdfCase& each : kCases) tables.materials.push_back(each.material());
  MaterialTables shared(tables.curves);
  for (const int distribution : {DISTRIBUTION_BECKMANN, DISTRIBUTION_GGX})
    tables.materials.push_back(material_of(RoughPlasticBsdf{.distribution = distribution}, shared));
  tables.materials.push_back(material_of(OpenPbrBsdf{.specular_roughness = 0.4f}, shared));
  tables.materials.push_back(
      material_of(OpenPbrBsdf{.specular_roughness = 0.4f, .coat_weight = 0.5f}, shared));
  tables.materials.push_back(
      material_of(OpenPbrBsdf{.specular_roughness = 0.4f, .film_weight = 0.5f}, shared));
  const auto brdf = read_measured_file("anisotropic", measured_fields(anisotropic_formula()).file());
  tables.materials.push_back(
      material_of(MeasuredBsdf{"anisotropic", std::make_shared<const MeasuredBrdf>(brdf.value())}, shared));
  shared.compute();
  tables.materials.push_back(material_of(PlasticBsdf{}));
  tables.materials.push_back(material_of(WardBsdf{.alpha_u = 0.3f}));
  tables.materials.push_back(material_of(BlinnPhongBsdf{}));
  tables.materials.push_back(material_of(RoughDiffuseBsdf{}));
  tables.materials.push_back(material_of(MicrofacetDiffuseBsdf{}));
  tables.materials.push_back(material_of_family(FAMILY_PHASE));
  tables.phase_lobes = {
      {PHASE_HG, 0.6f, 0.5f}, {PHASE_HG, -0.2f, 0.2f}, {PHASE_RAYLEIGH, 0, 0.3f}, {PHASE_HG, 0, 0}};
  return tables;
}

/// LANES surfaces of materials in [first, end).
Surfaces random_surfaces(RandomNumbers& random, int first, int end) {
  Surfaces surfaces;
  for (int j = 0; j < LANES; ++j) {
    Surface s = surface_in_medium(make_vec3(0, 0, 0));
    s.shading = s.geometric = rounded(random.direction());
    s.wo = rounded(random.direction());
    s.material = first + int(random.below(std::uint64_t(end - first)));
    store_surface(&surfaces, j, s);
  }
  return surfaces;
}

TEST(BsdfLanes, OfSeveralFamiliesAreThoseOfEachByItself) {
  SceneTables tables = all_materials();
  const Scene scene = tables.scene();
  RandomNumbers random(17);
  std::set<ulong> seen;
  for (int k = 0; k < 5000; ++k) {
    // Often of few materials, so that some groups of lanes lack a family.
    const int count = int(tables.materials.size()), start = k / 2 % count;
    const int most = k % 2 == 0 ? std::min(3, count - start) : count - start;
    const Surfaces surfaces =
        random_surfaces(random, start, start + 1 + int(random.below(std::uint64_t(most))));
    Closures closures;
    resolve_closures(&scene, &surfaces, &closures);
    ulong expected = 0;
    for (int j = 0; j < LANES; ++j)
      expected |= ulong{1} << tables.materials[std::size_t(surfaces.material[j])].family;
    const ulong families = families_among(&closures);
    ASSERT_EQ(families, expected & EVERY_FAMILY);
    seen.insert(families);

    float wi[3 * LANES], uv[2 * LANES], choice[LANES];
    for (int j = 0; j < LANES; ++j) {
      STORE_LANE_vec3(wi, j, rounded(random.direction()));
      uv[j] = random.unit_float(), uv[LANES + j] = random.unit_float(), choice[j] = random.unit_float();
    }
    BsdfValues values;
    BsdfSamples samples;
    eval_bsdfs(&scene, families, &closures, &surfaces, wi, &values);
    sample_bsdfs(&scene, families, &closures, &surfaces, uv, choice, &samples);
    for (int j = 0; j < LANES; ++j) {
      const Surface s = load_surface(&surfaces, j);
      Closure c = closure_of(tables.materials[std::size_t(s.material)]);
      c.offset = -1;  // hair is seen where v is 0
      const BsdfValue value = load_bsdf_value(&values, j);
      const BsdfValue value_alone = eval_bsdf(&scene, c, s.shading, s.wo, LOAD_LANE_vec3(wi, j));
      ASSERT_TRUE(same(value.f_cos, value_alone.f_cos));
      ASSERT_EQ(value.pdf, value_alone.pdf);
      const BsdfSample sample = load_bsdf_sample(&samples, j);
      const BsdfSample sample_alone =
          sample_bsdf(&scene, c, s.shading, s.wo, uv[j], uv[LANES + j], choice[j]);
      ASSERT_EQ(sample.pdf, sample_alone.pdf);
      ASSERT_EQ(sample.eta, sample_alone.eta);
      if (c.family == FAMILY_BLACK) continue;  // no direction
      ASSERT_TRUE(same(sample.wi, sample_alone.wi));
      ASSERT_TRUE(same(sample.weight, sample_alone.weight));
    }
  }
  ulong all = 0;
  for (const Material& m : tables.materials) all |= ulong{1} << m.family;
  EXPECT_EQ(all, EVERY_FAMILY | ulong{1});
  for (const ulong families : {ulong{0}, ONLY(DIFFUSE), ONLY(ROUGHDIELECTRIC_BECKMANN), ONLY(PHONG),
                               ONLY(MICROFACET_DIFFUSE), ONLY(MEASURED)})
    EXPECT_TRUE(seen.contains(families)) << families;
}

TEST(Closures, HaveWhatTheMaterialHas) {
  SceneTables tables = all_materials();
  const Scene scene = tables.scene();
  RandomNumbers random(18);
  const Surfaces surfaces = random_surfaces(random, 0, int(tables.materials.size()));
  Closures closures;
  resolve_closures(&scene, &surfaces, &closures);
  for (int j = 0; j < LANES; ++j) {
    const Material& m = tables.materials[std::size_t(surfaces.material[j])];
    const Closure c = load_closure(&closures, j);
    EXPECT_EQ(c.family, m.family);
    EXPECT_TRUE(same(c.diffuse, m.diffuse));
    EXPECT_TRUE(same(c.specular, m.specular));
    EXPECT_EQ(c.exponent, m.exponent);
    EXPECT_TRUE(same(c.k, m.k));
    EXPECT_EQ(c.ior, m.ior);
    EXPECT_EQ(c.alpha_v, m.alpha_v);
  }
}

TEST(Closures, KeepWhatNoFamilyOfTheSceneUses) {
  SceneTables tables;
  tables.materials = {{}, kCases[0].material()};
  tables.materials[1].exponent = 7;  // of no account
  const Scene scene = tables.scene();
  RandomNumbers random(19);
  const Surfaces surfaces = random_surfaces(random, 0, 2);
  Closures closures;
  for (int j = 0; j < LANES; ++j) store_closure(&closures, j, black_closure());
  resolve_closures(&scene, &surfaces, &closures);
  for (int j = 0; j < LANES; ++j) {
    const Closure c = load_closure(&closures, j);
    EXPECT_EQ(c.family, surfaces.material[j] == 1 ? FAMILY_DIFFUSE : FAMILY_BLACK);
    EXPECT_EQ(c.diffuse.y, surfaces.material[j] == 1 ? 0.5f : 0);
    EXPECT_EQ(c.exponent, 0);
    EXPECT_EQ(c.ior, 0);
  }
}

}  // namespace
}  // namespace penumbra
