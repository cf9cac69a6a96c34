#include "worker/cli/command_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <set>
#include <sstream>
#include <type_traits>

#include "kernels/host/console.h"
#include "kernels/host/plain_file.h"
#include "kernels/host/text.h"
#include "worker/cli/help_text.h"

namespace penumbra {
namespace {

std::string none_of_text(const std::string& text, const std::vector<std::string>& words) {
  return fmt::format("'{}' is none of {}{}", text, fmt::join(words, ", "), suggestion(text, words));
}

std::vector<std::string> sorted_names(const std::set<CLI::Option*>& options) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options) names.push_back(option->get_name());
  std::ranges::sort(names);
  return names;
}

/// Of a variable, or of one value where it has none or several.
template <typename Variable>
constexpr ValueKind kind_of() {
  if constexpr (std::is_same_v<Variable, std::string>) return ValueKind::kText;
  if constexpr (requires { typename Variable::value_type; }) return kind_of<typename Variable::value_type>();
  if constexpr (std::is_same_v<Variable, bool>) return ValueKind::kFlag;
  return std::is_floating_point_v<Variable> ? ValueKind::kNumber : ValueKind::kInteger;
}

template <typename Value>
CLI::Option* add_function(CLI::App& app, const std::string& names, std::function<Expected<void>(Value)> take,
                          const std::string& description) {
  return app.add_option_function<std::decay_t<Value>>(
      names,
      [names, take = std::move(take)](Value value) {
        if (const auto taken = take(value); !taken) throw CLI::ValidationError(names, taken.error().message);
      },
      description);
}

/// In place of "--spp: 1 required N missing".
std::string message_of(const CLI::ParseError& error) {
  const std::string text = error.what();
  const std::size_t end = text.find(": ");
  const bool is_without_value = dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr &&
                                text.ends_with(" missing") && end != std::string::npos;
  return is_without_value ? fmt::format("{} needs a value", text.substr(0, end)) : text;
}

/// Our help in place of the library's.
class HelpFormatter final : public CLI::Formatter {
 public:
  explicit HelpFormatter(const CommandLine& command) : command_(command) {}

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    const bool is_short = mode != CLI::AppFormatMode::All && !command_.short_help().empty();
    return help_text(command_, make_usage(app, std::move(name)), is_short);
  }

 private:
  const CommandLine& command_;
};

}  // namespace

OptionCheck one_of(std::vector<std::string> words) {
  std::string limits = fmt::format("{{{}}}", fmt::join(words, ","));
  return {[words = std::move(words)](const std::string& text) {
            return std::ranges::find(words, text) != words.end() ? std::string() : none_of_text(text, words);
          },
          std::move(limits)};
}

OptionCheck existing_file() {
  return {[](const std::string& text) -> std::string {
    std::error_code ignored;
    if (!std::filesystem::exists(text, ignored))
      return fmt::format("there is no file '{}'{}", text, file_suggestion(text));
    return std::filesystem::is_directory(text, ignored) ? fmt::format("'{}' is a folder", text) : "";
  }};
}

OptionCheck whole_number_or(int low, int high, const std::string& word) {
  const std::string limits = fmt::format("{} to {}, or {}", low, high, word);
  return {[=](const std::string& text) -> std::string {
            int value = 0;
            const char* end = text.data() + text.size();
            const auto [at, error] = std::from_chars(text.data(), end, value);
            const bool is_number = error == std::errc() && at == end;
            if (text == word || (is_number && value >= low && value <= high)) return {};
            return fmt::format("'{}' is neither a whole number from {} to {} nor {}", text, low, high, word);
          },
          limits};
}

OptionCheck size_in_bytes() {
  return {[size = CLI::AsSizeValue(false)](std::string& text) {
    const std::string given = text;
    try {
      if (size(text).empty()) return std::string();
    } catch (const CLI::ValidationError&) {  // of an unknown unit
    }
    return fmt::format("'{}' is no size in bytes, as in 20G, 512M or 65536", given);
  }};
}

Option* Option::type_name(const std::string& name) { return option_.type_name(name), this; }
Option* Option::kind(ValueKind kind) { return kind_ = kind, this; }
Option* Option::group(const std::string& name) { return option_.group(name), this; }
Option* Option::description(const std::string& text) { return option_.description(text), this; }
Option* Option::required(bool is_required) { return option_.required(is_required), this; }

Option* Option::check(const OptionCheck& check) {
  return option_.check(CLI::Validator(check.wrong, check.limits)), this;
}

Option* Option::transform(const OptionCheck& check) {
  return option_.transform(CLI::Validator(check.wrong, check.limits)), this;
}

Option* Option::expected(int least, int most) { return option_.expected(least, most), this; }

Option* Option::repeatable() {
  option_.expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  return this;
}

Option* Option::allow_extra_args(bool allow) { return option_.allow_extra_args(allow), this; }
Option* Option::delimiter(char separator) { return option_.delimiter(separator), this; }
Option* Option::capture_default_str() { return option_.capture_default_str(), this; }
Option* Option::default_str(const std::string& text) { return option_.default_str(text), this; }
Option* Option::envname(const std::string& name) { return option_.envname(name), this; }
Option* Option::needs(const Option* other) { return option_.needs(&other->option_), this; }
Option* Option::needs(const std::string& name) { return option_.needs(name), this; }
Option* Option::excludes(const Option* other) { return option_.excludes(&other->option_), this; }
Option* Option::excludes(const std::string& name) { return option_.excludes(name), this; }

std::string Option::name() const { return option_.get_name(); }
const std::vector<std::string>& Option::long_names() const { return option_.get_lnames(); }
const std::vector<std::string>& Option::short_names() const { return option_.get_snames(); }
const std::string& Option::group() const { return option_.get_group(); }
const std::string& Option::description() const { return option_.get_description(); }
std::string Option::type() const { return option_.get_type_name(); }
std::vector<std::string> Option::choices() const {
  const std::string type = this->type();
  const std::size_t open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  std::vector<std::string> words;
  for (std::size_t at = open + 1; at < close;) {
    const std::size_t end = std::min(type.find(',', at), close);
    words.push_back(type.substr(at, end - at));
    at = end + 1;
  }
  return words;
}
std::string Option::default_str() const { return option_.get_default_str(); }
std::string Option::envname() const { return option_.get_envname(); }
std::vector<std::string> Option::needed() const { return sorted_names(option_.get_needs()); }
std::vector<std::string> Option::excluded() const { return sorted_names(option_.get_excludes()); }
bool Option::is_positional() const { return option_.get_positional(); }
bool Option::is_required() const { return option_.get_required(); }
bool Option::takes_value() const { return option_.get_expected_max() > 0; }
bool Option::needs_value() const { return option_.get_expected_min() > 0; }
bool Option::takes_several_values() const {
  return option_.get_expected_max() > 1 ||
         (takes_value() && option_.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll);
}
std::string Option::flag_value(const std::string& long_name) const {
  return option_.get_flag_value(long_name, "");
}
bool Option::is_given() const { return option_.count() > 0; }
const std::vector<std::string>& Option::results() const { return option_.results(); }

CommandLine::CommandLine(const std::string& description, const std::string& name)
    : app_(std::make_shared<CLI::App>(description, name)) {
  begin();
}

CommandLine::CommandLine(std::shared_ptr<CLI::App> app) : app_(std::move(app)) { begin(); }

CommandLine::~CommandLine() = default;

void CommandLine::begin() {
  app_->formatter(std::make_shared<HelpFormatter>(*this));
  wrapped(app_->get_help_ptr())->description("Show this help")->group(group::kGeneral);
}

Option* CommandLine::wrapped(CLI::Option* option) {
  return options_.emplace_back(std::make_unique<Option>(*option)).get();
}

Option* CommandLine::add_option(const std::string& names, OptionTarget target,
                                const std::string& description) {
  return std::visit(
      [&](auto variable) {
        using Variable = typename decltype(variable)::type;
        return wrapped(app_->add_option(names, variable.get(), description))->kind(kind_of<Variable>());
      },
      target);
}

Option* CommandLine::add_option_function(const std::string& names,
                                         std::function<Expected<void>(const std::string&)> take,
                                         const std::string& description) {
  return wrapped(add_function(*app_, names, std::move(take), description));
}

Option* CommandLine::add_option_function(const std::string& names, std::function<Expected<void>(double)> take,
                                         const std::string& description) {
  return wrapped(add_function(*app_, names, std::move(take), description))->kind(ValueKind::kNumber);
}

Option* CommandLine::add_option_function(const std::string& names,
                                         std::function<Expected<void>(const std::vector<std::string>&)> take,
                                         const std::string& description) {
  return wrapped(add_function(*app_, names, std::move(take), description));
}

Option* CommandLine::add_choice(const std::string& names,
                                const std::vector<std::pair<std::string, int>>& choices,
                                std::function<void(int)> take, const std::string& description) {
  Option* option = wrapped(app_->add_option_function<int>(names, std::move(take), description));
  return option->transform({[choices](std::string& text) -> std::string {
    const auto chosen = std::ranges::find(choices, text, &std::pair<std::string, int>::first);
    if (chosen != choices.end()) return text = fmt::to_string(chosen->second), std::string();
    std::vector<std::string> words;
    for (const auto& [word, number] : choices) words.push_back(word);
    return none_of_text(text, words);
  }});
}

Option* CommandLine::add_flag(const std::string& names, FlagTarget target, const std::string& description) {
  return std::visit(
      [&](auto variable) {
        return wrapped(app_->add_flag(names, variable.get(), description))->kind(ValueKind::kFlag);
      },
      target);
}

std::string flag_word(const std::string& text) {
  bool given = false;
  if (!CLI::detail::lexical_cast(text, given)) return text;
  return given ? "true" : "false";
}

Option* CommandLine::add_flag_function(const std::string& names,
                                       std::function<Expected<void>(const std::string&)> take,
                                       const std::string& description) {
  const auto value = std::make_shared<std::string>();
  CLI::Option* option = app_->add_flag(names, *value, description);
  option->each([names, value, take = std::move(take)](const std::string& text) {
    if (const auto taken = take(text); !taken) throw CLI::ValidationError(names, taken.error().message);
  });
  return wrapped(option)->kind(ValueKind::kFlag);
}

Option* CommandLine::add_action_flag(const std::string& names, std::function<void()> act,
                                     const std::string& description) {
  const auto act_and_end = [act = std::move(act)] {
    act();
    throw CLI::Success();
  };
  return wrapped(app_->add_flag_callback(names, act_and_end, description)->trigger_on_parse());
}

void CommandLine::add_version(std::function<std::string()> text) {
  wrapped(app_->set_version_flag("--version", std::move(text), "Show the version"))->group(group::kGeneral);
}

void CommandLine::default_group(const std::string& name) { app_->option_defaults()->group(name); }

void CommandLine::remove_option(const Option* option) {
  app_->remove_option(&option->option_);
  short_help_.erase(option);
  std::erase_if(options_, [&](const auto& each) { return each.get() == option; });
}

CommandLine* CommandLine::add_command(const std::string& name, const std::string& description) {
  std::shared_ptr<CLI::App> command(app_, app_->add_subcommand(name, description));
  commands_.push_back(std::unique_ptr<CommandLine>(new CommandLine(std::move(command))));
  return commands_.back().get();
}

void CommandLine::require_command() { app_->require_subcommand(1); }
void CommandLine::prefix_command() { app_->prefix_command(); }
void CommandLine::callback(std::function<void()> run) { app_->callback(std::move(run)); }
void CommandLine::footer(const std::string& text) { app_->footer(text); }
void CommandLine::explain(std::function<std::string(const std::string& word)> explain) {
  explain_ = std::move(explain);
}

void CommandLine::short_help(std::vector<std::string> names) {
  if (short_help_.empty())
    wrapped(app_->set_help_all_flag("--help-all", "Show the help of all options"))->group(group::kGeneral);
  for (const std::string& name : names) short_help_.insert(option(name));
}

void CommandLine::group(const std::string& name) { app_->group(name); }

std::string CommandLine::name() const { return app_->get_name(); }
std::string CommandLine::description() const { return app_->get_description(); }
std::string CommandLine::footer() const { return app_->get_footer(); }
const std::string& CommandLine::group() const { return app_->get_group(); }

std::vector<Option*> CommandLine::options() const {
  std::vector<Option*> all;
  for (const auto& option : options_) all.push_back(option.get());
  return all;
}

std::vector<CommandLine*> CommandLine::commands() const {
  std::vector<CommandLine*> all;
  for (const auto& command : commands_) all.push_back(command.get());
  return all;
}

Option* CommandLine::find_option(const std::string& name) const {
  const CLI::Option* found = app_->get_option_no_throw(name);
  const auto option =
      std::ranges::find_if(options_, [&](const auto& each) { return &each->option_ == found; });
  return option == options_.end() ? nullptr : option->get();
}

Option* CommandLine::option(const std::string& name) const {
  Option* found = find_option(name);
  if (found == nullptr) throw CLI::OptionNotFound(name);
  return found;
}

CommandLine* CommandLine::find_command(const std::string& name) const {
  const auto command =
      std::ranges::find_if(commands_, [&](const auto& each) { return each->name() == name; });
  return command == commands_.end() ? nullptr : command->get();
}

std::string CommandLine::help() const { return app_->help(); }

std::optional<ExitCode> CommandLine::parse(int argc, const char* const* argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream answer, ignored;
    if (app_->exit(error, answer, ignored) == 0) return print_answer(answer.str()), kAllDone;
    return refuse(message_of(error));
  }
  return std::nullopt;
}

Expected<void> CommandLine::parse(std::vector<std::string> words) {
  std::ranges::reverse(words);  // the order that the library expects
  try {
    app_->parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    return fail(message_of(error));
  }
  return {};
}

ExitCode CommandLine::refuse(const std::string& what) const {
  const auto chosen = std::as_const(*app_).get_subcommands();
  const CommandLine& command = chosen.empty() ? *this : *find_command(chosen.front()->get_name());
  const std::string called = chosen.empty() ? name() : name() + " " + command.name();
  const auto unknown = command.app_->remaining();
  const std::string why = unknown.empty() ? what : command.why_unexpected(unknown.front());
  print_message(fmt::format("{}: error: {}\nRun '{} --help' for what there is.", called, why, called));
  return kBadInput;
}

std::string CommandLine::why_unexpected(const std::string& word) const {
  std::string why = fmt::format("unexpected argument '{}'", word);
  const std::string better = explain_ ? explain_(word) : std::string();
  return why + (better.empty() ? suggestion(word, known_names(word)) : "; " + better);
}

/// The names that the command accepts: its options if the unknown word is an option, else its commands.
std::vector<std::string> CommandLine::known_names(const std::string& unknown) const {
  std::vector<std::string> names;
  if (unknown.starts_with("-")) {
    for (const auto& option : options_)
      for (const std::string& name : option->long_names()) names.push_back("--" + name);
  } else {
    for (const auto& command : commands_) names.push_back(command->name());
  }
  return names;
}

}  // namespace penumbra
