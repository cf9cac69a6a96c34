#include "scheduler/cli/service/service_address.h"

#include <cstdlib>
#include <limits>

#include "scheduler/cli/option_checks.h"
#include "scheduler/protocol/token.h"

namespace penumbra {

void add_service_address(CLI::App& command, std::string& address) {
  command
      .add_option(
          "--to", address,
          "Address of the service: unix:/path, or HOST:PORT, where its token is wanted in the environment "
          "variable PENUMBRA_TOKEN (default: PENUMBRA_SERVICE)")
      ->type_name("ADDRESS")
      ->envname("PENUMBRA_SERVICE")
      ->required();
}

JobsClient connect_to_service(const std::string& address) {
  const char* token = std::getenv(kTokenVariable);
  return {address, token != nullptr ? token : ""};
}

CLI::Option* add_jobs(CLI::App& command, std::vector<JobId>& jobs) {
  return command
      .add_option("JOB", jobs, "Numbers of jobs, as `penumbra submit` and `penumbra status` say them")
      ->type_name("JOB")
      ->check(whole_number(1, std::numeric_limits<JobId>::max()));
}

}  // namespace penumbra
