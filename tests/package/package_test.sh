#!/usr/bin/env bash
# package_test.sh SOURCE BUILD FOLDER GENERATOR: installs BUILD into a fresh prefix, moves the prefix (nothing installed
# may depend on where it was), builds examples/ against it, and tracks. Then uses SOURCE as a part of another project.
set -euo pipefail
source=$1 build=$2 folder=$3 generator=$4

step() {
  printf '%s: %d s\n' "$1" "$SECONDS"
}
fail() {
  echo "package: $*" >&2
  exit 1
}
unset SILPOSE_DATA

rm -rf "$folder"
mkdir -p "$folder"
cmake --install "$build" --prefix "$folder/first" >"$folder/install.log" || fail "not installed: $folder/install.log"
prefix=$folder/prefix
mv "$folder/first" "$prefix"
step installed
for file in bin/silpose include/silpose/silpose.h share/silpose/experiments/human-walk.toml; do
  [[ -e $prefix/$file ]] || fail "$file is not installed"
done
if grep -rlF "$source" "$prefix/include" "$prefix"/lib*/cmake "$prefix"/lib/*/cmake 2>/dev/null; then
  fail "the files above name the source tree"
fi
if find "$prefix/include" -name '*_for_test.h' | grep .; then
  fail "headers of tests are installed"
fi

# The same headers at the same place give the same objects: the compiler cache of the build serves this test, too.
options=(-G "$generator" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER_LAUNCHER="$(command -v ccache || true)")
cmake -S "$source/examples" -B "$folder/examples" "${options[@]}" -DCMAKE_PREFIX_PATH="$prefix" \
  >"$folder/configure.log" 2>&1 || {
  cat "$folder/configure.log" >&2
  fail "find_package(silpose) failed"
}
step configured
cmake --build "$folder/examples" --parallel >"$folder/build.log" 2>&1 || {
  cat "$folder/build.log" >&2
  fail "examples/ does not build against the installed package"
}
step built

# The installed command finds the installed data, though those of the source tree are there too.
cd "$folder"
"$prefix/bin/silpose" experiment --list | grep human-walk >list.txt || fail "experiments are not found"
if [[ ! -d $prefix/share/silpose/makehuman ]]; then
  fail "the body data are not installed; scripts/fetch-body-data fetches them"
fi
"$prefix/bin/silpose" synth --out clip --motion sway --frames 6 --size 320x240 --quiet
"$prefix/bin/silpose" model list | grep -F .body >models.txt || fail "the body is not kept"
if grep -vF "$prefix/share/silpose" models.txt; then
  fail "the bodies above are not those of the prefix"
fi
examples/example_track_frames clip/masks clip/camera.toml "$prefix/share/silpose/human.body" >track.txt
step tracked
[[ $(wc -l <track.txt) == 6 ]] || fail "not one line for each of 6 frames: $(cat track.txt)"
awk '$3 < 0.8 { exit 1 }' track.txt || fail "visual accuracy below 0.8: $(cat track.txt)"

# As a part of another project: configured with its tests off, and one program built.
cmake -S "$source/tests/package/subproject" -B "$folder/subproject" "${options[@]}" -DSILPOSE_SOURCE="$source" \
  >"$folder/subproject.log" 2>&1 &&
  cmake --build "$folder/subproject" --parallel --target use_geometry >>"$folder/subproject.log" 2>&1 || {
  cat "$folder/subproject.log" >&2
  fail "add_subdirectory() does not work"
}
[[ $("$folder/subproject/use_geometry") == 320x240 ]] || fail "use_geometry printed something else"
step "as a subproject"
