// `penumbra serve`: a scheduler to which clients submit jobs.
#include <filesystem>
#include <memory>

#include "kernels/host/process.h"
#include "scheduler/cli/commands.h"
#include "scheduler/cli/service/service_run.h"
#include "scheduler/farm/checkpoint_sink.h"
#include "scheduler/files/stop_signal.h"
#include "scheduler/render/option_checks.h"
#include "scheduler/service/end_hook.h"
#include "scheduler/web/web_page.h"
#include "worker/cli/access_options.h"
#include "worker/cli/help_text.h"
#include "worker/device.h"
#include "worker/work_unit.h"

namespace penumbra {
namespace {

std::string default_spool() {
  const std::filesystem::path state = user_folder("XDG_STATE_HOME", ".local/state");
  return ((state.empty() ? ".local/state" : state) / "penumbra" / "spool").string();
}

}  // namespace

void add_serve_command(CommandLine& app, Command& chosen) {
  CommandLine* command = app.add_command("serve", "Wait for jobs, and render them");
  const auto options = std::make_shared<ServiceOptions>();
  const auto spool = std::make_shared<std::string>(default_spool());
  command->default_group(group::kNetwork);
  command
      ->add_option(
          "--listen", options->listen,
          "Address for clients, windows and more workers: unix:/path, or 127.0.0.1:PORT (0: a free port) "
          "with tokens, which are printed. With --keys other hosts too: 0.0.0.0:PORT for all")
      ->type_name("ADDRESS")
      ->check(some_text())
      ->required();
  add_keys_option(*command, options->keys, "TLS and tokens for --listen HOST:PORT");
  add_web_option(*command, options->web);
  command->default_group(group::kWorkers);
  command->add_option("--spool", *spool, "Folder of jobs, scenes and results; used by one service at a time")
      ->type_name("FOLDER")
      ->group("Jobs")
      ->capture_default_str();
  command
      ->add_option(
          "--workers", options->workers,
          "Worker processes on this machine; 0: only workers that connect (penumbra worker --connect)")
      ->type_name("N")
      ->check(whole_number(0, kMaxWorkers))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Threads of each worker (default: cores / workers)")
      ->type_name("N")
      ->check(whole_number(1, kMaxThreads));
  options->checkpoint_interval = kCheckpointInterval;
  command
      ->add_option("--checkpoint-interval", options->checkpoint_interval,
                   "Time between checkpoints, longer where they would take more than 1% of it; 0: none")
      ->type_name("SECONDS")
      ->transform(seconds())
      ->check(number_from_zero())
      ->group("Jobs")
      ->capture_default_str();
  command
      ->add_flag("--own-jobs", options->own_jobs,
                 "Jobs are cancelled, prioritized, retried and removed only by who submitted them, whom a "
                 "secret in ~/.local/state/penumbra/submitter proves (default: by everybody who may submit)")
      ->group("Jobs");
  command
      ->add_option(
          "--on-done", options->on_done,
          "Shell command for each job and each group that ends, with the fields {job} (number), {kind} (job, "
          "frame of a group, or group), {group}, {name}, {state}, {submitter}, {error}")
      ->type_name("COMMAND")
      ->check({[](const std::string& text) {
        const auto hook = EndHook::make(text);
        return hook ? std::string() : hook.error().message;
      }})
      ->group("Jobs");
  command
      ->add_option(
          "--keep", options->keep,
          "Remove jobs and their files so long after their end; of a group together (default: only `penumbra "
          "fetch --remove` does): 90m, 12h, 7d")
      ->transform(duration())
      ->type_name("TIME")
      ->group("Jobs");
  command->footer(
      "Jobs come with their scenes: a service needs no file system in common with its clients. A job is on "
      "disk before `penumbra submit` prints its number. After Ctrl-C, a crash or kill -9, the next service "
      "with the same folder continues, to the same images. The highest priority is rendered first; among "
      "equals "
      "users have equal shares, and each one's oldest job is first. Results wait in the folder for `penumbra "
      "fetch`.\n\n"
      "Examples:\n"
      "  penumbra serve --listen unix:/tmp/farm.socket --workers 4\n"
      "  penumbra submit scene.xml --spp 256 --to unix:/tmp/farm.socket\n"
      "  penumbra status --watch --to unix:/tmp/farm.socket\n"
      "  penumbra fetch 1 -o out/ --to unix:/tmp/farm.socket");
  command->callback([options, spool, &chosen] {
    chosen = [options, spool] {
      options->spool = *spool;
      return run_service(*options, install_stop_signal());
    };
  });
}

}  // namespace penumbra
