// Decides whether a result is accurate enough.
#pragma once

#include <string>
#include <vector>

#include "scheduler/stress/case.h"

namespace penumbra::stress {

enum class Verdict { kPass, kFail, kSkipped };
const char* verdict_name(Verdict verdict);

/// The result of one backend for a case.
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
  bool same_bits = true;  ///< all outcomes have bitwise the same value
};

/// Compares a result with the truth. It fails if the result or the truth is not finite, has a wrong number of
/// components, or if the outcome has a note about an error.
void judge(const Quads& truth, const Allowed& allowed, Outcome& outcome);

/// The largest distance from this truth that passes.
double allowed_error(const Quads& truth, const Allowed& allowed);

/// The verdict of a case: fails if any outcome fails, is skipped if all are skipped.
Verdict summarize(const std::vector<Outcome>& outcomes);

/// Whether all outcomes that are not skipped have the same bits.
bool have_same_bits(const std::vector<Outcome>& outcomes);

}  // namespace penumbra::stress
