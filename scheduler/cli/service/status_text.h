// The state of a service in words, as a table and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "jobs.pb.h"
#include "scheduler/protocol/wire.h"

namespace penumbra {

/// "queued", "rendering", "done", "incomplete", "failed", "cancelled".
std::string_view job_state_name(wire::JobState state);

/// A line of at most so many characters of UTF-8; nothing that a terminal would obey.
std::string fitted_line(std::string_view text, int columns);

/// Jobs and workers, lines of at most `columns` characters and at most `rows` of them, each without its
/// newline. Where there is no room for all jobs, those that are rendered, those that wait and those that
/// ended last come first.
std::vector<std::string> status_lines(const wire::StatusReply& status, int columns, int rows);

/// Documented in scheduler/service/README.md.
nlohmann::ordered_json status_json(const wire::StatusReply& status);

}  // namespace penumbra
