// Where a service is, and what proves that one may talk to it, as the commands that do are told.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "scheduler/service/jobs_client.h"

namespace penumbra {

constexpr int kMostUrgent = 1'000'000;  ///< of priorities

struct ServiceAddress {
  std::string to, keys;
};

/// Adds --to; and --keys, where the command has none.
void add_service_address(CLI::App& command, ServiceAddress& address, bool with_keys = true);

/// A client of the service there; `role` says which of the keys it needs. Errors: those of client_access.
Expected<std::unique_ptr<JobsClient>> connect_to_service(const ServiceAddress& address,
                                                         KeyRole role = KeyRole::kUser);

/// "JOB…", numbers that a service gave out.
CLI::Option* add_jobs(CLI::App& command, std::vector<JobId>& jobs);

}  // namespace penumbra
