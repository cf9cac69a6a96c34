// A made-up table for tests: a case that passes, one that fails on one backend, one that is skipped.
#pragma once

#include <limits>

#include "scheduler/stress/table.h"

namespace penumbra::stress {

struct Table {
  std::vector<Case> cases;
  std::vector<CaseResult> results;
  TableContext context;
};

inline Outcome outcome(const char* backend, Verdict verdict, double value, double error,
                       const char* note = "") {
  return {backend, verdict, {value}, error, note, .5};
}

inline Table small_table() {
  Table t;
  t.cases.push_back({"one/right",
                     "x < y",
                     "a quantity",
                     KernelMeasurement{0, {1, 2}, {}},
                     {{}, "sum"},
                     absolute(.5, "rounding")});
  t.cases.push_back(
      {"one/wrong", "hard", "another", HostMeasurement{}, {{}, "closed form"}, absolute(.5, "rounding")});
  t.cases.push_back(
      {"two/skipped", "far", "a third", KernelMeasurement{}, {{}, "sum"}, absolute(.5, "rounding")});
  t.results.resize(3);
  for (std::size_t i = 0; i < 3; ++i) t.results[i].tested = &t.cases[i];
  t.results[0].verdict = Verdict::kPass;
  t.results[0].truth = {1.25};
  t.results[0].allowed = .5;
  t.results[0].outcomes = {outcome("native", Verdict::kPass, 1.5, .25),
                           outcome("opencl", Verdict::kPass, 1.5, .25)};
  t.results[1].verdict = Verdict::kFail;
  t.results[1].truth = {3};
  t.results[1].same_bits = false;
  t.results[1].outcomes = {outcome("native", Verdict::kPass, 3, 0),
                           outcome("opencl", Verdict::kFail, std::numeric_limits<double>::quiet_NaN(),
                                   std::numeric_limits<double>::quiet_NaN(), "not a finite number")};
  t.results[2].verdict = Verdict::kSkipped;
  t.results[2].outcomes = {outcome("opencl", Verdict::kSkipped, 0, 0, "no OpenCL device")};
  t.context.backends = {"native", "opencl: a device"};
  t.context.host = "<host>";
  t.context.date = "2026-01-02T03:04:05Z";
  t.context.version = "1.2";
  return t;
}

}  // namespace penumbra::stress
