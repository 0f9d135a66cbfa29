#include "silpose/exchange/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <string_view>

#include "silpose/base/check.h"
#include "silpose/base/text_file.h"
#include "silpose/exchange/csv.h"

namespace silpose {
namespace {

constexpr double kPixelCentre = 0.5;  // the library's pixels less OpenCV's, which files use
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Appends ",1.234560"; nothing after the comma for NaN, no minus before zero.
void put_value(std::string& text, double value, int decimals) {
  text += ',';
  if (std::isnan(value)) return;
  const size_t start = text.size();
  fmt::format_to(std::back_inserter(text), "{:.{}f}", value, decimals);
  if (text[start] == '-' && text.find_first_not_of("-0.", start) == std::string::npos) text.erase(start, 1);
}

void put_frame_and_time(std::string& text, int64_t frame, double time_s) {
  fmt::format_to(std::back_inserter(text), "{}", frame);
  put_value(text, time_s, 6);
}

// A value of a DOF. Errors: not a finite number; beyond what any pose or its spread can be.
Result<double> pose_value(const CsvReader& csv, int column) {
  constexpr double kLargest = 1e6;  // metres, degrees
  const Result<double> value = csv.number(column);
  if (value && std::abs(*value) > kLargest)
    return csv.wrong("{} is not within {} metres or degrees of zero", csv.text(column).substr(0, 40), kLargest);
  return value;
}

const std::array<std::string, 2> kScoreColumns = {"visual_accuracy", "effective_sample_size"};

}  // namespace

Result<void> write_poses(const std::filesystem::path& path, const Skeleton& skeleton, const PoseTable& table,
                         PoseUnits units) {
  const auto dofs = skeleton.dofs();
  std::string text = "frame,time_s";
  for (const Dof& dof : dofs) text += ',' + dof.column();
  if (table.has_scores) {
    for (const std::string& column : kScoreColumns) text += ',' + column;
  }
  text += '\n';
  const int decimals = units == PoseUnits::kNormalised ? 8 : 6;
  for (const PoseTable::Row& row : table.rows) {
    check(row.values.size() == dofs.size(), "{}: frame {} has {} values for {} DOF", path.string(), row.frame,
          row.values.size(), dofs.size());
    put_frame_and_time(text, row.frame, row.time_s);
    for (size_t d = 0; d < dofs.size(); ++d) {
      check(std::isfinite(row.values[d]), "{}: frame {}: {} is {}", path.string(), row.frame, dofs[d].name,
            row.values[d]);
      const bool in_degrees = units == PoseUnits::kNatural && !dofs[d].is_translation;
      put_value(text, in_degrees ? to_degrees(row.values[d]) : row.values[d], decimals);
    }
    if (table.has_scores) {
      put_value(text, row.visual_accuracy, 6);
      put_value(text, row.effective_sample_size, 3);
    }
    text += '\n';
  }
  return write_text_file(path, text);
}

Result<PoseTable> read_poses(const std::filesystem::path& path, const Skeleton& skeleton, PoseUnits units) {
  const auto text = read_text_file(path);
  if (!text) return text.failure();
  CsvReader csv(path.string(), *text);
  std::vector<std::string> required = {"frame", "time_s"};
  for (const Dof& dof : skeleton.dofs()) required.push_back(dof.column());
  const auto columns = csv.read_header(required, kScoreColumns);
  if (!columns) return columns.failure();

  PoseTable table;
  const size_t num_dofs = skeleton.dofs().size();
  const std::vector<int>& at = *columns;
  const int accuracy_at = at[num_dofs + 2], sample_size_at = at[num_dofs + 3];
  table.has_scores = accuracy_at >= 0 && sample_size_at >= 0;
  while (true) {
    const auto more = csv.next_row();
    if (!more) return more.failure();
    if (!*more) return table;
    PoseTable::Row row;
    const auto frame = csv.integer(at[0]);
    if (!frame) return frame.failure();
    row.frame = *frame;
    if (!table.rows.empty() && row.frame <= table.rows.back().frame) {
      return csv.wrong("frame {} after frame {}", row.frame, table.rows.back().frame);
    }
    const auto time_s = csv.number(at[1]);
    if (!time_s) return time_s.failure();
    row.time_s = *time_s;
    row.values.resize(num_dofs);
    for (size_t d = 0; d < num_dofs; ++d) {
      const auto value = pose_value(csv, at[d + 2]);
      if (!value) return value.failure();
      const bool in_degrees = units == PoseUnits::kNatural && !skeleton.dofs()[d].is_translation;
      row.values[d] = in_degrees ? to_radians(*value) : *value;
    }
    if (table.has_scores) {
      const auto accuracy = csv.number_or(accuracy_at, kNaN), sample_size = csv.number_or(sample_size_at, kNaN);
      if (!accuracy) return accuracy.failure();
      if (!sample_size) return sample_size.failure();
      row.visual_accuracy = *accuracy;
      row.effective_sample_size = *sample_size;
    }
    table.rows.push_back(std::move(row));
  }
}

Result<void> write_joints(const std::filesystem::path& path, const JointTable& table) {
  std::string text = "frame,time_s,joint,x_m,y_m,z_m,u_px,v_px";
  text += table.has_spread ? ",x_sd_m,y_sd_m,z_sd_m\n" : "\n";
  for (const JointTable::Row& row : table.rows) {
    check(row.x_in_world.allFinite(), "{}: frame {}: joint '{}' is not finite", path.string(), row.frame, row.joint);
    check(!row.joint.empty() && row.joint.find_first_of(",\"\r\n") == std::string::npos,
          "{}: '{}' cannot be a joint's name", path.string(), row.joint);
    put_frame_and_time(text, row.frame, row.time_s);
    text += ',' + row.joint;
    for (const double value : row.x_in_world) put_value(text, value, 6);
    for (const double value : row.pixel) put_value(text, value - kPixelCentre, 3);
    if (table.has_spread) {
      for (const double value : row.sd) put_value(text, value, 6);
    }
    text += '\n';
  }
  return write_text_file(path, text);
}

Result<JointTable> read_joints(const std::filesystem::path& path) {
  const auto text = read_text_file(path);
  if (!text) return text.failure();
  CsvReader csv(path.string(), *text);
  const std::array<std::string, 6> required = {"frame", "time_s", "joint", "x_m", "y_m", "z_m"};
  const std::array<std::string, 5> optional = {"u_px", "v_px", "x_sd_m", "y_sd_m", "z_sd_m"};
  const auto columns = csv.read_header(required, optional);
  if (!columns) return columns.failure();
  const std::vector<int>& at = *columns;

  JointTable table;
  table.has_spread = at[8] >= 0 && at[9] >= 0 && at[10] >= 0;
  std::set<std::string, std::less<>> seen;  // joints of the frame
  while (true) {
    const auto more = csv.next_row();
    if (!more) return more.failure();
    if (!*more) return table;
    JointTable::Row row;
    const auto frame = csv.integer(at[0]);
    if (!frame) return frame.failure();
    row.frame = *frame;
    if (table.rows.empty() || row.frame > table.rows.back().frame) {
      seen.clear();
    } else if (row.frame < table.rows.back().frame) {
      return csv.wrong("frame {} after frame {}", row.frame, table.rows.back().frame);
    }
    const auto time_s = csv.number(at[1]);
    if (!time_s) return time_s.failure();
    row.time_s = *time_s;
    row.joint = csv.text(at[2]);
    if (row.joint.empty()) return csv.wrong("no joint named");
    if (!seen.insert(row.joint).second) return csv.wrong("joint '{}' twice in frame {}", row.joint, row.frame);
    for (int k = 0; k < 3; ++k) {
      const auto value = csv.number(at[3 + k]);
      if (!value) return value.failure();
      row.x_in_world[k] = *value;
    }
    for (int k = 0; k < 2; ++k) {
      const auto value = csv.number_or(at[6 + k], kNaN);
      if (!value) return value.failure();
      row.pixel[k] = *value + kPixelCentre;
    }
    for (int k = 0; k < 3 && table.has_spread; ++k) {
      const auto value = csv.number_or(at[8 + k], kNaN);
      if (!value) return value.failure();
      row.sd[k] = *value;
    }
    table.rows.push_back(std::move(row));
  }
}

}  // namespace silpose
