#include "scheduler/blender/blender_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <sstream>
#include <utility>

#include "scenes/number.h"
#include "scheduler/files/program_path.h"
#include "scheduler/files/run_program.h"
#include "scheduler/files/stop_signal.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr std::pair<int, int> kOldest{4, 2};
constexpr std::chrono::seconds kTimeToSayVersion{60};
constexpr const char* kWhatWouldDo =
    "Blender 4.2 or newer would do, or a Python 3.11 that has it (pip install bpy)";

/// Major and minor version in "Blender 4.2.3 LTS". Nothing if the text begins otherwise.
std::optional<std::pair<int, int>> version_of(std::string_view text) {
  constexpr std::string_view kName = "Blender ";
  if (!text.starts_with(kName)) return std::nullopt;
  text.remove_prefix(kName.size());
  const std::size_t dot = text.find('.');
  if (dot == text.npos) return std::nullopt;
  const std::size_t end = std::min(text.find_first_not_of("0123456789", dot + 1), text.size());
  const auto major = parse_integer(text.substr(0, dot)),
             minor = parse_integer(text.substr(dot + 1, end - dot - 1));
  if (!major || !minor) return std::nullopt;
  return std::pair(int(*major), int(*minor));
}

/// The line of the output that names the program. Libraries may write others before it.
std::string line_of_version(const std::string& output) {
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);)
    if (version_of(line) || line.starts_with("Python 3.")) return line;
  return output.substr(0, output.find('\n'));
}

/// `who`: what names the program, as in "--blender".
Expected<BlenderProgram> check(const std::string& who, const std::string& name) {
  const auto found = name.contains('/') ? Expected<fs::path>(fs::absolute(name)) : find_program(name);
  if (!found) return fail(fmt::format("{} {}: {}", who, name, found.error().message));
  const auto end = run_program(found->string(), {"--version"},
                               {.errors_too = true, .limit = kTimeToSayVersion, .stop = &stop_signal()});
  if (!end) return fail(fmt::format("{}: {}; {}", who, end.error().message, kWhatWouldDo));
  const std::string line = line_of_version(end->output);
  const bool is_python = line.starts_with("Python 3.");
  const auto version = version_of(line);
  if (!is_python && !version)
    return fail(fmt::format("{}: {} is neither Blender nor a Python ('{} --version' says '{}'); {}", who,
                            found->string(), name, line, kWhatWouldDo));
  if (version && *version < kOldest)
    return fail(fmt::format("{}: {} is {}, which is too old; {}", who, found->string(), line, kWhatWouldDo));
  return BlenderProgram{*found, is_python};
}

}  // namespace

std::vector<std::string> BlenderProgram::arguments(const fs::path& script,
                                                   std::vector<std::string> words) const {
  std::vector<std::string> all;
  if (is_python)
    all = {script.string()};
  else
    all = {"--background",
           "--factory-startup",
           "--disable-autoexec",
           "--python-exit-code",
           "1",
           "--python",
           script.string(),
           "--"};
  all.insert(all.end(), std::make_move_iterator(words.begin()), std::make_move_iterator(words.end()));
  return all;
}

Expected<BlenderProgram> find_blender(const std::string& named) {
  if (!named.empty()) return check("--blender", named);
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value != nullptr ? value : "");
  };
  if (const std::string value = variable("PENUMBRA_BLENDER"); !value.empty())
    return check("PENUMBRA_BLENDER", value);
  // The system's may be too old.
  const auto in_path = find_program("blender");
  auto checked = in_path ? check("PATH", in_path->string()) : Expected<BlenderProgram>(fail(""));
  const std::string python = variable("PENUMBRA_BLENDER_PYTHON");
  if (!checked && !python.empty()) return check("PENUMBRA_BLENDER_PYTHON", python);
  if (in_path) return checked;
  return fail(
      fmt::format("Blender exports such files, and there is none here: --blender, PENUMBRA_BLENDER and "
                  "PENUMBRA_BLENDER_PYTHON name no program, and no 'blender' is in PATH. {}",
                  kWhatWouldDo));
}

Expected<fs::path> find_export_script() {
  std::error_code unknown;
  const fs::path folder = fs::read_symlink("/proc/self/exe", unknown).parent_path();
  const fs::path inside = fs::path("blender") / "command_line.py";
  const fs::path installed = folder.parent_path() / "share" / "penumbra" / inside, built = folder / inside;
  for (const fs::path& place : {installed, built})
    if (fs::exists(place, unknown)) return place;
  return fail(
      fmt::format("the script that exports by Blender is neither {} nor {}: the installation is not whole",
                  installed.string(), built.string()));
}

}  // namespace penumbra
