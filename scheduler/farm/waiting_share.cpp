#include "scheduler/farm/waiting_share.h"

#include <fmt/format.h>

#include <algorithm>

namespace penumbra {

std::optional<WaitingShare::Measured> WaitingShare::measure(Seconds now, int workers, bool has_enough,
                                                            const Totals& totals) {
  if (!has_enough || workers == 0) {
    begin_.reset();
    return {};
  }
  if (!begin_) {
    begin_ = now;
    worker_seconds_ = 0;
    most_workers_ = workers;
    before_ = totals;
  } else {
    worker_seconds_ += workers * (now - last_);
    most_workers_ = std::max(most_workers_, workers);
  }
  last_ = now;
  const Seconds passed = now - *begin_;
  if (passed < kWindow || totals.results - before_.results < kResultsPerWorker * std::uint64_t(most_workers_))
    return {};
  begin_.reset();
  return Measured{.waiting = std::clamp(1 - (totals.busy - before_.busy) / worker_seconds_, 0.0, 1.0),
                  .bytes_per_second = double(totals.bytes - before_.bytes) / passed,
                  .cores = (totals.cpu - before_.cpu) / passed};
}

std::string waiting_text(const WaitingShare::Measured& measured, std::uint32_t pass, std::uint32_t more) {
  std::string text = fmt::format(
      "workers wait {:.0f}% of the time for the scheduler or its network, which takes {:.3g} MB/s of results "
      "with {:.1f} cores",
      100 * measured.waiting, measured.bytes_per_second * 1e-6, measured.cores);
  if (more > pass)
    text += fmt::format("; --pass {} needs {:.2g} times less of both, and changes the last bits", more,
                        double(more) / pass);
  return text;
}

}  // namespace penumbra
