#include "silpose/image/ffmpeg.h"

#include <array>
#include <cstdarg>
#include <filesystem>
#include <mutex>

extern "C" {
#include <libavutil/log.h>
}

namespace silpose {

std::string ffmpeg_text(int code) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(code, text.data(), text.size());
  return text.data();
}

std::string ffmpeg_path(const std::string& path) { return "file:" + std::filesystem::absolute(path).string(); }

void silence_ffmpeg() {
  static std::once_flag once;
  // Not its level: OpenCV sets that anew whenever it opens something.
  std::call_once(once, [] { av_log_set_callback([](void*, int, const char*, va_list) {}); });
}

}  // namespace silpose
