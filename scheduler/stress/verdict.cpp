#include "scheduler/stress/verdict.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace penumbra::stress {

const char* verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "pass";
    case Verdict::kFail:
      return "FAIL";
    case Verdict::kSkipped:
      return "skipped";
  }
  return "?";
}

double allowed_error(const Quads& truth, const Allowed& allowed) {
  Quad squares = 0;
  for (const Quad& t : truth) squares += t * t;
  return double(Quad(allowed.absolute) + Quad(allowed.relative) * sqrt_q(squares));
}

void judge(const Quads& truth, const Allowed& allowed, Outcome& outcome) {
  outcome.verdict = Verdict::kFail;
  outcome.error = std::numeric_limits<double>::quiet_NaN();
  if (outcome.value.size() != truth.size() || truth.empty()) {
    if (outcome.note.empty()) outcome.note = "the result has another number of components than the truth";
    return;
  }
  Quad squares = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (!std::isfinite(outcome.value[i])) {
      if (outcome.note.empty()) outcome.note = "not a finite number";
      return;
    }
    const Quad difference = Quad(outcome.value[i]) - truth[i];
    squares += difference * difference;
  }
  outcome.error = double(sqrt_q(squares));
  const double most = allowed_error(truth, allowed);
  // Written so that NaN fails.
  const bool close = std::isfinite(outcome.error) && std::isfinite(most) && outcome.error <= most;
  if (close && outcome.note.empty()) outcome.verdict = Verdict::kPass;
  if (!close && outcome.note.empty()) outcome.note = "off by more than allowed";
}

Verdict summarize(const std::vector<Outcome>& outcomes) {
  const auto any = [&](Verdict v) {
    return std::any_of(outcomes.begin(), outcomes.end(), [v](const Outcome& o) { return o.verdict == v; });
  };
  if (any(Verdict::kFail)) return Verdict::kFail;
  return any(Verdict::kPass) ? Verdict::kPass : Verdict::kSkipped;
}

bool have_same_bits(const std::vector<Outcome>& outcomes) {
  const Outcome* first = nullptr;
  for (const Outcome& o : outcomes) {
    if (o.verdict == Verdict::kSkipped) continue;
    if (!first) first = &o;
    const bool same = std::equal(o.value.begin(), o.value.end(), first->value.begin(), first->value.end(),
                                 [](double a, double b) {
                                   return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
                                 });
    if (!same) return false;
  }
  return true;
}

}  // namespace penumbra::stress
