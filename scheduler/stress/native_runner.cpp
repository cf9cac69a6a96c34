#include <algorithm>
#include <array>

#include "kernels/host/native_kernels.h"
#include "scheduler/stress/backend.h"
#include "scheduler/stress/quantity_list.h"

namespace penumbra {

using AnswerFunction = void(int id, const double* in, double* out, uint* scratch);
AnswerFunction answer_scalar, answer_sse2, answer_avx2, answer_avx512;

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
  KernelTarget target;
  Isa isa;  ///< instruction set of renders
  const char* name;
  AnswerFunction* answer;
};
constexpr NativeSet kSets[] = {
#ifdef PENUMBRA_AVX512
    {KernelTarget::kAvx512, Isa::kAvx512, "native avx512", answer_avx512},
#endif
#ifdef PENUMBRA_AVX2
    {KernelTarget::kAvx2, Isa::kAvx2, "native avx2", answer_avx2},
#endif
    {KernelTarget::kSse2, Isa::kSse2, "native sse2", answer_sse2},
    {KernelTarget::kScalar, Isa::kSse2, "native one lane", answer_scalar}};

}  // namespace

std::vector<Backend> native_backends(int threads) {
  std::vector<Backend> backends;
  for (const NativeSet& set : kSets) {
    if (!machine_has(set.target)) continue;
    Backend backend;
    backend.name = backend.description = set.name;
    backend.kernels = std::make_unique<NativeRunner>(set.answer);
    backend.render.threads = threads;
    backend.render.isa = set.isa;
    backend.render.block_of_one = set.target == KernelTarget::kScalar;
    backend.renders = backends.empty() || backend.render.block_of_one;
    backends.push_back(std::move(backend));
  }
  return backends;
}

}  // namespace stress
}  // namespace penumbra
