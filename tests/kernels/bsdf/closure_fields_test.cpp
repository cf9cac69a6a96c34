// The fields of a closure that a family reads are those that are resolved for it: USERS_* in families.h.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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
  return c;
}

Closure without_what_is_not_resolved(Closure c) {
#define SPOIL(_, type, name) \
  if (((USERS_##name & ~EXTRA_FAMILIES) >> c.family & 1u) == 0u) c.name = spoilt(c.name);
  CLOSURE_FIELDS(SPOIL, )
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

TEST(ClosureFields, AFamilyReadsOnlyThoseThatAreResolvedForIt) {
  SceneTables tables;
  tables.curves.assign(std::size_t(CURVE_ROWS) * CURVE_STRIDE, 0.4f);
  tables.phase_lobes.assign(PHASE_LOBES, PhaseLobe{PHASE_HG, 0.5f, 1.0f / PHASE_LOBES});
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
      if (HasFailure()) return;
    }
}

}  // namespace
}  // namespace penumbra::closure_fields_test
