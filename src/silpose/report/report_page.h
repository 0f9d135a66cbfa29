// The report: one HTML file that opens without network: the overlay video and a skeleton that can be rotated, how well
// the silhouettes agree and where they do not, every angle's curve with its claimed 90 % interval, how the masks were
// made, where the time went, and warnings. Made from a recording and run facts alone. Drawn by a small script inside
// the page (page/). Threads: functions without state.
#pragma once

#include <filesystem>
#include <string>

#include "silpose/base/result.h"
#include "silpose/report/report_input.h"

namespace silpose {

// The page as text. REQUIRES: recording and body. Errors: the overlay video cannot be read.
Result<std::string> make_report(const ReportInput& input);

// Errors: those of make_report; not writable.
Result<void> write_report(const std::filesystem::path& path, const ReportInput& input);

}  // namespace silpose
