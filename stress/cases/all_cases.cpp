#include "stress/cases/cases.h"

namespace penumbra::stress {

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  add_polygon_cases(cases);
  add_pending_cases(cases);
  return cases;
}

}  // namespace penumbra::stress
