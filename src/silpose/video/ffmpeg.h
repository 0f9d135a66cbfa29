// Owners of FFmpeg's objects, its error codes as text, and what is named differently in its versions (5.1 to 7.1). Only
// for the readers and writers of video in this module.
// Threads: functions without state; silence_ffmpeg() holds for all threads from the first call on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

namespace silpose {

struct FfmpegDelete {
  void operator()(AVFormatContext* input) const { avformat_close_input(&input); }
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};
using InputHandle = std::unique_ptr<AVFormatContext, FfmpegDelete>;
using CodecHandle = std::unique_ptr<AVCodecContext, FfmpegDelete>;
using FrameHandle = std::unique_ptr<AVFrame, FfmpegDelete>;
using PacketHandle = std::unique_ptr<AVPacket, FfmpegDelete>;
using ScalerHandle = std::unique_ptr<SwsContext, FfmpegDelete>;

// "No space left on device".
std::string ffmpeg_text(int code);

// A path as FFmpeg takes it, even if it contains colons and percent signs.
std::string ffmpeg_path(const std::string& path);

// Keeps FFmpeg and its codecs from printing.
void silence_ffmpeg();

// Whether an image is made of two fields, and whether its upper line is of the earlier one.
[[nodiscard]] bool is_interlaced(const AVFrame& frame);
[[nodiscard]] bool is_top_field_first(const AVFrame& frame);
// Of two fields, the upper line of the earlier one, or of none.
void set_interlaced(AVFrame& frame, bool is_interlaced);

// Side data of the container, owned by the stream; null: none of that type.
[[nodiscard]] const uint8_t* side_data_of(const AVStream& stream, AVPacketSideDataType type);
// `size` bytes of side data to fill in before the header is written; null: out of memory.
[[nodiscard]] uint8_t* add_side_data(AVStream& stream, AVPacketSideDataType type, size_t size);

}  // namespace silpose
