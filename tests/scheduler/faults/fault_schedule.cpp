#include "tests/scheduler/faults/fault_schedule.h"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <random>

namespace penumbra {

FaultSchedule FaultSchedule::of(unsigned seed) {
  std::mt19937 random(seed);
  const auto between = [&](int low, int high) { return low + int(random() % unsigned(high - low + 1)); };
  const auto chance = [&](int percent) { return between(1, 100) <= percent; };
  FaultSchedule schedule;
  schedule.seed = seed;
  schedule.workers = between(2, 4);
  schedule.tile = chance(50) ? 16 : 24;
  schedule.delay_ms = between(2, 8);
  if (chance(20)) schedule.verify = 0.2;
  if (chance(15)) schedule.crash_tile = between(0, 15);
  for (int faults = between(0, 4); faults > 0; --faults) {
    ProcessFault fault{.at = std::chrono::milliseconds(between(0, 400)),
                       .signal = chance(60) ? SIGKILL : SIGSTOP,
                       .victim = between(0, 100),
                       .wake_up = {}};
    if (fault.signal == SIGSTOP && chance(70)) fault.wake_up = std::chrono::milliseconds(between(20, 3000));
    schedule.processes.push_back(fault);
  }
  std::ranges::sort(schedule.processes, {}, &ProcessFault::at);
  for (int rogues = between(0, 3); rogues > 0; --rogues) {
    const RogueHabit habit{.roguery = Roguery(between(1, int(Roguery::kCount) - 1)),
                           .at = between(1, 12),
                           .delay = std::chrono::milliseconds(between(1, 10))};
    // Of two that lie the four workers that disagreed are more than this little farm is worth.
    const bool has_liar = schedule.verify == 1;
    if (habit.roguery == Roguery::kLies && has_liar) continue;
    if (habit.roguery == Roguery::kLies) schedule.verify = 1;
    schedule.rogues.push_back(habit);
  }
  return schedule;
}

std::string FaultSchedule::text() const {
  std::string text = fmt::format("PENUMBRA_FAULT_SEED={}: {} workers, tiles of {}, {} ms a unit, verify {}",
                                 seed, workers, tile, delay_ms, verify);
  if (crash_tile) text += fmt::format("; tile {} is deadly", *crash_tile);
  for (const ProcessFault& fault : processes) {
    text += fmt::format("; at {} ms signal {} to {}", fault.at.count(), fault.signal, fault.victim);
    if (fault.wake_up) text += fmt::format(" for {} ms", fault.wake_up->count());
  }
  for (const RogueHabit& rogue : rogues)
    text +=
        fmt::format("; a rogue ({}, unit {}, {} ms)", text_of(rogue.roguery), rogue.at, rogue.delay.count());
  return text;
}

}  // namespace penumbra
