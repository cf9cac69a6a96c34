// Options for the address and the credentials of a service, shared by the commands that talk to one.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "scheduler/service/jobs_client.h"
#include "worker/cli/command_line.h"

namespace penumbra {

constexpr int kMostUrgent = 1'000'000;  ///< the largest priority

struct ServiceAddress {
  std::string to, keys;
};

/// Adds --to, and with `with_keys` also --keys.
void add_service_address(CommandLine& command, ServiceAddress& address, bool with_keys = true);

/// Makes a client for the service at this address. `role` selects the keys. Errors: those of client_access.
Expected<std::unique_ptr<JobsClient>> connect_to_service(const ServiceAddress& address,
                                                         KeyRole role = KeyRole::kUser);

}  // namespace penumbra
