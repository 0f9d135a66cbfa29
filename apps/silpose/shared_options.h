// Options that several commands have.
// Threads: the main thread only.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "apps/silpose/command.h"
#include "silpose/session/camera_choice.h"
#include "silpose/session/input_options.h"

namespace silpose::app {

// --seed, --threads, --quiet, --json and --help.
void add_common_options(CLI::App& command, CommonOptions& common);

// VIDEO, the segmenter and its options, --fps, --start and --end.
void add_input_options(CLI::App& command, InputOptions& options);

// --camera and what belongs to its file.
void add_camera_options(CLI::App& command, CameraOptions& options);

void add_model_option(CLI::App& command, std::string& model);
CLI::Validator is_model();

// --out FILE.body, required.
void add_body_file_option(CLI::App& command, std::string& out);

}  // namespace silpose::app
