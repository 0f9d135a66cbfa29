#include "silpose/report/report_page.h"

#include "silpose/base/check.h"
#include "silpose/base/text_file.h"
#include "silpose/report/base64.h"
#include "silpose/report/page_template.h"
#include "silpose/report/report_data.h"

namespace silpose {
namespace {

std::string escape_html(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

// The page's address of the video; empty without one.
Result<std::string> video_address(const ReportInput& input) {
  if (input.overlay_video.empty()) return std::string();
  std::error_code failed;
  const uintmax_t size = std::filesystem::file_size(input.overlay_video, failed);
  if (failed) return error("{}: {}", input.overlay_video.string(), failed.message());
  if (size > static_cast<uintmax_t>(input.embed_limit_bytes)) {
    return escape_html(input.overlay_video.filename().string());
  }
  const Result<std::string> bytes = read_text_file(input.overlay_video);
  if (!bytes) return bytes.failure();
  return "data:video/mp4;base64," + base64(*bytes);
}

// A script element must not contain a "<" that HTML could mistake for markup.
std::string escape_script(std::string_view json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}

void replace(std::string& text, std::string_view what, std::string_view by) {
  const size_t at = text.find(what);
  if (at != std::string::npos) text.replace(at, what.size(), by);
}

}  // namespace

Result<std::string> make_report(const ReportInput& input) {
  check(input.recording != nullptr && input.body != nullptr, "make_report: recording and body are wanted");
  const Result<std::string> video = video_address(input);
  if (!video) return video.failure();
  std::string page(kPageTemplate);
  // From the end: what is put in is not searched again.
  replace(page, "@DATA@", escape_script(report_json(input)));
  replace(page, "@VIDEO@", *video);
  const std::string title = escape_html(input.title);
  replace(page, "@TITLE@", title);
  replace(page, "@HEADING@", title);
  return page;
}

Result<void> write_report(const std::filesystem::path& path, const ReportInput& input) {
  const Result<std::string> page = make_report(input);
  if (!page) return page.failure();
  return write_text_file(path, *page);
}

}  // namespace silpose
