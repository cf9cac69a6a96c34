// Runs `cmake --install` into a new folder, then moves that folder; also tests the Debian package.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class Installed : public ::testing::Test {
 protected:
  void SetUp() override {
    const ProgramResult installed =
        run_shell(folder_.path(), "cmake --install '" PENUMBRA_BINARY_DIR
                                  "' --prefix \"$PWD/first\" && mkdir moved && mv first 'moved/to here'");
    ASSERT_EQ(installed.exit_code, 0) << installed.out << installed.err;
  }
  /// What a shell makes of the line in an environment with nothing of ours, where $P is the installed folder.
  ProgramResult in_clean_environment(const std::string& line) {
    write_text(folder_ / "line.sh", "P=\"$HOME/moved/to here\"\n" + line + "\n");
    return Program(folder_.path(), "/usr/bin/env",
                   {"-i", "HOME=" + folder_.path().string(), "PATH=/usr/bin:/bin", "bash", "line.sh"})
        .wait();
  }

  TemporaryFolder folder_;
};

TEST_F(Installed, RendersTheSameBytesAsWhereItWasBuilt) {
  const ProgramResult rendered = in_clean_environment(
      "cp -r \"$P/share/penumbra/scenes/cornell-small\" . && \"$P/bin/penumbra\" render "
      "cornell-small/cornell-small.xml --spp 4 --workers 2 -q -o installed.exr");
  ASSERT_EQ(rendered.exit_code, 0) << rendered.out << rendered.err;
  const ProgramResult built =
      run_shell(folder_.path(), "penumbra render cornell-small/cornell-small.xml --spp 4 -q -o built.exr");
  ASSERT_EQ(built.exit_code, 0) << built.err;
  EXPECT_EQ(file_contents(folder_ / "installed.exr"), file_contents(folder_ / "built.exr"));
  // The module that reads images is found from where the program is.
  const ProgramResult compared =
      in_clean_environment("\"$P/bin/penumbra\" compare installed.exr built.exr --fail-above mse=0");
  EXPECT_EQ(compared.exit_code, 0) << compared.out << compared.err;
}

TEST_F(Installed, ReadsTextures) {
  ASSERT_EQ(run_shell(folder_.path(), "penumbra render '" PENUMBRA_SOURCE_DIR
                                      "/scenes/furnace/furnace.xml' --spp 1 -q -o texture.png")
                .exit_code,
            0);
  write_text(folder_ / "textured.xml", R"(<scene version="3.0.0">
  <integrator type="path"/>
  <sensor type="perspective">
    <transform name="to_world"><lookat origin="0, 0, 3" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film>
  </sensor>
  <shape type="rectangle">
    <emitter type="area"><texture name="radiance" type="bitmap"><string name="filename" value="texture.png"/></texture></emitter>
  </shape>
</scene>
)");
  const ProgramResult rendered = in_clean_environment("\"$P/bin/penumbra\" render textured.xml --spp 1 -q");
  EXPECT_EQ(rendered.exit_code, 0) << rendered.out << rendered.err;
}

TEST_F(Installed, IsFoundThroughALinkAndThroughPath) {
  const ProgramResult listed = in_clean_environment(
      "mkdir bin && ln -s \"$P/bin/penumbra\" bin/ && PATH=$PWD/bin:$PATH penumbra worker --list-devices");
  EXPECT_EQ(listed.exit_code, 0) << listed.err;
  EXPECT_THAT(listed.out, ContainsRegex("native: (sse2|avx2|avx512)"));
}

TEST_F(Installed, HasItsPapers) {
  const ProgramResult listed = in_clean_environment("cd \"$P/share/doc/penumbra\" && find . -type f | sort");
  for (const char* name :
       {"./README.md\n", "./LICENSE\n", "./copyright\n", "./examples/penumbra-serve.service\n",
        "./examples/system/penumbra-serve.service\n"})
    EXPECT_THAT(listed.out, HasSubstr(name));
}

TEST_F(Installed, EveryProgramStarts) {
  std::string programs = "penumbra penumbra-worker penumbra-stress";
  if (has_window()) programs += " penumbra-view";
  const ProgramResult started = in_clean_environment(
      "for each in " + programs + "; do \"$P/bin/$each\" --help >/dev/null || echo $each; done");
  EXPECT_THAT(started.out, IsEmpty());
  EXPECT_THAT(started.err, IsEmpty());
}

TEST_F(Installed, KnowsNothingOfWhereItWasBuilt) {
  if (in_clean_environment("command -v readelf").exit_code != 0) GTEST_SKIP() << "there is no readelf";
  if (in_clean_environment("readelf -SW \"$P\"/bin/penumbra | grep -q debug_line").exit_code == 0)
    GTEST_SKIP() << "this build has debug information, as for sanitizers, which names the sources";
  const ProgramResult found = in_clean_environment("grep -rlF '" PENUMBRA_BINARY_DIR "' \"$P\"");
  EXPECT_EQ(found.exit_code, 1) << found.out << found.err;
  const ProgramResult paths =
      in_clean_environment("readelf -d \"$P\"/bin/* \"$P\"/lib/penumbra/* | grep -E 'RPATH|RUNPATH'");
  EXPECT_THAT(paths.out, IsEmpty());
}

TEST(Tarball, RendersWhereItIsUnpackedAndAfterItWasMoved) {
  const TemporaryFolder folder;
  const auto shell = [&](const std::string& line) { return run_shell(folder.path(), line); };
  if (shell("command -v cpack").exit_code != 0) GTEST_SKIP() << "there is no cpack";
  const ProgramResult packed =
      shell("cpack --config '" PENUMBRA_BINARY_DIR
            "/CPackConfig.cmake' -G TGZ -B \"$PWD\" && mv penumbra-*.tar.gz p.tar.gz");
  ASSERT_EQ(packed.exit_code, 0) << packed.out << packed.err;
  const ProgramResult unpacked =
      shell("mkdir there && tar xzf p.tar.gz -C there && ls there && mv there/* 'else where'");
  ASSERT_EQ(unpacked.exit_code, 0) << unpacked.err;
  EXPECT_THAT(unpacked.out, ::testing::MatchesRegex("penumbra-[0-9.]+-[a-z0-9_]+\n"))
      << "one folder, which says what it is";
  const ProgramResult run = shell(
      "cp -r 'else where/share/penumbra/scenes/cornell-small' . && env -i 'else where/bin/penumbra' render "
      "cornell-small/cornell-small.xml --spp 4 --workers 2 -q -o there.exr && penumbra render "
      "cornell-small/cornell-small.xml --spp 4 -q -o built.exr && cmp there.exr built.exr && "
      "env -i 'else where/bin/penumbra' compare there.exr built.exr --fail-above mse=0");
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
}

TEST(DebianPackage, NamesTheLibrariesThatItNeeds) {
  const TemporaryFolder folder;
  const auto shell = [&](const std::string& line) { return run_shell(folder.path(), line); };
  if (shell("command -v cpack dpkg-shlibdeps dpkg-deb").exit_code != 0)
    GTEST_SKIP() << "there are no tools for Debian packages";
  const ProgramResult packed = shell("cpack --config '" PENUMBRA_BINARY_DIR
                                     "/CPackConfig.cmake' -G DEB -B \"$PWD\" && mv penumbra_*.deb p.deb");
  ASSERT_EQ(packed.exit_code, 0) << packed.out << packed.err;
  const ProgramResult depends = shell("dpkg-deb -f p.deb Depends");
  EXPECT_THAT(depends.out,
              AllOf(HasSubstr("libc6 (>= "), HasSubstr("libembree3"), HasSubstr("libssl"),
                    HasSubstr("libopenimageio"), HasSubstr("libopenexr"), HasSubstr("libopencl")));
  const ProgramResult files = shell("dpkg-deb -c p.deb");
  for (const char* file :
       {"./usr/bin/penumbra\n", "./usr/bin/penumbra-worker\n",
        "./usr/lib/penumbra/libpenumbra_image_reader.so", "./usr/share/man/man1/penumbra-render.1",
        "./usr/share/bash-completion/completions/penumbra\n"})
    EXPECT_THAT(files.out, HasSubstr(file));
  EXPECT_THAT(files.out, Not(HasSubstr("/usr/include"))) << "nothing is built against it";
  // What is unpacked runs as it lies.
  const ProgramResult run = shell("dpkg-deb -x p.deb . && env -i ./usr/bin/penumbra --version");
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

}  // namespace
}  // namespace penumbra
