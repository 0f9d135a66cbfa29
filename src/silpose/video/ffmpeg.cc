#include "silpose/video/ffmpeg.h"

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
  // Not its level: OpenCV resets that whenever it opens something.
  std::call_once(once, [] { av_log_set_callback([](void*, int, const char*, va_list) {}); });
}

// FFmpeg 6.1 deprecates the members, which 8 drops.
#if LIBAVUTIL_VERSION_INT >= AV_VERSION_INT(58, 29, 100)

bool is_interlaced(const AVFrame& frame) { return (frame.flags & AV_FRAME_FLAG_INTERLACED) != 0; }

bool is_top_field_first(const AVFrame& frame) { return (frame.flags & AV_FRAME_FLAG_TOP_FIELD_FIRST) != 0; }

void set_interlaced(AVFrame& frame, bool is_interlaced) {
  constexpr int kFields = AV_FRAME_FLAG_INTERLACED | AV_FRAME_FLAG_TOP_FIELD_FIRST;
  frame.flags = is_interlaced ? frame.flags | kFields : frame.flags & ~kFields;
}

#else

bool is_interlaced(const AVFrame& frame) { return frame.interlaced_frame != 0; }

bool is_top_field_first(const AVFrame& frame) { return frame.top_field_first != 0; }

void set_interlaced(AVFrame& frame, bool is_interlaced) {
  frame.interlaced_frame = frame.top_field_first = is_interlaced ? 1 : 0;
}

#endif

// FFmpeg 6.1 moves a stream's side data to its codec parameters.
#if LIBAVCODEC_VERSION_INT >= AV_VERSION_INT(60, 31, 100)

const uint8_t* side_data_of(const AVStream& stream, AVPacketSideDataType type) {
  const AVCodecParameters& parameters = *stream.codecpar;
  const AVPacketSideData* const found =
      av_packet_side_data_get(parameters.coded_side_data, parameters.nb_coded_side_data, type);
  return found == nullptr ? nullptr : found->data;
}

uint8_t* add_side_data(AVStream& stream, AVPacketSideDataType type, size_t size) {
  AVCodecParameters& parameters = *stream.codecpar;
  AVPacketSideData* const added =
      av_packet_side_data_new(&parameters.coded_side_data, &parameters.nb_coded_side_data, type, size, 0);
  return added == nullptr ? nullptr : added->data;
}

#else

const uint8_t* side_data_of(const AVStream& stream, AVPacketSideDataType type) {
  return av_stream_get_side_data(&stream, type, nullptr);
}

uint8_t* add_side_data(AVStream& stream, AVPacketSideDataType type, size_t size) {
  return av_stream_new_side_data(&stream, type, size);
}

#endif

}  // namespace silpose
