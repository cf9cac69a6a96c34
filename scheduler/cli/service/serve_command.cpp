// `penumbra serve`: a scheduler that others give jobs to.
#include <filesystem>
#include <memory>

#include "kernels/host/process.h"
#include "scheduler/cli/commands.h"
#include "scheduler/cli/option_checks.h"
#include "scheduler/cli/service/service_run.h"
#include "scheduler/cli/stop_signal.h"
#include "scheduler/farm/checkpoint_sink.h"
#include "scheduler/keys/access_options.h"
#include "scheduler/plan/work_unit.h"
#include "worker/device.h"

namespace penumbra {
namespace {

std::string default_spool() {
  const std::filesystem::path state = user_folder("XDG_STATE_HOME", ".local/state");
  return ((state.empty() ? ".local/state" : state) / "penumbra" / "spool").string();
}

}  // namespace

void add_serve_command(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand("serve", "Wait for jobs (penumbra submit), and render them");
  const auto options = std::make_shared<ServiceOptions>();
  const auto spool = std::make_shared<std::string>(default_spool());
  command
      ->add_option(
          "--listen", options->listen,
          "Address for clients, windows and further workers: unix:/path, or 127.0.0.1:PORT (0: any free "
          "one), where tokens are asked for, which are printed; with --keys also of other hosts, "
          "0.0.0.0:PORT "
          "for all")
      ->type_name("ADDRESS")
      ->check(some_text())
      ->required();
  add_keys_option(*command, options->keys, "TLS and tokens for --listen HOST:PORT");
  command
      ->add_option("--spool", *spool,
                   "Folder of jobs, their scenes and results; one service at a time has it")
      ->type_name("FOLDER")
      ->capture_default_str();
  command
      ->add_option("--workers", options->workers,
                   "Worker processes on this machine; 0: only those that join (penumbra worker --connect)")
      ->type_name("N")
      ->check(whole_number(0, kMaxWorkers))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Threads of each worker (default: cores / workers)")
      ->type_name("N")
      ->check(whole_number(1, kMaxThreads));
  options->checkpoint_interval = kCheckpointInterval;
  command
      ->add_option(
          "--checkpoint-interval", options->checkpoint_interval,
          "Keep what is rendered so often, or less often where that would take more than 1% of the time; 0: "
          "never")
      ->type_name("SECONDS")
      ->check(number_from_zero())
      ->capture_default_str();
  command->footer(
      "Jobs come with their scenes, so a service needs no file system in common with its clients. They are "
      "on disk\n"
      "before `penumbra submit` says their numbers. Whatever ends the service (Ctrl-C, a crash, kill -9), "
      "the next one\n"
      "with the same folder goes on with what was rendered, to the same images. The highest priority is "
      "rendered\n"
      "first, then the oldest job; results wait in the folder for `penumbra fetch`.\n\n"
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
