# What .ci/run and .ci/nightly share. To be sourced, in the project's folder.

# Compiled files are kept from one run to the next, whichever folder the clone is in.
export CCACHE_DIR=${CCACHE_DIR:-/var/tmp/penumbra-ccache-$(id -u)} CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=true CCACHE_MAXSIZE=5G

# Stacks with names; and what libraries do within themselves is not ours to report. LLVM within PoCL gives its threads stacks
# for signals and keeps those that the sanitizer gave them.
export ASAN_SYMBOLIZER_PATH=/usr/bin/llvm-symbolizer-19 TSAN_SYMBOLIZER_PATH=/usr/bin/llvm-symbolizer-19
export ASAN_OPTIONS="use_sigaltstack=0${ASAN_OPTIONS:+:$ASAN_OPTIONS}"
export TSAN_OPTIONS="suppressions=$PWD/.ci/tsan.supp${TSAN_OPTIONS:+:$TSAN_OPTIONS}"
export LSAN_OPTIONS="suppressions=$PWD/.ci/lsan.supp:print_suppressions=0${LSAN_OPTIONS:+:$LSAN_OPTIONS}"

timings=()

# step NAME COMMAND...: runs it and notes its time. Where it fails, everything ends.
step() {
  local name=$1 from=$SECONDS
  shift
  printf '\n=== %s\n' "$name"
  if ! "$@"; then
    printf '=== %s: FAILED after %d s\n' "$name" $((SECONDS - from)) >&2
    exit 1
  fi
  timings+=("$(printf '%6d s  %s' $((SECONDS - from)) "$name")")
}

all_passed() {
  printf '\n=== all passed\n'
  printf '%s\n' "${timings[@]}"
}

check_format() {
  local formatter files
  formatter=$(command -v clang-format-14 || command -v clang-format)
  mapfile -t files < <(git -c safe.directory="$PWD" ls-files -- '*.h' '*.cpp' '*.cl')
  if ((${#files[@]} == 0)); then
    echo "no source files found: is this a git clone?" >&2
    return 1
  fi
  "$formatter" --dry-run --Werror "${files[@]}" && echo "${#files[@]} files are formatted."
}

# configure PRESET [ARGUMENT...]: with warnings as errors, which later configurations of the preset keep.
configure() {
  local preset=$1
  shift
  cmake --preset "$preset" -DPENUMBRA_WARNINGS_AS_ERRORS=ON "$@" >/dev/null
}

# work LIMIT COMMAND...: runs it, and fails where it takes more work than LIMIT, in the unit of ../shared/yard, which does not
# depend on the machine.
work() {
  local limit=$1 report yards
  shift
  report=$(mktemp)
  if ! CCACHE_DISABLE=1 "$shared/yard/yards" "$@" 2> >(tee "$report" >&2); then return 1; fi
  yards=$(sed -nE 's/.*: ([0-9]+) yards$/\1/p' "$report" | tail -n 1)
  echo "$* takes $yards yards, of at most $limit."
  ((yards <= limit))
}

# check_work: the README's two commands in a new clone.
check_work() {
  local shared=$PWD/../shared folder
  if [[ ! -x $shared/yard/yards ]]; then
    echo "skipped: there is no ../shared/yard"
    return
  fi
  folder=$(mktemp -d)
  ln -s "$shared" "$folder/shared"
  git -c safe.directory="$PWD" clone -q . "$folder/penumbra"
  (
    cd "$folder/penumbra"
    work 90 bash scenes/quickstart.sh "$folder/out" && work 200 bash tests/run.sh
  ) && rm -rf "$folder"
}

# build PRESET TARGET...
build() {
  local preset=$1
  shift
  configure "$preset" && cmake --build --preset "$preset" --target "$@"
}

# build_and_test PRESET FOLDER [CTEST ARGUMENT...]: the tests of a folder of tests/.
build_and_test() {
  local preset=$1 folder=$2
  shift 2
  build "$preset" "$folder/all" || return 1
  ctest --test-dir "build/$preset/$folder" --output-on-failure --parallel "$(nproc)" "$@"
}

# check_blender VERSION [CTEST ARGUMENT...]: the tests of the extension for Blender, by bpy of that series.
check_blender() {
  local python status=0
  python=$(bash .ci/install_blender.sh "$1") || status=$?
  if ((status == 77)); then return 0; fi
  ((status == 0)) || return 1
  shift
  PENUMBRA_BLENDER_PYTHON=$python build_and_test release tests/scenes/blender -L blender "$@"
}

# build_and_run PRESET TEST FILTER: some tests of one executable.
build_and_run() { build "$1" "$2" && "build/$1/$2" --gtest_brief=1 --gtest_filter="$3"; }
