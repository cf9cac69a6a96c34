// Formats the state of a service as a table and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "jobs.pb.h"
#include "worker/protocol/wire.h"
#include "worker/work_unit.h"

namespace penumbra {

/// "queued", "rendering", "done", "incomplete", "failed", "cancelled".
std::string_view job_state_name(wire::JobState state);

/// Sorts jobs and groups by interest: first what is being rendered, then what waits, in the order in which it
/// will be rendered, then what ended last. `ended`: seconds since 1970.
using JobInterest = std::tuple<int, int, double, JobId>;
JobInterest job_interest(wire::JobState state, int priority, double ended, JobId number);

/// Shortens a text to one line of at most `columns` characters (UTF-8), without control characters.
std::string fitted_line(std::string_view text, int columns);

/// A table of groups, jobs and workers: at most `rows` lines of at most `columns` characters, without
/// newlines. If there is not enough room for all jobs, those being rendered, those waiting and those that
/// ended last come first. `unfolded`: jobs of groups are listed too.
std::vector<std::string> status_lines(const wire::StatusReply& status, int columns, int rows,
                                      bool unfolded = false);

/// The groups of status_json.
nlohmann::ordered_json groups_json(const wire::StatusReply& status);
/// The format is documented in scheduler/service/README.md.
nlohmann::ordered_json status_json(const wire::StatusReply& status);

}  // namespace penumbra
