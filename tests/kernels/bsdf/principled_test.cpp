// The principled BSDFs, read from files, against values of Mitsuba 3.
#include <gtest/gtest.h>

#include "kernels/host/device_scene.h"
#include "tests/kernels/bsdf/mitsuba_values.h"
#include "tests/kernels/kernels_under_test.h"

namespace penumbra {
namespace {

/// As seen from that side: nothing where it is black from there.
std::optional<Closure> closure_from(const BsdfModel& model, bool inside) {
  const auto* principled = std::get_if<PrincipledBsdf>(&model);
  if (principled == nullptr) return closure_of(material_of(std::get<PrincipledThinBsdf>(model)));
  if (!inside) return closure_of(material_of(*principled));
  const auto other = principled->other_side();
  return other ? std::optional(closure_of(material_of(*other))) : std::nullopt;
}

TEST(PrincipledBsdfs, AreWorthWhatMitsubaSays) {
  const std::vector<MitsubaBsdf> bsdfs = mitsuba_bsdfs("principled_values.txt");
  ASSERT_EQ(bsdfs.size(), 18u);
  for (const MitsubaBsdf& bsdf : bsdfs) {
    const BsdfModel model = model_of(bsdf.xml);
    EXPECT_EQ(bsdf.values.size(), 36u);
    for (const MitsubaValue& v : bsdf.values) {
      const bool inside = v.wo.z < 0;
      const std::optional<Closure> c = closure_from(model, inside);
      const auto turned = [&](const vec3& w) { return inside ? make_vec3(w.x, -w.y, -w.z) : w; };
      if (!c) {
        EXPECT_EQ(v.f_cos.x, 0);
        continue;
      }
      const BsdfValue ours = eval_bsdf(nullptr, *c, make_vec3(0, 0, 1), turned(v.wo), turned(v.wi));
      const auto close = [&](float a, float b) {
        EXPECT_NEAR(a, b, 1e-4 * b) << bsdf.xml << " viewer " << v.wo.x << ' ' << v.wo.y << ' ' << v.wo.z
                                    << " light " << v.wi.x << ' ' << v.wi.y << ' ' << v.wi.z;
      };
      close(ours.f_cos.x, v.f_cos.x);
      close(ours.f_cos.y, v.f_cos.y);
      close(ours.f_cos.z, v.f_cos.z);
      close(ours.pdf, v.pdf);
    }
  }
}

}  // namespace
}  // namespace penumbra
