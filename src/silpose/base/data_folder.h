// Where the data of programs lie: bodies, networks and experiments. The only place of the library that reads the
// environment; everything else is given the folder.
// Threads: any, as long as none changes the environment.
#pragma once

#include <filesystem>

namespace silpose {

// The folder of makehuman/, networks/, human.body and bodies/: $SILPOSE_DATA if set; else ../share/silpose next to the
// program, as `cmake --install` lays it out, if there; else the data folder of the build.
std::filesystem::path data_directory();

// The folder of the experiments' descriptions, searched in the same order: $SILPOSE_DATA/experiments,
// ../share/silpose/experiments, those of the source tree. Folders that do not exist are passed over.
std::filesystem::path experiments_directory();

}  // namespace silpose
