// The units of scheduler/packaging/systemd as their comments say, with what is installed, under a real
// systemd: a service that is killed is restarted and goes on, and its end is clean.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::systemd_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kCannot = 77;  // of under_systemd.sh

class Systemd : public ::testing::Test {
 protected:
  void SetUp() override {
    const ProgramResult installed =
        run_shell(folder_.path(), "cmake --install '" PENUMBRA_BINARY_DIR "' --prefix \"$PWD/installed\"");
    ASSERT_EQ(installed.exit_code, 0) << installed.out << installed.err;
    std::filesystem::create_directories(folder_ / "home/.config/systemd/user");
  }
  ProgramResult beside_systemd(const std::string& line) {
    write_text(folder_ / "line.sh", "set -eu\n" + line);
    return Program(
               folder_.path(), "/bin/bash",
               {source_path("tests/scheduler/packaging/under_systemd.sh"), (folder_ / "installed").string(),
                (folder_ / "home").string(), ". " + (folder_ / "line.sh").string()})
        .wait();
  }

  TemporaryFolder folder_;
};

TEST_F(Systemd, FindsNothingWrongWithTheUnits) {
  const ProgramResult verified =
      beside_systemd("systemd-analyze --user verify /usr/local/share/doc/penumbra/examples/*.service\n");
  if (verified.exit_code == kCannot) GTEST_SKIP() << verified.out;
  EXPECT_EQ(verified.exit_code, 0);
  EXPECT_THAT(verified.err, IsEmpty());
  const ProgramResult system =
      beside_systemd("systemd-analyze verify /usr/local/share/doc/penumbra/examples/system/*.service\n");
  EXPECT_EQ(system.exit_code, 0) << system.err;
}

TEST_F(Systemd, RestartsAServiceThatGoesOnAndEndsItCleanly) {
  // On one core and with frequent checkpoints, so that there is one before the job is over, also on a large
  // machine.
  const std::string line = R"sh(
units=~/.config/systemd/user
cp /usr/local/share/doc/penumbra/examples/penumbra-{serve,worker@}.service $units/
mkdir $units/penumbra-serve.service.d $units/penumbra-worker@.service.d
sed -i '/^ExecStart=/s/$/ --checkpoint-interval 0.1/' $units/penumbra-serve.service
for unit in serve worker@; do
  printf '[Service]\nCPUAffinity=0\nStandardOutput=append:%%h/units.log\nStandardError=append:%%h/units.log\n' \
    >$units/penumbra-$unit.service.d/here.conf
done
systemctl --user enable --now penumbra-serve penumbra-worker@1
export PENUMBRA_SERVICE=unix:$XDG_RUNTIME_DIR/penumbra/socket
of() { systemctl --user show --value -p "$2" penumbra-"$1"; }
wait_until() {
  for ((i = 0; i < 1200; ++i)); do
    if eval "$1"; then return; fi
    sleep 0.1
  done
  echo "never: $1"
  systemctl --user status --no-pager penumbra-serve penumbra-worker@1
  exit 1
}
wait_until 'penumbra status >/dev/null 2>&1'
penumbra submit /usr/local/share/penumbra/scenes/cornell-small/cornell-small.xml -D resolution=128 \
  --spp 512 -o there.exr -q
wait_until '[[ -n $(find ~/.local/state/penumbra/spool -name "*checkpoint*" -size +1k) ]]'
pid=$(of serve MainPID) worker=$(of worker@1 MainPID)
kill -KILL "$pid"
wait_until '[[ $(of serve NRestarts) == 1 && $(of serve ActiveState) == active ]]'
wait_until 'penumbra status >/dev/null 2>&1'
echo "restarted: $((pid != $(of serve MainPID)))"
timeout 240 penumbra fetch 1 --wait -o ~/fetched -q
echo "worker restarts: $(of worker@1 NRestarts), the same: $((worker == $(of worker@1 MainPID)))"
systemctl --user stop penumbra-serve
echo "serve: $(of serve Result) $(of serve ActiveState) $(of serve ExecMainStatus)"
systemctl --user stop penumbra-worker@1
echo "worker: $(of worker@1 Result) $(of worker@1 ActiveState) $(of worker@1 ExecMainStatus)"
)sh";
  const ProgramResult ran = beside_systemd(line);
  if (ran.exit_code == kCannot) GTEST_SKIP() << ran.out;
  const std::string log = file_contents(folder_ / "home/units.log");
  ASSERT_EQ(ran.exit_code, 0) << ran.out << ran.err << log;
  EXPECT_THAT(ran.out, HasSubstr("restarted: 1\n"));
  EXPECT_THAT(ran.out, HasSubstr("worker restarts: 0, the same: 1\n")) << "it waited for the service";
  EXPECT_THAT(ran.out, HasSubstr("serve: success inactive 0\n")) << log;
  EXPECT_THAT(ran.out, HasSubstr("worker: success inactive 0\n")) << log;
  EXPECT_THAT(log, HasSubstr("going on with")) << "of its checkpoint";
  const ProgramResult here =
      run_shell(folder_.path(),
                "penumbra render installed/share/penumbra/scenes/cornell-small/cornell-small.xml -D "
                "resolution=128 --spp 512 -q "
                "-o here.exr && cmp here.exr home/fetched/there.exr");
  EXPECT_EQ(here.exit_code, 0) << here.out << here.err;
}

}  // namespace
}  // namespace penumbra::systemd_test
