#include "silpose/exchange/trc.h"

#include <fmt/format.h>

#include <iterator>

#include "silpose/base/check.h"
#include "silpose/base/text_file.h"

namespace silpose {

Result<void> write_trc(const std::filesystem::path& path, const MarkerTable& table, double fps) {
  const size_t num_markers = table.names.size();
  check(num_markers > 0 && fps > 0, "write_trc: {} markers, {} frames per second", num_markers, fps);
  std::string text;
  const auto put = [&]<class... Args>(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
  };
  put("PathFileType\t4\t(X/Y/Z)\t{}\n", path.filename().string());
  put("DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n");
  put("{0:.6f}\t{0:.6f}\t{1}\t{2}\tm\t{0:.6f}\t{3}\t{1}\n", fps, table.rows.size(), num_markers,
      table.rows.empty() ? 0 : table.rows.front().frame);
  // Every cell ends in a tab, the last one of a line, too, as OpenSim writes it: it does not see an empty cell there
  // otherwise.
  put("Frame#\tTime\t");
  for (const std::string& name : table.names) put("{}\t\t\t", name);
  put("\n\t\t");
  for (size_t m = 1; m <= num_markers; ++m) put("X{0}\tY{0}\tZ{0}\t", m);
  put("\n\n");
  for (const MarkerTable::Row& row : table.rows) {
    put("{}\t{:.6f}\t", row.frame, row.time_s);
    check(row.x_in_world.empty() || row.x_in_world.size() == num_markers,
          "write_trc: frame {}: {} positions of {} markers", row.frame, row.x_in_world.size(), num_markers);
    for (const Eigen::Vector3d& x : row.x_in_world) {
      check(x.allFinite(), "write_trc: frame {}: a position is not finite", row.frame);
      put("{:.6f}\t{:.6f}\t{:.6f}\t", x.x(), x.y(), x.z());
    }
    if (row.x_in_world.empty()) text.append(3 * num_markers, '\t');
    text += '\n';
  }
  return write_text_file(path, text);
}

}  // namespace silpose
