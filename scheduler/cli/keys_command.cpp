// `penumbra keys FOLDER`: makes certificates and tokens for a scheduler that other hosts can reach.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "scheduler/cli/commands.h"
#include "scheduler/files/quoting.h"
#include "scheduler/render/option_checks.h"
#include "worker/keys/host_names.h"
#include "worker/keys/key_folder.h"
#include "worker/keys/make_keys.h"

namespace penumbra {
namespace {

constexpr int kMostDays = 3650;

ExitCode make(MakeKeysOptions options) {
  if (options.names.empty()) options.names = host_names();
  for (const std::string& name : loopback_names()) options.names.push_back(name);
  if (const auto made = make_keys(options); !made) return print_error(made.error()), kBadInput;
  const std::string folder = shell_quoted_file(options.folder.string());
  std::string text = fmt::format("keys for a scheduler at {}, good for {} days, in {}:\n",
                                 fmt::join(options.names, ", "), options.days, options.folder.string());
  for (const KeyRoleInfo& role : kKeyRoles) text += fmt::format("  {:<10} for {}\n", role.folder, role.who);
  text += fmt::format(
      "  {:<10} makes further ones: keep it where nothing is rendered, or remove it\n"
      "there$ penumbra render SCENE --listen 0.0.0.0:7000 --keys {}\n"
      "here$  penumbra worker --connect HOST:7000 --keys FOLDER      FOLDER: a copy of {}/worker\n",
      key_files::kAuthorityFolder, folder, options.folder.string());
  print_remark(text);
  return kAllDone;
}

}  // namespace

void add_keys_command(CommandLine& app, Command& chosen) {
  CommandLine* command =
      app.add_command("keys", "Make certificates and tokens for schedulers that other hosts connect to");
  const auto options = std::make_shared<MakeKeysOptions>();
  const auto folder = std::make_shared<std::string>();
  command->add_option("FOLDER", *folder, "Folder to write, which holds nothing else")->required();
  command->default_group("Certificates");
  command
      ->add_option("--name", options->names,
                   "A host name or address of the scheduler; *.farm.example for a whole domain (default: the "
                   "names and "
                   "addresses of this host). localhost is always included; repeatable")
      ->type_name("NAME")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--days", options->days, "Days until the certificates expire")
      ->type_name("N")
      ->check(whole_number(1, kMostDays))
      ->capture_default_str();
  command->add_flag("--force", options->force,
                    "Replace existing keys; every machine then needs the new ones");
  command->footer(
      "Connections from other hosts are encrypted (TLS 1.2 or 1.3), and both ends show a certificate of one "
      "authority, which is made here for this farm alone. The token says what a client may do: watch, work "
      "or "
      "submit. Only you can read the files (mode 0600); copy them to other machines by ssh or a shared home. "
      "PENUMBRA_KEYS=FOLDER stands for --keys FOLDER.\n\n"
      "Examples:\n"
      "  penumbra keys ~/farm                                    for this host\n"
      "  penumbra keys ~/farm --name render1 --name 10.0.0.7\n"
      "  scp -r ~/farm/worker node7:farm-worker");
  command->callback([options, folder, &chosen] {
    options->folder = *folder;
    chosen = [options] { return make(*options); };
  });
}

}  // namespace penumbra
