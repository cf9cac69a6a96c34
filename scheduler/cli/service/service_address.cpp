#include "scheduler/cli/service/service_address.h"

#include <fmt/format.h>

#include "kernels/host/console.h"
#include "scheduler/render/option_checks.h"
#include "worker/cli/access_options.h"
#include "worker/cli/help_text.h"

namespace penumbra {

void add_service_address(CommandLine& command, ServiceAddress& address, bool with_keys) {
  command
      .add_option("--to", address.to,
                  "Address of the service: unix:/path, or HOST:PORT with --keys, or with the token that it "
                  "printed in PENUMBRA_TOKEN")
      ->type_name("ADDRESS")
      ->envname("PENUMBRA_SERVICE")
      ->required()
      ->group(group::kNetwork);
  if (!with_keys) return;
  add_client_access_options(command, address.keys);
  command.option("--keys")->group(group::kNetwork);
}

Expected<std::unique_ptr<JobsClient>> connect_to_service(const ServiceAddress& address, KeyRole role) {
  auto access = client_access(address.to, address.keys, role);
  if (!access) return std::unexpected(access.error());
  auto client = std::make_unique<JobsClient>(address.to, std::move(*access));
  client->connect([&] { print_message(fmt::format("waiting for the service at {}", address.to)); });
  return client;
}

}  // namespace penumbra
