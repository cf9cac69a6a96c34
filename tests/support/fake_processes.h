// The child processes of a process and their states, read from /proc.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace penumbra {

/// Living (not zombie) children of a process, but for the symbolizer of a sanitizer.
std::vector<pid_t> children_of(pid_t parent);
/// The state letter of /proc/PID/stat, e.g. 'R', 'S', 'T' (stopped), 'Z'; 0 if there is no such process.
char process_state(pid_t pid);
/// Polls until the condition holds; false if it does not within so long.
bool eventually(const std::function<bool()>& condition, std::chrono::milliseconds patience);

}  // namespace penumbra
