#include "scenes/device/light_table.h"

#include <numeric>

namespace penumbra {

void set_light_probabilities(std::span<Light> lights, std::span<const double> power) {
  const std::size_t n = lights.size();
  const double total = std::accumulate(power.begin(), power.end(), 0.0);
  std::vector<double> share(n);
  std::vector<std::size_t> small, large;
  for (std::size_t i = 0; i < n; ++i) {
    share[i] = power[i] / total * double(n);
    lights[i].alias_threshold = 1.0f;
    lights[i].alias = int(i);
    (share[i] < 1 ? small : large).push_back(i);
  }
  while (!small.empty() && !large.empty()) {
    const std::size_t s = small.back(), l = large.back();
    small.pop_back();
    lights[s].alias_threshold = float(share[s]);
    lights[s].alias = int(l);
    share[l] -= 1 - share[s];
    if (share[l] < 1) {
      large.pop_back();
      small.push_back(l);
    }
  }
  // The probabilities that the rounded table really has, so that weights by 1 / pmf are exact.
  std::vector<double> chosen(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const double keep = std::min(1.0, double(lights[i].alias_threshold));
    chosen[i] += keep / double(n);
    chosen[std::size_t(lights[i].alias)] += (1 - keep) / double(n);
  }
  for (std::size_t i = 0; i < n; ++i) lights[i].pmf = float(chosen[i]);
}

}  // namespace penumbra
