// Where a service is, as the commands that talk to one are told.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "scheduler/service/jobs_client.h"

namespace penumbra {

/// Adds --to. The token comes from the environment, so that no list of processes shows it.
void add_service_address(CLI::App& command, std::string& address);

/// A client of the service there.
JobsClient connect_to_service(const std::string& address);

/// "JOB…", numbers that a service gave out.
CLI::Option* add_jobs(CLI::App& command, std::vector<JobId>& jobs);

}  // namespace penumbra
