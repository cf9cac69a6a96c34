// Shell completion: the words that may come next on a command line, from the parser's tables.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "worker/cli/command_line.h"

namespace penumbra {

struct Candidate {
  std::string word;  ///< the whole word; one that ends in KEY= is still incomplete
  std::string help;  ///< one line, or empty
  bool operator==(const Candidate&) const = default;
};

struct Completion {
  std::vector<Candidate> candidates;
  bool files = false;  ///< file names are possible too
};

/// All values for an option of that type (FILE, KEY=VALUE…), if its checks do not tell. `typed` is the text
/// typed so far. May be empty.
using ValuesOf = std::function<std::vector<Candidate>(const std::string& type, const std::string& typed)>;

/// `words` are the words after the program's name. The last one is being typed and may be empty. Only
/// candidates that begin with it are returned.
Completion complete(const CommandLine& app, const std::vector<std::string>& words,
                    const ValuesOf& values = {});

/// One line per candidate: word, tab, help. ":files" if file names are possible too.
std::string completion_text(const Completion& completion);

/// The completion script for bash, zsh or fish, which calls `PROGRAM complete WORD…`. Empty for other shells.
std::string completion_script(const std::string& shell);

}  // namespace penumbra
