// Which body: `--model human[:key=value,...]` or a .body file. Bodies built from the MakeHuman data are kept in the
// data folder, so that the next run loads them in milliseconds.
// Threads: functions without state; two programs that keep the same body are not in each other's way (whole_file.h).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/session/run_context.h"

namespace silpose {

// Whether it is "human", "human:..." that can be understood, or the path of a .body file, which may be missing.
// Errors: says why not.
Result<void> check_model(const std::string& model);

// The body of a model. Errors: those of check_model(), load_body() and build_body().
Result<std::shared_ptr<const BodyModel>> choose_body(const std::string& model, const RunContext& context);

// The human of a model with its levels of detail: always built, never taken from a kept file.
// Errors: not a human, phenotype out of range, body data missing or of another hash.
Result<BodyModel> build_body(const std::string& model, const RunContext& context);

// The human kept in `body_file`, unless the running program or the body data in the folder `data` is newer, or an
// earlier version of the program placed its joints elsewhere: then it has to be rebuilt.
std::optional<BodyModel> kept_human(const std::filesystem::path& body_file, const std::filesystem::path& data);

// The model that a result was made with: the body that was fitted to its clip, or the one that its run.json names;
// "human" where neither says.
std::string model_of_result(const std::filesystem::path& directory);

// How far the subject's size may be from the body's, one standard deviation, relative: 0 where the height is given, or
// a .body file. REQUIRES: a model that check_model() takes.
double size_deviation_of(const std::string& model);

}  // namespace silpose
