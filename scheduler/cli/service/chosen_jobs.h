// The argument by which commands name jobs and groups of a service.
#pragma once

#include <string>
#include <vector>

#include "scheduler/service/jobs_client.h"
#include "worker/cli/command_line.h"

namespace penumbra {

/// Adds the positional argument "JOB…": a number of a job or group, a range 14-19, or the name of a group.
Option* add_jobs(CommandLine& command, std::vector<std::string>& jobs);

/// The numbers of these jobs and groups, in the given order, each once. Of a range those that exist. Errors:
/// there is nothing in a range, or no group, or several, of a name; the service cannot be reached.
Expected<std::vector<JobId>> numbers_of(const std::vector<std::string>& jobs, JobsClient& service);

}  // namespace penumbra
