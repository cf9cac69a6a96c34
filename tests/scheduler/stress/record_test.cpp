// Compares the whole table of `penumbra stress` with tests/scheduler/stress/record.json. No case may fail or
// vanish, no truth may change, and no verdict may change unnoticed. After an improvement or a new case, run
// this test with PENUMBRA_UPDATE_RECORD=1 in the environment, and read the changes of the record. A case that
// fails makes the test fail even then.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

// Truths are computed in 113 bits and kept to 12 digits; condition numbers are of first order.
constexpr double kTruthDigits = 1e-11, kAllowedDigits = 2e-2;

double rounded(const nlohmann::json& number, const char* format) {
  char text[40];
  std::snprintf(text, sizeof text, format, number.get<double>());
  return std::strtod(text, nullptr);
}

/// What of the table is the same on every machine.
nlohmann::ordered_json record_of(const nlohmann::json& table) {
  nlohmann::ordered_json record = nlohmann::ordered_json::array();
  for (const auto& c : table["cases"]) {
    nlohmann::ordered_json entry;
    entry["name"] = c["name"];
    entry["verdict"] = c["verdict"];
    if (c.contains("truth")) {
      entry["truth"] = nlohmann::ordered_json::array();
      for (const auto& t : c["truth"]) entry["truth"].push_back(rounded(t, "%.12g"));
      entry["allowed"] = rounded(c["allowed_error"], "%.3g");
    }
    record.push_back(entry);
  }
  return record;
}

/// One case a line, for people who read what changed.
void write_record(const std::string& path, const nlohmann::ordered_json& record) {
  std::ofstream file(path);
  file << "[\n";
  for (std::size_t i = 0; i < record.size(); ++i)
    file << record[i].dump() << (i + 1 < record.size() ? ",\n" : "\n");
  file << "]\n";
}

bool near(double a, double b, double relative) {
  return a == b || std::abs(a - b) <= relative * std::max(std::abs(a), std::abs(b)) ||
         std::abs(a - b) < 1e-30;
}

TEST(StressTable, IsThatOfTheRecord) {
  const TemporaryFolder folder;
  const ProgramResult result = run_penumbra(folder.path(), {"stress", "--json", "table.json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::ifstream table_file(folder.path() / "table.json");
  const auto record = record_of(nlohmann::json::parse(table_file));
  const std::string path = source_path("tests/scheduler/stress/record.json");
  if (std::getenv("PENUMBRA_UPDATE_RECORD") != nullptr) write_record(path, record);
  std::ifstream record_file(path);
  const auto expected = nlohmann::json::parse(record_file);

  std::map<std::string, nlohmann::json> found;
  for (const auto& entry : record) {
    found[entry["name"]] = entry;
    EXPECT_NE(entry["verdict"], "FAIL") << entry["name"];
  }
  EXPECT_EQ(record.size(), expected.size());
  for (const auto& entry : expected) {
    const std::string name = entry["name"];
    ASSERT_TRUE(found.contains(name)) << name << " has vanished";
    const nlohmann::json& now = found[name];
    EXPECT_EQ(now["verdict"], entry["verdict"]) << name;
    if (!entry.contains("truth")) continue;
    ASSERT_EQ(now["truth"].size(), entry["truth"].size()) << name;
    for (std::size_t i = 0; i < entry["truth"].size(); ++i)
      EXPECT_TRUE(near(now["truth"][i], entry["truth"][i], kTruthDigits)) << name << ": " << now["truth"];
    EXPECT_TRUE(near(now["allowed"], entry["allowed"], kAllowedDigits)) << name << ": " << now["allowed"];
  }
}

}  // namespace
}  // namespace penumbra
