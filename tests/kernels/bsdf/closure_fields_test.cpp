// The closure fields that a family reads are those that are resolved for it: USERS_* in families.h.
#include "kernels/bsdf/control_lanes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "scenes/device/ltc/ltc_table.h"
#include "tests/kernels/bsdf/bsdf_case.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/same_value.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra::closure_fields_test {
namespace {

/// Larger than any field that a family has no use for.
constexpr int kNoIndex = 1 << 20;

int some(int, RandomNumbers& numbers) { return int(numbers.below(2)); }
float some(float, RandomNumbers& numbers) { return float(numbers.between(0.1, 0.9)); }
vec3 some(const vec3&, RandomNumbers& numbers) {
  return make_vec3(some(0.0f, numbers), some(0.0f, numbers), some(0.0f, numbers));
}

int spoilt(int) { return kNoIndex; }
float spoilt(float) { return std::numeric_limits<float>::quiet_NaN(); }
vec3 spoilt(const vec3&) { return make_vec3(spoilt(0.0f), spoilt(0.0f), spoilt(0.0f)); }

constexpr int kFilmRows = 2;

Closure some_closure(int family, RandomNumbers& numbers) {
  Closure c{};
#define FILL(_, type, name) c.name = some(c.name, numbers);
  CLOSURE_FIELDS(FILL, )
#undef FILL
  c.family = family;
  c.ior = 1.5f;
  c.curve = 0;
  c.curve_rows = numbers.below(2) == 0 ? 1 : CURVE_ROWS;
  c.first_lobe = 0;
  c.film_rows = family == FAMILY_OPENPBR_FILM ? kFilmRows : 0;
  if (family == FAMILY_OPENPBR_FILM && numbers.below(2) == 0) --c.film_rows;
  if (family == FAMILY_MEASURED) c.anisotropic = float(numbers.below(2));
  if (family == FAMILY_OPENPBR)
    c.variant = c.variant * OPENPBR_WEIGHT_TINTS + some(2, numbers) * OPENPBR_TINT_FADES;
  if (((OPENPBRS_LAYERED >> family) & 1u) != 0u) {
    c.variant += some(2, numbers) * OPENPBR_OWN_COAT;
    c.coat_normal = normalize3(add(c.coat_normal, make_vec3(0, 0, 1)));
  }
  if (family == FAMILY_HAIR)
    c.variant = int(numbers.below(1 + HAIR_ALONG_V + HAIR_OFFSET_BY_V + HAIR_OF_COLOUR));
  return c;
}

Closure without_what_is_not_resolved(Closure c) {
#define SPOIL(_, type, name) \
  if (((USERS_##name & ~EXTRA_FAMILIES) >> c.family & 1u) == 0u) c.name = spoilt(c.name);
  CLOSURE_PARAMETERS(SPOIL, )
#undef SPOIL
  return c;
}

float lobe_probability(const Closure& c, const vec3& wo) {
  switch (c.family) {
#define PROBABILITY(name, NAME) \
  case FAMILY_##NAME:           \
    return name##_lobe_probability(c, wo);
    BRANCHING_FAMILIES(PROBABILITY)
#undef PROBABILITY
    default:
      return 1.0f;
  }
}

#define COUNT(name, NAME, number, properties, text) number,
const int kFamilies[] = {BSDF_FAMILIES(COUNT)};
#undef COUNT

SceneTables tables_of_all_families() {
  SceneTables tables;
  constexpr int kFilms = kFilmRows * (FILM_REFLECTANCES + 3 * CURVE_STRIDE * CURVE_ROWS / OPENPBR_SETS);
  for (int i = 0; i < CURVE_ROWS * CURVE_STRIDE + kFilms; ++i)
    tables.curves.push_back(0.3f + 1e-5f * float(i));
  // The header of a measured BRDF, with two knots along each side of its grids and each angle.
  std::fill_n(tables.curves.begin(), MEASURED_HEADER, 2.0f);
  tables.phase_lobes.assign(PHASE_LOBES, PhaseLobe{PHASE_HG, 0.5f, 1.0f / PHASE_LOBES});
  tables.ltc_cells = ltc_table();
  return tables;
}

TEST(ClosureFields, AFamilyReadsOnlyThoseThatAreResolvedForIt) {
  SceneTables tables = tables_of_all_families();
  const Scene scene = tables.scene();
  const vec3 normal = make_vec3(0, 0, 1);
  RandomNumbers numbers(7);
  for (const int family : kFamilies)
    for (int k = 0; k < 200; ++k) {
      SCOPED_TRACE(testing::Message() << "family " << family << ", closure " << k);
      const Closure whole = some_closure(family, numbers), own = without_what_is_not_resolved(whole);
      vec3 wo = rounded(numbers.direction());
      wo.z = std::abs(wo.z);
      const vec3 wi = rounded(numbers.direction());
      const BsdfValue value = eval_bsdf(&scene, whole, normal, wo, wi),
                      value_of_own = eval_bsdf(&scene, own, normal, wo, wi);
      EXPECT_TRUE(same(value.f_cos, value_of_own.f_cos));
      EXPECT_TRUE(same(value.pdf, value_of_own.pdf));
      const float u = numbers.unit_float(), v = numbers.unit_float(), choice = numbers.unit_float();
      const BsdfSample sample = sample_bsdf(&scene, whole, normal, wo, u, v, choice),
                       sample_of_own = sample_bsdf(&scene, own, normal, wo, u, v, choice);
      EXPECT_TRUE(same(sample.wi, sample_of_own.wi));
      EXPECT_TRUE(same(sample.weight, sample_of_own.weight));
      EXPECT_TRUE(same(sample.pdf, sample_of_own.pdf));
      EXPECT_TRUE(same(sample.eta, sample_of_own.eta));
      EXPECT_TRUE(same(lobe_probability(whole, wo), lobe_probability(own, wo)));
      const ControlLobes control = control_of(&scene, whole, wo.z),
                         control_of_own = control_of(&scene, own, wo.z);
      EXPECT_TRUE(same(control.diffuse, control_of_own.diffuse));
      EXPECT_TRUE(same(control.specular, control_of_own.specular));
      EXPECT_TRUE(same(control.width_x, control_of_own.width_x));
      EXPECT_TRUE(same(control.width_y, control_of_own.width_y));
      EXPECT_TRUE(same(control.shift, control_of_own.shift));
      if (HasFailure()) return;
    }
}

// Otherwise nothing above would say that a family is missing among the users of a field: whatever it reads is
// seen in what it returns.
TEST(ClosureFields, ThatAreResolvedAreRead) {
  SceneTables tables = tables_of_all_families();
  const Scene scene = tables.scene();
  const vec3 normal = make_vec3(0, 0, 1);
  RandomNumbers numbers(8);
  std::set<std::pair<int, std::string>> resolved, read;
  for (const int family : kFamilies)
    for (int k = 0; k < 200; ++k) {
      const Closure whole = some_closure(family, numbers), other = some_closure(family, numbers);
      vec3 wo = rounded(numbers.direction());
      wo.z = std::abs(wo.z);
      const vec3 wi = rounded(numbers.direction());
      const float u = numbers.unit_float(), v = numbers.unit_float(), choice = numbers.unit_float();
      const auto same_of = [&](const Closure& changed) {
        const BsdfValue a = eval_bsdf(&scene, whole, normal, wo, wi),
                        b = eval_bsdf(&scene, changed, normal, wo, wi);
        const BsdfSample s = sample_bsdf(&scene, whole, normal, wo, u, v, choice),
                         t = sample_bsdf(&scene, changed, normal, wo, u, v, choice);
        return same(a.f_cos, b.f_cos) && same(a.pdf, b.pdf) && same(s.wi, t.wi) && same(s.weight, t.weight) &&
               same(s.pdf, t.pdf);
      };
#define CHANGE(_, type, name)                                                                       \
  if ((((USERS_##name) & ~EXTRA_FAMILIES) >> family & 1u) != 0u && !same(whole.name, other.name)) { \
    Closure changed = whole;                                                                        \
    changed.name = other.name;                                                                      \
    resolved.emplace(family, #name);                                                                \
    if (!same_of(changed)) read.emplace(family, #name);                                             \
  }
      CLOSURE_PARAMETERS(CHANGE, )
#undef CHANGE
    }
  EXPECT_EQ(read, resolved);
}

}  // namespace
}  // namespace penumbra::closure_fields_test
