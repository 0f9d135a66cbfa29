// The rules of ARCHITECTURE.md that the build does not enforce by itself, over the text of a source tree.
// Each function returns one line per violation, "file:line: what is wrong" or as it says; none: the tree obeys.
// Threads: functions without state.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace silpose {

using Floors = std::map<std::string, int, std::less<>>;

// "base=0 geometry=1 ..." as cmake/modules.cmake holds it.
Floors parse_floors(std::string_view text);

// #include lines under ROOT/src: a module of silpose or sadb includes itself and modules of strictly lower floors; its
// tests also `synth` and `human`. sadb sees only base, geometry and image of silpose; below `recording`, silpose does
// not see sadb.
std::vector<std::string> include_violations(const std::filesystem::path& root, const Floors& floors);

// Circles of #include lines between units of one module: of src/silpose/*, of src/sadb/*, of apps/silpose or of bench.
// A unit is NAME.h, NAME.cc and NAME-inl.h; tests (*_test.cc) do not count. One line for each set of units that all
// depend on one another, with the shortest circle through the first of them: "src/silpose/track: limb_reach -> limbs ->
// limb_reach".
std::vector<std::string> unit_circles(const std::filesystem::path& root);

// Folders with names that do not say what is in them, anywhere under ROOT/{src,apps,bench,examples,tests}.
std::vector<std::string> folder_violations(const std::filesystem::path& root);

// Keys of sources cited in comments ("deutscher2005", or any word in a list after "references.bib:") under
// ROOT/{src,apps,bench,examples} that ROOT/docs/references.bib does not hold.
std::vector<std::string> citation_violations(const std::filesystem::path& root);

// Constants at namespace scope in .h and .cc files of these folders, tests apart, that do not say where they come from:
// `constexpr` variables named kX whose initialiser has a number literal (one that is derived from other constants alone
// has none). The tag is in the comment at the end of one of the constant's own lines, or in the comment above its
// group; a group ends at an empty line and at the next comment line. Tags: [paper: KEY], a key of docs/references.bib;
// [measured: experiment NAME], a file experiments/NAME.toml; [tuned on WHAT]; [guess]; [definition], where the value
// follows from a layout, a unit or a law. A folder that is missing is a violation, so that a rename does not end the
// check.
std::vector<std::string> provenance_violations(const std::filesystem::path& root,
                                               const std::vector<std::string>& folders);

// Phrases that are not the field's terms, in lower case, each with what to write instead.
using Phrases = std::map<std::string, std::string, std::less<>>;

// Where such phrases occur as whole words, in any case: in the C++, Markdown, TOML, JavaScript, Python and shell files
// of ROOT and of ROOT/{src,apps,bench,examples,scripts,docs,experiments,tests}, but for ROOT/tests/layering.
std::vector<std::string> wording_violations(const std::filesystem::path& root, const Phrases& phrases);

}  // namespace silpose
