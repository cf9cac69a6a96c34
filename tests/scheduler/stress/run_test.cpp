// Runs cases on correct kernels and on wrong ones.
#include "scheduler/stress/run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "scheduler/stress/quantity_list.h"
#include "scheduler/stress/selection.h"

namespace penumbra::stress {
namespace {

using ::testing::HasSubstr;

class FixedAnswer final : public KernelRunner {
 public:
  explicit FixedAnswer(double answer) : answer_(answer) {}
  Expected<std::vector<Numbers>> run(std::span<const KernelMeasurement* const> measurements) override {
    return std::vector<Numbers>(measurements.size(), Numbers(QUANTITY_OUTPUTS, answer_));
  }

 private:
  double answer_;
};

std::vector<Backend> one(Backend backend) {
  std::vector<Backend> backends;
  backends.push_back(std::move(backend));
  return backends;
}

std::vector<Backend> answering(double answer) {
  Backend backend;
  backend.name = "fake";
  backend.kernels = std::make_unique<FixedAnswer>(answer);
  return one(std::move(backend));
}

std::vector<Case> cases_of(const char* pattern) { return *select(all_cases(), {pattern}); }

std::vector<CaseResult> run(const std::vector<Case>& cases, std::vector<Backend> backends) {
  return run_cases(cases, backends, [](const Case&) {});
}

TEST(Run, RightKernelsPass) {
  const auto cases = cases_of("polygon/horizon*");
  for (const CaseResult& r : run(cases, native_backends(1))) {
    EXPECT_EQ(r.verdict, Verdict::kPass) << r.tested->name;
    EXPECT_GE(r.outcomes.size(), 2u) << "the best instruction set, and one lane";
    EXPECT_TRUE(r.same_bits) << r.tested->name;
  }
}

TEST(Run, ADeliberatelyWrongTruthFails) {
  auto cases = cases_of("polygon/overhead");
  ASSERT_EQ(cases.size(), 1u);
  cases[0].truth.value = [right = cases[0].truth.value] { return Quads{right()[0] * (1 + Quad(1e-13))}; };
  EXPECT_EQ(run(cases, native_backends(1))[0].verdict, Verdict::kFail);
}

TEST(Run, KernelsThatAnswerNanFailEveryCase) {
  for (const char* group : {"polygon/",
                            "phong/",
                            "albedo/",
                            "direction/",
                            "surface/",
                            "watertight/",
                            "sampler/",
                            "sphere/",
                            "sphere-light/",
                            "camera/",
                            "mis/",
                            "block/",
                            "math/",
                            "filter/",
                            "triangle/octant*",
                            "rectangle/strip*",
                            "projected/sliver*",
                            "media/hg*",
                            "media/free*",
                            "media/weight*",
                            "media/sight*"}) {
    const auto cases = cases_of(group);
    for (const CaseResult& r : run(cases, answering(std::numeric_limits<double>::quiet_NaN()))) {
      EXPECT_EQ(r.verdict, Verdict::kFail) << r.tested->name;
    }
  }
}

TEST(Run, KernelsThatAnswerTheSameToEverythingFailSomeOfEachGroup) {
  for (const char* group :
       {"polygon/", "lobe/centre-1*", "triangle/octant*", "rectangle/strip*", "projected/sliver*", "phong/",
        "albedo/60*", "sampler/", "sphere/", "camera/", "mis/", "block/", "math/", "filter/", "media/hg*",
        "media/free*", "media/weight*", "media/sight*"}) {
    const auto cases = cases_of(group);
    for (const double answer : {0., .5, 1.}) {
      int failed = 0;
      for (const CaseResult& r : run(cases, answering(answer))) failed += r.verdict == Verdict::kFail;
      EXPECT_GT(failed, 0) << group << " " << answer;
    }
  }
}

TEST(Run, ABackendThatIsNotThereIsSkippedWithTheReason) {
  Backend missing;
  missing.name = "opencl";
  missing.skipped = "no device";
  const auto cases = cases_of("mis/balance*");
  for (const CaseResult& r : run(cases, one(std::move(missing)))) {
    EXPECT_EQ(r.verdict, Verdict::kSkipped);
    EXPECT_EQ(r.outcomes[0].note, "no device");
  }
}

TEST(Run, ABrokenBackendFails) {
  Backend broken;
  broken.name = "opencl";
  broken.broken = "does not compile";
  for (const char* pattern : {"mis/balance-max", "image/empty-path"}) {
    Backend copy;
    copy.name = broken.name;
    copy.broken = broken.broken;
    const auto cases = cases_of(pattern);
    const auto results = run(cases, one(std::move(copy)));
    EXPECT_EQ(results[0].verdict, Verdict::kFail);
    EXPECT_EQ(results[0].outcomes[0].note, "does not compile");
  }
}

TEST(Run, SamplesThatAreNoNumbersHaveToBeExpected) {
  auto cases = cases_of("image/empty-path");
  ASSERT_EQ(cases.size(), 1u);
  std::get<RenderMeasurement>(cases[0].measurement).non_finite = 1;
  const auto results = run(cases, native_backends(1));
  EXPECT_EQ(results[0].verdict, Verdict::kFail);
  EXPECT_THAT(results[0].outcomes[0].note, HasSubstr("0 samples are NaN or infinite, where 1 are expected"));
}

TEST(Run, ASceneThatCannotBeBuiltFails) {
  auto cases = cases_of("image/empty-path");
  auto& m = std::get<RenderMeasurement>(cases[0].measurement);
  m.scene = [make = m.scene] {
    SceneDescription scene = make();
    scene.emitters.emplace_back(PointLight{{1e300, 0, 0}, glm::vec3(1)});
    return scene;
  };
  const auto results = run(cases, native_backends(1));
  EXPECT_EQ(results[0].verdict, Verdict::kFail);
  EXPECT_THAT(results[0].outcomes[0].note, HasSubstr("single precision"));
}

}  // namespace
}  // namespace penumbra::stress
