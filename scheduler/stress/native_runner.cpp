#include <algorithm>
#include <array>

#include "kernels/host/native_kernels.h"
#include "scheduler/stress/backend.h"
#include "scheduler/stress/quantity_list.h"

namespace penumbra {

using AnswerFunction = void(int id, const double* in, double* out, uint* scratch);
AnswerFunction answer_one_lane, answer_sse2, answer_avx2, answer_avx512;

namespace stress {
namespace {

class NativeRunner final : public KernelRunner {
 public:
  explicit NativeRunner(AnswerFunction* answer) : answer_(answer) {}

  Expected<std::vector<Numbers>> run(std::span<const KernelMeasurement* const> measurements) override {
    std::vector<Numbers> results;
    alignas(64) std::array<uint, QUANTITY_SCRATCH> scratch{};
    for (const KernelMeasurement* m : measurements) {
      std::array<double, QUANTITY_INPUTS> in{};
      std::copy(m->inputs.begin(), m->inputs.end(), in.begin());
      results.emplace_back(QUANTITY_OUTPUTS);
      answer_(m->quantity, in.data(), results.back().data(), scratch.data());
    }
    return results;
  }

 private:
  AnswerFunction* answer_;
};

struct NativeSet {
  Isa isa;
  const char* name;
  AnswerFunction* answer;
};
constexpr NativeSet kSets[] = {
#ifdef PENUMBRA_AVX512
    {Isa::kAvx512, "native avx512", answer_avx512},
#endif
#ifdef PENUMBRA_AVX2
    {Isa::kAvx2, "native avx2", answer_avx2},
#endif
#ifdef PENUMBRA_SSE2
    {Isa::kSse2, "native sse2", answer_sse2},
#endif
};

}  // namespace

std::vector<Backend> native_backends(int threads) {
  std::vector<Backend> backends;
  const auto add = [&](Isa isa, const char* name, AnswerFunction* answer) -> Backend& {
    Backend backend;
    backend.name = backend.description = name;
    backend.kernels = std::make_unique<NativeRunner>(answer);
    backend.render.threads = threads;
    backend.render.isa = isa;
    backend.renders = backends.empty();
    return backends.emplace_back(std::move(backend));
  };
  for (const NativeSet& set : kSets)
    if (machine_has(set.isa)) add(set.isa, set.name, set.answer);
  Backend& one_lane = add(best_isa(), "native one lane", answer_one_lane);
  one_lane.description += ", renders by blocks of one pixel";
  one_lane.render.block_of_one = true;
  one_lane.renders = true;
  return backends;
}

}  // namespace stress
}  // namespace penumbra
