// The command line of a program, and of each of its commands: options, parsing, and what to say about bad
// usage. The library that does the parsing is known to command_line.cpp alone, because it takes long to
// compile.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "kernels/host/error.h"
#include "worker/cli/exit_code.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace penumbra {

/// A check of the text of a value. More of them are in option_checks.h.
struct OptionCheck {
  /// Returns what is wrong with the text, or an empty text. May rewrite it, for Option::transform.
  std::function<std::string(std::string& text)> wrong;
  std::string limits = {};  ///< shown in the help; may be empty

  /// The same, not shown in the help.
  [[nodiscard]] OptionCheck hidden() const { return {wrong, ""}; }
};

/// One of these words. The help lists them.
OptionCheck one_of(std::vector<std::string> words);
OptionCheck existing_file();
/// "true" or "false" for the words that flags take: 1, on, yes, 0, off, no and the like. Other texts stay.
std::string flag_word(const std::string& text);
/// A whole number in this range, or the word.
OptionCheck whole_number_or(int low, int high, const std::string& word);
/// For Option::transform: a size such as 20G becomes its number of bytes. K is 1024.
OptionCheck size_in_bytes();

/// What the text of a value stands for.
enum class ValueKind { kFlag, kInteger, kNumber, kText };

/// An option, a flag or a positional argument. It belongs to its command line.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(option) {}
  Option(const Option&) = delete;
  Option& operator=(const Option&) = delete;

  // What is set returns the option, for the next call.
  Option* type_name(const std::string& name);
  /// Without: that of the variable that stores the value, else text.
  Option* kind(ValueKind kind);
  /// An option without a group is hidden: it is neither in the help nor completed.
  Option* group(const std::string& name);
  Option* description(const std::string& text);
  Option* required(bool is_required = true);
  Option* check(const OptionCheck& check);
  /// A check that may rewrite the text. The last one added runs first, and all before those of check().
  Option* transform(const OptionCheck& check);
  /// The number of values.
  Option* expected(int least, int most);
  /// May be given several times, with one value each; all count.
  Option* repeatable();
  /// Without: one value for each time that the option is given.
  Option* allow_extra_args(bool allow);
  /// What separates values within a word.
  Option* delimiter(char separator);
  /// Shows the variable's value before parsing as the default.
  Option* capture_default_str();
  Option* default_str(const std::string& text);
  /// The environment variable that stands for the option.
  Option* envname(const std::string& name);
  Option* needs(const Option* other);
  Option* needs(const std::string& name);
  Option* excludes(const Option* other);
  Option* excludes(const std::string& name);

  /// The first long name with its dashes, else the first short one, else that of the positional argument.
  /// Empty if the option is hidden.
  [[nodiscard]] std::string name() const;
  /// All names without dashes.
  [[nodiscard]] const std::vector<std::string>& long_names() const;
  [[nodiscard]] const std::vector<std::string>& short_names() const;
  [[nodiscard]] const std::string& group() const;
  [[nodiscard]] const std::string& description() const;
  /// Its type's name, with the limits of its checks: "NAME:{direct,path}".
  [[nodiscard]] std::string type() const;
  /// The words of a type such as "NAME:{direct,path}". Empty: it has other values.
  [[nodiscard]] std::vector<std::string> choices() const;
  [[nodiscard]] ValueKind kind() const { return kind_; }
  /// The default that the help shows.
  [[nodiscard]] std::string default_str() const;
  [[nodiscard]] std::string envname() const;
  /// The names of the options that this one needs, or cannot be given with, sorted.
  [[nodiscard]] std::vector<std::string> needed() const;
  [[nodiscard]] std::vector<std::string> excluded() const;
  [[nodiscard]] bool is_positional() const;
  [[nodiscard]] bool is_required() const;
  [[nodiscard]] bool takes_value() const;
  [[nodiscard]] bool needs_value() const;
  [[nodiscard]] bool takes_several_values() const;
  /// What a flag stands for under this long name when it has no value: "true", unless another was chosen.
  [[nodiscard]] std::string flag_value(const std::string& long_name) const;

  // After parsing:
  [[nodiscard]] bool is_given() const;
  /// The values as they were given, transformed.
  [[nodiscard]] const std::vector<std::string>& results() const;

 private:
  friend class CommandLine;
  CLI::Option& option_;
  ValueKind kind_ = ValueKind::kText;
};

/// Where the value of an option is stored: a variable of one of these types.
template <typename... Types>
using AnyOf = std::variant<std::reference_wrapper<Types>...>;
using OptionTarget = AnyOf<int, std::uint32_t, std::uint64_t, float, double, std::string, std::vector<int>,
                           std::vector<std::string>, std::optional<int>, std::optional<std::uint32_t>,
                           std::optional<std::uint64_t>, std::optional<double>, std::optional<std::string>>;
using FlagTarget = AnyOf<bool, std::string>;

/// The command line of a program, or of one of its commands. It has --help. Targets must outlive the parsing.
/// Names are separated by commas: "-o,--out"; a name without dashes is a positional argument.
class CommandLine {
 public:
  explicit CommandLine(const std::string& description, const std::string& name = "");
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  Option* add_option(const std::string& names, OptionTarget target, const std::string& description);
  /// Options whose value is taken by a function. If it fails, that is bad usage: "NAMES: MESSAGE".
  Option* add_option_function(const std::string& names,
                              std::function<Expected<void>(const std::string&)> take,
                              const std::string& description = "");
  Option* add_option_function(const std::string& names, std::function<Expected<void>(double)> take,
                              const std::string& description);
  /// Takes the values of all times that the option is given.
  Option* add_option_function(const std::string& names,
                              std::function<Expected<void>(const std::vector<std::string>&)> take,
                              const std::string& description);
  /// An option whose values are these names; `take` gets the number of the chosen one.
  Option* add_choice(const std::string& names, const std::vector<std::pair<std::string, int>>& choices,
                     std::function<void(int)> take, const std::string& description);
  /// "--flag{value}" is a flag whose target becomes `value`, or what it is given as --flag=other.
  Option* add_flag(const std::string& names, FlagTarget target, const std::string& description);
  /// The same for a function that takes the value, "true" without one.
  Option* add_flag_function(const std::string& names, std::function<Expected<void>(const std::string&)> take,
                            const std::string& description);
  /// A flag like --help: as soon as it is read, `act` runs, and the program ends with kAllDone.
  Option* add_action_flag(const std::string& names, std::function<void()> act,
                          const std::string& description);
  /// Adds --version, which prints the text.
  void add_version(std::function<std::string()> text);
  /// The group of options that are added from now on.
  void default_group(const std::string& name);
  void remove_option(const Option* option);

  CommandLine* add_command(const std::string& name, const std::string& description);
  void require_command();
  /// All that follows the command's name is left alone.
  void prefix_command();
  /// Runs at the end of the parsing if this command was chosen.
  void callback(std::function<void()> run);
  /// Text at the end of the help.
  void footer(const std::string& text);
  /// What to say about a word that is neither an option nor an argument, such as what is right instead; if it
  /// returns an empty text, the nearest name is suggested.
  void explain(std::function<std::string(const std::string& word)> explain);
  /// --help shows these options only, the examples of the footer, and how to see the rest; --help-all, which
  /// this adds, shows all. May be called again with more.
  void short_help(std::vector<std::string> names);
  /// The heading under which the program's help lists this command.
  void group(const std::string& name);

  [[nodiscard]] std::string name() const;
  [[nodiscard]] std::string description() const;
  [[nodiscard]] std::string footer() const;
  [[nodiscard]] const std::string& group() const;
  /// The options that short_help chose; empty: --help shows all.
  [[nodiscard]] const std::set<const Option*>& short_help() const { return short_help_; }
  /// In the order in which they were added.
  [[nodiscard]] std::vector<Option*> options() const;
  [[nodiscard]] std::vector<CommandLine*> commands() const;
  /// The option with this name, dashes included; null if there is none.
  [[nodiscard]] Option* find_option(const std::string& name) const;
  /// The same for options that exist.
  [[nodiscard]] Option* option(const std::string& name) const;
  /// The command with this name; null if there is none.
  [[nodiscard]] CommandLine* find_command(const std::string& name) const;
  /// The help of the program, or of the command that was chosen.
  [[nodiscard]] std::string help() const;

  /// Parses what main gets. Returns the exit code if the program ends with that: what was asked for, such as
  /// the help, or the error is printed.
  std::optional<ExitCode> parse(int argc, const char* const* argv);
  /// Parses the words after the program's name, and prints nothing.
  Expected<void> parse(std::vector<std::string> words);
  /// Prints this error with a pointer to the help, as parse does.
  ExitCode refuse(const std::string& what) const;

 private:
  explicit CommandLine(std::shared_ptr<CLI::App> app);
  void begin();
  Option* wrapped(CLI::Option* option);
  [[nodiscard]] std::vector<std::string> known_names(const std::string& unknown) const;
  [[nodiscard]] std::string why_unexpected(const std::string& word) const;

  std::shared_ptr<CLI::App> app_;  // a command's belongs to the program's
  std::vector<std::unique_ptr<Option>> options_;
  std::vector<std::unique_ptr<CommandLine>> commands_;
  std::function<std::string(const std::string& word)> explain_;
  std::set<const Option*> short_help_;
};

}  // namespace penumbra
