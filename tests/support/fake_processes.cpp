#include "tests/support/fake_processes.h"

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <thread>

#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

struct Stat {
  char state = 0;
  pid_t parent = 0;
  std::string name;  // of the program, as much of it as the system keeps
};

/// A sanitizer starts it for the stack of its first report, a suppressed one too, and lets it live.
bool is_symbolizer(const std::string& name) {
  return name.starts_with("llvm-symbolize") || name == "addr2line";
}

Stat read_stat(const std::string& pid) {
  const std::string text = file_contents("/proc/" + pid + "/stat");
  const std::size_t name = text.find('('), after_name = text.rfind(')');  // the name may hold anything
  if (name == std::string::npos || after_name == std::string::npos) return {};
  std::istringstream rest(text.substr(after_name + 1));
  Stat stat{.name = text.substr(name + 1, after_name - name - 1)};
  rest >> stat.state >> stat.parent;
  return stat;
}

}  // namespace

std::vector<pid_t> children_of(pid_t parent) {
  std::vector<pid_t> children;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
    const std::string name = entry.path().filename();
    if (!std::isdigit(static_cast<unsigned char>(name[0]))) continue;
    const Stat stat = read_stat(name);
    if (stat.parent == parent && stat.state != 0 && stat.state != 'Z' && !is_symbolizer(stat.name))
      children.push_back(std::atoi(name.c_str()));
  }
  return children;
}

char process_state(pid_t pid) { return read_stat(std::to_string(pid)).state; }

bool eventually(const std::function<bool()>& condition, std::chrono::milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace penumbra
