// Cases whose feature does not exist yet. When it does, the entry becomes a measurement.
#include "scheduler/stress/cases/cases.h"

namespace penumbra::stress {
namespace {

struct Entry {
  const char *name, *stiff, *feature;
};

constexpr Entry kPending[] = {
    {"media/hg-forward-.9999", "Henyey-Greenstein scattering with g = .9999", "media"},
    {"media/hg-backward-.9999", "Henyey-Greenstein scattering with g = -.9999", "media"},
    {"media/optical-depth-1e-8", "a medium of optical depth 1e-8", "media"},
    {"media/optical-depth-1e8", "a medium of optical depth 1e8", "media"},
    {"media/transmittance-underflow", "a transmittance below the smallest number", "media"},
    {"media/free-flight-u-1", "free flights for u -> 1", "media"},
};

}  // namespace

void add_pending_cases(std::vector<Case>& cases) {
  for (const Entry& e : kPending) cases.push_back({e.name, e.stiff, "", Pending{e.feature}, {}, {}});
}

}  // namespace penumbra::stress
