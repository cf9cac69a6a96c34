#include "worker/cli/access_options.h"

#include <fmt/format.h>

#include "worker/keys/client_access.h"

namespace penumbra {

Option* add_keys_option(CommandLine& app, std::string& folder, const std::string& what_for) {
  return app
      .add_option("--keys", folder, what_for + ": the folder that `penumbra keys` made, or its part of it")
      ->envname(kKeysVariable)
      ->type_name("FOLDER");
}

void add_client_access_options(CommandLine& app, std::string& folder) {
  add_keys_option(app, folder, "For a scheduler at HOST:PORT with TLS");
  add_token_refusal(app);
}

void add_token_refusal(CommandLine& app) {
  // An empty group hides it from the help.
  app.add_option_function(
         "--token",
         [](const std::string&) -> Expected<void> {
           return fail(fmt::format(
               "all users of this machine can see the words of a command; put it into the environment "
               "variable {}",
               kTokenVariable));
         })
      ->group("");
}

}  // namespace penumbra
