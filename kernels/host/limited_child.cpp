#include "kernels/host/limited_child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <optional>
#include <string>
#include <utility>

#include "kernels/host/owned_descriptor.h"
#include "kernels/host/plain_file.h"
#include "kernels/host/process.h"

namespace penumbra {
namespace {

// A sanitizer's shadow of memory counts as memory.
#if defined(__has_feature)
  #if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
    #define PENUMBRA_HAS_SHADOW 1
  #endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  #define PENUMBRA_HAS_SHADOW 1
#endif
#ifdef PENUMBRA_HAS_SHADOW
constexpr bool kHasShadow = true;
#else
constexpr bool kHasShadow = false;
#endif
// A child that writes nothing for its time of the processor and this long waits for something that will not
// come, or shares the machine with very many others.
constexpr int kPatienceSeconds = 60;

/// The address space of this process in bytes (proc(5): the first number of statm, in pages).
std::uint64_t address_space() {
  unsigned long pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "re")) {
    if (std::fscanf(file, "%lu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return std::uint64_t(pages) * std::uint64_t(sysconf(_SC_PAGESIZE));
}

void set_limit(__rlimit_resource resource, std::uint64_t most) {
  rlimit limit{};
  getrlimit(resource, &limit);
  limit.rlim_cur = std::min<rlim_t>(most, limit.rlim_max);
  setrlimit(resource, &limit);
}

constexpr int kFailed = 3;  // exit code: `work` has returned an error
constexpr std::size_t kMostText = 4000;

/// Room for a text that parent and child share.
class SharedText {
 public:
  SharedText() : at_(mmap(nullptr, kMostText, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {}
  SharedText(const SharedText&) = delete;
  SharedText& operator=(const SharedText&) = delete;
  ~SharedText() {
    if (at_ != MAP_FAILED) munmap(at_, kMostText);
  }
  void set(const std::string& text) {
    if (at_ != MAP_FAILED) std::memcpy(at_, text.data(), std::min(text.size(), kMostText));
  }
  [[nodiscard]] std::string get() const {
    if (at_ == MAP_FAILED) return "cannot be read";
    const char* text = static_cast<const char*>(at_);
    return {text, strnlen(text, kMostText)};
  }

 private:
  void* at_;
};

[[noreturn]] void run_child(const ChildLimits& limits, std::uint64_t memory_before, pid_t parent, int pipe,
                            const std::function<Expected<void>(const ChildOutput&)>& work,
                            SharedText& error) noexcept {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  // Else it would keep what other threads have open: pipes of their children, locks and connections.
  close_range(STDERR_FILENO + 1, unsigned(pipe) - 1, 0);
  close_range(unsigned(pipe) + 1, ~0u, 0);
  restore_default_signals();
  signal(SIGPIPE, SIG_IGN);  // writing fails once the parent reads no more
  // Handlers of this process would write its messages.
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU})
    signal(number, SIG_DFL);
  const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nothing, standard);
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_CPU, limits.cpu_seconds);
  if (limits_child_memory() && memory_before > 0) set_limit(RLIMIT_AS, memory_before + limits.memory_bytes);
  try {
    const auto done = work([&](std::span<const std::uint8_t> bytes) { return write_whole(pipe, bytes); });
    if (done) _exit(0);
    error.set(done.error().message);
  } catch (const std::exception& problem) {  // usually out of memory
    error.set(problem.what());
  } catch (...) {
    error.set("cannot be read: what reads it threw something that is no exception");
  }
  _exit(kFailed);
}

/// Why the child did not end as it should; empty if it did.
std::string end_of(int status, const ChildLimits& limits, const SharedText& error) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  if (WIFEXITED(status) && WEXITSTATUS(status) == kFailed) return error.get();
  if (WIFEXITED(status))
    return fmt::format("cannot be read: exit code {} ended what reads it", WEXITSTATUS(status));
  if (WTERMSIG(status) == SIGXCPU)
    return fmt::format("cannot be read: that took more than {} s", limits.cpu_seconds);
  return fmt::format("cannot be read: signal {} ({}) ended what reads it", WTERMSIG(status),
                     strsignal(WTERMSIG(status)));
}

/// The parent's end of the pipe.
class PipeInput {
 public:
  PipeInput(int pipe, int patience) : pipe_(pipe), patience_(patience) {}

  bool fill(std::span<std::uint8_t> to) {
    while (!to.empty()) {
      pollfd entry{.fd = pipe_, .events = POLLIN, .revents = 0};
      const int ready = poll(&entry, 1, patience_ * 1000);
      if (ready < 0 && errno == EINTR) continue;
      is_silent_ = ready == 0;
      const ssize_t got = ready > 0 ? read(pipe_, to.data(), to.size()) : 0;
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      to = to.subspan(std::size_t(got));
    }
    return true;
  }
  /// Whether the child did nothing for so long that it was given up.
  [[nodiscard]] bool is_silent() const { return is_silent_; }

 private:
  int pipe_, patience_;
  bool is_silent_ = false;
};

/// The child. It does not outlive this.
class ChildProcess {
 public:
  explicit ChildProcess(pid_t pid) : pid_(pid) {}
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    static_cast<void>(wait());
  }
  /// Waits for its end. Nothing if that cannot be known.
  std::optional<int> wait() {
    int status = 0;
    const pid_t pid = std::exchange(pid_, 0);
    while (waitpid(pid, &status, 0) < 0)
      if (errno != EINTR) return std::nullopt;
    return status;
  }

 private:
  pid_t pid_;
};

}  // namespace

bool limits_child_memory() { return !kHasShadow; }

Expected<void> run_limited(const ChildLimits& limits,
                           const std::function<Expected<void>(const ChildOutput&)>& work,
                           const std::function<Expected<void>(const ChildInput&)>& take) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return fail(fmt::format("no pipe: {}", std::strerror(errno)));
  OwnedDescriptor from(ends[0]), to(ends[1]);
  fcntl(from.get(), F_SETPIPE_SZ, 1 << 20);  // else images go through it in many small pieces
  SharedText error;
  const std::uint64_t memory_before = address_space();
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) run_child(limits, memory_before, parent, to.get(), work, error);
  if (child < 0) return fail(fmt::format("no process: {}", std::strerror(errno)));
  ChildProcess process(child);
  to = OwnedDescriptor();
  PipeInput input(from.get(), int(limits.cpu_seconds) + kPatienceSeconds);
  bool is_whole = true;  // the child wrote all that was asked for
  Expected<void> taken = take([&](std::span<std::uint8_t> bytes) { return is_whole = input.fill(bytes); });
  if (!taken && is_whole) return taken;
  std::uint8_t more = 0;
  const bool goes_on = is_whole && input.fill({&more, 1});  // else it has ended, or is silent
  if (input.is_silent()) return fail("cannot be read: what reads it did nothing for too long");
  if (goes_on) return fail("cannot be read: what reads it wrote more than was asked for");
  const std::optional<int> status = process.wait();
  if (!status) return fail("cannot be read: the end of what reads it is not known");
  if (const std::string why = end_of(*status, limits, error); !why.empty()) return fail(why);
  return taken;
}

}  // namespace penumbra
