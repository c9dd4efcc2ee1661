#include "common/vision/jpeg.hpp"

#include <array>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <opencv2/imgproc.hpp>

extern "C" {
#include <jpeglib.h>
}

namespace fathom::vision {
namespace {

constexpr int kMostPixels = 200'000'000;  // a damaged header may promise anything

// libjpeg's way out of an error is a jump; nothing with a destructor may live between here and there.
struct Errors {
  jpeg_error_mgr manager{};
  std::jmp_buf out{};
  std::array<char, JMSG_LENGTH_MAX> text{};
};

void leave(j_common_ptr info) {
  auto* errors = reinterpret_cast<Errors*>(info->err);
  info->err->format_message(info, errors->text.data());
  std::longjmp(errors->out, 1);
}

// Warnings are counted by the library; the first one is what we tell.
void note(j_common_ptr info, int level) {
  auto* errors = reinterpret_cast<Errors*>(info->err);
  if (level >= 0) return;
  if (info->err->num_warnings++ == 0) info->err->format_message(info, errors->text.data());
}

jpeg_error_mgr* listen(Errors& errors) {
  jpeg_std_error(&errors.manager);
  errors.manager.error_exit = leave;
  errors.manager.emit_message = note;
  return &errors.manager;
}

// False: a jump came. `into` is made by `prepare` when the size is known.
bool decode(std::span<const std::uint8_t> bytes, bool colour, Errors& errors, cv::Mat& into, bool& grey_file) {
  jpeg_decompress_struct info{};
  info.err = listen(errors);
  if (setjmp(errors.out) != 0) {  // NOLINT(cert-err52-cpp): the library's way
    jpeg_destroy_decompress(&info);
    return false;
  }
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, bytes.data(), bytes.size());
  jpeg_read_header(&info, TRUE);
  grey_file = info.jpeg_color_space == JCS_GRAYSCALE;
  info.out_color_space = colour && !grey_file ? JCS_EXT_BGR : JCS_GRAYSCALE;
  info.do_fancy_upsampling = TRUE;  // where colour is halved, blocks of it would move the laser's dot
  info.dct_method = JDCT_IFAST;
  if (static_cast<double>(info.image_width) * info.image_height > kMostPixels) {
    std::snprintf(errors.text.data(), errors.text.size(), "%u x %u pixels are too many", info.image_width,
                  info.image_height);
    jpeg_destroy_decompress(&info);
    return false;
  }
  jpeg_start_decompress(&info);
  into.create(static_cast<int>(info.output_height), static_cast<int>(info.output_width),
              info.output_components == 3 ? CV_8UC3 : CV_8UC1);
  while (info.output_scanline < info.output_height) {
    JSAMPROW row = into.ptr(static_cast<int>(info.output_scanline));
    jpeg_read_scanlines(&info, &row, 1);
  }
  jpeg_finish_decompress(&info);
  jpeg_destroy_decompress(&info);
  return errors.manager.num_warnings == 0;
}

}  // namespace

std::string decode_jpeg(std::span<const std::uint8_t> bytes, bool colour, cv::Mat& grey, cv::Mat& bgr) {
  Errors errors;
  bool grey_file = false;
  if (bytes.empty()) return "corrupt JPEG: no bytes";
  if (!decode(bytes, colour, errors, colour ? bgr : grey, grey_file)) {
    return "corrupt JPEG: " + std::string{errors.text.data()};
  }
  if (!colour) {
    bgr.release();
  } else if (grey_file) {
    grey = bgr;
    bgr = cv::Mat{};
  } else {
    cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  }
  return {};
}

bool halves_colour(std::span<const std::uint8_t> bytes) {
  Errors errors;
  jpeg_decompress_struct info{};
  info.err = listen(errors);
  if (bytes.empty()) return false;
  if (setjmp(errors.out) != 0) {  // NOLINT(cert-err52-cpp)
    jpeg_destroy_decompress(&info);
    return false;
  }
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, bytes.data(), bytes.size());
  jpeg_read_header(&info, TRUE);
  bool halved = false;
  for (int i = 1; i < info.num_components; ++i) {
    halved = halved || info.comp_info[i].h_samp_factor < info.max_h_samp_factor ||
             info.comp_info[i].v_samp_factor < info.max_v_samp_factor;
  }
  jpeg_destroy_decompress(&info);
  return halved;
}

std::vector<std::uint8_t> encode_jpeg(const cv::Mat& picture, int quality, bool halved_colour) {
  Errors errors;
  jpeg_compress_struct info{};
  unsigned char* bytes = nullptr;
  unsigned long length = 0;
  info.err = listen(errors);
  if (setjmp(errors.out) != 0) {  // NOLINT(cert-err52-cpp)
    jpeg_destroy_compress(&info);
    std::free(bytes);
    return {};
  }
  jpeg_create_compress(&info);
  jpeg_mem_dest(&info, &bytes, &length);
  info.image_width = static_cast<JDIMENSION>(picture.cols);
  info.image_height = static_cast<JDIMENSION>(picture.rows);
  info.input_components = picture.channels();
  info.in_color_space = picture.channels() == 3 ? JCS_EXT_BGR : JCS_GRAYSCALE;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, quality, TRUE);
  // Colour at full resolution where there is any: the laser's dot is a few pixels of it, and blocks of 16 pixels would
  // move it by half of one.
  for (int i = 0; i < info.num_components; ++i) info.comp_info[i].h_samp_factor = info.comp_info[i].v_samp_factor = 1;
  if (halved_colour) info.comp_info[0].h_samp_factor = 2;
  jpeg_start_compress(&info, TRUE);
  while (info.next_scanline < info.image_height) {
    auto* row = const_cast<JSAMPROW>(picture.ptr(static_cast<int>(info.next_scanline)));
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  std::vector<std::uint8_t> result(bytes, bytes + length);
  std::free(bytes);
  return result;
}

}  // namespace fathom::vision
