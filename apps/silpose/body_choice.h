// Which body: `--model human[:key=value,...]` or a .body file. Bodies built from the MakeHuman data are kept in the
// data directory, so that the next run loads them in milliseconds. Threads: the main thread only.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "apps/silpose/console.h"
#include "silpose/base/result.h"
#include "silpose/body/body_model.h"

namespace silpose::app {

// A check for options: "human", "human:..." that can be understood, or the path of a .body file.
CLI::Validator is_model();

void add_model_option(CLI::App& command, std::string& model);

// The human kept in `body_file`, unless the program or the body data is newer, or an earlier version of the program
// placed its joints elsewhere: then it has to be rebuilt.
std::optional<BodyModel> kept_human(const std::filesystem::path& body_file);

// The body of a --model. Errors: unknown model, phenotype out of range, body data missing or of another hash.
Result<std::shared_ptr<const BodyModel>> choose_body(const std::string& model, Console& console);

// How far the subject's size may be from the body's of a --model that is_model() takes, one standard deviation,
// relative: 0 where the height is given, or a .body file.
double size_deviation_of(const std::string& model);

// choose_body(), always built, never taken from a kept file.
Result<BodyModel> build_body(const std::string& model, Console& console);

}  // namespace silpose::app
