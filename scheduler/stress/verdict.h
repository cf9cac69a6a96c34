// Whether a result is good enough.
#pragma once

#include <string>
#include <vector>

#include "scheduler/stress/case.h"

namespace penumbra::stress {

enum class Verdict { kPass, kFail, kSkipped };
const char* verdict_name(Verdict verdict);

/// What one backend made of a case.
struct Outcome {
  std::string backend;  ///< "native avx512", "opencl", "host"
  Verdict verdict = Verdict::kFail;
  Numbers value;
  double error = 0;  ///< Euclidean distance from the truth; NaN if there is no result
  std::string note;  ///< what went wrong, or why it was skipped
  double seconds = 0;
};

struct CaseResult {
  const Case* tested = nullptr;
  Numbers truth;
  double allowed = 0;
  std::vector<Outcome> outcomes;
  Verdict verdict = Verdict::kFail;
  bool same_bits = true;  ///< all outcomes have one value
};

/// Compares a result with the truth. Anything that is not finite, in the result or the truth, fails, as does
/// a wrong number of components, or a result that comes with a note of what went wrong.
void judge(const Quads& truth, const Allowed& allowed, Outcome& outcome);

/// Largest distance from this truth that passes.
double allowed_error(const Quads& truth, const Allowed& allowed);

/// Of a case: fails if any outcome does, is skipped if all are.
Verdict summarize(const std::vector<Outcome>& outcomes);

/// Whether all that are not skipped have the same bits.
bool have_same_bits(const std::vector<Outcome>& outcomes);

}  // namespace penumbra::stress
