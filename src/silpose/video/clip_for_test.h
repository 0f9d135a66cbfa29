// Clips as phones, camcorders and editors make them, for tests: what create_video() never writes.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "silpose/image/image.h"
#include "silpose/video/ffmpeg.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

namespace silpose {

struct ClipForTest {
  std::string codec = "libx264", pixel_format = "yuv420p";  // the file's extension determines the container
  int rate = 30;                                            // frames per second
  std::vector<int64_t> times_ms;                            // of the frames; empty: even
  AVRational pixel_aspect = {1, 1};
  AVColorSpace colour_space = AVCOL_SPC_UNSPECIFIED;
  AVColorTransferCharacteristic transfer = AVCOL_TRC_UNSPECIFIED;
  bool is_interlaced = false, has_sound = false, has_pictures = true;
  std::optional<std::array<int32_t, 9>> display_matrix;
  std::vector<std::pair<std::string, std::string>> metadata;  // of the file, as QuickTime's keys
};

inline int must(int code) {
  if (code < 0) throw std::runtime_error("clip_for_test: " + ffmpeg_text(code));
  return code;
}

// Writes `pictures` [H, W, 3] as they are to be stored.
inline void write_clip_for_test(const std::filesystem::path& path, std::span<const ByteImage> pictures,
                                const ClipForTest& clip) {
  silence_ffmpeg();
  AVFormatContext* output = nullptr;
  must(avformat_alloc_output_context2(&output, nullptr, nullptr, path.c_str()));
  const AVRational milliseconds{1, 1000};
  const auto add = [&](const std::string& codec_name, const auto& settle) {
    const AVCodec* const codec = avcodec_find_encoder_by_name(codec_name.c_str());
    if (codec == nullptr) throw std::runtime_error("clip_for_test: no " + codec_name);
    CodecHandle encoder(avcodec_alloc_context3(codec));
    settle(*encoder);
    encoder->thread_count = 1;
    if ((output->oformat->flags & AVFMT_GLOBALHEADER) != 0) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    AVDictionary* options = nullptr;
    av_dict_set(&options, "crf", "10", 0);
    av_dict_set(&options, "x265-params", "log-level=none", 0);
    must(avcodec_open2(encoder.get(), codec, &options));
    av_dict_free(&options);
    AVStream* const stream = avformat_new_stream(output, nullptr);
    must(avcodec_parameters_from_context(stream->codecpar, encoder.get()));
    stream->time_base = encoder->time_base;
    return std::pair(std::move(encoder), stream);
  };
  std::pair<CodecHandle, AVStream*> video, sound;
  if (clip.has_pictures) {
    video = add(clip.codec, [&](AVCodecContext& encoder) {
      encoder.width = pictures[0].width();
      encoder.height = pictures[0].height();
      encoder.pix_fmt = av_get_pix_fmt(clip.pixel_format.c_str());
      encoder.time_base = milliseconds;
      if (clip.times_ms.empty()) encoder.time_base = {1, clip.rate};
      encoder.framerate = {clip.rate, 1};
      encoder.sample_aspect_ratio = clip.pixel_aspect;
      encoder.colorspace = clip.colour_space;
      encoder.color_trc = clip.transfer;
      encoder.color_range = AVCOL_RANGE_MPEG;
      if (clip.is_interlaced) encoder.flags |= AV_CODEC_FLAG_INTERLACED_DCT | AV_CODEC_FLAG_INTERLACED_ME;
    });
    video.second->sample_aspect_ratio = clip.pixel_aspect;
    if (clip.times_ms.empty()) video.second->avg_frame_rate = {clip.rate, 1};
    if (clip.display_matrix) {
      uint8_t* const data = add_side_data(*video.second, AV_PKT_DATA_DISPLAYMATRIX, 9 * sizeof(int32_t));
      std::memcpy(data, clip.display_matrix->data(), 9 * sizeof(int32_t));
    }
  }
  if (clip.has_sound) {
    sound = add("pcm_s16le", [](AVCodecContext& encoder) {
      encoder.sample_fmt = AV_SAMPLE_FMT_S16;
      encoder.sample_rate = 8000;
      av_channel_layout_default(&encoder.ch_layout, 1);
      encoder.time_base = {1, 8000};
    });
  }
  must(avio_open(&output->pb, ffmpeg_path(path.string()).c_str(), AVIO_FLAG_WRITE));
  for (const auto& [key, value] : clip.metadata) av_dict_set(&output->metadata, key.c_str(), value.c_str(), 0);
  AVDictionary* muxing = nullptr;
  if (!clip.metadata.empty()) av_dict_set(&muxing, "movflags", "use_metadata_tags", 0);
  must(avformat_write_header(output, &muxing));
  av_dict_free(&muxing);

  const PacketHandle packet(av_packet_alloc());
  const auto encode = [&](const std::pair<CodecHandle, AVStream*>& to, const AVFrame* frame) {
    must(avcodec_send_frame(to.first.get(), frame));
    while (avcodec_receive_packet(to.first.get(), packet.get()) >= 0) {
      av_packet_rescale_ts(packet.get(), to.first->time_base, to.second->time_base);
      packet->stream_index = to.second->index;
      if (packet->duration == 0) packet->duration = av_rescale_q(1, {1, clip.rate}, to.second->time_base);
      must(av_interleaved_write_frame(output, packet.get()));
    }
  };
  if (clip.has_pictures) {
    AVCodecContext& encoder = *video.first;
    const FrameHandle frame(av_frame_alloc());
    frame->format = encoder.pix_fmt;
    frame->width = encoder.width;
    frame->height = encoder.height;
    must(av_frame_get_buffer(frame.get(), 0));
    const ScalerHandle scaler(sws_getContext(encoder.width, encoder.height, AV_PIX_FMT_BGR24, encoder.width,
                                             encoder.height, encoder.pix_fmt, SWS_BICUBIC, nullptr, nullptr, nullptr));
    sws_setColorspaceDetails(scaler.get(), sws_getCoefficients(SWS_CS_DEFAULT), 1,
                             sws_getCoefficients(clip.colour_space), 0, 0, 1 << 16, 1 << 16);
    for (size_t i = 0; i < pictures.size(); ++i) {
      must(av_frame_make_writable(frame.get()));
      const uint8_t* const rows[] = {pictures[i].pixels().data()};
      const int stride[] = {3 * encoder.width};
      sws_scale(scaler.get(), rows, stride, 0, encoder.height, frame->data, frame->linesize);
      frame->pts = clip.times_ms.empty() ? static_cast<int64_t>(i) : clip.times_ms.at(i);
      set_interlaced(*frame, clip.is_interlaced);
      encode(video, frame.get());
    }
    encode(video, nullptr);
  }
  if (clip.has_sound) {
    const FrameHandle frame(av_frame_alloc());
    frame->format = AV_SAMPLE_FMT_S16;
    frame->nb_samples = 8000;
    av_channel_layout_default(&frame->ch_layout, 1);
    must(av_frame_get_buffer(frame.get(), 0));
    std::memset(frame->data[0], 0, 16000);
    frame->pts = 0;
    encode(sound, frame.get());
    encode(sound, nullptr);
  }
  must(av_write_trailer(output));
  must(avio_closep(&output->pb));
  avformat_free_context(output);
}

}  // namespace silpose
