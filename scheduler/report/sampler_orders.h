// Expected convergence rates of MSE by kind of sampler.
#pragma once

#include <optional>
#include <string_view>

namespace penumbra {

/// Slopes of log MSE over log samples; they are twice the slopes of RMSE. For one pixel in two dimensions:
/// N^-1 for independent samples (any integrand); for jittered samples N^-2 for smooth integrands and N^-1.5
/// if an edge crosses the pixel (Mitchell 1996); for Owen-scrambled nets N^-3 for smooth integrands (Owen
/// 1997, up to logarithms) and N^-1.5 for edges. More dimensions and rougher integrands lie between N^-1 and
/// these.
struct SamplerOrder {
  double smooth = -1, edges = -1;
};

/// Nothing for a sampler without a known rate.
std::optional<SamplerOrder> expected_order(std::string_view sampler);

}  // namespace penumbra
