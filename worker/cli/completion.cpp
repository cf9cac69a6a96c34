#include "worker/cli/completion.h"

#include <algorithm>

#include "kernels/host/text.h"

namespace penumbra {
namespace {

/// Types of options whose values are file names.
bool is_file_type(const std::string& type) {
  return type.starts_with("FILE") || type.starts_with("FOLDER") || type == "A" || type == "B" ||
         type.starts_with("TEXT");
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// The option with that name, including its dashes.
const Option* option_named(const CommandLine& app, const std::string& name) {
  return name.starts_with("-") ? app.find_option(name) : nullptr;
}

void add_values(const Option& option, const std::string& typed, const ValuesOf& values, Completion& found) {
  for (const std::string& choice : option.choices()) found.candidates.push_back({choice, ""});
  const std::string type = option.type();
  if (found.candidates.empty() && values) found.candidates = values(type, typed);
  found.files = found.candidates.empty() && is_file_type(type);
}

void add_options(const CommandLine& app, Completion& found) {
  for (const Option* option : app.options()) {
    if (option->group().empty() || option->is_positional()) continue;
    const std::string help = first_line(option->description());
    for (const std::string& name : option->long_names()) found.candidates.push_back({"--" + name, help});
    for (const std::string& name : option->short_names()) found.candidates.push_back({"-" + name, help});
  }
}

void add_commands(const CommandLine& app, Completion& found) {
  for (const CommandLine* command : app.commands())
    if (!command->group().empty())
      found.candidates.push_back({command->name(), first_line(command->description())});
}

/// Adds candidates for the next positional argument.
void add_positional(const CommandLine& app, std::size_t index, const std::string& typed,
                    const ValuesOf& values, Completion& found) {
  for (const Option* option : app.options()) {
    if (!option->is_positional()) continue;
    if (index == 0 || option->takes_several_values()) return add_values(*option, typed, values, found);
    --index;
  }
}

}  // namespace

Completion complete(const CommandLine& app, const std::vector<std::string>& words, const ValuesOf& values) {
  Completion found;
  const std::string typed = words.empty() ? "" : words.back();
  const CommandLine* command = &app;
  const Option* waits = nullptr;  // the option that still needs its value
  std::size_t positionals = 0;
  bool options_ended = false;
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    const std::string& word = words[i];
    if (waits != nullptr) {
      waits = nullptr;
    } else if (word == "--") {
      options_ended = true;
    } else if (const Option* option = options_ended ? nullptr : option_named(*command, word)) {
      if (option->takes_value()) waits = option;
    } else if (const CommandLine* sub = positionals == 0 ? command->find_command(word) : nullptr) {
      command = sub;
    } else if (!word.starts_with("-") || options_ended) {
      ++positionals;
    }
  }
  std::string before;  // the part of the word before the value, for --name=value
  const std::size_t equals = typed.find('=');
  if (waits == nullptr && !options_ended && typed.starts_with("--") && equals != std::string::npos) {
    before = typed.substr(0, equals + 1);
    waits = option_named(*command, typed.substr(0, equals));
    if (waits == nullptr || !waits->takes_value()) return {};
  }
  const std::string value = typed.substr(before.size());
  if (waits != nullptr)
    add_values(*waits, value, values, found);
  else if (typed.starts_with("-") && !options_ended)
    add_options(*command, found);
  else if (!command->commands().empty())
    add_commands(*command, found);
  else
    add_positional(*command, positionals, value, values, found);
  std::erase_if(found.candidates, [&](const Candidate& c) { return !c.word.starts_with(value); });
  for (Candidate& candidate : found.candidates) candidate.word.insert(0, before);
  return found;
}

std::string completion_text(const Completion& completion) {
  std::string text;
  for (const auto& [word, help] : completion.candidates)
    text += help.empty() ? word + "\n" : word + "\t" + help + "\n";
  return text + (completion.files ? ":files\n" : "");
}

std::string completion_script(const std::string& shell) {
  // bash splits words at = and :, so the script splits the line again; $2 is the part to be replaced.
  if (shell == "bash")
    return R"(# Completion of Penumbra's programs for bash.
_penumbra() {
  local line=${COMP_LINE:0:COMP_POINT} word files='' before
  local -a words names
  read -ra words <<<"$line"
  if [[ $line == *[[:space:]] ]]; then words+=(""); fi
  before=${words[-1]%"$2"}
  COMPREPLY=()
  while IFS=$'\t' read -r word _; do
    if [[ $word == :files ]]; then files=yes; else COMPREPLY+=("${word#"$before"}"); fi
  done < <("${1/#\~/$HOME}" complete "${words[@]:1}" 2>/dev/null)
  if [[ $files ]]; then
    mapfile -t names < <(compgen -f -- "$2")
    COMPREPLY+=("${names[@]}")
    compopt -o filenames 2>/dev/null
  fi
  if [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *= ]]; then compopt -o nospace 2>/dev/null; fi
}
complete -F _penumbra penumbra penumbra-worker penumbra-view penumbra-stress
)";
  if (shell == "zsh")
    return R"(#compdef penumbra penumbra-worker penumbra-view penumbra-stress
# Completion of Penumbra's programs for zsh.
_penumbra() {
  local line word help files=''
  local -a described going_on
  while IFS= read -r line; do
    if [[ $line == :files ]]; then files=yes; continue; fi
    word=${line%%$'\t'*}
    help=''
    if [[ $line == *$'\t'* ]]; then help=":${line#*$'\t'}"; fi
    if [[ $word == *= ]]; then going_on+=("$word"); continue; fi
    described+=("${word//:/\\:}$help")
  done < <(${(Q)words[1]} complete "${(@Q)words[2,CURRENT]}" 2>/dev/null)
  (( $#described )) && _describe -V penumbra described
  (( $#going_on )) && compadd -S '' -- "${going_on[@]}"
  [[ -n $files ]] && _files
}
if [[ $funcstack[1] == _penumbra ]]; then _penumbra "$@"; else compdef _penumbra penumbra penumbra-worker penumbra-view penumbra-stress; fi
)";
  if (shell == "fish")
    return R"(# Completion of Penumbra's programs for fish.
function __penumbra_complete
    set -l words (commandline -opc) (commandline -ct)
    for line in ($words[1] complete $words[2..-1] 2>/dev/null)
        if test "$line" = :files
            __fish_complete_path (commandline -ct)
        else
            echo $line
        end
    end
end
for program in penumbra penumbra-worker penumbra-view penumbra-stress
    complete -c $program -f -a '(__penumbra_complete)'
end
)";
  return {};
}

}  // namespace penumbra
