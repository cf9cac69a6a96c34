#include "tests/slurm/slurm_cluster.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <random>
#include <sstream>

#include "tests/support/fake_processes.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

/// Free ports, all at once so that they differ.
std::vector<int> free_ports(int count) {
  std::vector<int> sockets, ports;
  for (int i = 0; i < count; ++i) {
    sockets.push_back(socket(AF_INET, SOCK_STREAM, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    if (bind(sockets.back(), generic, size) != 0 || getsockname(sockets.back(), generic, &size) != 0)
      continue;
    ports.push_back(ntohs(address.sin_port));
  }
  for (const int descriptor : sockets) close(descriptor);
  return ports;
}

std::string find_in_path(const std::string& name) {
  for (const char* folder : {"/usr/sbin/", "/usr/bin/", "/usr/local/sbin/", "/usr/local/bin/"})
    if (access((folder + name).c_str(), X_OK) == 0) return folder + name;
  return {};
}

std::string host_name() {
  char name[256] = {};
  gethostname(name, sizeof name - 1);
  return std::string(name).substr(0, std::string(name).find('.'));
}

}  // namespace

SlurmCluster::SlurmCluster() {
  // Its daemons change users and refuse keys in folders of others.
  if (geteuid() != 0) {
    why_not_ = "a Slurm of one's own needs root";
    return;
  }
  for (const char* name : {"munged", "slurmctld", "slurmd", "srun", "sbatch", "scontrol"})
    if (find_in_path(name).empty()) {
      why_not_ = std::string("there is no ") + name + " (packages slurm-wlm and munge)";
      return;
    }
  start();
}

void SlurmCluster::start() {
  chmod(folder_.path().c_str(), 0755);
  for (const char* name : {"state", "spool", "munge"}) fs::create_directory(folder_ / name);
  {
    std::random_device random;
    std::string key(128, '\0');
    for (char& byte : key) byte = char(random());
    write_text(folder_ / "munge.key", key);
    chmod((folder_ / "munge.key").c_str(), 0600);
  }
  const std::vector<int> ports = free_ports(1 + kNodes);
  if (ports.size() != 1 + kNodes) {
    why_not_ = "no free ports on 127.0.0.1";
    return;
  }
  const std::string folder = folder_.path().string(), host = host_name();
  std::ostringstream text;
  text << "ClusterName=penumbra-test\nSlurmctldHost=" << host << "(127.0.0.1)\nSlurmctldPort=" << ports[0]
       << "\nAuthType=auth/munge\nAuthInfo=socket=" << folder
       << "/munge/socket\nSlurmUser=root\nSlurmdUser=root"
       << "\nStateSaveLocation=" << folder << "/state\nSlurmdSpoolDir=" << folder << "/spool/%n"
       << "\nSlurmctldPidFile=" << folder << "/slurmctld.pid\nSlurmdPidFile=" << folder << "/%n.pid"
       << "\nSlurmctldLogFile=" << folder << "/slurmctld.log\nSlurmdLogFile=" << folder << "/%n.log"
       << "\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nSwitchType=switch/none\nMpiDefault=none"
       << "\nJobAcctGatherType=jobacct_gather/none\nAccountingStorageType=accounting_storage/none"
       << "\nSelectType=select/cons_tres\nSelectTypeParameters=CR_Core\nReturnToService=2"
       << "\nSchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1,requeue_delay=0"
       << "\nKillWait=2\nJobRequeue=1\nSlurmdTimeout=15"
       << "\nPreemptType=preempt/partition_prio\nPreemptMode=REQUEUE\n";
  for (int i = 1; i <= kNodes; ++i)
    text << "NodeName=n" << i << " NodeHostname=" << host
         << " NodeAddr=127.0.0.1 Port=" << ports[std::size_t(i)] << " CPUs=1 State=UNKNOWN\n";
  text << "PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP PriorityTier=2 PreemptMode=OFF\n"
       << "PartitionName=preempted Nodes=ALL MaxTime=INFINITE State=UP PriorityTier=1 PreemptMode=REQUEUE\n";
  write_text(folder_ / "slurm.conf", text.str());

  const auto run = [&](const std::string& name, const std::string& program,
                       std::vector<std::string> arguments) {
    fs::create_directory(folder_ / ("run-" + name));
    daemons_.push_back(
        std::make_unique<Program>(folder_ / ("run-" + name), find_in_path(program), arguments));
  };
  run("munged", "munged",
      {"--foreground", "--force", "--socket=" + folder + "/munge/socket",
       "--key-file=" + folder + "/munge.key", "--pid-file=" + folder + "/munge/pid",
       "--seed-file=" + folder + "/munge/seed"});
  if (!eventually([&] { return fs::exists(folder_ / "munge/socket"); }, 5s)) {
    why_not_ = "munged does not start: " + file_contents(folder_ / "run-munged/.stderr");
    return;
  }
  run("slurmctld", "slurmctld", {"-D", "-f", configuration()});
  for (int i = 1; i <= kNodes; ++i) {
    const std::string node = "n" + std::to_string(i);
    run(node, "slurmd", {"-D", "-N", node, "-f", configuration()});
  }
  const auto idle = [&] {
    return ask("sinfo -h -p all -o %T-%D") == "idle-" + std::to_string(kNodes) + "\n";
  };
  if (!eventually(idle, 15s)) why_not_ = "Slurm's nodes do not become idle: " + log_ends();
}

std::string SlurmCluster::log_ends() const {
  constexpr std::size_t kLongest = 500;
  std::string all;
  for (const char* name : {"slurmctld.log", "n1.log"}) {
    const std::string log = file_contents(folder_ / name);
    all += std::string(name) + ": " + log.substr(log.size() - std::min(log.size(), kLongest));
  }
  return all;
}

std::vector<pid_t> SlurmCluster::processes(const std::string& word, const std::string& node) const {
  std::vector<pid_t> found;
  for (const auto& process : fs::directory_iterator("/proc")) {
    const std::string name = process.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (!file_contents(process.path() / "cmdline").contains(word)) continue;
    // Variables are separated by zeros.
    const std::string environment = file_contents(process.path() / "environ") + '\0';
    if (environment.contains("SLURM_CONF=" + configuration() + '\0') &&
        environment.contains("SLURMD_NODENAME=" + node + (node.empty() ? "" : std::string(1, '\0'))))
      found.push_back(pid_t(std::stol(name)));
  }
  return found;
}

void SlurmCluster::lose_node(const std::string& node) {
  const std::string daemon = "-N " + node + " -f " + configuration();
  // The daemon first, so that it cannot report the end of its jobs. A slurmstepd is named by its job alone,
  // and is the parent of what runs.
  std::vector<pid_t> doomed;
  for (const auto& one : daemons_) {
    std::string command = file_contents(fs::path("/proc") / std::to_string(one->pid()) / "cmdline");
    std::ranges::replace(command, '\0', ' ');
    if (command.contains(daemon)) doomed.push_back(one->pid());
  }
  for (const pid_t pid : processes("", node)) {
    const std::string status = file_contents(fs::path("/proc") / std::to_string(pid) / "status");
    const std::size_t at = status.find("PPid:");
    const pid_t parent = at == std::string::npos ? 0 : pid_t(std::atol(status.c_str() + at + 5));
    if (file_contents(fs::path("/proc") / std::to_string(parent) / "comm").starts_with("slurmstepd"))
      doomed.push_back(parent);
    doomed.push_back(pid);
  }
  for (const pid_t pid : doomed) kill(pid, SIGKILL);
}

std::string SlurmCluster::ask(const std::string& command) const {
  const fs::path folder = folder_ / "ask";
  fs::create_directory(folder);
  const ProgramResult result =
      Program(folder, "/bin/sh", {"-c", "SLURM_CONF=" + configuration() + " timeout 10 " + command}).wait();
  return result.exit_code == 0 ? result.out : "";
}

SlurmCluster::~SlurmCluster() {
  if (daemons_.size() > 1) {
    ask("scancel --me");
    eventually([&] { return ask("squeue -h; echo done") == "done\n"; }, 5s);
  }
  for (auto daemon = daemons_.rbegin(); daemon != daemons_.rend(); ++daemon) {
    (*daemon)->send(SIGTERM);
    const pid_t pid = (*daemon)->pid();
    eventually([&] { return process_state(pid) == 'Z' || process_state(pid) == 0; }, 3s);
  }
}

}  // namespace penumbra
