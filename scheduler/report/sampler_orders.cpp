#include "scheduler/report/sampler_orders.h"

namespace penumbra {

std::optional<SamplerOrder> expected_order(std::string_view sampler) {
  if (sampler == "independent") return SamplerOrder{-1, -1};
  if (sampler == "stratified") return SamplerOrder{-2, -1.5};
  if (sampler == "sobol" || sampler == "halton") return SamplerOrder{-3, -1.5};
  return std::nullopt;
}

}  // namespace penumbra
