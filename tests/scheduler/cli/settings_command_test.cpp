#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes/settings.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

TEST(SettingsCommand, PrintsTheTable) {
  const TemporaryFolder folder;
  const ProgramResult result = run_penumbra(folder.path(), {"settings"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, settings_table());
}

}  // namespace
}  // namespace penumbra
