// Folders and videos as people have them: odd depths, damaged files, other files beside the pictures.
#include "common/pictures/source.hpp"

#include <doctest/doctest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "common/base/error.hpp"
#include "test/support/scratch.hpp"

namespace fathom::pictures {
namespace {

using test::Scratch;

/// Grey from dark to `brightest`.
cv::Mat ramp(int depth, double brightest) {
  cv::Mat picture(48, 64, CV_64F);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) picture.at<double>(y, x) = brightest * x / (picture.cols - 1);
  }
  picture.convertTo(picture, depth);
  return picture;
}

}  // namespace

TEST_CASE("pictures: 10, 12 and 14 bits in 16 have the brightness of 8, all pictures of a folder alike") {
  for (const int bits : {10, 12, 14, 16}) {
    CAPTURE(bits);
    const Scratch scratch;
    const double full = (1 << bits) - 1;
    cv::imwrite(scratch.path("1.png"), ramp(CV_16U, full));
    cv::imwrite(scratch.path("2.png"), ramp(CV_16U, 0.2 * full));  // a dark one
    cv::imwrite(scratch.path("3.png"), ramp(CV_8U, 255.0));
    const auto source = open(scratch.path(""), 0.0);
    double to_come = 3.0;
    for (const double brightest : {255.0, 51.0, 255.0}) {
      CHECK(source->to_come() == to_come--);
      const auto frame = source->next();
      REQUIRE(frame);
      CHECK(frame->picture.type() == CV_8UC1);
      double largest = 0.0;
      cv::minMaxIdx(frame->picture, nullptr, &largest);
      CHECK(largest == doctest::Approx(brightest).epsilon(0.01));
    }
    CHECK_FALSE(source->next());
    CHECK(source->to_come() == 0.0);
  }
}

TEST_CASE("pictures: what is empty, cut or no picture is told by name, other files are passed over") {
  const Scratch scratch;
  cv::imwrite(scratch.path("1.png"), ramp(CV_8U, 255.0));
  const std::string whole = test::read_bytes(scratch.path("1.png"));
  test::write_bytes(scratch.path("2.png"), whole.substr(0, whole.size() / 2));
  test::write_bytes(scratch.path("3.jpg"), "");
  test::write_bytes(scratch.path("4.tif"), "no picture");
  test::write_bytes(scratch.path("._1.png"), "another program's");
  test::write_bytes(scratch.path("notes.txt"), "x");
  const auto source = open(scratch.path(""), 0.0);
  CHECK(source->next()->problem.empty());
  CHECK(source->next()->problem.ends_with("2.png: ends before the picture does"));
  CHECK(source->next()->problem.ends_with("3.jpg: is empty"));
  CHECK(source->next()->problem.ends_with("4.tif: no picture that can be read; is it damaged?"));
  CHECK_FALSE(source->next());
}

TEST_CASE("pictures: a folder without pictures says in which of its folders there are some") {
  const Scratch scratch;
  std::filesystem::create_directories(scratch.path("frames"));
  CHECK_THROWS_WITH_AS(static_cast<void>(open(scratch.path(""), 0.0)), doctest::Contains("no pictures"), InputError);
  cv::imwrite(scratch.path("frames/1.png"), ramp(CV_8U, 255.0));
  CHECK_THROWS_WITH_AS(static_cast<void>(open(scratch.path(""), 0.0)), doctest::Contains("in its folder 'frames'"),
                       InputError);
}

TEST_CASE("pictures: a video that is cut says at its end how many pictures are missing") {
  const Scratch scratch;
  constexpr int kPictures = 40;
  const std::string path = scratch.path("whole.avi");
  {
    cv::VideoWriter writer{path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0, {64, 48}};
    REQUIRE(writer.isOpened());
    cv::Mat colour;
    for (int i = 0; i < kPictures; ++i) {
      cv::merge(std::vector<cv::Mat>(3, ramp(CV_8U, 100.0 + i)), colour);
      writer.write(colour);
    }
  }
  const std::string whole = test::read_bytes(path);
  test::write_bytes(scratch.path("cut.avi"), whole.substr(0, whole.size() / 2));
  for (const bool cut : {false, true}) {
    const auto source = open(cut ? scratch.path("cut.avi") : path, 0.0);
    int n = 0;
    while (source->next()) ++n;
    CHECK((n == kPictures) == !cut);
    CHECK(source->remark().ends_with("of 40 pictures that it states; is it cut?") == cut);
  }
}

}  // namespace fathom::pictures
