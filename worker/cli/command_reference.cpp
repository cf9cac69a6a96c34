#include "worker/cli/command_reference.h"

#include <algorithm>

#include "kernels/host/console.h"
#include "worker/cli/man_page.h"

namespace penumbra {

std::optional<ExitCode> answer_about(const CommandLine& app, const std::vector<std::string>& arguments,
                                     const ValuesOf& values) {
  if (arguments.empty()) return std::nullopt;
  const std::vector<std::string> rest(arguments.begin() + 1, arguments.end());
  if (arguments[0] == "complete") {
    print_answer(completion_text(complete(app, rest, values)));
    return kAllDone;
  }
  const std::string called = app.name();
  std::string name = called;  // the page's name: for "penumbra stress" it is penumbra-stress
  std::ranges::replace(name, ' ', '-');
  if (arguments[0] == "man" && rest.empty()) {
    print_answer(man_page(app, name, called, PENUMBRA_VERSION));
    return kAllDone;
  }
  if (arguments[0] == "man" && rest.size() == 1 && !rest[0].starts_with("-")) {
    const CommandLine* command = app.find_command(rest[0]);
    if (command == nullptr) return std::nullopt;
    print_answer(man_page(*command, name + "-" + rest[0], name + " " + rest[0], PENUMBRA_VERSION));
    return kAllDone;
  }
  return std::nullopt;
}

}  // namespace penumbra
