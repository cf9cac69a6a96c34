// The argument by which commands name jobs and groups of a service.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scheduler/service/jobs_client.h"
#include "worker/cli/command_line.h"

namespace penumbra {

/// Adds the positional argument "JOB…": a number of a job or group, a range 14-19, or the name of a group.
Option* add_jobs(CommandLine& command, std::vector<std::string>& jobs);

/// Adds --frames, of the shots that these jobs are.
Option* add_frames(CommandLine& command, std::string& frames);

/// The jobs of these frames (see frames_of) of each of the groups or jobs, of which only those for which
/// `is_meant`. Errors: one of them has not all of these frames, or none is meant.
Expected<std::vector<JobId>> jobs_of_frames(const std::vector<JobId>& numbers, const std::string& frames,
                                            JobsClient& service,
                                            const std::function<bool(const wire::JobStatus&)>& is_meant);

/// The numbers of these jobs and groups, in the given order, each once. Of a range those that exist. Errors:
/// there is nothing in a range, or no group, or several, of a name; the service cannot be reached.
Expected<std::vector<JobId>> numbers_of(const std::vector<std::string>& jobs, JobsClient& service);

}  // namespace penumbra
