// Clips as phones, camcorders and editors make them, for tests: what create_video() never writes.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
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
  bool is_interlaced = false, has_sound = false, has_images = true;
  std::optional<std::array<int32_t, 9>> display_matrix;
  std::vector<std::pair<std::string, std::string>> metadata;  // of the file, as QuickTime's keys
};

inline int must(int code) {
  if (code < 0) throw std::runtime_error("clip_for_test: " + ffmpeg_text(code));
  return code;
}

// A file that is written, stream by stream. Errors: throws std::runtime_error.
class ClipWriterForTest {
 public:
  ClipWriterForTest(const std::filesystem::path& path, const ClipForTest& clip) : path_(path), clip_(clip) {
    silence_ffmpeg();
    must(avformat_alloc_output_context2(&output_, nullptr, nullptr, path.c_str()));
  }
  ~ClipWriterForTest() { avformat_free_context(output_); }
  ClipWriterForTest(const ClipWriterForTest&) = delete;
  ClipWriterForTest& operator=(const ClipWriterForTest&) = delete;

  void add_images(int width, int height) {
    images_ = add(clip_.codec, [&](AVCodecContext& encoder) {
      encoder.width = width;
      encoder.height = height;
      encoder.pix_fmt = av_get_pix_fmt(clip_.pixel_format.c_str());
      encoder.time_base = {1, 1000};
      if (clip_.times_ms.empty()) encoder.time_base = {1, clip_.rate};
      encoder.framerate = {clip_.rate, 1};
      encoder.sample_aspect_ratio = clip_.pixel_aspect;
      encoder.colorspace = clip_.colour_space;
      encoder.color_trc = clip_.transfer;
      encoder.color_range = AVCOL_RANGE_MPEG;
      if (clip_.is_interlaced) encoder.flags |= AV_CODEC_FLAG_INTERLACED_DCT | AV_CODEC_FLAG_INTERLACED_ME;
    });
    AVStream& stream = *images_.stream;
    stream.sample_aspect_ratio = clip_.pixel_aspect;
    if (clip_.times_ms.empty()) stream.avg_frame_rate = {clip_.rate, 1};
    if (clip_.display_matrix) {
      uint8_t* const data = add_side_data(stream, AV_PKT_DATA_DISPLAYMATRIX, 9 * sizeof(int32_t));
      std::memcpy(data, clip_.display_matrix->data(), 9 * sizeof(int32_t));
    }
  }

  void add_sound() {
    sound_ = add("pcm_s16le", [](AVCodecContext& encoder) {
      encoder.sample_fmt = AV_SAMPLE_FMT_S16;
      encoder.sample_rate = 8000;
      av_channel_layout_default(&encoder.ch_layout, 1);
      encoder.time_base = {1, 8000};
    });
  }

  // After all streams were added.
  void write_header() {
    must(avio_open(&output_->pb, ffmpeg_path(path_.string()).c_str(), AVIO_FLAG_WRITE));
    for (const auto& [key, value] : clip_.metadata) av_dict_set(&output_->metadata, key.c_str(), value.c_str(), 0);
    AVDictionary* muxing = nullptr;
    if (!clip_.metadata.empty()) av_dict_set(&muxing, "movflags", "use_metadata_tags", 0);
    must(avformat_write_header(output_, &muxing));
    av_dict_free(&muxing);
  }

  void write_images(std::span<const ByteImage> images) {
    AVCodecContext& encoder = *images_.encoder;
    const FrameHandle frame(av_frame_alloc());
    frame->format = encoder.pix_fmt;
    frame->width = encoder.width;
    frame->height = encoder.height;
    must(av_frame_get_buffer(frame.get(), 0));
    const ScalerHandle scaler(sws_getContext(encoder.width, encoder.height, AV_PIX_FMT_BGR24, encoder.width,
                                             encoder.height, encoder.pix_fmt, SWS_BICUBIC, nullptr, nullptr, nullptr));
    sws_setColorspaceDetails(scaler.get(), sws_getCoefficients(SWS_CS_DEFAULT), 1,
                             sws_getCoefficients(clip_.colour_space), 0, 0, 1 << 16, 1 << 16);
    for (size_t i = 0; i < images.size(); ++i) {
      must(av_frame_make_writable(frame.get()));
      const uint8_t* const rows[] = {images[i].pixels().data()};
      const int stride[] = {3 * encoder.width};
      sws_scale(scaler.get(), rows, stride, 0, encoder.height, frame->data, frame->linesize);
      frame->pts = clip_.times_ms.empty() ? static_cast<int64_t>(i) : clip_.times_ms.at(i);
      set_interlaced(*frame, clip_.is_interlaced);
      encode(images_, frame.get());
    }
    encode(images_, nullptr);
  }

  // One second.
  void write_silence() {
    const FrameHandle frame(av_frame_alloc());
    frame->format = AV_SAMPLE_FMT_S16;
    frame->nb_samples = 8000;
    av_channel_layout_default(&frame->ch_layout, 1);
    must(av_frame_get_buffer(frame.get(), 0));
    std::memset(frame->data[0], 0, 16000);
    frame->pts = 0;
    encode(sound_, frame.get());
    encode(sound_, nullptr);
  }

  void finish() {
    must(av_write_trailer(output_));
    must(avio_closep(&output_->pb));
  }

 private:
  struct Track {
    CodecHandle encoder;
    AVStream* stream = nullptr;
  };

  Track add(const std::string& codec_name, const std::function<void(AVCodecContext&)>& settle) {
    const AVCodec* const codec = avcodec_find_encoder_by_name(codec_name.c_str());
    if (codec == nullptr) throw std::runtime_error("clip_for_test: no " + codec_name);
    CodecHandle encoder(avcodec_alloc_context3(codec));
    settle(*encoder);
    encoder->thread_count = 1;
    if ((output_->oformat->flags & AVFMT_GLOBALHEADER) != 0) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    AVDictionary* options = nullptr;
    av_dict_set(&options, "crf", "10", 0);
    av_dict_set(&options, "x265-params", "log-level=none", 0);
    must(avcodec_open2(encoder.get(), codec, &options));
    av_dict_free(&options);
    AVStream* const stream = avformat_new_stream(output_, nullptr);
    must(avcodec_parameters_from_context(stream->codecpar, encoder.get()));
    stream->time_base = encoder->time_base;
    return {std::move(encoder), stream};
  }

  // Null ends the stream.
  void encode(const Track& to, const AVFrame* frame) {
    must(avcodec_send_frame(to.encoder.get(), frame));
    while (avcodec_receive_packet(to.encoder.get(), packet_.get()) >= 0) {
      av_packet_rescale_ts(packet_.get(), to.encoder->time_base, to.stream->time_base);
      packet_->stream_index = to.stream->index;
      if (packet_->duration == 0) packet_->duration = av_rescale_q(1, {1, clip_.rate}, to.stream->time_base);
      must(av_interleaved_write_frame(output_, packet_.get()));
    }
  }

  const std::filesystem::path& path_;
  const ClipForTest& clip_;
  AVFormatContext* output_ = nullptr;
  Track images_, sound_;
  const PacketHandle packet_{av_packet_alloc()};
};

// Writes `images` [H, W, 3] as they are to be stored.
inline void write_clip_for_test(const std::filesystem::path& path, std::span<const ByteImage> images,
                                const ClipForTest& clip) {
  ClipWriterForTest writer(path, clip);
  if (clip.has_images) writer.add_images(images[0].width(), images[0].height());
  if (clip.has_sound) writer.add_sound();
  writer.write_header();
  if (clip.has_images) writer.write_images(images);
  if (clip.has_sound) writer.write_silence();
  writer.finish();
}

}  // namespace silpose
