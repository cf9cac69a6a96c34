// What could stand next on a command line: for shells, from the tables that parse it.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace penumbra {

struct Candidate {
  std::string word;  ///< the whole word, as far as it is known: KEY= goes on
  std::string help;  ///< one line, or nothing
  bool operator==(const Candidate&) const = default;
};

struct Completion {
  std::vector<Candidate> candidates;
  bool files = false;  ///< or a file's name
};

/// All values of an option of that type (FILE, KEY=VALUE…) which CLI11 does not know, for what is typed of
/// one so far. May be empty.
using ValuesOf = std::function<std::vector<Candidate>(const std::string& type, const std::string& typed)>;

/// `words` is what follows the program's name; the last one is being typed, and may be empty. Only what
/// begins with it is in the answer.
Completion complete(const CLI::App& app, const std::vector<std::string>& words, const ValuesOf& values = {});

/// A line for each: word, tab, help; ":files" where files are meant too.
std::string completion_text(const Completion& completion);

/// What a shell loads: bash, zsh or fish; it asks `PROGRAM complete WORD…`. Empty for others.
std::string completion_script(const std::string& shell);

}  // namespace penumbra
