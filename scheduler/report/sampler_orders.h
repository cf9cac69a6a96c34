// How fast MSE should fall with the number of samples, by kind of sampler.
#pragma once

#include <optional>
#include <string_view>

namespace penumbra {

/// Slopes of log MSE over log samples, twice the slopes of RMSE. For one pixel in two dimensions: N^-1 for
/// independent samples (any integrand); jittered N^-2 for smooth ones and N^-1.5 where an edge crosses the
/// pixel (Mitchell 1996); Owen-scrambled nets N^-3 for smooth ones (Owen 1997, up to logarithms) and N^-1.5
/// for edges. More dimensions and rougher integrands lie between N^-1 and these.
struct SamplerOrder {
  double smooth = -1, edges = -1;
};

/// Nothing for a sampler of which no order is known.
std::optional<SamplerOrder> expected_order(std::string_view sampler);

}  // namespace penumbra
